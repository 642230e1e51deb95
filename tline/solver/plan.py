"""Runs of a scene with other values, on a grid that suits it, in place of searches for one.

Two runs of orders s and s + 1 on the same slabs are compared as the polynomials they are; the finer one is the result,
and the difference bounds its errors. Both are packed once; where no value touches more than a few numbers there,
these are written down and nothing else is made again.
"""

from dataclasses import replace
from functools import cache, cached_property
from math import inf

import numpy as np
from numpy.typing import NDArray

from tline.compiled.structure import Packed, pack
from tline.errors import InputError
from tline.solver.assembly.assemble import assemble, rewritten
from tline.solver.assembly.layout import layout_of
from tline.solver.assembly.workspace import Tally
from tline.solver.description.circuit import load_step
from tline.solver.description.description import Description
from tline.solver.description.excitation import places_of, sampled
from tline.solver.description.groups import Group, poles_of
from tline.solver.description.nodes import weights_of
from tline.solver.description.resolution import resolution, short_lines
from tline.solver.description.slab import breaks_of, common_parts, relative_work
from tline.solver.kernel.finished import BLOCK, Compared, find_difference
from tline.solver.loop.march import March, Signals, Stepper, concatenated
from tline.solver.loop.slabs import Slabs
from tline.solver.radau import chebyshev
from tline.solver.result.accuracy import SLOWEST, Accuracy, Attempt
from tline.solver.result.merged import probed
from tline.solver.result.result import Result
from tline.solver.run import Again, given_out, line_records, records_of, run, with_ledger
from tline.solver.tolerance.compare import BETWEEN, as_computed, at_same_places, compare, relative

LOWEST, HIGHEST = 5, 10  # order of the coarser run: below, the difference falls slowly
HALVINGS = 5  # of slabs as wide as the shortest delay, or as the common divisor of all delays
MOST_PARTS = 1000  # of the shortest delay
MOST_WORK = 3e5  # line-end samples without fronts that take as long as a run: some hundredths of a second
TOLERANCE_SHARE = 0.1  # of the tolerance: largest error estimate for the scene as given
CAUTION = BETWEEN / (1 - SLOWEST)  # ratio of errors between places to differences


class OneOrder:
    """A scene at one order, packed."""

    def __init__(self, description: Description, order: int, h: float):
        chosen = resolution(description, order, h)
        self.slabs, self.resolved, self.notes = Slabs.until(description.t_end, h), chosen.resolved, chosen.notes
        self.assembly = assemble(description, set(description.probed), chosen)
        self.record = np.empty((self.assembly.kept, 2, self.slabs.number * order))
        stepper = Stepper(self.assembly, self.slabs.number, self.record)
        stepper.kernel.load()
        self.kernel, self.signals = stepper.kernel, stepper.signals
        self.excitation = self.signals.sampled(0, self.slabs.number).copy()
        self.initial = self.assembly.state.load.copy()
        samples = len(self.assembly.network.ends) * self.slabs.number * order
        self.attempt = Attempt(order, self.slabs.width, None, samples, 0.0)
        self._lines = description.lines

    @property
    def smooth(self) -> bool:
        """Whether no slab is in pieces, and no switch moves."""
        assembly = self.assembly
        return not (assembly.follows_edges or assembly.events or any(len(places) for places in self.signals.places))

    def take(self, description: Description) -> bool:
        """Put another scene in place, whose lines delay alike between the same nodes; whether that could be done."""
        assembly, n = self.assembly, self.slabs.number
        chosen, grid = assembly.resolution, assembly.grid
        if description.lines is not self._lines:
            self._lines = description.lines
            columns = description.columns
            grid = replace(grid, lines=self._lines, z0=columns.z0, columns=columns)
        if not rewritten(assembly, description, chosen, layout_of(description, chosen, grid)):
            return False
        self.signals = Signals(assembly, n, self.signals)
        self.excitation = self.signals.sampled(0, n)
        return self.kernel.takes(assembly.network, assembly.state, None)

    def write(self, g: int, group: Group, before: Group, z0: NDArray) -> None:
        """Put a group of nodes in place of another, before a run."""
        network, order, h = self.assembly.network, self.assembly.basis, self.slabs.width
        row, at = network.step_row[g], network.load_at[g]
        if row >= 0:
            step = load_step(group.always, order, h) if network.step_whole[row] else group.always.d
            network.step[network.step_at[row] :][: step.size] = step.ravel()
            at_rest = np.empty(0) if group.single else group.at_rest()  # nothing is lifted
            self.initial[at : at + len(at_rest)] = at_rest
        for k, (node, old) in enumerate(zip(group.nodes, before.nodes, strict=True), network.group[g]):
            if node.drives_as(old):
                continue
            network.weight[network.first[k] : network.first[k + 1]] = weights_of([node], z0)
            if node.excitations:
                parts = [share * sampled(shape, order, h, 0, self.slabs.number) for shape, share in node.excitations]
                self.excitation[network.excitation_row[k]] = np.sum(parts, axis=0).ravel()

    def march(self) -> bool:
        """Advance to the end; whether all waves are finite."""
        return self.kernel.blocks(self.slabs.number, self.excitation, self.record, 0) < 0


