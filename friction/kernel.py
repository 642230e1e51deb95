"""The friction kernels: a mass, a force, a law. They know arrays and numbers and nothing else.

Symbols: x, v place and velocity, z bristle deflection, F_a applied force, F_f friction force, g(v) steady friction of
the Stribeck curve, W_a and W_f their work; s the sign of v that a step keeps.
"""

from math import copysign, cos, exp, expm1, factorial, inf, pi, sin, tanh
from typing import Any, NamedTuple

import numpy as np

from tline.compiled import njit

SIGN, ZONE, BRISTLE, TANH = range(4)  # kinds of law
EULER, RK4, MOREAU, EXPONENTIAL = range(4)  # fixed steps
DONE, BUDGET, BLOWN_UP, STALLED = range(4)  # how a run can end
BREAK_AWAY, STOP, REVERSAL = range(3)  # events
T, X, V, Z, FA, FF, WA, WF, MODE = range(9)  # columns of a record
STUCK, SLIDING, PUSHED = 0, 1, 2  # modes, with the sign of the motion; pushed: within a dead zone, but too hard to hold
N = 20  # terms of a Taylor series
MOST_HALVINGS = 2000  # in the search for a root
FACTORIAL = np.array([float(factorial(k)) for k in range(N + 1)])
OPTIONS: dict[str, Any] = {"error_model": "numpy", "nogil": True, "fastmath": {"contract", "nsz"}}

# Rodas5P, Steinebach, BIT Numerical Mathematics 63 (2023) 27, doi:10.1007/s10543-023-00967-x: order 5, L-stable, and
# no loss of order on z, which follows the stiff balance of bristles
GAMMA, STAGES = 0.21193756319429014, 8
ALPHA = np.array([0.0, 0.6358126895828704, 0.4095798393397535, 0.9769306725060716, 0.4288403609558664, 1.0, 1.0, 1.0])
D = np.array([GAMMA, -0.42387512638858027, -0.3384627126235924, 1.8046452872882734, 2.325825639765069, 0.0, 0.0, 0.0])
A, C = np.zeros((STAGES, STAGES)), np.zeros((STAGES, STAGES))
A[1, :1] = 3.0
A[2, :2] = 2.849394379747939, 0.45842242204463923
A[3, :3] = -6.954028509809101, 2.489845061869568, -10.358996098473584
A[4, :4] = 2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641
A[5:, :5] = -7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256, 0.030198172008377946
A[6:, 5] = A[7, 6] = 1.0
C[1, :1] = -14.155112264123755
C[2, :2] = -17.97296035885952, -2.859693295451294
C[3, :3] = 147.12150275711716, -1.41221402718213, 71.68940251302358
C[4, :4] = 165.43517024871676, -0.4592823456491126, 42.90938336958603, -5.961986721573306
C[5, :5] = 24.854864614690072, -3.0009227002832186, 47.4931110020768, 5.5814197821558125, -0.6610691825249471
C[6, :4] = 30.91273214028599, -3.1208243349937974, 77.79954646070892, 34.28646028294783
C[6, 4:6] = -19.097331116725623, -28.087943162872662
C[7, :4] = 37.80277123390563, -3.2571969029072276, 112.26918849496327, 66.9347231244047
C[7, 4:7] = -40.06618937091002, -54.66780262877968, -9.48861652309627


class Law(NamedTuple):
    """A friction law: F_c, F_s, F_v (σ2), v_s, half width δ of the dead zone; σ0, σ1, z_ba; ε of tanh."""

    kind: int
    f_c: float
    f_s: float
    f_v: float
    v_s: float
    delta: float = 0.0
    sigma0: float = 0.0
    sigma1: float = 0.0
    z_ba: float = -1.0  # negative: bristles slip at any deflection, as LuGre's do
    epsilon: float = 1.0


class Drive(NamedTuple):
    """Applied force: straight pieces (start, value there, slope), a sine, and a spring of which one end moves."""

    start: np.ndarray
    value: np.ndarray
    slope: np.ndarray
    amplitude: float = 0.0
    omega: float = 0.0
    phase: float = 0.0
    stiffness: float = 0.0
    speed: float = 0.0


