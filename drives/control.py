"""Control of belt speed and tension: a decoupler and two PI controllers, and the stability of their loops.

The decoupler is in `drives.decoupling`.

Design rule (after S. Skogestad, 2003, doi:10.1016/S0959-1524(02)00062-8): the integral time is the time constant of
the plant's slowest pole or pair, at most 4/bandwidth, but longer where a phase margin of 60 degrees takes it; the gain
makes |L| = 1 at the bandwidth. Where the loop is then not stable with that phase margin and a gain margin of at least
2, the bandwidth is the largest below that has them. Of integral times longer than both the time constant and
4/bandwidth none is tried: their loops settle far more slowly than the bandwidth promises.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from flint import fmpq_poly

from drives.coupled import CoupledDrives
from drives.decoupling import decoupled
from drives.number import Number, exact, fill, positive, positive_roots, rational, roots, squared, written
from drives.transfer import TransferFunction
from tline.errors import InputError
from tline.presentation import Presentation, plain


@dataclass(frozen=True)
class Margins:
    """Distances of a stable loop from instability; without meaning for an unstable one.

    Attributes
    ----------
    phase : float
        Smallest phase margin, rad; infinite if |L| is never 1.
    crossover : float
        Angular frequency of that margin, rad/s, NaN if |L| is never 1.
    gain : float
        Smallest factor above 1 that makes the loop unstable, or infinite.
    crossings : list of float
        All angular frequencies at which |L| = 1, rad/s, rising.
    """

    phase: float
    crossover: float
    gain: float
    crossings: list[float]


def closed_poles(controller: "PI", plant: TransferFunction) -> list[complex]:
    """Roots of 1 + L = 0, rad/s; nothing is cancelled, so hidden modes of the loop are among them."""
    c = controller.transfer
    return roots(c.p * plant.p + c.q * plant.q)


def margins(controller: "PI", plant: TransferFunction) -> Margins:
    """Margins of L = controller*plant, from the exact frequencies where |L| = 1 and where L is real and negative.

    Parameters
    ----------
    controller : PI
    plant : TransferFunction

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
    crossings = sorted(math.sqrt(x) for x in positive_roots(squared(p) - squared(q)))
    phases = [math.remainder(math.pi + float(loop.phase(w)), 2 * math.pi) for w in crossings]
    phase, crossover = min(zip(phases, crossings, strict=True), default=(math.inf, math.nan))
    mirrored = fmpq_poly([x if k % 2 == 0 else -x for k, x in enumerate(q.coeffs())])
    odd = (p * mirrored).coeffs()[1::2]
    imaginary = fmpq_poly([x if k % 2 == 0 else -x for k, x in enumerate(odd)])
    imaginary //= imaginary.gcd(squared(q))  # at an undamped pole L is not real but infinite
    sizes = [-loop(1j * math.sqrt(x)).real for x in positive_roots(imaginary)]
    return Margins(phase, crossover, min((1 / size for size in sizes if 0 < size < 1), default=math.inf), crossings)


LEAST_PHASE_MARGIN, LEAST_GAIN_MARGIN = math.radians(60), 2.0
CERTAIN = 1e-9  # rad, more than rounding takes from a margin
LOWERED, TRIES, HALVINGS = 0.9, 300, 20  # the bandwidth, each time, how often at most, and then between the last two
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
class Bandwidth:
    """Angular frequency at which |L| = 1, rad/s.

    Attributes
    ----------
    asked : float or None
        By the user [rad/s].
    reached : float
        With the margins of the rule [rad/s].
    """

    asked: float | None
    reached: float

    @property
    def met(self) -> bool:
        """Whether the loop is as fast as it was asked to be."""
        return self.asked is None or self.reached >= self.asked


