"""The smallest and largest values of waves, between points, too."""

from typing import NamedTuple

import numpy as np

from tline.compiled.structure import Floats, Floats2, Floats3
from tline.compiled.unit import function, unit

NEWTON = 3  # steps from the best point of a slab to the extreme of its polynomial
ROUNDED = 1e-12  # of a value: largest excess that may be missed
TIE = 1e-9  # relative difference below which extremes are the same: the first counts


class ExtremesOfCopies(NamedTuple):
    """Search of the extremes until t_end of a wave in B copies, in periods of K slabs of s points, zero at t = 0."""

    wave: Floats3  # (n K, s, B)
    period: Floats  # (B,) in s
    edges: Floats2  # (K + 1, B) of the slabs, as shares of a period
    t_end: float
    points: Floats  # (s,) of a slab
    to_powers: Floats2  # (s, s) from values there to coefficients of powers of 2 x - 1
    found: Floats2  # (4, B) smallest value, when, largest, when
    top: Floats3  # (2, n K, B) largest of minus the wave and of the wave at the start and the points of each slab
    coef: Floats  # (s,)
    begin: Floats  # (s,) from values at the points to that at the begin of a slab


def extremes(
    wave: Floats3, period: Floats, edges: Floats2, t_end: float, points: Floats, to_powers: Floats2, found: Floats2
) -> ExtremesOfCopies:
    """The search for a wave's extremes, with its workspace."""
    top = np.empty((2, len(wave), wave.shape[2]))
    begin = (-1.0) ** np.arange(len(points)) @ to_powers
    return ExtremesOfCopies(wave, period, edges, t_end, points, to_powers, found, top, np.empty(len(points)), begin)


@unit
def find_extremes(search: ExtremesOfCopies) -> int:
    """Find the extremes in all copies.

    Slabs are searched whose points come near enough to the best: within twice the rise between points of a parabola
    with the bend of the first peak, and within the range of the slab's own points.
    """
    wave, edges, points, top, found = search.wave, search.edges, search.points, search.top, search.found
    slabs, s, copies = wave.shape
    parts, gap = edges.shape[0] - 1, points[0]
    for j in range(1, s):
        gap = max(gap, points[j] - points[j - 1])
    for slab in range(slabs):
        note_tops(wave[slab], search.begin, top[0, slab], top[1, slab])
    for c in range(copies):
        end = search.t_end / search.period[c]
        whole = min(int(end) * parts, slabs)  # slabs that end until then
        while whole < slabs and edges[whole % parts + 1, c] <= end - int(end):
            whole += 1
        for side in range(2):
            sign, first = 2.0 * side - 1.0, 0
            for slab in range(1, whole):
                if top[side, slab, c] > top[side, first, c]:
                    first = slab
            best, best_at, margin, at = 0.0, 0.0, 0.0, -1
            for k in range(-1, min(whole + 1, slabs)):
                slab = first if k < 0 else k
                reach = top[side, slab, c] + min(margin, top[0, slab, c] + top[1, slab, c])
                if k == first or (k >= 0 and reach <= (1.0 + ROUNDED if slab > at else 1.0 - TIE) * best):
                    continue
                begin = edges[slab % parts, c]
                width = edges[slab % parts + 1, c] - begin
                furthest = 1.0 if slab < whole else (end - int(end) - begin) / width
                value, x, bend = peak(wave[slab], c, sign, furthest, points, search.to_powers, search.coef)
                if k < 0:
                    margin = bend * gap**2 / 4.0
                if value > (1.0 + TIE) * best or (slab < at and value >= (1.0 - TIE) * best):
                    best_at, at = (slab // parts + begin + x * width) * search.period[c], slab
                best = max(best, value)
            found[2 * side, c], found[2 * side + 1, c] = sign * best, best_at
    return 0


@function
def note_tops(wave, begin, lowest, highest):
    """Largest value of -wave and of wave (s, B) at the begin of a slab and at its points, for all copies."""
    s, copies = wave.shape
    for c in range(copies):
        lowest[c] = 0.0
    for j in range(s):
        for c in range(copies):
            lowest[c] -= begin[j] * wave[j, c]
    for c in range(copies):
        highest[c] = -lowest[c]
    for j in range(s):
        for c in range(copies):
            lowest[c] = max(lowest[c], -wave[j, c])
            highest[c] = max(highest[c], wave[j, c])


@function
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


@function
def fill(wave, c, sign, to_powers, coef):
    """Coefficients of a copy's polynomial in a slab, times a sign."""
    for k in range(coef.size):
        total = 0.0
        for j in range(coef.size):
            total += to_powers[k, j] * wave[j, c]
        coef[k] = sign * total


@function
def powers(coef, z):
    """A polynomial at z, its slope, and its second derivative."""
    value, slope, bend = 0.0, 0.0, 0.0
    for k in range(coef.size - 1, -1, -1):
        bend = bend * z + 2.0 * slope
        slope = slope * z + value
        value = value * z + coef[k]
    return value, slope, bend
