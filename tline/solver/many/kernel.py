"""The kernel of many runs: copies of one network whose numbers differ, and the extremes of what they do.

Copies are the last axis of all arrays, so that loops over them vectorise; those over the few points of a slab would
not. Slabs of a period differ, periods are alike.
"""

import numpy as np

from tline.compiled import njit
from tline.solver.kernel.arithmetic import TINY
from tline.unit import OPTIONS

INNER = OPTIONS | {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}  # for kernels alone, never Python
NEWTON = 3  # steps from the best point of a slab to the extreme of its polynomial
SAME = 1e-12  # what is larger by less, relatively, is the same extreme
NEAR = 1e-9  # of a period; an instant this near to a slab's end is its end
NARROWEST = 1e-18  # of a period: slabs of no width count as so wide


@njit(**OPTIONS)
def advance_copies(delay, first, ends, drive_row, load_row, record_row, weight, maps, drive, n_periods, record):
    """Advance B copies by n periods of K slabs from rest; record efforts and arriving waves, (rows, 2, n K, s, B).

    delay (L,) in periods; first, ends as in `Network`; drive_row, load_row (N,) and record_row (2 L,) or -1;
    weight (2 L, B); maps (rows, K, s + n, s + n, B) by columns; drive (rows, periods, K, s, B), the last goes on.
    """
    slabs, s, copies = drive.shape[2], drive.shape[3], drive.shape[4]
    offset = np.zeros(delay.size + 1, np.int64)
    for line in range(delay.size):
        offset[line + 1] = offset[line] + 2 * delay[line]
    rows, size = maps.shape[0], maps.shape[2]
    waves, states = np.zeros((offset[-1], slabs, s, copies)), np.zeros((rows, size - s, copies))
    u, out = np.empty((size, copies)), np.empty((size, copies))
    for period in range(n_periods):
        driven = min(period, drive.shape[1] - 1)
        for node in range(first.size - 1):
            r = load_row[node]
            for slab in range(slabs):
                if drive_row[node] >= 0:
                    u[:s] = drive[drive_row[node], driven, slab]
                else:
                    u[:s] = 0.0
                for i in range(first[node], first[node + 1]):
                    gather_abreast(u, waves[due(ends[i], delay, offset, period), slab], weight[i])
                if r >= 0:
                    respond_abreast(maps[r][slab], states[r], u, out)
                for i in range(first[node], first[node + 1]):
                    arrived, row = waves[due(ends[i], delay, offset, period), slab], record_row[ends[i]]
                    if row >= 0:
                        keep(u, record[row, 0, period * slabs + slab])
                        keep(arrived, record[row, 1, period * slabs + slab])
                    scatter_abreast(u, arrived)


@njit(**INNER)
def due(end, delay, offset, period):
    """The period of a line's buffers that an end works on."""
    line = end >> 1
    turn, slot = divmod(period, delay[line])
    return offset[line] + ((turn ^ end) & 1) * delay[line] + slot


@njit(**INNER)
def gather_abreast(u, waves, share):
    """Add an end's share of its arriving waves, for all copies."""
    for j in range(waves.shape[0]):
        for c in range(waves.shape[1]):
            u[j, c] += share[c] * waves[j, c]


@njit(**INNER)
def respond_abreast(step, states, u, out):
    """Turn the Thévenin waves of one slab into efforts through loads' states, for all copies."""
    size, copies = step.shape[0], step.shape[2]
    s = size - states.shape[0]
    for i in range(s, size):
        for c in range(copies):
            u[i, c] = states[i - s, c]
    for i in range(size):
        for c in range(copies):
            out[i, c] = step[0, i, c] * u[0, c]
    j = 1
    while j + 4 <= size:  # four at a time: sums are fetched and put back less often
        for i in range(size):
            for c in range(copies):
                one = step[j, i, c] * u[j, c] + step[j + 1, i, c] * u[j + 1, c]
                out[i, c] += one + step[j + 2, i, c] * u[j + 2, c] + step[j + 3, i, c] * u[j + 3, c]
        j += 4
    while j < size:
        for i in range(size):
            for c in range(copies):
                out[i, c] += step[j, i, c] * u[j, c]
        j += 1
    for i in range(s):
        for c in range(copies):
            u[i, c] = out[i, c]
    for i in range(s, size):
        for c in range(copies):
            states[i - s, c] = 0.0 if abs(out[i, c]) < TINY else out[i, c]


@njit(**INNER)
def scatter_abreast(u, waves):
    """Send back from an end what the efforts leave of the arriving waves, for all copies."""
    for j in range(waves.shape[0]):
        for c in range(waves.shape[1]):
            back = 2.0 * u[j, c] - waves[j, c]
            waves[j, c] = 0.0 if abs(back) < TINY else back


