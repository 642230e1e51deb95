"""Varistor: the current grows with a power of the voltage, in both directions.

Constants: effort beyond the element, current at a voltage, that voltage, exponent.
"""

from tline.compiled.unit import function, unit
from tline.solver.kernel.laws.crossing import bracketed, sampled
from tline.solver.kernel.network import Crossing


@function
def grown(c, at, _, u):
    """Flow, and its slope, at an effort u of zero or above."""
    current, voltage, exponent = c[at + 1], c[at + 2], c[at + 3]
    share = (u / voltage) ** (exponent - 1.0)
    return current / voltage * share * u, exponent * current / voltage * share


@function
def varied(c, at, factor, d, z):
    """Flow i and di/dd behind the effort d and the impedance z."""
    size = abs(d)
    all_ = c[at + 2] * (size / (z * c[at + 1])) ** (1.0 / c[at + 3]) if z > 0.0 else size  # if all of d were at z
    i, slope = bracketed(grown, c, at, factor, size, z, 0.0, min(size, all_))
    return i if d > 0.0 else -i, slope


@unit
def varistor(crossing: Crossing, at: int, n: int, z: float) -> int:
    """Flows of a varistor at n samples, behind the efforts v and the impedance z."""
    return sampled(varied, crossing, at, n, z)
