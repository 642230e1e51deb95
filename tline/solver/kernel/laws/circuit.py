"""Laws in a circuit: the waves into all of them, at all coupled points, by one Newton method.

A law is a line end of no length. It receives the wave α = e + ρ i and returns β = e - ρ i = R(α); the circuit sends
α = c + S β, with c the waves from nodes and states. S cannot add energy if the circuit is passive, and R cannot
increase the distance of two waves if the law is monotone. So F(α) = α - c - S R(α) is monotone, and with μ (α - c)
added it has one root α(μ) for any laws. As μ falls from 1 that root moves, for each factor e, by no more than the
distance of c from a solution, and ends at the solution nearest to c (Tikhonov): a path of finite length, which
Newton's method follows if it does not find the solution from the last slab's waves directly.

If only a small part of a step reduces the residual, a kink stops it; it goes to just beyond. Beyond a kink the next
step continues, since Jacobians on both sides have determinants of one sign (Katzenelson 1965); where several kinks meet
it may return. So every other step is that of a contraction, which no kink stops.

References
----------
A. N. Tikhonov, V. Y. Arsenin: Solutions of Ill-Posed Problems, 1977; H. H. Bauschke, P. L. Combettes: Convex Analysis
and Monotone Operator Theory in Hilbert Spaces, 2017, section 23.4. J. Katzenelson: An algorithm for solving nonlinear
resistor networks, Bell Syst. Tech. J. 44 (1965) 1605-1620, doi:10.1002/j.1538-7305.1965.tb04195.x.
M. A. Krasnoselskii: Two remarks on the method of successive approximations, Uspekhi Mat. Nauk 10 (1955) 123-127.
"""

import numpy as np

from tline.compiled.unit import function, invoke, unit
from tline.solver.kernel.arithmetic import ACCEPTED_RESIDUAL, BEST_RESIDUAL, TINY, largest
from tline.solver.kernel.laws.answers import answered, exchange_states, respond_to, unbalance
from tline.solver.kernel.network import DIVIDED, MISSES, SPENT, Run

AT_ONCE, ALONG = 40, 200  # waves at which laws are asked: from the last slab's, and for each μ
MOST_SPENT = 50_000  # parts of slabs in which stores look for flows, of one group and slab: some seconds
RESTRAINT = 0.1  # in units of the relative residual, of steps where waves answer to nothing, as between shut valves
SHORTER, SHORTEST, ROUNDED = 0.25, 1e-9, 0.1  # a part of a step over the one before, the least, and so near the end
GAIN = 0.1  # least gain of a step, for each part of it
KINK, MOST_GROWTH = 0.1, 16.0  # part of a step that a kink stops, and most that the square beyond it may grow
SMALLER, SMALLEST = 1e-2, 1e-3  # a μ over the one before, at first and at least
STEEP, SMALLEST_MU = 0.99, 1e-17  # ratio of two μ at which a path is lost, and where it ends
ON_PATH = 0.1  # residual over μ, relative to the waves, with which the next μ is tried
QUICK = 1e-4  # of squares, with which the slopes of stores are kept
LOST, FOLLOWS, SOLVED = 0, 1, 2


@function
def aim(work, size, share):
    """Aim at a share of the step from where it starts."""
    for a in range(size):
        work.aimed[a] = work.start[a] - share * work.system[a, size]


@function
def relax(work, size, mu):
    """Go on by the mean of α and c + S R(α), which is nearer to any solution (Krasnoselskii 1955)."""
    for a in range(size):
        work.aimed[a] -= work.rest[a] / (2.0 + mu)


@function
def newton(run, g, q, h, step, at, k, mu):
    """Solve F + μ (α - c) = 0 from the waves `aimed`, only as accurately as the path needs if μ > 0.

    Without μ all steps to finite residuals are accepted: across kinks residuals rise before they
    vanish.
    """
    laws, work = run.network.laws, run.work.circuit
    size = (laws.first[g + 1] - laws.first[g]) * q
    faint = BEST_RESIDUAL * max(largest(run.work.row, k * q), work.largest[0])
    before, share, over, across, close, stops = np.inf, 1.0, False, False, False, 0
    for _ in range(ALONG if mu > 0.0 else AT_ONCE):
        now, worst, off, scale = unbalance(run, g, q, h, step, at, k, mu)
        if run.work.store.division[SPENT] > MOST_SPENT:
            return LOST
        free = across or (mu == 0.0 and not close)
        fits = now < np.inf if free else now <= (1.0 - GAIN * share) ** 2 * before
        if not fits and before < np.inf and share > (ROUNDED if close else SHORTEST):
            over, share = now <= MOST_GROWTH * before, share * SHORTER
            aim(work, size, share)
        elif not (fits or (now < np.inf and not close)):
            break
        elif share < KINK and not free:
            across, stops = True, stops + 1
            if over and stops % 2 == 1:
                aim(work, size, share / SHORTER)
            else:
                relax(work, size, mu)
        else:
            if worst <= BEST_RESIDUAL * scale:
                return SOLVED
            if off <= ON_PATH * mu * scale:
                return FOLLOWS
            answered(run, g, q, h, before == np.inf or now > QUICK * before)
            respond_to(run, g, q, step, at, k, mu if mu > 0.0 else RESTRAINT * min(worst / scale, 1.0))
            for a in range(size):
                work.start[a] = work.aimed[a]
            before, share, over, across, close = now, 1.0, False, False, worst <= max(ACCEPTED_RESIDUAL * scale, faint)
            aim(work, size, share)
    if not close:
        return LOST
    aim(work, size, 0.0)
    unbalance(run, g, q, h, step, at, k, mu)
    return SOLVED


