"""Dense output: waves between slab ends as the polynomials that they are, at probes and inside lines.

Inside a line a = a1(t - x/c) - A and b = b2(t - (l - x)/c) + B, whose losses A and B grow along each characteristic
by dA = (p + g) dx and dB = (p - g) dx, with p the drop per metre and g = z0 times the leakage. Both follow by Picard's
iteration on a lattice of places and instants, with the trapezoidal rule along the characteristics, and are of second
order in its step; a front on the way costs up to half the loss of a cell.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import ceil

import numpy as np
from numpy.typing import NDArray

from tline.compiled.structure import pack
from tline.distinct import distinct
from tline.errors import InputError
from tline.loss import Foster
from tline.solver.description.description import describe
from tline.solver.description.given import Stretches
from tline.solver.description.lines import circuits_of, fit_of
from tline.solver.radau import Basis, thin_product
from tline.solver.result.merged import CutRecord
from tline.solver.result.quantities import Bounds, quantity
from tline.solver.result.result import ProbeResult, Result, Samples
from tline.solver.result.wave import LineRecord, Wave
from tline.words.wording import place

DENSE = 4000  # instants
ROUGH = 1e-2  # relative to the wave's range: larger highest coefficients and a jump at the edge mean a front inside
NOISE = 1e-13  # relative to the largest wave; a smaller effort, or flow times z0, is zero
WIDEST = 4  # slabs over which a front may be smeared
NEAR = 2.5e-9  # slabs; edges nearer to each other are one
WAVES = "a1", "b1", "a2", "b2"
Passing = Sequence[tuple[Wave, float]]  # waves as they are at ends of a line, and how much later they pass a place
CELLS = 16
INSTANTS, OF_SLAB = 2000, 2  # of the lattice on a lossless line: in all and in a slab, at least
MOST_INSTANTS = 20_000  # of a lattice with more than one cell; a lossless line has more between them
ROUGHLY = 1e-5  # tolerance of circuits where a run had none
LAST_CHANGE, MOST_ROUNDS = 1e-6, 200  # the iteration ends at this change, relative to the largest wave


def shown(record: LineRecord, share: float) -> Passing:
    """Waves a and b that pass a place, as they are drawn, and how much later than at the end that they come from."""
    passing = record.passing(share)
    if not record.smeared:
        return passing
    largest = ROUGH * _span(record)
    return [(_bridged(wave, largest), late) for wave, late in passing]


def edges_of(passing: Passing, end: float) -> NDArray:
    """Instants between which all waves are one polynomial each, s, from 0 to the end of the run."""
    h = passing[0][0].h
    if all(wave.h == h and late == 0.0 and not len(wave.pieces.slab) for wave, late in passing):
        return np.append(h * np.arange(np.ceil(end / h - NEAR)), end)
    each = [late + wave.h * np.append(np.arange(len(wave.values) + 1.0), wave.begins) for wave, late in passing]
    edges = distinct(np.concatenate([[0.0], *each]))
    edges = edges[(edges >= 0.0) & (edges < end - NEAR * h)]
    return np.append(edges[np.diff(edges, prepend=-np.inf) > NEAR * h], end)


def on(wave: Wave, late: float, edges: NDArray, x: NDArray) -> NDArray:
    """Values of a wave at places x, 0 to 1, between each two of the edges, shape (edges - 1, places)."""
    start, stop = edges[:-1] - late, edges[1:] - late
    return wave.between(start, stop, NEAR * wave.h, x)


def curve(probe: ProbeResult) -> Samples:
    """Samples of a probe over the whole run: several between each two fronts or slab edges, and both sides of these.

    A jump gives two values at one instant. Where a front was not followed, the polynomial of its slab oscillates;
    there the curve is a straight line between the slabs on either side, where values are accurate. Some four thousand
    instants, or more if there are many slabs.
    """
    passing = shown(probe.record, probe.share)
    edges = edges_of(passing, probe.slabs.end)
    x = np.linspace(0.0, 1.0, max(DENSE // len(edges), 2))
    t = np.append(0.0, edges[:-1, None] + np.diff(edges)[:, None] * x)
    t[-1] = edges[-1]
    seen = probe.of_waves(t, *(np.append(wave.before, on(wave, late, edges, x)) for wave, late in passing))
    noise, zero = NOISE * max(abs(seen.a).max(), abs(seen.b).max()), seen.height.weight
    u = np.where(abs(seen.gauge_pressure) > noise, seen.u, zero)
    y = np.where(abs(seen.y) > noise / probe.record.z0, seen.y, 0.0)
    return replace(seen, u=u, y=y)


def drawable(record: LineRecord) -> LineRecord:
    """Return the record with straight lines across slabs that hold unfollowed fronts."""
    if not record.smeared:
        return record
    largest = ROUGH * _span(record)
    return replace(record, **{name: _bridged(getattr(record, name), largest) for name in WAVES})


def _span(record: LineRecord) -> float:
    """Range of the waves; zero if it is only rounding."""
    ends = [getattr(record, name).at_slab_ends() for name in WAVES]
    span = max(float(np.ptp(values)) for values in ends)
    return span if span > NOISE * max(float(np.abs(values).max()) for values in ends) else 0.0


def _bridged(wave: Wave, largest: float) -> Wave:
    """Draw a straight line across each front, from the end of the slab before it to the start of the slab after it.

    Fronts are in rough slabs: in one piece, with large highest coefficients, of which one alone may vanish by chance,
    and a jump at an edge. Where these go on for more than a few, something oscillates too fast for them, and the
    polynomials stay as they are.
    """
    first, highest = wave.basis.begin, wave.basis.to_legendre[max(wave.basis.s - 2, 1) :]
    starts, begins = np.append(thin_product(wave.values, first), wave.values[-1, -1]), wave.pieces.span[:, 0] == 0.0
    starts[wave.pieces.slab[begins]] = wave.pieces.values[begins] @ first
    ends = wave.at_slab_ends()
    breaks = np.abs(starts - ends) > largest
    if not breaks.any():
        return wave
    tail = np.abs(thin_product(wave.values, highest.T)).max(axis=1, initial=0.0)
    rough = (tail > largest) & (breaks[:-1] | breaks[1:])
    rough[wave.pieces.slab] = False
    change = np.diff(np.concatenate([[0], rough, [0]]))
    low, high = np.nonzero(change == 1)[0], np.nonzero(change == -1)[0]
    few = high - low <= WIDEST
    low, high = low[few], high[few]
    if not len(low):
        return wave
    slabs = np.concatenate([np.arange(p, q) for p, q in zip(low, high, strict=True)])
    knots, levels = np.stack([low, high], 1).ravel(), np.stack([ends[low], starts[high]], 1).ravel()
    values: NDArray = wave.values.copy()
    values[slabs] = np.interp(slabs[:, None] + wave.basis.c, knots, levels)
    return replace(wave, values=values)


def extremes(probe: ProbeResult, key: str) -> tuple[tuple[float, float], tuple[float, float]]:
    """Smallest and largest value of the curve, and the instant when each is first reached."""
    passing = shown(probe.record, probe.share)
    what, z0, order = quantity(key), probe.record.z0, passing[0][0].basis
    edges = edges_of(passing, probe.slabs.end)
    waves = [np.append(wave.before, on(wave, late, edges, order.c)) for wave, late in passing]
    largest = max(float(abs(wave).max()) for wave in waves)
    bounds = Bounds(NOISE * largest, NOISE * largest / z0, z0, probe.height.per_metre, largest, largest)
    seen, nothing = np.asarray(what.of(probe.of_waves(np.empty(0), *waves))), what.error(bounds)
    seen[np.abs(seen) <= nothing] = 0.0
    low, high = search(float(seen[0]), edges, seen[1:].reshape(len(edges) - 1, -1), order)
    return tuple((x if abs(x) > nothing else 0.0, at) for x, at in (low, high))  # type: ignore[return-value]


def search(
    first: float, edges: NDArray, values: NDArray, order: Basis
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Smallest and largest value of a signal that is one polynomial between each two edges, and when each is first met.

    Values are those at the points of an order, shape (edges - 1, points), `first` is the value before.
    """
    from tline.solver.kernel.finished import TIE, extremes as searching, find_extremes

    wave, found = np.ascontiguousarray(values - first)[:, :, None], np.empty((4, 1))  # what is sought begins at zero
    begin, length = edges[0], edges[-1] - edges[0]
    places = (edges[:, None] - begin) / length
    job = searching(wave, np.array([length]), places, float(length), order.c, order.to_powers, found)
    find_extremes(pack(job))
    near, there = TIE * (found[2, 0] - found[0, 0]), []
    for (value, at), top, sign in zip(found.reshape(2, 2).tolist(), job.top[:, :, 0], (-1, 1), strict=True):
        least = sign * value - near
        k, at = int(np.argmax(top >= least)), float(begin) + at
        if least > 0.0 and edges[k] < at and top[k] >= least:  # of as large ones the first
            here = np.append(order.begin @ wave[k, :, 0], wave[k, :, 0])
            place = float(np.append(0.0, order.c)[np.argmax(sign * here >= least)])
            at = min(at, float(edges[k] + (edges[k + 1] - edges[k]) * place))
        there.append((value + first, min(at, float(edges[-1])) if least > 0.0 else float(begin)))
    return there[0], there[1]


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
            at = distinct(np.concatenate(late))
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


def _lost(result: Result, line: str, record: LineRecord, cells: int, t: NDArray) -> NDArray:
    """Losses A (taken from a) and B (added to b) at places and instants."""
    losses = result.scene.single_lines[line].losses
    assert losses is not None
    cell = losses.exact.length / cells
    if not (circuits := result.circuits.get(line)):  # of a run without any
        fit = fit_of(float(result.t[-1]), t[1], ROUGHLY)
        circuits = circuits_of({line: describe(result.scene).lines[line]}, fit)[line]
    (entered1, _), (_, entered2) = record.at_end1, record.at_end2
    way, n = round(record.delay / cells / t[1]), len(t)  # of a cell, in steps
    early, late = t[1] * np.arange(-cells * way, n), [way * j for j in range(cells + 1)]
    a, b = entered1(early), entered2(early)
    a0, b0 = np.stack([a[cells * way - k :][:n] for k in late]), np.stack([b[k:][:n] for k in late])
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
