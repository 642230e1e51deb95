"""Diamonds inside lines: a slab of the wave a meets one of the wave b, and each loses effort to friction.

With ξ = t - τ and η = t + τ, τ the delay from end 1, a_η = -φ/2 and b_ξ = φ/2. Both are collocated at Radau's points, a
along η at each point of ξ, b along ξ at each point of η.

Effort that half a slab of a line loses, as a function of d = a - b = 2 z0 y at a place: odd laws that rise.

g(d) = r d + k |d| d + c f |d| d, with f = |d|^n or Darcy's friction factor over Re = ρ |d|; see `tline.loss.flow_law`.
"""

import numpy as np

from tline.compiled.unit import function, invoke, unit
from tline.solver.kernel.arithmetic import ROUNDED, TINY
from tline.solver.kernel.network import POWER, SWAMEE_JAIN, TABULATED, Diamonds, Run

STOKES, DUNLOP, LAMINAR = 2000.0, 4000.0, 2040.0  # Reynolds numbers, as in `tline.loss.flow_law`
SLOWEST = 1e-200  # Reynolds number
BITS, MANTISSA, ONE = 52, 2**52 - 1, 1023 << 52  # of a number: those of its fraction, and 1.0
TERMS, PLACES = 7, 128  # of a power's series, and in its table
ROUNDS, NEWTON = 400, 8  # at most, and steps of Newton's method
TANGENT_RANGE, UNKNOWN = 0.5, 1e300  # of a flow: how far tangents hold
LINEAR = 1e-5  # of the correction by a step of Newton's method: largest rest after its rounds
MIDDLE = 0.5  # of a rectangle of order 1, where friction is looked up: constants are of second order there
REACH = 0.6  # about the change of the flow at a place by the loss there, of order 1; all lead to the same end


@function
def swamee_jain(roughness, reynolds):
    """Friction factor, and its exponent d ln f/d ln Re."""
    if reynolds < STOKES:
        return 64.0 / reynolds, -1.0
    part = 5.74 / max(reynolds, DUNLOP) ** 0.9
    y2 = roughness / 3.7 + part
    y3 = -2.0 * np.log10(y2)
    fa = 1.0 / (y3 * y3)
    if reynolds > DUNLOP:
        return fa, -3.6 / np.log(10.0) * part / (y2 * y3)
    r, fb = reynolds / STOKES, fa * (2.0 - 0.00514215 / (y2 * y3))
    x1, x2, x3 = 7.0 * fa - fb, 0.128 - 17.0 * fa + 2.5 * fb, -0.128 + 13.0 * fa - 2.0 * fb
    x4 = 0.032 - 3.0 * fa + 0.5 * fb
    cubic = x1 + r * (x2 + r * (x3 + r * x4))
    return cubic, r * (x2 + r * (2.0 * x3 + 3.0 * r * x4)) / cubic


@function
def tabulated(tables, at, reynolds):
    """Friction factor and exponent from a table: ln of the first Re, their distance, number of points, ln f there."""
    if reynolds <= LAMINAR:
        return 64.0 / reynolds, -1.0
    n = int(tables[at + 2])
    x = (np.log(reynolds) - tables[at]) / tables[at + 1]
    if x >= n - 1.0:
        return np.exp(tables[at + 2 + n]), 0.0
    k = int(max(x, 0.0))
    rise = tables[at + 4 + k] - tables[at + 3 + k]
    return np.exp(tables[at + 3 + k] + (max(x, 0.0) - k) * rise), rise / tables[at + 1]


@function
def power(tables, at, x):
    """x^n, x ≥ 0, from a table: five times as fast as the library's.

    With x = 2^e m, and m near one of PLACES points in [1, 2), the table has n's binomials up to r^6, these points to
    the n, one over each, and 2^(n e).
    """
    bits = np.float64(x).view(np.int64)
    m = np.int64(bits & MANTISSA | ONE).view(np.float64)
    k = at + TERMS + ((bits >> (BITS - 7)) & (PLACES - 1))
    r, series = m * tables[k + PLACES] - 1.0, 0.0
    for term in range(TERMS - 1, -1, -1):
        series = tables[at + term] + r * series
    return tables[at + TERMS + 2 * PLACES + (bits >> BITS)] * tables[k] * series


@function
def lost(diamonds, row, d):
    """Effort g(d) that a line loses in half a slab, and its slope."""
    size, kind, constants = abs(d), diamonds.kind[row], diamonds.constants
    r, k, c = constants[row, 0], constants[row, 1], constants[row, 2]
    value, slope = r * d + k * size * d, r + 2.0 * k * size
    if kind == POWER:
        each = c * power(diamonds.tables, diamonds.table_at[row], size)
        return value + each * d, slope + (1.0 + constants[row, 3]) * each
    if kind == SWAMEE_JAIN or kind == TABULATED:  # noqa: SIM109
        reynolds = max(constants[row, 3] * size, SLOWEST)
        if kind == TABULATED:
            factor, exponent = tabulated(diamonds.tables, diamonds.table_at[row], reynolds)
        else:
            factor, exponent = swamee_jain(constants[row, 4], reynolds)
        each = c * factor * size
        return value + each * d, slope + (2.0 + exponent) * each
    return value, slope


@unit
def lose_steadily(diamonds: Diamonds) -> int:
    """Find friction before t = 0, beside cells."""
    for row in range(diamonds.line.size):
        diamonds.steady[row, 3], _ = lost(diamonds, row, diamonds.steady[row, 2])
    return 0


@function
def flushed(x):
    """Zero in place of numbers whose squares vanish."""
    return 0.0 if abs(x) < TINY else x


