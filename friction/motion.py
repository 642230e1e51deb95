"""Prescribed motions: velocity and place over time, and the intervals in which the velocity keeps its sign."""

from collections.abc import Callable
from dataclasses import dataclass
from math import asin, cos, pi, sin
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from friction.testbench import Force
from tline.errors import InputError

if TYPE_CHECKING:
    from friction.kernel.prescribed import Course

MOST_REVERSALS = 1_000_000
FEWEST_PIECES, MOST_PIECES = 64, 16_384  # of the spline of a formula
FORMULA = 1e-9  # error of that, relative to the largest value
BETWEEN = 0.382  # share of a piece at which it is sampled


@dataclass(frozen=True)
class Motion:
    """A velocity: cubics from each start on, in the time since then (rising powers), and a sine.

    Attributes
    ----------
    start : ndarray, shape (n,)
        Rising from 0 [s].
    cubic : ndarray, shape (n, 4)
        Coefficients [m/s, m/s², …].
    sine : tuple of float
        Amplitude [m/s], angular frequency [rad/s], phase [rad]; one cubic only beside it, a constant.
    x0 : float
        Place at the beginning [m].
    """

    start: NDArray
    cubic: NDArray
    sine: tuple[float, float, float] = (0.0, 0.0, 0.0)
    x0: float = 0.0

    def velocity(self, t: NDArray) -> NDArray:
        """Velocity at times [m/s]; after its jump where it jumps."""
        piece, (amplitude, omega, phase) = self._piece(t), self.sine
        return _power(self.cubic[piece], t - self.start[piece]) + amplitude * np.sin(omega * t + phase)

    def place(self, t: NDArray) -> NDArray:
        """Place at times [m]."""
        piece, (amplitude, omega, phase) = self._piece(t), self.sine
        integral = np.column_stack([np.zeros(self.start.size), self.cubic / np.arange(1, 5)])
        gain = _power(integral[:-1], np.diff(self.start))
        x = (self.x0 + np.append(0.0, np.cumsum(gain)))[piece] + _power(integral[piece], t - self.start[piece])
        return x + amplitude / omega * (cos(phase) - np.cos(omega * t + phase)) if amplitude else x

    def course(self, t_end: float) -> "Course":
        """Motion up to an end, in the form of the kernels. Raises InputError: it reverses more than a million times."""
        from friction.kernel.prescribed import Course

        inside = self.start[(self.start > 0.0) & (self.start < t_end)]
        turns = self._turns(t_end)
        edges = np.unique(np.concatenate([[0.0, t_end], inside, turns[(turns > 0.0) & (turns < t_end)]]))
        middle = edges[:-1] + 0.5 * np.diff(edges)
        return Course(
            self.start,
            self.cubic,
            *self.sine,
            edges,
            self._piece(middle),
            np.sign(self.velocity(middle)).astype(np.int64),
        )

    def _piece(self, t: NDArray) -> NDArray:
        return np.maximum(np.searchsorted(self.start, t, side="right") - 1, 0)

    def _turns(self, t_end: float) -> NDArray:
        """Zeros of the velocity up to an end."""
        amplitude, omega, phase = self.sine
        if amplitude:
            if omega * t_end / pi > MOST_REVERSALS:
                raise InputError(
                    "t_end", "too many reversals", f"at most {MOST_REVERSALS:,}", f"{omega * t_end / pi:.3g}"
                )
            share = -float(self.cubic[0, 0]) / amplitude
            if abs(share) >= 1.0:
                return np.empty(0)
            turns = np.arange(np.floor(phase / pi) - 1, np.ceil((omega * t_end + phase) / pi) + 2)
            return (np.where(turns % 2, -1.0, 1.0) * asin(share) + pi * turns - phase) / omega
        from scipy.interpolate import PPoly

        ends = np.append(self.start, max(t_end, self.start[-1]) + 1.0)
        roots = PPoly(self.cubic[:, ::-1].T, ends).roots(extrapolate=False)
        return roots[np.isfinite(roots)]


