"""Small mechanisms as diagrams of signals, expanded in series of the time since the start of a leg.

A signal is an input, a state (the integral of a signal), a sum, a product, a switch between two, a value held by a
sampled controller, or the friction of a contact. All but integrands precede the signals made of them, so one pass
finds term k of all series from the terms before.

A contact keeps its applied force less stiction, and the drop of friction from its peak, as series of their own, so that
at a break-away, where F_a = F_s and v = 0, nothing is left of rounding that could push the wrong way.
"""

from math import copysign, cos, factorial, inf, isnan, pi, sin

import numpy as np

from friction.kernel import signals as sig
from friction.kernel.contacts import FAR, beyond, rub, spring_guard, stretch
from friction.kernel.roots import first_root_within, shifted
from friction.kernel.signals import N
from tline.compiled.unit import function

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
