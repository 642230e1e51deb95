"""Edges between the lossless parts of a network in the steady state: lossy lines, and elements without a state.

Each element is behind an effort and its source impedance; openings that it moves by itself are those at which it does
not. Lossy lines drop effort along them and leak.

Of its resistance r and conductance g per metre such a line of length l makes a π: R = Zc sinh γl between its ends and
G = tanh(γl/2)/Zc at each, with Zc = √(r/g) and γ = √(r g). Friction that depends on the flow adds its fall to R's.
"""

from collections.abc import Callable, Mapping, Sequence
from copy import copy
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.compiled.structure import pack
from tline.errors import InputError
from tline.solver.description.description import Description
from tline.solver.description.elements import PlacedLaw, resistive
from tline.solver.description.given import kinds_numbered
from tline.solver.description.groups import Group
from tline.solver.description.laws import laws_of, opened, units_of_laws
from tline.solver.description.lines import Columns, Line
from tline.solver.kernel.network import Crossing, Laws
from tline.solver.kernel.units import law_addresses
from tline.solver.steady.balance import EdgeLaws
from tline.solver.steady.pockets import held_drops
from tline.words.wording import place

if TYPE_CHECKING:
    from tline.solver.steady.steady_state import Before


NOTHING = 1e-11  # of the largest flow: smaller flows are rounding or leakage
TIGHT, TIGHTEST = 1e2, 1e12  # drop over flow of a valve, in impedances of its nodes
REGULATOR, DISC = 0.3, 1.0  # start of the search
SHUT = 1e-7  # a smaller opening is shut
STEPS, LONGEST = 60, 1.5  # of Newton's method, for the logarithm of an opening
DIFFERENCE = 1e-6  # of the logarithm, for slopes
SETTLED, ROUNDED = 1e-13, 1e-8  # of a step; below the second one it need not become shorter


class Flows:
    """Laws of elements, packed once."""

    def __init__(self, laws: Laws):
        self._v, self._flow, self._slope = np.empty((3, len(laws.kind)))
        if not len(laws.kind):
            return
        from tline.solver.kernel.laws.crossing import Through, through

        crossing, law = Crossing(laws.constants, *np.empty((4, 1))), law_addresses(units_of_laws(laws))
        values = law, laws.at, laws.control, self._v, laws.source_impedance, self._flow, self._slope, crossing
        self._through, self._packed = through, pack(Through(*values))

    def __call__(self, v: NDArray) -> tuple[NDArray, NDArray]:
        """Flow through each element behind the efforts v, and its slope; each shape (E,)."""
        if len(v):
            self._v[:] = v
            self._through(self._packed)
        return self._flow.copy(), self._slope.copy()


Slopes = tuple[NDArray, ...]  # drops and flows, and those of both over a


class Falls:
    """Drops along lines, over one unknown each: z0·y."""

    def __init__(self, columns: Columns, falls: NDArray):
        there, row = np.flatnonzero(falls), np.cumsum(falls) - 1
        self.z0, self._resistance, self._length = columns.z0[there], columns.pi[0][there], columns.length[there]
        self._laws = [(row[places], law) for places, law in columns.laws]

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
        ends: NDArray,
    ):
        self.falls, self._names = Falls(description.columns, falls), (description.lines, np.flatnonzero(falls))
        self.elements = _standing(description)
        pairs = [(e.from_node, e.to_node) for e in self.elements]
        own = [[-1 if node is None else number[node] for node in pair] for pair in pairs]
        self.from_node, self.to_node = np.vstack([ends[falls], np.array(own, int).reshape(-1, 2)]).T
        nodes = description.nodes
        impedances = [element.seen(nodes) for element in self.elements]
        packed, _ = laws_of([Group([*nodes.values()], [], self.elements, [])], impedances, 0, 0)
        self.seen, self.constants = packed.source_impedance, [element.constants for element in self.elements]
        self.packed = opened(packed, self.elements, openings)

    @cached_property
    def where(self) -> list[str]:
        """Places of the lines and elements."""
        lines, there = self._names
        names = [*lines]
        return [place("lines", names[k]) for k in there.tolist()] + [element.where for element in self.elements]

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
            constants=np.concatenate([np.empty(0), *constants]), control=controls, source_impedance=self.seen
        )
        found.elements, found.constants, found.packed = elements, constants, opened(packed, elements, openings)
        return found

    def laws(self, part: NDArray, largest: float) -> EdgeLaws:
        """Return the laws between the parts of the nodes, for efforts up to the largest."""
        ends = np.append(part, -1)
        self.packed = self.packed._replace(source_impedance=_steep(self.packed, largest))
        self._flows = Flows(self.packed)
        impedance = np.concatenate([self.falls.z0, self.packed.source_impedance])
        return EdgeLaws(ends[self.from_node], ends[self.to_node], impedance, self.solved)

    def holding(
        self, part: NDArray, flow: NDArray, scale: float
    ) -> tuple[tuple[NDArray, NDArray], NDArray, tuple[NDArray, NDArray]]:
        """Ends of edges, which of them pass flow or would, and drops between which they hold: for `pockets.settled`."""
        ends, none = np.append(part, -1), np.zeros(len(self.falls.z0))
        low, high = (np.concatenate([none, drops]) for drops in held_drops(self.packed))
        passing = (low == high) | (np.abs(flow) > NOTHING * scale)
        return (ends[self.from_node], ends[self.to_node]), passing, (low, high)

    def solved(self, a: NDArray) -> Slopes:
        """Drops and flows, and their slopes over the efforts a behind the impedances."""
        count, z = len(self.falls.z0), self.packed.source_impedance
        flow, slope = self._flows(a[count:])
        of_elements = a[count:] - z * flow, flow, 1 - z * slope, slope
        return tuple(map(np.concatenate, zip(self.falls.solved(a[:count]), of_elements, strict=True)))


