"""One step of a Taylor series on bristles that slip at any deflection: explicit, of order 16."""

from math import cos, exp, sin

from friction.kernel.law import applied, respond
from tline.compiled.unit import function

TERMS = 17  # of a series, with the first
ROWS = 6
SQUARE, BELL, SLIP, RATE, PULL, HELD = range(ROWS)  # (v/v_s)², its bell, v·z/g, ż, F_a, F_f
MIDDLE, SAFE = 0.5, 4.0  # where within a step the law is asked again; how much less than its defect a step is off


@function
def taylor(law, push, mass, t, s, h, work):
    """One step from y into `new` of `work`, and its polynomials into `dense` (TERMS, 5).

    The last row of u holds the error: of v and z what they miss of the law in the middle and at the end, for the bell
    e^(−(v/v_s)²) is invisible in the first terms where v is far above v_s; of the others the last term.
    """
    y, new, c, error = work.y, work.new, work.dense, work.u[work.u.shape[0] - 1]
    for j in range(5):
        c[0, j] = y[j]
    expand(law, push, mass, t, s, c, work.series)
    power = 1.0
    for k in range(1, TERMS):
        power *= h
        for j in range(5):
            c[k, j] *= power
    for j in range(5):
        new[j], error[j] = 0.0, c[TERMS - 1, j]
        for k in range(TERMS - 1, -1, -1):
            new[j] += c[k, j]
    error[1] = error[2] = 0.0
    for theta in (MIDDLE, 1.0):
        x = v = z = v_t = z_t = 0.0
        for k in range(TERMS - 1, -1, -1):
            if k > 0:
                v_t, z_t = v_t * theta + k * c[k, 1], z_t * theta + k * c[k, 2]
            x, v, z = x * theta + c[k, 0], v * theta + c[k, 1], z * theta + c[k, 2]
        held, rate = respond(law, s, v, z)
        off = h * (applied(push, t + theta * h, x)[0] - held) / mass - v_t
        error[1], error[2] = max(error[1], abs(off) / SAFE), max(error[2], abs(h * rate - z_t) / SAFE)


@function
def expand(law, push, mass, t, s, c, series):
    """Coefficients of x, v, z and both works in powers of time, from those of the forces."""
    square, bell, slip, rate, pull, held = series
    peak, lever = law.f_s - law.f_c, 1.0
    angle = push.omega * t + push.phase
    swing, other = push.amplitude * sin(angle), push.amplitude * cos(angle)
    for k in range(TERMS - 1):
        down = whole = own = 0.0
        for j in range(k + 1):
            whole += c[j, 1] * c[k - j, 1]
            own += c[j, 1] * c[k - j, 2]
        square[k], bell[k] = whole / law.v_s**2, 0.0
        if peak > 0.0:
            for j in range(1, k + 1):
                down -= j * square[j] * bell[k - j]
            bell[k] = exp(-square[0]) if k == 0 else down / k
        for j in range(1, k + 1):
            own -= peak * bell[j] * slip[k - j]
        slip[k] = own / (law.f_c + peak * bell[0])
        rate[k] = c[k, 1] - law.sigma0 * s * slip[k]
        held[k] = law.sigma0 * c[k, 2] + law.sigma1 * rate[k] + law.f_v * c[k, 1]
        if k == 0:
            pull[0] = applied(push, t, c[0, 0])[0]
        else:
            pull[k] = swing * lever - push.stiffness * c[k, 0]
            if k == 1:
                pull[1] += push.slope + push.stiffness * push.speed
        swing, other, lever = other, -swing, lever * push.omega / (k + 1)
        into = taken = 0.0
        for j in range(k + 1):
            into += pull[j] * c[k - j, 1]
            taken += held[j] * c[k - j, 1]
        c[k + 1, 0], c[k + 1, 1] = c[k, 1] / (k + 1), (pull[k] - held[k]) / (mass * (k + 1))
        c[k + 1, 2] = rate[k] / (k + 1)
        c[k + 1, 3], c[k + 1, 4] = into / (k + 1), taken / (k + 1)
