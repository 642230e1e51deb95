"""Nonlinear drives as a mechanism of `friction`: slack, dry friction in the spools, limited torques.

Everything is exact to rounding from event to event; the belts' relaxation bounds the steps, which are explicit.
"""

from collections.abc import Sequence
from math import pi
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

from drives.coupled import CoupledDrives
from drives.parts import Winding
from drives.torque import Torque
from tline.errors import InputError

if TYPE_CHECKING:
    from friction import Event, Model

MOST_EVENTS = 100_000
REFUSED = ("", "takes too many steps", "beyond the range of floats", "changes without end at one instant")  # by status
Dry: TypeAlias = "Sequence[Model | None]"  # laws of friction of the left and the right bearing


class Assembly:
    """Spools, belts and pulley, signal by signal.

    Attributes
    ----------
    mechanism : Mechanism
    states : dict of str to int
        Signals of the states of the drives.
    shown : dict of str to int
        Signals beside them that `run` is to give.
    """

    def __init__(self, drives: CoupledDrives, x0: NDArray, slack: bool = False, winding: Winding | None = None):
        from friction.mechanism import Mechanism

        self.mechanism = m = Mechanism()
        self.drives, self.slack, self.winding, self.contacts = drives, slack, winding, dict[str, int]()
        self.places, self.shown, self.spools = list[int](), dict[str, int](), {"1": drives.left, "2": drives.right}
        names = zip(drives.states, x0.tolist(), strict=False)
        self.states = {name: m.state(start, watched=bool(winding) or name != "phi1") for name, start in names}
        self.energies = m.state(watched=False), m.state(watched=False)
        self.heat, self.work = dict[int, float](), dict[int, float]()
        radii = {side: float(spool.radius) for side, spool in self.spools.items()}
        phi = {"1": float(x0[0]), "2": (radii["1"] * x0[0] + x0[3:].sum()) / radii["2"]}
        if winding:
            self.states["phi2"] = m.state(phi["2"])
            m.integrate(self.states["phi2"], self.states["w2"])
            self._wind(winding, phi)
        pull = {name: float(factor) for name, factor in drives.tension.items()}
        rims = self._stretching(-pull["v_p"]) if drives.pulley.mass else {}
        self.tension = m.add({self.states[name]: pull[name] for name in pull if name not in ("w1", "w2")} | rims)
        if slack and drives.pulley.mass:
            raise InputError("slack", "beside a pulley with mass", "one of both")
        if slack:
            self.tension = m.larger(self.tension, m.add({}))
        if winding:
            self.shown["tension"] = self.tension

    def _wind(self, winding: Winding, phi: dict[str, float]) -> None:
        """Radii, inertias, and 1/J as states that follow dJ/dt = -/+ line_density r^3 w."""
        m, density = self.mechanism, float(winding.line_density)
        for (side, spool), sign in zip(self.spools.items(), (-1.0, 1.0), strict=True):
            r0, turn, w = float(spool.radius), sign * float(winding.thickness) / (2.0 * pi), self.states[f"w{side}"]
            radius, share = m.add({self.states[f"phi{side}"]: turn}, r0), density / abs(4.0 * turn)
            square = m.multiply(radius, radius)
            inertia = m.add({m.multiply(square, square): share}, float(spool.inertia) - share * r0**4)
            flow = m.multiply(m.multiply(square, radius), w)
            mobility = m.state(1.0 / (float(spool.inertia) + share * ((r0 + turn * phi[side]) ** 4 - r0**4)))
            m.integrate(mobility, m.add({m.multiply(m.multiply(mobility, mobility), flow): -sign * density}))
            self.work[m.multiply(m.multiply(flow, w), w)] = 0.5 * sign * density
            self.shown |= {f"r{side}": radius, f"J{side}": inertia, f"1/J{side}": mobility}

    def _at_rim(self, side: str, signal: int, factor: float) -> dict[int, float]:
        """A signal times the radius of a spool, and times a factor."""
        if self.winding:
            return {self.mechanism.multiply(self.shown[f"r{side}"], signal): factor}
        return {signal: factor * float(self.spools[side].radius)}

    def _stretching(self, factor: float) -> dict[int, float]:
        """r2*w2 - r1*w1 times a factor."""
        return self._at_rim("2", self.states["w2"], factor) | self._at_rim("1", self.states["w1"], -factor)

    def move(self, T1: int, T2: int, friction: Dry = (None, None)) -> None:
        """The equations of motion under torques, which are signals."""
        from friction.methods import STATIC

        m, state, drives = self.mechanism, self.states, self.drives
        stretching = self._stretching(1.0)
        for name, belt in drives.damped.items():
            per_damping = 1.0 / float(belt.damping)
            speed = m.add({self.tension: per_damping, state[name]: -float(belt.stiffness) * per_damping})
            m.integrate(state[name], speed)
            self.heat[m.multiply(speed, speed)] = float(belt.damping)
            stretching[speed] = -1.0
        if "v_p" in state:
            heavy = 1.0 / float(drives.pulley.belt_mass)
            m.integrate(state["v_p"], m.add({self.tension: heavy, state["e_p"]: -heavy * float(drives.spring)}))
            stretching = {state["v_p"]: 1.0}
        m.integrate(state["e_p"], m.add(stretching))
        m.integrate(state["phi1"], state["w1"])
        per_radius = 1.0 / float(drives.right.radius)
        angles = {"1": {state["phi1"]: 1.0}, "2": {state[name]: per_radius for name in drives.elongations}}
        angles["2"][state["phi1"]] = float(drives.left.radius) * per_radius
        if self.winding:
            angles["2"] = {state["phi2"]: 1.0}
        sides = ("1", "left", T1, -1.0), ("2", "right", T2, 1.0)
        for (side, name, torque, sign), law in zip(sides, friction, strict=True):
            w, spool = state[f"w{side}"], self.spools[side]
            net = m.add({torque: sign, w: -float(spool.friction)} | self._at_rim(side, self.tension, -sign))
            if law is not None:
                if not isinstance(law, STATIC):
                    raise InputError("friction", f"{law.name} has no events", "coulomb or karnopp")
                self.contacts[name], net = m.contact(law, w, net)
                self.places.append(m.add(angles[side]))
                self.heat[m.multiply(self.contacts[name], w)] = 1.0
            if self.winding:
                m.integrate(w, m.multiply(net, self.shown[f"1/J{side}"]))
            else:
                m.integrate(w, m.add({net: 1.0 / float(spool.inertia)}))
            self.heat[m.multiply(w, w)] = float(spool.friction)
            self.work[m.multiply(torque, w)] = sign
        for energy, power in zip(self.energies, (self.heat, self.work), strict=True):
            m.integrate(energy, m.add(power))

    def run(
        self, t: NDArray, inputs: Sequence[Torque]
    ) -> "tuple[NDArray, list[NDArray], dict[str, NDArray], dict[str, list[Event]]]":
        """Run; return states, shape (n, states); heat and work; other recorded signals; events of the spools."""
        from friction.kernel.law import BUDGET, DONE
        from friction.kernel.structures import Inputs
        from friction.result import events_of

        corners = np.array(sorted({time for one in inputs for time in one.times}))
        values, slopes = (np.column_stack(each) for each in zip(*(one.pieces(corners) for one in inputs), strict=True))
        signals = {**self.states, "heat": self.energies[0], "work": self.energies[1], **self.shown}
        given = Inputs(corners, np.stack([values, slopes], axis=-1), 0.0, 0.0, 0.0)
        status, found, changes = self.mechanism.run(t, signals, given, places=self.places, events=MOST_EVENTS)
        if status != DONE:
            last = t[np.isfinite(found["heat"])].max(initial=0.0)
            expected = "a shorter run, or belts without damping" if status == BUDGET else "a stable loop"
            why = REFUSED[status] + ", or the left spool is empty" * bool(self.winding)
            raise InputError("simulation", why, expected, f"nothing after {last:.4g} s")
        events = {side: events_of(changes[changes[:, 4] == k]) for k, side in enumerate(self.contacts)}
        x = np.column_stack([found[name] for name in self.drives.states])
        return (
            x,
            [found["heat"], found["work"]],
            {name: found[name] for name in signals if name not in self.drives.states},
            events,
        )
