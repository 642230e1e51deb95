"""Estimated errors of a run, from its differences to a finer one."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from tline.solver.description.description import Description
from tline.solver.result.accuracy import SLOWEST, Accuracy, Estimate
from tline.solver.result.result import Result
from tline.solver.tolerance.difference import EPS, Difference, difference, difference_at_ends, is_smooth

SMALLEST_ESTIMATE = 2e-15  # relative to the amplitude; no estimate is smaller
NOTHING = 1e-13  # relative to the largest amplitude of all probes; smaller amplitudes are rounding
SILENT = 1e-9  # relative to the larger of u and z0·y; errors of a smaller amplitude count as zero
BETWEEN = 1.5  # ratio of the largest difference at any instant to that at the places compared
BY_ORDER, BY_SLAB = 0.2, 0.5  # shares of the previous difference; a step that leaves less resolves every decay
STEPS = 2  # consecutive steps that must do so: two runs may agree by accident
ROUNDED = 1e-13  # relative to the amplitude; smaller differences are rounding


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
    if followed and not description.dispersive:
        return _over(result, [waveform.fastest() for waveform in description.waveforms.values()])
    decays = [scale for scale, _ in description.time_scales.values()]
    if description.elements:
        lines = result.lines.values()
        waves = [pair for line in lines for pair in ((line.a1, line.b1), (line.a2, line.b2))]
        highest = max((float((a.values + b.values).max()) / 2 for a, b in waves), default=0.0)
        decays += description.filling_times(highest)
    return _over(result, decays)


def _over(result: Result, decays: Sequence[float]) -> float:
    return max((result.resolution.resolved / decay for decay in decays if decay > 0), default=0.0)


def with_errors(result: Result, other: Result, by: float) -> Result:
    """Return a result whose envelope, if any, has `by` times its differences to another run's as errors."""
    if result.envelope is None or other.envelope is None:
        return result
    return replace(result, envelope=result.envelope.compared(other.envelope, by))


def added(one: Mapping[str, Estimate], other: Mapping[str, Estimate]) -> dict[str, Estimate]:
    """Sums by probe."""
    return {name: Estimate(e.u + other[name].u, e.y + other[name].y) for name, e in one.items()}
