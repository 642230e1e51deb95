"""Does a verdict hold for every function whose coefficients are within a relative tolerance of the given ones?

At a fixed frequency the values of p and q fill two rectangles, whose corners belong to Kharitonov's polynomials, and
Re p conj q is linear in each of its four real arguments. So all functions of the box are positive real if and only if
Re p conj q >= 0 for the 16 pairs of corners and p + q is Hurwitz at 4 of them.

References
----------
V. L. Kharitonov, "Asymptotic stability of an equilibrium position of a family of systems of linear differential
equations", Differential Equations 14 (1979), 1483-1485.
"""

from dataclasses import dataclass
from fractions import Fraction
from itertools import product

from flint import fmpz, fmpz_poly

from passivity.errors import ExpressionError, shown
from passivity.exact.positive_real import check_positive_real
from passivity.polynomial.roots import routh_column
from passivity.polynomial.sign import SignProof, find_sign, parts
from passivity.rational.evaluate import Exact, exact
from passivity.rational.function import RationalFunction
from passivity.status import Kind, Status
from passivity.verdict import Verdict, Witness

_X = fmpz_poly([0, 1])


@dataclass(frozen=True)
class Robustness:
    """Whether a verdict is the same in a box of coefficients.

    Parameters
    ----------
    tolerance : Fraction
        Each coefficient c lies between c - tolerance |c| and c + tolerance |c|; zeros stay.
    same : bool or None
        None if neither is shown: the witness of a refutation fails somewhere in the box.
    exception : RationalFunction or None
        A function of the box with another verdict.
    """

    tolerance: Fraction
    same: bool | None
    exception: RationalFunction | None = None


def robustness(verdict: Verdict, tolerance: Exact) -> Robustness:
    """Is every function within a relative tolerance of the given one positive real too, or not either?

    Parameters
    ----------
    verdict : Verdict
        Of `check_positive_real`.
    tolerance : int, float, Fraction, Decimal or str
        At least 0, below 1; half an ulp of double precision is ``2**-53``.

    Raises
    ------
    ExpressionError
        For another tolerance, or a verdict that is undecided or about a reflection.

    Examples
    --------
    >>> touching = check_positive_real(RationalFunction.from_expression("(s^2 + s + 1)/(s^2 + s + 4)"))
    >>> robustness(touching, 0).same, robustness(touching, "1e-9").same
    (True, False)
    """
    eps = exact(tolerance, "tolerance")
    if not 0 <= eps < 1:
        raise ExpressionError("tolerance", "out of range", "at least 0 and below 1", shown(tolerance))
    one_port = isinstance(verdict.function, RationalFunction) and verdict.kind is Kind.PR and not verdict.is_discrete
    if verdict.status is Status.UNDECIDED or not one_port:
        raise ExpressionError("verdict", "has no box to ask about", "of one port, positive real proved or refuted")
    if verdict.witness:
        return Robustness(eps, _refutes_all(verdict.function, verdict.witness, eps) or None)
    p, q = _corners(verdict.function.p, eps), _corners(verdict.function.q, eps)
    for a, b, c, d in product((0, 1), repeat=4):
        sign = find_sign(p[0][a] * q[0][b] + _X * (p[1][c] * q[1][d]))
        if not isinstance(sign, SignProof):
            return _exception(eps, _whole(p[0][a], p[1][c]), _whole(q[0][b], q[1][d]))
    for a, c in product((0, 1), repeat=2):
        corner = _whole(p[0][a], p[1][c]), _whole(q[0][a], q[1][c])
        if routh_column(corner[0] + corner[1]) is None:
            return _exception(eps, *corner)
    return Robustness(eps, True)


def _exception(eps: Fraction, p: fmpz_poly, q: fmpz_poly) -> Robustness:
    found = RationalFunction(p, q)
    differs = check_positive_real(found).status is Status.REFUTED
    return Robustness(eps, False, found) if differs else Robustness(eps, None)


def _corners(f: fmpz_poly, eps: Fraction) -> tuple[list[fmpz_poly], list[fmpz_poly]]:
    """Lowest and highest even part u(x), and odd part v(x), of f(jw) = u + jw v; times the denominator of eps."""
    up, down = eps.numerator, eps.denominator
    u, v = ([fmpz_poly([c * down + side * abs(c) * up for c in g.coeffs()]) for side in (-1, 1)] for g in parts(f))
    return u, v


def _whole(u: fmpz_poly, v: fmpz_poly) -> fmpz_poly:
    """The polynomial f with f(jw) = u(x) + jw v(x)."""
    c = [fmpz(0)] * (2 * max(len(u), len(v)))
    c[: 2 * len(u) : 2] = [-a if k % 2 else a for k, a in enumerate(u.coeffs())]
    c[1 : 2 * len(v) + 1 : 2] = [-a if k % 2 else a for k, a in enumerate(v.coeffs())]
    return fmpz_poly(c)


def _refutes_all(z: RationalFunction, witness: Witness, eps: Fraction) -> bool:
    """Whether Re p conj q < 0 at the witness for all coefficients in the box."""
    p, q = _box(z.numerator, witness, eps), _box(z.denominator, witness, eps)
    return sum(max(a * b for a in p[k] for b in q[k]) for k in (0, 1)) < 0


def _box(coefficients: tuple[Fraction, ...], s: Witness, eps: Fraction) -> list[tuple[Fraction, Fraction]]:
    """Intervals of real and imaginary part of a polynomial at the witness."""
    power, middle, spread = (Fraction(1), Fraction(0)), [Fraction(0), Fraction(0)], [Fraction(0), Fraction(0)]
    for c in reversed(coefficients):
        for k in (0, 1):
            middle[k] += c * power[k]
            spread[k] += abs(c * power[k]) * eps
        power = power[0] * s.re - power[1] * s.im, power[0] * s.im + power[1] * s.re
    return [(m - d, m + d) for m, d in zip(middle, spread, strict=True)]
