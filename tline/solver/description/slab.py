"""Slab width of a scene: the cheapest that resolves it."""

from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import lru_cache
from math import ceil, floor, inf, lcm, log2, sqrt

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tline.distinct import distinct
from tline.solver.description.description import Description

SLABS_PER_DELAY, SLABS_PER_RUN = 4, 500  # at least, where they cost little
SLABS_FOR_FRONTS = 20_000  # at most, to give the short pieces of waveforms slabs of their own
CHEAP = 1e7  # line-end samples computed without asking whether that fine is needed
CHEAP_IN_BLOCKS = 1e9  # the same where a slab divides all delays: without fronts inside slabs some hundred times faster
DENSE = 8  # entries of a circuit's map over a slab that take as long as a line-end sample
MOST_KEPT = 4e7  # samples on the lines or in the record that are kept without asking
MOST_MARKS = 100  # jumps, corners and switches that are worth a slab that divides their instants
FINER = 20  # times, that a slab may be narrower than needed to divide all delays
ROOMY = 16  # times that a slab is longer than lumped lines take to settle: so often a front may pass them unharmed
WHOLE = 1e-12  # a delay this near to whole slabs, relatively, is whole
WITH_FRONTS = 6.0  # times the work of a slab without fronts, which is compared as well, for each piece
MOST_PLACES = 4  # pieces of a slab, as far as is foretold
WITH_SHIFTS = 12.0  # the same where no front is, but waves are projected
BESIDE = 2e4  # samples without fronts that take as long as what comes with a run whose slabs are not whole
DIAMONDS, SMOOTH = 2e4, 5e3  # that a first run may have: some hundredths of a second; where no law bends waves
MOST_DIAMONDS = 1e6  # of a run, beyond which friction is in cells wider than slabs, at first as few of these
SPARE_PARTS = 2  # times that slabs may be narrower to divide delays
PLACES = 9  # digits of an instant's place in its slab
ORDER = 5


def slab_of(description: Description, kept: NDArray, scales: Mapping[str, tuple[float, float]], settle: float) -> float:
    """Slab width that resolves the scene, if affordable; `kept` are the lines that are not lumped, shape (L,)."""
    columns = description.columns
    delays = columns.delay[kept].tolist()
    lossy = columns.delay[kept & columns.dispersive].tolist() if description.dispersive else []
    shortest, breaks = min(delays), breaks_of(description)
    layered = description.t_end / SLABS_FOR_FRONTS  # faster decays are followed behind fronts, not by narrow slabs
    slower = [scale for scale, period in scales.values() if lossy or period < inf or scale > layered]
    resolved = min([shortest / SLABS_PER_DELAY, *slower])
    affordable = min(_affordable(description, delays, CHEAP), shortest)
    least = max(affordable, min(ROOMY * settle, min(shortest, description.t_end) / SLABS_PER_DELAY))
    if lossy:
        return _slab_beside_losses(description, delays, lossy, resolved, least)
    wanted, often = (max(min(resolved, most), least) for most in (inf, description.t_end / SLABS_PER_RUN))
    affordable = _affordable(description, delays, CHEAP_IN_BLOCKS)
    wanted = often if description.elements else wanted
    if description.diamonds:
        most = DIAMONDS if description.elements else SMOOTH
        return _slab_for_diamonds(delays, breaks, description.t_end, max(least, often), most)
    return _cheapest((*delays,), (*breaks.tolist(),), description.t_end, affordable, wanted, often)


def _slab_for_diamonds(delays: list[float], breaks: NDArray, t_end: float, wanted: float, number: float) -> float:
    """Slab width that limits the number of diamonds and divides all delays, and breaks if that costs no more.

    The number of parts is a power of two times a common one, so that runs on halved slabs share their ends.
    """
    shortest = min(delays)
    wanted = min(max(wanted, sqrt(2 * t_end * sum(delays) / number)), shortest)
    most = int(shortest / wanted * SPARE_PARTS)
    times = ((*delays, *breaks[:MOST_MARKS].tolist()), (*delays,))
    parts = next(filter(None, (common_parts(each, shortest, most) for each in times)), 1)
    return shortest / (parts * 2 ** max(floor(log2(shortest / parts / wanted)), 0))


def cell_of(description: Description, s: int, h: float) -> float:
    """Width of cells beside slabs of order s and width h, s; 0 for diamonds or cells of slabs if these are not many."""
    number = cells_in(description, h)
    few = number <= (MOST_DIAMONDS if description.diamonds and s > 1 else DIAMONDS)
    return 0.0 if few else sqrt(number / DIAMONDS) * h


def cells_in(description: Description, width: float) -> float:
    """Number of cells, or diamonds, of a given width, s, in a run."""
    delays = description.columns.delay[description.columns.dispersive]
    return 2 * float(delays.sum()) * description.t_end / width**2