class Pair:
    """Two orders on slabs of one width, for runs of a described scene with other values.

    Both are packed once; where slabs are in pieces they are packed again for each run.

    `orders` are the coarser run and the finer one, and `tol` is that of all runs.
    """

    def __init__(self, description: Description, tol: float, orders: tuple[OneOrder, OneOrder]):
        self.description, self.tol, self.orders = description, tol, orders

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
            if self.smooth and self._put(description):
                coarse, fine = self.orders
                return self._result(description) if coarse.march() and fine.march() else None
            return self._made_anew(description) if self._resolves(description) else None
        except InputError:
            return None  # a search reports it, or finds a way round

    def _resolves(self, description: Description) -> bool:
        fastest = min(map(min, description.time_scales.values()), default=inf)
        return fastest >= self.orders[0].resolved and _tells_by_order(description)

    def _put(self, description: Description) -> bool:
        """Put a scene in place of the one before; whether that could be done, and no slab is in pieces."""
        return self._resolves(description) and all(one.take(description) and one.smooth for one in self.orders)

    def _made_anew(self, description: Description) -> Result | None:
        coarse, fine = (as_computed(run(description, one.assembly.resolution)) for one in self.orders)
        told, *_ = compare(description, coarse, fine, self.tol)
        if not told.met or fine.unresolved:
            return None
        accuracy = replace(told, attempts=(Attempt.of(coarse, told.worst), Attempt.of(fine)))
        return with_ledger(replace(fine, accuracy=accuracy), None)

    @cached_property
    def _compared(self) -> tuple[NDArray, list[Packed]]:
        """Largest differences at each probe, by blocks of slabs, and packed calls that find them."""
        found = np.zeros((len(self.description.probes), 6, BLOCK))
        fine, s, other = self.orders[1], *(one.assembly.basis.s for one in self.orders)
        places, packed = at_same_places(s, other, 1, len(chebyshev(other))), []
        for probe, most in zip(self.description.probes.values(), found, strict=True):
            row = fine.assembly.recorded[probe.line] + int(probe.share)
            sides = (1, 0) if probe.share == 0.0 else (0, 1)  # of the record, which has the arriving wave first
            a, b, c, d = (one.record[row, side].reshape(fine.slabs.number, -1) for one in self.orders for side in sides)
            work = np.empty((2, s, BLOCK)), np.empty((2, other, BLOCK)), np.empty((4, BLOCK)), most
            packed.append(pack(Compared(a, b, c, d, *places, 2 * probe.height.above_level, *work)))
        return found, packed

    def _result(self, description: Description) -> Result | None:
        """Return the result of the finer run; None if it is not as accurate as asked."""
        fine, (most, packed) = self.orders[1], self._compared
        most.fill(0.0)
        for compared in packed:
            find_difference(compared)
        found: dict[str, list[list[float]]] = {}
        for (name, probe), each in zip(self.description.probes.items(), most.max(axis=2).tolist(), strict=True):
            end_u, end_y, u, y, *amplitude = each
            if description.steady:  # and so it began
                a, b = fine.assembly.start[probe.line].reshape(2, 2)[int(probe.share)]
                amplitude[0] = max(amplitude[0], abs(a + b - 2 * probe.height.above_level))
            inside = [CAUTION * max(end_u, u), CAUTION * max(end_y, y)]
            found[name] = [[CAUTION * end_u, CAUTION * end_y], inside, inside, amplitude]
        told = relative(found)
        worst = 0.0
        for estimate in told[1].values():
            worst = max(worst, estimate.u, estimate.y)
        if not worst <= self.tol:
            return None
        attempts = replace(self.orders[0].attempt, estimate=worst), fine.attempt
        return self._given_out(description, fine.record.copy(), Accuracy(self.tol, *told, attempts=attempts))

    @cached_property
    def _done(self) -> March:
        return March(0.0, concatenated([], self.orders[1].assembly.basis.s), Tally(), None, raw=True)

    def _given_out(self, description: Description, waves: NDArray, accuracy: Accuracy) -> Result:
        fine = self.orders[1]
        given = given_out(description, fine.assembly, fine.slabs, waves, self._done, accuracy=accuracy)
        return with_ledger(given, None)


