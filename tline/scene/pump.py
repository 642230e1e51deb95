"""Pumps: a curve at rated speed, affinity laws, a prescribed speed, or a run-down or start with inertia."""

from itertools import pairwise
from math import inf, pi
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import PrivateAttr, model_validator

from tline.errors import InputError
from tline.scene.element import NAMED, Between, named, optional, pair, required
from tline.scene.factor import ALWAYS, Factor
from tline.scene.law import Bend, ElementLaw, LawKind, OfLiquids, Shown
from tline.scene.pump_curves import TABLES, PumpPieces, Suter, backward, in_four_quadrants, parabola, smooth
from tline.scene.quantity import Frequency, Inertia, Instant, PositiveShare, Pressure, Quantity, Role
from tline.scene.waveform import PiecewiseLinear
from tline.words.wording import shown

MOST_OF_A_PARABOLA, LEAST_OF_SUTER = 3, 9  # points
EFFICIENCY = 0.75  # if none is given
LAST_OF_ONE = 2.0  # flow without rise over that of the single point of a curve
ONE_POINT = 4 / 3  # shut-off rise over that of the single point of a curve (L. A. Rossman, EPANET 2 manual, 2000)
Flow = Annotated[Quantity, Role("flow", "m^3/s", at_least=0)]


Ratio = Annotated[Quantity, Role("ratio", "")]
Pairs = list[Annotated[tuple[Ratio, Ratio], pair("head, torque over those of the rated point")]]
Quadrants = Annotated[Pairs, named("pump", TABLES, Pairs | Literal["radial", "mixed 61", "mixed 81"]), NAMED]


class Pumping(LawKind):
    """Law of a pump; constants: effort beyond, rise at rest, presence of a check valve; see `Pump._constants`."""

    name, unit = "pump", "laws.pump.pump"
    control = "speed"
    supplies = True

    def bends(self, c, rho):
        """Kinks where the check valve shuts, and between pieces of the curve: there at the rated speed, or at rest."""
        if c[2] > 0:
            yield Bend(c[0], -c[1], 2)
        number = int(c[5])
        borders, forms = c[9 : 8 + number], c[8 + number : 8 + 4 * number]
        for k, q in enumerate(borders):
            if q > 0 or (q == 0 and c[2] == 0):
                at_rest, linear, square = forms[3 * k : 3 * k + 3]
                yield Bend(c[0], rho * q - c[1] - (at_rest + linear * q + square * q**2), 2)

    def holds(self, c, control):  # noqa: D102
        return (-inf, c[0] - control**2 * c[1]) if c[2] else (0.0, 0.0)

    def source(self, c):  # noqa: D102
        return "a pump, which holds a source"


class Running(Pumping):
    """Law of a pump with inertia, whose state is its speed: at the start rated if it will run down, zero if it will
    start."""

    name, unit = "rotor", "stores.rotor.rotor"
    control = "trip"
    states = 1
    steady = "pump"

    def at_rest(self, c, effort, control):  # noqa: D102
        return (control,)

    def bends(self, c, rho):  # noqa: D102
        if c[2] > 0:
            yield Bend(0.0)  # where its flow stops


