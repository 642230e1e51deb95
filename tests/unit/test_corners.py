"""Corners of piecewise polynomials that are known by hand; and sums of records in few pieces."""

import numpy as np
import pytest

from tline.solver.convolution.corners import corners_of
from tline.solver.convolution.families import summed
from tline.solver.radau import basis

ORDER, N = basis(5), 12
PLACES = np.arange(N)[:, None] + ORDER.c


def bent(t):
    """Two waves with one corner, in the sixth slab."""
    return np.stack([np.where(t < 5.37, t**2, t**2 + (t - 5.37) * (3 - t)), np.where(t < 5.37, t, 10.74 - t)])


def test_a_corner_is_found_where_two_polynomials_meet():
    found = corners_of(bent(PLACES), 1e-6, ORDER)
    assert found.slab.tolist() == [5]
    assert found.at[0] == pytest.approx(0.37, abs=1e-3)
    np.testing.assert_allclose(found.before[:, 0], np.stack([PLACES[5] ** 2, PLACES[5]]), rtol=1e-10)
    np.testing.assert_allclose(found.behind[1, 0], 10.74 - PLACES[5], rtol=1e-10)


def test_smooth_waves_and_jumps_have_no_corner():
    assert not len(corners_of(np.sin(PLACES)[None] / 10, 1e-6, ORDER).slab)
    assert not len(corners_of(np.where(PLACES < 5.37, 0.0, 1.0)[None], 1e-6, ORDER).slab)


@pytest.mark.parametrize("least", [0.0, 1e-5])
def test_records_on_two_grids_add_up(least):
    """A smooth wave on the scene's slabs, and one that bends at 4.7, on slabs that begin 0.3 of one earlier."""
    late = np.arange(N + 1)[:, None] + ORDER.c - 0.3

    def wave(t):
        return np.exp(-t / 3) + np.maximum(t - 4.7, 0.0) ** 2

    records = [np.sin(PLACES / 3).reshape(1, 1, -1).repeat(2, 1), wave(late).reshape(1, 1, -1).repeat(2, 1)]
    whole, noted = summed(iter(records), np.array([0.0, 0.3]), N, ORDER, least)
    assert len(np.unique(noted.slab)) == (1 if least else N)
    error = whole[0, 0].reshape(N, -1) - np.sin(PLACES / 3) - wave(PLACES)
    assert np.abs(error).max() < max(least, 1e-5)
    place = noted.slab[:, None] + noted.span[:, :1] + np.diff(noted.span) * ORDER.c
    np.testing.assert_allclose(noted.values[:, 0], np.sin(place / 3) + wave(place), atol=1e-5)
