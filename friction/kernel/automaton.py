"""The static laws as a hybrid automaton: stuck, or sliding one way, until a guard of the mode vanishes.

Which guard vanished says what happens, and the state is put exactly there: v = 0 at a stop, F_a = ±F_s at a
break-away. A motion that reaches rest always sticks; if the force does not hold it there, it breaks away at the same
instant. Changes at one instant are one change, of the mode before to the mode after: stop and break-away the other way
are a reversal, break-away and stop are nothing. No leg depends on where the run ends or is looked at.
"""

from math import copysign, floor, inf, isfinite, nan, pi

import numpy as np

from friction.kernel.law import BLOWN_UP, BUDGET, DONE, FA, FF, MODE, STALLED, WA, WF, T, V, X, Z, piece, put, row_of
from friction.kernel.roots import first_root_within, value
from friction.kernel.structures import EVENTS, STEPS, HybridRun
from friction.kernel.taylor import (
    CFA,
    CFF,
    CLOCK,
    CV,
    CWA,
    CWF,
    CX,
    GAP,
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
from tline.compiled.unit import function, unit

FOREVER = 1e13  # s, more than any run may last
STILL = 1e-250  # m/s and m, below which terms of series would be subnormal numbers, and steps without end
MOST_IDLE = 10  # changes of mode at one instant


@unit
def automaton(run: HybridRun, budget: int) -> int:
    """Run a static law, in so many legs at most; returns the status."""
    law, drive, c, p, q, state, counts = run.law, run.drive, run.series, run.p, run.q, run.state, run.counts
    state[SV], state[TURN] = run.v0, drive.phase / (2.0 * pi)
    state[GAP], state[PULL] = drive.target, drive.stiffness * drive.target
    mode = int(copysign(SLIDING, run.v0)) if abs(run.v0) > law.delta else STUCK
    number, push, forced, row, idle = 0, piece(drive, 0), nan, 0, 0
    for leg in range(budget):
        expand(law, push, run.mass, state, mode, forced, c)
        if not is_finite(c):
            return BLOWN_UP
        counts[STEPS] = leg + 1
        left = ((push.end - push.start) - state[CLOCK]) + state[LOST]
        h = trusted_step(law, mode, c, min(left, FOREVER), p, q)
        root, border = first_guard(law, mode, c, h, p, q)
        h = min(h, root)
        ends = h >= left and root == inf
        t = push.end if ends else push.start + (state[CLOCK] + (h - state[LOST]))
        if h > 0.0:
            row = sample(run, row, t, push.start, h, mode)
        if t > run.t_end:
            return DONE
        advance(push, c, h, state)
        idle = idle + 1 if root == 0.0 else 0
        if idle > MOST_IDLE:
            return STALLED
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
            counts[EVENTS] = tell(run.events, counts[EVENTS], before, mode, t, state[SX])
    return BUDGET


@function
def is_finite(c):
    """Whether all series are but those of the Stribeck peak."""
    total = 0.0
    for k in range(CFF + 1):
        for j in range(N + 1):
            total += c[k, j]
    return isfinite(total)


@function
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
        for k in range(N):
            p[k] = sign * row[k]
        p[0] += shift
        root = first_root_within(p, N, h, q)
        if root < best:
            best, which = root, border
    return best, which


@function
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


@function
def tell(events, met, before, after, t, x):
    """Keep a change of the motion, together with those of the same instant; how many there are then."""
    old, new = np.sign(before), np.sign(after)
    if t == 0.0:  # how the run begins
        return met
    last = row_of(events, met - 1)
    if met > 0 and events[last, 2] == t:
        events[last, 1] = new
        return met - 1 if events[last, 0] == new else met
    return met if old == new else put(events, met, old, new, t, x)


@function
def sample(run, row, t, start, h, mode):
    """Keep the samples of a leg that ends at t; the number of the next."""
    times, record, state, c = run.times, run.record, run.state, run.series
    while row < times.size and times[row] <= t:
        at = min(max(((times[row] - start) - state[CLOCK]) + state[LOST], 0.0), h)
        for column, k in ((X, CX), (V, CV), (FA, CFA), (FF, CFF), (WA, CWA), (WF, CWF)):
            record[row, column] = value(c[k, : (N if k in (CFA, CFF) else N + 1)], at)
        record[row, T], record[row, Z], record[row, MODE] = times[row], 0.0, mode
        row += 1
    return row


@function
def advance(push, c, h, state):
    """The state at the end of a leg; the clock is a compensated sum, what pulls follows its own rate."""
    before = state[SX]
    for k, j in ((CX, SX), (CV, SV), (CWA, SWA), (CWF, SWF)):
        state[j] = value(c[k], h)
    if push.stiffness != 0.0 or push.integral != 0.0:
        area = 0.0
        for k in range(N, 0, -1):
            area = (area + c[CX, k] / (k + 1)) * h
        c[CX, 0] = 0.0
        closed = push.speed * h - value(c[CX], h)
        c[CX, 0] = before
        area = h * (state[GAP] + 0.5 * push.speed * h - area)
        state[PULL] += push.stiffness * closed + push.integral * area
        state[GAP] += closed
    for j in (SV, GAP):
        if abs(state[j]) < STILL:
            state[j] = 0.0
    if push.amplitude != 0.0:
        turn = state[TURN] + h * (push.omega / (2.0 * pi))
        state[TURN] = turn - floor(turn)
    step = h - state[LOST]
    clock = state[CLOCK] + step
    state[LOST], state[CLOCK] = (clock - state[CLOCK]) - step, clock
