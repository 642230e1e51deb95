"""The drives with what is not linear, as a mechanism of `friction`: slack, dry friction in the spools, limited torques.

Everything is exact to rounding from event to event; the belts' relaxation bounds the steps, which are explicit.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

from drives.coupled import CoupledDrives
from drives.torque import Torque
from tline.errors import InputError

if TYPE_CHECKING:
    from friction import Event, Model

MOST_EVENTS = 100_000
Dry: TypeAlias = "Sequence[Model | None]"  # laws of friction of the left and the right bearing


class Parts:
    """Spools, belts and pulley, signal by signal.

    Attributes
    ----------
    mechanism : Mechanism
    states : dict of str to int
        Signals of the states of the drives.
    shown : dict of str to int
        Signals beside them that `run` is to give.
    """

    def __init__(self, drives: CoupledDrives, x0: NDArray, slack: bool = False):
        from friction.mechanism import Mechanism

        self.mechanism = m = Mechanism()
        self.drives, self.contacts, self.places, self.shown = drives, dict[str, int](), list[int](), dict[str, int]()
        names = zip(drives.states, x0.tolist(), strict=False)
        self.states = {name: m.state(start, watched=name != "phi1") for name, start in names}
        self.energies = m.state(watched=False), m.state(watched=False)
        self.tension = m.add({self.states["e_p"]: float(drives.spring)})
        if slack:
            self.tension = m.larger(self.tension, m.add({}))

    def of(self, row: NDArray) -> dict[int, float]:
        """A combination of the states."""
        return dict(zip(self.states.values(), row.tolist(), strict=True))

    def move(self, T1: int, T2: int, friction: Dry = (None, None)) -> None:
        """The equations of motion under torques, which are signals."""
        from friction.methods import STATIC

        m, state, drives, heat, work = self.mechanism, self.states, self.drives, {}, {}
        stretching = {state["w2"]: float(drives.right.radius), state["w1"]: -float(drives.left.radius)}
        for name, belt in drives.damped.items():
            per_damping = 1.0 / float(belt.damping)
            speed = m.add({self.tension: per_damping, state[name]: -float(belt.stiffness) * per_damping})
            m.integrate(state[name], speed)
            heat[m.multiply(speed, speed)] = float(belt.damping)
            stretching[speed] = -1.0
        m.integrate(state["e_p"], m.add(stretching))
        m.integrate(state["phi1"], state["w1"])
        per_radius = 1.0 / float(drives.right.radius)
        angles = {"left": {state["phi1"]: 1.0}, "right": {state[name]: per_radius for name in drives.states[3:]}}
        angles["right"][state["phi1"]] = float(drives.left.radius) * per_radius
        sides = ("left", "w1", T1, drives.left, -1.0), ("right", "w2", T2, drives.right, 1.0)
        for (side, name, torque, spool, sign), law in zip(sides, friction, strict=True):
            w, pull = state[name], {torque: sign, self.tension: -sign * float(spool.radius)}
            net = m.add(pull | {state[name]: -float(spool.friction)})
            if law is not None:
                if not isinstance(law, STATIC):
                    raise InputError("friction", f"{law.name} has no events", "coulomb or karnopp")
                self.contacts[side], net = m.contact(law, w, net)
                self.places.append(m.add(angles[side]))
                heat[m.multiply(self.contacts[side], w)] = 1.0
            m.integrate(w, m.add({net: 1.0 / float(spool.inertia)}))
            heat[m.multiply(w, w)] = float(spool.friction)
            work[m.multiply(torque, w)] = sign
        for energy, power in zip(self.energies, (heat, work), strict=True):
            m.integrate(energy, m.add(power))

    def run(
        self, t: NDArray, inputs: Sequence[Torque]
    ) -> "tuple[NDArray, list[NDArray], dict[str, NDArray], dict[str, list[Event]]]":
        """States, shape (n, states); heat and work; what else is shown; events of the spools."""
        from friction.kernel import DONE, Inputs
        from friction.result import events_of

        corners = np.array(sorted({time for one in inputs for time in one.times}))
        values, slopes = (np.column_stack(each) for each in zip(*(one.pieces(corners) for one in inputs), strict=True))
        signals = {**self.states, "heat": self.energies[0], "work": self.energies[1], **self.shown}
        given = Inputs(corners, values, slopes, 0.0, 0.0, 0.0)
        status, found, changes = self.mechanism.run(t, signals, given, places=self.places, events=MOST_EVENTS)
        if status != DONE:
            raise InputError("simulation", "takes too many steps", "a shorter run, or belts without damping")
        events = {side: events_of(changes[changes[:, 4] == k]) for k, side in enumerate(self.contacts)}
        x = np.column_stack([found[name] for name in self.states])
        return x, [found["heat"], found["work"]], {name: found[name] for name in self.shown}, events
