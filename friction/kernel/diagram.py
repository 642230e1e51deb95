"""Small mechanisms as diagrams of signals, expanded in series of the time since the start of a leg.

A signal is an input, a state (the integral of a signal), a sum, a product, a switch between two, a value held by a
sampled controller, or the friction of a contact. All but integrands precede the signals made of them, so one pass
finds term k of all series from the terms before.

A contact keeps its applied force less stiction, and the drop of friction from its peak, as series of their own, so that
at a break-away, where F_a = F_s and v = 0, nothing is left of rounding that could push the wrong way.
"""

from math import copysign, cos, exp, expm1, factorial, inf, isnan, pi, sin
from typing import NamedTuple

import numpy as np

from friction.kernel.roots import first_root_within
from tline.compiled.structure import Floats, Floats2, Integers, Integers2
from tline.compiled.unit import function

INPUT, HELD, STATE, SUM, PRODUCT, SWITCH, FRICTION, NET = range(8)  # kinds of signals; NET, the applied force less
# friction, stands behind its FRICTION
F_C, F_S, F_V, V_S, DELTA = range(5)  # of a contact's law
STUCK, SLIDING, PUSHED = 0, 1, 2  # modes, with the sign of the motion; pushed: within a dead zone, but too hard to hold
N = 20  # terms of a series
CLOCK, LOST, TURN = range(3)  # time since the piece of the inputs began, what its sum lost, turns of the sine
INVERSE = np.array([1.0 / factorial(k) for k in range(N + 1)])
SERIES_TAIL = 1e-17  # of a series' largest early term: largest last terms
FAR = 6.0  # multiples of v_s at which e^(−(v/v_s)²) begins to count: 2e-16


class Diagram(NamedTuple):
    """Signals in order."""

    kind: Integers  # (n,)
    source: Integers2  # (n, 3) number of an input or of what is held; integrand; factors; difference of what a switch
    # has for one sign and the other, and both; velocity, applied force and number of a contact
    first: Integers  # (n + 1,) of the terms of each sum
    term: Integers  # signals that are added
    factor: Floats  # by which
    constant: Floats  # (n,) constant term of a sum
    law: Floats2  # (contacts, 5)
    contact: Integers  # (contacts,) signals of their friction
    watched: Integers  # signals that steps must follow to rounding


class Inputs(NamedTuple):
    """Inputs over time: straight pieces, and a sine that is added to the first one."""

    start: Floats  # (pieces,)
    value: Floats2  # (pieces, inputs) there
    slope: Floats2
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
    side: Integers  # (n,) sign of the difference at a switch
    known: Floats  # (n,) value of a signal set by an event; NaN otherwise
    clock: Floats  # (3,)
    series: Floats2  # (n, N + 1)
    bell: Floats2  # (2·contacts, N + 1) (v/v_s)², e^(−(v/v_s)²)
    p: Floats  # (N + 1,)
    q: Floats  # (N + 1,)


def unsampled() -> Sampled:
    """No controller."""
    return Sampled(inf, 0.0, np.zeros(0, np.int64), np.zeros((0, 0)), np.zeros(0))


@function
def expand(run, number):
    """Series of all signals, while one piece of the inputs lasts."""
    d, c, known, side, state = run.diagram, run.series, run.known, run.side, run.state
    kinds, source, first, term, factor = d.kind, d.source, d.first, d.term, d.factor
    for i in range(kinds.size):
        if kinds[i] <= HELD:
            expand_input(run, number, i)
    for k in range(N):
        for i in range(kinds.size):
            kind = kinds[i]
            if kind == STATE:
                c[i, k] = state[i] if k == 0 else c[source[i, 0], k - 1] / k
            elif kind == SUM:
                total = d.constant[i] if k == 0 else 0.0
                for j in range(first[i], first[i + 1]):
                    total += factor[j] * c[term[j], k]
                c[i, k] = total
            elif kind == PRODUCT:
                total, one, other = 0.0, source[i, 0], source[i, 1]
                for j in range(k + 1):
                    total += c[one, j] * c[other, k - j]
                c[i, k] = total
            elif kind == SWITCH:
                if k == 0:
                    side[i] = 0
                if side[i] == 0:
                    side[i] = int(np.sign(c[source[i, 0], k]))
                c[i, k] = c[source[i, 1 if side[i] > 0 else 2], k]
            elif kind == FRICTION:
                rub(d, run.mode, run.bell, c, i, k)
            if k == 0 and not isnan(known[i]):
                c[i, 0] = known[i]
    for i in range(kinds.size):
        if kinds[i] == STATE:
            c[i, N] = c[source[i, 0], N - 1] / N


@function
def expand_input(run, number, i):
    """Expand an input or a held value."""
    inputs, clock, out, k = run.inputs, run.clock, run.series[i], run.diagram.source[i, 0]
    for j in range(N):
        out[j] = 0.0
    if run.diagram.kind[i] == HELD:
        out[0] = run.sampled.held[k]
        return
    out[0] = inputs.value[number, k] + inputs.slope[number, k] * (clock[CLOCK] - clock[LOST])
    out[1] = inputs.slope[number, k]
    if k == 0 and inputs.amplitude != 0.0:
        angle = 2.0 * pi * clock[TURN]
        a, b, power = inputs.amplitude * sin(angle), inputs.amplitude * cos(angle), 1.0
        for j in range(N):
            out[j] += a * power * INVERSE[j]
            a, b, power = b, -a, power * inputs.omega


