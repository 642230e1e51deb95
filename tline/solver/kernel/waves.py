"""The wave kernel: lines carry waves, nodes scatter them. It knows arrays and nothing else.

Symbols: w wave that arrives at an end, u effort of a node, 2u - w wave that leaves; s points per slab, x load state.
Nodes do not see each other before the shortest delay has passed, so each is advanced over a whole block of slabs at
once; where a line's slot wraps, or the scratch is full, the block is cut into tiles that are contiguous in memory.

Positions in the wave buffers are unsigned: a signed index is tested for wrapping round at every access, and the loops
do not vectorise. Helpers are inlined as source: as calls they would count references to their arrays at every tile,
which costs up to five times the arithmetic. An integer written in a call compiles a version of what is called for that
number alone; `int64(0)` does not.
"""

from typing import Any

import numpy as np
from numba import int64, uint64

from tline.compiled import njit
from tline.solver.kernel.by_reference import borrowed
from tline.solver.kernel.callback import answer

TINY = 1e-150  # waves below are flushed to zero: subnormal numbers are slow, and their squares vanish anyway
SCRATCH = 512  # samples per tile
ABREAST = 64  # lumps advanced together
FEW = 24  # samples that are not worth gathering
CONSTANT, SQUARED, TABLED = range(3)  # kinds of lumps; the others have a memory
OPTIONS: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract", "nsz"}}
INNER: dict[str, Any] = OPTIONS | {
    "no_cpython_wrapper": True,
    "no_cfunc_wrapper": True,
}  # for kernels alone, never Python


@njit(inline="always", **OPTIONS)
def begin(u, q, n, drive, row, start):
    """Start the Thévenin wave of a node, at place q of u, with the sources' part."""
    if row < 0:
        for i in range(n):
            u[q + uint64(i)] = 0.0
    else:
        for i in range(n):
            u[q + uint64(i)] = drive[row, start + i]


@njit(inline="always", **OPTIONS)
def gather(u, q, n, waves, o, share):
    """Add an end's share of its arriving wave."""
    for i in range(n):
        u[q + uint64(i)] += share * waves[o + uint64(i)]


@njit(inline="always", **OPTIONS)
def scatter(u, q, n, waves, o):
    """Send back from an end what the node's effort leaves of the arriving wave."""
    for i in range(n):
        back = 2.0 * u[q + uint64(i)] - waves[o + uint64(i)]
        waves[o + uint64(i)] = 0.0 if abs(back) < TINY else back


@njit(inline="always", **OPTIONS)
def note(u, q, n, waves, o, record, row, column):
    """Keep the waves that arrive at an end and leave it."""
    for i in range(n):
        record[row, 0, column + i] = waves[o + uint64(i)]
        record[row, 1, column + i] = 2.0 * u[q + uint64(i)] - waves[o + uint64(i)]


@njit(inline="always", **OPTIONS)
def shift(waves, o, m, before, end, shifts, r, history, row):
    """Apply the fractional rest of a delay to m arriving slabs, in place."""
    s = before.shape[1]
    for j in range(s):
        history[j, 0] = before[end, j]
        for k in range(m):
            history[j, k + 1] = waves[o + uint64(k * s + j)]
        before[end, j] = history[j, m]
    for i in range(s):
        for k in range(m):
            row[k] = 0.0
        for j in range(s):
            now, then = shifts[r, 0, i, j], shifts[r, 1, i, j]
            for k in range(m):
                row[k] += now * history[j, k + 1] + then * history[j, k]
        for k in range(m):
            waves[o + uint64(k * s + i)] = row[k]


@njit(inline="always", **OPTIONS)
def load(u, k, m, s, step, at, states, x, n, row):
    """Turn the Thévenin waves of m slabs at a group's k nodes into the nodes' efforts, through the group's state."""
    width = uint64(k * s + n)
    for slab in range(m):
        for p in range(k):
            for i in range(s):
                row[uint64(p * s + i)] = u[uint64((p * m + slab) * s + i)]
        for i in range(n):
            row[uint64(k * s + i)] = states[uint64(x + i)]
        place = uint64(at)
        for p in range(k):
            for i in range(s):
                total = 0.0
                for j in range(width):
                    total += step[place + j] * row[j]
                place += width
                u[uint64((p * m + slab) * s + i)] = total
        for i in range(n):
            total = 0.0
            for j in range(width):
                total += step[place + j] * row[j]
            place += width
            states[uint64(x + i)] = 0.0 if abs(total) < TINY else total


@njit(inline="always", **OPTIONS)
def add_product(matrix, at, rows, columns, x, o, out, q):
    """Add the product of a matrix, held by columns, with part of an array to part of another."""
    for j in range(columns):
        factor, place = x[uint64(o + j)], uint64(at + j * rows)
        for i in range(uint64(rows)):
            out[uint64(q) + i] += matrix[place + i] * factor


# Elements whose flow is no linear function of the effort across them. Each sees a Thévenin source: an effort v behind
# an impedance z. Where several see each other, Newton's method finds all flows at once, instant by instant.

QUADRATIC, PUMP, RELIEF, LEAK, DEMAND, DIODE, TABLE, GAS, TANK, ROTOR, VAPOUR, AIR, OWN = range(13)
SPARE, CLOSE = 4e-15, 1e-10  # residuals, relative to the efforts: where to stop, and what will do if no step helps
STEPS, ULPS = 80, 4e-16  # of a scalar Newton, and the relative change at which it ends
TRIES, LEAST_STRIDE = 40, 1e-8  # Newton steps for a part of the way, and the least part
FAINT = 1e-9  # slope, for a step, of drops that have none at rest and of flows that answer to nothing
FARTHEST = 2.0  # step, in units of the largest effort
MISSED, SQUEEZES = 1e-3, 64  # share of a gas's volume that a step may lose, and steps in a slab where it loses more
LOOKS, HALVINGS = 4, 60  # at a slab for roots, per point; and of an interval with a root
CHOKES, CHOKED = 1 - (5 / 6) ** 3.5, 1.4**0.5 * (5 / 6) ** 3  # 1 - ratio of pressures where air chokes; its flow then


@njit(**INNER)
def eliminate(system, size):
    """Solve a linear system by Gauss with pivots; the right side is its last column, and becomes the solution."""
    for pivot in range(size):
        best = pivot
        for i in range(pivot + 1, size):
            if abs(system[i, pivot]) > abs(system[best, pivot]):
                best = i
        for j in range(pivot, size + 1):
            system[pivot, j], system[best, j] = system[best, j], system[pivot, j]
        for i in range(pivot + 1, size):
            ratio = system[i, pivot] / system[pivot, pivot]
            if ratio != 0.0:
                for j in range(pivot + 1, size + 1):
                    system[i, j] -= ratio * system[pivot, j]
    for pivot in range(size - 1, -1, -1):
        for j in range(pivot + 1, size):
            system[pivot, size] -= system[pivot, j] * system[j, size]
        system[pivot, size] /= system[pivot, pivot]


@njit(**INNER)
def left_of(rest, first, aim):
    """Take from residuals what they may have left, 1 - aim of the first ones. Returns the largest."""
    largest = 0.0
    for i in range(rest.size):
        rest[i] -= (1.0 - aim) * first[i]
        largest = max(largest, abs(rest[i]))
    return largest


@njit(**OPTIONS)
def rooted(d, z, capacity, one_way):
    """Flow i and di/dd where d = z i + i |i| / capacity²; without cancellation from shut to without loss."""
    if capacity == 0.0 or (one_way > 0.0 and d < 0.0):
        return 0.0, 0.0
    if capacity == np.inf:
        return d / z, 1.0 / z
    sum_ = z * capacity + np.sqrt((z * capacity) ** 2 + 4.0 * abs(d))
    if sum_ == 0.0:
        return 0.0, 1.0 / z
    i = 2.0 * d * capacity / sum_
    return i, capacity**2 / (z * capacity**2 + 2.0 * abs(i))


@njit(**INNER)
def parabolic(d, z, bend, one_way):
    """Flow i and di/dd where d = z i + bend i |i|."""
    if one_way > 0.0 and d < 0.0:
        return 0.0, 0.0
    sum_ = z + np.sqrt(z**2 + 4.0 * bend * abs(d))
    if sum_ == 0.0:
        return 0.0, 0.0
    i = 2.0 * d / sum_
    return i, 1.0 / (z + 2.0 * bend * abs(i))


@njit(**INNER)
def conducted(kind, c, at, factor, u):
    """Flow, and its slope over the effort u, of a law that gives it so."""
    if kind == RELIEF:  # in its band
        rate = c[at + 1] / c[at + 3]
        root = np.sqrt(u)
        return rate * (u - c[at + 2]) * root, rate * (root + 0.5 * (u - c[at + 2]) / root)
    share = (u / c[at + 2]) ** c[at + 3] * factor * c[at + 1]  # LEAK, DEMAND
    return share, c[at + 3] * share / u


@njit(**INNER)
def bracketed(kind, c, at, factor, d, z, low, high):
    """Flow i and di/dd where d = u + z i(u), and u lies between low and high: Newton, bisection where that fails."""
    u = high
    for _ in range(STEPS):
        i, slope = conducted(kind, c, at, factor, u)
        rest = u + z * i - d
        if rest > 0.0:
            high = u
        else:
            low = u
        step = rest / (1.0 + z * slope)
        after = u - step
        if not low * (1.0 - ULPS) <= after <= high * (1.0 + ULPS):
            after = 0.5 * (low + high)
        close = abs(after - u) <= ULPS * u
        u = after
        if close:
            break
    i, slope = conducted(kind, c, at, factor, u)
    if z * slope > 1.0:  # then u is known better than what it conducts
        i = (d - u) / z
    return i, slope / (1.0 + z * slope)


@njit(**INNER)
def diode(d, z, saturation, thermal):
    """Flow i and di/dd where d = u + z i and i = saturation (exp(u/thermal) - 1): Newton from the right, monotone."""
    u = d
    if d > 0.0 and z > 0.0:
        u = min(d, thermal * np.log1p(d / (z * saturation)))
    elif d < 0.0:
        u = 0.0
    for _ in range(STEPS if z > 0.0 else 0):
        growth = z * saturation * np.exp(u / thermal)
        step = (u + z * saturation * np.expm1(u / thermal) - d) / (1.0 + growth / thermal)
        u -= step
        if abs(step) <= 1e-15 * abs(u) + 1e-300:
            break
    if z == 0.0 and d < 0.0:
        u = d
    slope = saturation / thermal * np.exp(u / thermal)
    return saturation * np.expm1(u / thermal), slope / (1.0 + z * slope)


@njit(**INNER)
def tabled(d, z, c, at, n):
    """Flow i and di/dd where d = u + z i, and (u, i) lies on straight lines through n points, continued beyond."""
    low, high = 0, n - 1
    while high - low > 1:
        middle = (low + high) // 2
        if c[at + middle] + z * c[at + n + middle] <= d:
            low = middle
        else:
            high = middle
    start, stop = c[at + low] + z * c[at + n + low], c[at + high] + z * c[at + n + high]
    rise = c[at + n + high] - c[at + n + low]
    if stop <= start:
        return c[at + n + low], 0.0
    slope = rise / (stop - start)
    if d - start < stop - d:
        return c[at + n + low] + slope * (d - start), slope
    return c[at + n + high] - slope * (stop - d), slope


