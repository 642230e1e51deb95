"""Accumulators whose piston rests on a spring."""

from math import inf, pi
from typing import Annotated, ClassVar, Literal

import numpy as np

from tline.scene.element import AtNode, optional, required
from tline.scene.law import Bend, ElementLaw, LawKind, OfLiquids, Shown, Volume
from tline.scene.quantity import Diameter, Length, Pressure, Quantity, Role

AT_STOP = 1e-9  # relative to the stroke


class SpringLoaded(LawKind):
    """Law of a spring accumulator; constants: effort beyond, capacitance, efforts of the spring at its two stops.

    The state is the effort of the spring.
    """

    name, unit = "spring", "stores.spring.spring"
    states = 1
    returns = steep = True

    def at_rest(self, c, effort, control):  # noqa: D102
        return (min(max(effort - c[0], c[2]), c[3]),)

    def capacity(self, c, effort):
        """Capacity between the stops."""
        return c[1]

    def bends(self, c, rho):
        """Kinks just before the piston meets a stop and just after it has left one."""
        _, _, first, last = c
        near = AT_STOP * (last - first if last < inf else abs(first))
        yield from (Bend(at) for at in (first + near, last - near) if abs(at) < inf)

    def volume(self, c):  # noqa: D102
        beyond, per_effort, first, last = c
        return Volume(lambda p: per_effort * (np.clip(p - beyond, first, last) - first), inf)


class SpringAccumulator(AtNode, OfLiquids):
    """Accumulator at a node: a piston on a spring with a preload.

    The piston begins to move where the gauge pressure exceeds the preload, and stops at the end of its stroke. It has
    neither mass nor friction, and at its stops nothing flows. A loss in front of it is an orifice between two nodes.
    """

    kind: Literal["spring accumulator"] = "spring accumulator"
    piston_diameter: Diameter = required("diameter of the piston")
    stiffness: Annotated[Quantity, Role("stiffness", "N/m", above=0)] = required("force of the spring over way")
    preload: Pressure = required("gauge pressure at which the piston begins to move")
    stroke: Length | None = optional("way of the piston; without it as long as it takes")
    shows = (
        Shown("travel", "m", lambda one, y, i: (y - one.preload) * pi / 4 * one.piston_diameter**2 / one.stiffness),
        Shown("inflow", "m^3/s", lambda one, y, i: i),
    )
    example: ClassVar[str] = """\
kind = "spring accumulator"
piston_diameter = "10 cm"
stiffness = 2e5           # N/m
preload = "4 bar"
"""

    def law(self) -> ElementLaw:  # noqa: D102
        area, preload = pi / 4 * float(self.piston_diameter) ** 2, float(self.preload)
        full = inf if self.stroke is None else preload + float(self.stiffness * self.stroke) / area
        return ElementLaw("spring", (0.0, area**2 / float(self.stiffness), preload, full))
