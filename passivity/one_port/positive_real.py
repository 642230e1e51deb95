"""Exact verdicts: is an impedance positive real, is a reflection bounded real?

Z = p/q is positive real if and only if Re p(jw) conj q(jw) >= 0 for all w and, after cancelling common factors, all
roots of p + q lie in Re s < 0. Poles and residues need no look of their own. H = p/q is bounded real if and only if
(1 + H)/(1 - H) = (q + p)/(q - p) is positive real, that is |q|^2 - |p|^2 >= 0 and all roots of q lie in Re s < 0.

References
----------
M. Z. Q. Chen, M. C. Smith, "A note on tests for positive-real functions", IEEE Transactions on Automatic Control 54
(2009), 390-393.
"""

from fractions import Fraction

from flint import fmpz_poly

from passivity.budget import VERDICT, budget
from passivity.errors import ExpressionError
from passivity.one_port.axis import allowance
from passivity.one_port.hurwitz import routh_column
from passivity.one_port.polynomial_sign import UndecidedError, coprime, find_sign
from passivity.one_port.verdict import Certificate, Verdict
from passivity.one_port.witness import from_axis, from_root
from passivity.rational.function import RationalFunction
from passivity.status import Kind, Status


def check_positive_real(z: RationalFunction | str) -> Verdict:
    """Is Z analytic with Re Z >= 0 in the right half plane, that is, is a one-port with this impedance passive?

    Parameters
    ----------
    z : RationalFunction or str
        An impedance or an admittance; open and short circuit included. Taken exactly as given.

    Examples
    --------
    >>> of = RationalFunction.from_expression
    >>> check_positive_real(of("50 + 1n*s + 1/(1p*s)")).status
    <Status.PROVED: 'proved'>
    >>> verdict = check_positive_real(of("1/(s^2 + s + 1) - 1/100"))
    >>> verdict.status, verdict.witness.re > 0, verdict.witness.value_re < 0
    (<Status.REFUTED: 'refuted'>, True, True)
    """
    return check(z, Kind.PR)


def check_bounded_real(h: RationalFunction | str) -> Verdict:
    """Is H analytic with |H| <= 1 in the right half plane, that is, does a reflection never return more than came?

    Parameters
    ----------
    h : RationalFunction or str
        Taken exactly as given.

    Examples
    --------
    >>> check_bounded_real(RationalFunction.from_expression("(1 - s)/(1 + s)")).lossless
    True
    """
    return check(h, Kind.BR)


def check(function: RationalFunction | str, kind: Kind) -> Verdict:
    """The verdict of one of the two functions above."""
    if isinstance(function, str):
        function = RationalFunction.from_expression(function)
    elif not isinstance(function, RationalFunction):
        expected = "a RationalFunction or the text of one; passivity.is_positive_real takes more"
        raise ExpressionError("function", "not a rational function", expected, type(function).__name__)
    p, q = function.p, function.q
    with budget(VERDICT):
        return _checked(function, kind, p, q)


def _checked(function: RationalFunction, kind: Kind, p: fmpz_poly, q: fmpz_poly) -> Verdict:
    try:
        allowed = allowance(kind, p, q)
        sign = find_sign(allowed)
        if isinstance(sign, Fraction):
            witness = from_axis(kind, p, q, allowed, sign)
            return Verdict(kind, function, Status.REFUTED, witness=witness, hidden=_hidden(_common(p, q)))
        lossless, common = not allowed, fmpz_poly([1])
        column = routh_column(_closing(kind, p, q))
        if column is None and (common := _common(p, q)).degree() > 0:
            p, q = p // common, q // common
            sign = find_sign(allowance(kind, p, q))
            assert not isinstance(sign, Fraction)
            column = routh_column(_closing(kind, p, q))
        hidden = _hidden(common)
        if column is None:
            witness = from_root(kind, function.p, function.q, _closing(kind, p, q))
            return Verdict(kind, function, Status.REFUTED, witness=witness, lossless=lossless, hidden=hidden)
    except UndecidedError as error:
        return Verdict(kind, function, Status.UNDECIDED, budget=str(error))
    certificate = Certificate(kind, function, common, sign, column)
    return Verdict(kind, function, Status.PROVED, certificate, lossless=lossless, hidden=hidden)


def _closing(kind: Kind, p: fmpz_poly, q: fmpz_poly) -> fmpz_poly:
    return p + q if kind is Kind.PR else q


def _common(p: fmpz_poly, q: fmpz_poly) -> fmpz_poly:
    return fmpz_poly([1]) if coprime(p, q) else p.gcd(q)


def _hidden(common: fmpz_poly) -> fmpz_poly | None:
    return common if common.degree() > 0 and routh_column(common) is None else None
