"""A matched source sends a sine down a lossless pipe to what stands at its other end, from a steady flow."""

from math import pi
from typing import Any, NamedTuple

import numpy as np
from one_line import one_line

import tline as tl


class MatchedSine(NamedTuple):
    """Ends of the pipe are a, where the source is, and b."""

    z0: float
    delay: float
    head: float
    swing: float
    rate: float
    t_end: float

    def scene(self, loads: dict[str, dict[str, Any]], **solver: float) -> tl.Scene:
        """With loads at b, where the probe is."""
        swing = {"shape": "sine", "offset": self.head, "amplitude": self.swing, "frequency": self.rate}
        loads, line = {name: {"at": "b"} | load for name, load in loads.items()}, {"z0": self.z0, "delay": self.delay}
        given = {
            "medium": "hydraulic",
            "start": "steady",
            "loads": loads,
            "solver": solver,
            "probes": {"b": {"at": "b"}},
        }
        return one_line(self.t_end, line, swing, self.z0, far="b", **given)

    def wave(self, t: float) -> float:
        """What arrives at b."""
        late = t - self.delay
        return self.head + self.swing * np.sin(2 * pi * self.rate * late) if late > 0 else self.head
