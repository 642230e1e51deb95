"""Series of the forces of contacts: dry friction, and those that stick like springs.

A spring's force grows by stiffness·v while it sticks, up to its limit in the direction of the motion. Elements of
Maxwell slip slide at their limit, which follows the Stribeck curve. Armstrong's law slides at F_c + P/(1 + (w/v_s)²) +
F_v·v, w the velocity one lag earlier; P is what a rest has left: from P_a, when the contact came to rest, it has grown
by (F_s − F_c − P_a)·t_2/(t_2 + dwell) when it breaks away. Either sticks again where v vanishes.
"""

from math import copysign, exp, expm1, inf

from friction.kernel import signals as sig
from friction.kernel.roots import shifted
from friction.kernel.signals import N
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
