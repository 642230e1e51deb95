"""Runs on slabs that divide delays a little longer or shorter than those of the scene, ever closer to these.

Where slabs divide all delays, lossy lines are in segments: exact but for the order, and corners stay at slab ends. A
delay that is off by d moves a wave by that time, which counts as error; a jump may not move. What one of several delays
changes is not known alone: each is taken to change all that was seen.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.description import Description
from tline.solver.description.rounded import Rounded, rounded_delays
from tline.solver.result.result import Result
from tline.solver.tolerance.closer import Step, closer
from tline.solver.tolerance.search import Search

MOST_STEPS = 2e6  # of segments, in a run: a second
CAUTION = 2.0  # times what is expected to be wrong
ROUNDING = 1e-6  # of the largest change of a delay; one that is less is none


def with_rounded_delays(search: Search, run: Callable[[Search], Result]) -> Result | None:
    """Round delays ever more closely until the estimated error is within the tolerance; None if two are too many slabs.

    Parameters
    ----------
    search : Search
    run : callable
        Of a search whose lossy lines are in segments.
    """
    description = search.description

    def near(rounded: Rounded, tol: float) -> Result:
        return run(search._replace(description=rounded.description, tol=tol))

    def steps() -> Iterator[Step]:
        before = None
        for each in rounded_delays(description, _most(description)):
            yield Step(partial(near, each), before and _left(before.off, each.off))
            before = each

    result = closer(steps(), search.tol, lambda number, samples, last: "")
    if result is None or result.accuracy is None or result.accuracy.met or result.accuracy.limit:
        return result
    return replace(
        result, accuracy=replace(result.accuracy, limit="slabs that divide the delays more closely take long")
    )


def _left(before: NDArray, off: NDArray) -> float:
    """What is still wrong of what a step has changed, at most."""
    real = np.abs(off - before) > ROUNDING * np.abs(before).max()
    return CAUTION * float((np.abs(off) / np.abs(off - before))[real].sum())


def may_round(description: Description) -> bool:
    """Whether delays may change a little: nothing jumps, and order and slab are free."""
    fixed = description.scene.solver
    varies = description.elements or description.switched
    jumps = any(np.abs(changes.jump).any() for changes in description.changes)
    linear = all(line.losses is None or line.losses.linear for line in description.lines.values())
    return linear and not (jumps or varies or fixed.slab or fixed.order)


def _most(description: Description) -> float:
    """Slabs of the shortest delay that are affordable."""
    delays = [line.delay for line in description.lines.values()]
    return sqrt(MOST_STEPS / (sum(delays) * description.t_end)) * min(delays)