class Push(NamedTuple):
    """The applied force while one of the pieces lasts; numbers only, since calls with arrays count references."""

    start: float
    end: float
    value: float
    slope: float
    amplitude: float
    omega: float
    phase: float
    stiffness: float
    speed: float


@njit(**OPTIONS)
def push_at(drive, t):
    """The piece of the applied force that begins at t or goes on there."""
    i = max(np.searchsorted(drive.start, t, side="right") - 1, 0)
    end = drive.start[i + 1] if i + 1 < drive.start.size else inf
    return Push(
        drive.start[i], end, drive.value[i], drive.slope[i], drive.amplitude, drive.omega, drive.phase, drive.stiffness,
        drive.speed,
    )  # fmt: skip


@njit(**OPTIONS)
def applied(push, t, x):
    """Applied force and its partial derivative in time."""
    force = push.value + push.slope * (t - push.start) + push.stiffness * (push.speed * t - x)
    rate = push.slope + push.stiffness * push.speed
    if push.amplitude != 0.0:
        angle = push.omega * t + push.phase
        force += push.amplitude * sin(angle)
        rate += push.amplitude * push.omega * cos(angle)
    return force, rate


@njit(**OPTIONS)
def steady(law, v):
    """g(v) and its derivative."""
    peak = (law.f_s - law.f_c) * exp(-((v / law.v_s) ** 2))
    return law.f_c + peak, -2.0 * v / law.v_s**2 * peak


@njit(**OPTIONS)
def slip_share(law, s, z, g):
    """α of the elasto-plastic model, Dupont et al. (2002), with its derivatives in z and in z_ss = g/σ0."""
    if law.z_ba < 0.0:
        return 1.0, 0.0, 0.0
    z_ss, bend = g / law.sigma0, abs(z)
    if s * z <= 0.0 or bend <= law.z_ba:
        return 0.0, 0.0, 0.0
    if bend >= z_ss:
        return 1.0, 0.0, 0.0
    width = z_ss - law.z_ba
    angle = pi * (bend - 0.5 * (z_ss + law.z_ba)) / width
    steep = 0.5 * cos(angle) * pi / width
    return 0.5 + 0.5 * sin(angle), copysign(steep, z), -steep * (bend - law.z_ba) / width


@njit(**OPTIONS)
def respond(law, s, v, z):
    """F_f and ż of a smooth law, with |v| read as s·v."""
    g = law.f_c + (law.f_s - law.f_c) * exp(-((v / law.v_s) ** 2))
    if law.kind == TANH:
        return g * tanh(v / law.epsilon) + law.f_v * v, 0.0
    rate = v - slip_share(law, s, z, g)[0] * law.sigma0 * s * v * z / g
    return law.sigma0 * z + law.sigma1 * rate + law.f_v * v, rate


@njit(**OPTIONS)
def jacobian(law, s, v, z):
    """Derivatives of F_f in v and z, and of ż in v and z."""
    g, slope = steady(law, v)
    if law.kind == TANH:
        bend = tanh(v / law.epsilon)
        return slope * bend + g * (1.0 - bend**2) / law.epsilon + law.f_v, 0.0, 0.0, 0.0
    share, share_z, share_ss = slip_share(law, s, z, g)
    full = law.sigma0 * s * v * z / g
    rate_v = 1.0 - share * (law.sigma0 * s * z - full * slope) / g - share_ss * slope / law.sigma0 * full
    rate_z = -share * law.sigma0 * s * v / g - share_z * full
    return law.sigma1 * rate_v + law.f_v, law.sigma0 + law.sigma1 * rate_z, rate_v, rate_z


@njit(**OPTIONS)
def friction(law, v, z, f_a):
    """F_f and ż of any law, as a solver that knows nothing of events meets it."""
    if law.kind >= BRISTLE:
        return respond(law, 1.0 if v >= 0.0 else -1.0, v, z)
    if law.kind == ZONE and abs(v) <= law.delta:
        return min(max(f_a, -law.f_s), law.f_s), 0.0
    return (0.0 if v == 0.0 else copysign(steady(law, v)[0], v)) + law.f_v * v, 0.0


