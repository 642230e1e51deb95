"""Ideal elements with several ports: no losses, no memory, and not always impedances.

All flows are counted into the element; waves a and b are those of ports with the same reference resistance.
"""

from passivity.errors import ExpressionError, shown
from passivity.multiport.cayley import scattering
from passivity.multiport.matrix import MAX_PORTS, RationalMatrix
from passivity.rational.evaluate import Exact, exact


def transformer_scattering(ratio: Exact) -> RationalMatrix:
    """S of the ideal transformer u1 = n u2, y2 = -n y1; it has no impedances.

    Parameters
    ----------
    ratio : int, float, Fraction, Decimal or str
        n, dimensionless.

    Raises
    ------
    ExpressionError
        It is no number.

    Examples
    --------
    >>> print(transformer_scattering(2))
    [(3)/(5), (4)/(5); (4)/(5), (-3)/(5)]
    """
    n = exact(ratio, "ratio")
    square = n * n + 1
    return RationalMatrix.from_rows([[(n * n - 1) / square, 2 * n / square], [2 * n / square, (1 - n * n) / square]])


def gyrator_impedances(resistance: Exact) -> RationalMatrix:
    """Z of the gyrator u1 = -r y2, u2 = r y1.

    Parameters
    ----------
    resistance : int, float, Fraction, Decimal or str
        r, ohm or Pa s/m³.

    Raises
    ------
    ExpressionError
        It is no number.

    Examples
    --------
    >>> print(gyrator_impedances("2 ohm"))
    [(0)/(1), (-2)/(1); (2)/(1), (0)/(1)]
    """
    r = exact(resistance, "resistance")
    return RationalMatrix.from_rows([[0, -r], [r, 0]])


def gyrator_scattering(resistance: Exact, z0: Exact = 1) -> RationalMatrix:
    """S of the same gyrator.

    Parameters
    ----------
    resistance : int, float, Fraction, Decimal or str
        r of the gyrator.
    z0 : int, float, Fraction, Decimal or str
        Reference resistance of all ports, above zero.

    Raises
    ------
    ExpressionError
        One is no number, or z0 is not above zero.

    Examples
    --------
    >>> print(gyrator_scattering("50 ohm", 50))
    [(0)/(1), (-1)/(1); (1)/(1), (0)/(1)]
    """
    return scattering(gyrator_impedances(resistance), z0)


def circulator_scattering(ports: int = 3) -> RationalMatrix:
    """S of the circulator that hands what enters at a port to the next; 2 to MAX_PORTS ports.

    Parameters
    ----------
    ports : int
        Number of ports.

    Raises
    ------
    ExpressionError
        There are too few or too many.

    Examples
    --------
    >>> print(circulator_scattering())
    [(0)/(1), (0)/(1), (1)/(1); (1)/(1), (0)/(1), (0)/(1); (0)/(1), (1)/(1), (0)/(1)]
    """
    if not isinstance(ports, int) or not 1 < ports <= MAX_PORTS:
        raise ExpressionError("ports", "not a number of ports", f"from 2 to {MAX_PORTS}", shown(ports, repr))
    return RationalMatrix.from_rows([[int(i == (k + 1) % ports) for k in range(ports)] for i in range(ports)])
