"""Belt speed and tension moved apart: the decoupler, and the relative gains without it.

For spools alike to the belt (equal J/r^2 and B/r^2) the sum of the torques moves only the tension and their
difference only the belt speed, so with T1 = (tau_f - tau_v)/2, T2 = (tau_f + tau_v)/2 the plant falls in two. Without
it the relative gain array is 1/2 at every frequency: each torque moves both outputs equally, the worst pairing there is
(E. H. Bristol, 1966, doi:10.1109/TAC.1966.1098266). For other spools an inner feedback of their speeds and the tension
makes them behave like two alike, of the mean M and D; radii enter as T_i = r_i/r_m*(...), r_m their mean.
"""

from dataclasses import replace
from fractions import Fraction
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drives.coupled import CoupledDrives
from drives.number import rational
from drives.parts import Spool
from drives.symbolic import INPUTS
from drives.transfer import TransferFunction, frequencies
from tline.errors import check_kind


def alike(drives: CoupledDrives) -> CoupledDrives:
    """Return the drives with two spools of the mean M and D, the effect of the inner feedback.

    Parameters
    ----------
    drives : CoupledDrives

    Examples
    --------
    >>> alike(CoupledDrives()) == CoupledDrives()
    True
    """
    check_kind("drives", drives, CoupledDrives)
    (m1, d1), (m2, d2) = drives.mobility(drives.left), drives.mobility(drives.right)
    m, d = (m1 + m2) / 2, (d1 + d2) / 2
    left, right = (Spool(m * x.radius**2, d * x.radius**2, x.radius) for x in (drives.left, drives.right))
    return replace(drives, left=left, right=right)


class Share(NamedTuple):
    """Torque of one motor: T = share*(tau_f -/+ tau_v)/2 + per_speed*w + per_tension*f, minus for spool 1.

    Attributes
    ----------
    share : Fraction
        Of the torque asked for, dimensionless.
    per_speed : Fraction
        Feedback of the spool's own speed [N m s/rad].
    per_tension : Fraction
        Feedback of the tension [m].
    """

    share: Fraction
    per_speed: Fraction
    per_tension: Fraction


def decoupler(drives: CoupledDrives) -> tuple[Share, Share]:
    """The decoupler with the inner feedback that makes unequal spools alike.

    Parameters
    ----------
    drives : CoupledDrives

    Examples
    --------
    >>> [tuple(map(float, share)) for share in decoupler(CoupledDrives())]
    [(1.0, 0.0, 0.0), (1.0, 0.0, 0.0)]
    """
    same, mean = alike(drives), (drives.left.radius + drives.right.radius) / 2
    found = []
    for spool, twin, sign in ((drives.left, same.left, -1), (drives.right, same.right, 1)):
        ratio = spool.inertia / twin.inertia
        friction = sign * (spool.friction - ratio * twin.friction)
        found.append(Share(spool.radius * ratio / mean, friction, spool.radius * (1 - ratio)))
    return found[0], found[1]


def decoupled(drives: CoupledDrives) -> tuple[TransferFunction, TransferFunction]:
    """belt_speed/tau_v and tension/tau_f behind the decoupler.

    Parameters
    ----------
    drives : CoupledDrives

    Examples
    --------
    >>> for plant in decoupled(CoupledDrives()):
    ...     print(plant)
    belt_speed/tau_v = 50/(s + 100)
    tension/tau_f = 10000/(s^2 + 500*s + 2000)
    """
    same = alike(drives)
    mean = (drives.left.radius + drives.right.radius) / 2
    speed, tension = same.transfer("belt_speed", "T2"), same.transfer("tension", "T1")
    scale2, scale1 = (rational(spool.radius / mean) for spool in (drives.right, drives.left))
    return (
        TransferFunction(speed.p * scale2, speed.q, "belt_speed/tau_v"),
        TransferFunction(tension.p * scale1, tension.q, "tension/tau_f"),
    )


def relative_gain_array(drives: CoupledDrives, omega: ArrayLike) -> NDArray[np.complex128]:
    """Bristol's array from (T1, T2) to (belt_speed, tension), shape (2, 2, n).

    Parameters
    ----------
    drives : CoupledDrives
    omega : array_like, shape (n,)
        Angular frequencies [rad/s], 0 or more.

    Raises
    ------
    InputError
        A frequency is negative or not finite.

    Examples
    --------
    >>> np.round(relative_gain_array(CoupledDrives(), [0.0, 100.0]).real[0, 0], 12)
    array([0.5, 0.5])
    """
    (a, b), (c, d) = ([drives.transfer(out, torque) for torque in INPUTS] for out in ("belt_speed", "tension"))
    straight, crossed = a.p * d.p * b.q * c.q, b.p * c.p * a.q * d.q  # of a*d/(a*d - b*c), over one denominator
    first = TransferFunction(straight, straight - crossed, "relative gain")(1j * np.atleast_1d(frequencies(omega)))
    return np.array([[first, 1 - first], [1 - first, first]])
