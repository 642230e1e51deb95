"""Interior field of a line, from the waves that entered at its ends and their losses under way.

With a = a1(t - x/c) - A and b = b2(t - (l - x)/c) + B, the accumulated losses A and B grow along each characteristic by
the local loss of the line, dA = (p + g) dx and dB = (p - g) dx, with p the drop per metre and g = z0 times
the leakage per metre. Both follow by Picard's iteration on a lattice of places and instants, with the trapezoidal rule
along the characteristics, and are of second order in its step; a front on the way costs up to half the loss of a cell.
"""

from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.loss import Foster
from tline.solver.description.circuits import Circuits, circuits_of, fit_of
from tline.solver.description.description import describe
from tline.solver.description.given import Stretches
from tline.solver.result.dense_output import drawable, edges_of, on, search
from tline.solver.result.merged import CutRecord
from tline.solver.result.result import LineRecord, Result
from tline.words.wording import place

CELLS = 16
INSTANTS, OF_SLAB = 2000, 2  # of the lattice on a lossless line: in all and in a slab, at least
MOST_INSTANTS = 20_000  # of a lattice with more than one cell; a lossless line has more between them
ROUGHLY = 1e-5  # tolerance of circuits where a run had none
LAST_CHANGE, MOST_ROUNDS = 1e-6, 200  # the iteration ends at this change, relative to the largest wave


@dataclass(frozen=True, eq=False)
class Inside:
    """Waves and effort inside a recorded line."""

    record: LineRecord  # waves at its ends
    t: NDArray  # (instants,) instants of the lattice, s: the delay of a cell is a whole number of its steps
    # (2, cells + 1, instants) losses A and B at places apart by equal delays; None for a
    # lossless line
    lost: NDArray | None
    cells: int  # number of intervals between these places

    @property
    def places(self) -> NDArray:
        """Shares of the delay at which extremes are looked for."""
        return np.arange(self.cells + 1) / self.cells

    def waves(self, t: NDArray, share: float) -> tuple[NDArray, NDArray]:
        """Waves (a, b) at instants t and a place given as a share of the delay, from 0 to 1."""
        a, b = self.record.waves(t, share)
        if self.lost is None or share in (0.0, 1.0):
            return a, b
        j = min(int(share * self.cells), self.cells - 1)
        weight = share * self.cells - j
        A, B = (1 - weight) * self.lost[:, j] + weight * self.lost[:, j + 1]
        return a - np.interp(t, self.t, A), b + np.interp(t, self.t, B)

    def effort(self, t: NDArray, share: float) -> NDArray:
        """Effort, Pa or V, at instants t and a place given as a share of the delay, from 0 to 1."""
        a, b = self.waves(t, share)
        return (a + b) / 2

    def extremes(self, slab_ends: NDArray) -> NDArray:
        """Effort before t = 0, lowest and highest effort, shape (3, places)."""
        return self._on_lattice(slab_ends) if self.lost is not None else self._searched(slab_ends[-1])

    def _on_lattice(self, slab_ends: NDArray) -> NDArray:
        """Extremes where losses are known on the lattice alone; slab ends show pulses shorter than its cells."""
        seen = []
        for share in self.places.tolist():
            way = self.record.delay * share  # waves are as they were at slab ends a way ago
            late = [slab_ends, slab_ends + way, slab_ends + self.record.delay - way, self.t]
            at = np.unique(np.concatenate(late))
            u = self.effort(at[at <= slab_ends[-1]], share)
            seen.append((u[0], u.min(), u.max()))
        return np.array(seen).T

    def _searched(self, t_end: float) -> NDArray:
        """Extremes of waves without losses, as the polynomials that they are."""
        found = []
        for share in self.places.tolist():
            passing = self.record.passing(share)
            edges, order = edges_of(passing, t_end), passing[0][0].basis
            u = sum(on(wave, late, edges, order.c) for wave, late in passing) / 2
            start = sum(wave.before for wave, _ in passing) / 2
            found.append((start, *(value for value, _ in search(start, edges, np.asarray(u), order))))
        return np.array(found).T


@dataclass(frozen=True, eq=False)
class InStretches:
    """Waves and effort inside a line in stretches."""

    cut: Stretches
    stretches: "list[Inside]"  # from end 1 on

    @property
    def places(self) -> NDArray:
        """Shares of the delay at which extremes are looked for."""
        parts = zip(self.cut.shares[:-1], self.cut.widths, self.stretches, strict=True)
        inner = [float(begin) + width * each.places[:-1] for begin, width, each in parts]
        return np.concatenate([*inner, [1.0]])

    def waves(self, t: NDArray, share: float) -> tuple[NDArray, NDArray]:
        """Waves (a, b) at instants t and a place given as a share of the delay, from 0 to 1."""
        k, part = self.cut.stretch_at(share)
        return self.stretches[k].waves(t, part)

    def effort(self, t: NDArray, share: float) -> NDArray:
        """Effort at instants t and a place given as a share of the delay, from 0 to 1."""
        a, b = self.waves(t, share)
        return (a + b) / 2

    def extremes(self, slab_ends: NDArray) -> NDArray:
        """Effort before t = 0, lowest and highest effort, shape (3, places)."""
        seen = [each.extremes(slab_ends) for each in self.stretches]
        return np.concatenate([seen[0], *(each[:, 1:] for each in seen[1:])], axis=1)


