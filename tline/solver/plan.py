"""Runs of a scene with other values, on a grid that suits it, in place of searches for one.

Two runs of orders s and s + 1 on the same slabs are compared as the polynomials they are; the finer one is the result,
and the difference bounds its errors. Where no value touches more than numbers in packed arrays, these are written down
and nothing else is made again.
"""

from dataclasses import replace
from math import inf

import numpy as np
from numpy.typing import NDArray

from tline.compiled.structure import pack
from tline.errors import InputError
from tline.solver.assembly.assemble import assemble
from tline.solver.assembly.fronts import Tally
from tline.solver.description.description import Description
from tline.solver.description.excitation import Shape, places_of, sampled
from tline.solver.description.given import Scene
from tline.solver.description.groups import Group, poles_of
from tline.solver.description.load_step import StateSpace, load_step
from tline.solver.description.nodes import Node
from tline.solver.description.resolution import Resolution, resolution
from tline.solver.description.short_lines import short_lines
from tline.solver.description.slab import breaks_of, common_parts, relative_work
from tline.solver.kernel.difference import BLOCK, Compared, find_difference
from tline.solver.loop.march import March, Stepper, concatenated
from tline.solver.loop.slabs import Slabs
from tline.solver.radau import chebyshev
from tline.solver.result.accuracy import SLOWEST, Accuracy, Attempt
from tline.solver.result.result import LineRecord, ProbeResult, Result, Wave
from tline.solver.run import Again, given_out, run, with_ledger
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
        self.slabs = Slabs.until(description.t_end, chosen.h)
        self.assembly = assemble(description, set(description.probed), chosen)
        self.record = np.empty((self.assembly.kept, 2, self.slabs.number * order))
        stepper = Stepper(self.assembly, self.slabs.number, self.record)
        stepper.compile()
        self.kernel = stepper.kernel
        self.smooth = stepper.fronts is None and not stepper.at_edges and not self.assembly.follows_edges
        self.excitation = stepper.signals.sampled(0, self.slabs.number).copy()
        self.initial = self.assembly.state.load.copy()
        samples = len(self.assembly.network.ends) * self.slabs.number * order
        self.attempt = Attempt(order, self.slabs.width, None, samples, 0.0)

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

    def march(self) -> bool:
        """Advance from rest to the end; whether all waves are finite."""
        state = self.assembly.state
        for part in (state.waves, state.slot, state.side, state.before):
            part.fill(0)
        state.load[...] = self.initial
        return self.kernel.blocks(self.slabs.number, self.excitation, self.record, 0) < 0


