"""Switches and valves that move at an instant, as laws: a conductance, whose control signal jumps."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.scene.switch import Switch
from tline.solver.description.description import Description
from tline.solver.description.elements import PlacedLaw
from tline.solver.description.excitation import just_before
from tline.solver.description.given import ElementLaw
from tline.words.wording import place

SHORT = 1e-10  # of the impedance that a switch sees: the resistance of one that has none
LINEAR = (0.0, 3.0, -1.0, 0.0, 1.0, -1.0, 0.0, 1.0)  # constants of the table i = e


class Moving(NamedTuple):
    """A conductance that jumps at an instant, as a waveform."""

    before: float
    after: float
    instant: float

    def breaks(self, t_end: float) -> NDArray:
        """The instant, s."""
        return np.array([self.instant]) if self.instant < t_end else np.empty(0)

    def value(self, t: NDArray, inside: NDArray) -> NDArray:
        """Conductance at t, of the piece that contains `inside`."""
        return np.where(inside < self.instant, self.before, self.after) + 0.0 * t

    def fastest(self) -> float:
        """No time scale."""
        return np.inf


def switches_of(description: Description) -> Iterator[PlacedLaw]:
    """Switches of a scene at nodes whose effort is not held."""
    for at, one in description.scene.placed:
        if not isinstance(one, Switch):
            continue
        ends = one.terminals
        free = [node for node in ends if node is not None and description.nodes[node].held is None]
        if free:
            impedance = max(1 / description.nodes[node].total for node in free)
            before, after = (1 / max(float(r), SHORT * impedance) for r in (one.before, one.after))
            moving = Moving(before, after, float(one.time))
            law = ElementLaw("table", LINEAR, moving)  # type: ignore[arg-type]
            level = description.nodes[free[0]].above_level if ends[1] is None else 0.0
            yield PlacedLaw(place(*at), law, *ends, above_level=level, control=just_before(moving))
