"""One step of a Taylor series on bristles that slip at any deflection: explicit, of order 16."""

from math import cos, exp, sin

from friction.kernel.law import applied, respond
from tline.compiled.unit import function

TERMS = 17  # of a series, with the first
ROWS = 6
SQUARE, BELL, SLIP, RATE, PULL, HELD = range(ROWS)  # (v/v_s)², its bell, v·z/g, ż, F_a, F_f
MIDDLE, SAFE = 0.5, 4.0  # where within a step the law is asked again; how much less than its defect a step is off
NEAR, FAR, STEEP, LOOKS = 2.0, 6.0, 0.7, 16  # times v_s: above NEAR a series does not see the bell, above FAR there is
# none, at STEEP it counts most; instants at which a step is looked at for it


@function
def taylor(law, push, mass, t, s, h, work):
    """One step from y into `new` of `work`, and its polynomials into `dense` (TERMS, 5).

    The last row of u holds the error: of v and z their defect in the middle, at the end, and where the bell
    e^(−(v/v_s)²) counts most, which is invisible in the first terms where v is far above v_s; of the others the last
    term.
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
    x = v = z = w_a = w_f = 0.0
    for k in range(TERMS - 1, -1, -1):
        x, v, z, w_a, w_f = x + c[k, 0], v + c[k, 1], z + c[k, 2], w_a + c[k, 3], w_f + c[k, 4]
    new[0], new[1], new[2], new[3], new[4] = x, v, z, w_a, w_f
    for j in range(5):
        error[j] = 0.0 if j in (1, 2) else c[TERMS - 1, j]
    for theta in (MIDDLE, 1.0, into_bell(law, c)):
        if theta > 0.0:
            off, slip = missed(law, push, mass, t, s, h, c, theta)
            error[1], error[2] = max(error[1], off / SAFE), max(error[2], slip / SAFE)


@function
def missed(law, push, mass, t, s, h, c, theta):
    """Defect of the polynomials of v and z at an instant within a step."""
    x = v = z = v_t = z_t = 0.0
    for k in range(TERMS - 1, -1, -1):
        if k > 0:
            v_t, z_t = v_t * theta + k * c[k, 1], z_t * theta + k * c[k, 2]
        x, v, z = x * theta + c[k, 0], v * theta + c[k, 1], z * theta + c[k, 2]
    held, rate = respond(law, s, v, z)
    return abs(h * (applied(push, t + theta * h, x)[0] - held) / mass - v_t), abs(h * rate - z_t)


@function
def into_bell(law, c):
    """Where a step that begins far above v_s comes down to it, or is slowest; 0 if it stays away."""
    least = abs(c[0, 1])
    if law.f_s == law.f_c or least <= NEAR * law.v_s:
        return 0.0
    for k in range(1, TERMS):
        least -= abs(c[k, 1])
    if least > FAR * law.v_s:
        return 0.0
    slowest, found, low = abs(c[0, 1]), 0.0, 0.0
    for n in range(1, LOOKS + 1):
        speed = speed_at(c, n / LOOKS)
        if speed < slowest:
            slowest, found = speed, n / LOOKS
        if speed <= STEEP * law.v_s:
            high = n / LOOKS
            for _ in range(LOOKS):
                middle = 0.5 * (low + high)
                if speed_at(c, middle) > STEEP * law.v_s:
                    low = middle
                else:
                    high = middle
            return high
        low = n / LOOKS
    return found


@function
def speed_at(c, theta):
    """|v| within a step."""
    v = 0.0
    for k in range(TERMS - 1, -1, -1):
        v = v * theta + c[k, 1]
    return abs(v)


@function
def expand(law, push, mass, t, s, c, series):
    """Coefficients of x, v, z and both works in powers of time, from those of the forces.

    The sums of one term run in one loop, side by side; products with the term itself come after it.
    """
    square, bell, slip, rate, pull, held = series
    peak, lever, per_v_s, per_mass = law.f_s - law.f_c, 1.0, 1.0 / law.v_s**2, 1.0 / mass
    angle = push.omega * t + push.phase
    swing, other = push.amplitude * sin(angle), push.amplitude * cos(angle)
    for k in range(TERMS - 1):
        down = whole = own = into = taken = 0.0
        for j in range(k):
            v = c[k - j, 1]
            whole += c[j, 1] * v
            own += v * c[j, 2]
            into += pull[j] * v
            taken += held[j] * v
        whole, own = whole + c[k, 1] * c[0, 1], own + c[0, 1] * c[k, 2]
        square[k], bell[k] = whole * per_v_s, 0.0
        if peak > 0.0:
            for j in range(1, k):
                down -= j * square[j] * bell[k - j]
                own -= peak * bell[j] * slip[k - j]
            bell[k] = exp(-square[0]) if k == 0 else (down - k * square[k] * bell[0]) / k
            if k > 0:
                own -= peak * bell[k] * slip[0]
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
        per = 1.0 / (k + 1)
        c[k + 1, 0], c[k + 1, 1], c[k + 1, 2] = c[k, 1] * per, (pull[k] - held[k]) * per_mass * per, rate[k] * per
        c[k + 1, 3], c[k + 1, 4] = (into + pull[k] * c[0, 1]) * per, (taken + held[k] * c[0, 1]) * per
