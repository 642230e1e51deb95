"""Measured motion and force: checked, and the motion as a smoothing spline that the laws can be moved with."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from friction.motion import Motion, splined
from tline.errors import InputError

if TYPE_CHECKING:
    from friction.kernel.prescribed import Course

FEWEST, MOST_SAMPLES = 50, 100_000  # samples
REST = 1e-3  # of the largest velocity, below which a static law is taken to be at rest
NORMAL, FOURTH = (
    0.6745,
    70.0**0.5,
)  # median of |noise|, and growth of noise in fourth differences, both over its deviation
EXACT = 1e-6  # of the range, noise below which the spline goes through all samples


class Measured(NamedTuple):
    """A record: arrays of shape (n,), time from 0 on, and the velocity between the samples."""

    t: NDArray
    x: NDArray
    v: NDArray
    force: NDArray
    course: "Course"

    @property
    def at_rest(self) -> NDArray:
        """Samples with a speed of at most REST times the largest."""
        return np.abs(self.v) <= REST * np.max(np.abs(self.v))


def measured(t: ArrayLike, force: ArrayLike, velocity: ArrayLike | None, position: ArrayLike | None) -> Measured:
    """The record of a test, its velocity by a smoothing spline.

    Raises
    ------
    InputError
        Samples are missing or out of order, or nothing moves or changes.
    """
    if (velocity is None) == (position is None):
        raise InputError("motion", "not one", "velocity or position")
    name, given = ("velocity", velocity) if position is None else ("position", position)
    arrays = {key: _column(key, value) for key, value in (("t", t), ("force", force), (name, given))}
    time, size = arrays["t"], arrays["t"].size
    for key, column in arrays.items():
        if column.size != size:
            raise InputError(key, "not as long as t", f"{size} samples", f"{column.size}")
    if not FEWEST <= size <= MOST_SAMPLES:
        raise InputError(
            "t", "too few samples" if size < FEWEST else "too many samples", f"{FEWEST} to {MOST_SAMPLES:,}", f"{size}"
        )
    late = np.flatnonzero(np.diff(time) <= 0.0)
    if late.size:
        raise InputError(
            f"t[{late[0] + 1}]", "time does not rise", f"more than {time[late[0]]:g}", f"{time[late[0] + 1]:g}"
        )
    for key in ("force", name):
        if np.ptp(arrays[key]) <= 1e-12 * np.max(np.abs(arrays[key])):
            raise InputError(key, "constant", "something that changes" if key == "force" else "a motion")
    motion = _smooth(time - time[0], arrays[name], name == "position")
    at = time - time[0]
    return Measured(at, motion.place(at), motion.velocity(at), arrays["force"], motion.course(float(at[-1])))


def _column(name: str, values: ArrayLike | None) -> NDArray:
    try:
        column = np.array(values, float).ravel()
    except (TypeError, ValueError) as error:
        raise InputError(name, "not numbers", "a number for each sample", str(error)[:60]) from error
    bad = np.flatnonzero(~np.isfinite(column))
    if bad.size:
        raise InputError(f"{name}[{bad[0]}]", "a gap", "a number for each sample", f"{bad.size} without")
    return column


def _smooth(t: NDArray, values: NDArray, is_position: bool) -> Motion:
    """A spline as rough as the noise, which the fourth differences of the samples show.

    C. H. Reinsch, Numerische Mathematik 10 (1967) 177; P. Dierckx, Curve and Surface Fitting with Splines (1993).
    """
    noise = float(np.median(np.abs(np.diff(values, 4)))) / NORMAL / FOURTH
    return splined(t, values, is_position, 0.0 if noise < EXACT * np.ptp(values) else noise)
