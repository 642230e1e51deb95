"""Air valve: lets air in where the pressure would fall below that outside, and out again.

Its states are the volume of the air and, as the volume that it would have outside, its amount; and how far its outlet
is open, for one that shuts in a time: 1 and less while it shuts, from when air first leaves, and FULL before.
Constants: effort beyond the element, pressure outside, flows of air in, out, and out beyond the pressure that switches,
as it is outside, that choke; that pressure over the one outside; rate at which the outlet shuts, 0 for one that shuts
as soon as the air is gone; and its capacity for liquid.
"""

import numpy as np

from tline.compiled.unit import function, unit
from tline.solver.kernel.arithmetic import (
    ACCEPTED_RESIDUAL,
    BEST_RESIDUAL,
    HALVINGS,
    TRIES,
    after,
    clear,
    eliminate,
    fallen,
    project,
    times,
)
from tline.solver.kernel.laws.quadratic import rooted
from tline.solver.kernel.network import Store
from tline.solver.kernel.stores.gas import expanded

SWITCHES = 0.5  # of the switching pressure: further rise until the smaller orifice alone is open
RATE, CAPACITY, FULL = 6, 7, 2.0
CHOKES, CHOKED = 1 - (5 / 6) ** 3.5, 1.4**0.5 * (5 / 6) ** 3  # 1 - ratio of pressures where air chokes; its flow then


@function
def shutting(opening, rate, t):
    """Share of the outlet that is open a time t after an opening."""
    return 1.0 if rate == 0.0 or opening > 1.0 else max(opening - rate * t, 0.0)


@function
def blown(g, c, at, share):
    """Volume of air, as it is outside, that leaves per s where the pressure is 1 + g |g| atmospheres.

    Isentropic flow through an orifice, which chokes; its slope over g is finite where air turns.
    """
    outlet = c[at + 3]
    if g > 0.0 and g * g > c[at + 5]:
        way = min((g * g / c[at + 5] - 1.0) / SWITCHES, 1.0)
        outlet += (c[at + 4] - outlet) * way * way * (3.0 - 2.0 * way)
    x = g * g / (1.0 if g < 0.0 else 1.0 + g * g)  # 1 - ratio of the pressures
    rate = CHOKED
    if x <= CHOKES:
        low = np.log1p(-x)
        rate = np.sqrt(-7.0 * np.exp(10.0 / 7.0 * low) * np.expm1(2.0 / 7.0 * low))
    return -c[at + 2] * rate if g < 0.0 else share * outlet * (1.0 + g * g) * rate


@function
def exchange(store, at, h, z, volume, air, opening):
    """One Radau IIA step of an air valve of width h, from an amount of air in a volume: flows at the points.

    g are the roots of the pressures there, in atmospheres. Returns volume, air, energy taken in, and the least volume
    at a point, nan if no solution was found.
    """
    c, radau, w, g, flow, out = store.constants, store.tools.radau, store.first, store.safe, store.flow, store.y
    s, outside, before, damped = flow.size, c[at + 1], np.inf, 1.0
    rest, system = store.rest, store.system
    for _ in range(TRIES):
        worst, scale, least, v, m, work = 0.0, volume + air, np.inf, 0.0, 0.0, 0.0
        for j in range(s):
            flow[j] = (w[j] - outside * g[j] * abs(g[j])) / z
            out[j] = blown(g[j], c, at, shutting(opening, c[at + RATE], h * store.tools.c[j]))
            scale = max(scale, h * abs(flow[j]), h * abs(out[j]))
            work += h * radau[s - 1, j] * flow[j] * outside * g[j] * abs(g[j])
        for j in range(s):
            v, m = volume, air
            for k in range(s):
                v -= h * radau[j, k] * flow[k]
                m -= h * radau[j, k] * out[k]
            least, density = min(least, v), 1.0 + g[j] * abs(g[j])
            rest[j] = density * v - m
            worst, scale = max(worst, abs(rest[j])), max(scale, abs(density * v))
            for k in range(s):
                delta = 1e-7 * max(abs(g[k]), 1.0) * (1.0 if g[k] > 0.0 else -1.0)
                share = shutting(opening, c[at + RATE], h * store.tools.c[k])
                more = (blown(g[k] + delta, c, at, share) - out[k]) / delta
                system[j, k] = h * radau[j, k] * (more + density * 2.0 * abs(g[k]) * outside / z)
            system[j, j] += 2.0 * abs(g[j]) * v
            system[j, s] = rest[j]
        if worst <= BEST_RESIDUAL * scale or (worst <= ACCEPTED_RESIDUAL * scale and worst >= 0.5 * before):
            return v, m, work, least
        damped = min(1.0, 2.0 * damped) if worst < before else 0.5 * damped
        before = worst
        eliminate(system, s)
        for j in range(s):
            g[j] = max(g[j] - damped * system[j, s], 0.5 * (g[j] - 1.0))
    return 0.0, 0.0, 0.0, np.nan


@function
def in_air(volume, air):
    """Energy of air in a volume above that at the outside pressure, in atmospheres times volume."""
    if air <= 0.0:
        return volume
    _, x, _ = expanded(np.log(volume / air), 1.0)
    return 0.5 * air * x * x


