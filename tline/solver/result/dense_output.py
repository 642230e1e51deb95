"""Dense output: waves between slab ends, for drawing and for the search of extremes."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tline.compiled.structure import pack
from tline.solver.radau import thin_product
from tline.solver.result.quantities import Bounds, quantity
from tline.solver.result.result import LineRecord, ProbeResult, Samples, Wave

DENSE = 4000  # instants
AFTER = 1e-8  # distance behind an edge, in slabs, of the value just after it
ROUGH = 1e-2  # relative to the wave's range: larger highest coefficients and a jump at the edge mean a front inside
NOISE = 1e-13  # relative to the largest wave; a smaller effort, or flow times z0, is zero
PLACES = 5  # samples in a slab, at least, in the search of extremes
CANDIDATES, AROUND, ZOOMS = 16, 17, 7  # samples refined in the search, places around each, and refinements
TIE = 1e-9  # relative to the range: smaller differences of extremes count as ties
WIDEST = 4  # slabs over which a front may be smeared


def curve(probe: ProbeResult, least: int = 2) -> Samples:
    """Samples of a probe over the whole run: several in a slab, and both sides of every front and slab edge.

    A jump gives two values at one instant. Where a front was not followed, the polynomial of its slab oscillates;
    there the curve is a straight line between the slabs on either side, where values are accurate.

    Some four thousand instants, or `least` in a slab, edges included, if there are many slabs.
    """
    shown = replace(probe, record=drawable(probe.record))
    h, n, last = probe.slabs.width, probe.slabs.whole, probe.slabs.whole + probe.slabs.rest
    local = np.linspace(0.0, 1.0, max(DENSE // probe.slabs.number, least))
    behind = local == 0.0
    after = np.where(behind, AFTER, local)
    offsets = np.array([probe.share, 1.0 - probe.share]) * probe.record.delay / h % 1.0
    edges = offsets[(offsets > AFTER) & (offsets < 1.0 - 2 * AFTER) & (0.0 < probe.share < 1.0)]
    local = np.concatenate([local, edges, edges])
    after = np.concatenate([after, edges, edges + AFTER])
    behind = np.concatenate([behind, edges < 0.0, edges > 0.0])
    start, fronts = np.arange(n + (last > n))[:, None], _fronts(probe) / h
    instants = np.concatenate([[0.0], (start + after).ravel(), fronts, fronts + AFTER, [last]])
    order = np.argsort(instants, kind="stable")
    behind = np.concatenate([[False], np.tile(behind, len(start)), fronts < 0.0, fronts > 0.0, [False]])
    drawn = np.concatenate([[0.0], (start + local).ravel(), fronts, fronts, [last]])
    order = order[instants[order] <= last]
    t, instants = (np.where(each < last, each * h, probe.slabs.end) for each in (drawn[order], instants[order]))
    seen = _seen(shown, instants, behind[order], AFTER * h)
    noise, zero = NOISE * max(abs(seen.a).max(), abs(seen.b).max()), seen.height.weight
    u = np.where(abs(seen.gauge_pressure) > noise, seen.u, zero)
    y = np.where(abs(seen.y) > noise / probe.record.z0, seen.y, 0.0)
    return Samples(t, u, y, seen.a, seen.b, seen.height)


def _seen(probe: ProbeResult, t: NDArray, behind: NDArray, late: float) -> Samples:
    """Samples at rising instants; at those marked `behind` an edge, extrapolated to it from `late` after it.

    Instants with another one as near are not extrapolated.
    """
    seen, marked = probe.at(t), np.flatnonzero(behind & (np.diff(t, append=np.inf) > 2 * late))
    more = probe.at(t[marked] + late)
    for letter in "uyab":
        values = getattr(seen, letter)
        values[marked] = 2 * values[marked] - getattr(more, letter)
    return seen


def _fronts(probe: ProbeResult) -> NDArray:
    record, share = probe.record, probe.share
    if share in (0.0, 1.0):
        passing = [(record.a1 if share == 0.0 else record.a2, 0.0)]  # both waves at an end have the same pieces
    else:
        passing = [(record.a1, share * record.delay), (record.b2, (1.0 - share) * record.delay)]
    instants = [wave.breakpoints() + delay for wave, delay in passing]
    return np.unique(np.concatenate([t[t < probe.slabs.end] for t in instants]))


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
    """Smallest and largest value of the curve, and the instant when each is first reached.

    Slabs are sampled; around the highest values, or parabolas through three of them, the polynomials are searched.
    """
    if (waves := _at_end(probe)) is not None:
        return _of_polynomials(probe, key, *waves)
    seen, shown = curve(probe, PLACES), replace(probe, record=drawable(probe.record))
    what, z0, noise = quantity(key), probe.record.z0, NOISE * float(max(abs(seen.a).max(), abs(seen.b).max()))
    largest = float(abs(seen.u).max()), float(abs(seen.y).max())
    noise = what.error(Bounds(noise, noise / z0, z0, probe.height.per_metre, *largest))
    width = probe.slabs.width / max(DENSE // probe.slabs.number, PLACES)
    low, high = (highest(lambda t: what.of(shown.at(t)), seen.t, what.of(seen), sign, noise, width) for sign in (-1, 1))
    return low, high


def _at_end(probe: ProbeResult) -> tuple[Wave, Wave] | None:
    """Waves at an end of a line, as drawn; None elsewhere, or if their slabs are not in the same pieces."""
    (a, b), record = probe.waves, probe.record
    ours, theirs = a.pieces, b.pieces
    if probe.share not in (0.0, 1.0) or any(len(wave.values) != probe.slabs.number for wave in (a, b)):
        return None
    if len(ours.slab) != len(theirs.slab) or not np.array_equal(ours.slab + ours.span.T, theirs.slab + theirs.span.T):
        return None
    largest = ROUGH * _span(record) if record.smeared else np.inf
    return (_bridged(a, largest), _bridged(b, largest)) if record.smeared else (a, b)


def _polynomials(a: Wave, b: Wave) -> tuple[NDArray, NDArray, NDArray]:
    """Edges of the pieces of two waves, in slabs, and the values of both at their points."""
    pieces, whole = a.pieces, np.arange(len(a.values))
    if not len(pieces.slab):
        return np.arange(len(whole) + 1.0), a.values, b.values
    whole = np.delete(whole, pieces.slab)
    begin = np.append(whole, pieces.slab + pieces.span[:, 0])
    order = np.argsort(begin, kind="stable")
    one, other = (np.concatenate([wave.values[whole], wave.pieces.values])[order] for wave in (a, b))
    return np.append(begin[order], len(a.values)), one, other


def _of_polynomials(probe: ProbeResult, key: str, a: Wave, b: Wave) -> tuple[tuple[float, float], tuple[float, float]]:
    """Extremes of a quantity that is one polynomial in each piece, and the instants when they are first reached."""
    from tline.solver.kernel.peaks import extremes as search
    from tline.solver.kernel.peaks import find_extremes

    slabs, what, z0, order = probe.slabs, quantity(key), probe.record.z0, a.basis
    edges, *both = _polynomials(a, b)
    values = [np.append(wave.before, each) for wave, each in zip((a, b), both, strict=True)]
    noise = NOISE * max(float(abs(each).max()) for each in values)
    bounds = Bounds(noise, noise / z0, z0, probe.height.per_metre, *(2 * [noise / NOISE]))
    seen = np.asarray(what.of(probe._samples(np.empty(0), *values)))
    nothing = what.error(bounds)
    seen[np.abs(seen) <= nothing] = 0.0
    first, seen = float(seen[0]), seen - seen[0]  # the search expects a signal that begins at zero
    wave, end, found = seen[1:].reshape(len(edges) - 1, -1, 1), slabs.whole + slabs.rest, np.empty((4, 1))
    job = search(wave, edges[-1:], edges[:, None] / edges[-1], end, order.c, order.to_powers, found)
    find_extremes(pack(job))
    near, there, count = TIE * (found[2, 0] - found[0, 0]), [], int(np.searchsorted(edges, slabs.whole))
    for (value, at), top, sign in zip(found.reshape(2, 2).tolist(), job.top[:, :count, 0], (-1, 1), strict=True):
        least = sign * value - near
        k = int(np.argmax(top >= least)) if count else 0
        if count and edges[k] < at and top[k] >= least:  # of as large ones the first
            here = np.append(order.begin @ wave[k, :, 0], wave[k, :, 0])
            place = float(np.append(0.0, order.c)[np.argmax(sign * here >= least)])
            at = min(at, float(edges[k] + (edges[k + 1] - edges[k]) * place))
        value = value + first if abs(value + first) > nothing else 0.0
        there.append((value, slabs.width * (min(at, end) if least > 0.0 else 0.0)))
    return there[0], there[1]


def highest(
    at: Callable[[NDArray], NDArray],
    t: NDArray,
    values: NDArray,
    sign: int,
    noise: float,
    width: float,
    candidates: int = CANDIDATES,
) -> tuple[float, float]:
    """Largest value (sign 1) or smallest (sign -1) of a sampled signal, and its instant.

    Samples are several in a slab, `width` apart; a value between them must exceed theirs by `noise`. As many
    `candidates` as given are refined around the highest samples, and as many around the highest parabolas.
    """
    rising = sign * values
    fall = 2 * rising[1:-1] - rising[2:] - rising[:-2]
    top = (rising[1:-1] >= rising[2:]) & (rising[1:-1] >= rising[:-2]) & (fall > 0)
    gain = np.zeros(len(rising))
    gain[1:-1][top] = (rising[2:] - rising[:-2])[top] ** 2 / (8 * fall[top])
    few = min(candidates, len(t))
    best = np.unique(np.concatenate([np.argpartition(-each, few - 1)[:few] for each in (rising, rising + gain)]))
    found, heights = zoomed(lambda near: at(near.ravel()).reshape(near.shape), t[best], width, (t[0], t[-1]), sign)
    higher = heights > rising.max() + noise
    found, heights = found[higher], heights[higher]
    return extreme(np.append(values, sign * heights), np.append(t, found), sign)


def zoomed(
    at: Callable[[NDArray], NDArray], found: NDArray, width: float, span: tuple[float, float], sign: int
) -> tuple[NDArray, NDArray]:
    """Maximum of a signal times a sign around each of some instants within a span: its instant and value.

    `at` takes instants whose last axis lies around one of the instants given, within ± `width`.
    """
    around, heights = np.linspace(-1.0, 1.0, AROUND), np.empty(found.shape)
    for _ in range(ZOOMS):
        near = np.clip(found[..., None] + width * around, *span)
        height = sign * at(near)
        best = height.argmax(axis=-1)[..., None]
        found, heights = (np.take_along_axis(each, best, -1)[..., 0] for each in (near, height))
        width *= 4 / AROUND
    return found, heights


def extreme(samples: NDArray, t: NDArray, sign: int) -> tuple[float, float]:
    """Largest sample (sign 1) or smallest (sign -1), and the instant when it is first reached, within rounding."""
    best = (sign * samples).max()
    reached = sign * samples >= best - TIE * np.ptp(samples)
    return float(sign * best) + 0.0, float(t[reached].min())  # no negative zero
