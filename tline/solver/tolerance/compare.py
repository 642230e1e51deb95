"""Estimated errors of a run, from its differences to a finer one.

Inside slabs each run has its own polynomials. They are compared in every slab of the finer run: in one piece, at
Chebyshev's places; where a front of either run lies inside, at such places of every piece, on both sides of the front.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.compiled.structure import pack
from tline.distinct import distinct
from tline.solver.description.description import Description
from tline.solver.description.groups import filling_times
from tline.solver.kernel.finished import BLOCK, Compared, find_difference
from tline.solver.loop.slabs import Slabs
from tline.solver.radau import Matrix, basis, chebyshev, thin_product
from tline.solver.result.accuracy import SLOWEST, Accuracy, Estimate
from tline.solver.result.result import ProbeResult, Result
from tline.solver.result.wave import Wave

SMALLEST_ESTIMATE = 2e-15  # relative to the amplitude; no estimate is smaller
NOTHING = 1e-13  # relative to the largest amplitude of all probes; smaller amplitudes are rounding
SILENT = 1e-9  # relative to the larger of u and z0·y; errors of a smaller amplitude count as zero
BETWEEN = 1.5  # ratio of the largest difference at any instant to that at the places compared
BY_ORDER, BY_SLAB = 0.2, 0.5  # shares of the previous difference; a step that leaves less resolves every decay
STEPS = 2  # consecutive steps that must do so: two runs may agree by accident
ROUNDED = 1e-13  # relative to the amplitude; smaller differences are rounding
BESIDE = 1e-7  # slabs, from an edge without a front to the places beside it
SAME_BREAK = 2.5e-9  # slabs of the coarser run; nearer breaks count as one, for each run moves them by up to 1e-9
ROUNDINGS = 32  # roundings of an instant by which two runs may differ about one front
CLUSTER = 4  # narrow pieces side by side
EPS = float(np.finfo(float).eps)
SETTLES = 16  # settling times of lumped lines: a piece up to that wide is blurred, for each pass adds one
CHUNK = 100_000  # slabs at a time


def is_smooth(coarse: ProbeResult, fine: ProbeResult) -> bool:
    """Whether both are at the end of a line, with samples at the ends of their own slabs, none of them in pieces."""
    return fine.share in (0.0, 1.0) and all(
        len(wave.values) == probe.slabs.number and not len(wave.pieces.slab)
        for probe in (coarse, fine)
        for wave in (probe.record.a1, probe.record.a2)
    )


def smooth_difference(
    coarse: ProbeResult, fine: ProbeResult, count: int, every: int, places: int
) -> tuple[NDArray, NDArray, NDArray]:
    """Largest differences at slab ends of the coarser run and at any place, and largest values of the finer one.

    Each holds effort and z0 times flow, shape (2,), over `count` coarse slabs of `every` fine ones. Places in each fine
    slab are Chebyshev's, and its end.
    """
    s, other = coarse.waves[0].basis.s, fine.waves[0].basis.s
    weight, most = fine.height.weight, np.zeros((6, BLOCK))
    a, b = (np.ascontiguousarray(wave.values[:count]) for wave in coarse.waves)
    c, d = (np.ascontiguousarray(wave.values[: count * every]) for wave in fine.waves)
    work = np.empty((2, s, BLOCK)), np.empty((2, other, BLOCK)), np.empty((4, BLOCK)), most
    find_difference(pack(Compared(a, b, c, d, *at_same_places(s, other, every, places), 2 * weight, *work)))
    at_ends, inside, largest = most.max(axis=1).reshape(3, 2) / 2
    (a, b), (c, d) = ([wave.before for wave in probe.waves] for probe in (fine, coarse))
    at_ends = np.maximum(at_ends, np.abs([a - c + b - d, a - c - b + d]) / 2)
    return at_ends, np.maximum(inside, at_ends), np.maximum(largest, [abs(a + b - 2 * weight) / 2, 0.0])


@lru_cache
def at_same_places(coarse: int, fine: int, every: int, places: int) -> tuple[Matrix, Matrix]:
    """Matrices from values at the points of a slab of either order to values at the places."""
    x = np.append((1 - np.cos(np.pi * np.arange(places) / places)) / 2, 1.0)
    spread = (np.arange(every)[:, None] + x).ravel() / every
    return basis(coarse).evaluation(spread).reshape(every, len(x), coarse), basis(fine).evaluation(x)


class Difference(NamedTuple):
    """Differences of effort (pressures are gauge pressures) and flow times impedance z0·y, each of shape (2,)."""

    at_ends: NDArray  # largest difference at slab ends
    inside: NDArray  # largest difference at all places except while lumped lines settle after a front
    blurred: NDArray  # largest difference at all places
    amplitude: NDArray  # largest value of the finer run


def difference(coarse: ProbeResult, fine: ProbeResult, settle: float = 0.0, followed: bool = False) -> Difference:
    """Compare a probe in two runs; a slab of the coarser run is a whole number of slabs of the finer one.

    `settle` is the settling time of lumped lines after a front, s; `followed` says whether both runs follow decays
    behind fronts, so that peaks in pieces too narrow to be compared are known by their height.
    """
    every = round(coarse.record.a1.h / fine.record.a1.h)
    slabs = Slabs.until(fine.slabs.end, coarse.record.a1.h)
    whole, n = slabs.whole * every, Slabs.until(slabs.end, fine.record.a1.h).number
    narrow, blurred = SETTLES * settle, np.zeros(2)
    if is_smooth(coarse, fine) and round(coarse.slabs.width / fine.slabs.width) == every:
        places = len(chebyshev(max(*(probe.waves[0].basis.s for probe in (coarse, fine)))))
        at_ends, inside, amplitude = smooth_difference(coarse, fine, slabs.whole, every, places)
        broken = np.zeros(n, bool)
    else:
        at_ends, amplitude = difference_at_ends(coarse, fine)
        inside, broken = at_ends, _broken(coarse, fine, n)
        for off, most in _in_one_piece(coarse, fine, every, broken[:whole]):
            inside, amplitude = np.maximum(inside, off), np.maximum(amplitude, most)
    broken[whole:] = True  # up to the end of the run
    off, most = _in_pieces(coarse, fine, broken, narrow, np.inf, followed)
    inside, amplitude = np.maximum(inside, off), np.maximum(amplitude, most)
    if settle:
        blurred, _ = _in_pieces(coarse, fine, broken, 0.0, narrow, followed)
    return Difference(at_ends, inside, np.maximum(inside, blurred), amplitude)


def difference_at_ends(coarse: ProbeResult, fine: ProbeResult) -> tuple[NDArray, NDArray]:
    """Largest differences at slab ends alone, and largest values there, of gauge effort and z0 times flow."""
    seen = fine.at_slab_ends, coarse.at_slab_ends
    ends, theirs = (np.stack([each.gauge_pressure, fine.record.z0 * each.y]) for each in seen)
    there = ends[:, :: round(coarse.slabs.width / fine.slabs.width)]
    common = min(there.shape[1], theirs.shape[1])
    return np.abs(there[:, :common] - theirs[:, :common]).max(axis=1), np.abs(ends).max(axis=1)


def _in_one_piece(coarse: ProbeResult, fine: ProbeResult, every: int, broken: NDArray):
    """The largest difference, and value, at places of the fine slabs without a front, chunk by chunk, of shape (2,)."""
    x = np.array(chebyshev(max(*(probe.waves[0].basis.s for probe in (coarse, fine)))))
    if 0.0 < fine.share < 1.0:
        each = (
            (probe.record.a1.h / k, delay) for probe, k in ((fine, 1), (coarse, every)) for _, delay in probe.passing
        )
        edges = [delay / h % 1.0 for h, delay in each]
        x = distinct(np.clip([*x, *(edge + d for edge in edges for d in (-BESIDE, BESIDE))], 0.0, 1.0 - BESIDE))
    n, whole = len(broken), ~broken
    in_coarse = (np.arange(every)[:, None] + x).ravel() / every
    for first in range(0, n // every, CHUNK):
        count = min(CHUNK, n // every - first)
        kept = whole[first * every : (first + count) * every]
        ours = on_slabs(fine, x, first * every, count * every)
        theirs = on_slabs(coarse, in_coarse, first, count).reshape(2, count * every, len(x))
        yield tuple(_largest(each[:, kept]) for each in (theirs - ours, ours))


def on_slabs(probe: ProbeResult, x: NDArray, first: int, n: int) -> NDArray:
    """Gauge effort and z0 times flow at places x, in slabs, of n slabs from a first one on, shape (2, n, places)."""
    a, b = (_wave_on_slabs(wave, delay / wave.h, x, first, n) for wave, delay in probe.passing)
    return np.stack([(a + b) / 2 - probe.height.weight, (a - b) / 2])


def _wave_on_slabs(wave: Wave, late: float, x: NDArray, first: int, n: int) -> NDArray:
    """Return values of a wave delayed by `late` slabs, shape (n, places)."""
    slab = np.floor(x - late).astype(int)
    seen = np.empty((n, len(x)))
    for k in distinct(slab):
        here = slab == k
        begin = min(max(first + int(k), 0), first + n)
        none = min(max(-first - int(k), 0), n)
        values = wave.values[begin : begin + n - none]
        seen[:none, here] = wave.before
        seen[none:, here] = thin_product(values, wave.basis.evaluation(x[here] - late - k).T)
    return seen


def _in_pieces(
    coarse: ProbeResult, fine: ProbeResult, broken: NDArray, narrowest: float, widest: float, followed: bool
) -> tuple[NDArray, NDArray]:
    """Largest difference, and value, in pieces between two widths, of slabs that hold fronts; each of shape (2,).

    Places are shares of their piece, or runs would differ by the rounding of a front's instant. That rounding is added
    for a wave that rises evenly: where it rises in 1e-9 s after 1 s, 2e-7 of the rise.
    """
    n, h = len(broken), fine.record.a1.h
    if not broken.any():
        return np.zeros(2), np.zeros(2)
    slabs = np.flatnonzero(broken)
    passing = (*coarse.passing, *fine.passing)
    fronts = np.concatenate([wave.breakpoints() + delay for wave, delay in passing])
    edges = [slabs * h + late % h for late in (0.0, *(late for _, late in fine.passing))]  # of the waves' slabs, too
    end = min(n * h, fine.slabs.end)
    knots = distinct(np.concatenate([*edges, slabs * h + h, fronts, [end]]))
    knots = knots[(knots >= 0) & (knots <= end)]
    same = SAME_BREAK * coarse.record.a1.h + ROUNDINGS * EPS * knots
    kept = np.diff(knots, prepend=-np.inf) > same
    knots, same = knots[kept], same[kept]
    start, stop = knots[:-1], knots[1:]
    width = stop - start
    kept = (width > narrowest) & (width <= widest) & broken[np.minimum(((start + stop) / 2 / h).astype(int), n - 1)]
    start, stop, width, same = start[kept], stop[kept], width[kept], same[1:][kept]
    x = np.array([*chebyshev(fine.waves[0].basis.s), 1.0])
    seen = []  # gauge effort and z0 times flow at places x of pieces, shape (2, pieces, places)
    for probe in (coarse, fine):
        a, b = (wave.between(start - delay, stop - delay, same, x) for wave, delay in probe.passing)
        seen.append(np.stack([(a + b) / 2 - probe.height.weight, (a - b) / 2]))
    theirs, ours = seen
    rounding = np.ptp(ours, axis=2) * (EPS * stop / width)
    off = _largest(np.abs(theirs - ours) + rounding[:, :, None])
    if not narrowest:
        risen, before = (_overlooked(probe, SAME_BREAK * coarse.record.a1.h) for probe in (fine, coarse))
        off = np.maximum(off, abs(risen - before) if followed else risen)
    return off, _largest(ours)


def _overlooked(probe: ProbeResult, narrow: float) -> float:
    """Height by which a wave rises above both its sides, or falls below them, in pieces too narrow to compare."""
    most = 0.0
    for wave, late in probe.passing:
        start, stop = wave.h * (wave.pieces.slab[:, None] + wave.pieces.span).T
        real = (stop - start <= narrow) & (stop - start > ROUNDINGS * EPS * stop) & (start + late < probe.slabs.end)
        if not real.any():
            continue
        sides = np.stack([wave(start[real] - CLUSTER * narrow), wave(stop[real] + CLUSTER * narrow)])
        values = wave.pieces.values[real]
        over, under = values.max(axis=1) - sides.max(axis=0), sides.min(axis=0) - values.min(axis=1)
        most += max(over.max(), under.max(), 0.0)
    return most / 2


def _largest(values: NDArray) -> NDArray:
    """Largest absolute value of effort and of flow, shape (2,)."""
    return np.abs(values).max(axis=(1, 2), initial=0.0)


def _broken(coarse: ProbeResult, fine: ProbeResult, n: int) -> NDArray:
    """Whether a front of either run lies inside each of n fine slabs, or a slab there is held in pieces."""
    broken = np.zeros(n + 1, bool)
    for probe in (coarse, fine):
        ratio = probe.record.a1.h / fine.record.a1.h
        for wave, delay in probe.passing:
            slabs = distinct(wave.pieces.slab)
            if len(slabs):
                begin = np.floor((slabs + delay / wave.h) * ratio + BESIDE).astype(int)
                for k in range(round(ratio) + (delay > 0)):
                    broken[np.minimum(begin + k, n)] = True
    return broken[:n]


def compare(
    description: Description,
    coarse: Result,
    fine: Result,
    tol: float | None = None,
    before: Sequence[Accuracy] = (),
    unknown: float = SLOWEST,
    whole: bool = False,
) -> tuple[Accuracy, float, Accuracy]:
    """Estimate the errors of a run by its differences to a finer one.

    `before` are differences of each earlier run to the next, up to the coarse one; without any a step is taken to leave
    the share `unknown`. The inside of slabs counts even if their ends are beyond the tolerance if all is asked
    (`whole`). Returned are the errors, their ratio to differences, and these; smaller fronts than both runs follow are
    left out of both.
    """
    found = Accuracy(tol, *differences(coarse, fine, None if whole else tol))
    by = caution(found, before[-1] if before else None, unknown)
    by *= magnified(description, coarse, fine, [*(each.worst for each in before), found.worst])
    return found.times(by).at_least(fine.resolution.layers), by, found


def differences(
    coarse: Result, fine: Result, tol: float | None = None
) -> tuple[dict[str, Estimate], dict[str, Estimate], dict[str, Estimate]]:
    """Largest differences to a finer run by probe, for `estimates`, `inside` and `blurred` of `Accuracy`.

    Where slab ends alone are beyond a tolerance, and the rest takes long, nothing else is looked at.
    """
    if coarse.envelope is not None:
        coarse, fine = as_computed(coarse), as_computed(fine)
    pairs = {name: (coarse.probes[name], probe) for name, probe in fine.probes.items()}
    if tol is not None and not all(is_smooth(*pair) for pair in pairs.values()):
        at_ends = {name: difference_at_ends(*pair) for name, pair in pairs.items()}
        told = relative({name: Difference(off, off, off, most) for name, (off, most) in at_ends.items()})
        if max(estimate.worst for estimate in told[0].values()) > tol:
            return told
    settle, followed = fine.resolution.settle, bool(coarse.resolution.layers and fine.resolution.layers)
    return relative({name: difference(*pair, settle, followed) for name, pair in pairs.items()})


def as_computed(result: Result) -> Result:
    """Return a result with the polynomials its slabs were computed with, from which envelopes are taken."""
    lines = {name: replace(line, raw=True) for name, line in result.lines.items()}
    probes = {name: replace(at, record=replace(at.record, raw=True)) for name, at in result.probes.items()}
    return replace(result, lines=lines, probes=probes)


def relative(
    all_: Mapping[str, Difference | list[list[float]]],
) -> tuple[dict[str, Estimate], dict[str, Estimate], dict[str, Estimate]]:
    """Differences over the amplitudes of their probes."""
    told: tuple[dict[str, Estimate], ...] = {}, {}, {}
    found, largest = {}, 0.0
    for name, each in all_.items():
        found[name] = each if isinstance(each, list) else np.asarray(each).tolist()
        largest = max(largest, *found[name][-1])
    for name, (*each, (u, y)) in found.items():
        wave = max(u, y)
        least, rounded = max(SILENT * wave, NOTHING * largest), EPS * wave
        for estimates, (of_u, of_y) in zip(told, each, strict=True):
            estimates[name] = Estimate(
                max(max(of_u, rounded) / u, SMALLEST_ESTIMATE) if u > least and of_u > 0 else 0.0,
                max(max(of_y, rounded) / y, SMALLEST_ESTIMATE) if y > least and of_y > 0 else 0.0,
            )
    return told


def caution(found: Accuracy, before: Accuracy | None = None, unknown: float = SLOWEST) -> float:
    """Errors between slab ends over differences to the finer run: they allow for the error that it still has.

    Where a step leaves the share r of the difference before, the next ones leave r², r³, …; the sum of all is the
    difference over 1 - r. Where laws bend waves r is erratic: it counts as at most a half, and as that if unknown.
    """
    left = found.worst / before.worst if before and before.worst > 0 else unknown
    return BETWEEN / (1 - min(left, SLOWEST))


def magnified(description: Description, coarse: Result, fine: Result, steps: Sequence[float]) -> float:
    """Errors over differences, where a decay faster than any run resolves may follow a front.

    Each run shows a share like 1/`unseen` of it, and so does their difference, the last of `steps`, which then does
    not fall. If it falls from step to step, it is of something else; if at once, by accident.
    """
    if steps[-1] <= ROUNDED:
        return 1.0
    most = BY_SLAB if fine.resolution.h < coarse.resolution.h else BY_ORDER
    last = steps[-STEPS - 1 :]
    if len(last) > 1 and all(after <= most * before for before, after in pairwise(last)):
        return 1.0
    by = unseen(description, coarse, bool(fine.resolution.layers))
    return by * max(most * max(last[:-1], default=0.0) / last[-1], 1.0) if by > 1.0 else 1.0


def unseen(description: Description, result: Result, followed: bool) -> float:
    """Ratio of the time scale that a run resolves to the fastest one of loads, vessels and waveforms.

    The pressure at vessels is taken to be the highest at the ends of any recorded line. Loads and vessels do not count
    where the other run follows decays behind fronts; beside dispersive lines fronts are not followed.
    """
    decays = [scale for scale, _ in description.time_scales.values()]
    if followed and not description.dispersive:
        decays = [waveform.fastest() for waveform in description.waveforms.values()]
    elif description.elements and not description.collapses:  # whose gas is part of the model of cavities
        lines = result.lines.values()
        waves = [pair for line in lines for pair in ((line.a1, line.b1), (line.a2, line.b2))]
        highest = max((float((a.values + b.values).max()) / 2 for a, b in waves), default=0.0)
        decays += filling_times(description.elements, description.nodes, highest)
    return max((result.resolution.resolved / decay for decay in decays if decay > 0), default=0.0)


def with_errors(result: Result, other: Result, by: float) -> Result:
    """Return a result whose envelope, if any, has `by` times its differences to another run's as errors."""
    if result.envelope is None or other.envelope is None:
        return result
    return replace(result, envelope=result.envelope.compared(other.envelope, by))


def added(one: Mapping[str, Estimate], other: Mapping[str, Estimate]) -> dict[str, Estimate]:
    """Sums by probe."""
    return {name: Estimate(e.u + other[name].u, e.y + other[name].y) for name, e in one.items()}