@function
def rub(d, modes, bell, c, i, k):
    """Term k of the friction of a contact, and of the applied force less it."""
    v, f_a, j = d.source[i, 0], d.source[i, 1], d.source[i, 2]
    mode, law = modes[j], d.law[j]
    if mode == STUCK:
        c[i, k], c[i + 1, k] = c[f_a, k], 0.0
        return
    s, sliding, drop = copysign(1.0, mode), abs(mode) == SLIDING, 0.0
    peak, viscous = (law[F_S] - law[F_C], law[F_V]) if sliding else (0.0, 0.0)
    if beyond(law, mode, c[v, 0]):
        drop = 1.0 if k == 0 else 0.0
    elif peak > 0.0:
        drop = drop_term(law[V_S], c[v], bell[2 * j], bell[2 * j + 1], k)
    stiction = law[F_S] if k == 0 else 0.0
    held = -s * viscous * c[v, k] + peak * drop
    if k == 0 and sliding and law[DELTA] > 0.0 and abs(c[v, 0]) == law[DELTA]:
        held = max(held, 0.0)  # friction at the border of a dead zone is at most F_s
    c[i, k] = s * (stiction - peak * drop) + viscous * c[v, k]
    c[i + 1, k] = s * ((s * c[f_a, k] - stiction) + held)


@function
def beyond(law, mode, v):
    """Whether the sliding is so fast that nothing is left of the Stribeck peak."""
    return abs(mode) == SLIDING and law[F_S] > law[F_C] and abs(v) > 1.001 * FAR * law[V_S]


@function
def drop_term(v_s, v, square, bell, k):
    """Term k of 1 − e^(−(v/v_s)²)."""
    total = 0.0
    for j in range(k + 1):
        total += (v[j] / v_s) * (v[k - j] / v_s)
    square[k] = total
    if k == 0:
        bell[0] = exp(-total)
        return -expm1(-total)
    total = 0.0
    for j in range(1, k + 1):
        total -= j * square[j] * bell[k - j]
    bell[k] = total / k
    return -bell[k]


@function
def trusted(row, n, h):
    """Largest step up to h at which term n is rounding of the largest early one."""
    last, found, power = abs(row[n]), 0.0, h ** (n - 5)
    if last == 0.0:
        return h
    for k in range(5, -1, -1):
        if SERIES_TAIL * abs(row[k]) >= last * power:
            return h
        power *= h
    for k in range(6):
        if row[k] != 0.0:
            found = max(found, (SERIES_TAIL * abs(row[k]) / last) ** (1.0 / (n - k)))
    return min(h, found)


@function
def trusted_step(run, h):
    """Largest step up to h at which the series are exact to rounding.

    Far out, a step ends where the bell e^(−(v/v_s)²) begins to count.
    """
    d, c, p = run.diagram, run.series, run.p
    for w in range(d.watched.size):
        i = d.watched[w]
        last = N if d.kind[i] == STATE else N - 1
        h = trusted(c[i], last, trusted(c[i], last - 1, h))
    for j in range(d.contact.size):
        v, law = d.source[d.contact[j], 0], d.law[j]
        if beyond(law, run.mode[j], c[v, 0]):
            for k in range(N):
                p[k] = copysign(1.0, run.mode[j]) * c[v, k]
            p[0] -= FAR * law[V_S]
            h = min(h, first_root_within(p, N, h, run.q))
    return h


@function
def first_guard(run, h):
    """Find the time at which the first guard vanishes, inf if none does, its signal, and its number: 0 or 1.

    Stuck: −F_a and +F_a reach F_s. Sliding: the speed falls to δ. Pushed: the speed rises to δ, the force falls to F_s.
    Switch: the difference keeps its sign.
    """
    d, c, p, best, which, border = run.diagram, run.series, run.p, inf, 0, 0
    for i in range(d.kind.size):
        mode = side = run.side[i]
        if d.kind[i] == FRICTION:
            mode = run.mode[d.source[i, 2]]
        elif d.kind[i] != SWITCH or side == 0:
            continue
        for b in range(1 if d.kind[i] == SWITCH or abs(mode) == SLIDING else 2):
            row, sign, shift = d.source[i, 0], copysign(1.0, mode), 0.0
            if d.kind[i] == FRICTION:
                law = d.law[d.source[i, 2]]
                shift = -law[DELTA]
                if mode == STUCK:
                    row, sign, shift = d.source[i, 1], 1.0 - 2.0 * b, law[F_S]
                elif abs(mode) == PUSHED and b == 1:
                    row, shift = d.source[i, 1], -law[F_S]
                elif abs(mode) == PUSHED:
                    sign, shift = -sign, law[DELTA]
            for k in range(N):
                p[k] = sign * c[row, k]
            p[0] += shift
            root = first_root_within(p, N, h, run.q)
            if root < best:
                best, which, border = root, i, b
    return best, which, border