class Pump(Between, OfLiquids):
    """Pump from the first node to the second: rise = N²·h(Q/N), N the speed over the rated one.

    The curve h is a parabola through up to three points: for a single point the one with 4/3 of its rise at shut-off,
    where it has its summit. From four points on h is a smooth falling curve through them, continued beyond them by
    a parabola with its summit at rest. With `quadrants` flow and speed may take either sign while it runs down. A pump
    that starts is at rest before, and its motor has a constant torque up to the rated speed, which it then holds.
    """

    kind: Literal["pump"] = "pump"
    curve: list[Annotated[tuple[Flow, Pressure], pair("flow, pressure rise")]] = required(
        "points [flow, pressure rise] at rated speed", min_length=1, max_length=100
    )
    efficiency: PositiveShare | None = optional(
        "of the rotor: power of the water over that of the shaft, for curves of four points or more, "
        "and at the rated point for quadrants; the rotor of a parabola b, c loses what c takes"
    )
    quadrants: Quadrants | None = optional(
        "characteristics in four quadrants, with the rated point as the curve: 'radial', 'mixed 61' or "
        "'mixed 81', those of pumps of a specific speed of 25, 61 and 81 (turns a minute, m³/s, m), or "
        "Suter's points [WH, WB] at equal steps of the angle pi + arctan(flow/speed) from 0 to 2 pi"
    )
    speed: Factor = optional("over the rated speed, constant or over time", ALWAYS)
    trip: Instant | None = optional("when the motor fails and it begins to run down")
    inertia: Inertia | None = optional("of all that turns, the liquid in it included; needed with trip and start")
    rated_speed: Frequency | None = optional("turns per second; needed with trip and start")
    start: Instant | None = optional("when its motor starts it, from rest; or again after a trip, as the power returns")
    motor_torque: Annotated[Quantity, Role("torque", "N m", above=0)] | None = optional(
        "while it starts, up to the rated speed; needed with start"
    )
    check_valve: bool = optional("whether a check valve behind it lets nothing back", False)
    shows = (
        Shown("speed", "Hz", lambda pump, y, i: pump.rated_speed * y),
        Shown("flow", "m^3/s", lambda pump, y, i: i),
        Shown("torque", "N m", lambda pump, y, i: pump.torque(y, i)),
        Shown("shaft power", "W", lambda pump, y, i: pump.torque(y, i) * 2 * pi * pump.rated_speed * y),
    )
    _pieces: tuple[PumpPieces, PumpPieces] = PrivateAttr()

    @model_validator(mode="after")
    def _runs(self):
        self._pieces = self._of_curve()
        moved = [key for key in ("trip", "start") if getattr(self, key) is not None]
        if self.trip is not None and self.start is not None and self.start <= self.trip:
            raise InputError("start", "is not after the trip", f"later than {self.trip:g} s", f"{self.start:g} s")
        needed = {"inertia": self.inertia, "rated_speed": self.rated_speed}
        missing = [key for key, value in needed.items() if value is None]
        if moved and missing:
            raise InputError(missing[0], "is missing", f"with {moved[0]}, both inertia and rated_speed")
        if not moved and len(missing) < 2:
            raise InputError("trip", "is missing", "an instant, for inertia and rated_speed to matter")
        if (self.start is None) != (self.motor_torque is None):
            raise InputError("motor_torque" if self.start is not None else "start", "is missing", "both, or neither")
        if moved and self.speed.model_dump() != ALWAYS.model_dump():
            raise InputError("speed", f"cannot be prescribed beside a {moved[0]}", f"one of speed and {moved[0]}")
        return self

    def _of_curve(self) -> tuple[PumpPieces, PumpPieces]:
        """Pieces of the curve for a rotor that turns forward, and backward."""
        points = sorted((float(q), float(h)) for q, h in self.curve)
        if self.quadrants is not None:
            if len(points) != 1 or points[0][0] == 0 or points[0][1] <= 0:
                raise InputError("curve", "is not a rated point", "one with flow and rise above zero", shown(points))
            return in_four_quadrants(self._suter(), *points[0], float(self.efficiency or EFFICIENCY))
        if len(points) > MOST_OF_A_PARABOLA:
            _check_falls(points)
            forward = smooth(points, float(self.efficiency or EFFICIENCY))
            return forward, backward(forward)
        if self.efficiency is not None:
            problem = "is for curves of four points or more, or quadrants"
            raise InputError("efficiency", problem, "none", f"{self.efficiency:g}")
        form = _parabola(points)
        return parabola(*form), parabola(*form, sign=-1.0)

    def _suter(self) -> Suter:
        assert self.quadrants is not None
        if isinstance(self.quadrants, str):
            return TABLES[self.quadrants]
        head, torque = zip(*((float(h), float(b)) for h, b in self.quadrants), strict=True)
        if len(head) < LEAST_OF_SUTER or len(head) % 4 != 1 or (head[0], torque[0]) != (head[-1], torque[-1]):
            expected = "9, 13, 17, ... points around the whole turn, of which the last is the first"
            raise InputError("quadrants", "not Suter's tables", expected, f"{len(head)} points")
        return Suter(head, torque)

    @property
    def largest_power(self) -> float:
        """Largest hydraulic power along the curve at rated speed, W, with straight lines between points."""
        points = sorted((float(q), float(h)) for q, h in self.curve)
        middles = [((q + r) / 2, (h + k) / 2) for (q, h), (r, k) in pairwise(points)]
        return max(q * h for q, h in (*points, *middles))

    @property
    def largest_torque(self) -> float:
        """Largest torque along the curve at rated speed, times that speed, W."""
        forms, borders = self._pieces[0].torques, self._pieces[0].borders
        last = max(float(q) for q, _ in self.curve) * (1 if len(self.curve) > 1 else LAST_OF_ONE)
        return max(
            a + b * q + c * q**2
            for q in (0.25 * last, 0.5 * last, 0.75 * last, last)
            for a, b, c in [forms[int(np.searchsorted(borders, q))]]
        )

    def torque(self, speed: NDArray, flow: NDArray) -> NDArray:
        """Torque of the water on a pump with inertia, N m, at speeds over the rated one and flows."""
        found, size = np.zeros_like(speed), np.abs(speed)
        for pieces, here in zip(self._pieces, (speed >= 0, speed < 0), strict=True):
            pump = np.array(pieces.torques)[np.sum(flow[:, None] > size[:, None] * pieces.borders, axis=1)].T
            found = np.where(here, pump[0] * size**2 + pump[1] * size * flow + pump[2] * flow**2, found)
        return found / (2 * pi * float(self.rated_speed or 1.0))

    def law(self) -> ElementLaw:  # noqa: D102
        turned = [(at, on) for at, on in ((self.trip, 0.0), (self.start, 1.0)) if at is not None]
        if not turned or self.inertia is None or self.rated_speed is None:
            return ElementLaw("pump", self._constants(), self.speed)
        turns = 2 * pi * float(self.rated_speed)
        points = [(float(at), level) for at, on in turned for level in (1.0 - on, on)]
        constants = self._constants(self.inertia * turns**2, float(self.motor_torque or 0.0) * turns)
        return ElementLaw("rotor", constants, PiecewiseLinear.model_validate({"points": points}))

    def _constants(self, energy: float = 0.0, motor: float = 0.0) -> tuple[float, ...]:
        """Constants of the law; twice the energy at rated speed, J, and the power of the motor's torque there, W."""
        forward, back = self._pieces
        pieces = float(len(forward.rises)), float(len(back.rises)), float(motor), 0.0
        check = float(self.check_valve)
        return 0.0, forward.at_rest, check, float(energy), back.at_rest, *pieces, *forward.flat(), *back.flat()


