"""Waveforms that are curved: sines, exponential, surge."""

from typing import Literal

import numpy as np
from pydantic import Field, model_validator

from tline.errors import InputError
from tline.scene.quantity import ZERO, Angle, Duration, Frequency, Level, Time
from tline.scene.shape import Floats, Shape


class Sine(Shape):
    """offset + amplitude·sin(2π·frequency·(t - at) + phase) from `at` to `until`; outside, what it is at that end."""

    shape: Literal["sine"] = "sine"
    amplitude: Level = Field(description="half of peak to peak")
    frequency: Frequency = Field(description="cycles per second")
    phase: Angle = Field(default=ZERO, description="angle at the begin")
    offset: Level = Field(default=ZERO, description="middle level")
    at: Time = Field(default=ZERO, description="begin; before it the level is offset + amplitude·sin(phase)")
    until: Time | None = Field(default=None, description="end, where the level stays; without it there is none")

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
    """A sine that decays, or whose frequency swings, from `at` on; what it is there before.

    offset + amplitude·e^(-τ/decay)·sin(2π·frequency·τ + phase + index·sin(2π·modulation·τ)) with τ = t - at.
    """

    shape: Literal["modulated sine"] = "modulated sine"
    amplitude: Level = Field(description="half of peak to peak, at the begin")
    frequency: Frequency = Field(description="cycles per second of the carrier")
    phase: Angle = Field(default=ZERO, description="angle at the begin")
    offset: Level = Field(default=ZERO, description="middle level")
    at: Time = Field(default=ZERO, description="begin; before it the level is offset + amplitude·sin(phase)")
    decay: Duration | None = Field(default=None, description="time constant of the amplitude; without it none decays")
    index: Angle = Field(default=ZERO, description="largest deviation of the angle")
    modulation: Frequency | None = Field(default=None, description="cycles per second of that deviation")

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
    """to + (from - to)·e^(-(t - at)/time_constant); `from` before it begins."""

    shape: Literal["exponential"] = "exponential"
    from_: Level = Field(default=ZERO, alias="from", description="level before")
    to: Level = Field(description="level in the end")
    at: Time = Field(default=ZERO, description="begin")
    time_constant: Duration = Field(description="time after which 1/e of the way is left")

    def breaks(self, t_end):  # noqa: D102
        return np.array([float(self.at)])

    def value(self, t, inside):  # noqa: D102
        elapsed = np.where(inside < self.at, 0.0, t - self.at)
        return self.from_ - (self.to - self.from_) * np.expm1(-elapsed / self.time_constant)

    def fastest(self):  # noqa: D102
        return float(self.time_constant)


class DoubleExponential(Shape):
    """A surge: peak·k·(e^(-(t - at)/decay) - e^(-(t - at)/rise)), with k so that the peak is reached; 0 before."""

    shape: Literal["double exponential"] = "double exponential"
    peak: Level = Field(description="highest level")
    rise: Duration = Field(description="time constant of the front")
    decay: Duration = Field(description="time constant of the tail, longer than that of the front")
    at: Time = Field(default=ZERO, description="begin")

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
        """e^(-t/decay) - e^(-t/rise), accurate for small t and for nearly equal times."""
        return -np.exp(-t / self.decay) * np.expm1(-t / self.rise * ((self.decay - self.rise) / self.decay))

    def fastest(self):  # noqa: D102
        return float(self.rise)
