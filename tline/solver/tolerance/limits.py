"""What forbids finer runs in a search: what they would cost, or that they would not be enough."""

from collections.abc import Sequence
from itertools import pairwise
from math import log

from tline.solver.description.description import Description
from tline.solver.result.accuracy import Accuracy, Attempt

MOST_INSIDE = 2e7  # line-end samples in all runs together, for the sake of instants inside slabs alone,
WORTH = 64  # or so many times those of the first run, if that is more
TRIED = 2  # halvings of the slab, from which the next ones are foretold,
FORETOLD = 2e6  # and line-end samples in all runs together: before, runs may converge slower than they will; so few
# are cheap where nothing else is computed inside lines
STALE, CHEAP = 2, 1e5  # halvings of the slab in a row that may bring nothing; line-end samples that are tried anyway
MOST_SAMPLES, MOST_SECONDS = 3e9, 600  # line-end samples and stepping in all runs together
LOST = 0.3  # estimates beyond, one after the other, with cavities: no run resembles another
COLLAPSE = (
    ": cavities collapse at other instants in each run, and that spreads; order = 1 and no tolerance give one run"
)


def foretells(attempts: Sequence[Attempt], description: Description) -> bool:
    """Whether the runs so far tell how the next ones would converge."""
    return description.dispersive or description.collapses or sum(a.samples for a in attempts) >= FORETOLD


def limit_of(attempts: Sequence[Attempt], stale: int, collapses: bool, most: float) -> str:
    """What forbids a finer run; empty if nothing does."""
    told = [a.estimate for a in attempts if a.estimate is not None][-STALE - 1 :]
    samples, next_ = sum(a.samples for a in attempts), _growth(attempts) * attempts[-1].samples
    if (stale >= STALE and (collapses or samples > CHEAP)) or (collapses and len(told) > STALE and min(told) > LOST):
        return f"narrower slabs do not help{COLLAPSE * collapses}"
    if samples + next_ > most:
        return f"a finer run would take the total beyond {most:.0e} line-end samples"
    if sum(a.seconds for a in attempts) + 2 * attempts[-1].seconds > MOST_SECONDS:
        return f"a finer run would take the total beyond {MOST_SECONDS} s"
    return ""


def inside_limit(attempts: Sequence[Attempt], found: Accuracy, foretell: bool = True) -> str:
    """What forbids finer runs for the sake of instants inside slabs: that they would not be enough."""
    assert found.tol is not None
    if found.at_slab_ends > found.tol or found.worst <= found.tol:
        return ""
    told = [(a.slab, a.estimate) for a in attempts if a.estimate is not None]
    halvings = [worst for (h, _), (slab, worst) in pairwise(told) if slab < h]
    samples = sum(a.samples for a in attempts)
    left = log(max(max(MOST_INSIDE, WORTH * attempts[0].samples) / samples, 1.0), _growth(attempts))
    if left < 1:
        return "no room"
    if len(halvings) < TRIED or not foretell:
        return ""
    widest = max(worst for slab, worst in told if slab > told[-1][0])
    pace = (widest / found.worst) ** (1 / len(halvings))
    return "" if pace > 1 and found.worst <= found.tol * pace**left else "too slow"


def _growth(attempts: Sequence[Attempt]) -> float:
    """By how much a halved slab multiplies samples: by two, and by four in segments, of which there are more."""
    halved = [fine.samples / rough.samples for rough, fine in pairwise(attempts) if fine.slab < rough.slab]
    return max([2.0, *halved[-1:]])


def inside_slabs(accuracy: Accuracy) -> str:
    """What kept the tolerance from being met, if that was not at slab ends."""
    if accuracy.tol is None or accuracy.at_slab_ends > accuracy.tol or accuracy.worst <= accuracy.tol:
        return ""
    name, told = max(accuracy.inside.items(), key=lambda item: item[1].worst)
    return (
        f"inside slabs the error at '{name}' is up to {told.worst:.1g}, where a law or a front bends the wave; at slab "
        f"ends it is {accuracy.at_slab_ends:.1g}: read values there, ask for less, or give a narrower slab"
    )
