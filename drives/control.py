"""Control of belt speed and tension: a decoupler and two PI controllers.

For spools alike to the belt (equal J/r^2 and B/r^2) the sum of the torques moves only the tension and their
difference only the belt speed, so with T1 = (tau_f - tau_v)/2, T2 = (tau_f + tau_v)/2 the plant falls in two. Without
it the relative gain array is 1/2 at every frequency: each torque moves both outputs equally, the worst pairing there is
(E. H. Bristol, 1966, doi:10.1109/TAC.1966.1098266). For other spools an inner feedback of their speeds and the tension
makes them behave like two alike, of the mean M and D; radii enter as T_i = r_i/r_m*(...), r_m their mean.

Design rule (after S. Skogestad, 2003, doi:10.1016/S0959-1524(02)00062-8): the integral time is the time constant of
the plant's slowest pole or pair, at most 4/bandwidth; the gain makes |L| = 1 at the bandwidth, and is lowered until the
loop is stable with a phase margin of at least 60 degrees and a gain margin of at least 2.
"""

import math
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
from flint import fmpq_poly
from numpy.typing import ArrayLike, NDArray

from drives.coupled import CoupledDrives
from drives.number import Number, exact, fill, positive, rational
from drives.parts import Spool
from drives.roots import positive_roots, roots, squared
from drives.symbolic import INPUTS
from drives.transfer import TransferFunction, frequencies
from tline.errors import InputError

LEAST_PHASE_MARGIN, LEAST_GAIN_MARGIN = math.radians(60), 2.0
LOWERED, TRIES = 0.9, 300  # the gain, each time, and how often at most
FASTER = 5.0  # bandwidth over the slowest pole of the tension, unless given


@dataclass(frozen=True, init=False)
class PI:
    """tau = gain*(e + integral of e/integral_time).

    Parameters
    ----------
    gain : number
        Torque per unit of the controlled output.
    integral_time : number
        s, more than 0.

    Examples
    --------
    >>> print(PI(2, 0.5).transfer)
    PI = (2*s + 4)/s
    """

    gain: Fraction
    integral_time: Fraction

    def __init__(self, gain: Number, integral_time: Number):
        fill(self, gain=exact(gain, "gain"), integral_time=positive(integral_time, "integral_time"))

    @property
    def transfer(self) -> TransferFunction:
        """gain*(1 + 1/(integral_time*s))."""
        k = rational(self.gain)
        return TransferFunction(fmpq_poly([k / rational(self.integral_time), k]), fmpq_poly([0, 1]), "PI")


@dataclass(frozen=True)
class Margins:
    """How far a loop is from instability.

    Attributes
    ----------
    phase : float
        Smallest phase margin, rad; infinite if |L| is never 1.
    crossover : float
        Angular frequency there, rad/s, NaN if there is none.
    gain : float
        Smallest factor above 1 that makes the loop unstable, or infinite.
    """

    phase: float
    crossover: float
    gain: float


@dataclass(frozen=True)
class Design:
    """Controllers for belt speed and tension.

    Attributes
    ----------
    drives : CoupledDrives
    speed, tension : PI
        From the error of the belt speed to tau_v, and from the error of the tension to tau_f.
    speed_plant, tension_plant : TransferFunction
        Of the decoupled plant: belt_speed/tau_v and tension/tau_f.
    """

    drives: CoupledDrives
    speed: PI
    tension: PI
    speed_plant: TransferFunction
    tension_plant: TransferFunction

    @property
    def margins(self) -> dict[str, Margins]:
        """Of the loops ``speed`` and ``tension``."""
        return {"speed": margins(self.speed, self.speed_plant), "tension": margins(self.tension, self.tension_plant)}

    @property
    def poles(self) -> dict[str, list[complex]]:
        """Closed-loop poles of the loops ``speed`` and ``tension``, rad/s."""
        return {
            "speed": closed_poles(self.speed, self.speed_plant),
            "tension": closed_poles(self.tension, self.tension_plant),
        }


def alike(drives: CoupledDrives) -> CoupledDrives:
    """The drives with two spools of the mean M and D, which is what the inner feedback makes of them."""
    (m1, d1), (m2, d2) = drives.mobility(drives.left), drives.mobility(drives.right)
    m, d = (m1 + m2) / 2, (d1 + d2) / 2
    left, right = (Spool(m * x.radius**2, d * x.radius**2, x.radius) for x in (drives.left, drives.right))
    return replace(drives, left=left, right=right)