@function
def bent(slope, flow, base):
    """Estimate how far friction is off the tangent at another flow; very large, as unknown, if that is not near."""
    away = abs(flow - base)
    return slope * away * away / abs(base) if away < TANGENT_RANGE * abs(base) else away * UNKNOWN


@function
def meet(diamonds, row, radau, work, a, p, b, q, wide, high):
    """Advance s values of a from place p past s of b from place q, through a rectangle `wide` × `high` slabs.

    Returns whether the iteration ended: Newton's, for friction is dear, each step of it by rounds that leave no more of
    the last one than the slope of friction. Where steps do not end, for friction bends, each is a single round.
    """
    s, taken, flow, base, value, slope = radau.shape[0], work.taken, work.along, work.base, work.value, work.slope
    weight, steady, inside = work.weight, diamonds.steady[row], MIDDLE if s == 1 else 1.0
    begun = steady[2] - steady[0]
    size, last, reach, done = 0.0, 1e300, REACH * (wide + high) / np.sqrt(s), False
    for i in range(s):
        size = max(size, abs(a[p + i]), abs(b[q + i]))
        for j in range(s):
            flow[i, j] = a[p + i] - b[q + j] + begun
            taken[i, j] = 0.0
    for turn in range(ROUNDS):
        off, steep = 0.0, 0.0
        for i in range(s):
            for j in range(s):
                base[i, j] = flow[i, j]
                value[i, j], slope[i, j] = lost(diamonds, row, flow[i, j])
                value[i, j], slope[i, j] = (value[i, j] - steady[3]) * weight[i, j], slope[i, j] * weight[i, j]
                off, steep = max(off, abs(value[i, j] - taken[i, j])), max(steep, slope[i, j])
        weak = min(reach * steep, 1.0)
        if off * weak <= diamonds.exact * size or (off >= 0.5 * last and off * weak <= ROUNDED * size):
            done = True  # after one round more
        last = off
        for _ in range(ROUNDS if turn < NEWTON else 1):
            change, rest = 0.0, 0.0
            for i in range(s):
                for j in range(s):
                    here = value[i, j] + slope[i, j] * (flow[i, j] - base[i, j])
                    step = (here - taken[i, j]) / (1.0 + reach * slope[i, j])
                    taken[i, j] += step
                    change = max(change, abs(step))
            if done:
                break
            for i in range(s):
                for j in range(s):
                    x, y = 0.0, 0.0
                    for k in range(s):
                        x += radau[j, k] * taken[i, k]
                        y += radau[i, k] * taken[k, j]
                    flow[i, j] = a[p + i] - b[q + j] + begun - inside * (high * x + wide * y)
                    rest = max(rest, bent(slope[i, j], flow[i, j], base[i, j]))
            if change * weak <= max(LINEAR * off, diamonds.exact * size):
                done = max(rest, change * weak) <= diamonds.exact * size
                break
        if done:
            break
    for i in range(s):
        x, y = 0.0, 0.0
        for k in range(s):
            x += radau[s - 1, k] * taken[i, k]
            y += radau[s - 1, k] * taken[k, i]
        a[p + i] = flushed(a[p + i] - high * x)
        b[q + i] = flushed(b[q + i] + wide * y)
    return done


@unit
def pass_rectangle(run: Run, row: int, wide: float, high: float) -> int:
    """Advance the two waves in the workspace through a rectangle. Returns whether friction was found; see `meet`."""
    diamonds, work, zero = run.network.diamonds, run.work.diamonds, np.int64(0)
    return 1 if meet(diamonds, row, diamonds.tools.radau, work, work.a, zero, work.b, zero, wide, high) else 0


@function
def meet_apart(run, row, a, p, b, q, wide, high):
    """Advance two waves as `meet`, by a unit of its own."""
    work = run.work.diamonds
    for i in range(work.a.size):
        work.a[i], work.b[i] = a[p + i], b[q + i]
    done = invoke(run.units.rectangle, (run, np.int64(row), wide, high))
    for i in range(work.a.size):
        a[p + i], b[q + i] = work.a[i], work.b[i]
    return done == 1


@function
def places_in_ring(begin, before_a, before_b, D):
    """Places of a cell's first slabs of a and b, some slabs before those that have left the ends."""
    a, b = begin - before_a, begin - before_b + D
    return a + 2 * D if a < 0 else a, b - 2 * D if b >= 2 * D else b


@function
def pass_all(job, run, pass_one):
    """Advance all lines with losses by the diamonds of the slab in which the nodes have just worked.

    Those in whose middle the slab begins come first, then those half a slab later. `pass_one` advances a row by the
    slabs at two places of the buffers. Returns the number of a line whose friction was too strong to be found, or -1.
    """
    network, state, s = run.network, run.state, run.state.before.shape[1]
    for row in range(network.diamonds.line.size):
        line = network.diamonds.line[row]
        D, o = network.delay[line], network.offset[line]
        begin = state.side[line] * D + state.slot[line] - 1
        for later in range(2):
            for k in range(1 - later, D):
                a, b = places_in_ring(begin, k, D - k - later, D)
                if not pass_one(job, run, row, o + a * s, o + b * s):
                    return line
    return -1


@function
def pass_one(job, run, row, a, b):
    """Advance a row by the slabs at two places of the buffers. Returns whether friction was found."""
    waves, work, radau = run.state.waves, run.work.diamonds, run.network.diamonds.tools.radau
    return meet(run.network.diamonds, row, radau, work, waves, a, waves, b, 1.0, 1.0)


@unit
def pass_diamonds(run: Run, chosen: int, count: int) -> int:
    """Advance all lines with losses, as `pass_all` does."""
    return pass_all(run, run, pass_one)
