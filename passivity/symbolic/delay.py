"""A rational reflection behind a delay, H1 = exp(-tau s) H2, and the impedance or admittance Z = (1 + H1)/(1 - H1).

Z is positive real if and only if H1 is bounded real. For tau >= 0 H1 is bounded real if and only if H2 is: |H1| <= |H2|
in Re s > 0, on the axis |H1| = |H2|, and they have the same poles. For tau < 0 H1 grows without bound unless H2 = 0.
"""

from fractions import Fraction

from flint import arb, fmpq

from passivity.calculus.expand import Expansion, ExpansionError, Pair
from passivity.exact.verdict import Verdict, Witness
from passivity.exact.witness import from_axis, from_root, of_one_port
from passivity.polynomial.sign import allowance, find_sign
from passivity.rational.function import RationalFunction
from passivity.status import Kind, Status
from passivity.symbolic.domain import coefficients

_E = 1  # the generator exp(-tau s)
_MAX_DOUBLINGS = 200


def as_reflection(kind: Kind, function: Pair, tau: Pair, expansion: Expansion) -> tuple[Pair, Pair]:
    """H2 and its delay of a function H1, or Z, of s and exp(-tau s) that has this form.

    Raises
    ------
    ExpansionError
        If it has not.
    """
    p, q = function
    h = Pair(p, q) if kind is Kind.BR else Pair(p - q, p + q).reduced()
    (over, m), (under, n) = (_single_power(f) for f in h)
    return Pair(over, under), expansion.product(tau, Pair((m - n) * expansion.one, expansion.one)).reduced()


def _single_power(f) -> tuple:
    """g and k with f = g e^k, g free of e."""
    parts = [(g, k) for k, g in enumerate(coefficients(f, _E)) if g]
    if len(parts) > 1:
        raise ExpansionError("it is not exp(-T*s) times a rational reflection, nor the impedance of one")
    return parts[0] if parts else (f, 0)


def delayed_witness(verdict: Verdict, delay: Fraction) -> Witness | None:
    """s with |exp(-delay s) H2(s)| > 1, shown in ball arithmetic, for a verdict on H2 as a reflection."""
    h2 = verdict.function
    if delay < 0:
        return _growing(h2, delay)
    if verdict.status is not Status.REFUTED:
        return None
    if not delay:
        return verdict.witness
    test, allowed = of_one_port(Kind.BR, h2.p, h2.q, delay / 2), allowance(Kind.BR, h2.p, h2.q)
    sign = find_sign(allowed)
    return from_axis(test, allowed, sign) if isinstance(sign, Fraction) else from_root(test, h2.reduced().q)


def _growing(h2: RationalFunction, delay: Fraction) -> Witness | None:
    """A real s so large that exp(-delay s) |H2(s)| > 1."""
    for k in range(_MAX_DOUBLINGS):
        s = fmpq(2) ** k
        p, q = h2.p(s), h2.q(s)
        if q and abs(arb(p / q)) * (arb(fmpq(-delay.numerator, delay.denominator)) * arb(s)).exp() > 1:
            size = p / q
            return Witness(Kind.BR, Fraction(2**k), Fraction(0), ((Fraction(int(size.p), int(size.q)), Fraction(0)),))
    return None