class Plan(Pair):
    """Pair in which a run rewrites only the numbers that its values change.

    For scenes from rest without laws, losses, switches, elevations and lumped lines.
    """

    def __init__(self, description: Description, tol: float, orders: tuple[OneOrder, OneOrder]):
        super().__init__(description, tol, orders)
        self._base, _ = description.grouped()
        self._number = {node.name: g for g, group in enumerate(self._base) for node in group.nodes}
        self._written: dict[int, Group] = {}  # in place of those
        self._z0 = description.columns.z0
        self._whole = all(one.smooth for one in orders)
        self._like: Result | None = None  # of the run before

    def _put(self, description: Description) -> bool:
        known = description if description.origin is None else description.origin.description
        if known is not self.description or description.active or not self._whole:
            return False
        base: list[Group] = self._base
        changed: dict[int, Group] = {}
        for name in description.anew:
            g = self._number[name]
            if g not in changed:
                nodes = [description.anew.get(node.name, node) for node in base[g].nodes]
                changed[g] = Group(nodes, base[g].branches, [], [])
                if not self._takes(changed[g], base[g]):
                    return False
        for one in self.orders:
            for g in {**self._written, **changed}:
                one.write(g, changed.get(g, base[g]), self._written.get(g, base[g]), self._z0)
            state = one.assembly.state  # before t = 0, from rest, of a scene without heights
            for part in (state.waves, state.slot, state.side, state.before):
                part.fill(0)
            state.load[...] = one.initial
        self._written = changed
        return True

    def _takes(self, group: Group, old: Group) -> bool:
        """Whether a group is that of the plan but for numbers, slow enough, and without breaks inside slabs."""
        slabs, resolved = self.orders[1].slabs, self.orders[0].resolved
        if group.dynamic != old.dynamic:
            return False
        if group.dynamic:
            A = group.always.A
            if len(A) != len(old.always.A) or (len(A) and resolved * np.abs(poles_of(group.always)).max() > 1.0):
                return False
        for node, other in zip(group.nodes, old.nodes, strict=True):
            if node.drives_as(other):
                continue
            ours, theirs = node.excitations, other.excitations
            if len(ours) != len(theirs):
                return False
            anew = any(shape is not other for (shape, _), (other, _) in zip(ours, theirs, strict=True))
            slow = not anew or all(shape.fastest() >= resolved for shape, _ in ours)
            if not slow or (anew and np.any(places_of(ours, slabs.end, slabs.width) % 1)):
                return False
        return True

    def _given_out(self, description: Description, waves: NDArray, accuracy: Accuracy) -> Result:
        """Result like that of the run before, with other waves."""
        if self._like is None:
            self._like = super()._given_out(description, waves, accuracy)
        fine, accounts, scene = self.orders[1], self._like.accounts, description.scene
        lines = line_records(fine.assembly, records_of(fine.assembly, waves, self._done))
        return replace(
            self._like,
            scene=scene,
            probes=probed(description, lines, {}, fine.slabs),
            lines=lines,
            accuracy=accuracy,
            accounts=accounts._replace(scene=scene) if isinstance(accounts, Again) else accounts,
        )


def planned(description: Description, tol: float) -> Pair | None:
    """Find a plan or pair for runs with other values to a tolerance, on the widest slabs that leave these room."""
    if not _tells_by_order(description):
        return None
    more = description.steady or description.elements or description.heights or description.switched
    made = cache(lambda order, h: OneOrder(description, order, h))

    def enough(make: type[Pair], order: int, h: float) -> Pair | None:
        try:
            pair = make(description, TOLERANCE_SHARE * tol, (made(order, h), made(order + 1, h)))
        except InputError:
            return None
        return pair if pair.run(description) else None

    for make in (Pair,) if more else (Plan, Pair):
        for h in _widths(description):
            for order in range(LOWEST, HIGHEST + 1) if enough(make, HIGHEST, h) else ():
                if pair := enough(make, order, h):
                    pair.tol = tol
                    return pair
    return None


def _tells_by_order(description: Description) -> bool:
    """Whether two orders on slabs of one width suffice: nothing is lumped, remembered, or moves by itself."""
    if description.scene.solver.order or description.scene.solver.slab or description.stretches or description.lossy:
        return False
    if description.collapses or description.own or description.active:
        return False
    moves = any(element.governor is not None for element in description.elements)
    return not moves and not short_lines(description, ())[0]


def _widths(description: Description) -> list[float]:
    """Widths of slabs, s: wide ones first, which divide all delays, and breaks of waveforms, if any do."""
    delays = description.columns.delay.tolist()
    shortest, breaks = min(delays), breaks_of(description).tolist()
    times = (*delays, *breaks), (*delays,)
    parts = next(filter(None, (common_parts(each, shortest, MOST_PARTS) for each in times)), 1)
    samples = 2 * len(delays) * description.t_end * HIGHEST
    widths = (shortest / (parts * 2**k) for k in range(HALVINGS))
    affordable = (h for h in widths if samples / h * relative_work(h, delays, breaks) <= MOST_WORK)
    return [h for h in affordable if h <= description.t_end]
