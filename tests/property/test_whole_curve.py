"""A tolerance that is met is met wherever a user looks; `python -m benchmarks.whole_curve` tries hundreds of pairs."""

import numpy as np
import pytest
from curve_cases import LOSSLESS, found

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
