"""A contact at one instant, for solvers that are not compiled."""

from friction.kernel.law import applied, friction, mode_of, piece, steady
from friction.kernel.structures import Spot
from tline.compiled.unit import unit

FREE = 9  # mode of a solver that looks at the law alone


@unit
def observe(spot: Spot, number: int, mode: int, shown: int, t: float) -> int:
    """Find what moves the contact at t, within a piece of the applied force, while a mode lasts.

    Returns the sign of the motion, as a method sees it that meets no events; `shown` is what it was.
    """
    law, y, found = spot.law, spot.y, spot.found
    f_a, rate = applied(piece(spot.drive, number), t, y[0])[0], 0.0
    if mode == FREE:
        f_f, rate = friction(law, y[1], y[2], f_a)
    elif mode == 0:
        f_f = f_a
    else:
        f_f = mode * steady(law, y[1])[0] + law.f_v * y[1]
    found[0], found[1], found[2] = y[1], (f_a - f_f) / spot.mass, rate
    found[3], found[4] = f_a * y[1], f_f * y[1]
    found[5], found[6] = f_a, f_f
    return mode_of(law, shown, y[1], y[2], f_a)
