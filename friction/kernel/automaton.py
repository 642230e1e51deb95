"""The static laws as a hybrid automaton: stuck, or sliding one way, until a guard of the mode vanishes.

Which guard vanished says what happens, and the state is put exactly there: v = 0 at a stop, F_a = ±F_s at a
break-away. A motion that reaches rest always sticks; if the force does not hold it there, it breaks away at the same
instant. Changes at one instant are one change, of the mode before to the mode after: stop and break-away the other way
are a reversal, break-away and stop are nothing. No leg depends on where the run ends or is looked at.
"""

from math import copysign, floor, inf, isfinite, nan, pi

import numpy as np

from friction.kernel.law import BLOWN_UP, BUDGET, DONE, FA, FF, MODE, OPTIONS, STALLED, WA, WF, T, V, X, Z, piece, room
from friction.kernel.roots import first_root_within, value
from friction.kernel.taylor import (
    CFA,
    CFF,
    CLOCK,
    CV,
    CWA,
    CWF,
    CX,
    LOST,
    PULL,
    PUSHED,
    SLIDING,
    STUCK,
    SV,
    SWA,
    SWF,
    SX,
    TURN,
    N,
    expand,
    trusted_step,
)
from tline.compiled import njit

FOREVER = 1e13  # s, more than any run may last
MOST_IDLE = 10  # changes of mode at one instant


@njit(**OPTIONS)
def automaton(law, drive, mass, v0, t_end, times, budget, record):
    """Returns the status, legs made, and events as rows (sign of the motion before, after, t, x)."""
    c, p, q, state = np.zeros((8, N + 1)), np.empty(N + 1), np.empty(N + 1), np.zeros(8)
    state[SV], state[TURN] = v0, drive.phase / (2.0 * pi)
    mode = int(copysign(SLIDING, v0)) if abs(v0) > law.delta else STUCK
    number, push, forced, row, met, idle, events = 0, piece(drive, 0), nan, 0, 0, 0, np.empty((16, 4))
    for leg in range(budget):
        expand(law, push, mass, state, mode, forced, c)
        if not isfinite(c[: CFF + 1].sum()):
            return BLOWN_UP, leg, events[:met]
        left = ((push.end - push.start) - state[CLOCK]) + state[LOST]
        h = trusted_step(law, mode, c, min(left, FOREVER), p, q)
        root, border = first_guard(law, mode, c, h, p, q)
        h = min(h, root)
        ends = h >= left and root == inf
        t = push.end if ends else push.start + (state[CLOCK] + (h - state[LOST]))
        if h > 0.0:
            row = sample(times, row, t, push.start, state, h, mode, c, record)
        if t > t_end:
            return DONE, leg + 1, events[:met]
        advance(push, c, h, state)
        idle = idle + 1 if root == 0.0 else 0
        if idle > MOST_IDLE:
            return STALLED, leg + 1, events[:met]
        if ends:
            number, state[CLOCK], state[LOST], forced = number + 1, 0.0, 0.0, nan
            push = piece(drive, number)
        elif root == inf:
            forced = nan
        else:
            before = mode
            mode, held = changed(law, mode, border, state)
            if root > 0.0:
                forced = held
            events = room(events, met)
            met = tell(events, met, before, mode, t, state[SX])
    return BUDGET, budget, events[:met]


@njit(**OPTIONS)
def first_guard(law, mode, c, h, p, q):
    """Time at which the first guard of the mode vanishes, inf if none does, and which: 0 or 1.

    Stuck: −F_a and +F_a reach F_s. Sliding: the speed falls to δ. Pushed: the speed rises to δ, the force falls to F_s.
    """
    best, which, s = inf, 0, copysign(1.0, mode)
    for border in range(1 if abs(mode) == SLIDING else 2):
        row, sign, shift = c[CV], s, -law.delta
        if mode == STUCK:
            row, sign, shift = c[CFA], 1.0 - 2.0 * border, law.f_s
        elif abs(mode) == PUSHED:
            row, sign, shift = (c[CFA], s, -law.f_s) if border else (c[CV], -s, law.delta)
        p[:N] = sign * row[:N]
        p[0] += shift
        root = first_root_within(p, N, h, q)
        if root < best:
            best, which = root, border
    return best, which


@njit(**OPTIONS)
def changed(law, mode, border, state):
    """Mode after a guard has vanished, and the applied force if that says what it is, else NaN."""
    if mode == STUCK:
        way = 2.0 * border - 1.0
        reached = law.delta == 0.0 or state[SV] == way * law.delta
        return int(way * (SLIDING if reached else PUSHED)), way * law.f_s
    s = copysign(1.0, mode)
    if abs(mode) == PUSHED and border == 1:
        return STUCK, s * law.f_s
    state[SV] = s * law.delta
    return (int(s * SLIDING) if abs(mode) == PUSHED else STUCK), nan


@njit(**OPTIONS)
def tell(events, met, before, after, t, x):
    """Keep a change of the motion, together with those of the same instant; how many there are then."""
    old, new = np.sign(before), np.sign(after)
    if t == 0.0:  # how the run begins
        return met
    if met > 0 and events[met - 1, 2] == t:
        events[met - 1, 1] = new
        return met - 1 if events[met - 1, 0] == new else met
    if old == new:
        return met
    events[met, 0], events[met, 1], events[met, 2], events[met, 3] = old, new, t, x
    return met + 1


@njit(**OPTIONS)
def sample(times, row, t, start, state, h, mode, c, record):
    """Keep the samples of a leg that ends at t; the number of the next."""
    while row < times.size and times[row] <= t:
        at = min(max(((times[row] - start) - state[CLOCK]) + state[LOST], 0.0), h)
        for column, k in ((X, CX), (V, CV), (FA, CFA), (FF, CFF), (WA, CWA), (WF, CWF)):
            record[row, column] = value(c[k, : (N if k in (CFA, CFF) else N + 1)], at)
        record[row, T], record[row, Z], record[row, MODE] = times[row], 0.0, mode
        row += 1
    return row


@njit(**OPTIONS)
def advance(push, c, h, state):
    """The state at the end of a leg; the clock is a compensated sum, the spring's force follows its own rate."""
    before = state[SX]
    for k, j in ((CX, SX), (CV, SV), (CWA, SWA), (CWF, SWF)):
        state[j] = value(c[k], h)
    if push.stiffness != 0.0:
        c[CX, 0] = 0.0
        state[PULL] += push.stiffness * (push.speed * h - value(c[CX], h))
        c[CX, 0] = before
    if push.amplitude != 0.0:
        turn = state[TURN] + h * (push.omega / (2.0 * pi))
        state[TURN] = turn - floor(turn)
    step = h - state[LOST]
    clock = state[CLOCK] + step
    state[LOST], state[CLOCK] = (clock - state[CLOCK]) - step, clock