@function
def followed(run, g, q, h, step, at, k):
    """Follow the path of α(μ) to the solution next to c. Returns whether it came there."""
    laws, work = run.network.laws, run.work.circuit
    size = (laws.first[g + 1] - laws.first[g]) * q
    mu, ratio = 1.0, SMALLER
    for a in range(size):
        work.aimed[a], work.safe[a] = work.given[a], work.given[a]
    while mu > SMALLEST_MU and ratio < STEEP:
        found = newton(run, g, q, h, step, at, k, mu)
        if found == SOLVED:
            return True
        if found == FOLLOWS:
            ratio = max(ratio**1.5, SMALLEST)
        else:
            mu, ratio = mu / ratio, np.sqrt(ratio)
        for a in range(size):
            if found == FOLLOWS:
                work.safe[a] = work.aimed[a]
            else:
                work.aimed[a] = work.safe[a]
        mu *= ratio
    return False


@function
def found(run, g, q, h, step, at, k):
    """Find the waves into the laws of a group, from the last ones or along the path. Returns whether it could.

    Where stores miss the flow, or none is found for them, the search is repeated with their slab divided.
    """
    laws, work, division = run.network.laws, run.work.circuit, run.work.store.division
    first, last, s, stores = laws.first[g], laws.first[g + 1], run.state.before.shape[1], 0
    division[SPENT] = 0
    for e in range(first, last):
        stores |= laws.state_at[e] >= 0
    for divided in range(1 + stores):
        division[DIVIDED] = divided
        for a in range((last - first) * q):
            work.aimed[a] = work.waves[first * s + a]
        solved = newton(run, g, q, h, step, at, k, 0.0) == SOLVED
        if not solved and not division[MISSES]:
            solved = followed(run, g, q, h, step, at, k)
        if solved and not division[MISSES]:
            return True
    return False


@unit
def circuit(run: Run, g: int, n: int, h: float, own: int) -> int:
    """Turn the Thévenin waves of n samples at a group with laws into efforts, through its map over a slab of width h.

    The map is that of the network, or with `own` the one in the workspace. After it come the states.
    """
    network, laws, work, u, states = run.network, run.network.laws, run.work.circuit, run.work.u, run.state.load
    r, x, s = network.step_row[g], network.load_at[g], run.state.before.shape[1]
    k, m, count = network.group[g + 1] - network.group[g], laws.first[g + 1] - laws.first[g], network.step_states[r]
    q = s if network.step_whole[r] else np.int64(1)
    step, at, row = network.step, network.step_at[r], run.work.row
    if own != 0:
        step, at = run.work.map, np.int64(0)
    size, low, first = m * q, (k + m) * q, laws.first[g]
    width = low + count
    work.width[0] = width
    for block in range(n // q):
        for p in range(k):
            for i in range(q):
                row[p * q + i] = u[p * n + block * q + i]
        for i in range(count):
            row[low + i] = states[x + i]
        for a in range(size):
            place, total = at + (k * q + a) * width, 0.0
            for j in range(k * q):
                total += step[place + j] * row[j]
            for j in range(low, width):
                total += step[place + j] * row[j]
            work.given[a] = 2.0 * total
        for law in range(m):
            for i in range(q):
                work.control[law, i] = run.work.control[law, block * q + i]
        exchange_states(run, g, False)
        if not found(run, g, q, h, step, at, k):
            for a in range(size):
                work.waves[first * s + a] = 0.0
            for p in range(k):
                u[p * n + n - 1] = np.nan  # where it is looked for
            return 0
        for a in range(size):
            row[k * q + a] = work.sent[a]
        if laws.pockets[g]:
            invoke(run.units.hold, (run, g, q, h, own))
        for a in range(size):
            work.waves[first * s + a] = work.aimed[a]
            stores = laws.state_at[first + a // q] >= 0
            run.work.into[a // q, block * q + a % q] = work.drive[a] if stores else work.aimed[a]
        for a in range(k * q):
            place, total = at + a * width, 0.0
            for j in range(width):
                total += step[place + j] * row[j]
            u[a // q * n + block * q + a % q] = total
        for i in range(count):
            place, total = at + (low + i) * width, 0.0
            for j in range(width):
                total += step[place + j] * row[j]
            states[x + i] = 0.0 if abs(total) < TINY else total
    return 0
