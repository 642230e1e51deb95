"""Signals of small mechanisms, and runs of them, as compiled code takes them."""

from typing import NamedTuple

from tline.compiled.structure import Floats, Floats2, Floats3, Integers, Integers2

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