class Pair:
    """Two orders on slabs of one width, for runs of a described scene with other values.

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
        self._grids: list[Resolution] = []

    def run(self, description: Description) -> Result | None:
        """The result for the scene with other values; None if it is not as accurate as asked, or not resolved."""
        try:
            grids = self._grids or [resolution(self.description, s, self.h) for s in (self.order, self.order + 1)]
            self._grids, fastest = grids, min(map(min, description.time_scales.values()), default=inf)
            if fastest < grids[0].resolved or not _tells_by_order(description):
                return None
            coarse, fine = (as_computed(run(description, chosen)) for chosen in grids)
        except InputError:
            return None  # which a search tells, or finds a way round
        told = compare(description, coarse, fine, self.tol).errors
        if not told.met or fine.unresolved:
            return None
        accuracy = replace(told, attempts=(Attempt.of(coarse, told.worst), Attempt.of(fine)))
        return with_ledger(replace(fine, accuracy=accuracy), None)


class Plan(Pair):
    """A pair whose scene is packed once, where no run needs pieces of slabs; a run writes down what its values change.

    For scenes from rest without laws, losses, switches, elevations and lumped lines.
    """

    def __init__(self, description: Description, tol: float, order: int, h: float):
        super().__init__(description, tol, order, h)
        self.coarse, self.fine = self.orders = [OneOrder(description, s, h) for s in (order, order + 1)]
        self.resolved = self.coarse.assembly.resolution.resolved
        notes = self.coarse.assembly.resolution.notes
        self.smooth = self.coarse.smooth and self.fine.smooth and not self.fine.slabs.rest and not notes
        self.groups, nodes = description.grouped()
        self.number = {node: k for k, node in enumerate(nodes)}
        self.group = {node.name: g for g, group in enumerate(self.groups) for node in group.nodes}
        self.written: dict[int, Group] = {}  # in place of the description's
        self.z0 = np.array([line.z0 for line in description.lines.values()])
        self.result, self.attempts = self._given_out(), (self.coarse.attempt, self.fine.attempt)
        self.most = np.zeros((len(description.probes), 6, BLOCK))
        self.compared = [pack(self._compared(*each)) for each in zip(description.probes, self.most, strict=True)]

    def _compared(self, name: str, most: NDArray) -> Compared:
        """What compares the waves a and b at a probe in both runs."""
        probe = self.description.probes[name]
        row, n = self.fine.assembly.recorded[probe.line] + int(probe.share), self.fine.slabs.number
        sides = (1, 0) if probe.share == 0.0 else (0, 1)  # of the record, which has what arrived first
        a, b, c, d = (one.record[row, side].reshape(n, -1) for one in self.orders for side in sides)
        s, other = (one.assembly.basis.s for one in self.orders)
        work = np.empty((2, s, BLOCK)), np.empty((2, other, BLOCK)), np.empty((4, BLOCK)), most
        return Compared(a, b, c, d, *at_same_places(s, other, 1, len(chebyshev(other))), 0.0, *work)

    def run(self, description: Description) -> Result | None:
        """The result; None if the values make it another scene, or if it is not accurate."""
        if not (self.smooth and self._patched(description) and self.coarse.march() and self.fine.march()):
            return None
        accuracy = self._accuracy()
        return self._result(description.scene, accuracy) if accuracy.met else None

    def _given_out(self) -> Result:
        """The result of the finer run, but for its waves."""
        assembly, slabs = self.fine.assembly, self.fine.slabs
        done = March(0.0, concatenated([], assembly.basis.s), Tally(), None)
        return with_ledger(given_out(self.description, assembly, slabs, self.fine.record, done), None)

    def _result(self, scene: Scene, accuracy: Accuracy) -> Result:
        """The result of the finer run, with its waves."""
        known, record, lines = self.result, self.fine.record.copy(), {}
        waves = record.reshape(len(record), 2, self.fine.slabs.number, -1)
        for name, row in self.fine.assembly.recorded.items():
            (b1, a1), (a2, b2) = waves[row], waves[row + 1]  # what arrived first
            line = known.lines[name]
            pairs = (line.a1, a1), (line.b1, b1), (line.a2, a2), (line.b2, b2)
            a1, b1, a2, b2 = (Wave(values, 0.0, old.basis, old.h, old.pieces) for old, values in pairs)
            lines[name] = LineRecord(line.z0, line.delay, a1, b1, a2, b2, line.smeared, blurred=line.blurred)
        probes = {}
        for name, old in known.probes.items():
            probes[name] = ProbeResult(name, old.line, old.share, lines[old.line], old.slabs, old.height)
        again = known.accounts._replace(scene=scene) if isinstance(known.accounts, Again) else None
        return replace(known, scene=scene, lines=lines, probes=probes, accuracy=accuracy, accounts=again)

    def _accuracy(self) -> Accuracy:
        """Errors of the coarser run by its differences to the finer one, which bound those of this."""
        self.most.fill(0.0)
        for compared in self.compared:
            find_difference(compared)
        found = self.most.max(axis=2).reshape(-1, 3, 2)
        found[:, 1] = CAUTION * found[:, :2].max(axis=1)
        found[:, 0] *= CAUTION
        told = relative(dict(zip(self.description.probes, found[:, [0, 1, 1, 2]], strict=True)))
        worst = 0.0
        for estimate in told[1].values():
            worst = max(worst, estimate.u, estimate.y)
        return Accuracy(self.tol, *told, attempts=(replace(self.attempts[0], estimate=worst), self.attempts[1]))

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
        if self.fine.assembly.network.step_row[g] >= 0:
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
            if len(A) and self.resolved * np.abs(poles_of(group.always)).max() > 1.0:
                return False
        for node, before in zip(group.nodes, old.nodes, strict=True):
            if not (_driven_alike(node, before) or self._follows(node.excitations, before.excitations)):
                return False
        return True

    def _follows(self, excitations: list[tuple[Shape, float]], before: list[tuple[Shape, float]]) -> bool:
        """Whether what drives a node is slow enough, and breaks at edges of slabs alone, if as much did before."""
        slabs = self.fine.slabs
        if len(excitations) != len(before):
            return False
        if all(shape is other for (shape, _), (other, _) in zip(excitations, before, strict=True)):
            return True
        whole = not np.any(places_of(excitations, slabs.end, slabs.width) % 1)
        return whole and all(shape.fastest() >= self.resolved for shape, _ in excitations)


def _driven_alike(node: Node, other: Node) -> bool:
    """Whether waves and sources drive two nodes alike, which have the same line ends."""
    return (node.conductance, node.held, node.flows) == (other.conductance, other.held, other.flows)


def planned(description: Description, tol: float) -> Pair | None:
    """What runs a scene with other values to a tolerance, on the widest slabs that leave these some room."""
    if not _tells_by_order(description):
        return None
    once = description.steady or description.elements or description.heights or description.switched
    at_ends = all(at.line in description.lines and at.share in (0.0, 1.0) for at in description.probes.values())
    for make in (Plan, Pair) if at_ends and not once else (Pair,):
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