def _check_falls(points: list[tuple[float, float]]) -> None:
    flows, rises = zip(*points, strict=True)
    if len(set(flows)) < len(flows) or any(np.diff(rises) >= 0):
        raise InputError("curve", "the rise does not fall with the flow", "a falling curve", shown(points))


def _parabola(points: list[tuple[float, float]]) -> tuple[float, float, float]:
    """Coefficients h0, b, c of rise = h0 - b Q - c Q² through the points."""
    flows, rises = zip(*points, strict=True)
    if len(points) == 1:
        if flows[0] == 0 or rises[0] == 0:
            raise InputError("curve", "its one point is no working point", "flow and rise above zero")
        return ONE_POINT * rises[0], 0.0, (ONE_POINT - 1) * rises[0] / flows[0] ** 2
    _check_falls(points)
    q, h = np.array(flows), np.array(rises)
    powers = q[:, None] ** (np.array([0, 2]) if len(points) == 2 else np.arange(3))
    solved = np.linalg.solve(powers, h)
    h0, c = solved[0], -solved[-1]
    b = -solved[1] if len(points) == 3 else 0.0
    if b < -1e-12 * h0 / q[-1] or c < -1e-12 * h0 / q[-1] ** 2:
        raise InputError("curve", "its parabola rises somewhere", "a curve that falls ever more steeply", shown(points))
    return float(h0), max(float(b), 0.0), max(float(c), 0.0)
