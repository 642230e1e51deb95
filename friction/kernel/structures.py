"""Structures passed by reference to the units of this package: contacts, and arrays for results and workspace."""

from typing import NamedTuple

import numpy as np

from friction.kernel.law import Drive, Law
from friction.kernel.rodas import STAGES
from friction.kernel.series import ROWS as SERIES
from tline.compiled.structure import Floats, Floats2, Floats3, Integers

STEPS, REFUSED, EVENTS, RUN, STRIDE = range(5)  # counts: steps made and refused, events met, which of two runs is
# given, steps from one instant to the next at which runs are compared
INSTANTS = 512  # most of these; an even number


class FixedRun(NamedTuple):
    """A run in fixed steps."""

    law: Law
    drive: Drive
    mass: float
    h: float  # step, s
    y: Floats  # (5,) x, v, z and the works; at first where the run begins
    record: Floats2  # (samples, 9)
    events: Floats2  # (events, 4) sign of the motion before, after, t, x
    counts: Integers  # (4,)
    k: Floats2  # (4, 5) slopes
    middle: Floats  # (5,)


class Bench(NamedTuple):
    """Mass that a contact holds, its excitation, initial state, and times."""

    drive: Drive
    mass: float
    start: Floats  # (5,) x, v, z and the works
    t_end: float
    times: Floats  # of samples


class Compared(NamedTuple):
    """Two runs that are compared, and the workspace of their steps."""

    records: Floats3  # (2, times, 9)
    instants: Floats  # (INSTANTS,) ends of steps of the first run, at which all are compared; inf behind the last
    checks: Floats3  # (2, INSTANTS, 9) columns there
    events: Floats3  # (2, events, 4)
    errors: Floats  # (9,) an estimate for each column
    peaks: Floats  # (9,) largest magnitude of each column
    weights: Floats  # (9,) that of the run before
    counts: Integers  # (5,)
    u: Floats2  # (stages, 5)
    y: Floats  # (5,)
    new: Floats  # (5,)
    dense: Floats2  # (terms, 5)
    series: Floats2  # (6, terms)


class SmoothRun(NamedTuple):
    """A run of a smooth law, to a tolerance."""

    law: Law
    bench: Bench
    wanted: float  # tolerance, 0 for none
    at_least: float  # then that of single steps
    compared: Compared


def fixed_run(law: Law, drive: Drive, mass: float, start: Floats, h: float, samples: int, events: int) -> FixedRun:
    """Make a run from `start`, with room for a number of samples and events."""
    record, counts = np.full((samples, 9), np.nan), np.zeros(4, np.int64)
    return FixedRun(law, drive, mass, h, start, record, np.empty((events, 4)), counts, np.empty((4, 5)), np.empty(5))


def compared(samples: int, events: int, terms: int) -> Compared:
    """Make two runs with room for a number of samples and events, by steps of a number of terms."""
    records, counts = np.full((2, samples, 9), np.nan), np.zeros(5, np.int64)
    instants, checks = np.full(INSTANTS, np.inf), np.empty((2, INSTANTS, 9))
    steps = np.zeros((STAGES, 5)), np.zeros(5), np.zeros(5), np.zeros((terms, 5)), np.zeros((SERIES, terms))
    sizes = np.zeros(9), np.zeros(9), np.zeros(9)
    return Compared(records, instants, checks, np.empty((2, events, 4)), *sizes, counts, *steps)
