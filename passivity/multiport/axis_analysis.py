"""What floating point sees of a state space on the imaginary axis, by two methods: never a proof.

The lowest value is that of samples, once no crossing of a level just below it is left between which the form is lower.
"""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

from passivity.status import Kind

if TYPE_CHECKING:
    from passivity.multiport.axis_samples import Band, Samples
    from passivity.multiport.float_system import FloatSystem
    from passivity.multiport.hamiltonian import Crossing

MAX_ROUNDS = 4
_NEAR = 2.0**-30  # between value and level, in parts of the value
_SAME = 2.0**-20  # between the ends of bands found by both methods, in parts of the frequency


@dataclass(frozen=True)
class AxisAnalysis:
    """Violations on the imaginary axis in floating point.

    Parameters
    ----------
    bands : tuple of (float, float)
        Angular frequencies between which (Z + Z^H)/2 has a negative eigenvalue, or S a singular value above 1.
    edge_error : float
        Largest error of their ends that the residuals allow, to first order; 0 without bands.
    value, frequency : float
        The smallest eigenvalue, or the largest singular value, and where it is; ``math.inf`` for the limit.
    value_error : float
        The Hamiltonian test finds nothing lower (higher for a singular value) than the value by more than this;
        ``math.inf`` where it did not settle, as at poles on the axis that leave the value without bound.
    rightmost : float
        Largest real part of an eigenvalue of A.
    agree : bool
        Samples and the Hamiltonian test see the same bands, and the same value.
    """

    bands: tuple[tuple[float, float], ...]
    edge_error: float
    value: float
    value_error: float
    frequency: float
    rightmost: float
    agree: bool


def analyse(system: "FloatSystem") -> AxisAnalysis:
    """Look at a state space on the imaginary axis.

    Raises
    ------
    numpy.linalg.LinAlgError
        If the eigenvalues do not converge.

    Examples
    --------
    >>> from passivity.multiport.float_system import FloatSystem
    >>> from passivity.multiport.state_space import StateSpace
    >>> system = FloatSystem.of(Kind.PR, StateSpace.from_entries([[-1]], [[1]], [[1]], [["-1/5"]]))
    >>> found = analyse(system)
    >>> [(round(low, 9), high) for low, high in found.bands], found.value, found.frequency, found.agree
    ([(2.0, inf)], -0.2, inf, True)
    """
    from passivity.multiport.axis_samples import Samples

    samples = Samples(system)
    settled, depth = _settled(system, samples)
    lowest = samples.lowest
    bands, error = _bands(system, samples) if lowest.is_negative else ([], 0.0)
    low, high = lowest.value, lowest.value - depth
    if system.kind is Kind.BR:
        low, high = math.sqrt(1 - low), math.sqrt(1 - high)
    return AxisAnalysis(
        bands=tuple((x * system.unit, y * system.unit) for x, y in bands),
        edge_error=error * system.unit,
        value=low,
        value_error=abs(high - low),
        frequency=lowest.w * system.unit,
        rightmost=float(system.poles.real.max()) * system.unit,
        agree=settled and _same(bands, samples.bands(), error),
    )


def _settled(system: "FloatSystem", samples: "Samples") -> tuple[bool, float]:
    """Sample where the form is below a level just under the lowest sample, until it is nowhere.

    Whether that came to an end, and how far below the lowest sample the form may be.
    """
    from passivity.multiport.hamiltonian import crossings

    for _ in range(MAX_ROUNDS):
        lowest = samples.lowest
        shift = lowest.error + _NEAR * max(abs(lowest.value), float(abs(system.popov[2]).max()))
        level = lowest.value - shift
        between = samples.add(_middles(crossings(system, level)))
        if not any(place.value < level - place.error for place in between):
            return True, lowest.value - min(level, *(place.value - place.error for place in between))
        samples.follow()
    return False, math.inf


def _bands(system: "FloatSystem", samples: "Samples") -> tuple[list["Band"], float]:
    """Intervals between crossings in which the form is negative, and the largest error of their ends."""
    from passivity.multiport.hamiltonian import crossings

    found = _apart(crossings(system, 0.0))
    ends = [0.0, *(x.w for x in found), math.inf]
    errors = {x.w: x.error for x in found}
    bands: list[Band] = []
    negative = False
    for low, high, middle in zip(ends, ends[1:], samples.add(_middles(found)), strict=False):
        negative = middle.is_negative if middle.is_known else negative
        if negative:
            start = bands.pop()[0] if bands and bands[-1][1] == low else low
            bands.append((start, high))
    return bands, max((errors.get(w, 0.0) for band in bands for w in band), default=0.0)


def _apart(found: list["Crossing"]) -> list["Crossing"]:
    """Crossings that their errors tell apart, one of those that they do not."""
    kept: list[Crossing] = []
    for x in found:
        if not kept or x.w - kept[-1].w > x.error + kept[-1].error:
            kept.append(x)
    return kept


def _middles(found: list["Crossing"]) -> list[float]:
    """A frequency between each two crossings, before the first and beyond the last."""
    ends = [0.0, *(x.w for x in _apart(found))]
    return [(x + y) / 2 for x, y in pairwise(ends)] + [2 * ends[-1] or 1.0]


def _same(some: list["Band"], others: list["Band"], error: float) -> bool:
    if len(some) != len(others):
        return False
    pairs = [(x, y) for a, b in zip(some, others, strict=True) for x, y in zip(a, b, strict=True)]
    return all(x == y or abs(x - y) <= 10 * error + _SAME * max(x, y) < math.inf for x, y in pairs)
