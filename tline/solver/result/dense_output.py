"""Dense output: waves between slab ends as the polynomials that they are, for drawing, extremes and measures."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tline.compiled.structure import pack
from tline.solver.radau import Basis, thin_product
from tline.solver.result.quantities import Bounds, quantity
from tline.solver.result.result import LineRecord, ProbeResult, Samples, Wave

DENSE = 4000  # instants
ROUGH = 1e-2  # relative to the wave's range: larger highest coefficients and a jump at the edge mean a front inside
NOISE = 1e-13  # relative to the largest wave; a smaller effort, or flow times z0, is zero
TIE = 1e-9  # relative to the range: smaller differences of extremes count as ties
WIDEST = 4  # slabs over which a front may be smeared
NEAR = 2.5e-9  # slabs; edges nearer to each other are one

Passing = Sequence[tuple[Wave, float]]  # waves as they are at ends of a line, and how much later they pass a place


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
    edges = np.unique(np.concatenate([[0.0], *each]))
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
    a1, b1, a2, b2 = (_bridged(wave, largest) for wave in _waves(record))
    return replace(record, a1=a1, b1=b1, a2=a2, b2=b2)


def _waves(record: LineRecord) -> tuple[Wave, Wave, Wave, Wave]:
    return record.a1, record.b1, record.a2, record.b2


def _span(record: LineRecord) -> float:
    """Range of the waves; zero if it is only rounding."""
    ends = [wave.at_slab_ends() for wave in _waves(record)]
    span = max(float(np.ptp(values)) for values in ends)
    return span if span > NOISE * max(float(np.abs(values).max()) for values in ends) else 0.0


def _tail(wave: Wave) -> NDArray:
    """Largest of the two highest Legendre coefficients of each slab; one alone may vanish by chance."""
    highest = wave.basis.to_legendre[max(wave.basis.s - 2, 1) :]
    return np.abs(thin_product(wave.values, highest.T)).max(axis=1, initial=0.0)


def _edges(wave: Wave) -> tuple[NDArray, NDArray]:
    first = wave.basis.begin
    starts, begins = np.append(thin_product(wave.values, first), wave.values[-1, -1]), wave.pieces.span[:, 0] == 0.0
    starts[wave.pieces.slab[begins]] = wave.pieces.values[begins] @ first
    return starts, wave.at_slab_ends()


def _rough(wave: Wave, breaks: NDArray, largest: float) -> NDArray:
    """Slabs in one piece with large highest coefficients and a jump at an edge."""
    rough = (_tail(wave) > largest) & (breaks[:-1] | breaks[1:])
    rough[wave.pieces.slab] = False
    return rough


def _bridged(wave: Wave, largest: float) -> Wave:
    """Draw a straight line across each front, from the end of the slab before it to the start of the slab after it.

    Where rough slabs go on for more than a few, something oscillates too fast for them, and the polynomials stay as
    they are.
    """
    starts, ends = _edges(wave)
    breaks = np.abs(starts - ends) > largest
    if not breaks.any():
        return wave
    change = np.diff(np.concatenate([[0], _rough(wave, breaks, largest), [0]]))
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
    from tline.solver.kernel.peaks import extremes as searching
    from tline.solver.kernel.peaks import find_extremes

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