@njit(**INNER)
def keep(values, record):
    """Keep what an end sees, for all copies."""
    for j in range(record.shape[0]):
        for c in range(record.shape[1]):
            record[j, c] = values[j, c]


@njit(**OPTIONS)
def fill_maps(A, b, c, d, widths, rate, projector, maps):
    """Radau IIA steps over K slabs, (K, size, size, B), of loads dx/dt = A x + b w, u = c x + d w in B copies.

    By columns, from (Thévenin wave at the points, state) to (effort at the points, next state); there may be more room
    for states than the load has. A (n, n, B), n up to 2, b and c (n, B), d (B,), widths (K, B) in s; rate (modes,) and
    projector (modes, s, s) of the Radau matrix.
    """
    n, copies = b.shape
    slabs, modes, s = widths.shape[0], rate.size, projector.shape[1]
    parts = np.empty((modes, 2, 1 + n * (n + 2), copies))
    whole, last = np.empty((modes, s), np.complex128), np.empty((modes, s), np.complex128)
    for m in range(modes):
        for i in range(s):
            whole[m, i], last[m, i] = projector[m, i].sum(), projector[m, s - 1, i]
    for slab in range(slabs):
        for m in range(modes):
            solve_abreast(A, b, c, widths[slab], rate[m], parts[m])
        for j in range(s):
            for i in range(s):
                add_modes(parts, 0, projector[:, i, j], maps[slab, j, i])
            for k in range(n):
                add_modes(parts, 1 + k, last[:, j], maps[slab, j, s + k])
                add_modes(parts, 1 + n + k, whole[:, j], maps[slab, s + k, j])
            for copy in range(copies):
                maps[slab, j, j, copy] += d[copy]
        for k in range(n):
            for i in range(n):
                add_modes(parts, 1 + 2 * n + i * n + k, whole[:, s - 1], maps[slab, s + k, s + i])


@njit(**INNER)
def solve_abreast(A, b, c, width, rate, parts):
    """What a mode takes part in a load's step with, in all copies.

    With S = (1 - r h A)^-1: r h c S b, the n of r h S b, the n of c S, and the n n of S.
    """
    n, copies = b.shape
    found = np.empty(parts.shape[1], np.complex128)
    for copy in range(copies):
        scaled = rate * width[copy]
        if n == 1:
            solved = 1.0 / (1.0 - scaled * A[0, 0, copy])
            found[3] = solved
            found[1] = scaled * solved * b[0, copy]
            found[2] = solved * c[0, copy]
            found[0] = found[1] * c[0, copy]
        else:
            p, q = 1.0 - scaled * A[0, 0, copy], -scaled * A[0, 1, copy]
            r, t = -scaled * A[1, 0, copy], 1.0 - scaled * A[1, 1, copy]
            over = 1.0 / (p * t - q * r)
            p, q, r, t = t * over, -q * over, -r * over, p * over
            found[5], found[6], found[7], found[8] = p, q, r, t
            found[1] = scaled * (p * b[0, copy] + q * b[1, copy])
            found[2] = scaled * (r * b[0, copy] + t * b[1, copy])
            found[3] = c[0, copy] * p + c[1, copy] * r
            found[4] = c[0, copy] * q + c[1, copy] * t
            found[0] = c[0, copy] * found[1] + c[1, copy] * found[2]
        for i in range(found.size):
            parts[0, i, copy], parts[1, i, copy] = found[i].real, found[i].imag


@njit(**INNER)
def add_modes(parts, term, weight, out):
    """Real part of a sum over modes, for all copies."""
    for c in range(out.size):
        out[c] = 0.0
    for m in range(weight.size):
        real, imag = weight[m].real, weight[m].imag
        for c in range(out.size):
            out[c] += real * parts[m, 0, term, c] - imag * parts[m, 1, term, c]