@njit(**INNER)
def own(address, factor, d, z):
    """Flow i and di/dd where d = u + z i(u) and i is told at an address: by Ridders' method, which needs no slope."""
    low, high, wide = min(d, 0.0), max(d, 0.0), abs(d)
    at_low = low + z * answer(address, low, factor) - d
    at_high = high + z * answer(address, high, factor) - d
    for _ in range(STEPS):  # an active law has its effort beyond the wave
        if at_low <= 0.0 <= at_high:
            break
        wide = 2.0 * max(wide, abs(at_low), abs(at_high))
        if at_low > 0.0:
            low -= wide
            at_low = low + z * answer(address, low, factor) - d
        if at_high < 0.0:
            high += wide
            at_high = high + z * answer(address, high, factor) - d
    if not at_low <= 0.0 <= at_high:
        return np.nan, 0.0
    u = low if at_low == 0.0 else high
    for _ in range(STEPS):
        if at_low == 0.0 or at_high == 0.0 or high - low <= ULPS * max(abs(low), abs(high)):
            break
        before, middle = u, 0.5 * (low + high)
        rest = middle + z * answer(address, middle, factor) - d
        u = middle if rest == 0.0 else middle - (middle - low) * rest / np.sqrt(rest**2 - at_low * at_high)
        left = u + z * answer(address, u, factor) - d
        for place, value in ((middle, rest), (u, left)):
            if value > 0.0 and place < high:
                high, at_high = place, value
            elif value <= 0.0 and place > low:
                low, at_low = place, value
        if abs(u - before) <= ULPS * abs(u):
            break
    i, step = answer(address, u, factor), 1e-6 * max(abs(u), abs(d)) + TINY
    slope = max(answer(address, u + step, factor) - answer(address, u - step, factor), 0.0) / (2.0 * step)
    if z * slope > 1.0:
        i = (d - u) / z
    return i, slope / (1.0 + z * slope)


@njit(**OPTIONS)
def through(kind, c, at, factor, v, z):
    """Flow i through an element without a state, behind the effort v and the impedance z, and di/dv."""
    d = v - c[at]
    if kind == QUADRATIC:
        return rooted(d, z, c[at + 1] * max(factor, 0.0), c[at + 2])
    if kind == PUMP:
        speed = max(factor, 0.0)
        return parabolic(d + speed**2 * c[at + 1], z + speed * c[at + 2], c[at + 3], c[at + 4])
    if kind == DIODE:
        return diode(d, z, c[at + 1], c[at + 2])
    if kind == TABLE:
        return tabled(d, z, c, at + 2, int(c[at + 1]))
    if kind == OWN:
        return own(int64(c[at + 1]), factor, d, z)
    least = c[at + 2] if kind == RELIEF else 0.0
    if d <= least or factor <= 0.0:
        return 0.0, 0.0
    if kind == RELIEF:
        i, slope = rooted(d, z, c[at + 1], 0.0)
        high = least + c[at + 3]
        if d - z * i >= high:
            return i, slope
    elif kind == DEMAND:
        high = c[at + 2]
        if d - z * factor * c[at + 1] >= high:
            return factor * c[at + 1], 0.0
    elif c[at + 3] == 0.5:
        return rooted(d, z, factor * c[at + 1] / np.sqrt(c[at + 2]), 0.0)
    else:
        high = d
    return bracketed(kind, c, at, factor, d, z, least, min(d, high))


@njit(**OPTIONS)
def gas(low, n):
    """Of gas with p V^n = 1 in air of pressure 1, from ln V: effort, X with X²/2 the energy stored, and effort/X."""
    d = np.expm1(low)
    if abs(d) < 0.4:
        term, effort, energy, k = -n, n, n / 2.0, 1
        while abs(term) > 1e-17 * abs(effort) and k < 60:
            k += 1
            term *= d * (-n - k + 1.0) / k
            effort -= term
            energy -= term / (k + 1.0)
        return -d * effort, -d * np.sqrt(2.0 * energy), effort / np.sqrt(2.0 * energy)
    work = -low if n == 1.0 else -np.expm1((1.0 - n) * low) / (1.0 - n)
    x = np.sqrt(2.0 * (work + d))
    x = -x if d > 0.0 else x
    effort = np.expm1(-n * low)
    return effort, x, effort / x


@njit(**OPTIONS)
def stored(kind, c, at, y):
    """What the state y of an element says: X, dX/dy, and where v = e + l i + loss, dX/dt = (r + q i) i: e, l, r, q."""
    if kind == GAS:  # y = ln(V / volume at zero effort)
        effort, x, ratio = gas(y, c[at + 4])
        return x, -ratio * np.exp(y), c[at + 2] * effort, 0.0, ratio / c[at + 3], 0.0
    if kind == TANK:  # y = effort
        return y, 1.0, y, 0.0, 1.0 / c[at + 2], 0.0
    # ROTOR, y = speed over rated speed
    return (
        y,
        1.0,
        -c[at + 1] * y * abs(y),
        c[at + 2] * abs(y),
        -c[at + 1] * abs(y) / c[at + 5],
        c[at + 2] * (1.0 if y > 0.0 else -1.0) / c[at + 5],
    )


@njit(**INNER)
def filling(kind, c, at, y, v, z):
    """Flow i into an element with a state y, X, dX/dy, and dX/dt."""
    x, slope, effort, more, rate, bend = stored(kind, c, at, y)
    if kind == ROTOR:
        i, _ = parabolic(v - c[at] - effort, z + more, c[at + 3], c[at + 4])
    else:
        i, _ = rooted(v - c[at] - effort, z, c[at + 1], 0.0)
    return i, x, slope, (rate + bend * i) * i


@njit(**INNER)
def unfilled(laws, e, radau, h, y, v, z, start, flow, rest):
    """Residuals of the stages of an element with a state, the largest, and a scale."""
    kind, c, at, s = laws.kind[e], laws.constants, laws.at[e], radau.shape[0]
    x_start, _, _, _, _, _ = stored(kind, c, at, start)
    worst, scale = 0.0, abs(x_start)
    for j in range(s):
        rest[j] = -x_start
    for j in range(s):
        flow[j], x, _, rate = filling(kind, c, at, y[j], v[j], z)
        _, _, _, _, share, _ = stored(kind, c, at, y[j])
        rest[j] += x
        scale = max(scale, abs(x), h * abs(share * v[j]) / z)  # a stiff step magnifies what v is rounded by
        for k in range(s):
            rest[k] -= h * radau[k, j] * rate
    for j in range(s):
        worst = max(worst, abs(rest[j]))
    return worst, scale


@njit(**INNER)
def fill(laws, e, on, states, radau, h, v, z, flow, y, rest, system):
    """One Radau IIA step of width h of an element with a state: flows at the points under the efforts v there.

    The state is the root of twice the energy stored, so that the step cannot add energy (Hairer, Wanner: Solving
    Ordinary Differential Equations II, 1996, theorem IV.12.9). As in `meet`, the first residual is led to zero.
    """
    kind, c, at, s = laws.kind[e], laws.constants, laws.at[e], radau.shape[0]
    start = states[laws.state_at[e]]
    if kind == ROTOR and on > 0.5:
        for j in range(s):
            flow[j], _, _, _ = filling(kind, c, at, start, v[j], z)
        return
    for j in range(s):
        y[j] = start
    unfilled(laws, e, radau, h, y, v, z, start, flow, rest)
    first, safe = rest.copy(), y.copy()
    done, stride = 0.0, 1.0
    while done < 1.0 and stride > LEAST_STRIDE:
        aim, before, sound, share = min(done + stride, 1.0), np.inf, False, 1.0
        for _ in range(TRIES):
            _, scale = unfilled(laws, e, radau, h, y, v, z, start, flow, rest)
            now = left_of(rest, first, aim)
            sound = now <= SPARE * scale or (now <= CLOSE * scale and now >= 0.5 * before)
            if sound or not np.isfinite(now):
                break
            share = min(1.0, 2.0 * share) if now < before else 0.5 * share
            before, reach = now, 1e-300
            for k in range(s):
                delta = 1e-7 * max(abs(y[k]), 1.0)
                _, _, slope, rate = filling(kind, c, at, y[k], v[k], z)
                _, _, _, more = filling(kind, c, at, y[k] + delta, v[k], z)
                for j in range(s):
                    system[j, k] = (slope if j == k else 0.0) - h * radau[j, k] * (more - rate) / delta
                system[k, s] = rest[k]
            eliminate(system, s)
            for j in range(s):
                reach = max(reach, abs(system[j, s]))
            step = min(share, 2.0 / reach) if kind == GAS else share
            for j in range(s):
                y[j] -= step * system[j, s]
        if sound:
            copy(y, safe)
            done, stride = aim, 2.0 * stride
        else:
            copy(safe, y)
            stride *= 0.25
    states[laws.state_at[e]] = y[s - 1]
    if done < 1.0:
        flow[s - 1] = np.nan


@njit(**INNER)
def integrated(coef, factor, out):
    """Legendre coefficients of the integral from 0 of a polynomial on [0, 1], times a factor."""
    clear(out)
    out[0] = 0.5 * factor * coef[0]
    for k in range(coef.size):
        term = 0.5 * factor * coef[k] / (2 * k + 1)
        out[k + 1] += term
        if k > 0:
            out[k - 1] -= term


@njit(**INNER)
def squeeze(laws, e, start, states, tools, h, v, z, flow):
    """Flows into gas that keeps its temperature, by many steps of Euler's implicit method for its volume.

    Its energy is convex in its volume: a step adds none. Nor does the projection of these flows on the slab, which
    keeps their integral, the volume.
    """
    at, c, width = laws.at[e], laws.constants, 1.0 / SQUEEZES
    coef, sent = np.empty(flow.size), np.empty(flow.size + 1)
    constant, whole = np.empty(1), np.zeros(flow.size)
    times(tools.to_legendre, v, 0, coef)
    integrated(coef, 1.0, sent)
    volume, last, share = np.exp(start), 0.0, h * width * c[at + 2] / (z * c[at + 3])
    for k in range(SQUEEZES):
        here = series(sent, 2.0 * (k + 1) * width - 1.0)
        left = volume - share * (((here - last) / width - c[at]) / c[at + 2] + 1.0)
        root = np.sqrt(left * left + 4.0 * share)
        new = 0.5 * (left + root) if left > 0.0 else 2.0 * share / (root - left)
        constant[0] = (volume - new) * c[at + 3] / (h * width)
        project(constant, k * width, (k + 1) * width, 0.0, 1.0, tools.gauss, whole)
        volume, last = new, here
    states[laws.state_at[e]] = np.log(volume)
    times(tools.to_points, whole, 0, flow)


@njit(**INNER)
def is_missed(laws, e, start, states, radau, h, flow):
    """Whether the volume of gas that keeps its temperature is not what flowed: too stiff for the step."""
    at, c, spent = laws.at[e], laws.constants, 0.0
    if c[at + 1] < np.inf or c[at + 4] != 1.0:
        return False
    for j in range(flow.size):
        spent += radau[flow.size - 1, j] * flow[j]
    before, volume = np.exp(start), np.exp(states[laws.state_at[e]])
    return not abs(volume - before + h * spent / c[at + 3]) <= MISSED * max(volume, before)


