"""Scattering matrices from impedances and back, S = (Z - I)(Z + I)^-1, Z = (I + S)(I - S)^-1.

All flows are counted into the network; waves a and b are those of ports with the same reference resistance.
"""

from flint import fmpz_poly

from passivity.errors import ExpressionError
from passivity.rational.evaluate import Exact, positive
from passivity.rational.function import RationalFunction
from passivity.rational.matrix import RationalMatrix
from passivity.rational.polynomial_matrix import PolynomialMatrix, add, identity, minor_sums, scaled


def scattering(z: RationalMatrix, z0: Exact = 1) -> RationalMatrix:
    """Scattering matrix of a network with these impedances, all ports referred to the same resistance.

    Parameters
    ----------
    z : RationalMatrix
        Of the network.
    z0 : int, float, Fraction, Decimal or str
        Above zero.

    Raises
    ------
    ExpressionError
        If z0 is not above zero, or Z + z0 I has no inverse.

    Examples
    --------
    >>> print(scattering(RationalMatrix.from_rows([["100"]]), "50 ohm"))
    [(1)/(3)]
    """
    n, d = z.fraction
    reference = positive(z0, "z0")
    c, x = inverted(scaled(n, reference.denominator), d * reference.numerator)
    if not c:
        raise ExpressionError("Z + z0 I", "has no inverse", "a network that is not active everywhere")
    return _quotient(add(identity(z.size, c), scaled(x, -2)), c)


def impedances(s: RationalMatrix, z0: Exact = 1) -> RationalMatrix:
    """Impedances of a network with this scattering matrix; the inverse of `scattering`.

    Parameters
    ----------
    s : RationalMatrix
        Of the network.
    z0 : int, float, Fraction, Decimal or str
        Reference resistance of all ports, above zero.

    Raises
    ------
    ExpressionError
        If z0 is not above zero, or I - S has no inverse: an ideal transformer, for one, has no impedances.

    Examples
    --------
    >>> print(impedances(RationalMatrix.from_rows([["(1 - s)/(1 + s)"]])))
    [(1)/(s)]
    """
    n, d = s.fraction
    reference = positive(z0, "z0")
    c, x = inverted(scaled(n, -1), d)
    if not c:
        raise ExpressionError("I - S", "has no inverse: there are no impedances", "a network that has them")
    top = scaled(add(scaled(x, 2), identity(s.size, -c)), reference.numerator)
    return _quotient(top, c * reference.denominator)


def inverted(n: PolynomialMatrix, d: fmpz_poly) -> tuple[fmpz_poly, PolynomialMatrix]:
    """c and X, coprime, with (n/d + I)^-1 = X/c; c is zero if there is no inverse."""
    unit = d // d.content()
    sums, (adjugate, power) = minor_sums(add(n, identity(len(n), d)), unit)
    c, more = sums[-1]
    if not c:
        return c, adjugate
    x = scaled(adjugate, d * unit ** max(power - more, 0))
    c = common = c * unit ** max(more - power, 0)
    for entry in (entry for row in x for entry in row):
        common = common.gcd(entry)
    return c // common, [[entry // common for entry in row] for row in x]


def _quotient(n: PolynomialMatrix, d: fmpz_poly) -> RationalMatrix:
    return RationalMatrix(tuple(tuple(RationalFunction(x, d).reduced() for x in row) for row in n))
