"""Runs of conductors whose losses mix the modes: with twice as many places of losses until that changes little."""

from collections.abc import Callable
from functools import partial
from itertools import count

from tline.solver.result.result import Result
from tline.solver.tolerance.closer import Step, closer

ROUGH = 1e-3  # tolerance of the slabs of the first runs
MOST_SAMPLES = 3e7  # line-end samples of all runs
GROWTH = 6  # times as many samples with each doubling


def with_mixed_modes(run: Callable[[int, float], Result], tol: float) -> Result:
    """Double the places of losses until the estimated error is within a tolerance, or a limit is reached.

    Places are of first order behind jumps, and nearly of second behind corners.

    Parameters
    ----------
    run : callable
        Of a number of doublings and the tolerance of its slabs.
    tol : float
    """

    def too_far(steps: int, samples: int, last: float) -> str:
        if GROWTH * samples <= MOST_SAMPLES:
            return ""
        return f"the losses mix the modes; {steps} doublings of the places where they stand leave {last:.1g}"

    result = closer((Step(partial(run, doublings)) for doublings in count()), tol, too_far, ROUGH)
    assert result
    return result
