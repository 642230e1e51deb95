"""The smooth laws by Rodas5P: steps that depend neither on samples nor on the end, and the instants of events.

A contact slides from the instant at which its friction, without the viscous part, comes within 1 % of its steady value
in the direction of the motion, which is its break-away, until the velocity vanishes, which is its stop.
"""

from math import copysign, isfinite

from friction.kernel.law import (
    BRISTLE,
    BUDGET,
    DONE,
    FA,
    FF,
    MODE,
    STALLED,
    TANH,
    WA,
    WF,
    T,
    V,
    X,
    Z,
    applied,
    friction,
    gap,
    piece,
    put,
)
from friction.kernel.rodas import STAGES, continue_into, inside, rodas
from friction.kernel.structures import EVENTS, REFUSED, RUN, STEPS
from tline.unit import function

MOST_TRIES = 9  # to land on a reversal
EARLY = 1e-3  # first step, of the time scale of the contact


@function
def scales(law, mass):
    """Velocity and deflection that errors are weighed with, and the time scale of the contact."""
    if law.kind == TANH:
        return law.epsilon, 1.0, mass * law.epsilon / law.f_c
    v = law.v_s if law.f_s > law.f_c else law.f_c / (mass * law.sigma0) ** 0.5
    period = (mass / law.sigma0) ** 0.5
    return v, max(law.f_s / law.sigma0, v * period), period


@function
def rosenbrock(law, bench, tol, budget, compared, which):
    """One run with its own steps, which land on reversals, where |v| has a kink.

    Keeps samples, the largest magnitude of each column, and in that of time the largest error of a step. Returns the
    status, steps made and refused, and how many events there are.
    """
    drive, mass, t_end, times = bench.drive, bench.mass, bench.t_end, bench.times
    y, new, peaks, counts = compared.y, compared.new, compared.peaks, compared.counts
    counts[STEPS], counts[REFUSED], counts[EVENTS], counts[RUN] = 0, 0, 0, which
    v_size, z_size, period = scales(law, mass)
    t, h, number, row, mode = 0.0, EARLY * period, 0, 0, 0
    y[0], y[1], y[2], y[3], y[4], push = 0.0, bench.v0, 0.0, 0.0, 0.0, piece(drive, 0)
    for column in range(peaks.size):
        peaks[column] = 0.0
    if gap(law, y[1], y[2]) >= 0.0:
        mode = int(copysign(1.0, bench.v0))
    margin, pull = held_back(law, mode, y[1], y[2]), forces(law, push, t, y)
    while t <= t_end:
        if counts[STEPS] + counts[REFUSED] >= budget:
            return BUDGET
        largest(peaks, y, pull)
        last = h >= 0.999 * (push.end - t)
        step = push.end - t if last else min(h, 0.5 * (push.end - t))
        step, error, tries, after = attempt(law, push, mass, t, pull, step, (tol, v_size, z_size), compared)
        counts[REFUSED] += tries
        last = last and tries == 0
        if not error <= 1.0 or not (last or tries > 0):
            h = step * min(6.0, max(0.1, 0.9 * (error + 1e-12) ** -0.2)) if isfinite(error) else 0.1 * step
        if not error <= 1.0:
            if t + step == t:
                return STALLED
            counts[REFUSED] += 1
            continue
        counts[STEPS] += 1
        peaks[T] = max(peaks[T], error * tol)
        before, margin = margin, held_back(law, mode, new[1], new[2])
        if not margin > abs(margin - before) or (row < times.size and times[row] <= t + step):
            continue_into(y, new, compared.u, compared.dense)
            row, mode = watch(law, bench, push, t, step, mode, row, compared)
            margin = held_back(law, mode, new[1], new[2])
        t = push.end if last else t + step
        for j in range(5):
            y[j] = new[j]
        pull = after
        if last:
            number += 1
            push = piece(drive, number)
            pull = forces(law, push, t, y)
    return DONE


@function
def forces(law, push, t, y):
    """Applied force, its partial derivative in time, and friction."""
    f_a, f_t = applied(push, t, y[0])
    return f_a, f_t, friction(law, y[1], y[2], f_a)[0]


@function
def largest(peaks, y, pull):
    """Note the largest magnitudes so far."""
    for column, size in ((X, y[0]), (V, y[1]), (Z, y[2]), (FA, pull[0]), (FF, pull[2]), (WA, y[3]), (WF, y[4])):
        peaks[column] = max(peaks[column], abs(size))


