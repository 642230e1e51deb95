"""Reference motions of bristle laws: Taylor series of order 26, on the equations written out here.

Shares no code with the package. Steps end where |v|, or the slip of elasto-plastic bristles, changes its branch.
"""

from math import copysign, cos, exp, inf, isfinite, pi, sin

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from friction import Model, Testbench

N = 26  # order
X, V, Z, FA, FF, WA, WF, Q, E, G, P, SHARE, ANGLE, SINE, COSINE = range(15)  # rows of a series
COLUMNS = ("x", "v", "z", "F_a", "F_f", "W_a", "W_f")
SMALL = 1e-17  # last terms over the largest early one
FAR = 6.5  # multiples of v_s beyond which nothing is left of the Stribeck peak
MOST_STEPS = 4_000_000


@njit
def product(a, b, k):
    total = 0.0
    for j in range(k + 1):
        total += a[j] * b[k - j]
    return total


@njit
def quotient(a, b, own, k):
    """Term k of own = a/b."""
    total = a
    for j in range(k):
        total -= own[j] * b[k - j]
    return total / b[0]


@njit
def expand(c, p, y, t, s, branch):
    """Series about t into c. p: F_c, F_s, v_s, σ0, σ1, σ2, z_ba, mass, the force's offset, slope and start, amplitude,
    angular frequency, phase, stiffness, speed. Branch 0: no slip, 1: slip in part, 2: LuGre's.
    """
    v, z, side = c[V], c[Z], copysign(1.0, y[2])
    c[X, 0], v[0], z[0], c[WA, 0], c[WF, 0] = y
    factor = p[11]
    for k in range(N):
        c[Q, k] = product(v, v, k) / p[2] ** 2
        if k == 0:
            c[E, 0] = exp(-c[Q, 0]) if branch < 3 else 0.0
        else:
            total = 0.0
            for j in range(1, k + 1):
                total -= j * c[Q, j] * c[E, k - j]
            c[E, k] = total / k
        c[G, k] = (p[0] if k == 0 else 0.0) + (p[1] - p[0]) * c[E, k]
        c[P, k] = quotient(product(v, z, k), c[G], c[P], k)
        if branch % 3 == 1:
            slip_in_part(c, p, side, k)
            slip = product(c[SHARE], c[P], k)
        else:
            slip = 0.5 * (branch % 3) * c[P, k]
        rate = v[k] - p[3] * s * slip
        c[FF, k] = p[3] * z[k] + p[4] * rate + p[5] * v[k]
        turned = p[12] * t + p[13] + 0.5 * pi * k
        c[FA, k] = factor * sin(turned) - p[14] * c[X, k]
        factor *= p[12] / (k + 1)
        if k == 0:
            c[FA, 0] += p[8] + p[9] * (t - p[10]) + p[14] * p[15] * t
        elif k == 1:
            c[FA, 1] += p[9] + p[14] * p[15]
        c[X, k + 1], z[k + 1] = v[k] / (k + 1), rate / (k + 1)
        c[WA, k + 1], c[WF, k + 1] = product(c[FA], v, k) / (k + 1), product(c[FF], v, k) / (k + 1)
        v[k + 1] = (c[FA, k] - c[FF, k]) / p[7] / (k + 1)


@njit
def slip_in_part(c, p, side, k):
    """α = (1 − cos u)/2, u = π·(|z| − z_ba)/(g/σ0 − z_ba), as series."""
    above = pi * (side * c[Z, k] - (p[6] if k == 0 else 0.0))
    if k == 0:
        c[ANGLE, 0] = above / (c[G, 0] / p[3] - p[6])
        c[SINE, 0], c[COSINE, 0] = sin(c[ANGLE, 0]), cos(c[ANGLE, 0])
    else:
        for j in range(k):
            above -= c[ANGLE, j] * c[G, k - j] / p[3]
        c[ANGLE, k] = above / (c[G, 0] / p[3] - p[6])
        up = down = 0.0
        for j in range(1, k + 1):
            up += j * c[ANGLE, j] * c[COSINE, k - j]
            down -= j * c[ANGLE, j] * c[SINE, k - j]
        c[SINE, k], c[COSINE, k] = up / k, down / k
    c[SHARE, k] = (0.5 if k == 0 else 0.0) - 0.5 * c[COSINE, k]


@njit
def value(row, n, h):
    total = 0.0
    for k in range(n - 1, -1, -1):
        total = total * h + row[k]
    return total