def _steep(elements: Laws, largest: float) -> NDArray:
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
    own = [element for element in description.elements if not element.kind.fills]
    running = [one._replace(law=one.law._replace(kind=one.kind.steady or one.law.kind)) for one in own]
    return [*running, *resistive(description.scene, description.nodes)]


def openings_at_rest(elements: Sequence[PlacedLaw]) -> dict[str, float]:
    """Openings where all is at rest: those given, or else wide open regulators and shut discs."""
    found = {}
    for element in elements:
        if element.governor is not None:
            usual = 0.0 if element.governor.inertia else 1.0
            found[element.where] = usual if element.governor.start is None else element.governor.start
    return found


def still(elements: Sequence[PlacedLaw], solve: "Callable[[dict[str, float]], Before]") -> "Before":
    """Steady state in which openings do not move, or are at an end to which they are driven.

    `solve` gives the steady state under openings by place.
    """
    moving = [element for element in elements if element.governor is not None]
    given = {e.where: e.governor.start for e in moving if e.governor and e.governor.start is not None}
    openings = {e.where: REGULATOR if e.governor and not e.governor.inertia else DISC for e in moving} | given
    free = [e for e in moving if e.where not in given]
    before = solve(openings)
    if not free:
        return before
    low, last, worst = np.log(SHUT), np.inf, free[0]
    y = np.log([openings[e.where] for e in free])

    def at(y: NDArray) -> "tuple[Before, NDArray]":
        now = np.where(y > low, np.exp(y), 0.0).tolist()
        found = solve(openings | dict(zip([e.where for e in free], now, strict=True)))
        return found, np.array([_drive(e, found) for e in free])

    for _ in range(STEPS):
        before, drive = at(y)
        held = ((y >= 0.0) & (drive >= 0.0)) | ((y <= low) & (drive <= 0.0))
        moved = np.flatnonzero(~held)
        if not moved.size:
            return before
        worst = free[int(np.argmax(np.abs(drive) * ~held))]
        slopes = np.empty((len(free), len(moved)))
        for k, j in enumerate(moved):
            beside = y.copy()
            beside[j] -= DIFFERENCE
            slopes[:, k] = (drive - at(beside)[1]) / DIFFERENCE
        step = np.clip(np.linalg.lstsq(slopes[moved], drive[moved])[0], -LONGEST, LONGEST)
        size = float(np.abs(step).max())
        if size <= SETTLED or (size <= ROUNDED and size >= last):
            return before
        y[moved] = np.clip(y[moved] - step, low, 0.0)
        last = size
    if (settled := _in_turn(at, y)) is not None:
        return settled
    raise InputError(worst.where, "no opening is found at which it keeps its value", "its opening, or start = 'rest'")


def _in_turn(at: "Callable[[NDArray], tuple[Before, NDArray]]", y: NDArray) -> "Before | None":
    """One opening after the other until none moves any more, or nothing; one that rises lowers its own drive."""
    from scipy.optimize import brentq

    low = np.log(SHUT)
    for _ in range(STEPS):
        begun = y.copy()
        for k in range(y.size):

            def drive(value: float, k: int = k) -> float:
                y[k] = value
                return at(y)[1][k]

            y[k] = low if drive(low) <= 0.0 else 0.0 if drive(0.0) >= 0.0 else brentq(drive, low, 0.0, xtol=SETTLED)
        if np.abs(y - begun).max() <= ROUNDED:
            return at(y)[0]
    return None


def _drive(element: PlacedLaw, before: "Before") -> float:
    governor, through = element.governor, before.through.get(element.where, 0.0)
    assert governor is not None
    seen = [before.effort.get(node or "", 0.0) for node in (element.from_node, element.to_node)]
    each = zip((governor.here, governor.there, governor.through), (*seen, through), strict=True)
    return (
        sum(gain * (value - kept) for (gain, kept), value in each if gain)
        - governor.own * before.openings[element.where]
    )
