"""Small mechanisms as diagrams of signals, expanded in series of the time since the start of a leg.

A signal is an input, a state (the integral of a signal), a sum, a product, a switch between two, a value held by a
sampled controller, or the friction of a contact. All but integrands precede the signals made of them, so one pass
finds term k of all series from the terms before.

A contact keeps its applied force less stiction, and the drop of friction from its peak, as series of their own, so that
at a break-away, where F_a = F_s and v = 0, nothing is left of rounding that could push the wrong way.
"""

from math import copysign, cos, exp, expm1, factorial, inf, isnan, pi, sin

import numpy as np

from friction.kernel import structures as sig
from friction.kernel.roots import first_root_within, shifted
from friction.kernel.structures import N
from tline.compiled.unit import function

FAR = 6.0  # multiples of v_s at which e^(−(v/v_s)²) begins to count: 2e-16
EARLY = 1e-14  # of the time, by which a past leg may be read before it begins


@function
def rub(d, modes, bell, c, i, k):
    """Term k of the friction of a contact, and of the applied force less it."""
    v, f_a, j = d.source[i, 0], d.source[i, 1], d.source[i, 2]
    mode, law = modes[j], d.law[j]
    if mode == sig.STUCK:
        c[i, k], c[i + 1, k] = c[f_a, k], 0.0
        return
    s, sliding, drop = copysign(1.0, mode), abs(mode) == sig.SLIDING, 0.0
    peak, viscous = (law[sig.F_S] - law[sig.F_C], law[sig.F_V]) if sliding else (0.0, 0.0)
    if sliding and beyond(law, c[v, 0]):
        drop = 1.0 if k == 0 else 0.0
    elif peak > 0.0:
        drop = drop_term(law[sig.V_S], c[v], bell[2 * j], bell[2 * j + 1], k)
    stiction = law[sig.F_S] if k == 0 else 0.0
    held = -s * viscous * c[v, k] + peak * drop
    if k == 0 and sliding and law[sig.DELTA] > 0.0 and abs(c[v, 0]) == law[sig.DELTA]:
        held = max(held, 0.0)  # friction at the border of a dead zone is at most F_s
    c[i, k] = s * (stiction - peak * drop) + viscous * c[v, k]
    c[i + 1, k] = s * ((s * c[f_a, k] - stiction) + held)


@function
def beyond(law, v):
    """Whether the speed is so high that nothing is left of the Stribeck peak."""
    return law[sig.F_S] > law[sig.F_C] and abs(v) > 1.001 * FAR * law[sig.V_S]


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
def stretch(run, i, k):
    """Term k of the force of a spring, and of its limit."""
    d, c, v, j = run.diagram, run.series, run.diagram.source[i, 0], run.diagram.source[i, 2]
    law, mode, bell, limit = d.law[j], run.mode[j], run.bell, run.limit[j]
    if k == 0:
        run.side[i] = 0
    if run.side[i] == 0:
        run.side[i] = int(copysign(1.0, c[v, k])) if c[v, k] != 0.0 else 0
    if d.kind[i] == sig.ARMSTRONG and mode == sig.STUCK:
        limit[k] = recovered(law, run.memory[j], run.clock[sig.NOW], limit, k)
    elif d.kind[i] == sig.ARMSTRONG:
        if k == 0:
            look_back(run, j)
        w = run.late[j] if law[sig.LAG] > 0.0 else c[v]
        limit[k] = (law[sig.F_C] if k == 0 else 0.0) + run.memory[j, sig.PEAK] * share_term(law, w, bell, j, k)
    elif law[sig.F_S] == law[sig.F_C] or beyond(law, c[v, 0]):
        limit[k] = law[sig.F_C] if k == 0 else 0.0
    else:
        drop = drop_term(law[sig.V_S], c[v], bell[2 * j], bell[2 * j + 1], k)
        limit[k] = (law[sig.F_S] if k == 0 else 0.0) - (law[sig.F_S] - law[sig.F_C]) * drop
    if mode != sig.STUCK:
        c[i, k] = copysign(1.0, mode) * limit[k] + law[sig.F_V] * c[v, k]
    else:
        c[i, k] = run.state[i] if k == 0 else law[sig.STIFFNESS] * c[v, k - 1] / k