@lru_cache(maxsize=8)  # runs with other values ask the same
def _cheapest(
    delays: tuple[float, ...], breaks: tuple[float, ...], t_end: float, affordable: float, wanted: float, often: float
) -> float:
    """Cheapest slab of those that divide delays and breaks, delays alone, and the shortest delay.

    Without fronts inside they may be so narrow that samples come often, and low orders do.
    """
    shortest, samples = min(delays), 2 * len(delays) * t_end

    def cost(parts: int) -> float:
        h = _divided(shortest, parts, wanted)
        work = relative_work(h, delays, breaks)
        return samples / h * work + (BESIDE if work > 1.0 else 0.0)

    narrowest = max(affordable, samples / cost(1))
    most, choices = max(int(shortest / narrowest), 1), [1]
    for times in (delays, delays + breaks[:MOST_MARKS]):
        if parts := common_parts(times, shortest, most):
            choices.append(parts)
    parts = min(reversed(choices), key=cost)
    inside = relative_work(_divided(shortest, parts, wanted), delays, breaks) > 1.0
    return _divided(shortest, parts, wanted if inside else often)


def whole_slabs(h: float, delays: Sequence[float]) -> bool:
    """Whether slabs of this width divide all delays."""
    return all(abs(delay / h - round(delay / h)) <= WHOLE * delay / h for delay in delays)


def relative_work(h: float, delays: Sequence[float], breaks: ArrayLike) -> float:
    """Work for a slab of this width, over that for one without fronts inside."""
    if not whole_slabs(h, delays):
        return WITH_FRONTS * MOST_PLACES if np.size(breaks) else WITH_SHIFTS
    places = distinct(np.round(np.append(0.0, breaks) / h % 1.0, PLACES) % 1.0)
    return 1.0 if len(places) == 1 else WITH_FRONTS * min(len(places), MOST_PLACES)


def _divided(shortest: float, parts: int, wanted: float) -> float:
    """Divide the shortest delay into `parts`, and each of these further until no wider than wanted."""
    return shortest / (parts * ceil(shortest / parts / wanted - WHOLE))


def _slab_beside_losses(
    description: Description, delays: list[float], lossy: list[float], resolved: float, least: float
) -> float:
    """Slab width beside lines with memory or leakage."""
    cheap, t_end, breaks = _affordable(description, delays, CHEAP), description.t_end, breaks_of(description)
    few = len(breaks) <= MOST_MARKS
    gaps = [gap[gap > WHOLE * t_end] for gap in map(np.diff, description.breaks)]  # below rounding it is a jump
    fronts = [max(float(gap.min()), t_end / SLABS_FOR_FRONTS) for gap in gaps if gap.size]
    wanted = max(min([resolved, *fronts]), least)
    marks = [t for t in breaks.tolist() if t > 0] if few else []
    parts = _dividing(delays, lossy, marks, wanted, cheap)
    if not parts and len(breaks) and few:  # fronts inside slabs, exact in any slab, and slabs with fronts cost
        wanted = max(resolved, least)
    return _divided(min(delays), parts or 1, wanted)


def _affordable(description: Description, delays: list[float], cheap: float) -> float:
    probed = min(len(description.scene.probes), len(delays))
    states = [len(group.poles) for group in description.grouped()[0] if group.poles is not None]
    dense = sum(n * n for n in states) / DENSE
    stepping = (2 * len(delays) + dense / ORDER) * description.t_end / cheap
    kept = max(4 * probed * description.t_end, 2 * sum(delays)) / MOST_KEPT
    return ORDER * max(stepping, kept)


def breaks_of(description: Description) -> NDArray:
    """Instants of the jumps, corners and switches of a run, s."""
    instants = np.concatenate([[*description.switched.values()], *description.breaks])
    return instants[(instants >= 0) & (instants < description.t_end)]


def _dividing(delays: list[float], lossy: list[float], marks: list[float], wanted: float, affordable: float) -> int:
    """The fewest parts of the shortest delay that divide all delays and marks, or else some of them; 0 for too many.

    Rather those of lossy lines than others.
    """
    shortest = min(delays)
    most = int(shortest / max(wanted / FINER, affordable)) or 1
    choices = [*delays, *marks], delays, [shortest, *lossy, *marks], [shortest, *lossy]
    return next(filter(None, (common_parts(tuple(times), shortest, most) for times in choices)), 0)


@lru_cache  # fractions take long, and runs with other values ask the same
def common_parts(times: tuple[float, ...], unit: float, most: int) -> int:
    """The fewest parts of the unit that divide all times, 0 if it takes more than `most`."""
    parts = 1
    for time in set(times):
        ratio = Fraction(time / unit).limit_denominator(most)
        parts = lcm(parts, ratio.denominator)
        if parts > most or abs(time / unit - ratio) > WHOLE * ratio:
            return 0
    return parts
