"""Turbines with a rotor, a governor, and a load that may be rejected."""

from math import pi, sqrt
from typing import Annotated, ClassVar, Literal

from pydantic import model_validator

from tline.errors import InputError
from tline.scene.element import Between, optional, required
from tline.scene.law import Bend, ElementLaw, LawKind, OfLiquids, Shown
from tline.scene.quantity import (
    Duration,
    Frequency,
    Inertia,
    Instant,
    PositiveFlow,
    PositivePressure,
    PositiveShare,
    Quantity,
    Role,
)
from tline.scene.valve import Root
from tline.scene.waveform import PiecewiseLinear


class Driven(LawKind):
    """Law of a turbine; constants of `tline.solver.kernel.stores.turbine`, the last being the torque before the run."""

    name, unit = "turbine", "stores.turbine.turbine"
    control = "load"
    states = 2
    steady = Root.name

    def at_rest(self, c, effort, control):  # noqa: D102
        return 1.0, c[3]

    def bends(self, c, rho):  # noqa: D102
        yield Bend(c[0])

    def begun(self, c, drop, flow):  # noqa: D102
        return *c[:-1], max(flow, 0.0) * (c[5] * sqrt(max(drop, 0.0) / c[6]) - 1.0)


class Turbine(Between, OfLiquids):
    """Impulse turbine from the first node to the second, with its rotor, its load and a governor.

    The flow is opening·C·sqrt(drop), at any speed. The torque falls linearly with the speed, to zero at the
    runaway. Before the run the turbine has its rated speed and the load that its opening gives; any part of that load
    which is lost drives the rotor. With `droop` the gates move by droop·x' = -n' + (1 - n)/reset_time, n the speed over
    the rated one, no faster than in the stroke time; else they are fixed. For a machine whose flow depends on its speed
    use a `pump` with `quadrants`.

    References
    ----------
    E. B. Wylie, V. L. Streeter: Fluid Transients in Systems (1993); M. H. Chaudhry: Applied Hydraulic Transients,
    3rd edition (2014), on dashpot governors.
    """

    kind: Literal["turbine"] = "turbine"
    rated_flow: PositiveFlow = required("with its gates wide open, under the rated drop")
    rated_drop: PositivePressure = required("drop of the pressure there")
    rated_speed: Frequency = required("turns per second")
    inertia: Inertia = required("of all that turns, with the generator")
    efficiency: PositiveShare = optional("at the rated point", Quantity(0.88, ""))
    runaway: Annotated[Quantity, Role("ratio", "", above=1)] = optional(
        "speed without a load under the rated drop, over the rated speed", Quantity(1.8, "")
    )
    opening: PositiveShare = optional("of its gates before the run", Quantity(1, ""))
    rejects: Instant | None = optional("when the load is lost")
    load_left: Annotated[Quantity, Role("share", "", at_least=0)] = optional(
        "share of the load that is left then", Quantity(0, "")
    )
    droop: Annotated[Quantity, Role("ratio", "", above=0)] | None = optional(
        "temporary droop of the governor; without it the gates stand"
    )
    reset_time: Duration = optional("of the governor's dashpot", Quantity("6 s", "s"))
    stroke_time: Duration = optional("the least time from open to shut", Quantity("10 s", "s"))
    shows = (
        Shown("speed", "Hz", lambda turbine, y, i: turbine.rated_speed * y),
        Shown("opening", "", lambda turbine, y, i: y, last=True),
    )
    example: ClassVar[str] = """\
kind = "turbine"
rated_flow = "2 m^3/s"
rated_drop = "20 bar"
rated_speed = "500 rpm"
inertia = "20000 kg m^2"
droop = 0.4
rejects = "1 s"
"""

    @model_validator(mode="after")
    def _loses_once(self):
        if self.rejects is None and self.load_left:
            raise InputError("rejects", "is missing", "when the load changes to load_left")
        return self

    def law(self) -> ElementLaw:  # noqa: D102
        capacity = float(self.opening * self.rated_flow / sqrt(self.rated_drop))
        over = float(self.runaway) - 1
        energy = float(self.inertia * (2 * pi * self.rated_speed) ** 2 * over / (self.efficiency * self.rated_drop))
        gains = (0.0, 0.0) if self.droop is None else (1 / self.droop, 1 / (self.droop * self.reset_time))
        machine = float(self.opening), energy, 1 + over, float(self.rated_drop)
        governor = *map(float, gains), float(1 / self.stroke_time)
        left = None
        if self.rejects is not None:
            left = PiecewiseLinear.model_validate({"points": [(self.rejects, 1.0), (self.rejects, self.load_left)]})
        return ElementLaw("turbine", (0.0, capacity, 0.0, *machine, *governor, 0.0), left)
