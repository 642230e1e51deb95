"""Effort that half a slab of a line loses, as a function of d = a - b = 2 z0 y at a place: odd laws that rise.

g(d) = r d + k |d| d + c f |d| d, with f = |d|^n or Darcy's friction factor over Re = ρ |d|; see `tline.loss.flow_law`.
"""

import numpy as np

from tline.compiled.unit import function
from tline.solver.kernel.network import COLEBROOK, POWER, SWAMEE_JAIN

STOKES, DUNLOP, LAMINAR = 2000.0, 4000.0, 2040.0  # Reynolds numbers, as in `tline.loss.flow_law`
SLOWEST = 1e-200  # Reynolds number
BITS, MANTISSA, ONE = 52, 2**52 - 1, 1023 << 52  # of a number: those of its fraction, and 1.0
TERMS, PLACES = 7, 128  # of a power's series, and in its table


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
def colebrook(tables, at, reynolds):
    """The same from a table: ln of the first Re, their distance, number of points, and ln f at these."""
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

    With x = 2^e m, and m near one of so many places in [1, 2): n's binomials up to r^6, these places to the n, one over
    each, and 2^(n e).
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
    if kind == SWAMEE_JAIN or kind == COLEBROOK:  # noqa: SIM109
        reynolds = max(constants[row, 3] * size, SLOWEST)
        if kind == COLEBROOK:
            factor, exponent = colebrook(diamonds.tables, diamonds.table_at[row], reynolds)
        else:
            factor, exponent = swamee_jain(constants[row, 4], reynolds)
        each = c * factor * size
        return value + each * d, slope + (2.0 + exponent) * each
    return value, slope
