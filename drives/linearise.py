"""Linearisation: exact eigenvalues, and why a difference quotient makes a drive look slightly unstable.

The pulley of the exercise's Modelica text binds speeds only, v1 - v2 = 2*v_k*cos(theta), and not positions. Written
down literally it has one state too many, phi1, w1, phi2, w2, s1, s2, x_k with the belt's positions s1, s2 at the
pulley, and two eigenvalues 0: the mechanism may stand anywhere (the columns of phi and s cancel), and the position
constraint may be off by any constant (the rows of s1, s2 and x_k depend on each other). A forward difference computes
each of the columns with its own rounding error, about 1e-8 of its size, which moves the first 0 to a random side, up to
1e-5 rad/s. The second stays, but for the rounding of the eigenvalue algorithm itself, about 1e-13, and so does the
first where the quotient happens to be exact. Two zeros, each on a random side: with probability 1 - (1/2)^2 = 3/4 one
of them is positive.
"""

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from flint import fmpq_mat
from numpy.typing import NDArray

from drives.coupled import CoupledDrives, table
from drives.roots import roots

STEP = 2.0**-26  # the root of the precision of a float
ROUNDING = 1e-9  # rad/s, far more than eigenvalue algorithms make of an exact 0 here
LITERAL_STATES = ("phi1", "w1", "phi2", "w2", "s1", "s2", "x_k")


@dataclass(frozen=True)
class Artefact:
    """What a difference quotient makes of eigenvalues that are exactly 0.

    Attributes
    ----------
    runs, unstable : int
        Linearisations at random operating points, and how many of them had an eigenvalue with positive real part.
    by_difference : int
        Those where it is larger than `ROUNDING`, so that the difference quotient alone can have made it.
    largest : float
        Largest real part seen, rad/s.
    exact_zeros : int
        Eigenvalues that are exactly 0.
    """

    runs: int
    unstable: int
    by_difference: int
    largest: float
    exact_zeros: int


def eigenvalues(matrix: fmpq_mat) -> list[complex]:
    """All eigenvalues of an exact matrix with their multiplicity, zeros as exact zeros; see `drives.roots.roots`.

    Examples
    --------
    >>> eigenvalues(CoupledDrives().state_space().a)[-1]
    0j
    """
    return roots(matrix.charpoly())


def zero_eigenvalues(matrix: fmpq_mat) -> int:
    """How often 0 is an eigenvalue, exactly.

    Examples
    --------
    >>> zero_eigenvalues(CoupledDrives().state_space().a), zero_eigenvalues(literal_jacobian(CoupledDrives()))
    (1, 2)
    """
    return next(k for k, c in enumerate(matrix.charpoly().coeffs()) if c != 0)


def forward_difference(rates: Callable[[NDArray], NDArray], at: NDArray) -> NDArray[np.float64]:
    """The Jacobian as most tools compute it: (f(x + h) - f(x))/h with h = 1.5e-8*max(1, |x|), column by column."""
    base, columns = rates(at), []
    for k in range(len(at)):
        moved = at.copy()
        moved[k] += STEP * max(1.0, abs(at[k]))
        columns.append((rates(moved) - base) / (moved[k] - at[k]))
    return np.array(columns).T


def literal_rates(drives: CoupledDrives, torques: tuple[float, float] = (0.0, 0.0)) -> Callable[[NDArray], NDArray]:
    """dx/dt of the literal Modelica model in the states ``LITERAL_STATES``; both belts have to be damped."""
    left, right, pulley = drives.left, drives.right, drives.pulley

    def rates(x: NDArray) -> NDArray:
        phi1, w1, phi2, w2, s1, s2, x_k = x
        tension = pulley.tension(x_k)
        v1 = float(left.radius) * w1 + drives.left_belt.rate(tension, s1 - float(left.radius) * phi1)
        v2 = float(right.radius) * w2 - drives.right_belt.rate(tension, float(right.radius) * phi2 - s2)
        return np.array(
            [
                w1,
                left.acceleration(-torques[0], tension, w1),
                w2,
                right.acceleration(torques[1], -tension, w2),
                v1,
                v2,
                pulley.speed(v1, v2),
            ]
        )

    return rates


def literal_jacobian(drives: CoupledDrives) -> fmpq_mat:
    """The exact Jacobian of `literal_rates`."""
    left, right, c = drives.left, drives.right, drives.pulley.cosine
    b1, b2, one = drives.left_belt, drives.right_belt, Fraction(1)
    tension = -drives.pulley.stiffness / (2 * c)
    v1 = {"w1": left.radius, "x_k": tension / b1.damping, "s1": -b1.stiffness / b1.damping}
    v1["phi1"] = left.radius * b1.stiffness / b1.damping
    v2 = {"w2": right.radius, "x_k": -tension / b2.damping, "s2": -b2.stiffness / b2.damping}
    v2["phi2"] = right.radius * b2.stiffness / b2.damping
    rates = {
        "phi1": {"w1": one},
        "w1": {"w1": -left.friction / left.inertia, "x_k": left.radius * tension / left.inertia},
        "phi2": {"w2": one},
        "w2": {"w2": -right.friction / right.inertia, "x_k": -right.radius * tension / right.inertia},
        "s1": v1,
        "s2": v2,
        "x_k": {name: (v1.get(name, 0) - v2.get(name, Fraction(0))) / (2 * c) for name in v1 | v2},
    }
    return table(rates, LITERAL_STATES, LITERAL_STATES)


def artefact(drives: CoupledDrives, runs: int = 400, seed: int = 1) -> Artefact:
    """Linearise the literal model by forward differences at random operating points and count what looks unstable.

    Examples
    --------
    >>> seen = artefact(CoupledDrives(), runs=100)
    >>> seen.exact_zeros, 50 < seen.unstable < 95, seen.largest < 1e-3
    (2, True, True)
    """
    random = np.random.default_rng(seed)
    largest = []
    for _ in range(runs):
        torques = (random.uniform(-1, 1), random.uniform(-1, 1))
        jacobian = forward_difference(literal_rates(drives, torques), random.uniform(-1, 1, len(LITERAL_STATES)))
        largest.append(np.linalg.eigvals(jacobian).real.max())
    unstable, by_difference = (sum(bool(x > bound) for x in largest) for bound in (0, ROUNDING))
    return Artefact(runs, unstable, by_difference, float(max(largest)), zero_eigenvalues(literal_jacobian(drives)))
