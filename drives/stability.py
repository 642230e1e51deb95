"""Stability of a loop of one controller and one plant: closed-loop poles and margins."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from flint import fmpq_poly

from drives.roots import positive_roots, roots, squared
from drives.transfer import TransferFunction

if TYPE_CHECKING:
    from drives.control import PI


@dataclass(frozen=True)
class Margins:
    """How far a stable loop is from instability; of an unstable one they say nothing.

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


def closed_poles(controller: "PI", plant: TransferFunction) -> list[complex]:
    """Roots of 1 + L = 0, rad/s; nothing is cancelled, so hidden modes of the loop are among them."""
    c = controller.transfer
    return roots(c.p * plant.p + c.q * plant.q)


def margins(controller: "PI", plant: TransferFunction) -> Margins:
    """Margins of L = controller*plant, from the exact frequencies where |L| = 1 and where L is real and negative.

    Examples
    --------
    >>> from drives import PI, CoupledDrives, decoupled
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
