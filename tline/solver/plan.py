"""Runs of a scene with other values, on a grid that suits it, in place of searches for one.

Two runs of orders s and s + 1 on the same slabs are compared as the polynomials they are; the finer one is the result,
and the difference bounds its errors. Both are packed once; where no value touches more than a few numbers there,
these are written down and nothing else is made again.
"""

from dataclasses import replace
from functools import cached_property
from math import inf

import numpy as np
from numpy.typing import NDArray

from tline.compiled.structure import Packed, pack
from tline.errors import InputError
from tline.solver.assembly.assemble import assemble, rewritten
from tline.solver.assembly.fronts import Tally
from tline.solver.assembly.layout import layout_of
from tline.solver.description.description import Description
from tline.solver.description.excitation import Shape, places_of, sampled
from tline.solver.description.groups import Group, poles_of
from tline.solver.description.load_step import StateSpace, load_step
from tline.solver.description.nodes import Node
from tline.solver.description.resolution import resolution
from tline.solver.description.short_lines import short_lines
from tline.solver.description.slab import breaks_of, common_parts, relative_work
from tline.solver.kernel.difference import BLOCK, Compared, find_difference
from tline.solver.loop.march import March, Signals, Stepper, concatenated
from tline.solver.loop.slabs import Slabs
from tline.solver.radau import chebyshev
from tline.solver.result.accuracy import SLOWEST, Accuracy, Attempt
from tline.solver.result.result import Result
from tline.solver.run import given_out, run, with_ledger
from tline.solver.tolerance.compare import BETWEEN, as_computed, compare, relative
from tline.solver.tolerance.difference import at_same_places

NOTHING = np.empty(0)
LOWEST, HIGHEST = 5, 10  # order of the coarser run: below, what they differ by falls slowly
HALVINGS = 5  # of slabs as wide as the shortest delay, or as what divides all delays
MOST_PARTS = 1000  # of the shortest delay
MOST_WORK = 3e5  # line-end samples without fronts that take as long as a run: some hundredths of a second
SPARE = 0.1  # of the tolerance: what is to be told of the scene as it was given
CAUTION = BETWEEN / (1 - SLOWEST)  # errors between places over differences


class OneOrder:
    """A scene at one order, packed."""

    def __init__(self, description: Description, order: int, h: float):
        chosen = resolution(description, order, h)
        self.slabs, self.resolved, self.notes = Slabs.until(description.t_end, h), chosen.resolved, chosen.notes
        self.assembly = assemble(description, set(description.probed), chosen)
        self.record = np.empty((self.assembly.kept, 2, self.slabs.number * order))
        stepper = Stepper(self.assembly, self.slabs.number, self.record)
        stepper.compile()
        self.kernel, self.signals = stepper.kernel, stepper.signals
        self.excitation = self.signals.sampled(0, self.slabs.number).copy()
        self.initial = self.assembly.state.load.copy()
        samples = len(self.assembly.network.ends) * self.slabs.number * order
        self.attempt = Attempt(order, self.slabs.width, None, samples, 0.0)

    @property
    def smooth(self) -> bool:
        """Whether no slab is in pieces, and no switch moves."""
        assembly = self.assembly
        return not (assembly.follows_edges or assembly.events or any(len(places) for places in self.signals.places))

    def take(self, description: Description) -> bool:
        """Put another scene in place; whether that could be done."""
        assembly, n = self.assembly, self.slabs.number
        chosen = assembly.resolution
        if not rewritten(assembly, description, chosen, layout_of(description, chosen)):
            return False
        self.signals = Signals(assembly, n, self.signals)
        self.excitation = self.signals.sampled(0, n)
        return self.kernel.takes(assembly.network, assembly.state, None)

    def respond(self, g: int, system: StateSpace, at_rest: NDArray) -> None:
        """Put a state space in place of that of a group of nodes."""
        network = self.assembly.network
        row, at = network.step_row[g], network.load_at[g]
        step = load_step(system, self.assembly.basis, self.slabs.width) if network.step_whole[row] else system.d
        network.step[network.step_at[row] :][: step.size] = step.ravel()
        self.initial[at : at + len(at_rest)] = at_rest

    def drive(self, k: int, node: Node, weight: NDArray) -> None:
        """Put what drives a node in place of what drove it: shares of arriving waves, and sources."""
        network, order, h = self.assembly.network, self.assembly.basis, self.slabs.width
        network.weight[network.first[k] : network.first[k + 1]] = weight
        if node.excitations:
            parts = [share * sampled(shape, order, h, 0, self.slabs.number) for shape, share in node.excitations]
            self.excitation[network.excitation_row[k]] = np.sum(parts, axis=0).ravel()

    def rest(self) -> None:
        """Begin anew from rest."""
        state = self.assembly.state
        for part in (state.waves, state.slot, state.side, state.before):
            part.fill(0)
        state.load[...] = self.initial

    def march(self) -> bool:
        """Advance to the end; whether all waves are finite."""
        return self.kernel.blocks(self.slabs.number, self.excitation, self.record, 0) < 0


