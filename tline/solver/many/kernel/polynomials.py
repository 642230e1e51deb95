"""Polynomials of single copies within a slab."""

from tline.compiled.unit import function


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
