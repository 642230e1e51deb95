"""Waveforms of sources: smooth pieces between breaks.

A waveform is evaluated at instants t *as seen from* an instant inside one of its smooth pieces, so that a jump has two
sides and rounding never picks the wrong one. ``breaks`` lists the jumps and corners.
"""

import csv
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, PrivateAttr, ValidationInfo, model_serializer, model_validator

from tline.errors import InputError
from tline.scene.element import Element
from tline.scene.quantity import ZERO, Angle, Duration, Frequency, Level, Time

Floats = NDArray
MOST_BREAKS = 10**7


class Shape(Element):
    """What all waveforms share."""

    def breaks(self, t_end: float) -> Floats:
        """Instants before t_end at which the waveform jumps or has a corner, sorted."""
        raise NotImplementedError

    def value(self, t: Floats, inside: Floats) -> Floats:
        """Value at t of the smooth piece that contains `inside`; shapes broadcast."""
        raise NotImplementedError

    def fastest(self) -> float:
        """Shortest time scale of the smooth pieces, s (infinite if they are polynomials of low degree)."""
        return np.inf


class Constant(Shape):
    """The same value for ever; in a scene file the plain number or text."""

    shape: Literal["constant"] = "constant"
    level: Level

    @model_serializer
    def _plain(self) -> float | str:
        return self.level.typed

    def breaks(self, t_end):  # noqa: D102
        return np.empty(0)

    def value(self, t, inside):  # noqa: D102
        return np.full(np.broadcast_shapes(t.shape, inside.shape), float(self.level))


class Step(Shape):
    """A jump from one level to another."""

    shape: Literal["step"] = "step"
    from_: Level = Field(default=ZERO, alias="from")
    to: Level
    at: Time = ZERO

    def breaks(self, t_end):  # noqa: D102
        return np.array([float(self.at)])

    def value(self, t, inside):  # noqa: D102
        return np.where(inside < self.at, float(self.from_), float(self.to)) + 0.0 * t


class Points(Shape):
    """Straight lines between points (time, level); constant before the first and after the last."""

    def points(self) -> tuple[Floats, Floats]:
        """Times, not decreasing (two equal ones make a jump), and levels."""
        raise NotImplementedError

    def breaks(self, t_end):  # noqa: D102
        return np.unique(self.points()[0])

    def value(self, t, inside):  # noqa: D102
        times, levels = self.points()
        k = np.searchsorted(times, inside)
        low, high = np.maximum(k - 1, 0), np.minimum(k, len(times) - 1)
        span = times[high] - times[low]
        slope = np.divide(levels[high] - levels[low], span, out=np.zeros_like(span), where=span > 0)
        return levels[low] + slope * (t - times[low])


class Ramp(Points):
    """A straight rise or fall from one level to another."""

    shape: Literal["ramp"] = "ramp"
    from_: Level = Field(default=ZERO, alias="from")
    to: Level
    at: Time = ZERO
    duration: Duration

    def points(self):  # noqa: D102
        return np.array([self.at, self.at + self.duration]), np.array([self.from_, self.to], float)


class PiecewiseLinear(Points):
    """Points given in the scene; two at the same time make a jump."""

    shape: Literal["piecewise linear"] = "piecewise linear"
    points_: list[tuple[Time, Level]] = Field(alias="points", min_length=2)

    @model_validator(mode="after")
    def _in_order(self):
        _check_order([float(t) for t, _ in self.points_], "points")
        return self

    def points(self):  # noqa: D102
        times, levels = zip(*self.points_, strict=True)
        return np.array(times, float), np.array(levels, float)


class Table(Points):
    """Points from a CSV file with two columns, time and level, in SI; a first line of words is skipped."""

    shape: Literal["table"] = "table"
    file: str
    _points: tuple[Floats, Floats] = PrivateAttr()

    @model_validator(mode="after")
    def _read(self, info: ValidationInfo):
        path = Path((info.context or {}).get("folder", ".")) / self.file
        self._points = read_table(path)
        return self

    def points(self):  # noqa: D102
        return self._points


class Pulses(Points):
    """A train of equal pulses; trapezoids if rise or fall take time."""

    shape: Literal["pulses"] = "pulses"
    low: Level = ZERO
    high: Level
    at: Time = ZERO
    width: Duration
    rise: Time = ZERO
    fall: Time = ZERO
    period: Duration | None = None
    count: int | None = Field(default=None, ge=1)

    @model_validator(mode="after")
    def _fits(self):
        if self.rise < 0 or self.fall < 0:
            raise InputError("", "rise and fall take time", "zero or more", f"{self.rise:g} s and {self.fall:g} s")
        busy = self.rise + self.width + self.fall
        if self.period is not None and self.period < busy:
            raise InputError("period", "shorter than the pulse", f"at least {busy:g} s", f"{self.period:g} s")
        return self

    def _one(self) -> Floats:
        return np.cumsum([0.0, self.rise, self.width, self.fall])

    def breaks(self, t_end):  # noqa: D102
        if self.period is None:
            return np.unique(self.at + self._one())
        count = max(np.ceil((t_end - self.at) / self.period), 1)
        count = count if self.count is None else min(self.count, count)
        if count > MOST_BREAKS:
            raise InputError("period", "too many pulses before the end", f"at most {MOST_BREAKS}", f"{count:.3g}")
        starts = self.at + float(self.period) * np.arange(count)
        return np.unique(starts[:, None] + self._one())

    def value(self, t, inside):  # noqa: D102
        period = np.inf if self.period is None else float(self.period)
        k = np.zeros_like(inside) if np.isinf(period) else np.floor((inside - self.at) / period)
        k = np.clip(k, 0, 0 if np.isinf(period) else (np.inf if self.count is None else self.count - 1))
        start = self.at + (0.0 if np.isinf(period) else k * period)
        up, top, down, end = (start + offset for offset in self._one())
        rising = (t - up) / (self.rise or 1.0)
        falling = (end - t) / (self.fall or 1.0)
        part = np.select(
            [inside < up, inside < top, inside < down, inside < end],
            [0.0 * t, rising, 1.0 + 0.0 * t, falling],
            0.0,
        )
        return self.low + (self.high - self.low) * part