@njit(**INNER)
def fallen(coef, level, start):
    """Where after a place a polynomial on [0, 1] first falls below a level, as far as some looks tell; else 1."""
    looks, low = LOOKS * coef.size, start
    for k in range(int(start * looks) + 1, looks + 1):
        high = k / looks
        if series(coef, 2.0 * high - 1.0) < level:
            for _ in range(HALVINGS):
                middle = 0.5 * (low + high)
                if series(coef, 2.0 * middle - 1.0) < level:
                    high = middle
                else:
                    low = middle
            return high
        low = high
    return 1.0


@njit(**INNER)
def after(place, s):
    """The next look at a slab."""
    return min((int(place * LOOKS * s) + 1) / (LOOKS * s), 1.0)


@njit(**INNER)
def boil(laws, e, states, tools, h, v, z, flow):
    """Flows into a vapour cavity at the points of a slab of width h, under the efforts v there.

    It opens at a root of v less its pressure, and shuts where the integral has filled its volume again. What flows in
    between is projected on the slab: that keeps the volume, and adds no energy.
    """
    s, at, gauss = flow.size, laws.state_at[e], tools.gauss
    above, freed, piece, whole = np.empty(s), np.empty(s + 1), np.empty(s), np.zeros(s)
    for j in range(s):
        flow[j] = v[j] - laws.constants[laws.at[e]]
    times(tools.to_legendre, flow, 0, above)
    integrated(above, -h / z, freed)
    since, volume = 0.0, states[at]
    while since < 1.0:
        if volume == 0.0:
            since = fallen(above, 0.0, since)
        floor = series(freed, 2.0 * since - 1.0) - volume
        until = fallen(freed, floor, since)
        clear(piece)
        project(above, 0.0, 1.0, since, until, gauss, piece)
        project(piece, since, until, 0.0, 1.0, gauss, whole)
        volume = max(series(freed, 1.0) - floor, 0.0) if until == 1.0 else 0.0
        since = after(until, s)
    states[at] = volume
    times(tools.to_points, whole, 0, flow)
    for j in range(s):
        flow[j] /= z


@njit(**INNER)
def blown(g, inlet, outlet):
    """Volume of air, as it is outside, that leaves per s where the pressure is 1 + g |g| atmospheres.

    Isentropic flow through an orifice, which chokes; its slope over g is finite where air turns.
    """
    x = g * g / (1.0 if g < 0.0 else 1.0 + g * g)  # 1 - ratio of the pressures
    rate = CHOKED
    if x <= CHOKES:
        low = np.log1p(-x)
        rate = np.sqrt(-7.0 * np.exp(10.0 / 7.0 * low) * np.expm1(2.0 / 7.0 * low))
    return -inlet * rate if g < 0.0 else outlet * (1.0 + g * g) * rate


@njit(**INNER)
def exchange(c, at, radau, h, z, w, volume, air, g, flow, out, rest, system):
    """One Radau IIA step of an air valve of width h, from an amount of air in a volume: flows at the points.

    g are the roots of the pressures there, in atmospheres. Returns volume, air, energy taken in, and the least volume
    at a point, nan if no solution was found.
    """
    s, outside, before, share = flow.size, c[at + 1], np.inf, 1.0
    for _ in range(TRIES):
        worst, scale, least, v, m, work = 0.0, volume + air, np.inf, 0.0, 0.0, 0.0
        for j in range(s):
            flow[j] = (w[j] - outside * g[j] * abs(g[j])) / z
            out[j] = blown(g[j], c[at + 2], c[at + 3])
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
                more = (blown(g[k] + delta, c[at + 2], c[at + 3]) - out[k]) / delta
                system[j, k] = h * radau[j, k] * (more + density * 2.0 * abs(g[k]) * outside / z)
            system[j, j] += 2.0 * abs(g[j]) * v
            system[j, s] = rest[j]
        if worst <= SPARE * scale or (worst <= CLOSE * scale and worst >= 0.5 * before):
            return v, m, work, least
        share = min(1.0, 2.0 * share) if worst < before else 0.5 * share
        before = worst
        eliminate(system, s)
        for j in range(s):
            g[j] = max(g[j] - share * system[j, s], 0.5 * (g[j] - 1.0))
    return 0.0, 0.0, 0.0, np.nan


@njit(**INNER)
def in_air(volume, air):
    """Energy of air in a volume beyond what the air outside has, in atmospheres."""
    if air <= 0.0:
        return volume
    _, x, _ = gas(np.log(volume / air), 1.0)
    return 0.5 * air * x * x


@njit(**INNER)
def breathe(laws, e, states, tools, h, v, z, flow, out, rest, system):
    """Flows into an air valve at the points of a slab of width h, under the efforts v there.

    It opens at a root of v less the pressure outside; then follows a Radau IIA step up to where no air is left, found
    by bisection. What flows in is projected on the slab. The step keeps the volume; if it would add energy, the air
    comes nearer to the pressure outside, and if that does not do, the step is halved.
    """
    s, x, at, gauss, c = flow.size, laws.state_at[e], laws.at[e], tools.gauss, laws.constants
    coef, piece, kept, whole, w, g = np.empty(s), np.empty(s), np.empty(s), np.zeros(s), np.empty(s), np.empty(s)
    for j in range(s):
        flow[j] = v[j] - c[at]
    times(tools.to_legendre, flow, 0, coef)
    since, volume, air = 0.0, states[x], states[x + 1]
    while since < 1.0 and np.isfinite(whole[0]):
        if volume == 0.0:
            since = fallen(coef, 0.0, since)
        low, high, until, shut, room, held, taken = since, 1.0, 1.0, False, volume, air, 0.0
        for _ in range(HALVINGS if since < 1.0 else 0):
            clear(piece)
            project(coef, 0.0, 1.0, since, until, gauss, piece)
            times(tools.to_points, piece, 0, w)
            density = air / volume if volume > 0.0 else 1.0
            for j in range(s):
                g[j] = np.sqrt(abs(density - 1.0)) * (1.0 if density > 1.0 else -1.0)
            width = h * (until - since)
            v_end, m_end, work, least = exchange(
                c, at, tools.radau, width, z, w, volume, air, g, flow, out, rest, system
            )
            if least > 0.0 and in_air(volume, air) + work / c[at + 1] >= -SPARE * (volume + v_end + m_end):
                low, room, held, taken = until, v_end, m_end, work
                times(tools.to_legendre, flow, 0, kept)
            else:
                high = until
                shut |= least <= 0.0
            if low == high or (low > since and not shut) or high - low < SPARE:
                break
            until = 0.5 * (low + high)
        if low > since:
            project(kept, since, low, 0.0, 1.0, gauss, whole)
            most, most_now = in_air(volume, air) + taken / c[at + 1], in_air(room, held)
            if most_now > most:
                held = room + (held - room) * max(most, 0.0) / most_now
            volume, air = room, held
        elif since < 1.0 and not shut:
            whole[0], volume = np.nan, np.nan
        since = low
        if shut:
            volume, air, since = 0.0, 0.0, after(low, s)
    states[x], states[x + 1] = volume, air
    times(tools.to_points, whole, 0, flow)


@njit(**INNER)
def unbalance(laws, g, low, u, stride, q, factor, x, level, flow, slope, rest, taken):
    """Residuals of a group at sample q, and a scale; x has what elements see behind their impedances, then efforts.

    At nodes where nothing else conducts, u is the flow that is driven in, and x the effort.
    """
    first, n, scale = laws.first[g], laws.first[g + 1] - laws.first[g], 0.0
    for p in range(taken.size):
        taken[p] = 0.0
    for k in range(n):
        e = first + k
        flow[k], slope[k] = through(laws.kind[e], laws.constants, laws.at[e], factor[k, q], x[k], laws.seen[e])
        if laws.one[e] >= 0:
            taken[laws.one[e]] += flow[k]
        if laws.other[e] >= 0:
            taken[laws.other[e]] -= flow[k]
    for p in range(taken.size):
        z = laws.impedance[low + p]
        if z >= 0.0:
            level[p], rest[n + p] = u[p * stride + q] - z * taken[p], 0.0
            scale = max(scale, abs(u[p * stride + q]), abs(z * taken[p]))
        else:
            level[p], rest[n + p] = x[n + p], laws.seen[first] * (taken[p] - u[p * stride + q])
    for k in range(n):
        e = first + k
        rest[k] = x[k] - laws.seen[e] * flow[k]
        if laws.one[e] >= 0:
            rest[k] -= level[laws.one[e]]
        if laws.other[e] >= 0:
            rest[k] += level[laws.other[e]]
        scale = max(scale, abs(x[k]), abs(laws.seen[e] * flow[k]))
    return scale


@njit(**INNER)
def response(laws, g, low, nodes, slope, rest, system):
    """The linear system of a Newton step: laws first, then what flows into nodes where nothing else conducts."""
    first, count, size = laws.first[g], laws.first[g + 1] - laws.first[g], rest.size
    for i in range(size):
        for j in range(size):
            system[i, j] = 0.0
        system[i, size] = rest[i]
    for k in range(count):
        system[k, k] = max(1.0 - laws.seen[first + k] * slope[k], FAINT)
    for k in range(count):  # what the flow of element k does to each other
        for end, sign in ((laws.one[first + k], 1.0), (laws.other[first + k], -1.0)):
            if end < 0:
                continue
            z = laws.impedance[low + end]
            if z < 0.0:
                system[count + end, k] += laws.seen[first] * sign * slope[k]
                system[k, count + end] -= sign
            else:
                for f in range(count):
                    if laws.one[first + f] == end:
                        system[f, k] += sign * z * slope[k]
                    if laws.other[first + f] == end:
                        system[f, k] -= sign * z * slope[k]
    for p in range(nodes):
        if laws.impedance[low + p] >= 0.0:
            system[count + p, count + p], system[count + p, size] = 1.0, 0.0
        else:
            system[count + p, count + p] += FAINT


@njit(**INNER)
def meet(laws, g, low, nodes, u, stride, n, factor):
    """Several elements that see each other: Newton's method at each of n instants.

    The laws are monotone, so that residuals and unknowns determine each other (a homeomorphism). Where Newton's full
    steps fail, the residual is led from its first value to zero in smaller parts, which must succeed.
    """
    count = laws.first[g + 1] - laws.first[g]
    size = count + nodes
    x, safe, aimed, level = np.zeros(size), np.zeros(size), np.zeros(size), np.zeros(nodes)
    flow, slope, rest, taken = np.empty(count), np.empty(count), np.zeros(size), np.empty(nodes)
    system = np.empty((size, size + 1))
    for q in range(n):
        unbalance(laws, g, low, u, stride, q, factor, x, level, flow, slope, rest, taken)
        copy(rest, aimed)
        done, part = 0.0, 1.0
        while done < 1.0 and part > LEAST_STRIDE:
            aim, before, sound, share = min(done + part, 1.0), np.inf, False, 1.0
            for _ in range(TRIES):
                scale = unbalance(laws, g, low, u, stride, q, factor, x, level, flow, slope, rest, taken)
                now = left_of(rest, aimed, aim)
                sound = now <= SPARE * scale or (now <= CLOSE * scale and now >= 0.5 * before)
                if sound or not np.isfinite(now):
                    break
                share = min(1.0, 2.0 * share) if now < before else 0.5 * share
                before = now
                response(laws, g, low, nodes, slope, rest, system)
                eliminate(system, size)
                reach = scale
                for i in range(size):
                    reach = max(reach, abs(system[i, size]))
                for i in range(size):
                    x[i] -= min(share, FARTHEST * scale / reach) * system[i, size]
            if sound:
                copy(x, safe)
                done, part = aim, 2.0 * part
            else:
                copy(safe, x)
                part *= 0.25
        for p in range(nodes):
            u[p * stride + q] = level[p] if done == 1.0 else np.nan


