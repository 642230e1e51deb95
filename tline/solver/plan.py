"""A plan of a scene: all that no value touches is found and packed once, and a run writes down what its values change.

Two runs of orders s and s + 1 on the same slabs are compared as the polynomials they are, at Chebyshev's places in each
slab, and the finer one is the result. A plan is for scenes from rest without laws, losses, switches, elevations and
lumped lines, whose fronts lie at edges of slabs.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tline.compiled.structure import pack
from tline.solver.assembly.assemble import assemble
from tline.solver.assembly.fronts import Tally
from tline.solver.description.description import Description
from tline.solver.description.excitation import Shape, places_of, sampled
from tline.solver.description.given import Scene
from tline.solver.description.groups import Group, poles_of
from tline.solver.description.load_step import StateSpace, load_step
from tline.solver.description.nodes import Node
from tline.solver.description.resolution import resolution
from tline.solver.description.short_lines import short_lines
from tline.solver.description.slab import whole_slabs
from tline.solver.kernel.difference import BLOCK, Compared, find_difference
from tline.solver.loop.march import March, Stepper, concatenated
from tline.solver.loop.slabs import Slabs
from tline.solver.radau import chebyshev
from tline.solver.result.accuracy import SLOWEST, Accuracy, Attempt
from tline.solver.result.result import LineRecord, ProbeResult, Result, Wave
from tline.solver.run import Again, given_out, with_ledger
from tline.solver.tolerance.compare import BETWEEN, relative
from tline.solver.tolerance.smooth import at_same_places

NOTHING = np.empty(0)
WIDEST = 4  # slabs, over those of a search, which are for low orders
LOWEST, HIGHEST = 5, 10  # order of the coarser run: below, what they differ by falls slowly
MOST_SAMPLES = 1e6  # at line ends; in longer runs what a plan saves is little
SPARE = 0.1  # of the tolerance: what a plan is to tell of the scene as it was given
CAUTION = BETWEEN / (1 - SLOWEST)  # errors between places over differences


Excitations = list[tuple[Shape, float]]


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

    @property
    def attempt(self) -> Attempt:
        """As one of a search."""
        s, ends = self.assembly.basis.s, len(self.assembly.network.ends)
        return Attempt(s, self.slabs.width, None, ends * self.slabs.number * s, 0.0)

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


class Plan:
    """Two orders of a described scene on slabs of one width, for runs of it with other values.

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
        self.description, self.tol = description, tol
        self.coarse, self.fine = self.orders = [OneOrder(description, s, h) for s in (order, order + 1)]
        self.groups, nodes = description.grouped()
        self.number = {node: k for k, node in enumerate(nodes)}
        self.group = {node.name: g for g, group in enumerate(self.groups) for node in group.nodes}
        self.written: dict[int, Group] = {}  # in place of the description's
        self.z0 = np.array([line.z0 for line in description.lines.values()])
        self.result, self.attempts = self._given_out(), (self.coarse.attempt, self.fine.attempt)
        self.most = np.zeros((len(description.probes), 6, BLOCK))
        self.compared = [pack(self._compared(*each)) for each in zip(description.probes, self.most, strict=True)]

    @property
    def smooth(self) -> bool:
        """Whether no run needs pieces of slabs, nor ends within a slab."""
        return self.coarse.smooth and self.fine.smooth and not self.fine.slabs.rest

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
        """The result for the scene with other values; None if these make it another scene, or if it is not accurate.

        Parameters
        ----------
        description : Description
            Changed from the plan's own.
        """
        if not self._patched(description) or not (self.coarse.march() and self.fine.march()):
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
            if len(A) and self.coarse.assembly.resolution.resolved * np.abs(poles_of(group.always)).max() > 1.0:
                return False
        for node, before in zip(group.nodes, old.nodes, strict=True):
            if not (_driven_alike(node, before) or self._follows(node.excitations, before.excitations)):
                return False
        return True

    def _follows(self, excitations: Excitations, before: Excitations) -> bool:
        """Whether what drives a node is slow enough, and breaks at edges of slabs alone, if as much did before."""
        slabs, resolved = self.fine.slabs, self.coarse.assembly.resolution.resolved
        if len(excitations) != len(before):
            return False
        if all(shape is other for (shape, _), (other, _) in zip(excitations, before, strict=True)):
            return True
        whole = not np.any(places_of(excitations, slabs.end, slabs.width) % 1)
        return whole and all(shape.fastest() >= resolved for shape, _ in excitations)


def _driven_alike(node: Node, other: Node) -> bool:
    """Whether waves and sources drive two nodes alike, which have the same line ends."""
    return (node.conductance, node.held, node.flows) == (other.conductance, other.held, other.flows)


def planned(description: Description, tol: float) -> Plan | None:
    """A plan of a scene for a tolerance, if it is one for that; of the lowest order with some room for other values."""
    if description.active:
        return None
    by_hand = description.scene.solver.order or description.scene.solver.slab
    once = description.steady or description.elements or description.lossy or description.heights
    if by_hand or once or description.stretches or description.switched or description.own:
        return None
    if short_lines(description, ())[0]:  # which a search may lump
        return None
    if not all(probe.line in description.lines and probe.share in (0.0, 1.0) for probe in description.probes.values()):
        return None
    h, delays = resolution(description, LOWEST).h, [line.delay for line in description.lines.values()]
    if 2 * len(delays) * description.t_end / h * LOWEST > MOST_SAMPLES:
        return None
    for wider in range(WIDEST, 0, -1):
        if not whole_slabs(wider * h, delays) or resolution(description, LOWEST, wider * h).notes:
            continue
        for order in range(LOWEST, HIGHEST + 1):
            plan = Plan(description, tol, order, wider * h)
            if not plan.smooth:
                break
            result = plan.run(description)
            if result is not None and result.accuracy and result.accuracy.worst <= SPARE * tol:
                return plan
    return None
