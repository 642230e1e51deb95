"""Waveforms: straight lines between points, pulses, sines, exponentials and surges."""

from collections.abc import Mapping, Sequence
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import PrivateAttr, TypeAdapter, ValidationInfo, model_validator

from tline.distinct import distinct
from tline.errors import InputError
from tline.scene.element import optional, pair, required
from tline.scene.mistakes import OneOf
from tline.scene.quantity import LEVEL, ZERO, Angle, Delay, Duration, Frequency, Level, Time, Whole
from tline.scene.shape import Constant, Floats, Shape, Step, Straight
from tline.scene.text_file import beside, read_rows

MOST_PULSES = 1_000_000


class Sine(Shape):
    """Sine: offset + amplitude·sin(2π·frequency·(t - at) + phase) from `at` to `until`; constant outside."""

    shape: Literal["sine"] = "sine"
    amplitude: Level = required("half of peak to peak")
    frequency: Frequency = required("cycles per second")
    phase: Angle = optional("angle at the begin", ZERO)
    offset: Level = optional("middle level", ZERO)
    at: Time = optional("begin; before it the level is offset + amplitude·sin(phase)", ZERO)
    until: Time | None = optional("end, where the level stays; without it there is none")

    @model_validator(mode="after")
    def _ends_after_it_begins(self):
        if self.until is not None and self.until <= self.at:
            raise InputError("until", "not after the begin", f"more than {self.at:g} s", f"{self.until:g} s")
        return self

    def breaks(self, t_end):  # noqa: D102
        return np.array([self.at] if self.until is None else [self.at, self.until], float)

    def value(self, t, inside):  # noqa: D102
        stop = np.inf if self.until is None else float(self.until)
        t = np.where(inside < self.at, float(self.at), np.where(inside > stop, stop, t))
        angle = 2 * np.pi * self.frequency * (t - self.at) + self.phase
        return self.offset + self.amplitude * np.sin(angle)

    def fastest(self):  # noqa: D102
        return 1 / (2 * np.pi * self.frequency)


class ModulatedSine(Shape):
    """Sine that decays, or whose frequency swings, from `at` on; constant before.

    offset + amplitude·e^(-τ/decay)·sin(2π·frequency·τ + phase + index·sin(2π·modulation·τ)) with τ = t - at.
    """

    shape: Literal["modulated sine"] = "modulated sine"
    amplitude: Level = required("half of peak to peak, at the begin")
    frequency: Frequency = required("cycles per second of the carrier")
    phase: Angle = optional("angle at the begin", ZERO)
    offset: Level = optional("middle level", ZERO)
    at: Time = optional("begin; before it the level is offset + amplitude·sin(phase)", ZERO)
    decay: Duration | None = optional("time constant of the amplitude; without it none decays")
    index: Angle = optional("largest deviation of the angle", ZERO)
    modulation: Frequency | None = optional("cycles per second of that deviation")

    @model_validator(mode="after")
    def _deviates_at_a_frequency(self):
        if (self.modulation is None) != (self.index == 0):
            raise InputError("modulation", "not given together with its index", "both, or neither of them")
        return self

    def breaks(self, t_end):  # noqa: D102
        return np.array([float(self.at)])

    def value(self, t, inside):  # noqa: D102
        elapsed = np.where(inside < self.at, 0.0, t - self.at)
        angle = 2 * np.pi * self.frequency * elapsed + self.phase
        if self.modulation is not None:
            angle = angle + self.index * np.sin(2 * np.pi * self.modulation * elapsed)
        falling = 1.0 if self.decay is None else np.exp(-elapsed / self.decay)
        return self.offset + self.amplitude * falling * np.sin(angle)

    def fastest(self):  # noqa: D102
        swing = self.frequency + abs(self.index) * (self.modulation or 0.0)
        return min(1 / (2 * np.pi * swing), float(self.decay or np.inf))


class Exponential(Shape):
    """Exponential: to + (from - to)·e^(-(t - at)/time_constant); `from` before it begins."""

    shape: Literal["exponential"] = "exponential"
    from_: Level = optional("level before", ZERO, alias="from")
    to: Level = required("level in the end")
    at: Time = optional("begin", ZERO)
    time_constant: Duration = required("time after which 1/e of the way is left")

    def breaks(self, t_end):  # noqa: D102
        return np.array([float(self.at)])

    def value(self, t, inside):  # noqa: D102
        elapsed = np.where(inside < self.at, 0.0, t - self.at)
        return self.from_ - (self.to - self.from_) * np.expm1(-elapsed / self.time_constant)

    def fastest(self):  # noqa: D102
        return float(self.time_constant)


class DoubleExponential(Shape):
    """Surge: peak·k·(e^(-(t - at)/decay) - e^(-(t - at)/rise)), with k so that the peak is reached; 0 before."""

    shape: Literal["double exponential"] = "double exponential"
    peak: Level = required("highest level")
    rise: Duration = required("time constant of the front")
    decay: Duration = required("time constant of the tail, longer than that of the front")
    at: Time = optional("begin", ZERO)

    @model_validator(mode="after")
    def _rises_first(self):
        if self.rise >= self.decay:
            raise InputError("rise", "must be the shorter time", f"less than {self.decay:g} s", f"{self.rise:g} s")
        return self

    def breaks(self, t_end):  # noqa: D102
        return np.array([float(self.at)])

    def value(self, t, inside):  # noqa: D102
        highest = self.rise * (self.decay / (self.decay - self.rise)) * np.log1p((self.decay - self.rise) / self.rise)
        elapsed = np.where(inside < self.at, 0.0, t - self.at)
        return self.peak / self._difference(highest) * self._difference(elapsed)

    def _difference(self, t: Floats) -> Floats:
        """Difference e^(-t/decay) - e^(-t/rise), accurate for small t and for nearly equal times."""
        return -np.exp(-t / self.decay) * np.expm1(-t / self.rise * ((self.decay - self.rise) / self.decay))

    def fastest(self):  # noqa: D102
        return float(self.rise)


