"""Openings that efforts and flows at their own element move: of regulating valves, and of discs in the flow.

With x the opening, 0 to 1, u and w the efforts at the element's nodes and i its flow, the drive is
d = a (u - u0) + b (w - w0) + c (i - i0) - k x. A regulator has x' = d within its slowest and fastest rate; a disc with
inertia M and damping D has M x'' = d - D x'. Both stop at 0 and 1. Radau's stages of x' are found with the flows of the
group, by Broyden's method on the rates, and where that does not end, one rate after the other: a group's circuit is
unchanged, with given openings.

Constants: a, u0, b, w0, c, i0, k, slowest and fastest rate, M, D, number of points of a characteristic; its openings,
and its shares of the capacity.

References
----------
C. G. Broyden: A class of methods for solving nonlinear simultaneous equations, Math. Comp. 19 (1965) 577-593,
doi:10.1090/S0025-5718-1965-0198670-6.
"""

import numpy as np

from tline.compiled.unit import function, invoke, unit
from tline.solver.kernel.arithmetic import exchange_part
from tline.solver.kernel.laws.answers import keep_states
from tline.solver.kernel.laws.quadratic import rooted
from tline.solver.kernel.network import Run

AT_ONCE, IN_TURN = 40, 40  # tries; passes through all rates
BEST_RESIDUAL, ACCEPTED_RESIDUAL = 1e-15, 1e-11  # of an opening: aim of the iteration, and largest accepted
SLOWEST, FASTEST, INERTIA, DAMPING, POINTS = 7, 8, 9, 10, 11  # places of constants


@function
def share_of(c, at, x):
    """Share of the capacity at an opening."""
    n, k = int(c[at + POINTS]), 1
    if n == 0:
        return x
    openings, shares = at + POINTS + 1, at + POINTS + 1 + n
    while k < n - 1 and x > c[openings + k]:
        k += 1
    low = c[openings + k - 1]
    return c[shares + k - 1] + (c[shares + k] - c[shares + k - 1]) * (x - low) / (c[openings + k] - low)


@function
def opened(run, e, rate, o, j, h):
    """Opening of element e at point j, under the rates from place o on; at an end it stays until these turn."""
    tools, x = run.network.laws.tools, run.state.load[run.network.laws.governor_state[e]]
    radau, c, n = tools.radau, tools.c, tools.c.size
    begin, first = 0.0, rate[o] + (rate[o] - rate[o + 1]) * c[0] / (c[1] - c[0]) if n > 1 else rate[o]
    for k in range(j + 1):
        last, change, until = rate[o + k], 0.0, 0.0
        for i in range(n):
            change += h * (radau[k, i] - (radau[k - 1, i] if k > 0 else 0.0)) * rate[o + i]
        if first * last < 0.0:
            until = 0.5 * h * (c[k] - begin) * first * first / (first - last)
        x = min(max(x + until, 0.0), 1.0)
        x = min(max(x + change - until, 0.0), 1.0)
        begin, first = c[k], last
    return x


@function
def driven(run, g, e, j, x):
    """Drive of element e of a group at point j, and its flow, with the efforts that its opening x has led to.

    The flow comes from the wave into the law: of efforts that are nearly the same, the root would magnify the rounding.
    """
    laws, u, s = run.network.laws, run.work.u, run.network.laws.tools.c.size
    c, at = laws.constants, laws.governor[e]
    here = u[laws.from_node[e] * s + j] if laws.from_node[e] >= 0 else 0.0
    there = u[laws.to_node[e] * s + j] if laws.to_node[e] >= 0 else 0.0
    law, wave = laws.at[e], run.work.into[e - laws.first[g], j]
    flow = rooted(wave - c[law], laws.source_impedance[e], c[law + 1] * share_of(c, at, x), c[law + 2])[0]
    drive = c[at] * (here - c[at + 1]) + c[at + 2] * (there - c[at + 3]) + c[at + 4] * (flow - c[at + 5])
    return drive - c[at + 6] * x, flow


@function
def exchange(run, g, n, give):
    """Put waves and states of a group aside, or give them back."""
    work = run.work.govern
    exchange_part(run.work.u, np.int64(0), (run.network.group[g + 1] - run.network.group[g]) * n, work.u, give)
    keep_states(run, g, work.kept, give)


@function
def respond_under(run, g, n, h, own):
    """Efforts of a group under the openings of the rates that are tried. Returns whether there are any."""
    laws, rate = run.network.laws, run.work.govern.rate
    for e in range(laws.first[g], laws.first[g + 1]):
        a, at = e - laws.first[g], laws.governor[e]
        for j in range(n if at >= 0 else 0):
            run.work.control[a, j] = share_of(laws.constants, at, opened(run, e, rate, a * n, j, h))
    if run.network.load_at[g] >= 0:
        invoke(run.units.circuit, (run, g, n, h, own))
    else:
        invoke(run.units.crossing, (run, g, n, h))
    return np.isfinite(run.work.u[n - 1])