def _power(coefficients: NDArray, t: NDArray) -> NDArray:
    total = np.zeros_like(t)
    for column in coefficients.T[::-1]:
        total = total * t + column
    return total


def moved_with(velocity: Force) -> Motion:
    """A velocity [m/s] over time, from x = 0 on."""
    start, value, slope = velocity.pieces()
    motion = Motion(start, np.column_stack([value, slope, np.zeros((start.size, 2))]), velocity.sine)
    return _checked(motion, slope, "velocity")


def moved_along(position: Force) -> Motion:
    """A place [m] over time. Raises InputError: it jumps."""
    start, value, slope = position.pieces()
    jumps = value[1:] - value[:-1] - slope[:-1] * np.diff(start)
    if np.any(np.abs(jumps) > 1e-9 * (np.abs(value[1:]) + np.abs(value[:-1]))):
        raise InputError("position", "jumps", "a place without steps", f"a jump at {start[1:][jumps != 0.0][0]:g} s")
    amplitude, omega, phase = position.sine
    cubic = np.column_stack([slope, np.zeros((start.size, 3))])
    x0 = float(value[0]) + amplitude * sin(phase)
    return _checked(Motion(start, cubic, (amplitude * omega, omega, phase + 0.5 * pi), x0), slope, "position")


def _checked(motion: Motion, slope: NDArray, where: str) -> Motion:
    if motion.sine[0] and (motion.start.size > 1 or (slope[0] and where == "velocity")):
        raise InputError(where, "a sine on a slope", "a sine and a constant, or a formula")
    return motion


def moved_by(formula: Callable[[NDArray], ArrayLike], t_end: float, where: str) -> tuple[Motion, Motion, float]:
    """Approximate a velocity [m/s] or position [m] by a spline; return it, one of half the pieces, and their difference
    relative to the largest velocity.

    Raises InputError: it is not finite, or has a corner or a jump.
    """
    is_position, rough, count = where == "position", None, FEWEST_PIECES
    while count <= MOST_PIECES:
        edges = np.linspace(0.0, t_end, count + 1)
        between = edges[:-1] + BETWEEN * t_end / count
        values, others = (_values(formula, t, where) for t in (edges, between))
        fine = splined(edges, values, is_position)
        v = fine.velocity(between)
        if rough is not None:
            missed = (fine.place(between) if is_position else v) - others
            apart = float(np.max(np.abs(v - rough.velocity(between)))) / max(float(np.max(np.abs(v))), 1e-300)
            if max(apart, float(np.max(np.abs(missed))) / max(float(np.max(np.abs(others))), 1e-300)) <= FORMULA:
                return fine, rough, apart
        rough, count = fine, 2 * count
    raise InputError(where, "a formula with a corner, a jump or too many swings", "a smooth one, or a table or steps")


def _values(formula: Callable[[NDArray], ArrayLike], t: NDArray, where: str) -> NDArray:
    with np.errstate(all="ignore"):  # values not finite raise an error below
        values = np.broadcast_to(np.asarray(formula(t), float), t.shape)
    if not np.isfinite(values).all():
        raise InputError(where, f"no number at {t[~np.isfinite(values)][0]:g} s", "a finite number at any instant")
    return values


def splined(t: NDArray, values: NDArray, is_position: bool, noise: float = 0.0) -> Motion:
    """Fit a spline to velocity or position, smoothing noise of that deviation; the velocity has cubic pieces."""
    from scipy.interpolate import PPoly, make_interp_spline, splrep

    degree = 3 + is_position
    made: Any = splrep(t, values, k=degree, s=t.size * noise**2) if noise else make_interp_spline(t, values, degree)
    pieces, x0 = PPoly.from_spline(made), 0.0
    if is_position:
        x0, pieces = float(pieces(0.0)), pieces.derivative()
    inside = np.flatnonzero(np.diff(pieces.x) > 0.0)
    return Motion(pieces.x[inside], np.ascontiguousarray(pieces.c[::-1, inside].T), x0=x0)
