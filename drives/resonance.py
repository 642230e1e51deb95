"""The resonance of the tension: where it would be without damping, and how much friction of the spools removes it.

For spools alike to the belt and equal belts, with M = J/r^2, D = B/r^2, k_p = k/(4 cos(theta)^2):
1/K_eff = 2/K + 1/k_p, the undamped natural frequency is sqrt(2 K_eff/M), and |f/T| rises from omega = 0 as long as

    D^2 + 8 q^2 B_belt D < 4 M K_eff,    q = k_p/(K + 2 k_p),

which is the sign of its curvature at omega = 0. There is a peak elsewhere only if the derivative of |f/T|^2 has a root
there; `peak` looks at all of these.
"""

import math
from dataclasses import dataclass
from fractions import Fraction

from drives.coupled import CoupledDrives
from drives.roots import positive_roots, squared
from drives.transfer import TransferFunction
from tline.errors import InputError


@dataclass(frozen=True)
class Peak:
    """The largest value of |H(j omega)| at a frequency above 0.

    Attributes
    ----------
    frequency : float
        rad/s.
    ratio : float
        Of the value there to |H(0)|; infinite at an undamped pole.
    """

    frequency: float
    ratio: float


def peak(transfer: TransferFunction) -> Peak | None:
    """Peak of |H(j omega)| above its value at omega = 0, None if there is none.

    The stationary points are the roots of an exact polynomial in omega^2.

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

    Examples
    --------
    >>> undamped_frequency(CoupledDrives())
    20.0
    """
    (m1, _), (m2, _) = drives.mobility(drives.left), drives.mobility(drives.right)
    return math.sqrt((1 / m1 + 1 / m2) * effective_stiffness(drives))


def effective_stiffness(drives: CoupledDrives) -> Fraction:
    """K_eff, N/m: both belts and the pulley's spring in series."""
    parts = (drives.left_belt.stiffness, drives.right_belt.stiffness, drives.pulley.belt_stiffness)
    return 1 / sum((1 / part for part in parts), Fraction(0))


def largest_friction_with_peak(drives: CoupledDrives) -> float:
    """Friction B of each spool, N m s/rad, from which on |f/T| has no peak; other parameters as given.

    Raises
    ------
    InputError
        Spools or belts differ.

    Examples
    --------
    >>> round(largest_friction_with_peak(CoupledDrives()), 9)
    0.025264715
    """
    left, right, belt = drives.left, drives.right, drives.left_belt
    if (left.inertia, left.radius) != (right.inertia, right.radius) or belt != drives.right_belt:
        raise InputError("drives", "spools or belts differ", "equal ones for this formula")
    k_p = drives.pulley.belt_stiffness
    half = 4 * (k_p / (belt.stiffness + 2 * k_p)) ** 2 * belt.damping
    m, _ = drives.mobility(left)
    product = 4 * m * effective_stiffness(drives)
    d = float(product) / (float(half) + math.sqrt(half**2 + product))  # the root without cancellation
    return d * float(left.radius**2)