@njit(**OPTIONS)
def slopes(law, push, mass, t, y, out):
    """Time derivatives of x, v, z, W_a, W_f."""
    f_a = applied(push, t, y[0])[0]
    f_f, rate = friction(law, y[1], y[2], f_a)
    out[0], out[1], out[2] = y[1], (f_a - f_f) / mass, rate
    out[3], out[4] = f_a * y[1], f_f * y[1]


@njit(**OPTIONS)
def note(record, row, law, push, t, y):
    """Keep a state, with the forces of the law."""
    f_a = applied(push, t, y[0])[0]
    record[row, T], record[row, X], record[row, V], record[row, Z] = t, y[0], y[1], y[2]
    record[row, FA], record[row, FF] = f_a, friction(law, y[1], y[2], f_a)[0]
    record[row, WA], record[row, WF] = y[3], y[4]


@njit(**OPTIONS)
def march(law, drive, mass, y, h, steps, method, every, record):
    """Fixed steps; keeps the last state and every so-manieth. Returns the status and the steps made."""
    k1, k2, k3, k4, mid = np.empty(5), np.empty(5), np.empty(5), np.empty(5), np.empty(5)
    push = push_at(drive, 0.0)
    note(record, 0, law, push, 0.0, y)
    for n in range(steps):
        t, force = n * h, 0.0
        if t >= push.end:
            push = push_at(drive, t)
        if method == EULER:
            slopes(law, push, mass, t, y, k1)
            for j in range(5):
                y[j] += h * k1[j]
        elif method == RK4:
            slopes(law, push, mass, t, y, k1)
            for j in range(5):
                mid[j] = y[j] + 0.5 * h * k1[j]
            slopes(law, push, mass, t + 0.5 * h, mid, k2)
            for j in range(5):
                mid[j] = y[j] + 0.5 * h * k2[j]
            slopes(law, push, mass, t + 0.5 * h, mid, k3)
            for j in range(5):
                mid[j] = y[j] + h * k3[j]
            slopes(law, push, mass, t + h, mid, k4)
            for j in range(5):
                y[j] += h / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j])
        else:
            force = robust(law, push, mass, t, y, h, method)
        if not np.isfinite(y[1]) or abs(y[1]) > 1e100:
            return BLOWN_UP, n + 1
        if (n + 1) % every == 0 or n + 1 == steps:
            row = (n + every) // every
            note(record, row, law, push, (n + 1) * h, y)
            if method >= MOREAU:
                record[row, FF] = force
    return DONE, steps


@njit(**OPTIONS)
def robust(law, push, mass, t, y, h, method):
    """One step of Moreau and Jean, or of the exponential method; returns the friction force.

    Moreau and Jean: one contact in closed form; it holds what it can, and slides with what is left.
    Exponential: the bristle is exact for constant v, then the velocity follows with the new deflection.
    """
    x, v, z = y[0], y[1], y[2]
    middle = t + 0.5 * h
    f_a = applied(push, middle, x + 0.5 * h * v)[0]
    g = steady(law, v)[0]
    impulse = mass * v + h * f_a
    if method == MOREAU:
        hold = law.f_s if v == 0.0 else g
        new = 0.0 if abs(impulse) <= h * hold else (impulse - copysign(h * hold, impulse)) / (mass + h * law.f_v)
        force = (impulse - mass * new) / h
    else:
        share = slip_share(law, 1.0 if v >= 0.0 else -1.0, z, g)[0]
        decay = -share * law.sigma0 * abs(v) / g * h
        y[2] = z * exp(decay) + v * h * (expm1(decay) / decay if decay != 0.0 else 1.0)
        bristle = law.sigma0 * y[2] + law.sigma1 * (y[2] - z) / h
        new = (impulse - h * bristle) / (mass + h * law.f_v)
        force = bristle + law.f_v * new
    mean = 0.5 * (v + new)
    y[0], y[1] = x + h * mean, new
    y[3] += h * f_a * mean
    y[4] += h * force * mean
    return force


