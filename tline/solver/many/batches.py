"""Copies run in batches that fit the cache, and what their probes see."""

from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray

from tline.compiled.structure import pack
from tline.errors import InputError
from tline.solver.description.description import Description
from tline.solver.description.given import Height
from tline.solver.many.copies import Copies
from tline.solver.many.period import driven_waves, modes_of
from tline.solver.radau import basis
from tline.solver.result.result import Samples
from tline.words.wording import place

Floats = NDArray[np.float64]
BATCH = 64  # copies in the kernel at once
PERIOD, ROOM, LARGEST = 25e3, 8e6, 1e8  # samples that are set up at once in a period, and in all; and of one copy


@dataclass(frozen=True, eq=False)
class ProbeOfCopies:
    """What one probe saw in all copies; Pa and m³/s, or V and A."""

    u: Floats  # (copies, instants) effort, piezometric pressure in a scene with elevations
    y: Floats  # (copies, instants) flow
    lowest: Floats  # (copies,) effort from t = 0, where it is that of rest, to the end
    lowest_at: Floats  # (copies,) when that is reached, s
    highest: Floats  # (copies,)
    highest_at: Floats  # (copies,)
    z0: Floats  # (copies,) impedance of its line

    def samples(self, t: Floats, height: Height) -> Samples:
        """What it saw at the instants asked for, at its height, all copies as first axis."""
        q = self.z0[:, None] * self.y
        return Samples(t, self.u, self.y, self.u + q, self.u - q, height)


def run(
    description: Description, copies: Copies, edges: Floats, s: int, rows: NDArray, t: Floats
) -> dict[str, ProbeOfCopies]:
    """Run those copies of some rows at order s, with slabs at edges (K + 1, copies); see them at instants t."""
    where = _line_ends(description)
    recorded = sorted({*where.values()})
    most = max(ceil(description.t_end / copies.unit[rows].min() - 1e-9), 1) * (len(edges) - 1) * s
    maps = len(copies.junctions) * (len(edges) - 1) * (s + 2) ** 2
    each = most * 2 * len(recorded) + maps + len(t) * s
    if each > LARGEST:
        problem = f"a copy takes {each:.2g} samples in {most // (len(edges) - 1) // s} common measures of its delays"
        raise InputError("t_end", problem, f"at most {LARGEST:.0e}: a shorter run")
    B = int(np.clip(ROOM / each, 1, min(BATCH, len(rows))))
    chunk = B * max(int(min(ROOM / each, PERIOD / (len(edges) - 1) / s) / B), 1)
    found = {name: [np.empty((len(rows), *shape)) for shape in 2 * [(len(t),)] + 4 * [()]] for name in where}
    by_unit = np.argsort(copies.unit[rows], kind="stable")
    for low in range(0, len(rows), chunk):
        mine = by_unit[low : low + chunk]
        mine = np.pad(mine, (0, -len(mine) % B), mode="edge").reshape(-1, B)  # the last copy fills the last batch
        extremes, values = _seen(description.t_end, copies, edges, s, rows[mine], recorded, t)
        for name, end in where.items():
            row = recorded.index(end)
            u, w = values[:, row, 0], values[:, row, 1]
            sign = 2 * (end % 2) - 1  # what arrives at end 2 is a, at end 1 it is b
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
    """Run copies (batches, B); of line ends the extremes of efforts and when, shape (batches, ends, 4, B).

    Beside them efforts and arriving waves at instants t, shape (batches, ends, 2, B, instants).
    """
    from tline.solver.kernel.peaks import extremes, find_extremes
    from tline.solver.many.kernel.advance import CopiesRun, Values, advance_copies, fill_maps, find_values, load_maps

    order, unit, junctions = basis(s), copies.unit[rows], copies.junctions
    rate, projector = modes_of(order)
    n = max(ceil(t_end / unit.min() - 1e-9), 1)
    edges = np.ascontiguousarray(edges[:, rows].transpose(1, 0, 2))
    widths = np.diff(edges, axis=1) * unit[:, None]
    slabs = widths.shape[1]
    loads = [
        [np.moveaxis(part[..., rows], -2, 0).copy() for part in junction.load]
        for junction in junctions
        if junction.load is not None
    ]
    states = max((load[1].shape[1] for load in loads), default=0)
    maps = np.zeros((len(loads), slabs, s + states, s + states, rows.shape[1]))
    drives = [[(shape, share[rows]) for shape, share in junction.drives] for junction in junctions if junction.drives]
    drive = driven_waves(drives, order, unit, edges, n, t_end)
    weights = np.concatenate([junction.weights[:, rows] for junction in junctions]).transpose(1, 0, 2).copy()
    record_row = np.full(2 * len(copies.delay), -1)
    record_row[recorded] = np.arange(len(recorded))
    arrays = (
        copies.delay,
        np.cumsum([0, *(len(junction.ends) for junction in junctions)]),
        np.concatenate([junction.ends for junction in junctions]),
        _rows([bool(junction.drives) for junction in junctions]),
        _rows([junction.load is not None for junction in junctions]),
        record_row,
    )
    ends, B = len(recorded), rows.shape[1]
    record = np.empty((ends, 2, n * slabs, s, B))
    offset = 2 * np.cumsum([0, *copies.delay])
    waves, states_before = np.empty((offset[-1], slabs, s, B)), np.empty((len(loads), states, B))
    work = offset, waves, states_before, np.empty((s + states, B)), np.empty((s + states, B))
    peaks, values = np.empty((len(rows), ends, 4, B)), np.empty((len(rows), ends, 2, B, len(t)))
    for batch in range(len(rows)):
        for k, load in enumerate(loads):
            own = (part[batch] for part in load)
            fill_maps(pack(load_maps(own, widths[batch], rate, projector, maps[k])))
        advance_copies(pack(CopiesRun(*arrays, weights[batch], maps, drive[batch], record, *work)), n)
        for row in range(ends):
            seen, powers = (unit[batch], edges[batch]), order.to_powers
            find_extremes(pack(extremes(record[row, 0], *seen, t_end, order.c, powers, peaks[batch, row])))
            if len(t):
                find_values(pack(Values(record[row], *seen, t, powers, values[batch, row], np.empty(s))))
    return peaks + 0.0, values  # no -0.0


def _rows(there: list[bool]) -> NDArray:
    return np.where(there, np.cumsum(there) - 1, -1)
