"""Waveforms made of straight pieces between points (time, level)."""

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from pydantic import BeforeValidator, Field, PrivateAttr, ValidationInfo, model_validator

from tline.errors import InputError
from tline.scene.csv_rows import read_rows
from tline.scene.named_file import beside
from tline.scene.quantity import ZERO, Duration, Level, Time
from tline.scene.shape import Floats, Shape
from tline.words.wording import shown


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


def _pair(point: Any) -> Any:
    if not isinstance(point, list | tuple) or len(point) != 2:
        raise InputError("", "not a point", "a pair [time, level]", shown(point))
    return point


class PiecewiseLinear(Points):
    """Straight lines between points [time, level], constant outside; two points at the same time make a jump."""

    shape: Literal["piecewise linear"] = "piecewise linear"
    points_: list[Annotated[tuple[Time, Level], BeforeValidator(_pair)]] = Field(
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