@function
def stretched(store, at, h, z, since, volume, air, opening):
    """One step from an instant of the slab on, as far as there is air and no energy is added, found by bisection.

    A step ends where air begins to leave an outlet that shuts in a time. Returns where it ends, the volume, the air and
    the energy taken in there, and whether behind it no air is left, and air leaves. Its flow is kept in Legendre
    coefficients.
    """
    low, high, until, shut, leaves, room, held, taken = since, 1.0, 1.0, False, False, volume, air, 0.0
    waits = store.constants[at + RATE] > 0.0 and opening > 1.0
    tools, piece, g, s = store.tools, store.piece, store.safe, store.flow.size
    for _ in range(HALVINGS if since < 1.0 else 0):
        clear(piece)
        project(store.coef, 0.0, 1.0, since, until, tools.gauss, piece)
        times(tools.to_points, piece, 0, store.first)
        density = air / volume if volume > 0.0 else 1.0
        for j in range(s):
            g[j] = np.sqrt(abs(density - 1.0)) * (1.0 if density > 1.0 else -1.0)
        v_end, m_end, work, least = exchange(store, at, h * (until - since), z, volume, air, opening)
        taken_now = work / store.constants[at + 1]
        early = waits and least > 0.0 and g[s - 1] > 0.0
        if not early and least > 0.0 and in_air(volume, air) + taken_now >= -BEST_RESIDUAL * (volume + v_end + m_end):
            low, room, held, taken = until, v_end, m_end, taken_now
            times(tools.to_legendre, store.flow, 0, store.kept)
        else:
            high = until
            shut, leaves = least <= 0.0 or (shut and not waits), early
        if low == high or (low > since and not shut and not leaves) or high - low < BEST_RESIDUAL:
            break
        until = 0.5 * (low + high)
    return low, room, held, taken, shut, leaves


@function
def drained(store, at, h, z, since, opening):
    """Liquid out of an outlet that still shuts, until it is shut or air comes in. Returns where that is.

    Its flow is kept in Legendre coefficients.
    """
    c, tools, piece, s = store.constants, store.tools, store.piece, store.flow.size
    low = min(since + opening / (h * c[at + RATE]), fallen(store.coef, 0.0, since), 1.0)
    if low > since:
        clear(piece)
        project(store.coef, 0.0, 1.0, since, low, tools.gauss, piece)
        times(tools.to_points, piece, 0, store.first)
        for j in range(s):
            share = shutting(opening, c[at + RATE], h * (low - since) * tools.c[j])
            store.flow[j] = rooted(store.first[j], z, c[at + CAPACITY] * share, 1.0)[0]
        times(tools.to_legendre, store.flow, 0, store.kept)
    return low


@unit
def air(store: Store, at: int, state: int, h: float, z: float) -> int:
    """Flows into an air valve at the points of a slab of width h, under the efforts v there.

    It opens at a root of v less the pressure outside; then follows a Radau IIA step up to where no air is left, and
    liquid, as far as the outlet is open then. The inflow is projected on the slab. The step keeps the volume; if it
    would add energy, the air comes nearer to the pressure outside, and if that does not do, the step is halved.
    """
    states, tools, flow, v, coef = store.states, store.tools, store.flow, store.v, store.coef
    whole, s = store.whole, store.v.size
    clear(whole)
    for j in range(s):
        flow[j] = v[j] - store.constants[at]
    times(tools.to_legendre, flow, 0, coef)
    since, rate = 0.0, h * store.constants[at + RATE]
    volume, mass, opening = states[state], states[state + 1], states[state + 2]
    while since < 1.0 and np.isfinite(whole[0]):
        if volume == 0.0 and opening > 0.0:
            low = drained(store, at, h, z, since, opening)
            if low > since:
                project(store.kept, since, low, 0.0, 1.0, tools.gauss, whole)
            opening, since = max(opening - rate * (low - since), 0.0), low
            if low < 1.0:
                opening = 0.0
            continue
        if volume == 0.0:
            since = fallen(coef, 0.0, since)
            opening = FULL if rate > 0.0 and since < 1.0 else 0.0
        low, room, held, taken, shut, leaves = stretched(store, at, h, z, since, volume, mass, opening)
        if low > since:
            project(store.kept, since, low, 0.0, 1.0, tools.gauss, whole)
            most, most_now = in_air(volume, mass) + taken, in_air(room, held)
            if most_now > most:
                held = room + (held - room) * max(most, 0.0) / most_now
            volume, mass = room, held
        elif since < 1.0 and not shut and not leaves:
            whole[0], volume = np.nan, np.nan
        opening = max(opening - rate * (low - since), 0.0) if opening <= 1.0 else opening
        since = low
        if leaves:
            opening = 1.0
        if shut:
            volume, mass = 0.0, 0.0
            opening = opening if opening <= 1.0 else 0.0
            since = low if opening > 0.0 else after(low, s)
    states[state], states[state + 1], states[state + 2] = volume, mass, opening
    times(tools.to_points, whole, 0, flow)
    return 0
