"""Structures passed by reference to the units of this package: contacts, signals of mechanisms, results, workspace."""

from typing import NamedTuple

import numpy as np

from friction.kernel.law import Drive, Law
from friction.kernel.rodas import STAGES
from friction.kernel.series import ROWS as SERIES
from tline.compiled.structure import Floats, Floats2, Floats3, Integers, Integers2

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


INPUT, HELD, STATE, SUM, PRODUCT, SWITCH, FRICTION, NET, MAXWELL, ARMSTRONG = range(10)  # kinds of signals; NET, the
# applied force less friction, stands behind its FRICTION; the last two are contacts that stick like springs
F_C, F_S, F_V, V_S, DELTA, STIFFNESS, LAG, DWELL = range(8)  # of a contact's law
STUCK, SLIDING, PUSHED = 0, 1, 2  # modes, with the sign of the motion; pushed: within a dead zone, but too hard to hold
N = 20  # terms of a series
CLOCK, LOST, TURN, NOW = range(4)  # time since the piece of the inputs began, what its sum lost, turns of the sine, t
SINCE, REST, LEFT, PEAK, READ, UNTIL = range(6)  # of a contact that sticks like a spring: when it came to rest, with
# which Stribeck friction, what that is at the end of a leg, that of its break-away; past leg that is read, how long
LEGS = 3  # count of legs that took time


class Diagram(NamedTuple):
    """Signals in order."""

    kind: Integers  # (n,)
    source: Integers2  # (n, 3) number of an input or of what is held; integrand; factors; difference of what a switch
    # has for one sign and the other, and both; velocity, applied force (springs: velocity) and number of a contact
    first: Integers  # (n + 1,) of the terms of each sum
    term: Integers  # signals that are added
    factor: Floats  # by which
    constant: Floats  # (n,) constant term of a sum
    law: Floats2  # (contacts, 8)
    contact: Integers  # (contacts,) signals of their friction
    watched: Integers  # signals that steps must follow to rounding


class Inputs(NamedTuple):
    """Inputs over time: polynomials piece by piece, and a sine that is added to the first one."""

    start: Floats  # (pieces,)
    power: Floats3  # (pieces, inputs, terms) rising powers of the time since then
    amplitude: float
    omega: float
    phase: float


class Sampled(NamedTuple):
    """A controller that looks at signals every period.

    Registers take theirs at once, all together; outputs are held from a delay later on until the next ones.
    """

    period: float
    delay: float
    seen: Integers  # signals, first those of the registers
    queue: Floats2  # (latest, outputs)
    held: Floats  # (registers + outputs,)


class HybridRun(NamedTuple):
    """A run of a diagram as a hybrid automaton."""

    diagram: Diagram
    inputs: Inputs
    sampled: Sampled
    t_end: float
    times: Floats  # of samples
    shown: Integers  # signals that are kept
    place: Integers  # (contacts,) signals recorded with events
    record: Floats2  # (times, 1 + shown + contacts) time, signals, modes
    events: Floats2  # (events, 5) sign of the motion before, after, t, place, number of the contact
    counts: Integers  # (4,)
    state: Floats  # (n,) of signals that are states
    mode: Integers  # (contacts,)
    side: Integers  # (n,) sign of the difference at a switch, of the velocity of a spring
    known: Floats  # (n,) value of a signal set by an event; NaN otherwise
    clock: Floats  # (4,)
    series: Floats2  # (n, N + 1)
    bell: Floats2  # (2·contacts, N + 1) (v/v_s)², e^(−(v/v_s)²) or 1/(1 + (v/v_s)²)
    limit: Floats2  # (contacts, N + 1) of the force of springs
    late: Floats2  # (contacts, N + 1) velocity one lag earlier
    memory: Floats2  # (contacts, 6)
    past: Floats3  # (MOST_PAST, contacts, N + 1) velocities of past legs, if there are lags
    past_start: Floats  # (MOST_PAST,)
    p: Floats  # (N + 1,)
    q: Floats  # (N + 1,)