@njit
def branch_of(p, s, v, z):
    far = 3 if p[1] > p[0] and abs(v) > FAR * p[2] else 0
    if p[6] < 0.0:
        return far + 2
    limit = (p[0] + (p[1] - p[0]) * exp(-((v / p[2]) ** 2))) / p[3]
    return far + (0 if s * z <= 0.0 or abs(z) <= p[6] else 2 if abs(z) >= limit else 1)


@njit
def trusted(row, h):
    """Largest step up to h at which the last two terms are rounding."""
    for n in (N - 1, N):
        if row[n] != 0.0:
            most = 0.0
            for k in range(5):
                most = max(most, (SMALL * abs(row[k]) / abs(row[n])) ** (1.0 / (n - k)))
            h = min(h, most)
    return h


@njit
def ended(c, p, s, branch, h):
    """Whether the branch of the law does not last until h."""
    v, z = value(c[V], N + 1, h), value(c[Z], N + 1, h)
    return s * v < 0.0 or branch_of(p, s, v, z) != branch


@njit
def acceleration(c, h):
    total = 0.0
    for k in range(N, 0, -1):
        total = total * h + k * c[V, k]
    return total


@njit
def first_end(c, p, s, branch, h):
    """Where in (0, h] the branch ends, just after it; h if it lasts. Each least |v| is looked at."""
    for i in range(1, 17):
        low, high = h * (i - 1) / 16.0, h * i / 16.0
        if s * acceleration(c, low) < 0.0 < s * acceleration(c, high):
            falling, rising = low, high
            for _ in range(60):
                middle = 0.5 * (falling + rising)
                if s * acceleration(c, middle) < 0.0:
                    falling = middle
                else:
                    rising = middle
            if ended(c, p, s, branch, rising):
                high = rising
        if ended(c, p, s, branch, high):
            for _ in range(70):
                middle = 0.5 * (low + high)
                if middle in (low, high):
                    break
                if ended(c, p, s, branch, middle):
                    high = middle
                else:
                    low = middle
            return high
    return h


@njit
def march(p, starts, values, slopes, y, times, found):
    """Columns x, v, z, F_a, F_f, W_a, W_f at the times; whether the steps were enough."""
    c, t, row, i = np.zeros((15, N + 1)), 0.0, 0, 0
    p[8], p[9], p[10] = values[0], slopes[0], starts[0]
    for _ in range(MOST_STEPS):
        if abs(y[1]) < 1e-100:
            y[1] = 0.0
        s = copysign(1.0, y[1])
        branch = branch_of(p, s, y[1], y[2])
        expand(c, p, y, t, s, branch)
        if y[1] == 0.0:  # the sign is that of the first derivative that does not vanish; none depends on it
            s = 1.0
            for k in range(1, 4):
                if c[V, k] != 0.0:
                    s = copysign(1.0, c[V, k])
                    break
            branch = branch_of(p, s, 0.0, y[2])
            expand(c, p, y, t, s, branch)
        end = starts[i + 1] if i + 1 < starts.size else inf
        h = trusted(c[Z], trusted(c[V], end - t))
        most = min(h, 2.0 * (times[-1] - t) + 1e-30)
        h = first_end(c, p, s, branch, most)
        turned = h < most and s * value(c[V], N + 1, h) < 0.0
        while row < times.size and times[row] <= t + h:
            for k in range(7):
                found[row, k] = value(c[k], N if k in (FA, FF) else N + 1, times[row] - t)
            row += 1
        if row == times.size:
            return True
        y = np.array([value(c[k], N + 1, h) for k in (X, V, Z, WA, WF)])
        if turned:
            y[1] = 0.0
        t = t + h
        if h == end - (t - h):
            t, i = end, i + 1
            p[8], p[9], p[10] = values[i], slopes[i], starts[i]
    return False


def reference(model: Model, bench: Testbench, times: ArrayLike) -> NDArray:
    """Columns x, v, z, F_a, F_f, W_a, W_f at the times; NaN if that takes too many steps."""

    def given(name: str, default: float) -> float:
        return float(getattr(model, name, default))

    spring = (bench.spring.stiffness, bench.spring.speed) if bench.spring else (0.0, 0.0)
    p = np.array([
        given("F_c", 1.0), given("F_s", given("F_c", 1.0)), given("v_s", 1.0), given("sigma0", 1.0),
        given("sigma1", 0.0), given("sigma2", 0.0), given("z_ba", -1.0), bench.mass, 0.0, 0.0, 0.0,
        *bench.force.sine, *spring,
    ])  # fmt: skip
    times = np.asarray(times, float)
    found, start = np.full((times.size, 7), np.nan), bench.start
    enough = march(p, *bench.force.pieces(), start, times, found)
    return found if enough and isfinite(found.sum()) else np.full_like(found, np.nan)
