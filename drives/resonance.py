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
from flint import fmpq_poly
from numpy.typing import NDArray

from drives.coupled import CoupledDrives
from drives.number import positive_roots, rational, roots, squared
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


ANGLE = ("free angle", "where the spools stand changes nothing: no force depends on it, and only the angles show it")
SPEED = ("common speed", "both spools slow down at the same rate B/J, so the tension never feels it")
BELTS = ("belts against each other", "both carry the same tension and relax at the same rate K/B: nothing drives it")
TENSION = ("tension", "spools alike to the belt share it with opposite signs, so their mean speed never sees it")
ALIKE = (
    "spools and belts alike",
    "B/J = K/B with these numbers: both die out at the same rate and the tension stays 0",
)
CHANCE = ("coincidence", "with these numbers the mode is not reached or not seen")


@dataclass(frozen=True)
class HiddenMode:
    """An irreducible factor of det(sI - A) that is cancelled in a transfer function.

    Attributes
    ----------
    poles : tuple of complex
        Its roots, rad/s.
    times : int
        How often it is cancelled.
    names, reasons : tuple of str
        Moving quantity and why it is hidden, one for each time.
    uncontrollable, unobservable : int
        How often it is uncontrollable from the torque, and how often unobservable from the output.
    """

    poles: tuple[complex, ...]
    times: int
    names: tuple[str, ...]
    reasons: tuple[str, ...]
    uncontrollable: int
    unobservable: int


def hidden_modes(drives: CoupledDrives, output: str, source: str) -> list[HiddenMode]:
    """Modes of the full model that the transfer function from a torque to an output does not have.

    Parameters
    ----------
    drives : CoupledDrives
    output, source : str
        Of ``OUTPUTS`` and ``INPUTS``.

    Raises
    ------
    InputError
        An unknown name.

    Examples
    --------
    >>> for mode in hidden_modes(CoupledDrives(), "x_k", "T1"):
    ...     print([p.real for p in mode.poles], mode.names)
    [0.0] ('free angle',)
    [-100.0] ('common speed', 'belts against each other', 'spools and belts alike')
    """
    full = drives.state_space((output,), (source,))
    reached, seen = full.reached(), full.dual().reached()
    cancelled = full.modes // full.minimal().modes
    known = _structure(drives, output)
    left_over = TENSION if output == "belt_speed" and drives.symmetric else None
    found = []
    for factor, times in cancelled.factor()[1]:
        names = [name for polynomial, name in known if polynomial % factor == 0][:times]
        rest = left_over or (ALIKE if names and _of_spools_alike(drives, factor) else CHANCE)
        names += [rest] * (times - len(names))
        unreached, unseen = (_times(factor, full.modes // part.modes) for part in (reached, seen))
        told = tuple(name for name, _ in names), tuple(why for _, why in names)
        found.append(HiddenMode(tuple(roots(factor)), times, *told, unreached, unseen))
    return sorted(found, key=lambda mode: -mode.poles[0].real)


def _structure(drives: CoupledDrives, output: str) -> list[tuple[fmpq_poly, tuple[str, str]]]:
    """The modes that can be hidden for a reason that lies in the mechanism."""
    spools = [fmpq_poly([rational(x.friction), rational(x.inertia)]) for x in (drives.left, drives.right)]
    belts = [fmpq_poly([rational(x.stiffness), rational(x.damping)]) for x in (drives.left_belt, drives.right_belt)]
    found = []
    if not output.startswith("phi"):
        found.append((fmpq_poly([0, 1]), ANGLE))
    if output in ("x_k", "tension") and spools[0].gcd(spools[1]).degree() == 1:
        found.append((spools[0], SPEED))
    if belts[0].gcd(belts[1]).degree() == 1:
        found.append((belts[0], BELTS))
    return found


def _of_spools_alike(drives: CoupledDrives, factor: fmpq_poly) -> bool:
    """Whether both spools, on their own, have this mode."""
    return all(
        fmpq_poly([rational(x.friction), rational(x.inertia)]) % factor == 0 for x in (drives.left, drives.right)
    )


def _times(factor: fmpq_poly, polynomial: fmpq_poly) -> int:
    count = 0
    while polynomial.degree() > 0 and polynomial % factor == 0:
        polynomial, count = polynomial // factor, count + 1
    return count
