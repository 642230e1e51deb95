"""Head lost along a pipe by the three laws that EPANET knows."""

from collections.abc import Callable
from math import log10, pi

FOOT = 0.3048  # m; the coefficients of the laws are made for feet
GRAVITY = 32.2 * FOOT  # m/s², EPANET's
LAMINAR, TURBULENT = 2000.0, 4000.0  # Reynolds numbers


def hazen_williams(flow: float, length: float, diameter: float, roughness: float) -> float:
    """Head lost, m, at a flow of m³/s through a pipe of given length and diameter, m, and coefficient C.

    References
    ----------
    EPANET 2.2 User Manual, table 3.1.

    Examples
    --------
    >>> round(hazen_williams(0.1, 1000.0, 0.3, 100.0), 3)
    10.447
    """
    return 4.727 * length * roughness**-1.852 * (diameter / FOOT) ** -4.871 * (flow / FOOT**3) ** 1.852


def chezy_manning(flow: float, length: float, diameter: float, roughness: float) -> float:
    """Head lost, m, at a flow of m³/s through a pipe of given length and diameter, m, and Manning's n.

    References
    ----------
    EPANET 2.2 User Manual, section 3.1: Manning's formula with 1.49 for feet and an exponent of 1.333 for 4/3.

    Examples
    --------
    >>> round(chezy_manning(0.1, 1000.0, 0.3, 0.012), 3)
    9.058
    """
    speed = flow / (pi / 4 * diameter**2) / FOOT
    return length * (roughness * speed / 1.49) ** 2 / (diameter / FOOT / 4) ** 1.333


def darcy_weisbach(flow: float, length: float, diameter: float, roughness: float, viscosity: float) -> float:
    """Head lost, m, at a flow of m³/s through a pipe of given length, diameter and roughness, m; viscosity in m²/s.

    Examples
    --------
    >>> round(darcy_weisbach(0.1, 1000.0, 0.3, 1e-4, 1e-6), 3)
    5.716
    """
    speed = flow / (pi / 4 * diameter**2)
    factor = _darcy_factor(speed * diameter / viscosity, roughness / diameter)
    return factor * length / diameter * speed**2 / (2 * GRAVITY)


def _darcy_factor(reynolds: float, roughness: float) -> float:
    """Hagen and Poiseuille's, Swamee and Jain's, and Dunlop's cubic between (EPANET 2.2 User Manual, section 3.1).

    The cubic meets the turbulent law at 4000 with its slope, as in EPANET's code; the manual prints one term otherwise.
    """
    if reynolds < LAMINAR:
        return 64 / reynolds
    y2 = roughness / 3.7 + 5.74 / max(reynolds, TURBULENT) ** 0.9
    y3 = -2 * log10(y2)
    fa = y3**-2
    if reynolds > TURBULENT:
        return fa
    r, fb = reynolds / LAMINAR, fa * (2 - 0.00514215 / (y2 * y3))
    x1, x2, x3 = 7 * fa - fb, 0.128 - 17 * fa + 2.5 * fb, -0.128 + 13 * fa - 2 * fb
    return x1 + r * (x2 + r * (x3 + r * (0.032 - 3 * fa + 0.5 * fb)))


LAWS: dict[str, Callable[..., float]] = {
    "H-W": hazen_williams, "C-M": chezy_manning, "D-W": darcy_weisbach,
}  # fmt: skip
