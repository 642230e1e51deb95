"""Rational models as sums of partial fractions, of one port and of several with common poles, and the same exactly."""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from passivity.errors import ExpressionError
from passivity.rational.function import RationalFunction
from passivity.rational.matrix import RationalMatrix
from passivity.sampled.response import Parameter, array
from tline.presentation import Presentation, plain

MAX_POLES = 100  # each pair counted once


class PartialFractions(Presentation):
    """d + e s + sum of r/(s - a), where each a with Im a > 0 stands for itself and its conjugate, with r and conj r."""

    poles: Any
    residues: Any
    constant: Any
    proportional: Any
    parameter: Any
    picture = "passivity.sampled.report:draw_model"

    def text_lines(self) -> Iterator[str]:
        """What it is of, and its poles."""
        ports = len(np.atleast_1d(self.constant))
        yield f"{self.parameter.value} of {ports} port{'s' * (ports > 1)}, {self.order} poles, rad/s"
        for a in self.poles:
            yield f"  {a.real:.6g}" + (f" ± {a.imag:.6g}j" if a.imag else "")

    def to_dict(self) -> dict[str, Any]:
        """Real and imaginary part of each pole and residue; of several ports residues and the rest are matrices."""
        return plain({name: getattr(self, name) for name in ("poles", "residues", "constant", "proportional")})

    @property
    def order(self) -> int:
        """Number of poles, both of a pair counted."""
        return count(self.poles)

    @property
    def coefficients(self) -> NDArray:
        """The real numbers by which `terms` are multiplied, each of the shape of the constant."""
        parts = [
            part
            for a, r in zip(self.poles, self.residues, strict=True)
            for part in ([r.real, r.imag][: 1 + (a.imag > 0)])
        ]
        return np.array([*parts, self.constant, self.proportional])

    def with_coefficients(self, x: NDArray) -> Self:
        """The model with the same poles and other coefficients."""
        residues, k = np.zeros((len(self.poles), *x.shape[1:]), complex), 0
        for i, a in enumerate(self.poles):
            residues[i] = x[k] + (1j * x[k + 1] if a.imag > 0 else 0.0)
            k += 1 + (a.imag > 0)
        return type(self)(self.poles, residues, x[k], x[k + 1], self.parameter)  # pyright: ignore[reportCallIssue]

    def over(self, size: float) -> Self:
        """S/size, rounded."""
        return self.with_coefficients(self.coefficients / size)

    def moved_inside(self, by: float) -> Self:
        """S/(1 + by), or Z + by: less beyond the bound by so much."""
        if self.parameter is Parameter.S:
            return self.over(1 + by)
        x = self.coefficients
        x[-2] += by * np.eye(len(np.atleast_1d(self.constant))).reshape(x.shape[1:])
        return self.with_coefficients(x)

    def at(self, w: NDArray) -> NDArray[np.complex128]:
        """Values at s = jw; w in rad/s, shape (n,)."""
        return np.tensordot(terms(self.poles, w), self.coefficients, 1)

    def matrices(self, w: NDArray) -> NDArray[np.complex128]:
        """The same with shape (n, p, p), of one port too."""
        p = len(np.atleast_1d(self.constant))
        return self.at(w).reshape(-1, p, p)


