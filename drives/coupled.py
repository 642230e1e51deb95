"""The whole mechanism: two spools, two belt sections, a pulley between them; its exact state space.

The massless pulley makes an algebraic loop: the speeds v1, v2 of the belt on its two sides follow from forces that
depend on v1 and v2. Positions bind the elongations, e1 + e2 + e_p = r2*phi2 - r1*phi1, and with the tension f, the same
everywhere, as the unknown everything is explicit:

    f = k_p*e_p,    de_i/dt = (f - K_i*e_i)/B_i                 pulley, belts
    J1*dw1/dt = -T1 - B1*w1 + r1*f                              spool 1
    J2*dw2/dt = T2 - B2*w2 - r2*f                               spool 2
    de_p/dt = r2*w2 - r1*w1 - de1/dt - de2/dt                   the positions, differentiated

The loop's unknowns follow: v1 = r1*w1 + de1/dt, v2 = r2*w2 - de2/dt. phi2 is no state but follows from the positions,
so the constraint cannot drift and there is one free angle, phi1, on which nothing depends. Elongations as states stay
small while the angles grow. An undamped belt (B_i = 0) has e_i = f/K_i and is no state: it makes the spring softer,
1/k_s = 1/k_p + 1/K_i, and e_p is then the elongation of both together.

A pulley with mass m_p, referred to the belt, opens the loop: e_p moves with a speed v_p of its own,

    m_p*dv_p/dt = f - k_p*e_p,    f*(1/B_1 + 1/B_2) = r2*w2 - r1*w1 - v_p + K_1*e_1/B_1 + K_2*e_2/B_2.
"""

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

from flint import fmpq, fmpq_mat

from drives.number import known_names, rational
from drives.parts import Belt, Pulley, Spool
from drives.state_space import StateSpace
from drives.symbolic import INPUTS, OUTPUTS, transfer
from drives.transfer import TransferFunction
from tline.errors import InputError, check_kind

SPOOL = Spool(Fraction(1, 1000), Fraction(1, 10), Fraction(1, 10))  # the exercise's parts
BELT = Belt(Fraction(50), Fraction(1, 2))
PULLEY = Pulley(Fraction(200), math.radians(45))
PARTS = {"left": Spool, "right": Spool, "left_belt": Belt, "right_belt": Belt, "pulley": Pulley}


