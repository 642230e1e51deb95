"""One run by convolution quadrature: the waves of a linear scene on slabs, from its answers in s.

The scene is linear and time-invariant. So its change from the state before t = 0 is a convolution with the changes of
its sources, and laws of lines are exact in s: no circuit approximates them.
"""

import time
from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tline.distinct import distinct
from tline.solver.assembly.layout import Excitation
from tline.solver.assembly.workspace import Tally
from tline.solver.convolution.families import (
    MOST_FAMILIES,
    ROUNDED,
    SAME_FAMILY,
    Changes,
    changes_of,
    family_of,
    leads,
    summed,
)
from tline.solver.convolution.laws import Clock, Fronts, LawsAtPorts, Tangents
from tline.solver.convolution.layers import LEVELS, Layers, affordable
from tline.solver.convolution.nodal import LinearRest
from tline.solver.convolution.quadrature import MOST_GAIN, PADDED, Quadrature, bundle_creates_energy, fast, gain
from tline.solver.description.description import Description
from tline.solver.description.excitation import Waveform, projected
from tline.solver.description.given import Height, Shape
from tline.solver.description.resolution import WHOLE, Resolution
from tline.solver.loop.march import concatenated
from tline.solver.loop.slabs import Slabs
from tline.solver.radau import Basis, basis
from tline.solver.result.dense_output import extremes
from tline.solver.result.envelope import Envelope
from tline.solver.result.merged import probed
from tline.solver.result.result import ProbeResult, Result
from tline.solver.result.wave import LineRecord, Recorded
from tline.solver.steady.steady_state import Before, above_level, rest

MANY = 32  # fronts; each has some forty narrower slabs beside it where they are followed
MOST_BESIDE_LAWS = 2e7  # weights of convolutions, numbers
MOST_HELD = 4e6  # efforts in s at once, of all families of fronts
SHARED = 4  # families of fronts that cost as much as one run
MOST_POINTS = 4e6  # points at which the scene answers in one run, times its line ends
CUBE_POINTS = 8  # line ends beyond which an answer costs their cube


def envelope_of(description: Description, result: Result) -> Envelope:
    """Extremes at all nodes with line ends, all of which are recorded; their errors are not known yet."""
    seen = {
        node: ProbeResult(node, name, float(side), record, result.slabs, description.heights.get(node, Height()))
        for name, record in result.lines.items()
        for side, node in enumerate(description.lines[name].nodes)
    }
    found = [extremes(probe, "u") for probe in seen.values()]
    (low, low_at), (high, high_at) = (np.array(side).T for side in zip(*found, strict=True))
    start = np.array([sum(wave.before for wave in probe.waves) / 2 for probe in seen.values()])
    weight, per_metre = (np.array([getattr(p.height, name) for p in seen.values()]) for name in ("weight", "per_metre"))
    unknown = np.full(len(seen), np.nan)
    return Envelope((*seen,), start, low, low_at, unknown, high, high_at, unknown, weight, per_metre)


