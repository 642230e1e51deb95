"""A tolerance that is met is met wherever a user looks; `python tests/attack.py curve` tries more."""

import numpy as np
import pytest
from curve_cases import LOSSLESS, diode, found, orifice

from tline.solver.simulate import simulate

PAIRS = [(kind, k, 10.0 ** -(3 + 5 * k % 8)) for k, kind in enumerate(LOSSLESS)]


@pytest.mark.parametrize(("kind", "seed", "tol"), PAIRS)
def test_random_instants_and_extremes_are_as_told(kind, seed, tol):
    seen = found(LOSSLESS[kind](np.random.default_rng(seed)), tol, seed)
    assert seen.met, seen
    assert not seen.outside, seen


def test_ramps_far_shorter_than_a_slab_into_a_diode_are_not_the_same_piece_in_every_run():
    """Runs of one order would agree in them, and be wrong."""
    seen = found(LOSSLESS["diode"](np.random.default_rng([50, sum(map(ord, "diode"))])), 1e-6, 50)
    assert seen.met, seen
    assert not seen.outside, seen


@pytest.mark.parametrize("make", [diode, orifice])
@pytest.mark.parametrize("seed", range(2))
def test_laws_within_ramps_of_a_ten_thousandth_are_told_on_few_slabs(make, seed):
    """Halved slabs leave such a piece as it is; it is halved with them. Printed extremes lie in it."""
    case = make(np.random.default_rng([seed, 7]), "short ramp")
    for tol in (1e-3, 1e-6):
        seen = found(case, tol, seed)
        assert not seen.outside, (tol, seen)
    assert len(simulate(case.scene, tol=1e-3).t) < 6.0 / 1.003e-4 / 10  # no slab is as narrow as the ramp