@dataclass(frozen=True, eq=False, repr=False)
class PoleResidueModel(PartialFractions):
    """A function d + e s + sum of r/(s - a), each a with Im a > 0 standing for its conjugate too, with r and conj r.

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
            expected = "of each pair the pole with Im > 0"
            raise ExpressionError(f"poles[{k}]", "below the real axis", expected, f"{a[k]:.6g}")
        for k in np.flatnonzero((a.imag == 0) & (r.imag != 0)):
            raise ExpressionError(f"residues[{k}]", "not real at a real pole", "a real number", f"{r[k]:.6g}")

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


@dataclass(frozen=True, eq=False, repr=False)
class MatrixModel(PartialFractions):
    """A matrix D + E s + sum of R/(s - a) with common poles, each a with Im a > 0 standing for its conjugate too.

    Parameters
    ----------
    poles : ndarray of complex, shape (m,)
        a, rad/s, Im a >= 0.
    residues : ndarray of complex, shape (m, p, p)
        R, real where the pole is.
    constant : ndarray, shape (p, p)
        D.
    proportional : ndarray, shape (p, p), or 0
        E.
    parameter : Parameter or str
        Z, Y or S: what the matrix is.

    Examples
    --------
    >>> model = MatrixModel(np.array([-2.0]), np.array([[[1, 2], [3, 4]]]), np.zeros((2, 2)))
    >>> model.at(np.zeros(1))[0].real.tolist()
    [[0.5, 1.0], [1.5, 2.0]]
    """

    poles: NDArray[np.complex128]
    residues: NDArray[np.complex128]
    constant: NDArray[np.float64]
    proportional: Any = 0.0
    parameter: Any = Parameter.S

    def __post_init__(self):
        object.__setattr__(self, "parameter", Parameter(self.parameter))
        object.__setattr__(self, "proportional", np.zeros_like(self.constant) + self.proportional)

    def entry(self, i: int, k: int) -> PoleResidueModel:
        """What goes from port k to port i."""
        numbers = self.residues[:, i, k], self.constant[i, k], self.proportional[i, k]
        return PoleResidueModel(self.poles, *numbers, self.parameter)

    def rational(self) -> RationalMatrix:
        """The matrix, its floats taken as the binary numbers they are."""
        ports = range(len(self.constant))
        return RationalMatrix(tuple(tuple(self.entry(i, k).rational() for k in ports) for i in ports))

    def realised(self) -> tuple[NDArray, NDArray, NDArray, NDArray]:
        """A, B, C, D of dx/dt = A x + B a, b = C x + D a, without E: for each pole one state a port, for each pair two.

        Examples
        --------
        >>> model = MatrixModel(np.array([-1 + 2j]), np.array([[[4 + 8j]]]), np.zeros((1, 1)))
        >>> A, B, C, D = model.realised()
        >>> (D + C @ np.linalg.solve(3j * np.eye(2) - A, B)).round(12) == model.at(np.array([3.0]))[0].round(12)
        array([[ True]])
        """
        from scipy.linalg import block_diag

        p, (parts, inputs, outputs) = len(self.constant), ([], [], [])
        one, none = np.eye(p), np.zeros((p, p))
        for a, R in zip(self.poles, self.residues, strict=True):
            size = 2.0 ** np.round(np.log2(np.linalg.norm(R)) / 2) if R.any() else 1.0  # nothing is rounded
            if a.imag > 0:
                parts.append(np.kron([[a.real, a.imag], [-a.imag, a.real]], one))
                inputs += [2 * size * one, none]
                outputs += [R.real / size, R.imag / size]
            else:
                parts.append(a.real * one)
                inputs.append(size * one)
                outputs.append(R.real / size)
        A = np.asarray(block_diag(*parts)) if parts else np.zeros((0, 0))
        return A, np.vstack([np.zeros((0, p)), *inputs]), np.hstack([np.zeros((p, 0)), *outputs]), self.constant


def count(poles: NDArray[np.complex128]) -> int:
    """Number of poles, both of a pair counted."""
    return int((1 + (poles.imag > 0)).sum())


def terms(poles: NDArray, w: NDArray) -> NDArray[np.complex128]:
    """Values at s = jw of 1/(s - a), of j/(s - a) for each pair, of 1 and of s; shape (n, number of coefficients)."""
    s = 1j * w
    columns = []
    for a in poles:
        here, mirrored = 1 / (s - a), 1 / (s - a.conjugate())
        columns += [here + mirrored, 1j * (here - mirrored)] if a.imag > 0 else [here]
    return np.stack([*columns, np.ones_like(s), s], axis=1)