@njit(**OPTIONS)
def rodas(law, push, mass, t, y, s, h, u, new):
    """One step of Rodas5P into `new`; u (8, 5) holds the stages, of which the last is the error estimate.

    The matrix 1/(hγ) − J has a simple shape: x follows v, the works follow all, so that only v needs a division.
    """
    x, v, z = y[0], y[1], y[2]
    k, per_h, per_mass, place = push.stiffness, 1.0 / h, 1.0 / mass, h * GAMMA
    f_a, f_t = applied(push, t, x)
    f_v, f_z, z_v, z_z = jacobian(law, s, v, z)
    f = respond(law, s, v, z)[0]
    bristle = 1.0 / (1.0 / place - z_z)
    velocity = 1.0 / (1.0 / place + (f_v + k * place + f_z * z_v * bristle) * per_mass)
    for a in range(STAGES):
        x, v, z = y[0], y[1], y[2]
        r0 = r1 = r2 = r3 = r4 = 0.0
        for b in range(a):
            x += A[a, b] * u[b, 0]
            v += A[a, b] * u[b, 1]
            z += A[a, b] * u[b, 2]
            c = C[a, b] * per_h
            r0 += c * u[b, 0]
            r1 += c * u[b, 1]
            r2 += c * u[b, 2]
            r3 += c * u[b, 3]
            r4 += c * u[b, 4]
        force = applied(push, t + ALPHA[a] * h, x)[0]
        held, rate = respond(law, s, v, z)
        r0 += v
        r1 += (force - held + D[a] * h * f_t) * per_mass
        r2 += rate
        r3 += force * v + D[a] * h * f_t * y[1]
        r4 += held * v
        v = (r1 - (k * place * r0 + f_z * bristle * r2) * per_mass) * velocity
        x, z = (r0 + v) * place, (r2 + z_v * v) * bristle
        u[a, 0], u[a, 1], u[a, 2] = x, v, z
        u[a, 3] = (r3 + f_a * v - k * y[1] * x) * place
        u[a, 4] = (r4 + (f + f_v * y[1]) * v + f_z * y[1] * z) * place
    for j in range(5):
        new[j] = y[j] + u[STAGES - 1, j]
        for b in range(STAGES - 1):
            new[j] += A[STAGES - 1, b] * u[b, j]


@njit(**OPTIONS)
def rosenbrock(law, drive, mass, y, times, tol, budget, record):
    """Rodas5P with its own steps, landing on all times and, for bristles, on every reversal, where |v| has a kink.

    What a step may miss of a reversal is ∫|v|dt on the wrong side of zero. Returns the status, steps made and refused.
    """
    u, new = np.empty((STAGES, 5)), np.empty(5)
    kinks = law.kind == BRISTLE
    v_size = law.epsilon if not kinks else law.v_s if law.f_s > law.f_c else law.f_c / (mass * law.sigma0) ** 0.5
    z_size = max(law.f_s / law.sigma0, v_size * (mass / law.sigma0) ** 0.5) if kinks else 1.0
    wrong = 0.1 * tol * z_size
    t, h, refused, made, push = 0.0, 1e-4 * times[-1], 0, 0, push_at(drive, 0.0)
    for row in range(times.size):
        while t < times[row]:
            if t >= push.end:
                push = push_at(drive, t)
            end = min(times[row], push.end)
            last = h >= 0.999 * (end - t)
            step = end - t if last else min(h, 0.5 * (end - t))
            s = direction(law, push, mass, t, y, wrong)
            low, high, v_low, v_high, tries = 0.0, step, y[1], 0.0, 0
            while True:
                if made + refused + tries >= budget:
                    return BUDGET, made, refused
                rodas(law, push, mass, t, y, s, step, u, new)
                error = max(abs(u[STAGES - 1, 1]) / (v_size + abs(new[1])), abs(u[STAGES - 1, 2]) / z_size)
                work = max(abs(u[STAGES - 1, 3]), abs(u[STAGES - 1, 4]))
                error = max(error, work / (mass * v_size**2 + abs(new[3]) + abs(new[4]))) / tol
                missed = new[1] ** 2 * step / (abs(y[1]) + abs(new[1]) + 1e-300)
                if (
                    not (kinks and error <= 1.0 and missed > wrong and (v_high != 0.0 or s * new[1] < 0.0))
                    or tries == 9
                ):
                    break
                last, tries = False, tries + 1
                if s * y[1] <= 0.0:
                    s = -s
                    continue
                if s * new[1] > 0.0:
                    low, v_low = step, new[1]
                else:
                    high, v_high = step, new[1]
                guess = low + (high - low) * v_low / (v_low - v_high)
                step = min(max(guess, low + 0.02 * (high - low)), high - 0.02 * (high - low))
            refused += tries
            if error <= 1.0:
                t = end if last else t + step
                y[:] = new
                made += 1
            elif step < 1e-14 * times[-1]:
                return STALLED, made, refused
            else:
                refused += 1
            if not error <= 1.0 or not (last or tries > 0):
                h = step * min(6.0, max(0.1, 0.9 * (error + 1e-12) ** -0.2)) if np.isfinite(error) else 0.1 * step
        note(record, row, law, push, t, y)
    return DONE, made, refused


