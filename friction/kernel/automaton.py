"""Diagrams as hybrid automata: contacts stuck or sliding one way, switches one way or
the other, until a guard vanishes.

The guard that vanished determines the event, and the state is set exactly there: v = 0 at a stop, F_a = ±F_s at a
break-away. A motion that reaches rest always sticks; if the force does not hold it there, it breaks away at the same
instant. Changes at one instant are one change, of the mode before to the mode after: stop and break-away the other way
are a reversal, break-away and stop are nothing. No leg depends on where the run ends or is sampled.
"""

from math import copysign, floor, inf, nan, pi

import numpy as np

from friction.kernel import structures as sig
from friction.kernel.diagram import expand, first_guard, trusted_step
from friction.kernel.law import BLOWN_UP, BUDGET, DONE, STALLED, put, row_of
from friction.kernel.roots import value
from friction.kernel.structures import EVENTS, STEPS, HybridRun, N
from tline.compiled.unit import function, unit

FOREVER = 1e13  # s, more than any run may last
STILL = 1e-250  # of a state, below which terms of series would be subnormal numbers, and steps without end
GRAIN = 1e-15  # of the time, some ulps: a leg so short may leave states as they are, and is no time
MOST_IDLE = 10  # changes at one instant, for each signal


@unit
def automaton(run: HybridRun, budget: int) -> int:
    """Run a diagram in at most `budget` legs; return the status."""
    d, inputs, sampled, clock, counts = run.diagram, run.inputs, run.sampled, run.clock, run.counts
    clock[sig.TURN], number, t, row, idle, taken, given = inputs.phase / (2.0 * pi), 0, 0.0, 0, 0, 0, 0
    for j in range(d.contact.size):
        v = run.state[d.source[d.contact[j], 0]]
        slides = d.kind[d.contact[j]] == sig.FRICTION and abs(v) > d.law[j, sig.DELTA]
        run.mode[j] = int(copysign(sig.SLIDING, v)) if slides else sig.STUCK
    for leg in range(budget):
        counts[STEPS], clock[sig.NOW] = leg + 1, t
        expand(run, number)
        if not is_finite(run.series):
            return BLOWN_UP
        if sampled.held.size > 0 and t >= taken * sampled.period:
            take(sampled, run.series, taken)
            taken += 1
            if sampled.delay > 0.0:
                continue
        if given < taken and t >= given * sampled.period + sampled.delay:
            outputs = sampled.queue.shape[1]
            for k in range(outputs):
                sampled.held[sampled.held.size - outputs + k] = sampled.queue[given % sampled.queue.shape[0], k]
            given += 1
            continue
        start = inputs.start[number]
        end = inputs.start[number + 1] if number + 1 < inputs.start.size else inf
        until = end
        if sampled.held.size > 0:
            until = min(end, taken * sampled.period, given * sampled.period + sampled.delay)
        left = ((until - start) - clock[sig.CLOCK]) + clock[sig.LOST]
        h = trusted_step(run, min(left, FOREVER))
        if h < 0.0:
            return STALLED
        root, which, border = first_guard(run, h)
        h = min(h, root)
        ends = h >= left and root == inf
        t = until if ends else max(t, start + (clock[sig.CLOCK] + (h - clock[sig.LOST])))
        if h > 0.0:
            row = sample(run, row, t, ends, start, h)
        if t > run.t_end:
            return DONE
        advance(run, h)
        still = h <= GRAIN * t
        idle = idle + 1 if still else 0
        if idle > MOST_IDLE * d.kind.size:
            return STALLED
        for i in range(0 if still and not ends else run.known.size):  # guards that vanish together are known together
            run.known[i] = nan
        if ends:
            number += until == end
            clock[sig.CLOCK], clock[sig.LOST] = (0.0 if until == end else until - start), 0.0
        elif root < inf and d.kind[which] == sig.FRICTION:
            change(run, which, border, root > 0.0, t, h)
        elif root < inf and d.kind[which] >= sig.MAXWELL:
            let_go(run, which, border, t, h)
        elif root < inf:
            run.known[d.source[which, 0]] = 0.0
    return BUDGET


@function
def is_finite(c):
    """Return whether all coefficients of all series are finite."""
    wrong = 0
    for i in range(c.shape[0]):
        for j in range(N + 1):
            wrong |= not abs(c[i, j]) < inf
    return wrong == 0


@function
def take(sampled, c, taken):
    """Sample the signals of a controller, into its registers and into the queue of its outputs."""
    registers = sampled.seen.size - sampled.queue.shape[1]
    for k in range(sampled.seen.size):
        if k < registers:
            sampled.held[k] = c[sampled.seen[k], 0]
        else:
            sampled.queue[taken % sampled.queue.shape[0], k - registers] = c[sampled.seen[k], 0]