class Pair:
    """Two orders on slabs of one width, for runs of a described scene with other values.

    Both are packed once; where slabs are in pieces they are made anew for each run.

    Parameters
    ----------
    description : Description
    tol : float
        Of all runs.
    order : int
        Of the coarser run.
    h : float
        Width of slabs, s.
    """

    def __init__(self, description: Description, tol: float, order: int, h: float):
        self.description, self.tol, self.order, self.h = description, tol, order, h

    @cached_property
    def orders(self) -> tuple[OneOrder, OneOrder]:
        """The coarser run, and the finer one."""
        return OneOrder(self.description, self.order, self.h), OneOrder(self.description, self.order + 1, self.h)

    @cached_property
    def smooth(self) -> bool:
        """Whether the packed orders will do where no slab is in pieces."""
        coarse, fine = self.orders
        changing = any(element.kind.fills or element.kind.breaks for element in self.description.elements)
        at_ends = all(at.line and not at.conductor and at.share in (0, 1) for at in self.description.probes.values())
        return at_ends and not (changing or fine.slabs.rest or coarse.notes or fine.notes)

    def run(self, description: Description) -> Result | None:
        """The result for the scene with other values; None if it is not as accurate as asked, or not resolved."""
        try:
            fastest = min(map(min, description.time_scales.values()), default=inf)
            if fastest < self.orders[0].resolved or not _tells_by_order(description):
                return None
            if self.smooth and all(one.take(description) and one.smooth and one.march() for one in self.orders):
                return self._result(description)
            coarse, fine = (as_computed(run(description, one.assembly.resolution)) for one in self.orders)
        except InputError:
            return None  # which a search tells, or finds a way round
        told = compare(description, coarse, fine, self.tol).errors
        if not told.met or fine.unresolved:
            return None
        accuracy = replace(told, attempts=(Attempt.of(coarse, told.worst), Attempt.of(fine)))
        return with_ledger(replace(fine, accuracy=accuracy), None)

    @cached_property
    def _compared(self) -> tuple[NDArray, list[Packed]]:
        """Largest differences at each probe, of blocks of slabs, and what finds them."""
        found = np.zeros((len(self.description.probes), 6, BLOCK))
        fine, s, other = self.orders[1], *(one.assembly.basis.s for one in self.orders)
        places, packed = at_same_places(s, other, 1, len(chebyshev(other))), []
        for probe, most in zip(self.description.probes.values(), found, strict=True):
            row = fine.assembly.recorded[probe.line] + int(probe.share)
            sides = (1, 0) if probe.share == 0.0 else (0, 1)  # of the record, which has what arrived first
            waves = [one.record[row, side].reshape(fine.slabs.number, -1) for one in self.orders for side in sides]
            work = np.empty((2, s, BLOCK)), np.empty((2, other, BLOCK)), np.empty((4, BLOCK)), most
            packed.append(pack(Compared(*waves, *places, 2 * probe.height.above_level, *work)))
        return found, packed

    def _result(self, description: Description) -> Result | None:
        """The result of the finer run; None if it is not as accurate as asked."""
        fine, (most, packed) = self.orders[1], self._compared
        most.fill(0.0)
        for compared in packed:
            find_difference(compared)
        found = most.max(axis=2).reshape(-1, 3, 2)
        if description.steady:  # and so it began
            for each, probe in zip(found[:, 2], self.description.probes.values(), strict=True):
                a, b = fine.assembly.start[probe.line].reshape(2, 2)[int(probe.share)]
                each[0] = max(each[0], abs(a + b - 2 * probe.height.above_level))
        found[:, 1] = CAUTION * found[:, :2].max(axis=1)
        found[:, 0] *= CAUTION
        told = relative(dict(zip(self.description.probes, found[:, [0, 1, 1, 2]], strict=True)))
        worst = max(max(estimate.u, estimate.y) for estimate in told[1].values())
        if not worst <= self.tol:
            return None
        done = March(0.0, concatenated([], fine.assembly.basis.s), Tally(), None, raw=True)
        result = given_out(description, fine.assembly, fine.slabs, fine.record.copy(), done)
        attempts = tuple(one.attempt for one in self.orders)
        accuracy = Accuracy(self.tol, *told, attempts=(replace(attempts[0], estimate=worst), attempts[1]))
        return with_ledger(replace(result, accuracy=accuracy), None)