class Points(Shape):
    """Straight lines between points; constant before the first and after the last."""

    _lines: Straight | None = PrivateAttr(default=None)  # made at the first use

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
        return self._lines.value(t, inside)


def lines(times: Floats, levels: Floats) -> Straight:
    """Straight lines between points in order of time."""
    span, slope = np.diff(times), np.zeros(len(times) + 1)
    np.divide(np.diff(levels), span, out=slope[1:-1], where=span > 0)
    return Straight(times, np.append(levels[0], levels), slope)


class Ramp(Points):
    """Straight rise or fall from one level to another."""

    shape: Literal["ramp"] = "ramp"
    from_: Level = optional("level before", ZERO, alias="from")
    to: Level = required("level after")
    at: Time = optional("begin of the ramp", ZERO)
    duration: Duration = required("time from level to level")

    def points(self):  # noqa: D102
        return np.array([self.at, self.at + self.duration]), np.array([self.from_, self.to], float)


class PiecewiseLinear(Points):
    """Straight lines between points [time, level], constant outside; two points at the same time make a jump."""

    shape: Literal["piecewise linear"] = "piecewise linear"
    points_: list[Annotated[tuple[Time, Level], pair("time, level")]] = required(
        "pairs [time, level], in order of time", alias="points", min_length=2
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
    file: str = required("CSV file, looked for beside the scene file")
    _points: tuple[tuple[float, ...], tuple[float, ...]] = PrivateAttr()

    @model_validator(mode="after")
    def _read(self, info: ValidationInfo):
        self._points = read_table(beside(self.file, info), "file")
        return self

    def points(self):  # noqa: D102
        times, levels = self._points
        return np.array(times), np.array(levels)

    def __eq__(self, other: object) -> bool:
        """Whether both have the same points."""
        return isinstance(other, Table) and self._points == other._points


def read_table(path: Path, where: str) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Read times and levels from a CSV file."""
    rows = read_rows(path, where, "a point", {2: "two finite numbers with a comma between"})
    if len(rows) < 2:
        raise InputError(where, f"too few points in '{path}'", "at least two lines 'time, level'", str(len(rows)))
    times, levels = zip(*rows, strict=True)
    check_order(times, where)
    return times, levels


def check_order(times: Sequence[float], where: str) -> None:
    """Raise an error if times decrease, or three are at one instant."""
    for k, (before, now) in enumerate(pairwise(times), 2):
        if now < before:
            raise InputError(where, f"point {k} lies before the one in front of it", "times in order", f"{now:g} s")
    for k, (first, third) in enumerate(zip(times, times[2:], strict=False), 3):
        if first == third:
            raise InputError(where, f"point {k} is the third at one time", "at most two, for a jump", f"{third:g} s")


class Pulses(Shape):
    """Equal pulses: one, or one per period, up to a count if given; trapezoids if rise or fall take time."""

    shape: Literal["pulses"] = "pulses"
    low: Level = optional("level between pulses, and outside", ZERO)
    high: Level = required("level of the pulse")
    at: Time = optional("begin of the first rise", ZERO)
    width: Duration = required("time at the high level, rise and fall not counted")
    rise: Delay = optional("time from low to high", ZERO)
    fall: Delay = optional("time from high to low", ZERO)
    period: Duration | None = optional("time from pulse to pulse; without it there is one")
    count: Annotated[int, Whole(1)] | None = optional("number of pulses; without it they do not end")

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
        return distinct(starts[:, None] + self._corners())

    def value(self, t, inside):  # noqa: D102
        start = float(self.at)
        if self.period is not None:
            last = np.inf if self.count is None else self.count - 1
            start = start + self.period * np.clip(np.floor((inside - start) / self.period), 0, last)
        levels = np.array([self.low, self.high, self.high, self.low], float)
        return lines(self._corners(), levels).value(t - start, inside - start)

    def _corners(self):
        """Instants of one pulse, from its begin: rise, top, fall, end."""
        return np.cumsum([0.0, self.rise, self.width, self.fall])


WAVEFORMS = (
    Constant, Step, Ramp, PiecewiseLinear, Table, Pulses, Sine, ModulatedSine, Exponential, DoubleExponential,
)  # fmt: skip
Waveform = Annotated[Shape, OneOf(WAVEFORMS, "shape")]


def read_waveform(value: Any, unit: str | None, info: ValidationInfo) -> Shape:
    """Read a waveform whose levels have that unit; a number or text is a constant."""
    if not isinstance(value, Mapping | Shape):
        return Constant(level=LEVEL.parse(value, unit))
    units = {} if unit is None else {LEVEL.name: unit}
    return _waveforms().validate_python(value, context={**(info.context or {}), "units": units})


@cache
def _waveforms() -> TypeAdapter[Shape]:
    return TypeAdapter(Waveform)