@njit(**OPTIONS)
def direction(law, push, mass, t, y, wrong):
    """Sign of the motion that begins at t: of the force, where the velocity is about to change its sign."""
    f_a, f_t = applied(push, t, y[0])
    rise = (f_a - friction(law, y[1], y[2], f_a)[0]) / mass
    if y[1] ** 2 > wrong * abs(rise):
        return copysign(1.0, y[1])
    return copysign(1.0, rise if rise != 0.0 else f_t)


@njit(**OPTIONS)
def sweep(laws, drive, masses, v0, factors, t_end, tol, budget, out):
    """Many runs of the Rosenbrock method: laws (n, 10) in the order of Law. Keeps x, v, z, F_f at the end, and the
    status.
    """
    times, y, record = np.array([t_end]), np.empty(5), np.empty((1, 9))
    for n in range(masses.size):
        c = laws[n]
        law = Law(int(c[0]), c[1], c[2], c[3], c[4], c[5], c[6], c[7], c[8], c[9])
        a = factors[n]
        scaled = Drive(
            drive.start, a * drive.value, a * drive.slope, a * drive.amplitude, drive.omega, drive.phase,
            drive.stiffness, drive.speed,
        )  # fmt: skip
        y[:] = 0.0
        y[1] = v0[n]
        status = rosenbrock(law, scaled, masses[n], y, times, tol, budget, record)[0]
        out[n, 0], out[n, 1], out[n, 2], out[n, 3], out[n, 4] = y[0], y[1], y[2], record[0, FF], status


@njit(**OPTIONS)
def value(p, t):
    """A polynomial."""
    total = 0.0
    for k in range(p.size - 1, -1, -1):
        total = total * t + p[k]
    return total


@njit(**OPTIONS)
def shifted(p, t, q):
    """The polynomial about t into q."""
    for k in range(p.size):
        q[k] = p[k]
    if t != 0.0:
        for k in range(p.size - 1):
            for j in range(p.size - 2, k - 1, -1):
                q[j] += t * q[j + 1]


@njit(**OPTIONS)
def first_root(p, h, q):
    """The first t in (0, h] where a polynomial that is positive after 0 vanishes; inf if there is none.

    Intervals are halved until a bound shows that the polynomial keeps its sign there, or rises or falls throughout.
    Zeros at 0 itself are divided out.
    """
    zeros = 0
    while zeros < p.size and p[zeros] == 0.0:
        zeros += 1
    if zeros == p.size:
        return inf
    p = p[zeros:]
    if p[0] < 0.0:
        return 0.0
    low, width = 0.0, h
    for _ in range(MOST_HALVINGS):
        if low >= h:
            break
        width = min(width, h - low)
        r = 0.5 * width
        shifted(p, low + r, q)
        rest, rise, power = 0.0, 0.0, 1.0
        for k in range(1, p.size):
            rise += (k if k > 1 else 0.0) * abs(q[k]) * power
            power *= r
            rest += abs(q[k]) * power
        if q[0] > rest:
            low, width = low + width, 2.0 * width
        elif abs(q[1]) > rise or width < 1e-12 * h:
            if value(p, low + width) <= 0.0:
                return low + r + falling_root(q[: p.size], r)
            low, width = low + width, 2.0 * width
        else:
            width = r
    return inf


