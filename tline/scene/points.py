"""Waveforms made of straight pieces: between points (time, level), and pulses, one or many."""

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Literal, NamedTuple

import numpy as np
from pydantic import Field, PrivateAttr, ValidationInfo, model_validator

from tline.errors import InputError
from tline.scene.element import pair
from tline.scene.quantity import ZERO, Delay, Duration, Level, Time, Whole
from tline.scene.shape import Floats, Shape
from tline.scene.text_file import beside, read_rows


class Lines(NamedTuple):
    """Straight lines between points, constant before the first and after the last."""

    times: Floats  # (points,)
    begin: Floats  # (points + 1,) where each line begins; of the first its end
    level: Floats  # (points + 1,) there
    slope: Floats  # (points + 1,)


class Points(Shape):
    """Straight lines between points; constant before the first and after the last."""

    _lines: Lines | None = PrivateAttr(default=None)  # made at the first use

    def points(self) -> tuple[Floats, Floats]:
        """Times, not decreasing (two equal ones make a jump), and levels."""
        raise NotImplementedError

    def breaks(self, t_end):  # noqa: D102
        times, _ = self.points()
        kept = np.ones(len(times), bool)
        np.greater(times[1:], times[:-1], out=kept[1:])
        return times[kept]

    def value(self, t, inside):  # noqa: D102
        self._lines = self._lines or lines(*self.points())
        return between(self._lines, t, inside)


def lines(times: Floats, levels: Floats) -> Lines:
    """Straight lines between points in order of time."""
    begin = np.maximum(np.arange(len(times) + 1) - 1, 0)
    span, slope = np.diff(times), np.zeros(len(times) + 1)
    np.divide(np.diff(levels), span, out=slope[1:-1], where=span > 0)
    return Lines(times, times[begin], levels[begin], slope)


def between(lines: Lines, t: Floats, inside: Floats) -> Floats:
    """Level at t of the straight piece that contains `inside`, continued."""
    piece = np.searchsorted(lines.times, inside)
    return lines.level[piece] + lines.slope[piece] * (t - lines.begin[piece])


class Ramp(Points):
    """A straight rise or fall from one level to another."""

    shape: Literal["ramp"] = "ramp"
    from_: Level = Field(default=ZERO, alias="from", description="level before")
    to: Level = Field(description="level after")
    at: Time = Field(default=ZERO, description="begin of the ramp")
    duration: Duration = Field(description="time from level to level")

    def points(self):  # noqa: D102
        return np.array([self.at, self.at + self.duration]), np.array([self.from_, self.to], float)


class PiecewiseLinear(Points):
    """Straight lines between points [time, level], constant outside; two points at the same time make a jump."""

    shape: Literal["piecewise linear"] = "piecewise linear"
    points_: list[Annotated[tuple[Time, Level], pair("time, level")]] = Field(
        alias="points", min_length=2, description="pairs [time, level], in order of time"
    )

    @model_validator(mode="after")
    def _in_order(self):
        check_order([float(t) for t, _ in self.points_], "points")
        return self

    def points(self):  # noqa: D102
        times, levels = zip(*self.points_, strict=True)
        return np.array(times, float), np.array(levels, float)


class Table(Points):
    """Points from a CSV file with two columns, time and level, in SI; a first line of words is skipped."""

    shape: Literal["table"] = "table"
    file: str = Field(description="CSV file, looked for beside the scene file")
    _points: tuple[tuple[float, ...], tuple[float, ...]] = PrivateAttr()

    @model_validator(mode="after")
    def _read(self, info: ValidationInfo):
        self._points = read_table(beside(self.file, info), "file")
        return self

    def points(self):  # noqa: D102
        times, levels = self._points
        return np.array(times), np.array(levels)

    def __eq__(self, other: object) -> bool:
        """Whether the same was read."""
        return isinstance(other, Table) and self._points == other._points


def read_table(path: Path, where: str) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Times and levels from a CSV file.

    Parameters
    ----------
    path : Path
        Two numbers a line with a comma between; empty lines and lines that begin with # are skipped.
    where : str
        What an error points at.
    """
    rows = read_rows(path, where, "a point", {2: "two finite numbers with a comma between"})
    if len(rows) < 2:
        raise InputError(where, f"too few points in '{path}'", "at least two lines 'time, level'", str(len(rows)))
    times, levels = zip(*rows, strict=True)
    check_order(times, where)
    return times, levels


def check_order(times: Sequence[float], where: str) -> None:
    """Refuse times that decrease, or three at one instant."""
    for k, (before, now) in enumerate(pairwise(times), 2):
        if now < before:
            raise InputError(where, f"point {k} lies before the one in front of it", "times in order", f"{now:g} s")
    for k, (first, third) in enumerate(zip(times, times[2:], strict=False), 3):
        if first == third:
            raise InputError(where, f"point {k} is the third at one time", "at most two, for a jump", f"{third:g} s")


MOST_PULSES = 1_000_000


class Pulses(Shape):
    """Equal pulses: one, or one each period, up to a count if there is one; trapezoids if rise or fall take time."""

    shape: Literal["pulses"] = "pulses"
    low: Level = Field(default=ZERO, description="level between pulses, and outside")
    high: Level = Field(description="level of the pulse")
    at: Time = Field(default=ZERO, description="begin of the first rise")
    width: Duration = Field(description="time at the high level, rise and fall not counted")
    rise: Delay = Field(default=ZERO, description="time from low to high")
    fall: Delay = Field(default=ZERO, description="time from high to low")
    period: Duration | None = Field(default=None, description="time from pulse to pulse; without it there is one")
    count: Annotated[int, Whole(1)] | None = Field(
        default=None, description="number of pulses; without it they do not end"
    )

    @model_validator(mode="after")
    def _fits(self):
        busy = self.rise + self.width + self.fall
        if self.period is not None and self.period < busy * (1 - 1e-12):
            raise InputError("period", "shorter than the pulse", f"at least {busy:g} s", f"{self.period:g} s")
        if self.count is not None and self.period is None:
            raise InputError("count", "pulses are counted only where they repeat", "a period")
        return self

    def breaks(self, t_end):  # noqa: D102
        period, count = self.period or np.inf, self.count or np.inf
        first = max(min(np.floor(-self.at / period), count) - 1, 0.0)
        last = min(max(np.ceil((t_end - self.at) / period), 1.0), count)
        if last - first > MOST_PULSES:
            expected, got = f"at most {MOST_PULSES:,}", f"{last - first:.3g}"
            raise InputError("period", "too many pulses before the end", expected, got)
        starts = self.at + (self.period or 0.0) * np.arange(first, last)
        return np.unique(starts[:, None] + self._corners())

    def value(self, t, inside):  # noqa: D102
        start = float(self.at)
        if self.period is not None:
            last = np.inf if self.count is None else self.count - 1
            start = start + self.period * np.clip(np.floor((inside - start) / self.period), 0, last)
        levels = np.array([self.low, self.high, self.high, self.low], float)
        return between(lines(self._corners(), levels), t - start, inside - start)

    def _corners(self):
        """Instants of one pulse, from its begin: rise, top, fall, end."""
        return np.cumsum([0.0, self.rise, self.width, self.fall])
