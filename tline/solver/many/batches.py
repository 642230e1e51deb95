"""Copies run in batches that fit the cache, and the records of their probes."""

from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray

from tline.compiled.structure import Packed, pack
from tline.errors import InputError
from tline.solver.description.circuit import StateSpace, load_step
from tline.solver.description.description import Description
from tline.solver.description.given import Height, Shape
from tline.solver.kernel.finished import extremes, find_extremes
from tline.solver.kernel.network import Crossing
from tline.solver.kernel.units import law_addresses
from tline.solver.many.copies import Copies, driven_waves
from tline.solver.many.kernel import (
    Apart,
    CopiesRun,
    LawsOfCopies,
    Values,
    advance_copies,
    find_apart,
    find_values,
)
from tline.solver.radau import Basis, basis
from tline.solver.result.result import Samples
from tline.solver.tolerance.compare import SILENT, SMALLEST_ESTIMATE
from tline.words.wording import place

Floats = NDArray[np.float64]
BATCH = 64  # copies in the kernel at once
PERIOD, ROOM, LARGEST = 25e3, 8e6, 1e8  # most samples that are set up at once in a period, and in all; and of one copy


@dataclass(frozen=True, eq=False)
class ProbeOfCopies:
    """Record of one probe in all copies; Pa and m³/s, or V and A."""

    u: Floats  # (copies, instants) effort, piezometric pressure in a scene with elevations
    y: Floats  # (copies, instants) flow
    lowest: Floats  # (copies,) effort from t = 0, where it is that before, to the end
    lowest_at: Floats  # (copies,) when that is reached, s
    highest: Floats  # (copies,)
    highest_at: Floats  # (copies,)
    # (copies, slabs of a period) differences of two orders, relative to the amplitude; no slabs of a run at one order
    apart: Floats
    z0: Floats  # (copies,) impedance of its line

    def samples(self, t: Floats, height: Height) -> Samples:
        """Return the samples at the requested instants, at the probe's height, all copies as first axis."""
        q = self.z0[:, None] * self.y
        return Samples(t, self.u, self.y, self.u + q, self.u - q, height)


