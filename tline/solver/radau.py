"""Polynomials on a slab, held as their values at the right-Radau points, and the matrices that act on them.

A slab is [0, 1] in its own time. Values at the points are turned by constant matrices into: values elsewhere,
the restriction to a part of the slab, the L2 projection of a polynomial known on a part, and the L2 projection of a
delayed wave. The Radau IIA matrix integrates loads on the same points.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from math import prod

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

Matrix = NDArray
LEAST_PLACES = 8  # of `chebyshev`
ALONE = 250_000  # multiplications for which BLAS takes no threads


@dataclass(frozen=True, eq=False)
class Basis:
    """Polynomials of degree s - 1 on [0, 1].

    References
    ----------
    Hairer, Wanner: Solving Ordinary Differential Equations II (1996), section IV.5.
    """

    s: int  # number of points, the order
    c: Matrix  # (s,) right-Radau points; the last is 1
    A: Matrix  # (s, s) Radau IIA matrix: integrals of the cardinal polynomials from 0 to each point
    to_points: Matrix  # (s, s) from Legendre coefficients to values at the points
    to_legendre: Matrix  # (s, s) back

    def evaluation(self, x) -> Matrix:
        """Matrix from values at the points to values at x, shape (len(x), s)."""
        return thin_product(self._legendre(x), self.to_legendre)

    def values(self, x: NDArray, polynomials: NDArray) -> NDArray:
        """Values of polynomials, each given at the points, shape (n, s), at places of its own, shape (n, places)."""
        series = thin_product(polynomials, self.to_legendre.T).T[:, :, None]
        return legendre.legval(2 * x - 1, series, tensor=False)

    @cached_property
    def to_powers(self) -> Matrix:
        """Matrix from values at the points to coefficients of powers of 2 x - 1."""
        series = np.zeros((self.s, self.s))
        for k in range(self.s):
            series[: k + 1, k] = legendre.leg2poly(np.eye(self.s)[k, : k + 1])
        return series @ self.to_legendre

    @cached_property
    def begin(self) -> Matrix:
        """From values at the points to that at the begin of the slab, shape (s,)."""
        return self.evaluation([0.0])[0]

    def restriction(self, start: float, end: float) -> Matrix:
        """Matrix to the values, at the Radau points of the part [start, end], of the same polynomial."""
        return self.evaluation(start + (end - start) * self.c)

    def moments(self, x, weights) -> Matrix:
        """Matrix from values at the quadrature nodes x to the projection's values at the points, shape (s, len(x))."""
        test = (self._legendre(x) * (2 * np.arange(self.s) + 1)).T
        return self.to_points @ (test * weights)

    def projection(self, start: float, end: float) -> Matrix:
        """Matrix of the L2 projection of a function that is a polynomial on [start, end] and zero elsewhere.

        It takes the polynomial's values at the Radau points of [start, end].
        """
        x, weights = gauss(self.s)
        return self.moments(start + (end - start) * x, (end - start) * weights) @ self.evaluation(x)

    def shift(self, f: float) -> tuple[Matrix, Matrix]:
        """Matrices (now, before) of a wave delayed by a fraction f of a slab, 0 < f < 1, and L2-projected.

        The delayed wave on a slab is ``now @ values + before @ previous_values``. Neither the delay nor the projection
        adds energy, for any f and s.
        """
        now = self.projection(f, 1.0) @ self.restriction(0.0, 1.0 - f)
        before = self.projection(0.0, f) @ self.restriction(1.0 - f, 1.0)
        return now, before

    def _legendre(self, x) -> Matrix:
        return legendre.legvander(2 * np.asarray(x, float) - 1, self.s - 1)


def thin_product(rows: NDArray, matrix: NDArray) -> NDArray:
    """Product of many short rows, (..., n, s), with small matrices (..., s, m) or a vector, without threads.

    Threads of BLAS would wait for each other ten times as long as the product takes.
    """
    each = matrix.shape[-2:]
    real = 4 if np.iscomplexobj(matrix) else 1  # multiplications in one
    if (parts := 1 + real * rows.shape[-2] * prod(each) // ALONE) == 1:
        return rows @ matrix
    return np.concatenate([part @ matrix for part in np.array_split(rows, parts, axis=-2)], axis=-len(each))


@lru_cache
def gauss(n: int) -> tuple[Matrix, Matrix]:
    """Gauss-Legendre nodes and weights on [0, 1], exact to degree 2n - 1."""
    x, weights = legendre.leggauss(n)
    return (x + 1) / 2, weights / 2


@lru_cache
def basis(s: int) -> Basis:
    """The basis of order s, 1 <= s <= 16.

    Examples
    --------
    >>> basis(2).c.round(4).tolist()
    [0.3333, 1.0]
    """
    difference = np.zeros(s + 1)  # the right-Radau points are the roots of P_s - P_(s-1)
    difference[s], difference[s - 1] = 1.0, -1.0
    x = np.sort(legendre.legroots(difference).real)
    for _ in range(3):
        x -= legendre.legval(x, difference) / legendre.legval(x, legendre.legder(difference))
    x[-1] = 1.0
    to_points = np.ascontiguousarray(legendre.legvander(x, s - 1))  # one layout, so that the kernel compiles once
    integrals = np.stack([legendre.legval(x, legendre.legint(row, lbnd=-1)) / 2 for row in np.eye(s)], axis=1)
    to_legendre = np.linalg.inv(to_points)
    return Basis(s, (x + 1) / 2, integrals @ to_legendre, to_points, to_legendre)


@lru_cache
def chebyshev(order: int) -> tuple[float, ...]:
    """Places in a slab, denser toward its edges: 0 among them, 1 not, for that is the slab's end."""
    n = max(LEAST_PLACES, order + 2)
    return tuple(((1 - np.cos(np.pi * np.arange(n) / n)) / 2).tolist())
