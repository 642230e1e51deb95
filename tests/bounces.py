"""A circuit between two lossless lines of the same delay, a step behind a resistance, and a resistance at the end.

Waves v that arrive at the circuit drive currents i = Y(s)·v into it, and v - 2·z0·i leaves; ends reflect it. So what
leaves is a power series in exp(-2 s T), whose terms are rational in s: each is inverted on Talbot's contour.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import mpmath as mp
import numpy as np
from numpy.typing import NDArray

from tline.scene.scene import Scene

DELAY, SOURCE, LOAD, POINTS, T_END = 1.0, 20.0, 130.0, 50, 10.0  # 50 points of the contour give 30 digits
Z0 = (50.0, 75.0)
R, L, C = 10.0, 20.0, 1 / 512
L1, L2, COUPLING = 30.0, 60.0, 0.75


class Between(NamedTuple):
    """A link of a scene, and its admittance to arriving waves: of the first port, mutual, of the second."""

    table: dict[str, Any]
    admittance: Callable[[Any], tuple[Any, Any, Any]]


def _series(s: Any) -> tuple[Any, Any, Any]:
    y = 1 / (sum(Z0) + R + s * L + 1 / (s * C))
    return y, -y, y


def _coils(s: Any) -> tuple[Any, Any, Any]:
    first, second, mutual = Z0[0] + s * L1, Z0[1] + s * L2, s * COUPLING * mp.sqrt(L1 * L2)
    determinant = first * second - mutual**2
    return second / determinant, -mutual / determinant, first / determinant


SERIES = Between({"kind": "series", "resistance": R, "inductance": L, "capacitance": C}, _series)
COILS = Between({"kind": "coupled inductors", "inductance": [L1, L2], "coupling": COUPLING}, _coils)


def scene_of(link: Between, order: int, slab: float) -> Scene:
    """A step of 1 at t = 0."""
    return Scene(
        medium="electrical",
        t_end=T_END,
        lines={
            "first": {"nodes": ["near", "a"], "z0": Z0[0], "delay": DELAY},
            "second": {"nodes": ["b", "far"], "z0": Z0[1], "delay": DELAY},
        },
        sources={"s": {"at": "near", "kind": "voltage", "value": {"shape": "step", "to": 1}, "resistance": SOURCE}},
        links={"link": link.table | {"nodes": ["a", "b"]}},
        loads={"load": {"at": "far", "kind": "resistor", "resistance": LOAD}},
        probes={"near": {"at": "near"}, "far": {"at": "far"}},
        solver={"order": order, "slab": slab},
    )


def leaving(link: Between, s: Any, n: int) -> tuple[Any, Any]:
    """Waves that leave the circuit into both lines after n round trips, for a step of 1 that arrives at the first."""
    y = link.admittance(s)
    ends = [(mp.mpf(r) - z) / (r + z) for r, z in zip((SOURCE, LOAD), Z0, strict=True)]
    first, second = 1 / s, mp.mpf(0)
    for k in range(n + 1):
        into = y[0] * first + y[1] * second, y[1] * first + y[2] * second
        first, second = first - 2 * Z0[0] * into[0], second - 2 * Z0[1] * into[1]
        if k < n:
            first, second = first * ends[0], second * ends[1]
    return first, second


def inverse(spectrum: Callable[[Any], Sequence[Any]], t: Any) -> list[Any]:
    """Inverse Laplace transforms at t > 0 on Talbot's contour (Abate and Valko 2004, doi:10.1002/nme.995)."""
    with mp.workdps(POINTS):
        r = 2 * mp.mpf(POINTS) / (5 * t)
        total = [value * mp.exp(r * t) / 2 for value in spectrum(r)]
        for k in range(1, POINTS):
            angle = k * mp.pi / POINTS
            cot = mp.cot(angle)
            s = r * angle * mp.mpc(cot, 1)
            weight = mp.exp(s * t) * mp.mpc(1, angle + (angle * cot - 1) * cot)
            total = [before + (value * weight).real for before, value in zip(total, spectrum(s), strict=True)]
        return [value * r / POINTS for value in total]


def closed_form(link: Between, times: NDArray) -> NDArray:
    """Efforts at the near and the far end at some instants, none of them that of an echo."""
    at_ends = mp.mpf(SOURCE) / (SOURCE + Z0[0]), mp.mpf(LOAD) / (LOAD + Z0[1])  # share of a wave that arrives
    wave = 2 * mp.mpf(Z0[0]) / (SOURCE + Z0[0])  # of the source
    found = []
    for t in times:
        u = [wave / 2 if t > 0 else mp.mpf(0), mp.mpf(0)]
        n = 0
        while (since := mp.mpf(float(t)) - 2 * (n + 1) * DELAY) > 1e-9:
            waves = inverse(lambda s, n=n: leaving(link, s, n), since)
            u = [before + wave * share * w for before, share, w in zip(u, at_ends, waves, strict=True)]
            n += 1
        found.append([float(value) for value in u])
    return np.array(found).T