def decoupled(drives: CoupledDrives) -> tuple[TransferFunction, TransferFunction]:
    """belt_speed/tau_v and tension/tau_f behind the decoupler.

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


def design(
    drives: CoupledDrives, speed_bandwidth: float | None = None, tension_bandwidth: float | None = None
) -> Design:
    """Controllers by the rule above.

    Parameters
    ----------
    drives : CoupledDrives
    speed_bandwidth, tension_bandwidth : float, optional
        rad/s; 5 times the slowest pole of the tension if not given. The margins may allow less for the tension.

    Raises
    ------
    InputError
        A bandwidth that is not more than 0, or no gain gives the margins.

    Examples
    --------
    >>> found = design(CoupledDrives(), 20, 20)
    >>> round(float(found.speed.gain), 6), round(float(found.speed.integral_time), 6)
    (0.4, 0.01)
    >>> round(math.degrees(found.margins["tension"].phase))
    85
    """
    speed_plant, tension_plant = decoupled(drives)
    usual = FASTER * abs(_slowest(tension_plant))
    speed = _tuned(
        speed_plant, float(positive(usual if speed_bandwidth is None else speed_bandwidth, "speed_bandwidth"))
    )
    wanted = usual if tension_bandwidth is None else tension_bandwidth
    tension = _tuned(tension_plant, float(positive(wanted, "tension_bandwidth")))
    return Design(drives, speed, tension, speed_plant, tension_plant)


def _slowest(plant: TransferFunction) -> complex:
    return max(plant.poles, key=lambda z: z.real)


def _tuned(plant: TransferFunction, bandwidth: float) -> PI:
    """The PI controller by the rule above."""
    pole = _slowest(plant)
    constant = math.inf if pole == 0 else (2 if pole.imag else 1) * -pole.real / abs(pole) ** 2
    integral = min(constant, 4 / bandwidth) or 4 / bandwidth
    response = plant(1j * bandwidth) * (1 + 1 / (1j * bandwidth * integral))
    gain = math.copysign(1 / abs(response), float(plant.numerator[0]))
    for _ in range(TRIES):
        tried = PI(exact(gain, "gain"), exact(integral, "integral_time"))
        found = margins(tried, plant)
        stable = all(pole.real < 0 for pole in closed_poles(tried, plant))
        if stable and found.phase >= LEAST_PHASE_MARGIN and found.gain >= LEAST_GAIN_MARGIN:
            return tried
        gain *= LOWERED
    raise InputError(plant.name, "no PI controller of this rule has the margins", "some friction or damping")


def closed_poles(controller: PI, plant: TransferFunction) -> list[complex]:
    """Roots of 1 + L = 0, rad/s; nothing is cancelled, so hidden modes of the loop are among them."""
    c = controller.transfer
    return roots(c.p * plant.p + c.q * plant.q)


def margins(controller: PI, plant: TransferFunction) -> Margins:
    """Margins of L = controller*plant, from the exact frequencies where |L| = 1 and where L is real and negative.

    Examples
    --------
    >>> found = margins(PI(0.4, 0.01), decoupled(CoupledDrives())[0])
    >>> round(found.crossover, 9), round(math.degrees(found.phase), 9), found.gain
    (20.0, 90.0, inf)
    """
    c = controller.transfer
    p, q = c.p * plant.p, c.q * plant.q
    loop = TransferFunction(p, q, "L")
    crossings = [math.sqrt(x) for x in positive_roots(squared(p) - squared(q))]
    phases = [math.remainder(math.pi + float(loop.phase(w)), 2 * math.pi) for w in crossings]
    phase, crossover = min(zip(phases, crossings, strict=True), default=(math.inf, math.nan))
    mirrored = fmpq_poly([x if k % 2 == 0 else -x for k, x in enumerate(q.coeffs())])
    odd = (p * mirrored).coeffs()[1::2]
    imaginary = fmpq_poly([x if k % 2 == 0 else -x for k, x in enumerate(odd)])
    imaginary //= imaginary.gcd(squared(q))  # at an undamped pole L is not real but infinite
    sizes = [-loop(1j * math.sqrt(x)).real for x in positive_roots(imaginary)]
    return Margins(phase, crossover, min((1 / size for size in sizes if 0 < size < 1), default=math.inf))


def relative_gain_array(drives: CoupledDrives, omega: ArrayLike) -> NDArray[np.complex128]:
    """Bristol's array from (T1, T2) to (belt_speed, tension), shape (2, 2, n).

    Examples
    --------
    >>> np.round(relative_gain_array(CoupledDrives(), [0.0, 100.0]).real[0, 0], 12)
    array([0.5, 0.5])
    """
    (a, b), (c, d) = ([drives.transfer(out, torque) for torque in INPUTS] for out in ("belt_speed", "tension"))
    straight, crossed = a.p * d.p * b.q * c.q, b.p * c.p * a.q * d.q  # of a*d/(a*d - b*c), over one denominator
    first = TransferFunction(straight, straight - crossed, "relative gain")(1j * np.atleast_1d(frequencies(omega)))
    return np.array([[first, 1 - first], [1 - first, first]])
