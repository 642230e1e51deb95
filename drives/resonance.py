"""The resonance of the tension: where it would be without damping, and how much friction of the spools removes it.

For spools alike to the belt and equal belts, with M = J/r^2, D = B/r^2, k_p = k/(4 cos(theta)^2):
1/K_eff = 2/K + 1/k_p, the undamped natural frequency is sqrt(2 K_eff/M), and with 1/K_tot = 2/(K + B_belt s) + 1/k_p
at s = j omega, f/T is proportional to 1/(2 + s (M s + D)/K_tot). With 1/K_tot = alpha - j omega beta it is larger than
at rest where

    (alpha^2 + omega^2 beta^2) D^2 + 4 beta D < 4 M alpha - M^2 omega^2 (alpha^2 + omega^2 beta^2),

so at each frequency for D below a bound; the largest of these bounds is the largest D with a peak. Most often it is the
one at omega = 0, but stiff pulleys with well damped belts resonate where the belts have become rigid.
"""

import math
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from drives.coupled import CoupledDrives
from drives.roots import positive_roots, squared
from drives.transfer import TransferFunction
from tline.errors import InputError

FINE, POINTS, REFINED = 1e-3, 2001, 4  # where the search for the bound begins, and how finely


@dataclass(frozen=True)
class Peak:
    """The largest value of |H(j omega)| at a frequency above 0.

    Attributes
    ----------
    frequency : float
        rad/s.
    ratio : float
        Ratio of the value there to |H(0)|; infinite at an undamped pole.
    """

    frequency: float
    ratio: float


def peak(transfer: TransferFunction) -> Peak | None:
    """Find the peak of |H(j omega)| above its value at omega = 0; None without such a peak.

    The stationary points are the roots of an exact polynomial in omega^2.

    Parameters
    ----------
    transfer : TransferFunction

    Raises
    ------
    InputError
        H has a pole or a zero at 0.

    Examples
    --------
    >>> peak(CoupledDrives().transfer("x_k", "T1")) is None
    True
    """
    start = transfer.dc_gain
    if not start or isinstance(start, float):
        raise InputError(transfer.name, "has no finite value other than 0 at rest", "another output")
    undamped = [z.imag for z in transfer.poles if z.real == 0 and z.imag > 0]
    if undamped:
        return Peak(min(undamped), math.inf)
    p, q = squared(transfer.p), squared(transfer.q)
    found = []
    for x in positive_roots(p.derivative() * q - p * q.derivative()):
        w = math.sqrt(x)
        found.append(Peak(w, float(abs(transfer(1j * w))) / abs(float(start))))
    found = [one for one in found if one.ratio > 1]
    return max(found, key=lambda one: one.ratio, default=None)


def undamped_frequency(drives: CoupledDrives) -> float:
    """Natural frequency of the tension without any damping, rad/s: sqrt((1/M1 + 1/M2)*K_eff).

    Parameters
    ----------
    drives : CoupledDrives

    Examples
    --------
    >>> undamped_frequency(CoupledDrives())
    20.0
    """
    _massless(drives)
    (m1, _), (m2, _) = drives.mobility(drives.left), drives.mobility(drives.right)
    return math.sqrt((1 / m1 + 1 / m2) * effective_stiffness(drives))


def _massless(drives: CoupledDrives) -> None:
    if drives.pulley.mass:
        raise InputError("pulley.mass", "not in this formula", "0, or `peak` of a transfer function")


def effective_stiffness(drives: CoupledDrives) -> Fraction:
    """K_eff, N/m: both belts and the pulley's spring in series.

    Parameters
    ----------
    drives : CoupledDrives

    Examples
    --------
    >>> effective_stiffness(CoupledDrives())
    Fraction(20, 1)
    """
    parts = (drives.left_belt.stiffness, drives.right_belt.stiffness, drives.pulley.belt_stiffness)
    return 1 / sum((1 / part for part in parts), Fraction(0))


def largest_friction_with_peak(drives: CoupledDrives) -> float:
    """Friction B of each spool, N m s/rad, from which on |f/T| has no peak; other parameters as given.

    Parameters
    ----------
    drives : CoupledDrives

    Raises
    ------
    InputError
        Spools or belts differ.

    Examples
    --------
    >>> round(largest_friction_with_peak(CoupledDrives()), 9)
    0.025264715
    """
    _massless(drives)
    left, right, belt = drives.left, drives.right, drives.left_belt
    if (left.inertia, left.radius) != (right.inertia, right.radius) or belt != drives.right_belt:
        raise InputError("drives", "spools or belts differ", "equal ones for this formula")
    m, k_p = float(drives.mobility(left)[0]), float(drives.pulley.belt_stiffness)
    stiff, damped = float(belt.stiffness), float(belt.damping)

    def bound(omega: NDArray) -> NDArray:
        """Return the largest D with |f/T| above its value at rest, 0 where no D has it."""
        size = stiff**2 + (omega * damped) ** 2
        alpha, beta = 1 / k_p + 2 * stiff / size, 2 * damped / size
        a, c = alpha**2 + (omega * beta) ** 2, 4 * m * alpha
        c = c - (m * omega) ** 2 * a
        with np.errstate(invalid="ignore"):
            return np.where(c > 0, c / (2 * beta + np.sqrt(4 * beta**2 + a * c)), 0.0)  # no cancellation

    fastest = 2 * math.sqrt(k_p / m)  # above it nothing exceeds the value at rest
    slowest = min(fastest, stiff / damped if damped else fastest, math.sqrt(float(effective_stiffness(drives)) / m))
    omega = np.concatenate([[0.0], np.geomspace(FINE * slowest, fastest, POINTS)])
    for _ in range(REFINED):
        best = int(np.argmax(bound(omega)))
        omega = np.linspace(omega[max(best - 1, 0)], omega[min(best + 1, len(omega) - 1)], POINTS)
    return float(bound(omega).max() * left.radius**2)
