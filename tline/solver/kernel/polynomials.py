"""Polynomials on intervals, held by their Legendre coefficients."""

from tline.compiled.unit import function
from tline.solver.kernel.arithmetic import clear

LOOKS, HALVINGS = 4, 60  # at a slab for roots, per point; and of an interval with a root
ROUNDING = 1e-9  # of a look


@function
def series(coef, y):
    """Sum of a Legendre series at y, -1 to 1."""
    total, last, here = coef[0], 1.0, y
    for k in range(1, coef.size):
        total += coef[k] * here
        last, here = here, ((2 * k + 1) * y * here - k * last) / (k + 1)
    return total


@function
def project(coef, a, b, p, q, gauss, out):
    """Add to the projection on [p, q] what a polynomial on [a, b] has there; a restriction is exact."""
    low, high = max(a, p), min(b, q)
    if high <= low:
        return
    for i in range(gauss.shape[1]):
        since = (high - low) * gauss[0, i]  # low: places in narrow intervals are known better than instants
        value = gauss[1, i] * (high - low) / (q - p) * series(coef, 2.0 * (low - a + since) / (b - a) - 1.0)
        y = 2.0 * (low - p + since) / (q - p) - 1.0
        out[0] += value
        last, here = 1.0, y
        for k in range(1, out.size):
            out[k] += (2 * k + 1) * value * here
            last, here = here, ((2 * k + 1) * y * here - k * last) / (k + 1)


@function
def integrated(coef, factor, out):
    """Legendre coefficients of the integral from 0 of a polynomial on [0, 1], times a factor."""
    clear(out)
    out[0] = 0.5 * factor * coef[0]
    for k in range(coef.size):
        term = 0.5 * factor * coef[k] / (2 * k + 1)
        out[k + 1] += term
        if k > 0:
            out[k - 1] -= term


@function
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


@function
def after(place, s):
    """The next look at a slab, beyond this one however it is rounded."""
    return min((int(place * LOOKS * s + ROUNDING) + 1) / (LOOKS * s), 1.0)