@function
def recovered(law, memory, now, limit, k):
    """Term k of the force that an Armstrong contact holds: stiction comes back with the time of rest."""
    since, gain = memory[sig.SINCE], law[sig.F_S] - law[sig.F_C] - memory[sig.REST]
    if since == -inf or law[sig.DWELL] == 0.0:
        return law[sig.F_S] if k == 0 else 0.0
    ahead = now - since + law[sig.DWELL]
    if k < 2:
        left = gain * law[sig.DWELL] / ahead
        return law[sig.F_S] - left if k == 0 else left / ahead
    return -limit[k - 1] / ahead


@function
def share_term(law, w, bell, j, k):
    """Term k of 1/(1 + (w/v_s)²)."""
    square, share, total = bell[2 * j], bell[2 * j + 1], 0.0
    for n in range(k + 1):
        total += (w[n] / law[sig.V_S]) * (w[k - n] / law[sig.V_S])
    square[k] = total
    total = 1.0 if k == 0 else 0.0
    for n in range(1, k + 1):
        total -= square[n] * share[k - n]
    share[k] = total / (1.0 + square[0])
    return share[k]


@function
def look_back(run, j):
    """Velocity one lag earlier, 0 before the run, and until when the leg that it comes from goes on.

    That is negative if the leg is no longer kept.
    """
    memory, late, lag, legs = run.memory[j], run.late[j], run.diagram.law[j, sig.LAG], run.counts[sig.LEGS]
    most, now = run.past_start.size, run.clock[sig.NOW]
    at, read = now - lag, max(int(memory[sig.READ]), legs - most)
    memory[sig.UNTIL] = inf
    if lag == 0.0:
        return
    if at < -EARLY * lag:
        memory[sig.UNTIL] = -at
        for k in range(late.size):
            late[k] = 0.0
        return
    if legs > most and run.past_start[read % most] > at + EARLY * now:
        memory[sig.UNTIL] = -1.0
        return
    while read + 1 < legs and run.past_start[(read + 1) % most] <= at + EARLY * now:
        read += 1
    memory[sig.READ] = read
    end = run.past_start[(read + 1) % most] if read + 1 < legs else now
    memory[sig.UNTIL] = end - at
    shifted(run.past[read % most, j], at - run.past_start[read % most], late)


@function
def spring_guard(run, i, border, p):
    """Put the guard of a spring into p; return whether it has one with this number.

    Stuck: the force reaches its limit in the direction of the motion (border 0), or that changes (1). Sliding: the
    velocity vanishes.
    """
    c, v, j, side = run.series, run.diagram.source[i, 0], run.diagram.source[i, 2], run.side[i]
    sign = copysign(1.0, run.mode[j]) if run.mode[j] != sig.STUCK else side
    for k in range(N):
        p[k] = run.limit[j, k] - side * c[i, k] if run.mode[j] == sig.STUCK and border == 0 else sign * c[v, k]
    if run.mode[j] != sig.STUCK and side != sign:
        p[0] = -1.0  # at once
    return side != 0 if run.mode[j] == sig.STUCK else border == 0


INVERSE = np.array([1.0 / factorial(k) for k in range(N + 1)])
SERIES_TAIL = 1e-17  # of a series' largest early term: largest last terms