@njit(**INNER)
def pass_elements(laws, g, low, nodes, states, u, stride, n, factor, tools, h):
    """Turn the Thévenin waves of n samples at a group's nodes into efforts, through its elements."""
    e, dead = laws.first[g], False
    for p in range(nodes):
        dead |= laws.impedance[low + p] < 0.0
    if dead or laws.first[g + 1] - e > 1:
        meet(laws, g, low, nodes, u, stride, n, factor)
        return
    one, other, kind, at, c = laws.one[e], laws.other[e], laws.kind[e], laws.at[e], laws.constants
    z_one = laws.impedance[low + one] if one >= 0 else 0.0
    z_other = laws.impedance[low + other] if other >= 0 else 0.0
    z, here, there, s = z_one + z_other, max(one, 0) * stride, max(other, 0) * stride, tools.c.size
    sign_here, sign_there = (1.0 if one >= 0 else 0.0), (1.0 if other >= 0 else 0.0)
    if laws.state_at[e] < 0:
        for i in range(n):
            v = sign_here * u[here + i] - sign_there * u[there + i]
            flow, _ = through(kind, c, at, factor[0, i], v, z)
            u[here + i] -= z_one * flow
            u[there + i] += z_other * flow
        return
    flows, y, rest, system, v = np.empty(s), np.empty(s), np.empty(s), np.zeros((s, s + 1)), np.empty(s)
    for slab in range(n // s):
        for j in range(s):
            i = slab * s + j
            v[j] = sign_here * u[here + i] - sign_there * u[there + i]
        if kind == VAPOUR:
            boil(laws, e, states, tools, h, v, z, flows)
        elif kind == AIR:
            breathe(laws, e, states, tools, h, v, z, flows, y, rest, system)
        else:
            start = states[laws.state_at[e]]
            fill(laws, e, factor[0, slab * s], states, tools.radau, h, v, z, flows, y, rest, system)
            if kind == GAS and is_missed(laws, e, start, states, tools.radau, h, flows):
                squeeze(laws, e, start, states, tools, h, v, z, flows)
        for j in range(s):
            u[here + slab * s + j] -= z_one * flows[j]
            u[there + slab * s + j] += z_other * flows[j]


@njit(**INNER)
def states_at(laws, e):
    """Number of states of an element."""
    if laws.state_at[e] < 0:
        return 0
    return 2 if laws.kind[e] == AIR else 1


@njit(**INNER)
def pass_elements_at_cells(network, g, states, u, factor, laws, cells):
    """The same for one slab of a group at lines in cells, which feel its efforts at once: until these stay.

    What they add is small, and the smaller the slab.
    """
    low, s = network.group[g], laws.tools.c.size
    nodes, first = network.group[g + 1] - low, laws.first[g]
    size, own = nodes * s, np.zeros((laws.first[g + 1] - first, 2))
    wave, last, change, scale = u[:size].copy(), u[:size].copy(), np.inf, 0.0
    for k in range(own.shape[0]):
        for i in range(states_at(laws, first + k)):
            own[k, i] = states[laws.state_at[first + k] + i]
    for _ in range(STEPS):
        for k in range(own.shape[0]):
            for i in range(states_at(laws, first + k)):
                states[laws.state_at[first + k] + i] = own[k, i]
        for p in range(nodes):
            for i in range(s):
                u[p * s + i] = wave[p * s + i]
            if cells.echo_at[low + p] >= 0:
                add_product(cells.echo, cells.echo_at[low + p], s, s, last, p * s, u, p * s)
        pass_elements(laws, g, low, nodes, states, u, s, s, factor, laws.tools, laws.step)
        change, scale = 0.0, 0.0
        for i in range(size):
            change, scale = max(change, abs(u[i] - last[i])), max(scale, abs(u[i]))
            last[i] = u[i]
        if not change > SPARE * scale:
            return
    if change > CLOSE * scale:
        u[size - 1] = np.nan


@njit(**INNER)
def meet_elements(network, g, states, u, n, factor, laws, cells):
    """Turn the Thévenin waves of n samples at a group with elements into efforts; beside cells n is one slab."""
    low, nodes = network.group[g], network.group[g + 1] - network.group[g]
    if cells is not None:
        if cells.beside[g]:
            pass_elements_at_cells(network, g, states, u, factor, laws, cells)
            return
    pass_elements(laws, g, low, nodes, states, u, n, n, factor, laws.tools, laws.step)


@njit(**INNER)
def opened(laws, g, drive, start, n, factor):
    """What scales the elements of a group at n samples."""
    for k in range(laws.first[g + 1] - laws.first[g]):
        e = laws.first[g] + k
        for i in range(n):
            factor[k, i] = drive[laws.drive_row[e], start + i] if laws.drive_row[e] >= 0 else laws.factor[e]


@njit(**INNER)
def elements_at(laws, g):
    """Number of elements of a group."""
    return 0 if laws is None else laws.first[g + 1] - laws.first[g]


@njit(**INNER)
def most_elements(laws):
    """Most elements of a group."""
    most = 0
    if laws is None:
        return most
    for g in range(laws.first.size - 1):
        most = max(most, laws.first[g + 1] - laws.first[g])
    return most


@njit(**OPTIONS)
def flows_through(laws, factor, v, z):
    """Flow through each element without a state behind an effort and an impedance, and its slope."""
    flow, slope = np.empty(v.size), np.empty(v.size)
    for e in range(v.size):
        flow[e], slope[e] = through(laws.kind[e], laws.constants, laws.at[e], factor[e], v[e], z[e])
    return flow, slope


@njit(**INNER)
def pass_cells(network, cells, state, enter, y):
    """Advance lossy lines in cells by the slab in which the nodes have just worked.

    At an end K is what comes back at once: w = y + K o arrives while o leaves, ŷ = R y with R = 1/(1 + K), and with
    r = 2u - ŷ in the buffer o = r - Q (r + ŷ), Q = R K. Where cells meet, a and b leave them, and X a + Y b and
    X b + Y a enter, with X = 1/(1 - K²) and Y = X K.
    """
    waves, values, s = state.waves, state.cells, state.before.shape[1]
    for r in range(cells.line.size):
        line, D, m, x0 = cells.line[r], cells.number[r], cells.held[r], cells.state[r]
        each, maps, at = m + 2 * s, cells.maps, cells.at[r]
        ends = x0 + D * each
        into = at + each * m
        X = into + each * 2 * s
        Y, R, Q = X + s * s, X + 2 * s * s, X + 3 * s * s
        for i in range(2 * s * D):
            enter[i] = 0.0
        for end in range(2):
            o, here = 2 * s * (D - 1) + s if end else 0, network.offset[line] + (state.side[line] ^ end) * s
            for i in range(s):
                enter[o + i] = waves[here + i]
                y[i] = enter[o + i] + values[ends + end * s + i]
            for j in range(s):
                for i in range(s):
                    enter[o + i] -= maps[Q + j * s + i] * y[j]
        for c in range(D - 1):
            a, b = x0 + c * each + m, x0 + (c + 1) * each + m + s
            add_product(maps, X, s, s, values, a, enter, 2 * s * (c + 1))
            add_product(maps, Y, s, s, values, b, enter, 2 * s * (c + 1))
            add_product(maps, X, s, s, values, b, enter, 2 * s * c + s)
            add_product(maps, Y, s, s, values, a, enter, 2 * s * c + s)
        for c in range(D):
            x = x0 + c * each
            for i in range(each):
                y[i] = 0.0
            add_product(maps, into, each, 2 * s, enter, 2 * s * c, y, 0)
            add_product(maps, at, each, m, values, x, y, 0)
            for i in range(each):
                values[x + i] = 0.0 if abs(y[i]) < TINY else y[i]
        for end in range(2):
            o, there = (
                x0 + (D - 1) * each + m if end else x0 + m + s,
                network.offset[line] + (1 - state.side[line] ^ end) * s,
            )
            for i in range(s):
                values[ends + end * s + i] = 0.0
            add_product(maps, R, s, s, values, o, values, ends + end * s)
            for i in range(s):
                waves[there + i] = values[ends + end * s + i]


@njit(**INNER)
def scratch_of_cells(cells, s):
    """Room for what enters the cells of a line, and for what one holds and what leaves it."""
    number, held = 0, 0
    if cells is None:
        return np.empty(0), np.empty(0)
    for r in range(cells.line.size):
        number, held = max(number, cells.number[r]), max(held, cells.held[r])
    return np.empty(2 * s * number), np.empty(held + 2 * s)


@njit(inline="always", **OPTIONS)
def passing(t, p, ring):
    """Where in a line's ring the slabs stand that meet p half slabs from end 1, in slab t or half a slab later."""
    a, b = t - (p >> 1), t + ((p + 1) >> 1)
    if a < 0:
        a += ring
    if b >= ring:
        b -= ring
    return a, b


@njit(inline="always", **OPTIONS)
def looked_up(entries, at, size):
    """Share e/w of a wave of some size, from a table over its logarithm."""
    n = int(entries[at + 2])
    x = (np.log2(max(size, TINY)) - entries[at]) * entries[at + 1]
    x = min(max(x, 0.0), n - 1.0)
    k = min(int(x), n - 2)
    part = x - k
    return (1.0 - part) * entries[at + 3 + k] + part * entries[at + 4 + k]


@njit(inline="always", **OPTIONS)
def taken(kind, c, w):
    """What a lump without a table takes of a wave."""
    if kind == CONSTANT:
        return c * w
    v = c * abs(w)
    root = 1.0 + np.sqrt(1.0 + v)
    return w * v / (root * root)


@njit(**INNER)
def dissipate(waves, o, s, ring, t, m, place, strength, entries, at, sign, kind):
    """Take away what lumps without memory dissipate of m slabs, lump by lump."""
    for k in range(place.size):
        done = 0
        while done < m:
            a, b = passing(t + done, place[k], ring)
            n = min(m - done, ring - a, ring - b)
            done += n
            a, b, n, c = uint64(o + a * s), uint64(o + b * s), uint64(n * s), strength[k]
            for i in range(n):
                w = waves[a + i] + sign * waves[b + i]
                loss = taken(kind, c, w) if kind < TABLED else w * looked_up(entries, at, abs(w))
                waves[a + i] -= loss
                waves[b + i] -= sign * loss


@njit(**INNER)
def dissipate_abreast(waves, a, b, n, s, strength, first, sign, kind, pair, each):
    """The same at n neighbouring lumps in one slab: of s samples, at places a, a - s, ... and b, b + s, ..."""
    n, s, first = uint64(n), uint64(s), uint64(first)
    if n * s < FEW:
        for k in range(n):
            for i in range(s):
                p, q = a + i - k * s, b + i + k * s
                loss = taken(kind, strength[first + k], waves[p] + sign * waves[q])
                waves[p] -= loss
                waves[q] -= sign * loss
        return
    for i in range(s):
        for k in range(n):
            pair[k * s + i], each[k * s + i] = waves[a + i - k * s], strength[first + k]
    for i in range(n * s):
        pair[i] = taken(kind, each[i], pair[i] + sign * waves[b + i])
        waves[b + i] -= sign * pair[i]
    for i in range(s):
        for k in range(n):
            waves[a + i - k * s] -= pair[k * s + i]


@njit(**INNER)
def remember(lumps, r, waves, o, s, ring, t, m, memory, w, out):
    """Advance the circuits of a row by m slabs, some lumps at a time."""
    low, high, modes, sign = lumps.first[r], lumps.first[r + 1], lumps.modes[r], lumps.sign[r]
    direct = lumps.at[r]
    read, write, decay = direct + s * s, direct + s * s + s * modes, direct + s * s + 2 * s * modes
    entries, count = lumps.entries, high - low
    while low < high:
        n = min(high - low, ABREAST)
        state = lumps.memory[r] + low - lumps.first[r]
        for slab in range(t, t + m):
            for j in range(n):
                a, b = passing(slab, lumps.place[low + j], ring)
                a, b = o + a * s, o + b * s
                for i in range(s):
                    w[i * ABREAST + j] = waves[a + i] + sign * waves[b + i]
            for i in range(s):
                for j in range(n):
                    out[i * ABREAST + j] = 0.0
                for q in range(s):
                    share = entries[direct + i * s + q]
                    for j in range(n):
                        out[i * ABREAST + j] += share * w[q * ABREAST + j]
            for k in range(modes):
                x = uint64(state + k * count)
                for i in range(s):
                    share = entries[read + i * modes + k]
                    for j in range(uint64(n)):
                        out[i * ABREAST + j] += share * memory[x + j]
                share = entries[decay + k]
                for j in range(uint64(n)):
                    memory[x + j] *= share
                for i in range(s):
                    share = entries[write + k * s + i]
                    for j in range(uint64(n)):
                        memory[x + j] += share * w[i * ABREAST + j]
                for j in range(uint64(n)):
                    memory[x + j] = 0.0 if abs(memory[x + j]) < TINY else memory[x + j]
            for j in range(n):
                a, b = passing(slab, lumps.place[low + j], ring)
                a, b = o + a * s, o + b * s
                for i in range(s):
                    waves[a + i] -= out[i * ABREAST + j]
                    waves[b + i] -= sign * out[i * ABREAST + j]
        low += n


@njit(**OPTIONS)
def lose(network, lumps, rows, state, m, w, out):
    """Let those rows of lumps take what is theirs of m slabs, no more than the gaps between them."""
    waves, s = state.waves, state.before.shape[1]
    place, strength, entries = lumps.place, lumps.strength, lumps.entries
    for r in rows:
        line, low, high, kind, sign, at = (
            lumps.line[r], lumps.first[r], lumps.first[r + 1], lumps.kind[r], lumps.sign[r], lumps.at[r],
        )  # fmt: skip
        o, ring = network.offset[line], 2 * network.delay[line]
        t = state.side[line] * network.delay[line] + state.slot[line]
        if kind > TABLED:
            remember(lumps, r, waves, o, s, ring, t, m, state.lumps, w, out)
        elif m == 1 and kind != TABLED and place[high - 1] - place[low] == 2 * (high - 1 - low):
            while low < high:
                a, b = passing(t, place[low], ring)
                n = min(high - low, a + 1, ring - b, ABREAST)
                a, b = uint64(o + a * s), uint64(o + b * s)
                dissipate_abreast(waves, a, b, n, s, strength, low, sign, kind, w, out)
                low += n
        else:
            dissipate(waves, o, s, ring, t, m, place[low:high], strength[low:high], entries, at, sign, kind)


@njit(**INNER)
def largest_group(network):
    """Most nodes of a group, and most states of a map over a slab."""
    nodes, states = 1, 0
    for g in range(network.group.size - 1):
        nodes = max(nodes, network.group[g + 1] - network.group[g])
    for r in range(network.step_states.size):
        states = max(states, network.step_states[r])
    return nodes, states


def parted(network):
    """A network without elements, cells and lumps, and these, or None: what a scene has not is not compiled.

    But pipes with lumps mostly have elements, and those with elements lumps, so both are compiled together.
    """
    laws, cells, lumps = network.laws, network.cells, network.lumps
    either = laws.kind.size or lumps.line.size
    return (
        network._replace(laws=None, cells=None, lumps=None),
        laws if either else None,
        cells if cells.line.size else None,
        lumps if either else None,
    )


@njit(**INNER)
def are_lumped(lumps):
    """Whether losses are lumped inside lines."""
    return False if lumps is None else lumps.line.size > 0


def advance(network, state, n_slabs, drive, record, column):
    """Advance all nodes by n_slabs, writing the record from the given column (in slabs) on.

    Returns -1, or the number of a node whose effort is no longer finite; the number after the last node's if a wave
    under way is not.
    """
    network, *others = parted(network)
    return advance_blocks(network, state, n_slabs, drive, record, column, *others)


@njit(**OPTIONS)
def advance_blocks(network, state, n_slabs, drive, record, column, laws, cells, lumps):
    """The same; the network has its laws, cells and lumps beside it, or None."""
    node = pass_blocks(
        borrowed(network), borrowed(state), int64(0), n_slabs, borrowed(drive), borrowed(record), column,
        borrowed(laws), borrowed(cells), borrowed(lumps),
    )  # fmt: skip
    if node < 0:
        for w in state.waves:
            if not np.isfinite(w):
                return network.first.size - 1
    return node


@njit(**INNER)
def turn(network, state, lines, count):
    """Let so many slabs pass on some lines."""
    delay, slots = network.delay, state.slot
    for line in lines:
        slots[line] += count
        if slots[line] >= delay[line]:
            slots[line] -= delay[line]
            state.side[line] = 1 - state.side[line]


@njit(**INNER)
def pass_blocks(network, state, k, n_slabs, drive, record, column, laws, cells, lumps):
    """Advance all nodes by n_slabs, from slab k of the drive and of the record's part that begins in the column.

    Far nodes go a stride. Then the others follow in steps; near lines pass on meanwhile, and far lines wait.
    Returns -1, or the number of a node whose effort is no longer finite.
    """
    delay, offset, first, ends, group = network.delay, network.offset, network.first, network.ends, network.group
    shift_row, shifts, weight, drive_row = network.shift_row, network.shift, network.weight, network.drive_row
    load_at, step_row, step_at, step = network.load_at, network.step_row, network.step_at, network.step
    step_states, record_row, blocks = network.step_states, network.record_row, network.blocks
    waves, slots, sides, before, states = state.waves, state.slot, state.side, state.before, state.load
    s = before.shape[1]
    tile = max(SCRATCH // s, 1)
    most_nodes, most_states = largest_group(network)
    u, history = np.empty(most_nodes * tile * s), np.empty((s, tile + 1))
    scratch = np.empty(max(tile, most_nodes * s + most_states))
    factor = np.empty((most_elements(laws), tile * s))
    position = np.empty(ends.size, np.uint64)
    enter, y = scratch_of_cells(cells, s)
    w, out = np.empty(s * ABREAST), np.empty(s * ABREAST)
    done = int64(0)
    while done < n_slabs:
        block, begun, far = min(blocks.stride, n_slabs - done), int64(0), True
        while begun < block:
            groups = blocks.far_groups if far else blocks.near_groups
            count = block if far else min(blocks.step, block - begun)
            for g in groups:
                one, after, ahead = group[g], group[g + 1], 0
                low, high = first[one], first[after]
                while ahead < count:
                    m = min(count - ahead, tile)
                    for e in range(low, high):
                        line = ends[e] >> 1
                        slot, side = slots[line] + ahead, sides[line] ^ (ends[e] & 1)
                        if blocks.waits[line]:
                            slot += begun
                        if slot >= delay[line]:
                            slot, side = slot - delay[line], 1 - side
                        m = min(m, delay[line] - slot)
                        position[e] = offset[line] + (side * delay[line] + slot) * s
                    here = (k + done + begun + ahead) * s
                    for node in range(one, after):
                        q = uint64((node - one) * m * s)
                        begin(u, q, m * s, drive, drive_row[node], here)
                        for e in range(first[node], first[node + 1]):
                            row = shift_row[ends[e] >> 1]
                            if row >= 0:
                                shift(waves, position[e], m, before, ends[e], shifts, row, history, scratch)
                            gather(u, q, m * s, waves, position[e], weight[e])
                    if load_at[g] >= 0:
                        r = step_row[g]
                        load(u, after - one, m, s, step, step_at[r], states, load_at[g], step_states[r], scratch)
                    if laws is not None:
                        if laws.first[g] < laws.first[g + 1]:
                            opened(laws, g, drive, here, m * s, factor)
                            meet_elements(network, g, states, u, m * s, factor, laws, cells)
                    for node in range(one, after):
                        q = uint64((node - one) * m * s)
                        for e in range(first[node], first[node + 1]):
                            if record_row[ends[e]] >= 0:
                                note(u, q, m * s, waves, position[e], record, record_row[ends[e]], column * s + here)
                            scatter(u, q, m * s, waves, position[e])
                        if not np.isfinite(u[q + uint64(m * s - 1)]):
                            return node
                    ahead += m
            if not far:
                if lumps is not None:
                    lose(network, lumps, blocks.near_rows, state, count, w, out)
                if cells is not None:
                    pass_cells(network, cells, state, enter, y)
                turn(network, state, blocks.near_lines, count)
                begun += count
            far = False
        if lumps is not None:
            lose(network, lumps, blocks.far_rows, state, block, w, out)
        turn(network, state, blocks.far_lines, block)
        done += block
    return -1


# Slabs with fronts inside. They are few, so plain calls do; a polynomial is held by its Legendre coefficients here.

MERGE = 1e-11  # slabs; fronts nearer than this to each other are one
SAME = 1e-13  # of the largest wave; pieces that continue each other so well need no breakpoint
LIVE, PEAK, MERGED, DISSOLVED, DROPPED, NOTED = range(6)
SCALE, LOST = range(2)


@njit(**INNER)
def series(coef, y):
    """Sum of a Legendre series at y, -1 to 1."""
    total, last, here = coef[0], 1.0, y
    for k in range(1, coef.size):
        total += coef[k] * here
        last, here = here, ((2 * k + 1) * y * here - k * last) / (k + 1)
    return total


@njit(**INNER)
def project(coef, a, b, p, q, gauss, out):
    """Add to the projection on [p, q] what a polynomial on [a, b] has there; a restriction is exact."""
    low, high = max(a, p), min(b, q)
    if high <= low:
        return
    for i in range(gauss.shape[1]):
        t = low + (high - low) * gauss[0, i]
        value = gauss[1, i] * (high - low) / (q - p) * series(coef, 2.0 * (t - a) / (b - a) - 1.0)
        y = 2.0 * (t - p) / (q - p) - 1.0
        out[0] += value
        last, here = 1.0, y
        for k in range(1, out.size):
            out[k] += (2 * k + 1) * value * here
            last, here = here, ((2 * k + 1) * y * here - k * last) / (k + 1)


@njit(**INNER)
def clear(out):
    """Set to zero; loops like this one compile many times faster than array expressions."""
    for i in range(out.size):
        out[i] = 0.0


@njit(**INNER)
def copy(values, out):
    """Copy as many values as there is room for."""
    for i in range(out.size):
        out[i] = values[i]


@njit(**INNER)
def distance(one, other):
    """Sum of the absolute differences."""
    total = 0.0
    for i in range(one.size):
        total += abs(one[i] - other[i])
    return total


@njit(**INNER)
def weakest(size, low, high):
    """Index of the least of some values."""
    best = low
    for i in range(low, high):
        if size[i] < size[best]:
            best = i
    return best


@njit(**INNER)
def times(matrix, values, o, out):
    """Product of a matrix with a part of an array."""
    for i in range(out.size):
        total = 0.0
        for j in range(out.size):
            total += matrix[i, j] * values[o + j]
        out[i] = total


@njit(**INNER)
def joined(left, right, a, mid, b, gauss, whole, part):
    """Project two pieces on their union; returns what that changes in the wider one, and in the other."""
    clear(whole)
    project(left, a, mid, a, b, gauss, whole)
    project(right, mid, b, a, b, gauss, whole)
    clear(part)
    project(whole, a, b, a, mid, gauss, part)
    on_left = distance(part, left)
    clear(part)
    project(whole, a, b, mid, b, gauss, part)
    on_right = distance(part, right)
    return (on_left, on_right) if mid - a >= b - mid else (on_right, on_left)


@njit(**INNER)
def front_size(left, right, a, mid, b, least, gauss, whole, part):
    """Damage that joining two pieces would do to the wider one; of a plain jump, a quick estimate of it.

    Zero if they continue each other, so that neither would suffer.
    """
    jump, sign = 0.0, 1.0
    for k in range(left.size):
        jump += sign * right[k] - left[k]
        sign = -sign
    if abs(jump) > least:
        return abs(jump) * min(mid - a, b - mid) / (b - a)
    on_wider, on_other = joined(left, right, a, mid, b, gauss, whole, part)
    return max(on_wider, TINY) if max(on_wider, on_other) > least else 0.0


@njit(**INNER)
def fronts_in(pieces, row, offset, place, size, n):
    """Append those fronts of a slab that lie in the present one when moved by the offset."""
    if row < 0:
        return n
    for j in range(pieces.number[row]):
        t = pieces.start[row, j] + offset
        strength = pieces.anew[row] if j == 0 else pieces.size[row, j]
        if strength > 0.0 and -MERGE / 2 <= t < 1.0 - MERGE / 2 and n < place.size:
            place[n], size[n] = t, strength
            n += 1
    return n


@njit(**INNER)
def united(place, size, n, edges, most, counts, sizes):
    """Edges of the pieces between n fronts. Returns how many pieces, and the size of a front at the start."""
    for i in range(1, n):
        t, strength, j = place[i], size[i], i
        while j > 0 and place[j - 1] > t:
            place[j], size[j] = place[j - 1], size[j - 1]
            j -= 1
        place[j], size[j] = t, strength
    anew, kept = 0.0, 0
    for i in range(n):
        if place[i] < MERGE:
            counts[MERGED] += anew > 0.0
            anew = max(anew, size[i])
        elif kept > 0 and place[i] - place[kept - 1] < MERGE:
            counts[MERGED] += 1
            size[kept - 1] = max(size[kept - 1], size[i])
        else:
            place[kept], size[kept] = place[i], size[i]
            kept += 1
    while kept >= most:
        j = weakest(size, 0, kept)
        counts[DROPPED] += 1
        sizes[LOST] = max(sizes[LOST], size[j])
        for i in range(j, kept - 1):
            place[i], size[i] = place[i + 1], size[i + 1]
        kept -= 1
    edges[0] = 0.0
    for i in range(kept):
        edges[i + 1] = place[i]
    edges[kept + 1] = 1.0
    return kept + 1, anew


@njit(**INNER)
def unfold(pieces, row, values, o, to_legendre, offset, span, coef, n):
    """Append the pieces of a slab that lie in the present one when moved by the offset."""
    if row < 0:
        span[n, 0], span[n, 1] = offset, offset + 1.0
        times(to_legendre, values, o, coef[n])
        return n + 1
    for j in range(pieces.number[row]):
        a, b = pieces.start[row, j] + offset, pieces.start[row, j + 1] + offset
        if b > 0.0 and a < 1.0:
            span[n, 0], span[n, 1] = a, b
            copy(pieces.coef[row, j], coef[n])
            n += 1
    return n


@njit(**INNER)
def regrouped(span, coef, n, edges, m, tools, whole, out):
    """Values at the points of m pieces of a wave that is given in n others: restricted, or projected."""
    i = 0
    for k in range(m):
        while i < n - 1 and span[i, 1] <= edges[k]:
            i += 1
        clear(whole)
        j = i
        while j < n and span[j, 0] < edges[k + 1]:
            project(coef[j], span[j, 0], span[j, 1], edges[k], edges[k + 1], tools.gauss, whole)
            j += 1
        times(tools.to_points, whole, 0, out[k])


@njit(**INNER)
def collocate(system, k, h, radau, w, x, stages, row):
    """One Radau IIA step of width h of dx/dt = A x + B w, for k inputs; w becomes C x + D w, x the state at the end."""
    s, n = radau.shape[0], system.shape[0] - k
    size = s * n
    for i in range(s):
        for p in range(n):
            at = i * n + p
            stages[at, size] = x[p]
            for j in range(s):
                for q in range(k):
                    stages[at, size] += h * radau[i, j] * system[p, n + q] * w[q * s + j]
                for q in range(n):
                    stages[at, j * n + q] = (i == j and p == q) - h * radau[i, j] * system[p, q]
    eliminate(stages, size)
    for i in range(s):
        for p in range(k):
            row[p] = 0.0
            for q in range(n):
                row[p] += system[n + p, q] * stages[i * n + q, size]
            for q in range(k):
                row[p] += system[n + p, n + q] * w[q * s + i]
        for p in range(k):
            w[p * s + i] = row[p]
    for p in range(n):
        x[p] = stages[(s - 1) * n + p, size]


@njit(**INNER)
def settling(fronts, g, slab, m, anew):
    """Add breakpoints where the group has settled after fronts; in `outer` leave out those that arrive before that.

    Marks the pieces in which it settles. Returns the number of pieces with all breakpoints, and without those left out.
    """
    edges, outer, unsettled, given = fronts.room.edges, fronts.room.outer, fronts.room.unsettled, fronts.room.size
    until, n, kept, outer[0] = fronts.settled[g] - slab, 0, 0, 0.0
    for i in range(1, m + 1):
        given[i] = edges[i]
    if anew > 0.0:
        until = fronts.settle[g]
    for i in range(1, m + 1):
        at = given[i]
        unsettled[n] = until > edges[n] + MERGE
        if MERGE < until < at - MERGE and n + 2 < fronts.at_node:
            n, kept = n + 1, kept + 1
            edges[n], outer[kept], unsettled[n] = until, until, False
        if i < m and n + 2 < fronts.at_node:
            n += 1
            edges[n] = at
            if at > until + MERGE:
                kept += 1
                outer[kept] = at
            until = at + fronts.settle[g]
        elif i < m:
            fronts.counts[DROPPED] += 1
    edges[n + 1], outer[kept + 1] = 1.0, 1.0
    fronts.settled[g] = slab + until
    return n + 1, kept + 1


@njit(**INNER)
def rejoin(values, edges, n, outer, m, tools, span, coef, whole):
    """Project n pieces on m wider ones."""
    for j in range(n):
        span[j, 0], span[j, 1] = edges[j], edges[j + 1]
        times(tools.to_legendre, values[j], 0, coef[j])
    regrouped(span, coef, n, outer, m, tools, whole, values)


@njit(**INNER)
def collocate_finely(system, k, width, settle, fronts, x):
    """The same in steps as long as a group settles, and a last one, in slabs; the effort is projected."""
    tools, s, w, stages, row = fronts.tools, fronts.tools.c.size, fronts.room.wave, fronts.room.stages, fronts.room.row
    span, coef, whole, steps = fronts.room.span, fronts.room.given, fronts.room.whole, fronts.room.steps
    edges, values, flat, out = steps.edges, steps.values, steps.wave, steps.out
    most, m = edges.size - 2, 1
    while m <= most and m * settle < most * (width - MERGE):
        edges[m] = m * settle / (most * width)
        m += 1
    edges[0], edges[m] = 0.0, 1.0
    for p in range(k):
        span[0, 0], span[0, 1] = 0.0, 1.0
        times(tools.to_legendre, w, p * s, coef[0])
        regrouped(span, coef, int64(1), edges, m, tools, whole, values[p])
    for j in range(m):
        for p in range(k):
            for i in range(s):
                flat[p * s + i] = values[p, j, i]
        h = fronts.step * width * (edges[j + 1] - edges[j])
        collocate(system, k, h, tools.radau, flat, x, stages, row)
        for p in range(k):
            for i in range(s):
                values[p, j, i] = flat[p * s + i]
    for p in range(k):
        for j in range(m):
            span[j, 0], span[j, 1] = edges[j], edges[j + 1]
            times(tools.to_legendre, values[p, j], 0, coef[j])
        regrouped(span, coef, m, steps.ends, int64(1), tools, whole, out)
        for i in range(s):
            w[p * s + i] = out[0, i]


@njit(**INNER)
def respond(network, state, fronts, g, slab, m, laws):
    """Turn the Thévenin waves of m pieces at a group into the nodes' efforts; switches move where pieces begin."""
    systems, moves, room, s = fronts.systems, fronts.moves, fronts.room, fronts.tools.c.size
    edges, u, wave, opening = room.edges, room.u, room.wave, room.opening
    count = elements_at(laws, g)
    x, k = network.load_at[g], network.group[g + 1] - network.group[g]
    for piece in range(m):
        while moves.due[g] < moves.first[g + 1] and moves.at[moves.due[g]] - slab <= edges[piece] + MERGE:
            network.step_row[g] = moves.row[moves.due[g]]
            moves.due[g] += 1
        if x < 0 and count == 0:
            continue
        for p in range(k):
            for i in range(s):
                wave[p * s + i] = u[p, piece, i]
        if count > 0:
            for e in range(count):
                copy(room.factor[e, piece], opening[e])
            width = fronts.step * (edges[piece + 1] - edges[piece])
            if laws is not None:
                pass_elements(laws, g, network.group[g], k, state.load, wave, s, s, opening, fronts.tools, width)
            for p in range(k):
                for i in range(s):
                    u[p, piece, i] = wave[p * s + i]
            continue
        r = network.step_row[g]
        n = network.step_states[r]
        if m == 1:
            load(wave, k, 1, s, network.step, network.step_at[r], state.load, x, n, room.row)
        else:
            width, states = edges[piece + 1] - edges[piece], state.load[x : x + n]
            system = systems.entries[systems.at[r] : systems.at[r] + (n + k) ** 2].reshape((n + k, n + k))
            if not room.unsettled[piece]:
                collocate(system, k, fronts.step * width, fronts.tools.radau, wave, states, room.stages, room.row)
            elif abs(width - fronts.settle[g]) < MERGE:
                load(wave, k, 1, s, systems.settling, systems.settling_at[r], state.load, x, n, room.row)
            else:
                collocate_finely(system, k, width, fronts.settle[g], fronts, states)
        for p in range(k):
            for i in range(s):
                u[p, piece, i] = wave[p * s + i]


@njit(**INNER)
def release(pieces, row, counts):
    """Give a row back."""
    if row >= 0:
        counts[LIVE] -= 1
        pieces.free[counts[LIVE]] = row


@njit(**INNER)
def thinned(fronts, m, most):
    """Take away breakpoints that are not needed, then the weakest beyond the number allowed. Returns pieces left."""
    counts, sizes, gauss, room = fronts.counts, fronts.sizes, fronts.tools.gauss, fronts.room
    edges, coef, size, whole, part = room.own, room.coef, room.size, room.whole, room.part
    least, kept = SAME * sizes[SCALE], 0
    for k in range(1, m):
        strength = front_size(coef[kept], coef[k], edges[kept], edges[k], edges[k + 1], least, gauss, whole, part)
        if strength == 0.0:
            copy(whole, coef[kept])
            counts[DISSOLVED] += 1
        else:
            kept += 1
            copy(coef[k], coef[kept])
            edges[kept], size[kept] = edges[k], strength
        edges[kept + 1] = edges[k + 1]
    m = kept + 1
    while m > most:
        j = weakest(size, 1, m)
        most_off = max(joined(coef[j - 1], coef[j], edges[j - 1], edges[j], edges[j + 1], gauss, whole, part))
        copy(whole, coef[j - 1])
        counts[DROPPED] += 1
        sizes[LOST] = max(sizes[LOST], most_off)
        for k in range(j, m - 1):
            size[k] = size[k + 1]
            copy(coef[k + 1], coef[k])
        for k in range(j, m):
            edges[k] = edges[k + 1]
        m -= 1
    return m


@njit(**INNER)
def send(fronts, e, waves, m, anew):
    """Put a wave of m pieces on a line."""
    pieces, tools, counts, sizes, room = fronts.pieces, fronts.tools, fronts.counts, fronts.sizes, fronts.room
    edges, coef, size, whole, part, o = room.own, room.coef, room.size, room.whole, room.part, room.position[e]
    if anew > 0.0 and pieces.width[e] > 0.0:
        least = SAME * sizes[SCALE]
        times(tools.to_legendre, pieces.last[e], 0, coef[m])
        anew = front_size(coef[m], coef[0], -pieces.width[e], 0.0, edges[1], least, tools.gauss, whole, part)
        counts[DISSOLVED] += anew == 0.0
    times(tools.to_points, coef[m - 1], 0, pieces.last[e])
    pieces.width[e] = 1.0 - edges[m - 1]
    most = fronts.most if counts[LIVE] < pieces.free.size else 1
    m = thinned(fronts, m, most)
    if anew > 0.0 and most == 1:
        counts[DROPPED] += 1
        sizes[LOST] = max(sizes[LOST], anew)
        anew = 0.0
    if m == 1 and anew == 0.0:
        times(tools.to_points, coef[0], 0, whole)
        for i in range(whole.size):
            waves[o + i] = 0.0 if abs(whole[i]) < TINY else whole[i]
        return
    row = pieces.free[counts[LIVE]]
    counts[LIVE] += 1
    counts[PEAK] = max(counts[PEAK], counts[LIVE])
    pieces.of_slab[o // whole.size] = row
    pieces.number[row], pieces.anew[row] = m, anew
    pieces.start[row, m] = 1.0
    for k in range(m):
        pieces.start[row, k], pieces.size[row, k] = edges[k], size[k]
        copy(coef[k], pieces.coef[row, k])
    for i in range(whole.size):
        waves[o + i] = 0.0


@njit(**INNER)
def keep(fronts, record, row, slab, m, arrived, u):
    """Record m pieces, and their values at the points of the slab."""
    log, edges, whole, point = fronts.log, fronts.room.edges, fronts.room.whole, fronts.room.part
    s = whole.size
    for side in range(2):
        k = 0
        for i in range(s):
            while k < m - 1 and edges[k + 1] < fronts.tools.c[i]:
                k += 1
            for j in range(s):
                point[j] = arrived[k, j] if side == 0 else 2.0 * u[k, j] - arrived[k, j]
            times(fronts.tools.to_legendre, point, 0, whole)
            y = 2.0 * (fronts.tools.c[i] - edges[k]) / (edges[k + 1] - edges[k]) - 1.0
            record[row, side, slab * s + i] = series(whole, y)
    for k in range(m if m > 1 else 0):
        at = fronts.counts[NOTED]
        log.where[at, 0], log.where[at, 1] = row, slab
        log.span[at, 0], log.span[at, 1] = edges[k], edges[k + 1]
        for j in range(s):
            log.values[at, 0, j] = arrived[k, j]
            log.values[at, 1, j] = 2.0 * u[k, j] - arrived[k, j]
        fronts.counts[NOTED] += 1


@njit(**INNER)
def fronts_at(network, fronts, sources, g, slab):
    """Gather the fronts that meet at a group in one slab. Returns how many."""
    pieces, moves, position, n = fronts.pieces, fronts.moves, fronts.room.position, int64(0)
    place, size = fronts.room.place, fronts.room.size
    for i in range(network.first[network.group[g]], network.first[network.group[g + 1]]):
        e = network.ends[i]
        rest = fronts.rest[e >> 1]
        n = fronts_in(pieces, pieces.of_slab[position[e] // fronts.tools.c.size], rest, place, size, n)
        if rest > 0.0:
            n = fronts_in(pieces, pieces.before[e], rest - 1.0, place, size, n)
    i = moves.due[g]
    while i < moves.first[g + 1] and moves.at[i] - slab < 1.0 - MERGE / 2 and n < place.size:
        place[n], size[n] = max(moves.at[i] - slab, 0.0), np.inf
        i, n = i + 1, n + 1
    for i in range(fronts.drives.first[g], fronts.drives.first[g + 1]):
        n = fronts_of_source(sources, fronts.drives.row[i], slab, place, size, n)
    return n


@njit(**INNER)
def fronts_of_source(sources, r, slab, place, size, n):
    """Append those of a source, or of what scales an element."""
    if drives_front(sources, r, slab):
        now = sources.due[r]
        for j in range(sources.begin[now], sources.begin[now + 1]):
            if n < place.size and (sources.start[j] > 0.0 or sources.anew[now]):
                place[n], size[n] = sources.start[j], np.inf
                n += 1
    return n


@njit(**INNER)
def drives_front(sources, r, slab):
    """Whether a source has a front in the slab."""
    return sources.due[r] < sources.first[r + 1] and sources.slab[sources.due[r]] == slab


@njit(**INNER)
def driven(sources, drive, r, slab, o, to_legendre, span, given):
    """The sources' part of a Thévenin wave, as pieces. Returns how many."""
    if not drives_front(sources, r, slab):
        span[0, 0], span[0, 1] = 0.0, 1.0
        times(to_legendre, drive[r], o, given[0])
        return int64(1)
    first = sources.begin[sources.due[r]]
    n = sources.begin[sources.due[r] + 1] - first
    for j in range(n):
        span[j, 0], span[j, 1] = sources.start[first + j], sources.stop[first + j]
        copy(sources.coef[first + j], given[j])
    return n


@njit(**INNER)
def scatter_pieces(network, state, fronts, sources, drive, g, slab, k, record, laws):
    """One group, one slab, in pieces. Returns the sum of the efforts at the slab's end."""
    waves, before, pieces, tools, room = state.waves, state.before, fronts.pieces, fronts.tools, fronts.room
    position, edges, outer, u, arrived = room.position, room.edges, room.outer, room.u, room.arrived
    span, given, coef, whole, part = room.span, room.given, room.coef, room.whole, room.part
    s, low, total = before.shape[1], network.first[network.group[g]], 0.0
    n = fronts_at(network, fronts, sources, g, slab)
    m, anew = united(room.place, room.size, n, edges, fronts.at_node, fronts.counts, fronts.sizes)
    fewer = 0
    if fronts.settle[g] > 0.0:
        m, fewer = settling(fronts, g, slab, m, anew)
    if not fronts.fractional:
        anew = 0.0
    for node in range(network.group[g], network.group[g + 1]):
        mine, r = u[node - network.group[g]], network.drive_row[node]
        if r >= 0:
            n = driven(sources, drive, r, slab, k * s, tools.to_legendre, span, given)
            regrouped(span, given, n, edges, m, tools, whole, mine)
        else:
            for j in range(m):
                clear(mine[j])
        for i in range(network.first[node], network.first[node + 1]):
            e = network.ends[i]
            rest, now = fronts.rest[e >> 1], pieces.of_slab[position[e] // s]
            n = int64(0)
            if rest > 0.0:
                n = unfold(pieces, pieces.before[e], before[e], 0, tools.to_legendre, rest - 1.0, span, given, n)
            n = unfold(pieces, now, waves, position[e], tools.to_legendre, rest, span, given, n)
            regrouped(span, given, n, edges, m, tools, whole, arrived[i - low])
            pieces.of_slab[position[e] // s] = -1
            if rest > 0.0:
                release(pieces, pieces.before[e], fronts.counts)
                pieces.before[e] = now
                for j in range(s):
                    before[e, j] = waves[position[e] + j]
            else:
                release(pieces, now, fronts.counts)
            for j in range(m):
                for p in range(s):
                    mine[j, p] += network.weight[i] * arrived[i - low, j, p]
    if laws is not None:
        for i in range(laws.first[g], laws.first[g + 1]):
            mine, r = room.factor[i - laws.first[g]], laws.drive_row[i]
            if r >= 0:
                n = driven(sources, drive, r, slab, k * s, tools.to_legendre, span, given)
                regrouped(span, given, n, edges, m, tools, whole, mine)
            else:
                for j in range(m):
                    for p in range(s):
                        mine[j, p] = laws.factor[i]
    respond(network, state, fronts, g, slab, m, laws)
    if 0 < fewer < m:
        for node in range(network.group[g], network.group[g + 1]):
            rejoin(u[node - network.group[g]], edges, m, outer, fewer, tools, span, given, whole)
            for i in range(network.first[node], network.first[node + 1]):
                rejoin(arrived[i - low], edges, m, outer, fewer, tools, span, given, whole)
        m = fewer
        copy(outer, edges)
    for node in range(network.group[g], network.group[g + 1]):
        mine = u[node - network.group[g]]
        for i in range(network.first[node], network.first[node + 1]):
            e = network.ends[i]
            if network.record_row[e] >= 0:
                keep(fronts, record, network.record_row[e], slab, m, arrived[i - low], mine)
            for j in range(m):
                for p in range(s):
                    part[p] = 2.0 * mine[j, p] - arrived[i - low, j, p]
                    fronts.sizes[SCALE] = max(fronts.sizes[SCALE], abs(part[p]))
                times(tools.to_legendre, part, 0, coef[j])
            copy(edges, room.own)
            send(fronts, e, waves, m, anew)
        total += mine[m - 1, s - 1]
    return total


@njit(**INNER)
def scatter_whole(network, state, fronts, drive, g, slab, k, record, laws, cells):
    """One group, one slab without fronts. Returns the sum of the efforts at the slab's end."""
    waves, before, pieces, total = state.waves, state.before, fronts.pieces, 0.0
    s, u, row, position = before.shape[1], fronts.room.wave, fronts.room.row, fronts.room.position
    for node in range(network.group[g], network.group[g + 1]):
        q = uint64((node - network.group[g]) * s)
        begin(u, q, s, drive, network.drive_row[node], k * s)
        for i in range(network.first[node], network.first[node + 1]):
            e = network.ends[i]
            o, r = uint64(position[e]), network.shift_row[e >> 1]
            if r >= 0:
                shift(waves, o, 1, before, e, network.shift, r, fronts.room.history, row)
            gather(u, q, s, waves, o, network.weight[i])
    if network.load_at[g] >= 0:
        r, nodes = network.step_row[g], network.group[g + 1] - network.group[g]
        n = network.step_states[r]
        load(u, nodes, 1, s, network.step, network.step_at[r], state.load, network.load_at[g], n, row)
    if laws is not None:
        if laws.first[g] < laws.first[g + 1]:
            opened(laws, g, drive, k * s, s, fronts.room.opening)
            meet_elements(network, g, state.load, u, s, fronts.room.opening, laws, cells)
    for node in range(network.group[g], network.group[g + 1]):
        q = uint64((node - network.group[g]) * s)
        for j in range(network.first[node], network.first[node + 1]):
            e = network.ends[j]
            o = uint64(position[e])
            if network.record_row[e] >= 0:
                note(u, q, s, waves, o, record, network.record_row[e], slab * s)
            scatter(u, q, s, waves, o)
            for i in range(s):
                pieces.last[e, i] = waves[position[e] + i]
            pieces.width[e] = 1.0
        total += u[q + uint64(s - 1)]
    return total


@njit(**INNER)
def levelled(pieces, row, tools, counts, sizes, whole):
    """Project a slab in pieces on the whole slab, and give its row back. Counts what that loses."""
    clear(whole)
    for j in range(pieces.number[row]):
        a, b = pieces.start[row, j], pieces.start[row, j + 1]
        project(pieces.coef[row, j], a, b, 0.0, 1.0, tools.gauss, whole)
        if j > 0:
            counts[DROPPED] += 1
            sizes[LOST] = max(sizes[LOST], pieces.size[row, j])
    release(pieces, row, counts)


@njit(**INNER)
def level_source(sources, r, tools, whole, out):
    """Project a source with fronts in a slab on the whole slab."""
    clear(whole)
    for j in range(sources.begin[sources.due[r]], sources.begin[sources.due[r] + 1]):
        project(sources.coef[j], sources.start[j], sources.stop[j], 0.0, 1.0, tools.gauss, whole)
    times(tools.to_points, whole, 0, out)


@njit(**INNER)
def level(network, state, fronts, sources, drive, g, slab, k):
    """Leave out all fronts inside a slab that meet at a group; switches move at the nearest edge."""
    pieces, tools, counts, sizes, moves = fronts.pieces, fronts.tools, fronts.counts, fronts.sizes, fronts.moves
    waves, before, s = state.waves, state.before, fronts.tools.c.size
    position, whole = fronts.room.position, fronts.room.whole
    while moves.due[g] < moves.first[g + 1] and moves.at[moves.due[g]] - slab < 0.5:
        counts[DROPPED] += 1
        network.step_row[g] = moves.row[moves.due[g]]
        moves.due[g] += 1
    for i in range(fronts.drives.first[g], fronts.drives.first[g + 1]):
        r = fronts.drives.row[i]
        if drives_front(sources, r, slab):
            level_source(sources, r, tools, whole, drive[r, k * s : (k + 1) * s])
    for node in range(network.group[g], network.group[g + 1]):
        for i in range(network.first[node], network.first[node + 1]):
            e = network.ends[i]
            row = pieces.of_slab[position[e] // s]
            if row >= 0:
                levelled(pieces, row, tools, counts, sizes, whole)
                times(tools.to_points, whole, 0, waves[position[e] : position[e] + s])
                pieces.of_slab[position[e] // s] = -1
            if pieces.before[e] >= 0:
                levelled(pieces, pieces.before[e], tools, counts, sizes, whole)
                times(tools.to_points, whole, 0, before[e])
                pieces.before[e] = -1


@njit(**INNER)
def level_at_lumps(network, lumps, state, fronts):
    """Project slabs in pieces that pass lumps on slabs in one piece: there fronts are no longer followed."""
    pieces, tools, counts, sizes, whole = fronts.pieces, fronts.tools, fronts.counts, fronts.sizes, fronts.room.whole
    waves, s = state.waves, whole.size
    for r in range(lumps.line.size):
        line = lumps.line[r]
        ring = 2 * network.delay[line]
        t = state.side[line] * network.delay[line] + state.slot[line]
        for k in range(lumps.first[r], lumps.first[r + 1]):
            for slab in passing(t, lumps.place[k], ring):
                o = network.offset[line] + slab * s
                row = pieces.of_slab[o // s]
                if row >= 0:
                    counts[DROPPED] += pieces.anew[row] > 0.0
                    sizes[LOST] = max(sizes[LOST], pieces.anew[row])
                    levelled(pieces, row, tools, counts, sizes, whole)
                    times(tools.to_points, whole, 0, waves[o : o + s])
                    pieces.of_slab[o // s] = -1


def advance_fronts(network, state, fronts, sources, drive, first_slab, n_slabs, record):
    """Advance all nodes slab by slab with fronts as breakpoints, until none is left or the log is full.

    Returns -1, or the number of a node whose effort, or that of another in its group, is no longer finite; and the
    number of slabs done.
    """
    network, *others = parted(network)
    return advance_pieces(network, state, fronts, sources, drive, first_slab, n_slabs, record, *others)


@njit(**INNER)
def quiet_slabs(network, state, fronts, sources, slab, most):
    """Number of slabs ahead, at most so many and none beyond the shortest delay, in which no group meets a front."""
    delay, pieces, moves, due, s = network.delay, fronts.pieces, fronts.moves, sources.due, state.before.shape[1]
    for line in range(delay.size):
        most = min(most, delay[line])
    for g in range(moves.due.size):
        if fronts.settled[g] > slab + MERGE:
            return 0
        if moves.due[g] < moves.first[g + 1]:
            most = min(most, int(np.floor(moves.at[moves.due[g]] - slab + MERGE / 2)))
    for r in range(due.size):
        if due[r] < sources.first[r + 1]:
            most = min(most, sources.slab[due[r]] - slab)
    if fronts.counts[LIVE] == 0:
        return most
    for e in range(2 * delay.size):
        if pieces.before[e] >= 0:
            return 0
    for line in range(delay.size):
        for end in range(2):
            slot, side = state.slot[line], state.side[line] ^ end
            for ahead in range(most):
                if slot == delay[line]:
                    slot, side = 0, 1 - side
                if pieces.of_slab[network.offset[line] // s + side * delay[line] + slot] >= 0:
                    most = ahead
                    break
                slot += 1
    return most


@njit(**INNER)
def note_last(network, state, pieces):
    """Keep the last slab, in one piece, that left every end."""
    s = state.before.shape[1]
    for e in network.ends:
        line = e >> 1
        slot, side = state.slot[line] - 1, state.side[line] ^ (e & 1)
        if slot < 0:
            slot, side = slot + network.delay[line], 1 - side
        o = network.offset[line] + (side * network.delay[line] + slot) * s
        for i in range(s):
            pieces.last[e, i] = state.waves[o + i]
        pieces.width[e] = 1.0


@njit(**OPTIONS)
def advance_pieces(network, state, fronts, sources, drive, first_slab, n_slabs, record, laws, cells, lumps):
    """The same; the network has its laws, cells and lumps beside it, or None."""
    network, state, fronts, sources = borrowed(network), borrowed(state), borrowed(fronts), borrowed(sources)
    drive, record = borrowed(drive), borrowed(record)
    by_law, in_cells, in_lumps = borrowed(laws), borrowed(cells), borrowed(lumps)  # None is seen in arguments alone
    first, ends, group, delay, slots, sides = (
        network.first, network.ends, network.group, network.delay, state.slot, state.side,
    )  # fmt: skip
    pieces, counts, moves, due, position = fronts.pieces, fronts.counts, fronts.moves, sources.due, fronts.room.position
    s, k = state.before.shape[1], int64(0)
    w, out, (enter, y) = np.empty(s * ABREAST), np.empty(s * ABREAST), scratch_of_cells(in_cells, s)
    while k < n_slabs:
        slab = first_slab + k
        log_is_full = counts[NOTED] + 2 * record.shape[0] * fronts.at_node > fronts.log.where.shape[0]
        if log_is_full or (counts[LIVE] == 0 and k >= fronts.lull):
            return -1, k
        for r in range(due.size):
            while due[r] < sources.first[r + 1] and sources.slab[due[r]] < slab:
                due[r] += 1
        if not are_lumped(in_lumps):
            quiet = quiet_slabs(network, state, fronts, sources, slab, n_slabs - k)
            if quiet > 1:
                node = pass_blocks(network, state, k, quiet, drive, record, first_slab, by_law, in_cells, in_lumps)
                if node >= 0:
                    return node, k
                note_last(network, state, pieces)
                k += quiet
                continue
        for g in range(group.size - 1):
            i = moves.due[g]
            broken_here = i < moves.first[g + 1] and moves.at[i] - slab < 1.0 - MERGE / 2
            broken_here |= fronts.settled[g] > slab + MERGE
            for i in range(fronts.drives.first[g], fronts.drives.first[g + 1]):
                broken_here |= drives_front(sources, fronts.drives.row[i], slab)
            for node in range(group[g], group[g + 1]):
                for i in range(first[node], first[node + 1]):
                    e = ends[i]
                    line = e >> 1
                    position[e] = network.offset[line] + ((sides[line] ^ (e & 1)) * delay[line] + slots[line]) * s
                    broken_here |= pieces.of_slab[position[e] // s] >= 0 or pieces.before[e] >= 0
            if cells is not None:
                if broken_here and fronts.levels[g]:
                    level(network, state, fronts, sources, drive, g, slab, k)
                    broken_here = False
            if broken_here:
                at_end = scatter_pieces(network, state, fronts, sources, drive, g, slab, k, record, by_law)
            else:
                at_end = scatter_whole(network, state, fronts, drive, g, slab, k, record, by_law, in_cells)
            if not np.isfinite(at_end):
                return group[g], k
        if lumps is not None:
            level_at_lumps(network, in_lumps, state, fronts)
            lose(network, in_lumps, network.blocks.far_rows, state, 1, w, out)
            lose(network, in_lumps, network.blocks.near_rows, state, 1, w, out)
        if cells is not None:
            pass_cells(network, in_cells, state, enter, y)
        turn(network, state, network.blocks.far_lines, 1)
        turn(network, state, network.blocks.near_lines, 1)
        k += 1
    return -1, n_slabs