@function
def unsettled(run, g, n, h):
    """Residuals of the rates of openings at all points. Returns the largest."""
    laws, work, radau = run.network.laws, run.work.govern, run.network.laws.tools.radau
    c, worst = laws.constants, 0.0
    for e in range(laws.first[g], laws.first[g + 1]):
        o, at, place = (e - laws.first[g]) * n, laws.governor[e], laws.governor_state[e]
        for j in range(n if at >= 0 else 0):
            work.turned[o + j] = driven(run, g, e, j, opened(run, e, work.rate, o, j, h))[0]
        for j in range(n if at >= 0 else 0):
            if c[at + INERTIA] > 0.0:
                led = run.state.load[place + 1]
                for i in range(n):
                    force = work.turned[o + i] - c[at + DAMPING] * work.rate[o + i]
                    led += h * radau[j, i] * force / c[at + INERTIA]
            else:
                led = min(max(work.turned[o + j], c[at + SLOWEST]), c[at + FASTEST])
            work.rest[o + j] = work.rate[o + j] - led
            worst = max(worst, abs(work.rest[o + j]))
    return worst


@function
def learn(work, size):
    """Broyden's update of the inverse, after a step."""
    inverse, step, turned, along = work.inverse, work.step, work.turned, 0.0
    for a in range(size):
        turned[a] = 0.0
        for b in range(size):
            turned[a] += inverse[a, b] * (work.rest[b] - work.last[b])
        along += step[a] * turned[a]
    if along == 0.0:
        return
    for b in range(size):
        seen = 0.0
        for a in range(size):
            seen += step[a] * inverse[a, b]
        work.last[b] = seen / along
    for a in range(size):
        for b in range(size):
            inverse[a, b] += (step[a] - turned[a]) * work.last[b]


@function
def move(work, size):
    """Take Broyden's step."""
    for a in range(size):
        work.step[a] = 0.0
        for b in range(size):
            work.step[a] -= work.inverse[a, b] * work.rest[b]
    for a in range(size):
        work.rate[a] += work.step[a]
        work.last[a] = work.rest[a]


@function
def commit(run, g, n, h):
    """Advance the openings; the rate is zero at the end of a stroke."""
    laws, work, states = run.network.laws, run.work.govern, run.state.load
    for e in range(laws.first[g], laws.first[g + 1]):
        o, at, place = (e - laws.first[g]) * n, laws.governor[e], laws.governor_state[e]
        if at < 0:
            continue
        for j in range(n):
            flow = driven(run, g, e, j, opened(run, e, work.rate, o, j, h))[1]
            states[place + 2] = min(states[place + 2], flow)
        x, v = opened(run, e, work.rate, o, n - 1, h), work.rate[o + n - 1]
        stopped = (x <= 0.0 and v < 0.0) or (x >= 1.0 and v > 0.0)
        states[place], states[place + 1] = x, 0.0 if stopped else v


@function
def tried(run, g, n, h, own):
    """Apply the rates. Returns the largest residual of openings, or nan where no flow was found."""
    exchange(run, g, n, True)
    return h * unsettled(run, g, n, h) if respond_under(run, g, n, h, own) else np.nan


@function
def begin(run, g, n):
    """Start from the present rates of openings."""
    laws, work = run.network.laws, run.work.govern
    for e in range(laws.first[g], laws.first[g + 1]):
        for j in range(n):
            a = (e - laws.first[g]) * n + j
            work.rate[a] = run.state.load[laws.governor_state[e] + 1] if laws.governor[e] >= 0 else 0.0
            work.rest[a] = 0.0


@function
def settled_at_once(run, g, n, h, own):
    """Find all rates by Broyden's method. Returns whether it could."""
    work, size, before = run.work.govern, (run.network.laws.first[g + 1] - run.network.laws.first[g]) * n, np.inf
    for a in range(size):
        for b in range(size):
            work.inverse[a, b] = 1.0 if a == b else 0.0
    for step in range(AT_ONCE):
        worst = tried(run, g, n, h, own)
        if worst <= BEST_RESIDUAL or (worst <= ACCEPTED_RESIDUAL and worst >= 0.5 * before):
            return True
        if not np.isfinite(worst):
            return False
        before = worst
        if step > 0:
            learn(work, size)
        move(work, size)
    return False


@function
def settled_in_turn(run, g, n, h, own):
    """Find one rate after the other by halving, until none moves any more. Returns whether they came to rest.

    An opening that rises lowers its own drive. So the residual of a rate rises with it, and at least as much: its root
    is no farther away than that residual.
    """
    laws, work = run.network.laws, run.work.govern
    for _ in range(IN_TURN):
        moved = 0.0
        for a in range((laws.first[g + 1] - laws.first[g]) * n):
            if laws.governor[laws.first[g] + a // n] < 0:
                continue
            begun = work.rate[a]
            if not np.isfinite(tried(run, g, n, h, own)):
                return False
            low, high = min(begun, begun - work.rest[a]), max(begun, begun - work.rest[a])
            while h * (high - low) > BEST_RESIDUAL and low < 0.5 * (low + high) < high:
                work.rate[a] = 0.5 * (low + high)
                if not np.isfinite(tried(run, g, n, h, own)):
                    return False
                if work.rest[a] > 0.0:
                    high = work.rate[a]
                else:
                    low = work.rate[a]
            moved = max(moved, h * abs(work.rate[a] - begun))
        if moved <= ACCEPTED_RESIDUAL:
            return True
    return False


@unit
def govern(run: Run, g: int, n: int, h: float, own: int) -> int:
    """Turn the Thévenin waves of one slab, or piece, of width h into efforts, with openings that these move."""
    exchange(run, g, n, False)
    begin(run, g, n)
    settled = settled_at_once(run, g, n, h, own)
    if not settled:
        begin(run, g, n)
        settled = settled_in_turn(run, g, n, h, own)
    if settled:
        commit(run, g, n, h)
    else:
        run.work.u[n - 1] = np.nan
    return 0