@njit(**OPTIONS)
def falling_root(q, r):
    """The root in [-r, r] of a polynomial positive at one end and negative at the other: Newton's method, guarded."""
    low, high, t = -r, r, 0.0
    for _ in range(100):
        f, slope = 0.0, 0.0
        for k in range(q.size - 1, -1, -1):
            slope = slope * t + f
            f = f * t + q[k]
        if f > 0.0:
            low = t
        else:
            high = t
        new = t - f / slope if slope < 0.0 else 0.5 * (low + high)
        if not low <= new <= high:
            new = 0.5 * (low + high)
        if new == t or high - low <= 1e-17 * r:
            return new
        t = new
    return t


@njit(**OPTIONS)
def expand(law, push, mass, t, y, mode, c):
    """Taylor coefficients about t into c: rows X, V, F_a, F_f, works of F_a and F_f, (v/v_s)², e^(-(v/v_s)²)."""
    x, v, f_a, f_f, w_a, w_f, square, bell = c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7]
    s = copysign(1.0, mode)
    pushed = abs(mode) == PUSHED
    base, peak, viscous = (law.f_s, 0.0, 0.0) if pushed else (law.f_c, law.f_s - law.f_c, law.f_v)
    force, rate = applied(push, t, 0.0)
    angle = push.omega * t + push.phase
    x[0], v[0], w_a[0], w_f[0] = y[0], y[1], y[3], y[4]
    for k in range(N):
        if push.amplitude != 0.0:
            f_a[k] = push.amplitude * push.omega**k / FACTORIAL[k] * sin(angle + 0.5 * pi * k)
        else:
            f_a[k] = 0.0
        if k == 0:
            f_a[k] = force
        elif k == 1:
            f_a[k] = rate
        f_a[k] -= push.stiffness * x[k]
        if peak > 0.0 and mode != STUCK:
            square[k] = 0.0
            for j in range(k + 1):
                square[k] += v[j] * v[k - j] / law.v_s**2
            bell[k] = exp(-square[0]) if k == 0 else 0.0
            for j in range(1, k + 1):
                bell[k] -= j * square[j] * bell[k - j] / k
        else:
            bell[k] = 0.0
        if mode == STUCK:
            f_f[k], v[k + 1] = f_a[k], 0.0
        else:
            f_f[k] = s * ((base if k == 0 else 0.0) + peak * bell[k]) + viscous * v[k]
            v[k + 1] = (f_a[k] - f_f[k]) / (mass * (k + 1))
        x[k + 1] = v[k] / (k + 1)
    for k in range(N):
        w_a[k + 1] = w_f[k + 1] = 0.0
        for j in range(k + 1):
            w_a[k + 1] += f_a[j] * v[k - j] / (k + 1)
            w_f[k + 1] += f_f[j] * v[k - j] / (k + 1)


@njit(**OPTIONS)
def trusted_step(law, mode, c, h, p, q):
    """The largest step up to h at which the last terms are below rounding.

    Far out on the bell e^(-(v/v_s)²) the last terms say nothing, being small although the bell is yet to come: a step
    ends where it begins to count, at 6 v_s.
    """
    for row, n in ((c[1], N), (c[2], N - 1)):
        size = 2e-17 * (abs(row[0]) + abs(row[1]) * h + abs(row[2]) * h**2)
        while abs(row[n]) * h**n + abs(row[n - 1]) * h ** (n - 1) > size:
            h *= 0.8
            size = 2e-17 * (abs(row[0]) + abs(row[1]) * h + abs(row[2]) * h**2)
    if abs(mode) == SLIDING and law.f_s > law.f_c and abs(c[1, 0]) > 6.001 * law.v_s:
        p[:] = copysign(1.0, mode) * c[1]
        p[0] -= 6.0 * law.v_s
        h = min(h, first_root(p, h, q))
    return h


