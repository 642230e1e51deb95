"""A matched source sends a sine down a lossless pipe to what stands at its other end, from a steady flow."""

from math import pi
from typing import Any, NamedTuple

import numpy as np

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
        return tl.Scene(
            medium="hydraulic",
            t_end=self.t_end,
            start="steady",
            lines={"pipe": {"nodes": ["a", "b"], "z0": self.z0, "delay": self.delay}},
            sources={"s": {"at": "a", "kind": "pressure", "value": swing, "resistance": self.z0}},
            loads={name: {"at": "b"} | load for name, load in loads.items()},
            probes={"b": {"at": "b"}},
            solver=solver,
        )

    def wave(self, t: float) -> float:
        """What arrives at b."""
        late = t - self.delay
        return self.head + self.swing * np.sin(2 * pi * self.rate * late) if late > 0 else self.head
