"""Ledger of a run: energy supplied, dissipated and stored by every element and line, and the residual.

Energies through line ends and into elements are recorded slab by slab.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.solver.assembly.assemble import Assembly
from tline.solver.assembly.workspace import Fronts
from tline.solver.ledger.accounts import COLUMNS, GRAVITY, UNACCOUNTED, Columns, accounts_of
from tline.solver.loop.march import Noted
from tline.solver.loop.slabs import Slabs, cut_at_end
from tline.solver.radau import gauss
from tline.words.wording import place

TOLERANCE = 1e-3  # relative to the turnover; a larger loss or gain is reported
BLOCK = 100_000  # samples of a group's line ends processed together
NET = np.array([-1.0, 1.0, 1.0, 1.0, 0.0])  # weights of an account's columns in the energy that it takes
Found = tuple[NDArray, NDArray, NDArray]  # of pieces of a group: slab, span (pieces, 2), waves (pieces, rows, 2, s)


class Entry(NamedTuple):
    """Energies of one account, J."""

    # place of an element, a line or a node in the scene; of several elements if waves do not separate their shares
    where: str
    supplied: float  # by a source, a reservoir or a pump; negative if it absorbed energy
    dissipated: float  # in resistances, valves and diodes
    stored: float  # change of the stored energy
    taken: float  # dissipated and stored together, where these are not separable
    # lost by a line where fronts or fractional delays are projected on slabs (numerical
    # dissipation, negative by rounding only), or at a node whose flows do not balance
    unaccounted: float
    # largest energy that a passive account had given beyond that taken and stored, at any slab end; else 0
    created: float


class Ledger(NamedTuple):
    """Energy balance of a whole run, by element: supplied = dissipated + stored + taken + unaccounted.

    With elevations, energies of lines, sources and reservoirs count from the highest node, those of outlets to the
    open air from the gauge pressure; "gravity" supplies the difference, density·g·height for outflow below.

    Examples
    --------
    >>> from tline.scene.scene import Scene
    >>> from tline.solver.simulate import simulate
    >>> scene = Scene(
    ...     medium="electrical", t_end="40 ns", probes={"far": {"at": "far"}},
    ...     lines={"line": {"nodes": ["near", "far"], "z0": 50, "delay": "5 ns"}},
    ...     sources={"s": {"at": "near", "kind": "voltage", "value": 1, "resistance": 50}},
    ...     loads={"r": {"at": "far", "kind": "resistor", "resistance": 50}},
    ... )
    >>> ledger = simulate(scene, ledger=True).ledger
    >>> print(f"{ledger.of('sources.s').supplied:.3g} J, {ledger.of('loads.r').dissipated:.3g} J")
    4e-10 J, 1.75e-10 J
    """

    entries: tuple[Entry, ...]  # lines first, then elements, then nodes
    turnover: float  # energy of lossless lines before t = 0, and the most that each account gave at any time, J

    def of(self, where: str) -> Entry:
        """Return the account at a place in the scene, such as ``"lines.pipe"``."""
        for entry in self.entries:
            if entry.where == where:
                return entry
        raise InputError("ledger", "no such account", "a line or an element such as 'lines.NAME'", repr(where))

    @property
    def total(self) -> Entry:
        """Sum of all accounts, column by column."""
        return Entry("sum", *(float(part) for part in self._numbers().sum(axis=0)))

    @property
    def residual(self) -> float:
        """Sum of the absolute unaccounted energies over the turnover; 0 if nothing moved."""
        off = float(np.abs(self._numbers()[:, UNACCOUNTED]).sum())
        return off / self.turnover if self.turnover else 0.0

    @property
    def notes(self) -> tuple[str, ...]:
        """Sentences on a residual, or energy created, beyond a thousandth of the turnover, with the largest cause."""
        told, bound = [], TOLERANCE * self.turnover
        if self.residual > TOLERANCE:
            worst = max(self.entries, key=lambda entry: abs(entry.unaccounted))
            did = f"{worst.where} lost" if worst.unaccounted > 0 else f"{worst.where} made"
            told.append(
                f"ledger: {self.residual:.2g} of the energy turned over is not accounted for; {did} most of it, "
                f"{abs(worst.unaccounted):.3g} J; narrower slabs or a higher order are off by less"
            )
        makers = [entry for entry in self.entries if entry.created > bound]
        told += [f"ledger: {e.where} gave {e.created:.3g} J more than it had taken" for e in makers]
        return tuple(told)

    def _numbers(self) -> NDArray:
        return np.array([entry[1:] for entry in self.entries], float).reshape(-1, len(COLUMNS) + 1)


class Recorder:
    """Recorder of the energies of a run, slab by slab."""

    def __init__(self, assembly: Assembly, slabs: Slabs):
        description, network = assembly.description, assembly.network
        description.refuse_coupled("a ledger")
        self.assembly, self.slabs, self.h = assembly, slabs, slabs.width
        inner = np.flatnonzero(np.diff(network.first) == 0)  # nodes without line ends
        assembly.watch(np.arange(len(network.ends)), inner)
        self.rows = np.append(network.record_row, network.effort_row[inner])  # of the record, by place
        self.place_of_row = np.full(assembly.rows, -1)  # none of laws
        self.place_of_row[self.rows] = np.arange(len(self.rows))
        lines, names = list(assembly.lines.values()), list(assembly.nodes)
        self.z0 = np.array([line.z0 for line in lines])
        places = {names[k]: place for place, k in enumerate(inner.tolist(), len(network.ends))}
        self.groups = [accounts_of(description, group, self.z0, places) for group in assembly.groups]
        self.start = stored(assembly, None)
        self.taken, self.least, self.behind = np.zeros((3, len(lines)))
        self.totals = [np.zeros((len(group.where), len(COLUMNS))) for group in self.groups]
        self.lowest = [np.zeros(len(group.where)) for group in self.groups]
        self.group_of, self.row_in_group = np.full((2, len(self.rows)), -1)
        for g, group in enumerate(self.groups):
            self.group_of[group.places], self.row_in_group[group.places] = g, np.arange(len(group.places))

    def see(self, record: NDArray, first: int, n: int, pieces: Noted) -> None:
        """Account for n slabs from number `first` on, which begin at the first column of the record."""
        s = self.assembly.basis.s
        through = np.zeros((len(self.z0), n))  # energy into each line in each slab
        found = self._sorted(self._until_end(record, first, n, pieces))
        for g, group in enumerate(self.groups):
            rows = self.rows[group.places]
            step = max(BLOCK // (max(len(rows), 1) * s), 1)
            for low in range(0, n, step):
                high = min(low + step, n)
                waves = record[rows, :, low * s : high * s].reshape(len(rows), 2, high - low, s)
                slabs = first + np.arange(low, high)
                self._post(g, waves, slabs, found.get(g), through[:, low:high])
        so_far = self.taken[:, None] + np.cumsum(through, axis=1)
        self.taken, self.least = so_far[:, -1], np.minimum(self.least, so_far.min(axis=1))

    def _until_end(self, record: NDArray, first: int, n: int, pieces: Noted) -> Noted:
        """Pieces by place in place of row, up to the end of the run; energies into lines behind it are kept."""
        at = self.place_of_row[pieces.row]
        pieces = Noted(at[at >= 0], *(part[at >= 0] for part in pieces[1:]))
        if first + n <= self.slabs.whole:
            return pieces
        basis, last = self.assembly.basis, self.slabs.whole - first
        waves = record[self.rows, :, last * basis.s : (last + 1) * basis.s]
        pieces, behind = cut_at_end(self.slabs, waves, pieces, basis)
        behind = behind.of_rows(2 * len(self.z0))
        (w, o), line = behind.values.swapaxes(0, 1), behind.row // 2
        columns = Columns(basis, self.h, behind.slab, behind.span)
        np.subtract.at(self.behind, line, columns.integral((w - o) * (w + o)) / (4 * self.z0[line]))
        return pieces

    def _post(self, g: int, waves: NDArray, slabs: NDArray, found: Found | None, through: NDArray) -> None:
        group, basis = self.groups[g], self.assembly.basis
        columns = Columns(basis, self.h, slabs)
        out, posted = group.energies(waves[:, 0], waves[:, 1], columns)
        if found is not None:
            these = slice(*np.searchsorted(found[0], [slabs[0], slabs[-1] + 1]))
            slab, span, waves = (part[these] for part in found)
            if len(slab):
                w, o = waves.transpose(2, 1, 0, 3)
                parts = group.energies(w, o, Columns(basis, self.h, slab, span))
                starts = np.flatnonzero(np.diff(slab, prepend=-1))
                for whole, part in zip((out, posted), parts, strict=True):
                    whole[..., slab[starts] - slabs[0]] = np.add.reduceat(part, starts, axis=-1)
        ends = group.places < 2 * len(self.z0)
        np.subtract.at(through, group.places[ends] // 2, out[ends])
        so_far = (self.totals[g] @ NET)[:, None] + np.cumsum(np.tensordot(posted, NET, (1, 0)), axis=1)
        self.lowest[g] = np.minimum(self.lowest[g], so_far.min(axis=1))
        self.totals[g] += posted.sum(axis=2)

    def _sorted(self, pieces: Noted) -> dict[int, Found]:
        """Pieces by group; in one group and slab they have the same spans in all rows."""
        g, s = self.group_of[pieces.row], self.assembly.basis.s
        order = np.lexsort((self.row_in_group[pieces.row], pieces.span[:, 0], pieces.slab, g))
        found = {}
        for number, start, count in zip(*np.unique(g[order], return_index=True, return_counts=True), strict=True):
            if number >= 0:  # else at what a source between two nodes prescribes
                these, rows = order[start : start + count], len(self.groups[number].places)
                waves = pieces.values[these].reshape(-1, rows, 2, s)
                found[int(number)] = pieces.slab[these[::rows]], pieces.span[these[::rows]], waves
        return found

    def ledger(self, fronts: Fronts | None) -> Ledger:
        """Ledger of the finished run."""
        entries = self._of_lines(stored(self.assembly, fronts) - self.behind)
        lossless = np.array([line.losses is None for line in self.assembly.lines.values()])
        turnover = float(np.where(lossless, self.start, np.maximum(-self.least, 0.0)).sum())
        gravity = np.zeros(len(COLUMNS))
        for group, totals, lowest in zip(self.groups, self.totals, self.lowest, strict=True):
            turnover -= float(lowest.sum())
            for where, may_give, numbers, low in zip(group.where, group.may_give, totals, lowest, strict=True):
                if where == GRAVITY:
                    gravity += numbers
                else:
                    entries.append(Entry(where, *numbers.tolist(), created=0.0 if may_give else 0.0 - float(low)))
        if self.assembly.description.heights:
            entries.append(Entry(GRAVITY, *gravity.tolist(), created=0.0))
        return Ledger(tuple(entries), turnover)

    def _of_lines(self, end: NDArray) -> list[Entry]:
        at_rest, entries = not self.assembly.description.steady, []
        for k, (name, line) in enumerate(self.assembly.lines.items()):
            where, taken, least = place("lines", name), float(self.taken[k]), float(self.least[k])
            if line.losses is None:
                change = float(end[k] - self.start[k])
                created = max(0.0, -least - float(self.start[k]))
                entries.append(Entry(where, 0.0, 0.0, change, 0.0, taken - change, created))
            else:
                entries.append(Entry(where, 0.0, 0.0, 0.0, taken, 0.0, 0.0 - least if at_rest else 0.0))
        return entries


def stored(assembly: Assembly, fronts: Fronts | None) -> NDArray:
    """Energy in lossless lines: integral of (a² + b²)/(4 z0) over waves under way, J, shape (lines,).

    It includes the part of the last arrived slab that a fractional delay still holds back.
    """
    network, state, basis = assembly.network, assembly.state, assembly.basis
    s, h, weights = basis.s, assembly.resolution.h, basis.A[-1]
    lines = list(assembly.lines.values())
    z0 = np.array([line.z0 for line in lines])
    rest = np.array([line.delay for line in lines]) / h - network.delay
    total = np.add.reduceat(state.waves**2 * np.tile(weights, state.waves.size // s), network.offset)
    for k in np.flatnonzero(network.shift_row >= 0):
        held = state.before[2 * k : 2 * k + 2] @ basis.restriction(1 - rest[k], 1.0).T
        total[k] += rest[k] * (held**2 @ weights).sum()
    if fronts is not None:
        pieces = fronts.pieces
        slab, end = np.flatnonzero(pieces.of_slab >= 0), np.flatnonzero(pieces.before >= 0)
        line = np.searchsorted(network.offset, slab * s, side="right") - 1
        np.add.at(total, line, _squares(fronts, pieces.of_slab[slab], np.zeros(len(slab))))
        np.add.at(total, end // 2, _squares(fronts, pieces.before[end], 1.0 - fronts.rest[end // 2]))
    return h * total / (4 * z0)


def _squares(fronts: Fronts, rows: NDArray, after: NDArray) -> NDArray:
    """Integral of the squares of slabs in pieces, each from an instant `after` on, in slab time."""
    pieces, (x, weights) = fronts.pieces, gauss(fronts.pieces.coef.shape[2])
    start, stop = pieces.start[rows, :-1], pieces.start[rows, 1:]
    there = np.arange(start.shape[1]) < pieces.number[rows][:, None]
    start, stop = np.where(there, start, 1.0), np.where(there, stop, 1.0)
    cut = np.clip(after[:, None], start, stop)
    places = 2 * (cut[..., None] + (stop - cut)[..., None] * x - start[..., None])
    y = places / np.where(stop > start, stop - start, 1.0)[..., None] - 1
    coef = np.where(there[..., None], pieces.coef[rows], 0.0)
    values = np.einsum("rpxk,rpk->rpx", np.polynomial.legendre.legvander(y, len(x) - 1), coef)
    return ((stop - cut) * (values**2 @ weights)).sum(axis=1)