@njit(**OPTIONS)
def event_within(law, mode, c, h, p, q):
    """Time of the first event within a step, inf if none, and which border is met: 0 or 1."""
    best, which = inf, 0
    s = copysign(1.0, mode)
    for border in range(1 if abs(mode) == SLIDING else 2):
        n = N
        for k in range(N):
            if mode == STUCK:
                p[k] = c[2, k] * (2 * border - 1)
            elif border == 1:
                p[k] = s * c[2, k]
            else:
                p[k] = (s if abs(mode) == SLIDING else -s) * c[1, k]
        if mode == STUCK:
            p[0] += law.f_s
        elif border == 1:
            p[0] -= law.f_s
        else:
            p[0] += -law.delta if abs(mode) == SLIDING else law.delta
        while n > 1 and p[n - 1] == 0.0:
            n -= 1
        root = first_root(p[:n], h, q)
        if root < best:
            best, which = root, border
    return best, which


@njit(**OPTIONS)
def automaton(law, drive, mass, y, times, budget, record, events):
    """The static laws as a hybrid automaton, stuck or sliding, by Taylor series with events as roots of the
    polynomials.

    Keeps an event as (kind, t, x). Returns the status, steps made, and events met (of which those that fit are kept).
    """
    c, p, q = np.zeros((8, N + 1)), np.empty(N + 1), np.empty(N + 1)
    t, push, row, met, steps, mode, fresh = 0.0, push_at(drive, 0.0), 0, 0, 0, STUCK, True
    f_a = applied(push, t, y[0])[0]
    if abs(y[1]) > law.delta:
        mode = int(copysign(SLIDING, y[1]))
    elif abs(f_a) > law.f_s:
        mode = int(copysign(PUSHED if law.delta > 0.0 else SLIDING, f_a))
    while True:
        expand(law, push, mass, t, y, mode, c)
        if fresh and abs(mode) == SLIDING and abs(c[1, 1]) < 1e-12 * law.f_s / mass:
            c[1, 1] = 0.0  # breaks away with F_a = F_s
        if not np.isfinite(c[:4].sum()):
            return BLOWN_UP, steps, met
        end = min(times[-1], push.end)
        h = trusted_step(law, mode, c, end - t, p, q)
        last = h == end - t
        root, border = event_within(law, mode, c, h, p, q)
        h = min(h, root)
        stop = end if last and root > h else t + h
        while row < times.size and times[row] <= stop:
            for column, k in ((X, 0), (V, 1), (FA, 2), (FF, 3), (WA, 4), (WF, 5)):
                record[row, column] = value(c[k, : (N if k in (2, 3) else N + 1)], times[row] - t)
            record[row, T], record[row, Z], record[row, MODE] = times[row], 0.0, mode
            row += 1
        for k, j in ((0, 0), (1, 1), (4, 3), (5, 4)):
            y[j] = value(c[k], h)
        t, steps, fresh = stop, steps + 1, False
        if row == times.size:
            return DONE, steps, met
        if steps >= budget:
            return BUDGET, steps, met
        if t >= push.end:
            push = push_at(drive, t)
        f_a = applied(push, t, y[0])[0]
        kind, before = -1, mode
        if root == h:
            if abs(mode) != STUCK and border == 0:
                y[1] = copysign(law.delta, mode)
            if mode == STUCK:
                kind, mode = BREAK_AWAY, begin(law, y, 2 * (0 if border else 1) - 1)
            elif abs(mode) == PUSHED and border == 0:
                mode = int(copysign(SLIDING, mode))
            elif abs(f_a) <= law.f_s or abs(mode) == PUSHED:
                kind, mode = STOP, STUCK
            else:
                kind, mode = REVERSAL, begin(law, y, f_a)
        elif mode == STUCK and abs(f_a) > law.f_s:
            kind, mode = BREAK_AWAY, begin(law, y, f_a)
        elif abs(mode) == PUSHED and mode * f_a <= 2.0 * law.f_s:
            kind, mode = STOP, STUCK
        fresh = mode != before
        if kind >= 0:
            if met < events.shape[0]:
                events[met, 0], events[met, 1], events[met, 2] = kind, t, y[0]
            met += 1


@njit(**OPTIONS)
def begin(law, y, way):
    """Mode of a motion that begins that way: sliding, or first through the rest of the dead zone."""
    if law.delta == 0.0 or y[1] == copysign(law.delta, way):
        return int(copysign(SLIDING, way))
    return int(copysign(PUSHED, way))