class Sine(Shape):
    """offset + amplitude·sin(2π·frequency·(t - at) + phase) between `at` and `until`, its value at `at` before."""

    shape: Literal["sine"] = "sine"
    amplitude: Level
    frequency: Frequency
    phase: Angle = ZERO
    offset: Level = ZERO
    at: Time = ZERO
    until: Time | None = None

    def breaks(self, t_end):  # noqa: D102
        return np.array([self.at] if self.until is None else [self.at, self.until], float)

    def value(self, t, inside):  # noqa: D102
        stop = np.inf if self.until is None else float(self.until)
        t = np.where(inside < self.at, float(self.at), np.where(inside > stop, stop, t))
        angle = 2 * np.pi * self.frequency * (t - self.at) + self.phase
        return self.offset + self.amplitude * np.sin(angle)

    def fastest(self):  # noqa: D102
        return 1 / (2 * np.pi * self.frequency)


class Exponential(Shape):
    """From one level towards another with a time constant."""

    shape: Literal["exponential"] = "exponential"
    from_: Level = Field(default=ZERO, alias="from")
    to: Level
    at: Time = ZERO
    time_constant: Duration

    def breaks(self, t_end):  # noqa: D102
        return np.array([float(self.at)])

    def value(self, t, inside):  # noqa: D102
        elapsed = np.where(inside < self.at, 0.0, t - self.at)
        return self.from_ - (self.to - self.from_) * np.expm1(-elapsed / self.time_constant)

    def fastest(self):  # noqa: D102
        return float(self.time_constant)


class DoubleExponential(Shape):
    """A surge: peak·k·(e^(-t/decay) - e^(-t/rise)), with k so that the peak is reached."""

    shape: Literal["double exponential"] = "double exponential"
    peak: Level
    rise: Duration
    decay: Duration
    at: Time = ZERO

    @model_validator(mode="after")
    def _rises_first(self):
        if self.rise >= self.decay:
            raise InputError("rise", "must be the shorter time", f"less than {self.decay:g} s", f"{self.rise:g} s")
        return self

    def breaks(self, t_end):  # noqa: D102
        return np.array([float(self.at)])

    def value(self, t, inside):  # noqa: D102
        top = np.log(self.decay / self.rise) * self.rise * self.decay / (self.decay - self.rise)
        scale = self.peak / (np.exp(-top / self.decay) - np.exp(-top / self.rise))
        elapsed = np.where(inside < self.at, 0.0, t - self.at)
        return scale * (np.exp(-elapsed / self.decay) - np.exp(-elapsed / self.rise))

    def fastest(self):  # noqa: D102
        return float(self.rise)


Waveform = Annotated[
    Constant | Step | Ramp | PiecewiseLinear | Table | Pulses | Sine | Exponential | DoubleExponential,
    Field(discriminator="shape"),
]


def read_table(path: Path) -> tuple[Floats, Floats]:
    """Times and levels from a CSV file.

    Raises
    ------
    InputError
        The file cannot be read, a line is not two finite numbers, or the times are not in order.
    """
    rows = []
    try:
        with path.open(newline="", encoding="utf-8") as file:
            for number, row in enumerate(csv.reader(file), 1):
                if not row or row[0].lstrip().startswith("#"):
                    continue
                try:
                    time, level = (float(cell) for cell in row)
                    if not np.isfinite(time + level):
                        raise ValueError
                    rows.append((time, level))
                except ValueError:
                    if rows or number > 1:
                        raise InputError(
                            f"{path}, line {number}", "not a point", "two finite numbers", repr(row)
                        ) from None
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InputError(str(path), f"cannot be read: {error}") from None
    if len(rows) < 2:
        raise InputError(str(path), "too few points", "at least two lines 'time, level'", str(len(rows)))
    times, values = np.array(rows).T
    _check_order(times, str(path))
    return times, values


def _check_order(times, where: str) -> None:
    for k in range(1, len(times)):
        if times[k] < times[k - 1]:
            raise InputError(
                where, f"time {k + 1} lies before the one in front of it", "times in order", f"{times[k]:g} s"
            )
