"""Jitter and masks of eyes that are written down."""

import numpy as np
import pytest

from tline.errors import InputError
from tline.signal.bits import FINE
from tline.signal.eye_diagram import Eye
from tline.signal.eye_statistics import Mask, crossings, jitter, mask_hits, mask_of


def written(shifts: np.ndarray, rise: float = 0.25) -> Eye:
    """Bits of 1 s, alternating between 1 and -1, each edge straight, its middle late by a share of a bit."""
    n = len(shifts)
    t = np.arange(n * FINE) / FINE
    u = np.zeros(n * FINE)
    for k in range(n):
        sign = 1.0 if k % 2 else -1.0
        u += sign * np.clip((t - k - shifts[k]) / rise + 0.5, 0.0, 1.0) * 2
    u = u + 1.0
    bits = np.arange(n) % 2 == 1
    return Eye(bits, 1.0, u.reshape(n, FINE), 0.5, 1.0, -1.0, 0.0, 1.0)


def test_crossings_are_where_the_edges_are():
    shifts = np.array([0.0, 0.02, -0.03, 0.05, 0.01, -0.01, 0.0, 0.04])
    seen = written(shifts)
    assert crossings(seen)[:-1] == pytest.approx(shifts[1:], abs=1e-12)  # that of the first bit comes last
    assert jitter(seen).peak_to_peak == pytest.approx(0.08, abs=1e-12)
    assert jitter(seen).rms == pytest.approx(np.std(crossings(seen)), abs=1e-15)


def test_a_level_that_never_changes_has_no_jitter():
    flat = Eye(np.array([True, False]), 1.0, np.ones((2, FINE)), 0.5, 1.0, 1.0, 0.0, 1.0)
    assert jitter(flat) == (0.0, 0.0)


@pytest.mark.parametrize(("shift", "hits"), [(0.18, 0), (0.22, 1), (0.45, 1)])
def test_a_late_edge_touches_the_corner_of_a_mask(shift, hits):
    """The mask begins 0.3 before the middle of the bit, 0.2 after its begin."""
    shifts = np.zeros(8)
    shifts[3] = shift
    assert mask_hits(written(shifts, rise=0.02), Mask(0.6, 0.5)) == hits


def test_a_mask_as_high_as_the_eye_is_touched_by_all():
    seen = written(np.zeros(8))
    assert mask_hits(seen, Mask(0.4, 1.9)) == 0
    assert mask_hits(seen, Mask(0.4, 2.1)) == 8


def test_a_mask_is_within_a_bit():
    seen = written(np.zeros(4))
    assert mask_of("0.5 s", 0.2, seen).corners.shape == (7, 2)
    for width, height in ((2.0, 1.0), (0.0, 1.0), (0.5, 0.0)):
        with pytest.raises(InputError, match=r"mask: its (width|height)"):
            mask_of(width, height, seen)
