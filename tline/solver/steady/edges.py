"""What lies between the lossless parts of a network in the steady state: lossy lines, and elements without a state."""

from collections.abc import Mapping
from copy import copy

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.description import Description
from tline.solver.description.elements import PlacedLaw
from tline.solver.description.given import kinds_numbered
from tline.solver.description.groups import Group
from tline.solver.description.laws import laws_of, opened
from tline.solver.kernel.network import Laws as Elements
from tline.solver.steady.balance import EdgeLaws
from tline.solver.steady.flows import Flows
from tline.solver.steady.lossy_lines import Falls
from tline.solver.steady.pockets import held_drops
from tline.words.wording import place

NOTHING = 1e-11  # of the largest flow: so little passes where it is rounded or leaks
NONE = np.empty(0)
TIGHT, TIGHTEST = 1e2, 1e12  # drop over flow of a valve, in impedances of its nodes


class Edges:
    """Lossy lines first, then elements."""

    def __init__(
        self,
        description: Description,
        number: Mapping[str, int],
        openings: Mapping[str, float],
        falls: NDArray,
    ):
        each = zip(description.lines.items(), falls.tolist(), strict=True)
        lines = {name: line for (name, line), kept in each if kept}
        self.falls = Falls(lines)
        self.elements = _standing(description)
        self.where = [place("lines", name) for name in lines] + [element.where for element in self.elements]
        pairs = [line.nodes for line in lines.values()] + [
            (element.from_node, element.to_node) for element in self.elements
        ]
        ends = [[-1 if node is None else number[node] for node in pair] for pair in pairs]
        self.from_node, self.to_node = np.array(ends, int).reshape(-1, 2).T
        nodes = description.nodes
        impedances = [element.seen(nodes) for element in self.elements]
        packed, _ = laws_of([Group([*nodes.values()], [], self.elements, [])], impedances, 0, 0)
        self.seen, self.constants = packed.source_impedance, [element.constants for element in self.elements]
        self.packed = opened(packed, self.elements, openings)

    def like(self, description: Description, openings: Mapping[str, float]) -> "Edges | None":
        """Edges with other numbers in their laws; None where the laws of a description are others."""
        elements, found = _standing(description), copy(self)
        constants = [element.constants for element in elements]
        before, after = (
            [(e.where, e.kind, e.from_node, e.to_node, len(c)) for e, c in zip(each, numbers, strict=True)]
            for each, numbers in ((self.elements, self.constants), (elements, constants))
        )
        if before != after:
            return None
        controls = np.array([element.control for element in elements], float)
        packed = self.packed._replace(
            constants=np.concatenate([NONE, *constants]), control=controls, source_impedance=self.seen
        )
        found.elements, found.constants, found.packed = elements, constants, opened(packed, elements, openings)
        return found

    @property
    def count(self) -> int:
        """Lines and elements."""
        return len(self.where)

    def out_of_nodes(self, flow: NDArray, n: int) -> NDArray:
        """Flow out of each of n nodes into the edges."""
        out = np.zeros(n + 1)
        np.add.at(out, self.from_node, flow)
        np.add.at(out, self.to_node, -flow)
        return out[:-1]

    def laws(self, part: NDArray, largest: float) -> EdgeLaws:
        """The same between the parts that the nodes are in, where efforts are no larger than that."""
        ends = np.append(part, -1)
        self.packed = self.packed._replace(source_impedance=_steep(self.packed, largest))
        self._flows = Flows(self.packed)
        return EdgeLaws(
            ends[self.from_node],
            ends[self.to_node],
            np.concatenate([self.falls.z0, self.packed.source_impedance]),
            self.solved,
        )

    def holding(
        self, part: NDArray, flow: NDArray, scale: float
    ) -> tuple[tuple[NDArray, NDArray], NDArray, tuple[NDArray, NDArray]]:
        """Ends of edges, which of them pass flow or would, and drops between which they hold: for `pockets.settled`."""
        ends, none = np.append(part, -1), np.zeros(len(self.falls.z0))
        low, high = (np.concatenate([none, drops]) for drops in held_drops(self.packed))
        passing = (low == high) | (np.abs(flow) > NOTHING * scale)
        return (ends[self.from_node], ends[self.to_node]), passing, (low, high)

    def solved(self, a: NDArray) -> tuple[NDArray, NDArray, NDArray, NDArray]:
        """Drops and flows, and their slopes over the efforts a behind the impedances."""
        count = len(self.falls.z0)
        fall, y, steep, dy = self.falls.solved(a[:count])
        flow, slope = self._flows(a[count:])
        source_impedance = self.packed.source_impedance
        return (
            np.concatenate([fall, a[count:] - source_impedance * flow]),
            np.concatenate([y, flow]),
            np.concatenate([steep, 1 - source_impedance * slope]),
            np.concatenate([dy, slope]),
        )


def _steep(elements: Elements, largest: float) -> NDArray:
    """Impedance of each element: that of its nodes, or drop over flow of one so tight that its root is a jump."""
    source_impedance = elements.source_impedance.copy()
    for e, kind in enumerate(kinds_numbered(elements.kind.tolist())):
        constants, control = elements.constants[elements.at[e] :], max(float(elements.control[e]), 0.0)
        drop_over_flow = kind.tightness(constants, control, largest)
        if drop_over_flow > TIGHT * source_impedance[e]:
            source_impedance[e] = min(drop_over_flow, TIGHTEST * source_impedance[e])
    return source_impedance


def _standing(description: Description) -> list[PlacedLaw]:
    """Elements without a state, and what passes a steady flow in proportion to the effort."""
    return [_running(element) for element in description.elements if not element.kind.fills] + description.resistive


def _running(element: PlacedLaw) -> PlacedLaw:
    """An element as it is while nothing changes."""
    return element._replace(law=element.law._replace(kind=element.kind.steady or element.law.kind))
