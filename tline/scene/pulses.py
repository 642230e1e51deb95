"""A waveform of pulses, one or many."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from tline.errors import InputError
from tline.scene.points import between, lines
from tline.scene.quantity import ZERO, Delay, Duration, Level, Time, Whole
from tline.scene.shape import Shape

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
