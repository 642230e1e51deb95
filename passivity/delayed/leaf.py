"""What the exact test proves of a rational function: discs with its values, and its argument."""

import math
from collections.abc import Iterator
from fractions import Fraction
from itertools import product

from flint import fmpz_poly

from passivity.delayed.disc import RIGHT, UNIT, Disc
from passivity.delayed.form import of_rational
from passivity.delayed.proof import ProofStep
from passivity.one_port.axis import allowance
from passivity.one_port.hurwitz import routh_column
from passivity.one_port.margin import Margin, margins
from passivity.one_port.polynomial_sign import UndecidedError, find_sign
from passivity.one_port.verdict import Certificate, Verdict
from passivity.rational.function import RationalFunction
from passivity.status import Kind, Status

MAX_DEGREE = 16  # above, only Re >= 0 and modulus <= 1 are tried

_S = RationalFunction(fmpz_poly([0, 1]), fmpz_poly([1]))


def leaves(r: RationalFunction) -> Iterator[ProofStep]:
    """Proved facts about a rational function, the sharpest half-planes and discs among them where they are found.

    Examples
    --------
    >>> for step in leaves(RationalFunction.from_expression("1/(1 + s)")):
    ...     print(step)
    1/(s + 1): in the disc on [0, 1]
    1/(s + 1): Re >= 0
    1/(s + 1): Re <= 1
    1/(s + 1): | | <= 1
    1/(s + 1): |arg| <= 90°
    """
    for disc in _candidates(r):
        if certificate := _certificate(moved(r, disc)):
            yield ProofStep("rational", of_rational(r), disc, certificate=certificate)
    for turns, candidate in ((1, r), (2, r / _S), (2, r * _S)):
        if not r.is_zero and (certificate := _certificate(candidate)):
            yield ProofStep("rational", of_rational(r), Fraction(turns), certificate=certificate)
            return
    if parts := _two_factors(r):
        yield ProofStep("factors", of_rational(r), Fraction(2), parts)


def _two_factors(r: RationalFunction) -> tuple[ProofStep, ProofStep] | None:
    """Two positive real functions with the product r, one of them a quotient of prime factors."""
    if r.is_zero or r.degree > MAX_DEGREE:
        return None
    above, below = ([f for f, _ in side.factor()[1]] for side in (r.p, r.q))
    for f, g in product(above, [fmpz_poly([1]), *below]):
        one = RationalFunction(f, g)
        certificates = _certificate(one), _certificate(other := (r / one).reduced())
        if all(certificates):
            first, second = (
                ProofStep("rational", of_rational(z), Fraction(1), certificate=c)
                for z, c in zip((one, other), certificates, strict=True)
            )
            return first, second
    return None


def _certificate(z: RationalFunction) -> Certificate | None:
    """The exact test's proof that a function is positive real; no witness if it is not, for that takes longer."""
    r = z.reduced()
    try:
        sign = find_sign(allowance(Kind.PR, r.p, r.q))
    except UndecidedError:
        return None
    if isinstance(sign, Fraction) or (column := routh_column(r.p + r.q)) is None:
        return None
    return Certificate(Kind.PR, r, fmpz_poly([1]), sign, column)


def moved(r: RationalFunction, disc: Disc) -> RationalFunction:
    """What must be positive real, for the values of r to lie in a disc that is not a point.

    Examples
    --------
    >>> print(moved(RationalFunction.from_expression("s"), UNIT))
    (-1*s - 1)/(s - 1)
    """
    if disc.high == math.inf:
        return r - disc.low
    return disc.high - r if disc.low == -math.inf else (r - disc.low) / (disc.high - r)


def _candidates(r: RationalFunction) -> list[Disc]:
    """The half-planes and discs that the extremes on the axis suggest."""
    if r.degree > MAX_DEGREE:
        return [RIGHT, UNIT]
    try:
        low, high = (_end(margins(Verdict(Kind.PR, f, Status.UNDECIDED)).input) for f in (r, -r))
        most = _end(margins(Verdict(Kind.BR, r, Status.UNDECIDED)).reflection, upper=True)
    except UndecidedError:
        return [RIGHT, UNIT]
    found = [Disc(low, -high)] if low is not None and high is not None and low < -high else []
    found += [Disc(low, math.inf)] if low is not None else []
    found += [Disc(-math.inf, -high)] if high is not None else []
    return [*found, *([Disc(-most, most)] if most else [])]


def _end(margin: Margin | None, upper: bool = False) -> Fraction | None:
    """The end of a margin's enclosure that is not passed."""
    end = math.inf if margin is None else margin.high if upper else margin.low
    return None if end in (math.inf, -math.inf) else Fraction(end)
