"""Torques over time: pieces that are each linear, with jumps between them if need be."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ulp

import numpy as np
from numpy.typing import NDArray

from drives.number import exact, finite
from tline.errors import InputError

LONGEST_TABLE = 10_000
ULPS = 8


def _late(where: str, time: float) -> None:
    if time < 0:
        raise InputError(where, "before the start", "0 s or later", f"{time:g} s")


@dataclass(frozen=True)
class Torque:
    """A torque, N m: in piece k it is starts[k] + slopes[k]*(t - times[k]).

    Parameters
    ----------
    times : tuple of float
        Where the pieces begin, s; the first is 0, each is later than the one before.
    starts, slopes : tuple of float
        N m and N m/s, as many.

    Examples
    --------
    >>> Torque.ramp(2.0, 1.0, 2.0)(1.25), Torque.step(3.0)(0.0), Torque.table([0, 1], [0, 4])(9.0)
    (0.5, 3.0, 4.0)
    """

    times: tuple[float, ...]
    starts: tuple[float, ...]
    slopes: tuple[float, ...]

    @classmethod
    def step(cls, height: float, at: float = 0.0) -> "Torque":
        """0 before `at`, `height` from then on."""
        height, at = finite((height, at), "step")
        _late("step", at)
        return cls((0.0, at), (0.0, height), (0.0, 0.0)) if at else cls((0.0,), (height,), (0.0,))

    @classmethod
    def ramp(cls, height: float, start: float, end: float) -> "Torque":
        """0 before `start`, `height` after `end`, a straight line between.

        Raises
        ------
        InputError
            `end` is not later than `start`.
        """
        height, start, end = finite((height, start, end), "ramp")
        return cls.table([start, end], [0.0, height])

    @classmethod
    def table(cls, times: Sequence[float], values: Sequence[float], *, held: bool = False) -> "Torque":
        """Straight lines through points; the first value before the first time, the last one after the last.

        Parameters
        ----------
        times : sequence of float
            s, 0 or later, each later than the one before; at most `LONGEST_TABLE`.
        values : sequence of float
            N m, as many.
        held : bool
            Keep each value until the next time instead.

        Raises
        ------
        InputError
            Naming the time that is out of order; or if the lengths differ.

        Examples
        --------
        >>> Torque.table([0, 2, 1], [1, 1, 1])
        Traceback (most recent call last):
        tline.errors.InputError: times[2]: out of order, expected a time later than 2 s, got 1 s
        """
        if not 0 < len(times) <= LONGEST_TABLE or len(times) != len(values):
            expected = f"as many values as times, from 1 to {LONGEST_TABLE}"
            raise InputError("torque table", "wrong length", expected, f"{len(times)} times and {len(values)} values")
        t, v = [float(exact(time, f"times[{k}]")) for k, time in enumerate(times)], finite(values, "values")
        _late("times[0]", t[0])
        for k in range(1, len(t)):
            if t[k] <= t[k - 1]:
                raise InputError(f"times[{k}]", "out of order", f"a time later than {t[k - 1]:g} s", f"{t[k]:g} s")
        slopes = [0.0 if held else (v[k + 1] - v[k]) / (t[k + 1] - t[k]) for k in range(len(t) - 1)] + [0.0]
        before = [] if t[0] == 0 else [0.0]
        return cls((*before, *t), (*[v[0]] * len(before), *v), (*before, *slopes))

    @classmethod
    def held(cls, times: NDArray, values: NDArray) -> "Torque":
        """Each value from its time until the next, 0 before the first."""
        if not len(times) or times[0] > 0.0:
            times, values = np.append(0.0, times), np.append(0.0, values)
        return cls(tuple(times.tolist()), tuple(values.tolist()), (0.0,) * len(times))

    def __add__(self, other: "Torque") -> "Torque":
        times = np.union1d(self.times, other.times)
        (starts, slopes), (more, steeper) = self.pieces(times), other.pieces(times)
        return Torque(*(tuple(column.tolist()) for column in (times, starts + more, slopes + steeper)))

    def pieces(self, t: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Values and slopes just after the times t."""
        k = np.searchsorted(self.times, t, side="right") - 1
        slopes = np.array(self.slopes)[k]
        return np.array(self.starts)[k] + slopes * (t - np.array(self.times)[k]), slopes

    def aligned(self, step: float) -> "Torque":
        """Move corners that are within a few ulps of a multiple of the step onto it."""
        near = [round(time / step) * step for time in self.times]
        times = (n if abs(n - time) <= ULPS * ulp(n) else time for n, time in zip(near, self.times, strict=True))
        return Torque(tuple(times), self.starts, self.slopes)

    def __call__(self, t: float) -> float:
        """Value at t >= 0; at a jump the later one."""
        return float(self.pieces(np.array([t]))[0][0])


ZERO = Torque.step(0.0)