@dataclass(frozen=True, repr=False)
class Design(Presentation):
    """Controllers for belt speed and tension.

    Attributes
    ----------
    drives : CoupledDrives
    speed, tension : PI
        From the error of the belt speed to tau_v, and from the error of the tension to tau_f.
    speed_plant, tension_plant : TransferFunction
        Of the decoupled plant: belt_speed/tau_v and tension/tau_f.
    bandwidths : mapping of str to Bandwidth
        Of the loops ``speed`` and ``tension``, if `design` made them.
    """

    drives: CoupledDrives
    speed: PI
    tension: PI
    speed_plant: TransferFunction
    tension_plant: TransferFunction
    bandwidths: Mapping[str, Bandwidth] = field(default_factory=dict)
    picture = "drives.picture:draw_design"

    @property
    def verdicts(self) -> tuple[str, ...]:
        """A sentence for each loop that is unstable, slower than asked, or resonates at a gain of 1; else none."""
        found, margins = [], self.margins
        for name, poles in self.poles.items():
            worst = max(poles, key=lambda z: z.real)
            band = self.bandwidths.get(name)
            if worst.real >= 0:
                found.append(f"the {name} loop is unstable: a closed-loop pole at {written(worst)} rad/s")
            elif band and not band.met:
                found.append(
                    f"the {name} loop reaches {band.reached:.4g} rad/s, not the {band.asked:.4g} rad/s asked for: "
                    f"beyond, no PI controller of this rule has a phase margin of 60° and a gain margin of 2"
                )
            elif len(crossings := margins[name].crossings) > 1:
                all_of_them = ", ".join(f"{w:.4g}" for w in crossings)
                found.append(
                    f"the {name} loop has a gain of 1 at {all_of_them} rad/s, about a resonance: from the first of "
                    f"these on it follows its set point less well than its bandwidth promises"
                )
        return tuple(found)

    def text_lines(self) -> Iterator[str]:
        """Plant, controller, margins and poles of each loop."""
        for name, (controller, plant) in self.loops.items():
            margin, poles = self.margins[name], ", ".join(written(z) for z in self.poles[name])
            yield f"{name}: {plant}"
            yield f"  gain {float(controller.gain):.5g}, integral time {float(controller.integral_time):.5g} s"
            yield (
                f"  phase margin {math.degrees(margin.phase):.4g}° at {margin.crossover:.4g} rad/s, "
                f"gain margin {margin.gain:.4g}"
            )
            yield f"  poles {poles} rad/s"

    def to_dict(self) -> dict[str, Any]:
        """Gain, integral time, margins, poles and bandwidth of each loop."""
        found = {}
        for name, (controller, _) in self.loops.items():
            margin = self.margins[name]
            found[name] = {
                "gain": controller.gain,
                "integral_time": controller.integral_time,
                "poles": self.poles[name],
                "phase_margin_degrees": math.degrees(margin.phase),
                "crossover": margin.crossover,
                "gain_margin": margin.gain,
                "stable": all(z.real < 0 for z in self.poles[name]),
                "bandwidth": self.bandwidths.get(name),
            }
        return plain(found)

    @property
    def loops(self) -> dict[str, tuple[PI, TransferFunction]]:
        """Controller and plant of the loops ``speed`` and ``tension``."""
        return {"speed": (self.speed, self.speed_plant), "tension": (self.tension, self.tension_plant)}

    @property
    def margins(self) -> dict[str, Margins]:
        """Stability margins of both loops."""
        return {name: margins(*loop) for name, loop in self.loops.items()}

    @property
    def poles(self) -> dict[str, list[complex]]:
        """Closed-loop poles of both loops, rad/s."""
        return {name: closed_poles(*loop) for name, loop in self.loops.items()}


def design(
    drives: CoupledDrives, speed_bandwidth: float | None = None, tension_bandwidth: float | None = None
) -> Design:
    """Controllers by the rule above.

    Parameters
    ----------
    drives : CoupledDrives
    speed_bandwidth, tension_bandwidth : float, optional
        Of the loop, rad/s; 5 times the slowest pole of the tension if not given. The margins may allow less; the
        design holds the bandwidth reached.

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
    >>> design(CoupledDrives(), tension_bandwidth=1000).verdicts[0][:63]
    'the tension loop reaches 286.3 rad/s, not the 1000 rad/s asked '
    """
    speed_plant, tension_plant = decoupled(drives)
    usual = FASTER * abs(_slowest(tension_plant))
    controllers, bandwidths = {}, {}
    for name, plant, asked in (("speed", speed_plant, speed_bandwidth), ("tension", tension_plant, tension_bandwidth)):
        wanted = usual if asked is None else float(positive(asked, f"{name}_bandwidth"))
        controllers[name], reached = _tuned(plant, wanted)
        bandwidths[name] = Bandwidth(None if asked is None else wanted, reached)
    return Design(drives, controllers["speed"], controllers["tension"], speed_plant, tension_plant, bandwidths)


def _slowest(plant: TransferFunction) -> complex:
    return max(plant.poles, key=lambda z: z.real)


def _tuned(plant: TransferFunction, bandwidth: float) -> tuple[PI, float]:
    """The PI controller by the rule above, and its bandwidth."""
    too_fast, reached = math.inf, bandwidth
    for _ in range(TRIES):
        if found := _tried(plant, reached):
            break
        too_fast, reached = reached, reached * LOWERED
    else:
        raise InputError(plant.name, "no PI controller of this rule has the margins", "some friction or damping")
    for _ in range(HALVINGS if too_fast < math.inf else 0):
        middle = math.sqrt(reached * too_fast)
        if better := _tried(plant, middle):
            found, reached = better, middle
        else:
            too_fast = middle
    return found, reached


def _tried(plant: TransferFunction, bandwidth: float) -> PI | None:
    """Return the PI controller of a bandwidth, if it has the margins."""
    pole = _slowest(plant)
    constant = math.inf if pole == 0 else (2 if pole.imag else 1) * -pole.real / abs(pole) ** 2
    integral = min(constant, 4 / bandwidth) or 4 / bandwidth
    allowed = math.pi + float(plant.phase(bandwidth)) - LEAST_PHASE_MARGIN - CERTAIN  # lag of the controller, rad
    if allowed <= 0:
        return None
    if allowed < math.pi / 2:
        integral = max(integral, 1 / (bandwidth * math.tan(allowed)))
    if integral > max(constant, 4 / bandwidth):
        return None
    response = plant(1j * bandwidth) * (1 + 1 / (1j * bandwidth * integral))
    gain = math.copysign(1 / abs(response), float(plant.numerator[0]))
    tried = PI(exact(gain, "gain"), exact(integral, "integral_time"))
    found = margins(tried, plant)
    stable = all(pole.real < 0 for pole in closed_poles(tried, plant))
    return tried if stable and found.phase >= LEAST_PHASE_MARGIN and found.gain >= LEAST_GAIN_MARGIN else None