@njit(**OPTIONS)
def find_extremes(wave, unit, edges, t_end, points, to_powers, found):
    """Smallest value, when, largest, when, (4, B), until t_end of B waves (n K, s, B) that are zero at t = 0.

    A period lasts unit (B,); edges (K + 1, B) of its slabs are shares of it; to_powers (s, s) turns values at the
    points (s,) of a slab into coefficients of powers of 2 x - 1. Slabs are searched whose points come near enough to
    the best: within twice what a parabola with the bend of the first peak may rise between points, and within what
    the slab's own points differ.
    """
    slabs, s, copies = wave.shape
    parts, gap = edges.shape[0] - 1, points[0]
    for j in range(1, s):
        gap = max(gap, points[j] - points[j - 1])
    top, coef = np.empty((2, slabs, copies)), np.empty(s)
    for slab in range(slabs):
        note_tops(wave[slab], to_powers, top[0, slab], top[1, slab])
    for c in range(copies):
        end = t_end / unit[c]
        whole = min(int(end) * parts, slabs)  # slabs that end until then
        while whole < slabs and edges[whole % parts + 1, c] <= end - int(end):
            whole += 1
        for side in range(2):
            sign, first = 2.0 * side - 1.0, 0
            for slab in range(1, whole):
                if top[side, slab, c] > top[side, first, c]:
                    first = slab
            best, best_at, margin = 0.0, 0.0, 0.0
            for k in range(-1, min(whole + 1, slabs)):
                slab = first if k < 0 else k
                rise = min(margin, top[0, slab, c] + top[1, slab, c])
                if k == first or (k >= 0 and top[side, slab, c] + rise <= best + SAME * abs(best)):
                    continue
                begin = edges[slab % parts, c]
                width = edges[slab % parts + 1, c] - begin
                furthest = 1.0 if slab < whole else (end - int(end) - begin) / width
                value, x, bend = peak(wave[slab], c, sign, furthest, points, to_powers, coef)
                if k < 0:
                    margin = bend * gap**2 / 4.0
                if value > best:
                    best, best_at = value, (slab // parts + begin + x * width) * unit[c]
            found[2 * side, c], found[2 * side + 1, c] = sign * best, best_at


@njit(**INNER)
def note_tops(wave, to_powers, lowest, highest):
    """Largest value of -wave and of wave (s, B) at the begin of a slab and at its points, for all copies."""
    s, copies = wave.shape
    for c in range(copies):
        lowest[c] = 0.0
    for j in range(s):
        weight = 0.0  # of its value at the begin, where powers are 1, -1, 1 ...
        for k in range(s):
            weight += to_powers[k, j] * (1.0 - 2.0 * (k & 1))
        for c in range(copies):
            lowest[c] -= weight * wave[j, c]
    for c in range(copies):
        highest[c] = -lowest[c]
    for j in range(s):
        for c in range(copies):
            lowest[c] = max(lowest[c], -wave[j, c])
            highest[c] = max(highest[c], wave[j, c])


@njit(**INNER)
def peak(wave, c, sign, furthest, points, to_powers, coef):
    """Largest value of sign times a copy's polynomial from 0 to `furthest`, where, and how much it bends there.

    Newton's method goes there from the best of its begin, its points, and the end.
    """
    x, best = furthest, -np.inf
    fill(wave, c, sign, to_powers, coef)
    for j in range(-1, points.size):
        place = 0.0 if j < 0 else points[j]
        value = sign * wave[j, c] if j >= 0 else powers(coef, -1.0)[0]
        if place <= furthest and value > best:
            best, x = value, place
    if furthest < 1.0:
        value = powers(coef, 2.0 * furthest - 1.0)[0]
        if value > best:
            best, x = value, furthest
    at, bend = x, 0.0
    for step in range(NEWTON + 1):
        value, slope, bend = powers(coef, 2.0 * x - 1.0)
        if value > best:
            best, at = value, x
        if step < NEWTON and bend < 0.0:
            x = min(max(x - 0.5 * slope / bend, 0.0), furthest)
    return best, at, 4.0 * abs(bend)


@njit(**INNER)
def fill(wave, c, sign, to_powers, coef):
    """Coefficients of a copy's polynomial in a slab, times a sign."""
    for k in range(coef.size):
        total = 0.0
        for j in range(coef.size):
            total += to_powers[k, j] * wave[j, c]
        coef[k] = sign * total


@njit(**INNER)
def powers(coef, z):
    """A polynomial at z, its slope, and its second derivative."""
    value, slope, bend = 0.0, 0.0, 0.0
    for k in range(coef.size - 1, -1, -1):
        bend = bend * z + 2.0 * slope
        slope = slope * z + value
        value = value * z + coef[k]
    return value, slope, bend


@njit(**OPTIONS)
def find_values(waves, unit, edges, t, to_powers, found):
    """Waves (rows, n K, s, B) at instants t, (rows, B, instants); at a jump the value before it, at t = 0 zero."""
    rows, slabs, s, copies = waves.shape
    parts, coef = edges.shape[0] - 1, np.empty(s)
    for c in range(copies):
        for i in range(t.size):
            place = t[i] / unit[c]
            period = min(max(int(np.ceil(place - NEAR)) - 1, 0), slabs // parts - 1)
            k = 0
            while k < parts - 1 and edges[k + 1, c] < place - period - NEAR:
                k += 1
            width = max(edges[k + 1, c] - edges[k, c], NARROWEST)
            x = min(max((place - period - edges[k, c]) / width, 0.0), 1.0)
            for row in range(rows):
                fill(waves[row, period * parts + k], c, 1.0, to_powers, coef)
                found[row, c, i] = powers(coef, 2.0 * x - 1.0)[0] if t[i] > 0.0 else 0.0
