"""The equations of motion as one writes them on paper, from the parts alone; made for `drives.witness`.

No matrix and no model of the rest of the package is used here. The state is

    x = (phi1, w1, w2, e_p, e of each damped belt, v_p of a pulley with mass,
         under control the outputs of filters, q_speed and q_tension, phi2),

in which phi2 is an angle of its own, so that the positions' constraint is something to check. The inputs u are T1 and
T2, or under control the set points of belt speed and tension and the disturbing torques d1 and d2. Each of x and u is
a sequence of floats, or, where no torque is limited, of arrays with an entry for each sample.
"""

from collections.abc import Callable, Sequence
from fractions import Fraction
from math import copysign, cos, exp, inf, pi
from typing import Any, NamedTuple

from numpy.typing import NDArray

Row = Sequence[Any] | NDArray[Any]
Product = tuple[float, Any, Any]  # coefficient*a*b, a power


class Control(NamedTuple):
    """PI controllers of belt speed and tension, each with gain and integral time, and the limit of the motors."""

    speed: tuple[Any, Any]
    tension: tuple[Any, Any]
    limit: float = inf
    antiwindup: bool = True
    filter_time: Any = 0.0


SEEN = ("w1_seen", "w2_seen", "tension_seen")  # by a controller behind filters


class Equations:
    """Equations of motion of the mechanism at an instant.

    Parameters
    ----------
    parts : CoupledDrives
        Drives, or an object with the same parts.
    control : Control, optional
        Without it the inputs are torques.
    slack : bool
        Whether the belt cannot push.
    dry : sequence of Coulomb, Karnopp or None
        Dry friction of the left and the right bearing.
    winding : Winding, optional
        Of the belt on the spools, whose phi2 is then an output as it is.
    number : callable
        Number type to compute in, as float or Fraction.
    """

    def __init__(
        self,
        parts: Any,
        control: Control | None = None,
        slack: bool = False,
        dry: Sequence[Any] = (None, None),
        winding: Any = None,
        number: Callable = float,
    ):
        belts = {"e1": parts.left_belt, "e2": parts.right_belt}
        given = {name: (number(one.stiffness), number(one.damping)) for name, one in belts.items()}
        spools = parts.left, parts.right
        self.spools = [(number(one.inertia), number(one.friction), number(one.radius)) for one in spools]
        self.belts = [(k, b) for k, b in given.values() if b]
        self.k, self.cosine = number(parts.pulley.stiffness), number(cos(parts.pulley.angle))
        self.spring = 1 / (4 * self.cosine**2 / self.k + sum(1 / k for k, b in given.values() if not b))
        self.heavy = number(one.mass) / (4 * self.cosine**2) if (one := parts.pulley).mass else 0
        self.parts, self.control, self.slack, self.dry = parts, control, slack, dry
        self.wound = (float(winding.thickness) / (2 * pi), float(winding.line_density)) if winding else None
        integrals = ("q_speed", "q_tension") if control else ()
        if control and control.filter_time:
            integrals = SEEN + integrals
        if self.heavy:
            integrals = ("v_p", *integrals)
        self.states = ("phi1", "w1", "w2", "e_p", *(name for name in given if given[name][1]), *integrals)

    @property
    def freed(self) -> "Equations":
        """Equations without slack, limit, dry friction and winding: linear in x and u.

        Under control in fractions: the decoupler of unequal spools cancels nearly all of the torques it is added to.
        """
        if self.control is None:
            return Equations(self.parts)
        (k_v, t_v), (k_f, t_f), *_, lag = self.control
        control = Control((Fraction(k_v), Fraction(t_v)), (Fraction(k_f), Fraction(t_f)), filter_time=Fraction(lag))
        return Equations(self.parts, control, number=Fraction)

    @property
    def linear(self) -> bool:
        """Whether the equations are linear as they are."""
        return (
            not self.slack
            and not any(self.dry)
            and not self.wound
            and (self.control is None or self.control.limit == inf)
        )

    def tension(self, x: Row) -> Any:
        """The belt's tension, N."""
        if self.heavy:
            (_, _, r1), (_, _, r2) = self.spools_at(x)
            free = r2 * x[2] - r1 * x[1] - x[6] + sum(k * e / b for (k, b), e in zip(self.belts, x[4:6], strict=True))
            return free / sum(1 / b for _, b in self.belts)
        return self.spring * ((x[3] + abs(x[3])) / 2 if self.slack else x[3])

    def at(self, x: Row, u: Row) -> tuple[list[Any], list[Product], list[Product]]:
        """dx/dt, heat flow and supplied power."""
        (j1, b1, r1), (j2, b2, r2) = self.spools_at(x)
        w1, w2, f, integrals = x[1], x[2], self.tension(x), []
        T1, T2 = u[0], u[1]
        if self.control:
            motors, integrals = self._controlled(self.control, x, u)
            T1, T2 = motors[0] + u[2], motors[1] + u[3]
        stretching = [(f - k * e) / b for (k, b), e in zip(self.belts, x[4:], strict=False)]
        pulls = r1 * f - T1 - b1 * w1, T2 - b2 * w2 - r2 * f
        rubbed = [rubbing(law, w, net) if law else 0 for law, w, net in zip(self.dry, (w1, w2), pulls, strict=True)]
        turning = (pulls[0] - rubbed[0]) / j1, (pulls[1] - rubbed[1]) / j2
        pulley = [r2 * w2 - r1 * w1 - sum(stretching), *stretching]
        if self.heavy:
            pulley = [x[6], *stretching, (f - self.spring * x[3]) / self.heavy]
        rates = [w1, *turning, *pulley, *integrals, w2]
        heat = [(b1, w1, w1), (b2, w2, w2), *((b, v, v) for (_, b), v in zip(self.belts, stretching, strict=True))]
        heat += [(1.0, torque, w) for law, torque, w in zip(self.dry, rubbed, (w1, w2), strict=True) if law]
        work = [(-1.0, T1, w1), (1.0, T2, w2)]
        if self.wound:
            work += [(s * self.wound[1] / 2 * r**3, w * w, w) for s, r, w in ((-1, r1, w1), (1, r2, w2))]
        return rates, heat, work

    def spools_at(self, x: Row) -> list[tuple[Any, Any, Any]]:
        """Inertia, friction and radius of the spools, as much as is wound on them."""
        if not self.wound:
            return self.spools
        (turn, density), found = self.wound, []
        for (j, b, r), way in zip(self.spools, (-turn * x[0], turn * x[-1]), strict=True):
            found.append((j + density / (4 * turn) * ((r + way) ** 4 - r**4), b, r + way))
        return found

    def stored(self, x: Row) -> Any:
        """Energy in spools and springs, J."""
        (j1, _, _), (j2, _, _) = self.spools_at(x)
        belts = sum(k * e**2 for (k, _), e in zip(self.belts, x[4:], strict=False))
        pulley = self.spring * x[3] ** 2 + self.heavy * x[6] ** 2 if self.heavy else self.tension(x) ** 2 / self.spring
        return (j1 * x[1] ** 2 + j2 * x[2] ** 2 + pulley + belts) / 2

    def outputs(self, x: Row, u: Row) -> dict[str, Any]:
        """Return the outputs by name."""
        (j1, _, r1), (j2, _, r2) = self.spools_at(x)
        f = self.tension(x)
        held = self.spring * x[3] if self.heavy else f  # by the pulley's spring
        found = {"tension": f, "x_k": -2 * self.cosine * held / self.k, "belt_speed": (r1 * x[1] + r2 * x[2]) / 2}
        found |= {"phi1": x[0], "w1": x[1], "w2": x[2], "phi2": (r1 * x[0] + sum(x[3 : 4 + len(self.belts)])) / r2}
        if self.wound:
            found |= {"phi2": x[-1], "r1": r1, "r2": r2, "J1": j1, "J2": j2}
        if self.control:
            found["T1"], found["T2"] = self._controlled(self.control, x, u)[0]
        return found

    def _controlled(self, control: Control, x: Row, u: Row) -> tuple[tuple[Any, Any], list[Any]]:
        """Torques of the motors, and dq/dt.

        Each spool is to move as one of the mean M = J/r^2 and D = B/r^2 would under the pull p = (tau_f -+ tau_v)/(2
        r_m): M u' = -p1 - D u + f on the left, M u' = p2 - D u - f on the right, with u = r w.
        """
        (j1, b1, r1), (j2, b2, r2) = self.spools
        m1, m2, d1, d2 = j1 / r1**2, j2 / r2**2, b1 / r1**2, b2 / r2**2
        m, d, mean = (m1 + m2) / 2, (d1 + d2) / 2, (r1 + r2) / 2
        w1, w2, f = seen = x[1], x[2], self.tension(x)
        lag, behind = control.filter_time, []
        if lag:
            w1, w2, f = x[-6:-3]
            behind = [(new - old) / lag for new, old in zip(seen, (w1, w2, f), strict=True)]
        u1, u2 = r1 * w1, r2 * w2
        errors = u[0] - (u1 + u2) / 2, u[1] - f
        (k_v, t_v), (k_f, t_f) = control.speed, control.tension
        tau_v, tau_f = k_v * (errors[0] + x[-3] / t_v), k_f * (errors[1] + x[-2] / t_f)
        a1, a2 = r1 * m1 / m, r2 * m2 / m  # torque for a pull
        rest1 = a1 * (tau_f / (2 * mean) + d * u1 - f) + r1 * (f - d1 * u1)
        rest2 = a2 * (tau_f / (2 * mean) - d * u2 - f) + r2 * (f + d2 * u2)
        pull = tau_v / (2 * mean)
        wanted = rest1 - a1 * pull, rest2 + a2 * pull
        if control.limit == inf:
            return wanted, [*behind, *errors]
        given = limited(control.limit, pull, (-a1, rest1), (a2, rest2))
        if not control.antiwindup:
            return given, [*behind, *errors]
        less1, less2 = (given[0] - wanted[0]) / a1, (given[1] - wanted[1]) / a2
        return given, [*behind, errors[0] + mean * (less2 - less1) / k_v, errors[1] + mean * (less1 + less2) / k_f]


def rubbing(law: Any, w: float, net: float) -> float:
    """Return the dry friction of a bearing under a torque; at rest the friction that holds it, up to stiction."""
    if abs(w) > getattr(law, "delta", 0.0):
        return copysign(law.sliding + (law.stiction - law.sliding) * exp(-((w / law.law.v_s) ** 2)), w) + law.F_v * w
    return min(max(net, -law.stiction), law.stiction)


def limited(limit: float, pull: Any, *motors: tuple[float, Any]) -> tuple[Any, Any]:
    """The torques slope*pull + rest of both motors, with the pull cut until neither is beyond the limit.

    If no pull does that, both torques are limited at the pull midway between those that either would need.
    """
    reach = [(-rest / slope, limit / abs(slope)) for slope, rest in motors]
    low, high = max(*(middle - half for middle, half in reach)), min(*(middle + half for middle, half in reach))
    between = (low + high) / 2
    cut = min(max(pull, min(low, between)), max(high, between))
    first, second = (min(max(slope * cut + rest, -limit), limit) for slope, rest in motors)
    return first, second