@dataclass(frozen=True)
class CoupledDrives:
    """Two spools coupled by an elastic belt over a spring-mounted pulley; without arguments the exercise's.

    Parameters
    ----------
    left, right : Spool
        Spool 1, which T1 > 0 brakes, and spool 2, which T2 > 0 drives.
    left_belt, right_belt : Belt
        Between spool 1 and pulley, and between pulley and spool 2.
    pulley : Pulley

    Raises
    ------
    InputError
        One of them is another thing, or the pulley has a mass beside a belt without damping.

    Examples
    --------
    >>> drives = CoupledDrives()
    >>> drives.transfer("x_k", "T1").denominator
    (Fraction(1, 1), Fraction(500, 1), Fraction(2000, 1))
    >>> drives.state_space().states
    ('phi1', 'w1', 'w2', 'e_p', 'e1', 'e2')
    """

    left: Spool = SPOOL
    right: Spool = SPOOL
    left_belt: Belt = BELT
    right_belt: Belt = BELT
    pulley: Pulley = PULLEY

    def __post_init__(self):
        for name, kind in PARTS.items():
            check_kind(name, getattr(self, name), kind)
        if self.pulley.mass and len(self.damped) < 2:
            raise InputError("pulley.mass", "beside a belt without damping", "damping in both belts, or no mass")

    @property
    def symmetric(self) -> bool:
        """Whether both spools are the same to the belt: equal J/r^2 and B/r^2."""
        return self.mobility(self.left) == self.mobility(self.right)

    @staticmethod
    def mobility(spool: Spool) -> tuple[Fraction, Fraction]:
        """Return M = J/r^2 in kg and D = B/r^2 in N s/m, a spool referred to the belt."""
        return spool.inertia / spool.radius**2, spool.friction / spool.radius**2

    @cached_property
    def damped(self) -> dict[str, Belt]:
        """The belts whose elongation is a state."""
        return {name: belt for name, belt in (("e1", self.left_belt), ("e2", self.right_belt)) if belt.damping}

    @cached_property
    def spring(self) -> Fraction:
        """k_s in N/m: the pulley's spring in series with the undamped belts."""
        undamped = [belt for belt in (self.left_belt, self.right_belt) if not belt.damping]
        return 1 / (1 / self.pulley.belt_stiffness + sum((1 / belt.stiffness for belt in undamped), Fraction(0)))

    @cached_property
    def states(self) -> tuple[str, ...]:
        """Names: angle in rad, angular speeds in rad/s, elongations of the springs and of the damped belts in m; the
        speed v_p of e_p in m/s, if the pulley has a mass.
        """
        return ("phi1", "w1", "w2", *self.elongations, *(("v_p",) if self.pulley.mass else ()))

    @property
    def elongations(self) -> tuple[str, ...]:
        """States whose sum is r2*phi2 - r1*phi1."""
        return ("e_p", *self.damped)

    @cached_property
    def tension(self) -> dict[str, Fraction]:
        """f as a combination of the states."""
        if not self.pulley.mass:
            return {"e_p": self.spring}
        both = 1 / sum((1 / belt.damping for belt in self.damped.values()), Fraction(0))
        belts = {name: both * belt.stiffness / belt.damping for name, belt in self.damped.items()}
        return {"w1": -both * self.left.radius, "w2": both * self.right.radius, "v_p": -both, **belts}

    @cached_property
    def belt_rates(self) -> dict[str, dict[str, Fraction]]:
        """de/dt = (f - K*e)/B of each damped belt as a combination of the states."""
        found = {}
        for name, belt in self.damped.items():
            found[name] = plus(self.tension, 1 / belt.damping, {name: -belt.stiffness / belt.damping})
        return found

    def state_space(self, outputs: tuple[str, ...] = OUTPUTS, inputs: tuple[str, ...] = INPUTS) -> StateSpace:
        """The full model, exact, with named states; `.minimal()` of it leaves out modes hidden from these ports.

        Parameters
        ----------
        outputs : tuple of str
            Any of ``OUTPUTS``: x_k in m, tension in N, belt_speed in m/s (mean of both spools), w1 and w2 in rad/s,
            phi1 and phi2 in rad.
        inputs : tuple of str
            Any of ``INPUTS``, N m.

        Raises
        ------
        InputError
            An unknown name.

        Examples
        --------
        >>> CoupledDrives().state_space(("tension",), ("T1",)).A.shape
        (6, 6)
        """
        known_names("outputs", outputs, OUTPUTS)
        known_names("inputs", inputs, INPUTS)
        one, left, right = Fraction(1), self.left, self.right
        rates = {
            "phi1": {"w1": one},
            "w1": plus(self.tension, left.radius / left.inertia, {"w1": -left.friction / left.inertia}),
            "w2": plus(self.tension, -right.radius / right.inertia, {"w2": -right.friction / right.inertia}),
            **self.belt_rates,
        }
        if self.pulley.mass:
            heavy = 1 / self.pulley.belt_mass
            rates |= {"e_p": {"v_p": one}, "v_p": plus(self.tension, heavy, {"e_p": -self.spring * heavy})}
        else:
            rates["e_p"] = {"w1": -left.radius, "w2": right.radius}
            for rate in self.belt_rates.values():
                rates["e_p"] = plus(rate, -one, rates["e_p"])
        torques = {"w1": {"T1": -1 / left.inertia}, "w2": {"T2": 1 / right.inertia}}
        flexibility = -2 * self.pulley.cosine / self.pulley.stiffness
        seen = {name: {name: one} for name in ("w1", "w2", "phi1")}
        seen["phi2"] = {"phi1": left.radius / right.radius} | dict.fromkeys(self.elongations, 1 / right.radius)
        seen["tension"] = self.tension
        seen["x_k"] = {"e_p": flexibility * self.spring}
        seen["belt_speed"] = {"w1": left.radius / 2, "w2": right.radius / 2}
        return StateSpace(
            table(rates, self.states, self.states),
            table(torques, self.states, inputs),
            table(seen, outputs, self.states),
            fmpq_mat(len(outputs), len(inputs)),
            self.states,
            tuple(inputs),
            tuple(outputs),
        )

    @property
    def parameters(self) -> dict[str, Fraction]:
        """The parameters by the names of ``drives.symbolic.SYMBOLS``, c_squared = cos(theta)^2, and m of the pulley."""
        parts = (("1", self.left, self.left_belt), ("2", self.right, self.right_belt))
        found = {
            "k": self.pulley.stiffness,
            "m": self.pulley.mass,
            "c": self.pulley.cosine,
            "c_squared": self.pulley.cosine_squared,
        }
        for side, spool, belt in parts:
            found |= {f"J{side}": spool.inertia, f"B{side}": spool.friction, f"r{side}": spool.radius}
            found |= {f"K{side}": belt.stiffness, f"Bb{side}": belt.damping}
        return found

    def transfer(self, output: str, source: str) -> TransferFunction:
        """Transfer function from a torque to an output, exact and without hidden modes.

        Raises
        ------
        InputError
            An unknown name.

        Examples
        --------
        >>> print(CoupledDrives().transfer("belt_speed", "T2"))
        belt_speed/T2 = 50/(s + 100)
        """
        return transfer(self.parameters, output, source)


def plus(row: dict[str, Fraction], factor: Fraction, other: dict[str, Fraction]) -> dict[str, Fraction]:
    """factor*row + other."""
    return {name: factor * row.get(name, Fraction(0)) + other.get(name, Fraction(0)) for name in row | other}


def table(entries: dict[str, dict[str, Fraction]], rows: tuple[str, ...], columns: tuple[str, ...]) -> fmpq_mat:
    """Make a matrix with named rows and columns; entries not named are 0."""
    found = [entries.get(row, {}).get(column) for row in rows for column in columns]
    return fmpq_mat(len(rows), len(columns), [rational(x) if x else fmpq(0) for x in found])