@function
def attempt(law, push, mass, t, pull, step, sizes, compared):
    """A step of at most that length into `new`; the step, its error over the tolerance, tries before it, and the forces
    at its end.

    With |v| read as s·v, what a step misses of a reversal is ∫|v|dt on the wrong side of zero; where that counts, it
    ends at the reversal instead.
    """
    y, new, u, dense = compared.y, compared.new, compared.u, compared.dense
    tol, v_size, z_size = sizes
    wrong = 0.1 * tol * z_size
    rise = (pull[0] - pull[2]) / mass
    s = copysign(1.0, y[1])
    if y[1] ** 2 <= wrong * abs(rise):  # about to change its sign
        s = copysign(1.0, rise if rise != 0.0 else pull[1])
    tries = 0
    while True:
        rodas(law, push, mass, t, s, step, compared)
        error = max(abs(u[STAGES - 1, 1]) / (v_size + abs(new[1])), abs(u[STAGES - 1, 2]) / z_size)
        work = max(abs(u[STAGES - 1, 3]), abs(u[STAGES - 1, 4]))
        error = max(error, work / (mass * v_size**2 + abs(new[3]) + abs(new[4]))) / tol
        if not error <= 1.0:
            return step, error, tries, pull
        after = forces(law, push, t + step, new)
        if law.kind != BRISTLE or tries == MOST_TRIES:
            return step, error, tries, after
        back = s * new[1] < 0.0
        dips = not back and s * rise < 0.0 and s * (after[0] - after[2]) > 0.0
        if not back and not dips:
            return step, error, tries, after
        continue_into(y, new, u, dense)
        theta = 1.0 if back else lowest(dense, s)
        v = s * inside(dense, 1, theta)
        missed = -v * step * (v / (v - abs(y[1]) - 1e-300) if back else 1.0)
        if missed <= wrong:
            return step, error, tries, after
        begins = lowest(dense, -s) if s * y[1] <= 0.0 else 0.0
        if s * inside(dense, 1, begins) > 0.0:
            step *= crossing(law, dense, int(s), begins, theta)
        else:
            s = -s
        tries += 1


@function
def lowest(dense, s):
    """Where within a step s·v, which falls at first, is least."""
    low, high = 0.0, 1.0
    for _ in range(30):
        middle = 0.5 * (low + high)
        rate = dense[3, 1] + middle * (4.0 / 3.0) * dense[4, 1]
        if s * (dense[1, 1] + middle * (2.0 * dense[2, 1] + 3.0 * middle * rate)) < 0.0:
            low = middle
        else:
            high = middle
    return high


@function
def held_back(law, mode, v, z):
    """Positive while the mode lasts."""
    return mode * v if mode != 0 else -gap(law, v, z)


@function
def guard(law, dense, mode, theta):
    """The same within a step."""
    return held_back(law, mode, inside(dense, 1, theta), inside(dense, 2, theta))


@function
def crossing(law, dense, mode, low, high):
    """Where within a step the sign of the guard changes: regula falsi that halves when it does not."""
    f_low, f_high = guard(law, dense, mode, low), guard(law, dense, mode, high)
    for n in range(80):
        middle = 0.5 * (low + high)
        if n % 3 and f_low != f_high:
            middle = min(max(low - f_low * (high - low) / (f_high - f_low), low), high)
        f = guard(law, dense, mode, middle)
        if (f > 0.0) == (f_low > 0.0):
            low, f_low = middle, f
        else:
            high, f_high = middle, f
        if high - low <= 1e-15 or f == 0.0:
            break
    return high


@function
def watch(law, bench, push, t, step, mode, row, compared):
    """Samples and events of an accepted step; the next sample, and the mode at its end."""
    dense, times, counts = compared.dense, bench.times, compared.counts
    record, events = compared.records[counts[RUN]], compared.events[counts[RUN]]
    theta = 0.0
    while True:
        root = 2.0
        for k in (0.5, 1.0):
            if k > theta and not guard(law, dense, mode, k) > 0.0:
                root = crossing(law, dense, mode, theta, k)
                break
        until = t + min(root, 1.0) * step
        while row < times.size and times[row] <= until:
            keep(law, push, t, step, mode, dense, times[row], record[row])
            row += 1
        if root > 1.0 or until > bench.t_end:
            return row, mode
        before, theta = mode, root
        mode = int(copysign(1.0, inside(dense, 1, root))) if mode == 0 else 0
        counts[EVENTS] = put(events, counts[EVENTS], before, mode, until, inside(dense, 0, root))


@function
def keep(law, push, t, step, mode, dense, at, record):
    """A sample within a step."""
    theta = min((at - t) / step, 1.0)
    x, v, z = inside(dense, 0, theta), inside(dense, 1, theta), inside(dense, 2, theta)
    f_a = applied(push, at, x)[0]
    record[T], record[X], record[V], record[Z], record[FA] = at, x, v, z, f_a
    record[FF], record[MODE] = friction(law, v, z, f_a)[0], mode
    record[WA], record[WF] = inside(dense, 3, theta), inside(dense, 4, theta)