@function
def change(run, i, border, later, t, h):
    """Another mode of a contact whose guard has vanished; if later than the leg began, the force may be known."""
    d, j = run.diagram, run.diagram.source[i, 2]
    v, f_a, law, mode, held = d.source[i, 0], d.source[i, 1], d.law[j], run.mode[j], nan
    s = copysign(1.0, mode)
    if mode == sig.STUCK:
        way = 2.0 * border - 1.0
        reached = law[sig.DELTA] == 0.0 or run.state[v] == way * law[sig.DELTA]
        new, held = int(way * (sig.SLIDING if reached else sig.PUSHED)), way * law[sig.F_S]
    elif abs(mode) == sig.PUSHED and border == 1:
        new, held = sig.STUCK, s * law[sig.F_S]
    else:
        run.state[v] = s * law[sig.DELTA]
        new = int(s * sig.SLIDING) if abs(mode) == sig.PUSHED else sig.STUCK
    if later:
        run.known[f_a] = held
    run.mode[j] = new
    run.counts[EVENTS] = tell(run.events, run.counts[EVENTS], mode, new, t, value(run.series[run.place[j]], h), j)


@function
def let_go(run, i, border, t, h):
    """A spring that reaches its limit, or whose velocity vanishes; with that, others of the same velocity follow."""
    d, v, j, mode = run.diagram, run.diagram.source[i, 0], run.diagram.source[i, 2], run.mode[run.diagram.source[i, 2]]
    memory, new = run.memory[j], sig.STUCK
    if mode == sig.STUCK and border == 0:
        new = run.side[i] * sig.SLIDING
        memory[sig.PEAK] = value(run.limit[j], h) - d.law[j, sig.F_C]
    elif h > 0.0:
        run.known[v] = 0.0
        if d.kind[v] == sig.STATE:
            run.state[v] = 0.0
    if mode != sig.STUCK:
        memory[sig.SINCE], memory[sig.REST], memory[sig.UNTIL] = t, memory[sig.LEFT], inf
    run.mode[j] = new
    run.counts[EVENTS] = tell(run.events, run.counts[EVENTS], mode, new, t, value(run.series[run.place[j]], h), j)


@function
def tell(events, met, before, after, t, x, contact):
    """Keep a change of the motion, together with those of the same instant; how many there are then."""
    old, new = np.sign(before), np.sign(after)
    if t == 0.0:  # how the run begins
        return met
    last = row_of(events, met - 1)
    for r in range(last if met > 0 else -1, -1, -1):
        if events[r, 2] != t:
            break
        if events[r, 4] == contact:
            events[r, 1] = new
            if events[r, 0] != new:
                return met
            for k in range(events.shape[1]):
                events[r, k] = events[last, k]
            return met - 1
    if old == new:
        return met
    met = put(events, met, old, new, t, x)
    events[row_of(events, met - 1), 4] = contact
    return met


@function
def sample(run, row, t, ends, start, h):
    """Keep the samples of a leg that ends at t, where inputs may jump: their values there are those of the next leg."""
    times, record, shown, clock = run.times, run.record, run.shown, run.clock
    while row < times.size and (times[row] < t or (times[row] == t and not ends)):
        at = min(max(((times[row] - start) - clock[sig.CLOCK]) + clock[sig.LOST], 0.0), h)
        record[row, 0] = times[row]
        for column in range(shown.size):
            record[row, 1 + column] = value(run.series[shown[column]], at)
        for j in range(run.mode.size):
            record[row, 1 + shown.size + j] = run.mode[j]
        row += 1
    return row


@function
def advance(run, h):
    """The state at the end of a leg; the clock is a compensated sum."""
    d, clock, state, omega = run.diagram, run.clock, run.state, run.inputs.omega
    for i in range(d.kind.size):
        if d.kind[i] == sig.STATE:
            state[i] = value(run.series[i], h)
    if h > 0.0:
        keep_springs(run, h)
    for w in range(d.watched.size):
        if abs(state[d.watched[w]]) < STILL:
            state[d.watched[w]] = 0.0
    if run.inputs.amplitude != 0.0:
        turn = clock[sig.TURN] + h * (omega / (2.0 * pi))
        clock[sig.TURN] = turn - floor(turn)
    step = h - clock[sig.LOST]
    total = clock[sig.CLOCK] + step
    clock[sig.LOST], clock[sig.CLOCK] = (total - clock[sig.CLOCK]) - step, total


@function
def keep_springs(run, h):
    """Forces of springs at the end of a leg, without viscous parts, and the velocities in it, for the lags."""
    d, most = run.diagram, run.past_start.size
    for j in range(d.contact.size):
        i, mode = d.contact[j], run.mode[j]
        if d.kind[i] >= sig.MAXWELL:
            held = value(run.limit[j], h)
            run.state[i] = value(run.series[i], h) if mode == sig.STUCK else copysign(held, mode)
            run.memory[j, sig.LEFT] = held - d.law[j, sig.F_C]
        for k in range(N + 1 if most > 0 else 0):
            run.past[run.counts[sig.LEGS] % most, j, k] = run.series[d.source[i, 0], k]
    if most > 0:
        run.past_start[run.counts[sig.LEGS] % most] = run.clock[sig.NOW]
        run.counts[sig.LEGS] += 1
