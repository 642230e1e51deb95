"""Where a model is not passive: the exact bands, and the worst frequencies in them."""

import math
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from passivity.one_port.axis import allowance
from passivity.one_port.polynomial_sign import squarefree
from passivity.one_port.real_roots import positive_roots
from passivity.one_port.verdict import Verdict
from passivity.sampled.check import excess
from passivity.sampled.model import PoleResidueModel
from passivity.sampled.response import Parameter

POINTS = 60  # in a band, at equal ratios
BEYOND = 1e6  # times the largest modulus of a pole or band edge: stands for infinity, its inverse for zero


def forbidden_bands(verdict: Verdict) -> list[tuple[float, float]]:
    """Where Re Z(jw) < 0 or |S(jw)| > 1, w from 0 to infinity, rad/s.

    Examples
    --------
    >>> from passivity import RationalFunction, check_positive_real
    >>> forbidden_bands(check_positive_real(RationalFunction.from_expression("(s + 2)/(s^2 + s + 1)")))
    [(1.4142135623730951, inf)]
    """
    a = allowance(verdict.kind, verdict.function.p, verdict.function.q)
    if not a:
        return []
    changes = [float(root) for f, power in squarefree(a) if power % 2 and f[0] for root in positive_roots(f)]
    edges = [0.0, *map(math.sqrt, sorted(changes)), math.inf]
    last = len(edges) - 2  # counted down from infinity, the sign changes at each edge
    negative = a.leading_coefficient() < 0
    return [band for k, band in enumerate(pairwise(edges)) if ((last - k) % 2 == 0) == negative]


def worst_frequencies(model: PoleResidueModel, verdict: Verdict) -> NDArray:
    """In each forbidden band all frequencies where the model is locally worst, rad/s."""
    bands = forbidden_bands(verdict)
    marks = np.array([*np.abs(model.poles), *(edge for band in bands for edge in band)])
    marks = marks[(marks > 0) & (marks < math.inf)]
    least, most = (marks.min() / BEYOND, marks.max() * BEYOND) if len(marks) else (1.0, 1.0)
    found = []
    for low, high in bands:
        low, high = max(low, least), min(high, most)
        inner = np.concatenate([np.geomspace(low, high, POINTS), *(_near(a) for a in model.poles if a.real)])
        w = np.unique(inner[(inner >= low) & (inner <= high)])
        beyond = _beyond(model, w)
        padded = np.pad(beyond, 1, constant_values=-math.inf)
        peaks = np.flatnonzero((beyond >= padded[:-2]) & (beyond > padded[2:]) & (beyond > 0))
        peaks = peaks if len(peaks) else np.array([np.argmax(beyond)])
        found += [_summit(model, w, int(k)) for k in peaks]
    return np.array(found)


def _near(pole: complex) -> NDArray:
    """Frequencies that show the resonance of a pole."""
    return np.abs(pole.imag + pole.real * np.tan(np.linspace(-1.4, 1.4, 15)))


def _beyond(model: PoleResidueModel, w: NDArray) -> NDArray:
    values = model.at(w)
    return excess(np.abs(values) if model.parameter is Parameter.S else values.real, model.parameter)


def _summit(model: PoleResidueModel, w: NDArray, k: int) -> float:
    """The top between the neighbours of a point that is higher than they."""
    from scipy.optimize import minimize_scalar

    low, high = math.log(w[max(k - 1, 0)]), math.log(w[min(k + 1, len(w) - 1)])
    if low == high:
        return float(w[k])
    top: Any = minimize_scalar(lambda x: -_beyond(model, np.exp([x]))[0], bounds=(low, high), method="bounded")
    found = np.array([w[k], math.exp(top.x)])
    return float(found[np.argmax(_beyond(model, found))])
