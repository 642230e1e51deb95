"""A tolerance that is met is met wherever a user looks; `python -m benchmarks.whole_curve` tries hundreds of pairs."""

import numpy as np
import pytest
from curve_cases import LOSSLESS, LOSSY, found

PAIRS = [(kind, k, 10.0 ** -(3 + 5 * k % 8)) for k, kind in enumerate(LOSSLESS)]


@pytest.mark.parametrize(("kind", "seed", "tol"), [*PAIRS, ("cable", 4, 1e-4), ("zielke", 0, 1e-3)])
def test_random_instants_and_extremes_are_as_told(kind, seed, tol):
    seen = found((LOSSLESS | LOSSY)[kind](np.random.default_rng(seed)), tol, seed)
    assert not seen.outside, seen
    assert kind in LOSSY or seen.met, seen
