"""Taylor series of the static laws, stuck or sliding, from recurrences, in time since the start of a leg.

The applied force less stiction, u = ±F_a − F_s, and the drop of friction from its peak are series of their own, so that
at a break-away, where u = 0 and v = 0, nothing is left of rounding that could push the wrong way.
"""

from math import copysign, cos, exp, expm1, factorial, isnan, pi, sin

import numpy as np

from friction.kernel.roots import first_root_within
from tline.compiled.unit import function

STUCK, SLIDING, PUSHED = 0, 1, 2  # modes, with the sign of the motion; pushed: within a dead zone, but too hard to hold
N = 20  # terms of a series
ROWS = 8  # of series
CX, CV, CFA, CFF, CWA, CWF, SQUARE, BELL = range(ROWS)
STATE = 9  # numbers of a state
SX, SV, SWA, SWF, CLOCK, LOST, TURN, PULL, GAP = range(STATE)  # clock since the piece began, turns of the sine, force
# of the spring or of a controller without its derivative part, and what is left to the target
INVERSE = np.array([1.0 / factorial(k) for k in range(N + 1)])
ROUNDING = 1e-17  # of a series' largest early term: what its last terms may be
FAR = 6.0  # multiples of v_s at which e^(−(v/v_s)²) begins to count: 2e-16


@function
def applied_series(push, state, out):
    """The applied force without its spring."""
    clock = state[CLOCK] - state[LOST]
    for k in range(out.size):
        out[k] = 0.0
    out[0] = push.value + push.slope * clock
    out[1] = push.slope
    if push.amplitude != 0.0:
        angle = 2.0 * pi * state[TURN]
        a, b, power = push.amplitude * sin(angle), push.amplitude * cos(angle), 1.0
        for k in range(N):
            out[k] += a * power * INVERSE[k]
            a, b, power = b, -a, power * push.omega


@function
def expand(law, push, mass, state, mode, forced, c):
    """Series about the state into c: x, v, F_a, F_f, works of F_a and F_f, (v/v_s)², e^(−(v/v_s)²).

    `forced` is the applied force where an event says what it is, NaN elsewhere.
    """
    x, v, f_a, f_f, square, bell = c[CX], c[CV], c[CFA], c[CFF], c[SQUARE], c[BELL]
    s = copysign(1.0, mode)
    sliding = abs(mode) == SLIDING
    peak, viscous = (law.f_s - law.f_c, law.f_v) if sliding else (0.0, 0.0)
    applied_series(push, state, f_a)
    x[0], v[0], pull, still, left = state[SX], state[SV], state[PULL], mode == STUCK, state[GAP]
    border = sliding and law.delta > 0.0 and abs(v[0]) == law.delta
    far, drop = beyond(law, mode, v[0]), 0.0
    for k in range(N):
        closing = (push.speed if k == 0 else 0.0) - v[k]
        f_a[k] += pull + push.derivative * closing
        if k == 0 and not isnan(forced):
            f_a[0] = forced
        pull, left = (push.stiffness * closing + push.integral * left) / (k + 1), closing / (k + 1)
        if far:
            drop = 1.0 if k == 0 else 0.0
        elif peak > 0.0:
            drop = drop_term(law.v_s, v, square, bell, k)
        if still:
            f_f[k], v[k + 1] = f_a[k], 0.0
        else:
            stiction = law.f_s if k == 0 else 0.0
            held = -s * viscous * v[k] + peak * drop
            if border and k == 0:
                held = max(held, 0.0)  # friction at the border of a dead zone is at most F_s
            f_f[k] = s * (stiction - peak * drop) + viscous * v[k]
            v[k + 1] = s * ((s * f_a[k] - stiction) + held) / (mass * (k + 1))
        x[k + 1] = v[k] / (k + 1)
    works(c, state, still and v[0] == 0.0)


@function
def beyond(law, mode, v):
    """Whether the sliding is so fast that nothing is left of the Stribeck peak."""
    return abs(mode) == SLIDING and law.f_s > law.f_c and abs(v) > 1.001 * FAR * law.v_s


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
def works(c, state, at_rest):
    """Series of the works of both forces."""
    v, f_a, f_f, w_a, w_f = c[CV], c[CFA], c[CFF], c[CWA], c[CWF]
    w_a[0], w_f[0] = state[SWA], state[SWF]
    for k in range(N):
        into = taken = 0.0
        if not at_rest:
            for j in range(k + 1):
                into += f_a[j] * v[k - j]
                taken += f_f[j] * v[k - j]
        w_a[k + 1], w_f[k + 1] = into / (k + 1), taken / (k + 1)


@function
def trusted(row, n, h):
    """Largest step up to h at which term n is rounding of the largest early one."""
    last, found = abs(row[n]), 0.0
    if last == 0.0:
        return h
    for k in range(6):
        if row[k] != 0.0:
            found = max(found, (ROUNDING * abs(row[k]) / last) ** (1.0 / (n - k)))
    return min(h, found)


@function
def trusted_step(law, mode, c, h, p, q):
    """Largest step up to h at which the series are exact to rounding.

    Far out, a step ends where the bell e^(−(v/v_s)²) begins to count.
    """
    for n in (N - 1, N):
        if mode != STUCK:
            h = trusted(c[CV], n, h)
        h = trusted(c[CFA], n - 1, h)
    if beyond(law, mode, c[CV, 0]):
        for k in range(N):
            p[k] = copysign(1.0, mode) * c[CV, k]
        p[0] -= FAR * law.v_s
        h = min(h, first_root_within(p, N, h, q))
    return h