def run(
    description: Description,
    copies: Copies,
    edges: Floats,
    s: int,
    rows: NDArray,
    t: Floats,
    *,
    judged: bool = False,
) -> dict[str, ProbeOfCopies]:
    """Run the copies of some rows at order s, with slabs at edges (K + 1, copies), and sample them at instants t.

    If `judged`, they run at the next higher order as well, which is then the recorded one.
    """
    lines, where, orders = list(description.lines), {}, [basis(s), basis(s + 1)] if judged else [basis(s)]
    for name, probe in description.probes.items():
        if probe.share not in (0.0, 1.0) or not probe.line:
            problem = "inside a line" if probe.line else "sees a node's effort alone"
            raise InputError(place("probes", name), problem, "a probe at the end of a line, for many runs")
        where[name] = 2 * lines.index(probe.line) + int(probe.share)
    recorded, points, K = sorted({*where.values()}), orders[-1].s, len(edges) - 1
    most = max(ceil(description.t_end / copies.unit[rows].min() - 1e-9), 1) * K * points
    maps = len(copies.junctions) * K * (points + 2) ** 2
    each = (most * 2 * len(recorded) + maps) * len(orders) + len(t) * points
    if each > LARGEST:
        problem = f"a copy takes {each:.2g} samples in {most // K // points} common measures of its delays"
        raise InputError("t_end", problem, f"at most {LARGEST:.0e}: a shorter run")
    B = int(np.clip(ROOM / each, 1, min(BATCH, len(rows))))
    chunk = B * max(int(min(ROOM / each, PERIOD / K / points) / B), 1)
    shapes = [*2 * [(len(t),)], *4 * [()], (K if judged else 0,)]
    found = {name: [np.empty((len(rows), *shape)) for shape in shapes] for name in where}
    by_unit = np.argsort(copies.unit[rows], kind="stable")
    for low in range(0, len(rows), chunk):
        mine = by_unit[low : low + chunk]
        mine = np.pad(mine, (0, -len(mine) % B), mode="edge").reshape(-1, B)  # the last copy fills the last batch
        extremes, values, apart = _seen(description.t_end, copies, edges, orders, rows[mine], recorded, t)
        for name, end in where.items():
            row = recorded.index(end)
            u, w = values[:, row, 0], values[:, row, 1]
            sign = 2 * (end % 2) - 1  # the wave arriving at end 2 is a, at end 1 it is b
            lowest, lowest_at, highest, highest_at = extremes[:, row].swapaxes(0, 1)
            told = _relative(apart[:, row], lowest, highest, description.probes[name].height)
            flows = sign * (w - u) / copies.z0[end // 2, rows[mine], None]
            seen = u, flows, lowest, lowest_at, highest, highest_at, told
            for array, part in zip(found[name], seen, strict=True):
                array[mine] = part
    for name, (u, _, lowest, _, highest, *_) in found.items():
        for effort in (u, lowest, highest):
            effort += description.probes[name].height.level
    return {name: ProbeOfCopies(*arrays, z0=copies.z0[where[name] // 2, rows]) for name, arrays in found.items()}


def _relative(apart: Floats, lowest: Floats, highest: Floats, height: Height) -> Floats:
    """Differences over amplitudes (batches, B, K), by differences (batches, 3, K, B) and efforts above the level."""
    off_u, off_q, q = apart.transpose(1, 0, 3, 2)
    flow = q.max(axis=2, initial=0.0)[..., None]
    effort = np.maximum(height.above_level - lowest, highest - height.above_level)[..., None]
    worst = np.full(off_u.shape, SMALLEST_ESTIMATE)
    for off, scale in ((off_u, effort), (off_q, flow)):
        heard = ~(scale <= SILENT * np.maximum(effort, flow))
        with np.errstate(divide="ignore", invalid="ignore"):
            worst = np.maximum(worst, np.where(heard, off / scale, 0.0))
    return worst


def _seen(
    t_end: float, copies: Copies, edges: Floats, orders: list[Basis], rows: NDArray, recorded: list[int], t: Floats
) -> tuple[Floats, Floats, Floats]:
    """Run copies (batches, B); return extremes of efforts at line ends, with instants, (batches, ends, 4, B).

    Also returned are efforts and arriving waves at instants t, shape (batches, ends, 2, B, instants), and the
    differences of two orders, as in `Apart`.
    """
    unit, ends, B = copies.unit[rows], len(recorded), rows.shape[1]
    n = max(ceil(t_end / unit.min() - 1e-9), 1)
    edges = np.ascontiguousarray(edges[:, rows].transpose(1, 0, 2))
    slabs = edges.shape[1] - 1
    each, fine = [_OneOrder(t_end, copies, edges, order, rows, recorded, n) for order in orders], orders[-1]
    record, start = each[-1].record, copies.start[:, recorded][:, :, rows]
    peaks, values = np.empty((len(rows), ends, 4, B)), np.empty((len(rows), ends, 2, B, len(t)))
    started, apart = start.any(), np.zeros((len(rows), ends, 3, slabs if len(orders) > 1 else 0, B))
    begin = (np.arange(n)[:, None, None] + edges[:, None, :-1]).reshape(len(rows), n * slabs, B)
    in_time = (begin * unit[:, None] < t_end).sum(axis=1)
    for batch in range(len(rows)):
        for order in each:
            advance_copies(order.ready(batch), n)
        if len(orders) > 1:
            to_fine = orders[0].evaluation(fine.c)
            work = in_time[batch], apart[batch], np.empty((2, B))
            find_apart(pack(Apart(each[0].record, record, to_fine, *work)))
        for row in range(ends):
            here = start[:, row, batch]  # without it waves are zero at t = 0
            if started:
                record[row] -= here[:, None, None]
            seen, powers = (unit[batch], edges[batch]), fine.to_powers
            find_extremes(pack(extremes(record[row, 0], *seen, t_end, fine.c, powers, peaks[batch, row])))
            if len(t):
                find_values(pack(Values(record[row], *seen, t, powers, values[batch, row], np.empty(fine.s))))
            peaks[batch, row, ::2] += here[0]
            values[batch, row] += here[..., None]
    return peaks + 0.0, values, apart  # no -0.0


class _OneOrder:
    """Batches of copies at one order, ready to be advanced by n periods."""

    def __init__(
        self, t_end: float, copies: Copies, edges: Floats, order: Basis, rows: NDArray, recorded: list[int], n: int
    ):
        junctions, s, slabs, B = copies.junctions, order.s, edges.shape[1] - 1, rows.shape[1]
        unit, every = copies.unit[rows], np.ones(len(copies.unit))
        self._copies, self._rows, self._packed = copies, rows, None
        self._order, self._widths = order, np.diff(edges, axis=1) * unit[:, None]
        with_states = [junction for junction in junctions if junction.load is not None]
        self._loads = [StateSpace(*(part[rows] for part in each.load or ())) for each in with_states]
        self._at_loads = [junction.ends[0] for junction in with_states]
        states = max((load.b.shape[-2] for load in self._loads), default=0)
        self.record = np.empty((len(recorded), 2, n * slabs, s, B))
        self._laws = [(each.law, each.impedance) for each in junctions if each.law is not None]
        laws, driven = [law for law, _ in self._laws], [each.drives for each in junctions if each.drives]
        there = [law.beyond is not None for law in laws]
        more = [law.control for law in laws] + [law.beyond for law in laws if law.beyond is not None]
        shown = [*driven, *([(waveform, every)] for waveform in more)]
        record_row = np.full(2 * len(copies.delay), -1)
        record_row[recorded] = np.arange(len(recorded))
        offset, most = 2 * np.cumsum([0, *copies.delay]), s + states
        self._run = {
            "delay": copies.delay,
            "first": np.cumsum([0, *(len(junction.ends) for junction in junctions)]),
            "ends": np.concatenate([junction.ends for junction in junctions]),
            "drive_row": _rows([bool(junction.drives) for junction in junctions]),
            "load_row": _rows([junction.load is not None for junction in junctions]),
            "record_row": record_row,
            "maps": np.zeros((len(self._loads), slabs, most, most, B)),
            "record": self.record,
            "offset": offset,
            "waves": np.empty((offset[-1], slabs, s, B)),
            "states": np.empty((len(self._loads), states, B)),
            "u": np.empty((most, B)),
            "out": np.empty((most, B)),
        }
        shown = [
            [(shape if isinstance(shape, Shape) else shape[rows], share[rows]) for shape, share in parts]
            for parts in shown
        ]
        self._drive = driven_waves(shown, order, unit, edges, n, t_end)
        self._weights = np.concatenate([j.weights[:, rows] for j in junctions]).transpose(1, 0, 2).copy()
        self._arriving = np.ascontiguousarray(copies.start[1][:, rows].transpose(1, 0, 2))
        self._placed_laws = LawsOfCopies(
            row=_rows([junction.law is not None for junction in junctions]),
            unit=law_addresses([law.unit for law in laws]),
            sign=np.array([law.sign for law in laws], float),
            control_row=len(driven) + np.arange(len(laws)),
            beyond_row=np.where(np.array(there, bool), len(driven) + len(laws) + _rows(there), -1),
            at=np.zeros((len(laws), B), int),
            impedance=np.zeros((len(laws), B)),
            crossing=Crossing(np.zeros(0), *np.empty((4, s))),
        )

    def ready(self, batch: int) -> Packed:
        """Return a batch before t = 0."""
        rows, maps, states = self._rows[batch], self._run["maps"], self._run["states"]
        states.fill(0.0)
        for k, (load, end) in enumerate(zip(self._loads, self._at_loads, strict=True)):
            system = StateSpace(*(part[batch] for part in load))
            step = load_step(system, self._order, self._widths[batch])
            maps[k, :, : step.shape[-1], : step.shape[-1]] = step.transpose(0, 3, 2, 1)
            effort = self._copies.start[0, end, rows]
            if effort.any():  # a wave that has been constant for long
                held = np.linalg.solve(system.A, -system.b)[..., 0]
                states[k, : held.shape[1]] = held.T * effort
        varied = {"weight": self._weights[batch], "drive": self._drive[batch], "arriving": self._arriving[batch]}
        values = CopiesRun(**self._run, **varied, laws=self._laws_of(rows))
        if self._packed is None:
            self._packed = pack(values)
        else:
            self._packed.write(values)
        return self._packed

    def _laws_of(self, rows: NDArray) -> LawsOfCopies:
        """Return the laws of a batch, with constants copy by copy."""
        placed = self._placed_laws
        if not self._laws:
            return placed
        constants = [law.constants[rows] for law, _ in self._laws]
        begins = np.cumsum([0, *(each.size for each in constants)])
        at = [begin + np.arange(len(rows)) * each.shape[1] for begin, each in zip(begins, constants, strict=False)]
        crossing = placed.crossing._replace(constants=np.concatenate([each.ravel() for each in constants]))
        return placed._replace(at=np.array(at), impedance=np.array([z[rows] for _, z in self._laws]), crossing=crossing)


def _rows(there: list[bool]) -> NDArray:
    return np.where(np.array(there, bool), np.cumsum(there, dtype=int) - 1, -1)
