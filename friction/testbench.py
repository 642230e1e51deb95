"""The testbench: a mass on a table, the force applied to it, and perhaps a spring that pulls it."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from math import pi
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from friction.parameters import Parameters
from tline.errors import InputError, check_kind

if TYPE_CHECKING:
    from friction.kernel.law import Drive

STEEPEST = 1e30  # N/s; products of slopes and times stay finite
MOST_DELAYED = 10_000  # periods of a sampled controller


class Force(Protocol):
    """Applied force: straight pieces, and a sine (amplitude, angular frequency, phase)."""

    def pieces(self) -> tuple[NDArray, NDArray, NDArray]:
        """Start, value there and slope of the straight pieces; the last goes on for ever."""
        ...

    @property
    def sine(self) -> tuple[float, float, float]:
        """Amplitude [N], angular frequency [rad/s], phase [rad]."""
        ...


@dataclass(frozen=True)
class Ramp(Parameters, example=("Ramp(slope=2.0).offset", "0.0")):
    """Offset + slope·t."""

    slope: float = 0.5
    offset: float = 0.0
    place = "force"
    sine = (0.0, 0.0, 0.0)

    def pieces(self) -> tuple[NDArray, NDArray, NDArray]:
        """One straight piece."""
        return np.array([0.0]), np.array([float(self.offset)]), np.array([float(self.slope)])


@dataclass(frozen=True)
class Sine(Parameters, example=("Sine(1.0, 0.5, phase=2.0).sine", "(1.0, 3.141592653589793, 2.0)")):
    """Offset + slope·t + amplitude·sin(2π·frequency·t + phase)."""

    amplitude: float
    frequency: float
    offset: float = 0.0
    phase: float = 0.0
    slope: float = 0.0
    place = "force"

    pieces = Ramp.pieces

    @property
    def sine(self) -> tuple[float, float, float]:
        """Amplitude [N], angular frequency [rad/s], phase [rad]."""
        return float(self.amplitude), 2.0 * pi * self.frequency, float(self.phase)


@dataclass(frozen=True)
class _Points(Parameters):
    """Values at times."""

    times: Sequence[float]
    values: Sequence[float]
    place = "force"
    sine = (0.0, 0.0, 0.0)

    def __post_init__(self):
        super().__post_init__()
        if len(self.times) != len(self.values) or not self.times:
            given = f"{len(self.values)} values"
            raise InputError("force", "times and values do not match", "as many values as times", given)
        for k, (last, t) in enumerate(pairwise(self.times), 1):
            if t <= last:
                raise InputError(f"force.times[{k}]", "times do not rise", f"more than {last:g}", f"{t:g}")


@dataclass(frozen=True)
class Steps(_Points, example=("Steps([1.0], [5.0]).pieces()[1].tolist()", "[0.0, 5.0]")):
    """`values[k]` from `times[k]` on; 0 before the first."""

    def pieces(self) -> tuple[NDArray, NDArray, NDArray]:
        """One level piece each."""
        t, f = np.array(self.times, float), np.array(self.values, float)
        if t[0] > 0.0:
            t, f = np.r_[0.0, t], np.r_[0.0, f]
        return t, f, np.zeros(t.size)


@dataclass(frozen=True)
class Table(_Points, example=("Table([0.0, 2.0], [0.0, 1.0]).pieces()[2].tolist()", "[0.5, 0.0]")):
    """Straight lines between points; constant before the first and after the last."""

    def __post_init__(self):
        super().__post_init__()
        for k, ((t0, f0), (t1, f1)) in enumerate(pairwise(zip(self.times, self.values, strict=True)), 1):
            rise, time = abs(f1 - f0), t1 - t0
            if not rise <= STEEPEST * time:
                expected = f"at most {STEEPEST:g} N/s, or steps"
                raise InputError(
                    f"force.times[{k}]", "the force changes too fast", expected, f"{rise:g} N in {time:g} s"
                )

    def pieces(self) -> tuple[NDArray, NDArray, NDArray]:
        """One straight piece each."""
        t, f = np.array(self.times, float), np.array(self.values, float)
        if t[0] > 0.0:
            t, f = np.r_[0.0, t], np.r_[f[0], f]
        return t, f, np.r_[np.diff(f) / np.diff(t), 0.0]


FORCES = Ramp, Sine, Steps, Table


@dataclass(frozen=True)
class Spring(Parameters, example=("Spring(20.0, 0.05).speed", "0.05")):
    """A spring, slack at x = 0, whose far end moves: the stick–slip rig; with play it is slack that far either way."""

    stiffness: float
    speed: float
    play: float = 0.0
    place = "spring"


@dataclass(frozen=True)
class PID(Parameters, example=("PID(100.0, integral=50.0).derivative", "0.0")):
    """A controller: proportional·e + integral·∫e dt + derivative·ė, with the error e = target + speed·t − x.

    With a period it samples e at its multiples: ∫e dt is then a sum that includes the newest e, ė a difference to the
    one before, and the force is held from a delay later on until the next.
    """

    proportional: float
    integral: float = 0.0
    derivative: float = 0.0
    target: float = 0.0
    speed: float = 0.0
    limit: float | None = None
    period: float = 0.0
    delay: float = 0.0
    place = "controller"

    def __post_init__(self):
        super().__post_init__()
        if self.delay and not self.period:
            raise InputError("controller.delay", "without a period", "a sampled controller", f"{self.delay:g}")
        if self.delay > MOST_DELAYED * self.period:
            expected = f"at most {MOST_DELAYED} periods"
            raise InputError("controller.delay", "too long", expected, f"{self.delay:g}")


@dataclass(frozen=True)
class Testbench(Parameters):
    """A mass that starts at x0 with velocity v0, pushed by a force and pulled by a spring.

    Parameters
    ----------
    force : Ramp, Sine, Steps or Table, optional
        Applied force; the exercise's ramp of 0.5 N/s if not given.
    mass : float, optional
        Mass [kg], positive.
    v0 : float, optional
        Velocity at t = 0 [m/s].
    spring : Spring, optional
        Adds stiffness·(speed·t − x) to the applied force; with play, for `events`, the method of the static laws.
    controller : PID, optional
        Adds its force, in place of a spring; for `events`, the method of the static laws.
    x0 : float, optional
        Place at t = 0 [m].
    z0 : float, optional
        Deflection of the bristles at t = 0 [m]; 0 for a law without bristles.

    Raises
    ------
    InputError
        A number out of range or not finite; not a force, spring or controller; both a spring and a controller.

    Examples
    --------
    >>> from friction import Ramp, Testbench
    >>> Testbench(Ramp(2.0), v0=-1.0).mass
    1.0
    """

    __test__ = False  # not a test for pytest

    force: Force = field(default_factory=Ramp)
    mass: float = 1.0
    v0: float = 0.0
    spring: Spring | None = None
    controller: PID | None = None
    x0: float = 0.0
    z0: float = 0.0
    place = "bench"

    def __post_init__(self):
        super().__post_init__()
        check_kind("bench.force", self.force, *FORCES)
        for name, kind in (("spring", Spring), ("controller", PID)):
            if getattr(self, name) is not None:
                check_kind(f"bench.{name}", getattr(self, name), kind)
        if self.spring and self.controller:
            raise InputError("bench.controller", "beside a spring", "one of both")

    @property
    def drive(self) -> "Drive":
        """Applied force in the form of the kernels."""
        from friction.kernel.law import Drive

        pid = self.controller or PID(0.0)
        if self.spring:
            pid = PID(self.spring.stiffness, speed=self.spring.speed)
        pull = pid.proportional, pid.speed, pid.target, pid.integral, pid.derivative
        return Drive(*self.force.pieces(), *self.force.sine, *map(float, pull))

    @property
    def start(self) -> NDArray:
        """x, v, z and both works at t = 0."""
        return np.array([self.x0, self.v0, self.z0, 0.0, 0.0])
