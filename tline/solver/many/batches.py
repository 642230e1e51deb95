"""Copies run in batches that fit the cache, and the records of their probes."""

from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray

from tline.compiled.structure import pack
from tline.errors import InputError
from tline.solver.description.description import Description
from tline.solver.description.given import Height
from tline.solver.description.load_step import StateSpace, load_step
from tline.solver.kernel.peaks import extremes, find_extremes
from tline.solver.many.copies import Copies
from tline.solver.many.kernel.advance import CopiesRun, Values, advance_copies, find_values
from tline.solver.many.period import driven_waves
from tline.solver.radau import basis
from tline.solver.result.result import Samples
from tline.words.wording import place

Floats = NDArray[np.float64]
BATCH = 64  # copies in the kernel at once
PERIOD, ROOM, LARGEST = 25e3, 8e6, 1e8  # most samples that are set up at once in a period, and in all; and of one copy


@dataclass(frozen=True, eq=False)
class ProbeOfCopies:
    """Record of one probe in all copies; Pa and m³/s, or V and A."""

    u: Floats  # (copies, instants) effort, piezometric pressure in a scene with elevations
    y: Floats  # (copies, instants) flow
    lowest: Floats  # (copies,) effort from t = 0, where it is that of rest, to the end
    lowest_at: Floats  # (copies,) when that is reached, s
    highest: Floats  # (copies,)
    highest_at: Floats  # (copies,)
    z0: Floats  # (copies,) impedance of its line

    def samples(self, t: Floats, height: Height) -> Samples:
        """Return the samples at the requested instants, at the probe's height, all copies as first axis."""
        q = self.z0[:, None] * self.y
        return Samples(t, self.u, self.y, self.u + q, self.u - q, height)


def run(
    description: Description, copies: Copies, edges: Floats, s: int, rows: NDArray, t: Floats
) -> dict[str, ProbeOfCopies]:
    """Run the copies of some rows at order s, with slabs at edges (K + 1, copies), and sample them at instants t."""
    where, slabs = _line_ends(description), len(edges) - 1
    recorded = sorted({*where.values()})
    most = max(ceil(description.t_end / copies.unit[rows].min() - 1e-9), 1) * slabs * s
    each = most * 2 * len(recorded) + len(copies.junctions) * slabs * (s + 2) ** 2 + len(t) * s
    if each > LARGEST:
        problem = f"a copy takes {each:.2g} samples in {most // slabs // s} common measures of its delays"
        raise InputError("t_end", problem, f"at most {LARGEST:.0e}: a shorter run")
    B = int(np.clip(ROOM / each, 1, min(BATCH, len(rows))))
    chunk = B * max(int(min(ROOM / each, PERIOD / slabs / s) / B), 1)
    found = {name: [np.empty((len(rows), *shape)) for shape in 2 * [(len(t),)] + 4 * [()]] for name in where}
    by_unit = np.argsort(copies.unit[rows], kind="stable")
    for low in range(0, len(rows), chunk):
        mine = by_unit[low : low + chunk]
        mine = np.pad(mine, (0, -len(mine) % B), mode="edge").reshape(-1, B)  # the last copy fills the last batch
        extremes, values = _seen(description.t_end, copies, edges, s, rows[mine], recorded, t)
        for name, end in where.items():
            row = recorded.index(end)
            u, w = values[:, row, 0], values[:, row, 1]
            sign = 2 * (end % 2) - 1  # the wave arriving at end 2 is a, at end 1 it is b
            seen = u, sign * (w - u) / copies.z0[end // 2, rows[mine], None], *extremes[:, row].swapaxes(0, 1)
            for array, part in zip(found[name], seen, strict=True):
                array[mine] = part
    for name, (u, _, lowest, _, highest, _) in found.items():
        for effort in (u, lowest, highest):
            effort += description.probes[name].height.level
    return {name: ProbeOfCopies(*arrays, z0=copies.z0[where[name] // 2, rows]) for name, arrays in found.items()}


def _line_ends(description: Description) -> dict[str, int]:
    lines, ends = list(description.lines), {}
    for name, probe in description.probes.items():
        if probe.share not in (0.0, 1.0) or not probe.line:
            problem = "inside a line" if probe.line else "sees a node's effort alone"
            raise InputError(place("probes", name), problem, "a probe at the end of a line, for many runs")
        ends[name] = 2 * lines.index(probe.line) + int(probe.share)
    return ends


def _seen(
    t_end: float, copies: Copies, edges: Floats, s: int, rows: NDArray, recorded: list[int], t: Floats
) -> tuple[Floats, Floats]:
    """Run copies (batches, B); return extremes of efforts at line ends, with instants, (batches, ends, 4, B).

    Also returned are efforts and arriving waves at instants t, shape (batches, ends, 2, B, instants).
    """
    order, unit, junctions, B = basis(s), copies.unit[rows], copies.junctions, rows.shape[1]
    n = max(ceil(t_end / unit.min() - 1e-9), 1)
    edges = np.ascontiguousarray(edges[:, rows].transpose(1, 0, 2))
    slabs, ends, widths = edges.shape[1] - 1, len(recorded), np.diff(edges, axis=1) * unit[:, None]
    loads = [StateSpace(*(part[rows] for part in each.load)) for each in junctions if each.load is not None]
    states = max((load.b.shape[-2] for load in loads), default=0)
    drives = [[(shape, share[rows]) for shape, share in each.drives] for each in junctions if each.drives]
    drive = driven_waves(drives, order, unit, edges, n, t_end)
    weights = np.concatenate([each.weights[:, rows] for each in junctions]).transpose(1, 0, 2).copy()
    offset, record_row = 2 * np.cumsum([0, *copies.delay]), np.full(2 * len(copies.delay), -1)
    record_row[recorded] = np.arange(ends)
    maps, record = np.zeros((len(loads), slabs, s + states, s + states, B)), np.empty((ends, 2, n * slabs, s, B))
    network = {
        "delay": copies.delay,
        "first": np.cumsum([0, *(len(each.ends) for each in junctions)]),
        "ends": np.concatenate([each.ends for each in junctions]),
        "drive_row": _rows([bool(each.drives) for each in junctions]),
        "load_row": _rows([each.load is not None for each in junctions]),
        "record_row": record_row,
        "maps": maps,
        "record": record,
        "offset": offset,
        "waves": np.empty((offset[-1], slabs, s, B)),
        "states": np.empty((len(loads), states, B)),
        "u": np.empty((s + states, B)),
        "out": np.empty((s + states, B)),
    }
    peaks, values = np.empty((len(rows), ends, 4, B)), np.empty((len(rows), ends, 2, B, len(t)))
    for batch in range(len(rows)):
        for k, load in enumerate(loads):
            step = load_step(StateSpace(*(part[batch] for part in load)), order, widths[batch])
            maps[k, :, : step.shape[-1], : step.shape[-1]] = step.transpose(0, 3, 2, 1)
        advance_copies(pack(CopiesRun(**network, weight=weights[batch], drive=drive[batch])), n)
        for row in range(ends):
            seen, powers = (unit[batch], edges[batch]), order.to_powers
            find_extremes(pack(extremes(record[row, 0], *seen, t_end, order.c, powers, peaks[batch, row])))
            if len(t):
                find_values(pack(Values(record[row], *seen, t, powers, values[batch, row], np.empty(s))))
    return peaks + 0.0, values  # no -0.0


def _rows(there: list[bool]) -> NDArray:
    return np.where(np.array(there, bool), np.cumsum(there, dtype=int) - 1, -1)