class Plan(Pair):
    """A pair in which a run writes down no more than what its values change.

    For scenes from rest without laws, losses, switches, elevations and lumped lines.
    """

    def __init__(self, description: Description, tol: float, order: int, h: float):
        super().__init__(description, tol, order, h)
        self.groups, nodes = description.grouped()
        self.number = {node: k for k, node in enumerate(nodes)}
        self.group = {node.name: g for g, group in enumerate(self.groups) for node in group.nodes}
        self.written: dict[int, Group] = {}  # in place of the description's
        self.z0 = np.array([line.z0 for line in description.lines.values()])

    def run(self, description: Description) -> Result | None:
        """The result; None if the values make it another scene, or if it is not accurate."""
        try:
            if not (self.smooth and self.orders[1].smooth and self._patched(description)):
                return None
        except InputError:
            return None
        for one in self.orders:
            one.rest()
        return self._result(description) if all(one.march() for one in self.orders) else None

    def _patched(self, description: Description) -> bool:
        """Write down what other values change; whether that could be done."""
        known = description if description.origin is None else description.origin.description
        if known is not self.description or description.active:
            return False
        changed: dict[int, Group] = {}
        for name in description.anew:
            old = self.groups[g := self.group[name]]
            changed[g] = Group([description.anew.get(node.name, node) for node in old.nodes], old.branches, [], [])
            if not self._takes(changed[g], old):
                return False
        for g in {**self.written, **changed}:
            self._write(g, changed.get(g, self.groups[g]), self.written.get(g, self.groups[g]))
        self.written = changed
        return True

    def _write(self, g: int, group: Group, before: Group) -> None:
        """Write down what now stands at a group of nodes."""
        if self.orders[1].assembly.network.step_row[g] >= 0:
            at_rest = NOTHING if group.single else group.at_rest()  # nothing is lifted
            for one in self.orders:
                one.respond(g, group.always, at_rest)
        for node, old in zip(group.nodes, before.nodes, strict=True):
            if not _driven_alike(node, old):
                weight = node.weights(self.z0)
                for one in self.orders:
                    one.drive(self.number[node.name], node, weight)

    def _takes(self, group: Group, old: Group) -> bool:
        """Whether a group of nodes differs from that before in numbers alone, and is slow enough for the slabs."""
        if group.dynamic != old.dynamic:
            return False
        if group.dynamic:
            A = group.always.A
            if len(A) != len(old.always.A):
                return False
            if len(A) and self.orders[0].resolved * np.abs(poles_of(group.always)).max() > 1.0:
                return False
        for node, before in zip(group.nodes, old.nodes, strict=True):
            if not (_driven_alike(node, before) or self._follows(node.excitations, before.excitations)):
                return False
        return True

    def _follows(self, excitations: list[tuple[Shape, float]], before: list[tuple[Shape, float]]) -> bool:
        """Whether what drives a node is slow enough, and breaks at edges of slabs alone, if as much did before."""
        slabs = self.orders[1].slabs
        if len(excitations) != len(before):
            return False
        if all(shape is other for (shape, _), (other, _) in zip(excitations, before, strict=True)):
            return True
        whole = not np.any(places_of(excitations, slabs.end, slabs.width) % 1)
        return whole and all(shape.fastest() >= self.orders[0].resolved for shape, _ in excitations)


def _driven_alike(node: Node, other: Node) -> bool:
    """Whether waves and sources drive two nodes alike, which have the same line ends."""
    return (node.conductance, node.held, node.flows) == (other.conductance, other.held, other.flows)


def planned(description: Description, tol: float) -> Pair | None:
    """What runs a scene with other values to a tolerance, on the widest slabs that leave these some room."""
    if not _tells_by_order(description):
        return None
    more = description.steady or description.elements or description.heights or description.switched
    for make in (Pair,) if more else (Plan, Pair):
        for h in _widths(description):
            if make(description, SPARE * tol, HIGHEST, h).run(description) is None:
                continue
            for order in range(LOWEST, HIGHEST + 1):
                if make(description, SPARE * tol, order, h).run(description) is not None:
                    return make(description, tol, order, h)
    return None


def _tells_by_order(description: Description) -> bool:
    """Whether two orders on slabs of one width tell all: nothing is lumped, remembered, or moves by itself."""
    if description.scene.solver.order or description.scene.solver.slab or description.stretches or description.lossy:
        return False
    if description.collapses or description.own or description.active:
        return False
    moves = any(element.governor is not None for element in description.elements)
    return not moves and not short_lines(description, ())[0]


def _widths(description: Description) -> list[float]:
    """Widths of slabs, s: wide ones first, which divide all delays, and breaks of waveforms, if any do."""
    delays = [line.delay for line in description.lines.values()]
    shortest, breaks = min(delays), breaks_of(description).tolist()
    times = (*delays, *breaks), (*delays,)
    parts = next(filter(None, (common_parts(each, shortest, MOST_PARTS) for each in times)), 1)
    samples = 2 * len(delays) * description.t_end * HIGHEST
    widths = (shortest / (parts * 2**k) for k in range(HALVINGS))
    affordable = (h for h in widths if samples / h * relative_work(h, delays, breaks) <= MOST_WORK)
    return [h for h in affordable if h <= description.t_end]
