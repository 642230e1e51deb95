"""Spool, belt and pulley: the numbers of each, and the spring that a pulley is to the belt.

Signs: belt speeds count positive from spool 1 to spool 2, tension is positive. T1 > 0 brakes spool 1 and T2 > 0 pulls
spool 2, so both tighten the belt; the power supplied is T2*w2 - T1*w1. The pulley's deflection x_k is negative under
tension, as in the exercise's Modelica text.
"""

import math
from dataclasses import dataclass, field
from fractions import Fraction

from drives.number import Number, exact, fill, positive
from tline.errors import InputError

COSINES_SQUARED = {30: Fraction(3, 4), 45: Fraction(1, 2), 60: Fraction(1, 4)}  # all rational ones, by Niven's theorem
HALF = Fraction(1, 2)


@dataclass(frozen=True, init=False)
class Spool:
    """A spool on its motor's shaft: J dw/dt = torque - B w + r F, with torque and belt force F in the sense of w.

    Parameters
    ----------
    inertia : number
        Moment of inertia J of the spool, kg m^2, more than 0.
    friction : number
        Friction B of its bearing, N m s/rad, 0 or more.
    radius : number
        Radius r of the spool, m, more than 0.

    Raises
    ------
    InputError
        A value that no spool can have.

    Examples
    --------
    >>> Spool(1e-3, 0.1, 0.1).inertia
    Fraction(1, 1000)
    """

    inertia: Fraction
    friction: Fraction
    radius: Fraction

    def __init__(self, inertia: Number, friction: Number, radius: Number):
        fill(
            self,
            inertia=positive(inertia, "inertia"),
            friction=positive(friction, "friction", or_zero=True),
            radius=positive(radius, "radius"),
        )


@dataclass(frozen=True, init=False)
class Belt:
    """A massless section of belt: F = K e + B de/dt, with elongation e.

    Parameters
    ----------
    stiffness : number
        Stiffness K of the section, N/m, more than 0.
    damping : number
        Damping B of the section, N s/m, 0 or more.

    Raises
    ------
    InputError
        A value that no belt can have.

    Examples
    --------
    >>> Belt(50, 0.5).stiffness
    Fraction(50, 1)
    """

    stiffness: Fraction
    damping: Fraction

    def __init__(self, stiffness: Number, damping: Number):
        fill(self, stiffness=positive(stiffness, "stiffness"), damping=positive(damping, "damping", or_zero=True))


@dataclass(frozen=True, init=False)
class Pulley:
    """A pulley on a spring; on each side the belt makes the angle theta with the way the pulley moves.

    v1 - v2 = 2 v_k cos(theta) and F1 = F2 = F_k/(2 cos(theta)) with F_k = -k x_k, for the belt speeds v1 and v2 on its
    two sides. To the belt it is a spring k_p = k/(4 cos(theta)^2) with elongation e_p = -2 x_k cos(theta), and
    with a mass m, where F_k = -k x_k - m dv_k/dt, behind it a mass of m/(4 cos(theta)^2).

    Parameters
    ----------
    stiffness : number
        Stiffness k of the pulley's spring, N/m, more than 0.
    angle : number
        Angle theta between the belt and the pulley's way, rad, between 0 and pi/2. For 30, 45 and 60 degrees
        cos(theta)^2 is exact, for 60 the cosine too; else the cosine is the decimal of its float.
    mass : number, optional
        Mass m that moves with the pulley, kg, 0 or more; its inertia about its own axis is left out.

    Raises
    ------
    InputError
        A value that no pulley can have.

    Examples
    --------
    >>> pulley = Pulley(200, math.radians(45))
    >>> pulley.belt_stiffness, round(pulley.tension(deflection=-0.01), 9)
    (Fraction(100, 1), 1.414213562)
    """

    stiffness: Fraction
    angle: float
    mass: Fraction
    cosine: Fraction = field(init=False, repr=False)
    cosine_squared: Fraction = field(init=False, repr=False)

    def __init__(self, stiffness: Number, angle: Number, mass: Number = Fraction(0)):
        m = positive(mass, "mass", or_zero=True)
        k, angle = positive(stiffness, "stiffness"), float(exact(angle, "angle"))
        if not 0 < angle < math.pi / 2:
            raise InputError(
                "angle", "not physical", "more than 0 and less than 90 degrees", f"{math.degrees(angle):.6g} degrees"
            )
        degrees = round(math.degrees(angle))
        special = COSINES_SQUARED.get(degrees) if math.isclose(angle, math.radians(degrees), rel_tol=4e-16) else None
        cosine = HALF if special == HALF**2 else Fraction(repr(math.cos(angle)))
        fill(self, stiffness=k, angle=angle, mass=m, cosine=cosine, cosine_squared=special or cosine**2)

    @property
    def belt_stiffness(self) -> Fraction:
        """k_p = k/(4 cos(theta)^2) in N/m."""
        return self.stiffness / (4 * self.cosine_squared)

    @property
    def belt_mass(self) -> Fraction:
        """m/(4 cos(theta)^2) in kg."""
        return self.mass / (4 * self.cosine_squared)

    def tension(self, deflection: float) -> float:
        """Tension of the belt around it while it does not accelerate, N."""
        return -float(self.stiffness) * deflection / (2 * float(self.cosine))


@dataclass(frozen=True, init=False)
class Winding:
    """A belt that is wound from spool 1 on spool 2: radii r = r0 -/+ thickness*phi/(2 pi), and inertias with them.

    J = J0 + pi*line_density/(2*thickness)*(r^4 - r0^4), with r0 and J0 at the angle 0. The belt comes and goes at the
    speed of the surface, so J dw/dt stays the sum of the torques, and the energy of its motion comes and goes with it.

    Parameters
    ----------
    thickness : number
        Of the belt, m, more than 0.
    line_density : number
        Mass of the belt per length, kg/m, 0 or more.

    Raises
    ------
    InputError
        A value that no belt can have.

    Examples
    --------
    >>> Winding(1e-3, 0.05).thickness
    Fraction(1, 1000)
    """

    thickness: Fraction
    line_density: Fraction

    def __init__(self, thickness: Number, line_density: Number):
        density = positive(line_density, "line_density", or_zero=True)
        fill(self, thickness=positive(thickness, "thickness"), line_density=density)
