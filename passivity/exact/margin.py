"""How far a function or a matrix is from the border between passive and active, and at which frequency.

Of one port the extreme values are enclosed by exact tests. Of several, a level is found with floats, then proved from
one side by the exact test of Z - level I, or of S/level.
"""

import math
from collections.abc import Callable
from fractions import Fraction
from typing import NamedTuple

from flint import fmpz_poly

from passivity.budget import ASIDE, budget
from passivity.expression.number import double, square_root
from passivity.polynomial.infimum import infimum
from passivity.polynomial.sign import allowance, find_sign, product
from passivity.rational.evaluate import Exact, positive
from passivity.rational.function import RationalFunction
from passivity.rational.matrix import RationalMatrix
from passivity.rational.polynomial_matrix import PolynomialMatrix, add, axis_sums, identity, scaled
from passivity.rational.state_space import StateSpace
from passivity.status import Kind
from passivity.verdict import Margin, Margins, Verdict

MAX_ROUNDS = 30
_BORDER = {Kind.PR: 0.0, Kind.BR: -1.0}
_FIRST, _FAR = 2.0**-12, 50.0  # steps of log w
_NEAR = 2.0**-30  # between value and bound, in parts of the largest eigenvalue there


def margins(verdict: Verdict, z0: Exact = 1) -> Margins:
    """Margins of the function of a verdict, in the unit of the function.

    Parameters
    ----------
    verdict : Verdict
        Any; proved or not.
    z0 : int, float, Fraction, Decimal or str
        Reference impedance of the reflection of one port, above zero; without effect where a reflection is given.

    Raises
    ------
    ExpressionError
        If z0 is not above zero.
    UndecidedError
        If the budget for finding a minimum runs out.

    Examples
    --------
    >>> from passivity import RationalFunction, check_positive_real
    >>> found = check_positive_real(RationalFunction.from_expression("3 + s/(s^2 + s + 1)")).margins
    >>> found.input[:3], found.reflection.value, found.reflection.frequency
    ((Fraction(3, 1), Fraction(3, 1), 0.0), 0.6, 1.0)
    """
    if verdict.in_s is not None:
        from passivity.discrete import angle

        there = margins(verdict.in_s, z0)
        return Margins(*(m and m._replace(frequency=angle(m.frequency)) for m in there))
    if verdict.function is None:
        return verdict.margins
    with budget(ASIDE):
        if isinstance(verdict.function, RationalFunction):
            return _of_one_port(verdict.function, verdict.kind, z0)
        found = margin(verdict.function, verdict.kind)
        return Margins(input=found) if verdict.kind is Kind.PR else Margins(reflection=found)


def _of_one_port(function: RationalFunction, kind: Kind, z0: Exact) -> Margins:
    p, q, reference = function.p, function.q, positive(z0, "z0")
    if kind is Kind.BR:
        return Margins(reflection=_reflection(p, q))
    a = allowance(Kind.PR, p, q)
    one, unit = p * reference.denominator, q * reference.numerator
    return Margins(_smallest(a, product(q, q)), _smallest(a, product(p, p)), _reflection(one - unit, one + unit))


def _smallest(num: fmpz_poly, den: fmpz_poly) -> Margin | None:
    return Margin(*infimum(num, den)) if den else None


def _reflection(p: fmpz_poly, q: fmpz_poly) -> Margin | None:
    if not q:
        return None
    low, high, frequency = infimum(-product(p, p), product(q, q), guess=-1)
    if low == -math.inf:
        return Margin(math.inf, math.inf, frequency, largest=True)
    return Margin(_root(-high, math.floor), _root(-low, math.ceil), frequency, largest=True)


def _root(x: Fraction | float, rounding: Callable[[Fraction], int]) -> Fraction:
    """Square root; exact for squares, else so near that its distance to 1 has 60 bits."""
    exact = Fraction(x)
    if (root := square_root(exact)) is not None:
        return root
    near = abs(exact - 1)
    bits = 60 + max(near.denominator.bit_length() - near.numerator.bit_length(), 0)
    shift = bits - (exact.numerator.bit_length() - exact.denominator.bit_length()) // 2
    scaled = exact * Fraction(4) ** shift
    return (math.isqrt(math.floor(scaled)) + (rounding is math.ceil)) / Fraction(2) ** shift


def margin(network: RationalMatrix | StateSpace, kind: Kind) -> Margin | None:
    """The smallest eigenvalue of (Z + Z^H)/2, or the largest singular value of S, over all frequencies.

    None where it has no bound, or none was found in MAX_ROUNDS tests.
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
                low, high = Fraction(bound), Fraction(max(best.level, bound))
                return Margin(low, high, best.w) if kind is Kind.PR else Margin(-high, -low, best.w, largest=True)
            best = min(best, _descended(kind, matrix, math.sqrt(double(x))), key=lambda place: place.level)
    return None


class _Place(NamedTuple):
    """Level to be minimised at a frequency (infinite at a pole), and the largest eigenvalue or singular value."""

    level: float
    size: float
    w: float


def _place(kind: Kind, matrix: RationalMatrix, w: float) -> _Place:
    import numpy as np

    far = w == math.inf
    value = np.array([[double(x.at_infinity()) for x in row] for row in matrix.rows] if far else matrix(1j * w))
    if not np.isfinite(value).all():  # a pole, or all but one
        return _Place(math.inf, 0.0, w)
    if kind is Kind.BR:
        size = float(np.linalg.norm(value, 2))
        return _Place(-size, size, w)
    eigenvalues = np.linalg.eigvalsh(value / 2 + value.conj().T / 2)
    return _Place(float(eigenvalues[0]), float(abs(eigenvalues).max()), w)


def _beyond(kind: Kind, n: PolynomialMatrix, d: fmpz_poly, bound: Fraction) -> Fraction | None:
    """Find x = w^2, not a pole, where the level is below a bound; None if it nowhere is."""
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
