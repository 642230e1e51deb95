"""What is told of networks with laws holds at any instant, against a recursion from bounce to bounce."""

import warnings

import numpy as np
import pytest
from laws_by_bounces import Network, random_network

from tline.solver.simulate import UnresolvedWarning, simulate

TOLERANCES = 1e-3, 1e-4, 1e-6, 1e-8
ROUNDING = 1e-12  # of the amplitude, of the recursion
SILENT = 1e-8  # of the largest pressure, or flow times z0: nothing is told below


def outside(network: Network, tol: float) -> tuple[bool, list[str]]:
    """Whether a run says that it has met a tolerance, and where more than three times as much as it told is wrong."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnresolvedWarning)
        result = simulate(network.scene, tol=tol)
    assert result.accuracy is not None
    t, wrong = np.sort(np.random.default_rng(0).uniform(0, network.t_end, 1500)), []
    for name, exact in network.exact(t).items():
        seen, told, z0 = result.probes[name].at(t), result.accuracy.inside[name], result.probes[name].record.z0
        largest = max(np.abs(exact[0]).max(), z0 * np.abs(exact[1]).max())
        for letter, found, true, error, size in zip(
            "uy", (seen.u, seen.y), exact, (told.u, told.y), (1, z0), strict=True
        ):
            amplitude = np.abs(true).max()
            if size * amplitude <= SILENT * largest:
                continue
            off = np.abs(found - true).max() / amplitude
            if off > 3 * min(tol, error) + ROUNDING:
                wrong.append(f"{name}.{letter}: {off:.2g}, told {error:.2g}")
    return result.accuracy.met, wrong if result.accuracy.met else []


@pytest.mark.parametrize("seed", range(8))
def test_nothing_is_more_wrong_than_told(seed):
    _, wrong = outside(random_network(seed), TOLERANCES[seed % 4])
    assert not wrong


def test_pieces_that_halved_slabs_leave_as_they_are_are_told():
    """Behind the bend of the relief valve a piece is narrower than half a slab, and the wave bends like a root."""

    at, band, back, drop = 50727.3305797147, 19797.046194964943, 30571.04618571008, 154965.3241835148

    def relief(u):
        return 0.0006911100810096251 * np.clip((u - at) / band, 0, 1) * np.sqrt(np.maximum(u, 0) / drop)

    def check(u):
        return 0.00024212941668096642 * np.sqrt(np.maximum(u - back, 0) / drop)

    rated = {"pressure_drop": drop}
    laws = {
        0: (rated | {"kind": "check valve", "back_pressure": back, "flow": 0.00024212941668096642}, check),
        1: (rated | {"kind": "relief valve", "set_pressure": at, "band": band, "flow": 0.0006911100810096251}, relief),
    }
    value = {"shape": "double exponential", "peak": drop, "rise": 0.00417533022580924, "decay": 0.1625343711076705}
    line = 0, 1, 98009340.6682628, 0.03604452279541477
    met, wrong = outside(Network([line], {0: (value, 29104368.894278187)}, laws, 0.20191914497298966), 1e-6)
    assert met
    assert not wrong
