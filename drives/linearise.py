"""Linearisation: exact eigenvalues, and why a difference quotient makes a drive look slightly unstable.

The pulley of the exercise's Modelica text binds speeds only, v1 - v2 = 2*v_k*cos(theta), and not positions. Written
down literally it has one state too many, phi1, w1, phi2, w2, s1, s2, x_k with the belt's positions s1, s2 at the
pulley, and two eigenvalues 0: the mechanism may rest anywhere (the columns of phi and s cancel), and the position
constraint may be off by any constant (the rows of s1, s2 and x_k depend on each other). A forward difference computes
each of the columns with its own rounding error, about 1e-8 of its size, which moves the first 0 to a random side, up to
1e-5 rad/s. The second stays, but for the rounding of the eigenvalue algorithm itself, about 1e-13, and so does the
first where the quotient happens to be exact. Two zeros, each on a random side: with probability 1 - (1/2)^2 = 3/4 one
of them is positive.
"""

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from flint import fmpq_mat
from numpy.typing import ArrayLike, NDArray

from drives.coupled import CoupledDrives
from drives.number import rational

STEP = 2.0**-26  # the root of the precision of a float
ZERO_RATE = 1e-9  # rad/s, far more than eigenvalue algorithms make of an exact 0 here
LITERAL_STATES = ("phi1", "w1", "phi2", "w2", "s1", "s2", "x_k")


@dataclass(frozen=True)
class Artefact:
    """Computed counterparts, by a difference quotient, of eigenvalues that are exactly 0.

    Attributes
    ----------
    runs, unstable : int
        Linearisations at random operating points, and how many of them had an eigenvalue with positive real part.
    by_difference : int
        Those where it is larger than `ZERO_RATE`, so that the difference quotient alone can have made it.
    largest : float
        Largest real part found, rad/s.
    exact_zeros : int
        Eigenvalues that are exactly 0.
    """

    runs: int
    unstable: int
    by_difference: int
    largest: float
    exact_zeros: int


def zero_eigenvalues(matrix: fmpq_mat) -> int:
    """How often 0 is an eigenvalue, exactly.

    Parameters
    ----------
    matrix : flint.fmpq_mat
        Square.

    Examples
    --------
    >>> zero_eigenvalues(CoupledDrives().state_space().a), zero_eigenvalues(literal_jacobian(CoupledDrives()))
    (1, 2)
    """
    return next(k for k, c in enumerate(matrix.charpoly().coeffs()) if c != 0)


def forward_difference(rates: Callable[[NDArray], ArrayLike], at: NDArray) -> NDArray[np.float64]:
    """The Jacobian as most tools compute it: (f(x + h) - f(x))/h with h = 1.5e-8*max(1, |x|), column by column.

    Parameters
    ----------
    rates : callable
        dx/dt of a state.
    at : numpy.ndarray, shape (n,)
        Where, each in the unit of its state.

    Examples
    --------
    >>> forward_difference(lambda x: -3.0 * x, np.array([0.0]))
    array([[-3.]])
    """
    base, columns = np.array(rates(at)), []
    for k in range(len(at)):
        moved = at.copy()
        moved[k] += STEP * max(1.0, abs(at[k]))
        columns.append((np.array(rates(moved)) - base) / (moved[k] - at[k]))
    return np.array(columns).T


def literal_rates(
    drives: CoupledDrives, torques: tuple[Any, Any] = (0, 0), number: Callable = float
) -> Callable[[Any], list[Any]]:
    """dx/dt of the literal Modelica model in the states ``LITERAL_STATES``; both belts have to be damped.

    Parameters
    ----------
    drives : CoupledDrives
    torques : tuple of number
        T1 and T2 [N m].
    number : callable
        Number type to compute in: float, or Fraction.

    Examples
    --------
    >>> literal_rates(CoupledDrives(), (1.0, 0.0))([0.0] * 7)[1]
    -1000.0
    """
    (j1, b1, r1), (j2, b2, r2) = (map(number, vars(one).values()) for one in (drives.left, drives.right))
    (k1, d1), (k2, d2) = (map(number, vars(one).values()) for one in (drives.left_belt, drives.right_belt))
    k, c = number(drives.pulley.stiffness), number(drives.pulley.cosine)

    def rates(x: Any) -> list[Any]:
        phi1, w1, phi2, w2, s1, s2, x_k = x
        tension = -k * x_k / (2 * c)
        v1 = r1 * w1 + (tension - k1 * (s1 - r1 * phi1)) / d1
        v2 = r2 * w2 - (tension - k2 * (r2 * phi2 - s2)) / d2
        turned = (r1 * tension - torques[0] - b1 * w1) / j1, (torques[1] - r2 * tension - b2 * w2) / j2
        return [w1, turned[0], w2, turned[1], v1, v2, (v1 - v2) / (2 * c)]

    return rates


def literal_jacobian(drives: CoupledDrives) -> fmpq_mat:
    """The exact Jacobian of `literal_rates`, which are linear: its columns are the rates at unit vectors.

    Parameters
    ----------
    drives : CoupledDrives

    Examples
    --------
    >>> literal_jacobian(CoupledDrives())[1, 1]
    -100
    """
    n, rates = len(LITERAL_STATES), literal_rates(drives, number=Fraction)
    columns = [rates([Fraction(int(i == k)) for i in range(n)]) for k in range(n)]
    return fmpq_mat(n, n, [rational(x) for column in columns for x in column]).transpose()


def artefact(drives: CoupledDrives, runs: int = 400, seed: int = 1) -> Artefact:
    """Linearise the literal model by forward differences at random operating points and count unstable results.

    Parameters
    ----------
    drives : CoupledDrives
    runs : int
        Number of linearisations.
    seed : int
        Of the random operating points.

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
    unstable, by_difference = (sum(bool(x > bound) for x in largest) for bound in (0, ZERO_RATE))
    return Artefact(runs, unstable, by_difference, float(max(largest)), zero_eigenvalues(literal_jacobian(drives)))
