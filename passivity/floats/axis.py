"""Analysis of a state space on the imaginary axis in floating point, by two methods: never a proof.

The lowest value is that of samples, once no crossings of a level just below it remain with lower values between them.
An eigenvalue of the form F(s) = R + S^T X + X~ S + X~ Q X, X = (sI - A)^-1 B, crosses a level where, with that level
taken off R, the pencil

    P(s) = [[Q, A^T + s, S], [A - s, 0, B], [S^T, B^T, R]]

is singular: that of the Hamiltonian matrix, which needs no inverse of R. Without direct losses R is singular.

References
----------
S. Boyd, V. Balakrishnan, P. Kabamba, "A bisection method for computing the H-infinity norm of a transfer matrix",
Mathematics of Control, Signals and Systems 2 (1989), 207-219, doi:10.1007/BF02551385.
S. Grivet-Talocia, "Passivity enforcement via perturbation of Hamiltonian matrices", IEEE Transactions on Circuits and
Systems I 51 (2004), 1755-1769, doi:10.1109/TCSI.2004.834527.
"""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from passivity.floats.system import Band, FloatSystem, Samples
from passivity.status import Kind

SAFETY = 10  # errors by which an eigenvalue may be off the axis and still counts as on it
MAX_ROUNDS = 4
WELL = 1e4  # condition of R, and its part of P, below which it is inverted: the pencil takes three times as long
_NEAR = 2.0**-30  # between value and level, in parts of the value
_SAME = 2.0**-20  # between the ends of bands found by both methods, in parts of the frequency


class Crossing(NamedTuple):
    """A frequency, and the error that the residual of the eigenpair allows it to first order."""

    w: float
    error: float


def crossings(system: FloatSystem, level: float) -> list[Crossing]:
    """Where an eigenvalue of F may cross a level, in rising order; at poles on the axis too."""
    p, e = _pencil(system, level)
    s, left, right = _eigenpairs(p, e, 2 * len(system.a))
    turned = e @ right
    size = np.linalg.norm(right, axis=0)
    residual = np.linalg.norm(p @ right + turned * s, axis=0)
    residual += np.finfo(float).eps * (np.linalg.norm(p) + abs(s)) * size
    slope = abs(np.sum(left.conj() * turned, axis=0))
    with np.errstate(divide="ignore"):
        error = residual * np.linalg.norm(left, axis=0) / slope
    known = (s.imag >= 0) & (abs(s.real) <= SAFETY * error) & (error < abs(s))
    return sorted(Crossing(float(w), float(x)) for w, x in zip(s.imag[known], error[known], strict=True))


def _eigenpairs(p: NDArray, e: NDArray, n: int) -> tuple[NDArray[np.complex128], NDArray, NDArray]:
    """Finite s, and left and right vectors as columns, with P(s) singular; of n rows where R^-1 is harmless.

    e = [[J, 0], [0, 0]] with J^-1 = -J, so P(s) (x, u) = 0 is s x = J (P11 - P12 R^-1 P21) x and u = -R^-1 P21 x.
    """
    from scipy.linalg import eig

    j, r = e[:n, :n], p[n:, n:]
    if np.any(r) and np.linalg.cond(r) * np.linalg.norm(p) < WELL * np.linalg.norm(r):
        below, beside = np.linalg.solve(r, p[n:, :n]), np.linalg.solve(r.T, p[:n, n:].T)
        pairs: Any = eig(j @ (p[:n, :n] - p[:n, n:] @ below), left=True, right=True)
        s, left, right = pairs
        left = j.T @ left
        return s, np.vstack([left, -beside @ left]), np.vstack([right, -below @ right])
    pairs = eig(p, -e, left=True, right=True, homogeneous_eigvals=True)
    (top, bottom), left, right = pairs
    finite = abs(bottom) * (1 / np.finfo(float).eps) > abs(top)
    return top[finite] / bottom[finite], left[:, finite], right[:, finite]


def _pencil(system: FloatSystem, level: float) -> tuple[np.ndarray, np.ndarray]:
    """Return P(0) and dP/ds, with the inputs scaled by their effect."""
    a, b, (q, s, r) = system.a, system.b, system.popov
    n, m = b.shape
    r = r - level * np.eye(m)
    scale = 1 / (max(np.linalg.norm(b), np.linalg.norm(s), np.sqrt(np.linalg.norm(r))) or 1)
    zero, unit, none = np.zeros((n, n)), np.eye(n), np.zeros((n, m))
    p = [[q, a.T, s * scale], [a, zero, b * scale], [s.T * scale, b.T * scale, r * scale**2]]
    return np.block(p), np.block([[zero, unit, none], [-unit, zero, none], [none.T, none.T, np.zeros((m, m))]])


@dataclass(frozen=True)
class AxisAnalysis:
    """Violations on the imaginary axis in floating point: negative eigenvalues of (Z + Z^H)/2, singular values above 1.

    The Hamiltonian test finds nothing beyond the worst value by more than `value_error`, which is infinite where it did
    not settle, as at poles on the axis that leave the value without bound.
    """

    bands: tuple[tuple[float, float], ...]  # angular frequencies between which there are such
    edge_error: float  # largest of their ends that the residuals allow, to first order; 0 without bands
    value: float  # the smallest eigenvalue, or the largest singular value
    value_error: float
    frequency: float  # where it is; inf for the limit
    rightmost: float  # largest real part of an eigenvalue of A
    agree: bool  # samples and the Hamiltonian test see the same bands, and the same value


def analyse(system: FloatSystem) -> AxisAnalysis:
    """Look at a state space on the imaginary axis.

    Raises
    ------
    numpy.linalg.LinAlgError
        If the eigenvalues do not converge.
    """
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


def _settled(system: FloatSystem, samples: Samples) -> tuple[bool, float]:
    """Sample where the form is below a level just under the lowest sample, until it is nowhere.

    Whether that came to an end, and how far below the lowest sample the form may be.
    """
    for _ in range(MAX_ROUNDS):
        lowest = samples.lowest
        shift = lowest.error + _NEAR * max(abs(lowest.value), float(abs(system.popov[2]).max()))
        level = lowest.value - shift
        between = samples.add(_middles(crossings(system, level)))
        if not any(place.value < level - place.error for place in between):
            return True, lowest.value - min(level, *(place.value - place.error for place in between))
        samples.follow()
    return False, math.inf


def _bands(system: FloatSystem, samples: Samples) -> tuple[list[Band], float]:
    """Intervals between crossings in which the form is negative, and the largest error of their ends."""
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


def _apart(found: list[Crossing]) -> list[Crossing]:
    """Crossings that their errors tell apart, one of those that they do not."""
    kept: list[Crossing] = []
    for x in found:
        if not kept or x.w - kept[-1].w > x.error + kept[-1].error:
            kept.append(x)
    return kept


def _middles(found: list[Crossing]) -> list[float]:
    """A frequency between each two crossings, before the first and beyond the last."""
    ends = [0.0, *(x.w for x in _apart(found))]
    return [(x + y) / 2 for x, y in pairwise(ends)] + [2 * ends[-1] or 1.0]


def _same(some: list[Band], others: list[Band], error: float) -> bool:
    if len(some) != len(others):
        return False
    pairs = [(x, y) for a, b in zip(some, others, strict=True) for x, y in zip(a, b, strict=True)]
    return all(x == y or abs(x - y) <= 10 * error + _SAME * max(x, y) < math.inf for x, y in pairs)
