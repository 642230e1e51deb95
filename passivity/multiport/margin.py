"""How far a matrix is from the border between passive and active, and at which frequency.

A level is found with floats, then proved from one side by the exact test of Z - level I, or of S/level.
"""

import math
from fractions import Fraction
from typing import NamedTuple

from flint import fmpq_mat, fmpz_poly

from passivity.expression.number import double
from passivity.multiport.axis_form import axis_sums
from passivity.multiport.matrix import RationalMatrix, real_form
from passivity.multiport.polynomial_matrix import PolynomialMatrix, add, degree, identity, scaled
from passivity.multiport.state_space import StateSpace
from passivity.multiport.verdict import Network
from passivity.one_port.axis import product
from passivity.one_port.polynomial_sign import find_sign
from passivity.status import Kind

MAX_ROUNDS = 30
_BORDER = {Kind.PR: 0.0, Kind.BR: -1.0}
_FIRST, _FAR = 2.0**-12, 50.0  # steps of log w
_NEAR = 2.0**-30  # between value and bound, in parts of the largest eigenvalue there


class MatrixMargin(NamedTuple):
    """An extreme eigenvalue or singular value on the imaginary axis.

    Parameters
    ----------
    value : float
        At the frequency, computed in floats.
    bound : float
        Proved: at no frequency is it lower (eigenvalue) or higher (singular value) than this.
    frequency : float
        Angular frequency, rad per unit of time; ``math.inf`` for the limit.
    """

    value: float
    bound: float
    frequency: float


def margin(network: Network, kind: Kind) -> MatrixMargin | None:
    """The smallest eigenvalue of (Z + Z^H)/2, or the largest singular value of S, over all frequencies.

    None where it has no bound, or none was found in MAX_ROUNDS tests.

    Parameters
    ----------
    network : RationalMatrix or StateSpace
    kind : Kind
        `PR` for the eigenvalue: a resistance that may be taken away at every port; `BR` for the singular value.

    Raises
    ------
    UndecidedError
        If the network is too large.

    Examples
    --------
    >>> z = RationalMatrix.from_rows([["2 + 1/(s + 1)", "1"], ["1", "2"]])
    >>> found = margin(z, Kind.PR)
    >>> round(found.value, 6), found.frequency, 1 - found.bound < 1e-8
    (1.0, inf, True)
    """
    matrix = network.transfer if isinstance(network, StateSpace) else network
    places = [_place(kind, matrix, w) for w in (0.0, math.inf, 1.0, 1.1)]
    best, scale = min(places, key=lambda place: place.level), max(place.size for place in places) or 1.0
    for _ in range(MAX_ROUNDS):
        if not -scale / _NEAR**2 < best.level < math.inf or best.level - _NEAR * scale == -math.inf:
            return None
        border = abs(best.level - _BORDER[kind]) <= _NEAR * scale
        for bound in [_BORDER[kind]] * border + [best.level - _NEAR * scale]:
            x = _beyond(kind, *matrix.fraction, Fraction(bound))
            if x is None:
                level = max(best.level, bound)
                return MatrixMargin(*((level, bound) if kind is Kind.PR else (-level, -bound)), best.w)
            best = min(best, _descended(kind, matrix, math.sqrt(double(x))), key=lambda place: place.level)
    return None


class _Place(NamedTuple):
    """What is to be small at a frequency, infinite at a pole; and the largest eigenvalue or singular value."""

    level: float
    size: float
    w: float


def _place(kind: Kind, matrix: RationalMatrix, w: float) -> _Place:
    import numpy as np

    exact = _at_infinity(*matrix.fraction) if w == math.inf else matrix.at(Fraction(0), Fraction(w))
    if exact is None:
        return _Place(math.inf, 0.0, w)
    try:
        value = np.array([[float(Fraction(int(x.p), int(x.q))) for x in row] for row in exact.tolist()])
    except OverflowError:  # all but a pole
        return _Place(math.inf, 0.0, w)
    if kind is Kind.BR:
        size = float(np.linalg.norm(value, 2))
        return _Place(-size, size, w)
    eigenvalues = np.linalg.eigvalsh(value / 2 + value.T / 2)
    return _Place(float(eigenvalues[0]), float(abs(eigenvalues).max()), w)


def _at_infinity(n: PolynomialMatrix, d: fmpz_poly) -> fmpq_mat | None:
    """Limit of n/d as `RationalMatrix.at` writes it, None if there is none."""
    if degree(n, d) > d.degree():
        return None
    u = [[Fraction(int(x[d.degree()]), int(d.leading_coefficient())) for x in row] for row in n]
    return real_form(u, [[Fraction(0)] * len(n)] * len(n))


def _beyond(kind: Kind, n: PolynomialMatrix, d: fmpz_poly, bound: Fraction) -> Fraction | None:
    """A place x = w^2, not a pole, where the level is below a bound; None if there is none."""
    up, down = bound.numerator, bound.denominator
    shifted = (
        (add(scaled(n, down), identity(len(n), -up * d)), down * d) if kind is Kind.PR else (scaled(n, down), up * d)
    )
    for a, _ in axis_sums(kind, *shifted):
        x = find_sign(a * product(d, d))
        if isinstance(x, Fraction):
            return x
    return None


def _descended(kind: Kind, matrix: RationalMatrix, w: float) -> _Place:
    """A local minimum of the level, downhill from a frequency: ever longer steps, then thirds of an interval."""

    def at(t: float) -> _Place:
        return _place(kind, matrix, w * math.exp(t))

    step = _FIRST if at(_FIRST).level < at(-_FIRST).level else -_FIRST
    before, here = -step, 0.0
    while at(here + step).level < at(here).level and abs(here) < _FAR:
        before, here, step = here, here + step, 2 * step
    if abs(here) >= _FAR:
        return at(here)._replace(w=math.inf if here > 0 else 0.0)
    low, high = sorted((before, here + step))
    for _ in range(50):
        left, right = (2 * low + high) / 3, (low + 2 * high) / 3
        low, high = (low, right) if at(left).level < at(right).level else (left, high)
    return at((low + high) / 2)
