"""Stored, supplied and dissipated energy; the three are computed independently."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from flint import fmpq, fmpq_mat
from numpy.typing import NDArray

from drives.coupled import CoupledDrives
from drives.discretise import Legs, energy_matrix, joined
from drives.number import rational
from drives.state_space import StateSpace, floats

Rows = list[list[fmpq]]


@dataclass(frozen=True)
class Energy:
    """Energies at the samples, each of shape (n,).

    Attributes
    ----------
    stored : numpy.ndarray
        In spools, belts and the pulley with its spring [J].
    dissipated, supplied : numpy.ndarray
        Heat in bearings and belts, and work of the torques, since the start [J].
    """

    stored: NDArray[np.float64]
    dissipated: NDArray[np.float64]
    supplied: NDArray[np.float64]

    @property
    def imbalance(self) -> NDArray[np.float64]:
        """Gain in stored energy + dissipated - supplied: 0 but for rounding."""
        return self.stored - self.stored[0] + self.dissipated - self.supplied


def storage(drives: CoupledDrives) -> fmpq_mat:
    """H, exact and positive semidefinite: x'Hx is the stored energy, J."""
    half, names = Fraction(1, 2), drives.states
    terms = [(half * drives.left.inertia, {"w1": Fraction(1)}), (half * drives.right.inertia, {"w2": Fraction(1)})]
    terms += [(half * belt.stiffness, {name: Fraction(1)}) for name, belt in drives.damped.items()]
    terms += [(half * drives.spring, {"e_p": Fraction(1)}), (half * drives.pulley.belt_mass, {"v_p": Fraction(1)})]
    return _form([(c, [rational(row.get(name, Fraction(0))) for name in names]) for c, row in terms])


def open_torques(drives: CoupledDrives) -> Rows:
    """T1 and T2 if nobody controls them, as rows over (states, T1, T2, their slopes)."""
    n = len(drives.states)
    return [[fmpq(int(k == n + i)) for k in range(n + 4)] for i in range(2)]


def powers(drives: CoupledDrives, torques: Rows) -> tuple[fmpq_mat, fmpq_mat]:
    """Heat flow and supplied power, W, as quadratic forms of z.

    Parameters
    ----------
    drives : CoupledDrives
    torques : list of list of flint.fmpq
        T1 and T2, each as a combination of z, whose first entries are the states of the drives.
    """
    size, states = len(torques[0]), drives.states

    def row(entries: Mapping[str, Fraction]) -> list[fmpq]:
        known = [rational(entries.get(name, Fraction(0))) for name in states]
        return known + [fmpq(0)] * (size - len(known))

    w1, w2 = (row({name: Fraction(1)}) for name in ("w1", "w2"))
    heat = [(drives.left.friction, w1), (drives.right.friction, w2)]
    for name, rate in drives.belt_rates.items():
        heat.append((drives.damped[name].damping, row(rate)))
    quarter, work = Fraction(1, 4), []  # a*b = ((a + b)^2 - (a - b)^2)/4
    for sign, speed, torque in ((-1, w1, torques[0]), (1, w2, torques[1])):
        for other in (1, -1):
            both = [x + other * y for x, y in zip(speed, torque, strict=True)]
            work.append((sign * other * quarter, both))
    return _form(heat), _form(work)


def energy_of(drives: CoupledDrives, model: StateSpace, torques: Rows, x: NDArray, way: Legs) -> Energy:
    """Energies of a run of a linear model from the states at all ends of legs, exact between the samples.

    The model's first states are those of the drives, the torques are rows over (its states, its inputs, their slopes).
    """
    f, sums = joined(model.a, model.b), np.zeros((2, len(x)))
    z = np.column_stack([x[:-1], way.inputs])
    forms = powers(drives, torques)
    for length, chosen in way.groups():
        for total, form in zip(sums, forms, strict=True):
            total[1 + chosen] = squares(z[chosen], energy_matrix(f, form, length))
    dissipated, supplied = np.cumsum(sums, axis=1)[:, way.sampled]
    return Energy(stored_in(drives, x[way.sampled]), dissipated, supplied)


def stored_in(drives: CoupledDrives, x: NDArray) -> NDArray[np.float64]:
    """Stored energy in each state, J; the columns of x begin with the states of the drives."""
    return squares(x[:, : len(drives.states)], floats(storage(drives)))


def squares(z: NDArray, form: NDArray) -> NDArray[np.float64]:
    """z'Qz for each row z."""
    return ((z @ form) * z).sum(axis=1)


def _form(terms: Sequence[tuple[Fraction, list[fmpq]]]) -> fmpq_mat:
    """The sum of c*(row.z)^2 as a symmetric matrix."""
    n = len(terms[0][1])
    total = fmpq_mat(n, n)
    for c, row in terms:
        column = fmpq_mat(n, 1, row)
        total += column * column.transpose() * rational(c)
    return total
