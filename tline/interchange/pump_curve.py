"""Head of a pump over its flow, as EPANET draws it through points."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import log

import numpy as np

from tline.errors import InputError

SQUARE, STEPS = 2.0, 10  # parts of other power laws
NEAR = 0.25  # of a step: closer to the operating point than that no other is needed
Points = list[tuple[float, float]]


@dataclass(frozen=True)
class PowerLaw:
    """head = a - b·flow^c, in m and m³/s.

    Examples
    --------
    >>> law = PowerLaw(40.0, 1000.0, 2.0)
    >>> law.head(0.1), law.last
    (30.0, 0.2)
    """

    a: float
    b: float
    c: float

    def head(self, flow: float) -> float:
        """Head, m."""
        return self.a - self.b * flow**self.c

    @property
    def last(self) -> float:
        """Flow without head, m³/s."""
        return (self.a / self.b) ** (1 / self.c)

    def points(self, at: float) -> Points:
        """Points (flow, head), the one at a flow among them; two of a square law."""
        if self.c == SQUARE:
            return [(0.0, self.a), (self.last, 0.0)]
        step = max(self.last, 1.2 * at) / STEPS
        flows = {k * step for k in range(STEPS + 1) if abs(k * step - at) > NEAR * step} | {at}
        return [(flow, self.head(flow)) for flow in sorted(flows)]


@dataclass(frozen=True)
class Polyline:
    """Straight lines between points of rising flow, m³/s, and falling head, m; the outer ones go on.

    Examples
    --------
    >>> line = Polyline((0.0, 0.1, 0.2), (40.0, 35.0, 10.0))
    >>> round(line.head(0.15), 9)
    22.5
    """

    flows: tuple[float, ...]
    heads: tuple[float, ...]

    def head(self, flow: float) -> float:
        """Head, m."""
        k = int(np.clip(np.searchsorted(self.flows, flow) - 1, 0, len(self.flows) - 2))
        slope = (self.heads[k + 1] - self.heads[k]) / (self.flows[k + 1] - self.flows[k])
        return self.heads[k] + slope * (flow - self.flows[k])

    @property
    def last(self) -> float:
        """Largest flow, m³/s."""
        return self.flows[-1]

    def points(self, at: float) -> Points:
        """Its own points (flow, head), rest, middles between them, and the one at a flow."""
        own = sorted({0.0, *self.flows, max(self.last, 1.2 * at)})
        inner = [(one + two) / 2 for one, two in pairwise(own)]
        least = NEAR * min(two - one for one, two in pairwise(own))
        flows = {flow for flow in (*own, *inner) if abs(flow - at) > least} | {at}
        return [(flow, self.head(flow)) for flow in sorted(flows)]


def pump_curve(points: Sequence[tuple[float, float]]) -> PowerLaw | Polyline:
    """The curve through points (flow, head) in m³/s and m.

    One point (q, h) gives the law 4/3·h - h/3·(flow/q)²; three of which the first has no flow give a - b·flow^c;
    others are joined by straight lines.

    References
    ----------
    EPANET 2.2 User Manual, section 3.1, pumps.

    Examples
    --------
    >>> round(pump_curve([(0.1, 30.0)]).head(0.1), 9)
    30.0
    """
    points = sorted((float(q), float(h)) for q, h in points)
    flows, heads = tuple(q for q, _ in points), tuple(h for _, h in points)
    level = [one for one, two in pairwise(points) if two[0] <= one[0] or two[1] >= one[1]]
    if not points or level or flows[0] < 0 or heads[-1] < 0 or points == [(0.0, heads[0])]:
        got = ", ".join(f"({q:g}, {h:g})" for q, h in points[:8]) or "no points"
        raise InputError("", "its curve does not fall", "heads that fall as the flow rises", got)
    if len(points) == 1:
        q, h = points[0]
        return PowerLaw(4 / 3 * h, h / 3 / q**2, SQUARE)
    if len(points) == 3 and flows[0] == 0:
        a, one, two = heads
        c = log((a - two) / (a - one)) / log(flows[2] / flows[1])
        return PowerLaw(a, (a - one) / flows[1] ** c, c)
    return Polyline(flows, heads)
