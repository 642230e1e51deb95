"""Edges between the lossless parts of a network in the steady state: lossy lines, and elements without a state.

Flows through the elements of a network without a state, each behind an effort and its source impedance.

Lossy lines in a steady flow: drops along them, leakage from them, and efforts and flows inside.

Of its resistance r and conductance g per metre such a line of length l makes a π: R = Zc sinh γl between its ends and
G = tanh(γl/2)/Zc at each, with Zc = √(r/g) and γ = √(r g). Friction that depends on the flow adds its fall to R's.
"""

from collections.abc import Mapping
from copy import copy
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.compiled.structure import pack
from tline.loss.flow_law import side_by_side
from tline.solver.description.description import Description
from tline.solver.description.elements import PlacedLaw
from tline.solver.description.given import kinds_numbered
from tline.solver.description.groups import Group
from tline.solver.description.laws import laws_of, opened, units_of_laws
from tline.solver.description.lines import Line, distinct
from tline.solver.description.links import resistive
from tline.solver.kernel.network import Crossing, Laws
from tline.solver.kernel.network import Laws as Elements
from tline.solver.kernel.units import law_addresses
from tline.solver.steady.balance import EdgeLaws
from tline.solver.steady.pockets import held_drops
from tline.words.wording import place

NOTHING = 1e-11  # of the largest flow: smaller flows are rounding or leakage
NONE = np.empty(0)
TIGHT, TIGHTEST = 1e2, 1e12  # drop over flow of a valve, in impedances of its nodes


class Flows:
    """Laws of elements, packed once."""

    def __init__(self, laws: Laws):
        self._v, self._flow, self._slope = np.empty((3, len(laws.kind)))
        if not len(laws.kind):
            return
        from tline.solver.kernel.laws.through import Through, through

        crossing, law = Crossing(laws.constants, *np.empty((4, 1))), law_addresses(units_of_laws(laws))
        values = law, laws.at, laws.control, self._v, laws.source_impedance, self._flow, self._slope, crossing
        self._through, self._packed = through, pack(Through(*values))

    def __call__(self, v: NDArray) -> tuple[NDArray, NDArray]:
        """Flow through each element behind the efforts v, and its slope; each shape (E,)."""
        if len(v):
            self._v[:] = v
            self._through(self._packed)
        return self._flow.copy(), self._slope.copy()


Slopes = tuple[NDArray, NDArray, NDArray, NDArray]


def pi(line: Line) -> tuple[float, float]:
    """Resistance between the ends and conductance at each, to a steady flow, without flow-dependent friction."""
    if line.losses is None:
        return 0.0, 0.0
    exact = line.losses.exact
    r, g = exact.series.loss * exact.length, exact.shunt.loss * exact.length
    x = np.sqrt(r * g)
    return (r * np.sinh(x) / x, g * np.tanh(x / 2) / x) if x else (r, g / 2)


def falling(line: Line) -> bool:
    """Whether effort falls along a line in a steady flow."""
    return line.losses is not None and any(line.losses.steady_drop(1.0))


class Falls:
    """Drops along lines, over one unknown each: z0·y."""

    def __init__(self, lines: Mapping[str, Line]):
        first, like = distinct(lines.values())
        lengths = [line.losses.exact.length if line.losses else 0.0 for line in first]
        each = np.array([(line.z0, pi(line)[0], length) for line, length in zip(first, lengths, strict=True)])
        self.z0, self._resistance, self._length = each.reshape(-1, 3)[like].T
        self._laws = side_by_side([line.losses.flow_law if line.losses else None for line in first], like)

    def solved(self, a: NDArray) -> Slopes:
        """Falls and flows, and their slopes over a."""
        if not len(a):
            return a, a, a, a
        y, dy = a / self.z0, 1 / self.z0
        fall, slope = self._resistance * y, self._resistance * dy
        for here, law in self._laws:
            drop, steep = law(np.abs(y[here]))
            fall[here] += np.sign(y[here]) * drop * self._length[here]
            slope[here] += steep * self._length[here] * dy[here]
        return fall, y, slope, dy


class Ends(NamedTuple):
    """A line in a steady flow: efforts, and flows from end 1 to end 2."""

    line: Line
    u: NDArray  # (2,)
    y: NDArray  # (2,)

    def at(self, part: NDArray) -> tuple[NDArray, NDArray]:
        """Effort and flow times z0 at parts of its length."""
        (u1, u2), (y1, y2) = self.u, self.y
        losses, z0 = self.line.losses, self.line.z0
        assert losses is not None
        x = losses.attenuation
        if not x:
            return u1 + part * (u2 - u1), z0 * (y1 + part * (y2 - y1))
        Zc = np.sqrt(losses.exact.series.loss / losses.exact.shunt.loss)
        u = (u1 * np.sinh(x * (1 - part)) + u2 * np.sinh(x * part)) / np.sinh(x)
        y = (u1 * np.cosh(x * (1 - part)) - u2 * np.cosh(x * part)) / (Zc * np.sinh(x))
        return u, z0 * y


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
        """Return the laws between the parts of the nodes, for efforts up to the largest."""
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
    """Elements without a state, and resistive ones, which pass a steady flow in proportion to the effort."""
    return [_running(element) for element in description.elements if not element.kind.fills] + resistive(
        description.scene, description.nodes
    )


def _running(element: PlacedLaw) -> PlacedLaw:
    return element._replace(law=element.law._replace(kind=element.kind.steady or element.law.kind))