def inside(result: Result, line: str, cells: int = CELLS) -> Inside | InStretches:
    """Interior field of a recorded line.

    Losses are computed at the ends of `cells` cells, or of fewer if the run is far longer than the delay.

    References
    ----------
    R. Courant, D. Hilbert: Methods of Mathematical Physics II (1962), V.6: iteration along characteristics.

    Examples
    --------
    >>> from tline.scene.scene import Scene
    >>> from tline.solver.simulate import simulate
    >>> scene = Scene(
    ...     medium="electrical", t_end="40 ns", probes={"near": {"at": "near"}},
    ...     lines={"c": {"nodes": ["near", "far"], "z0": 50, "delay": "5 ns", "length": 1, "resistance": 50}},
    ...     sources={"s": {"at": "near", "kind": "voltage", "value": 1, "resistance": 50}},
    ...     loads={"r": {"at": "far", "kind": "resistor", "resistance": 100}}, start="steady",
    ... )
    >>> middle = inside(simulate(scene, record=["c"]), "c").effort(np.array([30e-9]), 0.5)
    >>> print(middle.round(6))  # 1 V over 50 + 50 + 100 ohm, 125 of these from the middle on
    [0.625]
    """
    if line not in result.lines:
        raise InputError("path", f"line '{line}' was not recorded", "simulate(scene, record=[…]) with it")
    record = result.lines[line]
    if isinstance(record, CutRecord) and result.parts is not None:
        parts = zip(record.cut.lines, record.cut.widths, strict=True)
        return InStretches(record.cut, [_inside(result.parts, name, ceil(cells * width)) for name, width in parts])
    return _inside(result, line, cells)


def _inside(result: Result, line: str, cells: int) -> Inside:
    record = drawable(result.lines[line])
    t_end, single = float(result.t[-1]), result.scene.single_lines.get(line)
    cells = max(min(cells, int(MOST_INSTANTS * record.delay / t_end)), 1)
    cell = record.delay / cells
    lossless = line not in result.circuits and (single is None or single.losses is None)
    step = cell / ceil(cell / min(t_end / INSTANTS, result.slabs.width / OF_SLAB)) if lossless else cell
    t = step * np.arange(ceil(t_end / step) + 1)
    return Inside(record, t, None if lossless else _lost(result, line, record, cells, t), cells)


def _entered(record: LineRecord, cells: int, n: int, step: float) -> tuple[list[NDArray], list[NDArray]]:
    """Waves a and b without losses, at the places and the first n instants of a lattice."""
    (entered1, _), (_, entered2) = record.at_end1, record.at_end2
    way = round(record.delay / cells / step)  # of a cell, in steps
    before = cells * way
    early = step * np.arange(-before, n)
    a, b = entered1(early), entered2(early)
    late = [way * j for j in range(cells + 1)]
    return [a[before - k :][:n] for k in late], [b[k:][:n] for k in late]


def _circuits(result: Result, line: str, step: float) -> Circuits:
    """Circuits that approximate the laws of a line that was computed without circuits."""
    return circuits_of({line: describe(result.scene).lines[line]}, fit_of(float(result.t[-1]), step, ROUGHLY))[line]


def _lost(result: Result, line: str, record: LineRecord, cells: int, t: NDArray) -> NDArray:
    """Losses A (taken from a) and B (added to b) at places and instants."""
    losses = result.scene.single_lines[line].losses
    assert losses is not None
    cell = losses.exact.length / cells
    circuits = result.circuits.get(line) or _circuits(result, line, t[1])
    a0, b0 = map(np.stack, _entered(record, cells, len(t), t[1]))
    size = max(np.abs(a0).max(), np.abs(b0).max())
    A = B = np.zeros_like(a0)
    for _ in range(MOST_ROUNDS):
        a, b = a0 - A, b0 + B
        y = (a - b) / (2 * record.z0)
        drop = cell * _taken(circuits.series, y, t[1]) + losses.friction(y)[0] / cells
        leak = cell * record.z0 * _taken(circuits.shunt, (a + b) / 2, t[1])
        before, A, B = (A, B), _along(drop + leak), _along((drop - leak)[::-1])[::-1]
        change = max(np.abs(new - old).max() for new, old in zip((A, B), before, strict=True))
        if change <= LAST_CHANGE * size:
            return np.stack([A, B])
    raise InputError(place("lines", line), "loses too much for what is inside it to be found", "shorter lines")


def _along(taken: NDArray) -> NDArray:
    """Sum of the losses of cells along the characteristic from the first place on; steady before the first instant."""
    total = np.zeros_like(taken)
    for j in range(1, len(taken)):
        behind = total[j - 1] + taken[j - 1] / 2
        total[j] = np.append(behind[0], behind[:-1]) + taken[j] / 2
    return total


def _taken(law: Foster, z: NDArray, step: float) -> NDArray:
    """Drop (or leakage) per metre of a law without its storage, for flows (or efforts) z linear between instants."""
    taken = law.loss * z
    for strength, rate in zip(law.strengths, law.rates, strict=True):
        from scipy.signal import lfilter

        decay = np.exp(-rate * step)
        mean = -np.expm1(-rate * step) / (rate * step)
        slow, _ = lfilter([1 - mean, mean - decay], [1, -decay], z, zi=mean * z[:, :1])
        taken = taken + strength * (z - slow)
    return taken
