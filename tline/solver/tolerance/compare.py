"""Errors of a run by its differences to a finer one."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from tline.solver.result.accuracy import Estimate
from tline.solver.result.result import Result
from tline.solver.tolerance.difference import difference

ROUNDING = 2e-15  # relative to the amplitude; no estimate is smaller
SILENT = 1e-9  # of the larger of u and z0·y; an amplitude below it is not weighed


def compared(coarse: Result, fine: Result) -> tuple[dict[str, Estimate], dict[str, Estimate], dict[str, Estimate]]:
    """Errors of a run by its largest differences to a finer one: `estimates`, `inside` and `blurred` of `Accuracy`."""
    told: tuple[dict[str, Estimate], ...] = {}, {}, {}
    for name, probe in fine.probes.items():
        found = difference(coarse.probes[name], probe, fine.resolution.settle)
        heard = found.amplitude > SILENT * found.amplitude.max()
        for each, size in zip(told, found[:3], strict=True):
            relative = np.where(heard, size / np.where(heard, found.amplitude, 1.0), 0.0)
            each[name] = Estimate(*(max(float(e), ROUNDING) if e > 0 else 0.0 for e in relative))
    return told


def with_errors(result: Result, other: Result, caution: float) -> Result:
    """A result whose envelope, if it has one, has its differences to that of another run, so many times, as errors."""
    if result.envelope is None or other.envelope is None:
        return result
    return replace(result, envelope=result.envelope.compared(other.envelope, caution))


def added(one: Mapping[str, Estimate], other: Mapping[str, Estimate]) -> dict[str, Estimate]:
    """Sums by probe."""
    return {name: Estimate(e.u + other[name].u, e.y + other[name].y) for name, e in one.items()}