class Convolved:
    """Linear scene in s, with the changes of its sources from before t = 0.

    Many fronts may be at edges of slabs (`clocked`), in place of narrower slabs beside each, which are there where
    fronts are `followed`. Slabs may be far wider than delays where all is `slow`.
    """

    def __init__(
        self,
        description: Description,
        record: Iterable[str],
        padded: int = PADDED[-1],
        *,
        envelope: bool = False,
        clocked: bool = True,
        slow: bool = False,
        followed: bool = True,
    ):
        self.description, self.padded, self.envelope = description, padded, envelope
        self.clocked, self.slow, self.followed = clocked, slow, followed
        self.kept = {*record, *description.probed}
        self.lines = [name for name in description.lines if envelope or name in self.kept]
        self.before: Before = above_level(description) if description.steady else rest(description)
        nodes = description.grouped()[1].values()
        self.network = LinearRest(description)
        self.laws = LawsAtPorts(description, self.network, self.before) if self.network.laws else None
        self.held = [[] if node.held is None else [self._changes(node.held, 1.0)] for node in nodes]
        self.flows = [[self._changes(*flow) for flow in node.flows] for node in nodes]

        self.driving = np.flatnonzero([bool(held or flows) for held, flows in zip(self.held, self.flows, strict=True)])

    def _changes(self, waveform: Shape, share: float) -> tuple[Changes, float]:
        return changes_of(waveform, self.description.steady, self.description.t_end), share

    @property
    def changes(self) -> list[Changes]:
        """Changes of all waveforms at nodes."""
        return [changes for parts in (*self.held, *self.flows) for changes, _ in parts]

    @cached_property
    def layered(self) -> bool:
        """Whether the response beside fronts may be followed on narrower slabs there, along rays."""
        return self.followed and not self.clock and not self.slow and affordable(self.network)

    def follows(self, h: float) -> bool:
        """Whether it is, on slabs of width h: laws move at edges, and meet fronts there if delays are whole slabs."""
        at = self.instants if self.aligned(h) else self.moves
        return self.layered and not leads(at / h).any()

    def aligned(self, h: float) -> bool:
        """Whether laws meet every front at an edge of slabs of width h, for delays are whole slabs, too."""
        if self.laws is None:
            return False
        slabs = self.network.delays * self.network.second / h
        return bool(np.abs(slabs - np.round(slabs)).max() <= SAME_FAMILY) and len(leads(self.instants / h)) < 2

    @cached_property
    def clock(self) -> float:
        """Common divisor of the spacings of many fronts, s, for slabs with all of them at edges; 0 if there is none."""
        apart = np.diff(self.instants)
        if len(apart) < MANY or not self.clocked or self.slow:
            return 0.0
        tick = float(apart.sum() / max(round(apart.sum() / apart.min()), 1))
        return tick if len(leads(self.instants / tick)) == 1 else 0.0

    @property
    def _halvings(self) -> int:
        """Times that slabs are halved beside fronts, at most: once where no line remembers and nothing has a state."""
        remember = any(line.losses and line.losses.constant is None for line in self.description.lines.values())
        states = any(group.poles is not None for group in self.description.grouped()[0])
        return LEVELS if remember or states else 1

    @cached_property
    def moves(self) -> NDArray:
        """Instants at which laws move, s."""
        return self.laws.moves if self.laws else np.empty(0)

    @cached_property
    def instants(self) -> NDArray:
        """Instants at which laws move, and all fronts of sources, s."""
        return distinct(np.concatenate([self.moves, *(changes.at for changes in self.changes)]))

    def leads(self, h: float) -> tuple[NDArray, list[Clock]]:
        """Leads by which slabs of width h begin earlier, in slabs, for families of fronts; and clocks of laws.

        With one lead each front is at an edge. Laws respond to all fronts at once, on slabs at whose edges they move.
        Fronts of sources elsewhere come before. Where narrower slabs follow fronts there is no need for any.
        """
        found = np.zeros(1) if self.follows(h) else leads(self.instants / h)
        found = found if len(found) else np.zeros(1)
        if self.laws is None:
            return found, []
        if len(found) < 2:
            return np.empty(0), [Clock(float(found[0]), 0)]
        fronts = leads(np.concatenate([changes.at for changes in self.changes]) / h)
        return fronts if self.parts_into(len(fronts)) else np.empty(0), self.laws.clocks(h)

    def parts_into(self, families: int) -> bool:
        """Whether the excitation can be split into that many families; a curved waveform with several fronts cannot."""
        several = any(changes.curved and len(changes.at) > 1 for changes in self.changes)
        return families <= (1 if several else MOST_FAMILIES)

    def run(self, chosen: Resolution) -> Result:
        """The result on slabs of a given order and width."""
        started = time.thread_time()
        description, order, h = self.description, basis(chosen.s), chosen.h
        slabs, (families, clocks) = Slabs.until(description.t_end, h), self.leads(h)
        ahead, n = np.array([*families, *(clock.ahead for clock in clocks)]), slabs.number
        fronts, whole = self._moved(order, h)
        rule = Quadrature(order, h, n + max(len(clocks), 1) * bool(ahead.any()), self.padded)
        lines = self.network.admittances(rule.points * self.network.second, np.outer(rule.late, whole))
        records = self._records(rule, order, lines, families, clocks)
        follows = self.follows(h)
        if follows:
            record, tangents = next(records)
            layers = self._layers(order, h, (fronts, whole), chosen.near, tangents)
            waves, noted = layers.corrected(record, n, description.t_end, chosen.layers)
        elif len(ahead) > 1 or ahead.any():
            waves, noted = summed((record for record, _ in records), ahead, n, order, chosen.layers)
        else:
            waves, noted = next(records)[0], concatenated([], order.s)
        start = {name: self._start(name, k) for k, name in enumerate(description.lines)}
        kept, seen, at_nodes = Recorded(waves, noted, order, h), dict[str, LineRecord](), dict[str, LineRecord]()
        for k, name in enumerate(self.lines):
            line = description.lines[name]
            before = description.nodes[line.nodes[0]].height.level + start[name]
            seen[name] = kept.line(2 * k, line, before, before)
        for k, node in enumerate(description.probed_nodes, 2 * len(seen)):
            u = self.before.effort[node] + description.nodes[node].height.level
            at_nodes[node] = kept.node(k, u, u)
        probes = probed(description, seen, at_nodes, slabs)
        narrow = noted.values[:, 0].size if follows else 0
        samples = self.network.size * n * order.s * len(ahead) + narrow
        seconds = time.thread_time() - started
        done = chosen._replace(convolved=True)
        result = Result(description.scene, slabs, probes, seen, done, done.notes, start, samples, seconds, Tally())
        if self.envelope:
            kept = {name: line for name, line in seen.items() if name in self.kept}
            result = replace(result, lines=kept, envelope=envelope_of(description, result))
        return result

    def _layers(
        self, order: Basis, h: float, moved: tuple[NDArray, NDArray], near: int, tangents: Tangents | None
    ) -> Layers:
        numbers = {name: j for j, name in enumerate(self.description.lines)}
        ends = [2 * numbers[name] + side for name in self.lines for side in (0, 1)]
        rows = [(int(self.network.node_of[end]), end) for end in ends]
        rows += [(self.network.names.index(node), -1) for node in self.description.probed_nodes]
        fronts = [
            Fronts([(node, 1.0)], held, changes.at, share * changes.jump, share * changes.bend)
            for held, each in ((True, self.held), (False, self.flows))
            for node, parts in enumerate(each)
            for changes, share in parts
        ]
        if self.laws and tangents:
            fronts += self.laws.fronts(tangents, order, h, self.description.t_end)
        kinks = any([*element.kind.bends(element.constants, 1.0)] for element in self.description.elements)
        return Layers(self.network, fronts, rows, order, h, moved, near, self.padded, self._halvings, kinks, tangents)

    def _parts(self, h: float, families: NDArray, k: int, ahead: float) -> list[list[Excitation]]:
        """Efforts held and flows at nodes due to one family of fronts, or behind the last to all of them."""

        def part(changes: Changes) -> Waveform:
            every = k == len(families)
            chosen = np.full(len(changes.at), True) if every else family_of(changes.at / h, families) == k
            return changes.part(chosen, ahead * h)

        return [[[(part(c), share) for c, share in each] for each in rows] for rows in (self.held, self.flows)]

    def _records(
        self, rule: Quadrature, order: Basis, lines: tuple[NDArray, NDArray], families: NDArray, clocks: list[Clock]
    ) -> Iterator[tuple[NDArray, Tangents | None]]:
        """Yield the responses to waveforms, on all slabs of the rule: (rows, 2, slabs * s) arriving and leaving waves.

        Slabs begin by one lead earlier each; `lines` are admittances at all points. Rows are ends of recorded lines,
        and behind them probed nodes without a line.
        """
        ahead = [*families.tolist(), *(clock.ahead for clock in clocks[:1])]  # of what sources drive
        s, N, last = rule.points * self.network.second, len(self.network.names), len(ahead) - 1
        for some in np.array_split(np.arange(last + 1), min(int(len(s) * N * (last + 1) / MOST_HELD) + 1, last + 1)):
            given = [self._driven(rule, order, self._parts(rule.h, families, k, ahead[k])) for k in some.tolist()]
            sources = rule.forward(np.concatenate(given, axis=2)).reshape(len(s), len(some), 2, -1)
            held, flows = sources.transpose(2, 0, 3, 1)
            driven, from_laws = self.network.efforts(s, self.driving, held, flows, lines)
            for column, k in enumerate(some.tolist()):
                efforts = driven[:, :, column]
                if self.laws and k == last:
                    for waves, tangents in self.laws.waves(rule, order, clocks, efforts, from_laws):
                        due = (from_laws @ waves[:, :, None])[:, :, 0]
                        yield self._recorded(rule, due + efforts * (last == 0), lines), tangents
                        last = -1
                    continue
                record = self._recorded(rule, efforts, lines)
                if self.laws is None:  # otherwise laws may drive
                    sizes = np.abs(given[column]).max(axis=(0, 1)).reshape(2, -1).max(axis=1, initial=0.0)
                    least = ROUNDED * max(sizes * [1.0, self.network.z0.max()])
                    record[np.abs(record).max(axis=(1, 2)) <= least] = 0.0
                yield record, None

    def _driven(self, rule: Quadrature, order: Basis, parts: list[list[Excitation]]) -> NDArray:
        """Efforts held at nodes with sources, and behind them flows there, on slabs, (n, s, 2 nodes)."""
        values = np.zeros((rule.n, order.s, 2, len(self.driving)))
        for kind, rows in enumerate(parts):
            for column, node in enumerate(self.driving):
                for waveform, share in rows[node]:
                    values[:, :, kind, column] += share * projected(waveform, order, rule.h, 0, rule.n)
        return values.reshape(rule.n, order.s, -1)

    def _recorded(self, rule: Quadrature, efforts: NDArray, lines: tuple[NDArray, NDArray]) -> NDArray:
        """Waves that efforts at nodes in s send into recorded lines, and waves that arrive there."""
        numbers = {name: j for j, name in enumerate(self.description.lines)}
        ends = np.array([2 * numbers[name] + side for name in self.lines for side in (0, 1)], int)
        probed = [self.network.names.index(node) for node in self.description.probed_nodes]
        arrives = rule.backward(np.hstack([self.network.arriving(efforts, lines, ends), efforts[:, probed]]))
        u = rule.backward(efforts[:, [*self.network.node_of[ends], *probed]])
        return np.stack([arrives, 2 * u - arrives]).transpose(3, 0, 1, 2).reshape(len(ends) + len(probed), 2, -1)

    def _moved(self, order: Basis, h: float) -> tuple[NDArray, NDArray]:
        """Delays of fronts in each line, s, and whole slabs of them by which waves are moved as they are.

        The latter where that cannot create energy. Where no law answers that is no matter: nothing is fed back.
        """
        fronts = np.array([line.delay for line in self.description.lines.values()])
        for bundle in self.network.bundles.values():
            fronts[bundle.lines] = bundle.fronts(fast(order.s) / h)
        slabs = np.floor(fronts / h * (1 + WHOLE))
        if self.laws is None:
            return fronts, slabs
        for k, line in self.network.lossy.items():
            if gain(line, self.network.z0[k], order, h, slabs[k]) > MOST_GAIN:
                slabs[k] = 0.0
        for bundle in self.network.bundles.values():
            if bundle_creates_energy(bundle, order, h, slabs[bundle.lines]):
                slabs[bundle.lines] = 0.0
        return fronts, slabs

    def _start(self, name: str, k: int) -> NDArray:
        """Waves (a1, b1, a2, b2) of a line before t = 0, counted from the level."""
        line = self.description.lines[name]
        u = np.array([self.before.effort[at] for at in line.nodes])
        q = line.z0 * self.before.flows[k]
        return np.stack([u + q, u - q], axis=1).ravel()


def is_affordable(scene: Convolved, s: int, h: float) -> bool:
    """Whether a scene is convolved on slabs of an order and a width within some seconds."""
    families, clocks = scene.leads(h)
    runs, ends = max((len(families) + len(clocks)) / SHARED, 1.0), scene.network.size
    points = scene.description.t_end / h * s * runs
    if scene.description.t_end / h * (len(scene.network.laws) * s) ** 2 > MOST_BESIDE_LAWS:
        return False
    return (scene.laws is not None or scene.parts_into(len(families))) and points * ends * max(
        ends / CUBE_POINTS, 1
    ) ** 2 <= MOST_POINTS
