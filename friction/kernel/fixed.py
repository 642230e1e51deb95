"""Fixed steps: Euler, Runge and Kutta, Moreau and Jean, and the exponential step of a bristle."""

from math import copysign, exp, expm1

import numpy as np

from friction.kernel import law as laws
from friction.kernel.law import applied, friction, gap, mode_of, note, push_at, put, slip_share, slopes, steady
from friction.kernel.structures import EVENTS, STEPS, FixedRun
from tline.compiled.unit import function, unit

EULER, RK4, MOREAU, EXPONENTIAL = range(4)


@unit
def march(run: FixedRun, steps: int, method: int, every: int) -> int:
    """Fixed steps; keeps the last state and every so-manieth, and events as every step shows them.

    Returns the status.
    """
    law, drive, mass, h, y, k, record = run.law, run.drive, run.mass, run.h, run.y, run.k, run.record
    push, force = push_at(drive, 0.0), 0.0
    f_a = applied(push, 0.0, y[0])[0]
    mode = mode_of(law, 0, y[1], y[2], f_a)
    note(record[0], 0.0, y, f_a, friction(law, y[1], y[2], f_a)[0], mode)
    for n in range(steps):
        t, x, v, z = n * h, y[0], y[1], y[2]
        if t >= push.end:
            push = push_at(drive, t)
        if method == EULER:
            slopes(law, push, mass, t, y, k[0])
            for j in range(5):
                y[j] += h * k[0, j]
        elif method == RK4:
            runge_kutta(law, push, mass, t, y, h, k, run.middle)
        else:
            force = robust(law, push, mass, t, y, h, method)
        run.counts[STEPS] = n + 1
        if not np.isfinite(y[1]) or abs(y[1]) > 1e100:
            return laws.BLOWN_UP
        f_a, before = applied(push, (n + 1) * h, y[0])[0], mode
        mode = mode_of(law, before, y[1], y[2], f_a)
        if mode != before:
            share = passed(law, before, v, z, y)
            at, place = t + share * h, x + share * (y[0] - x)
            run.counts[EVENTS] = put(run.events, run.counts[EVENTS], before, mode, at, place)
        if (n + 1) % every == 0 or n + 1 == steps:
            force = force if method >= MOREAU else friction(law, y[1], y[2], f_a)[0]
            note(record[(n + every) // every], (n + 1) * h, y, f_a, force, mode)
    return laws.DONE


@function
def passed(law, before, v, z, y):
    """Share of a step after which an event happened: a static law breaks away at its last instant at rest, all else is
    where a straight line vanishes.
    """
    if before == 0 and law.kind < laws.BRISTLE:
        return 0.0
    start, end = (gap(law, v, z), gap(law, y[1], y[2])) if before == 0 else (v, y[1])
    return start / (start - end) if start * end < 0.0 else 1.0


@function
def runge_kutta(law, push, mass, t, y, h, k, mid):
    """One step of the classical method of order 4."""
    slopes(law, push, mass, t, y, k[0])
    for j in range(5):
        mid[j] = y[j] + 0.5 * h * k[0, j]
    slopes(law, push, mass, t + 0.5 * h, mid, k[1])
    for j in range(5):
        mid[j] = y[j] + 0.5 * h * k[1, j]
    slopes(law, push, mass, t + 0.5 * h, mid, k[2])
    for j in range(5):
        mid[j] = y[j] + h * k[2, j]
    slopes(law, push, mass, t + h, mid, k[3])
    for j in range(5):
        y[j] += h / 6.0 * (k[0, j] + 2.0 * k[1, j] + 2.0 * k[2, j] + k[3, j])


@function
def robust(law, push, mass, t, y, h, method):
    """One step of Moreau and Jean, or of the exponential method; returns the friction force.

    Moreau and Jean: one contact in closed form; it holds up to its limit, and slides under the excess.
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
