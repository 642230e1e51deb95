"""Search for the smallest size with a margin above zero, where the margin should grow with the size."""

from collections.abc import Callable
from math import floor, log, log10
from typing import NamedTuple

STEP, STEPS = 2.0, 16  # from size to size until the margin changes its sign
DIGITS = 4  # of a size
PRECISION, NUDGE = 1.002, 0.001  # of the size
CURVE = (0.4, 0.65, 1.5, 2.5, 5.0)  # times the size found: runs for the curve, and to check that the margin grows
ROUNDS = 4  # of searches above a larger size that fails


class Trial(NamedTuple):
    """Result of one size, in SI."""

    size: float
    lowest: float  # lowest, highest: extremes that are limited, Pa
    highest: float
    margin: float  # to the nearer limit, Pa; negative beyond it
    error: float  # estimated error of the extremes, Pa; nan if order and slab are fixed


class SizeSearch(NamedTuple):
    """Trials of a search by size, and the smallest size that keeps the limits, None if none does."""

    trials: tuple[Trial, ...]
    found: Trial | None

    @property
    def turns(self) -> tuple[Trial, Trial] | None:
        """Adjacent trials of which the larger size has less margin by more than their errors."""
        for small, large in zip(self.trials, self.trials[1:], strict=False):
            slack = sum(trial.error for trial in (small, large) if trial.error == trial.error)
            if large.margin < small.margin - slack - 1e-6 * abs(small.margin):
                return small, large
        return None


def smallest(run: Callable[[float], Trial], first: float, largest: float = float("inf")) -> SizeSearch:
    """Find the smallest size, above zero, that keeps the limits, to 0.2 %, from `first` on and up to `largest`.

    A bracket by doubling or halving from `first`, then secants on the logarithm of the size, with bisection if they do
    not halve the bracket. Sizes around the one found are run as well: if a larger one fails, the search goes on above.
    """
    tried: dict[float, Trial] = {}

    def at(size: float) -> Trial:
        size = min(rounded(size), largest)
        if size not in tried:
            tried[size] = run(size)
        return tried[size]

    low = high = at(first)
    for _ in range(STEPS):
        if low.margin >= 0:
            low, high = at(low.size / STEP), low
        elif high.margin < 0 and high.size < largest:
            low, high = high, at(high.size * STEP)
    if low.margin >= 0:
        high = low
    for _ in range(ROUNDS):
        if high is low or high.margin < 0:
            break
        high = _refined(at, low, high)
        for share in CURVE:
            if high.size * share <= largest:
                at(high.size * share)
        failing = [trial for trial in tried.values() if trial.size > high.size and trial.margin < 0]
        if not failing:
            break
        low = max(failing)
        high = min((t for t in tried.values() if t.size > low.size), default=at(low.size * STEP))
    return SizeSearch(tuple(sorted(tried.values())), high if high.margin >= 0 else None)


def _refined(at: Callable[[float], Trial], low: Trial, high: Trial) -> Trial:
    """Larger end of a bracket that is narrow enough."""
    bisect, nudge = False, 0.0  # beyond the secant, so that the end that stood still moves next
    while high.size > PRECISION * low.size:
        width = log(high.size / low.size)
        share = 0.5 if bisect else low.margin / (low.margin - high.margin) + nudge / width
        middle = at(low.size * (high.size / low.size) ** min(max(share, 0.02), 0.98))
        if middle.size in (low.size, high.size):
            if bisect:
                break
            bisect = True
            continue
        nudge = NUDGE if middle.margin < 0 else -NUDGE
        low, high = (middle, high) if middle.margin < 0 else (low, middle)
        bisect = log(high.size / low.size) > width / 2
    return high


def rounded(size: float) -> float:
    """Round a size to four digits."""
    return round(size, DIGITS - 1 - floor(log10(size)))
