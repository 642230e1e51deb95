"""Rational models of one-ports as a sum of partial fractions, and the same functions exactly."""

from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from passivity.errors import ExpressionError
from passivity.rational.function import RationalFunction
from passivity.sampled.response import Parameter, array

MAX_POLES = 100  # each pair counted once


@dataclass(frozen=True, eq=False)
class PoleResidueModel:
    """d + e s + sum of r/(s - a), where each a with Im a > 0 stands for itself and its conjugate, with r and conj r.

    Parameters
    ----------
    poles : array_like of complex, shape (m,)
        a, rad/s, Im a >= 0, m <= MAX_POLES.
    residues : array_like of complex, shape (m,)
        r, real where the pole is.
    constant, proportional : float
        d and e.
    parameter : Parameter or str
        Z, Y or S: what the function is.

    Raises
    ------
    ExpressionError
        Naming the number that does not fit.

    Examples
    --------
    >>> model = PoleResidueModel([-2, -1 + 3j], [4, 1 - 1j], 5, 0, "Z")
    >>> print(model.rational() == RationalFunction.from_expression("5 + 4/(s + 2) + (2*s + 8)/((s + 1)^2 + 9)"))
    True
    """

    poles: Any
    residues: Any
    constant: float
    proportional: float
    parameter: Any

    def __post_init__(self):
        object.__setattr__(self, "parameter", Parameter(self.parameter))
        for name in ("poles", "residues"):
            object.__setattr__(self, name, array(getattr(self, name), complex, name))
        for name in ("constant", "proportional"):
            number = array(getattr(self, name), float, name)
            if number.ndim:
                raise ExpressionError(name, "not a number", "one real number", f"shape {number.shape}")
            object.__setattr__(self, name, float(number))
        a, r = self.poles, self.residues
        if a.ndim != 1 or a.shape != r.shape or len(a) > MAX_POLES:
            expected = f"one residue for each pole, at most {MAX_POLES}"
            raise ExpressionError("residues", "shape", expected, f"{r.shape} for {a.shape}")
        for k in np.flatnonzero(a.imag < 0):
            raise ExpressionError(
                f"poles[{k}]", "below the real axis", "of each pair the pole with Im > 0", f"{a[k]:.6g}"
            )
        for k in np.flatnonzero((a.imag == 0) & (r.imag != 0)):
            raise ExpressionError(f"residues[{k}]", "not real at a real pole", "a real number", f"{r[k]:.6g}")

    @property
    def coefficients(self) -> NDArray:
        """The real numbers by which `terms` are multiplied."""
        parts = [
            part
            for a, r in zip(self.poles, self.residues, strict=True)
            for part in ([r.real, r.imag][: 1 + (a.imag > 0)])
        ]
        return np.array([*parts, self.constant, self.proportional])

    def with_coefficients(self, x: NDArray) -> Self:
        """The model with the same poles and other coefficients."""
        residues, k = np.zeros(len(self.poles), complex), 0
        for i, a in enumerate(self.poles):
            width = 1 + (a.imag > 0)
            residues[i] = complex(*x[k : k + width])
            k += width
        return type(self)(self.poles, residues, x[k], x[k + 1], self.parameter)

    def at(self, w: NDArray) -> NDArray[np.complex128]:
        """Values at s = jw; w in rad/s, shape (n,)."""
        return terms(self.poles, w) @ self.coefficients

    def rational(self) -> RationalFunction:
        """The function, its floats taken as the binary numbers they are."""
        of = RationalFunction.from_coefficients
        total = of([self.proportional, self.constant], [1])
        for a, r in zip(self.poles, self.residues, strict=True):
            alpha, beta, u, v = (Fraction(float(x)) for x in (a.real, a.imag, r.real, r.imag))
            if beta:
                total += of([2 * u, -2 * (u * alpha + v * beta)], [1, -2 * alpha, alpha**2 + beta**2])
            else:
                total += of([u], [1, -alpha])
        return total


def terms(poles: NDArray, w: NDArray) -> NDArray[np.complex128]:
    """Values at s = jw of 1/(s - a), of j/(s - a) for each pair, of 1 and of s; shape (n, number of coefficients).

    Examples
    --------
    >>> terms(np.array([-1.0 + 0j]), np.array([1.0]))
    array([[0.5-0.5j, 1. +0.j , 0. +1.j ]])
    """
    s = 1j * w
    columns = []
    for a in poles:
        here, mirrored = 1 / (s - a), 1 / (s - a.conjugate())
        columns += [here + mirrored, 1j * (here - mirrored)] if a.imag > 0 else [here]
    return np.stack([*columns, np.ones_like(s), s], axis=1)