@function
def expand(run, number):
    """Series of all signals, while one piece of the inputs lasts."""
    d, c, known, side, state = run.diagram, run.series, run.known, run.side, run.state
    kinds, source, first, term, factor = d.kind, d.source, d.first, d.term, d.factor
    for i in range(kinds.size):
        if kinds[i] <= sig.HELD:
            expand_input(run, number, i)
    for k in range(N):
        for i in range(kinds.size):
            kind = kinds[i]
            if kind == sig.STATE:
                c[i, k] = state[i] if k == 0 else c[source[i, 0], k - 1] / k
            elif kind == sig.SUM:
                total = d.constant[i] if k == 0 else 0.0
                for j in range(first[i], first[i + 1]):
                    total += factor[j] * c[term[j], k]
                c[i, k] = total
            elif kind == sig.PRODUCT:
                total, one, other = 0.0, source[i, 0], source[i, 1]
                for j in range(k + 1):
                    total += c[one, j] * c[other, k - j]
                c[i, k] = total
            elif kind == sig.SWITCH:
                if k == 0:
                    side[i] = 0
                if side[i] == 0:
                    side[i] = int(np.sign(c[source[i, 0], k]))
                c[i, k] = c[source[i, 1 if side[i] > 0 else 2], k]
            elif kind == sig.FRICTION:
                rub(d, run.mode, run.bell, c, i, k)
            elif kind >= sig.MAXWELL:
                stretch(run, i, k)
            if k == 0 and not isnan(known[i]):
                c[i, 0] = known[i]
    for i in range(kinds.size):
        if kinds[i] == sig.STATE:
            c[i, N] = c[source[i, 0], N - 1] / N


@function
def expand_input(run, number, i):
    """Expand an input or a held value."""
    inputs, clock, out, k = run.inputs, run.clock, run.series[i], run.diagram.source[i, 0]
    for j in range(N):
        out[j] = 0.0
    if run.diagram.kind[i] == sig.HELD:
        out[0] = run.sampled.held[k]
        return
    shifted(inputs.power[number, k], clock[sig.CLOCK] - clock[sig.LOST], out)
    if k == 0 and inputs.amplitude != 0.0:
        angle = 2.0 * pi * clock[sig.TURN]
        a, b, power = inputs.amplitude * sin(angle), inputs.amplitude * cos(angle), 1.0
        for j in range(N):
            out[j] += a * power * INVERSE[j]
            a, b, power = b, -a, power * inputs.omega


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
        last = N if d.kind[i] == sig.STATE else N - 1
        h = trusted(c[i], last, trusted(c[i], last - 1, h))
    for j in range(d.contact.size):
        i, law = d.contact[j], d.law[j]
        v = d.source[i, 0]
        if d.kind[i] >= sig.MAXWELL:
            h = min(trusted(run.limit[j], N - 1, trusted(run.limit[j], N - 2, h)), run.memory[j, sig.UNTIL])
        if (d.kind[i] == sig.MAXWELL or abs(run.mode[j]) == sig.SLIDING) and beyond(law, c[v, 0]):
            for k in range(N):
                p[k] = copysign(1.0, c[v, 0]) * c[v, k]
            p[0] -= FAR * law[sig.V_S]
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
        is_spring = d.kind[i] >= sig.MAXWELL
        if is_spring or d.kind[i] == sig.FRICTION:
            mode = run.mode[d.source[i, 2]]
        elif d.kind[i] != sig.SWITCH or side == 0:
            continue
        for b in range(1 if d.kind[i] == sig.SWITCH or abs(mode) == sig.SLIDING else 2):
            if is_spring and not spring_guard(run, i, b, p):
                continue
            row, sign, shift = d.source[i, 0], copysign(1.0, mode), 0.0
            if d.kind[i] == sig.FRICTION:
                law = d.law[d.source[i, 2]]
                shift = -law[sig.DELTA]
                if mode == sig.STUCK:
                    row, sign, shift = d.source[i, 1], 1.0 - 2.0 * b, law[sig.F_S]
                elif abs(mode) == sig.PUSHED and b == 1:
                    row, shift = d.source[i, 1], -law[sig.F_S]
                elif abs(mode) == sig.PUSHED:
                    sign, shift = -sign, law[sig.DELTA]
            for k in range(N if not is_spring else 0):
                p[k] = sign * c[row, k]
            p[0] += shift
            root = first_root_within(p, N, h, run.q)
            if root < best:
                best, which, border = root, i, b
    return best, which, border
