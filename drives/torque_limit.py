"""Set points that motors of limited torque can hold, and the largest ones.

At rest relative to its set points the mechanism needs, with v the belt speed, f the tension and D_i = B_i/r_i^2,

    T1 + d1 = r1*(f - D1*v),    T2 + d2 = r2*(f + D2*v),

so |T_i| <= limit is a parallelogram in the plane of v and f. Its corners are the steady states of both torques at their
limit: +, + has the largest tension, -, + and +, - have the largest speeds forwards and backwards.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from drives.coupled import CoupledDrives
from drives.number import exact, positive
from drives.torque import Torque

EXCESS = Fraction(1, 10**9)  # relative to the limit: a smaller excess is still held
Range = tuple[float, float]


@dataclass(frozen=True)
class Reach:
    """Torques that hold a belt speed and a tension, and the range that the limit allows.

    Attributes
    ----------
    T1, T2 : float
        Torques that hold the set points, N m.
    holds : bool
        Whether both are within the limit.
    tension_at_speed : tuple of float or None
        Smallest and largest tension at that speed, N; None if none can be held there.
    speed_at_tension : tuple of float or None
        Smallest and largest belt speed at that tension, m/s; infinite without friction.
    tension : tuple of float
        Smallest and largest tension at any speed, N.
    """

    T1: float
    T2: float
    holds: bool
    tension_at_speed: Range | None
    speed_at_tension: Range | None
    tension: Range


def reach(
    drives: CoupledDrives, belt_speed: float, tension: float, limit: float, *, d1: float = 0.0, d2: float = 0.0
) -> Reach:
    """Whether motors can hold a belt speed and a tension.

    Parameters
    ----------
    drives : CoupledDrives
    belt_speed, tension : float
        Set points, m/s and N.
    limit : float
        Largest torque of each motor, N m, more than 0.
    d1, d2 : float
        Disturbing torques, which act like T1 and T2, N m.

    Raises
    ------
    InputError
        A number that is not finite, or a limit that is not more than 0.

    Examples
    --------
    >>> found = reach(CoupledDrives(), 1.0, 50.0, 2.0)
    >>> found.holds, found.T1, found.T2, found.tension_at_speed, found.speed_at_tension, found.tension
    (False, 4.0, 6.0, (-10.0, 10.0), None, (-20.0, 20.0))
    """
    v, f, most = exact(belt_speed, "belt_speed"), exact(tension, "tension"), positive(limit, "limit")
    sides = []  # radius, friction referred to the belt with its sign, disturbance
    for spool, sign, d in ((drives.left, -1, exact(d1, "d1")), (drives.right, 1, exact(d2, "d2"))):
        sides.append((spool.radius, sign * drives.mobility(spool)[1], d))
    needed = [r * (f + c * v) - d for r, c, d in sides]
    tensions = [((d - most) / r - c * v, (d + most) / r - c * v) for r, c, d in sides]
    speeds = [sorted((((d - most) / r - f) / c, ((d + most) / r - f) / c)) for r, c, d in sides if c]
    stuck = any(abs(r * f - d) > most for r, c, d in sides if not c)
    return Reach(
        float(needed[0]),
        float(needed[1]),
        all(abs(torque) <= most * (1 + EXCESS) for torque in needed),
        _common(tensions),
        None if stuck else _common(speeds) if speeds else (-np.inf, np.inf),
        (_furthest(sides, -most), _furthest(sides, most)),
    )


def _furthest(sides: list[tuple[Fraction, Fraction, Fraction]], torque: Fraction) -> float:
    """Return the tension with this torque of both motors, or that which the weaker one holds if friction is zero."""
    (_, c1, _), (_, c2, _) = sides
    bound1, bound2 = ((d + torque) / r for r, _, d in sides)
    if c1 == c2:
        return float(min(bound1, bound2) if torque > 0 else max(bound1, bound2))
    return float(bound1 - c1 * (bound1 - bound2) / (c1 - c2))


def unreachable(
    drives: CoupledDrives, belt_speed: Torque, tension: Torque, d1: Torque, d2: Torque, *, limit: float, end: float
) -> Iterator[str]:
    """Sentences on set points that the limit cannot hold, for each stretch of time with constant inputs.

    Parameters
    ----------
    drives : CoupledDrives
    belt_speed, tension, d1, d2 : Torque
        Set points and disturbing torques over time.
    limit : float
        N m.
    end : float
        Length of the run, s.
    """
    inputs = (belt_speed, tension, d1, d2)
    said = set()
    for time in sorted({time for one in inputs for time in one.times if time < end}):
        values, slopes = zip(*((float(x[0]) for x in one.pieces(np.array([time]))) for one in inputs), strict=True)
        if not any(slopes) and values not in said:
            said.add(values)
            v, f, first, second = values
            found = reach(drives, v, f, limit, d1=first, d2=second)
            if not found.holds:
                yield f"from {time:g} s on, {_sentence(found, v, f, limit)}"


def _sentence(found: Reach, v: float, f: float, limit: float) -> str:
    needs = f"T1 = {found.T1:.4g} N m and T2 = {found.T2:.4g} N m, and the limit is {limit:.4g} N m"
    said = [f"a belt speed of {v:.4g} m/s and a tension of {f:.4g} N cannot be held: they take {needs}"]
    tension, speed = found.tension_at_speed, found.speed_at_tension
    if tension and (tension[1] >= 0 or f < 0):
        nearest = min(max(f, tension[0]), tension[1])
        said.append(f"at that speed the {'largest' if f > nearest else 'smallest'} tension is {nearest:.4g} N")
    else:
        said.append("at that speed no tension can be held")
    if speed:
        nearest = min(max(v, speed[0]), speed[1])
        said.append(
            f"at that tension the {'largest' if abs(v) > abs(nearest) else 'nearest'} speed is {nearest:.4g} m/s"
        )
    else:
        low, high = found.tension
        said.append(f"at no speed {f'more than {high:.4g}' if f > high else f'less than {low:.4g}'} N")
    return "; ".join(said)


def _common(ranges: list) -> Range | None:
    low, high = max(low for low, _ in ranges), min(high for _, high in ranges)
    return (float(low), float(high)) if low <= high else None
