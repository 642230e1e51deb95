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

MAX_POLES = 2000  # of one port, both of a pair counted


@dataclass(frozen=True, eq=False, repr=False)
class PoleResidueModel(Presentation):
    """Model d + e s + sum of r/(s - a), in which each a with Im a > 0 includes its conjugate, with r and conj r.

    Of several ports d, e and all r are matrices, with poles in common.

    Parameters
    ----------
    poles : array_like of complex, shape (m,)
        a, rad/s, Im a >= 0; of one port at most MAX_POLES, both of a pair counted.
    residues : array_like of complex, shape (m,) or (m, p, p)
        r, real where the pole is.
    constant, proportional : float or array_like, shape (p, p)
        d and e.
    parameter : Parameter or str
        Z, Y or S: the quantity modelled.

    Raises
    ------
    ExpressionError
        Naming the number that does not fit.

    Examples
    --------
    >>> model = PoleResidueModel([-2, -1 + 3j], [4, 1 - 1j], 5, 0, "Z")
    >>> print(model.rational() == RationalFunction.from_expression("5 + 4/(s + 2) + (2*s + 8)/((s + 1)^2 + 9)"))
    True
    >>> PoleResidueModel([-2], [[[1, 2], [3, 4]]], np.zeros((2, 2))).at(np.zeros(1))[0].real.tolist()
    [[0.5, 1.0], [1.5, 2.0]]
    """

    poles: Any
    residues: Any
    constant: Any
    proportional: Any = 0.0
    parameter: Any = Parameter.S
    picture = "passivity.sampled.picture:draw_model"

    def __post_init__(self):
        object.__setattr__(self, "parameter", Parameter(self.parameter))
        for name, kind in (("poles", complex), ("residues", complex), ("constant", float), ("proportional", float)):
            object.__setattr__(self, name, array(getattr(self, name), kind, name))
        a, r, d = self.poles, self.residues, self.constant
        if d.ndim and (d.ndim != 2 or d.shape[0] != d.shape[1]):
            raise ExpressionError("constant", "no number", "one real number, or a square matrix", f"shape {d.shape}")
        if self.proportional.shape not in ((), d.shape):
            raise ExpressionError(
                "proportional", "shape", f"that of the constant, {d.shape}", f"{self.proportional.shape}"
            )
        if a.ndim != 1 or r.shape != (*a.shape, *d.shape) or (not d.ndim and count(a) > MAX_POLES):
            expected = f"one residue for each pole, at most {MAX_POLES} of one port"
            raise ExpressionError("residues", "shape", expected, f"{r.shape} for {a.shape}")
        for k in np.flatnonzero(a.imag < 0):
            expected = "of each pair the pole with Im > 0"
            raise ExpressionError(f"poles[{k}]", "below the real axis", expected, f"{a[k]:.6g}")
        for k in np.flatnonzero((a.imag == 0) & (r.imag != 0).any(tuple(range(1, r.ndim)))):
            raise ExpressionError(f"residues[{k}]", "not real at a real pole", "real numbers", f"{r[k]}")
        for name, value in (("constant", d), ("proportional", np.zeros_like(d) + self.proportional)):
            object.__setattr__(self, name, value if d.ndim else float(value))

    def text_lines(self) -> Iterator[str]:
        """Parameter, number of ports, and poles, as lines of text."""
        yield f"{self.parameter.value} of {self.ports} port{'s' * (self.ports > 1)}, {self.order} poles, rad/s"
        for a in self.poles:
            yield f"  {a.real:.6g}" + (f" ± {a.imag:.6g}j" if a.imag else "")

    def to_dict(self) -> dict[str, Any]:
        """Real and imaginary part of each pole and residue; of several ports residues and the rest are matrices."""
        return plain({name: getattr(self, name) for name in ("poles", "residues", "constant", "proportional")})

    @property
    def ports(self) -> int:
        """Number of ports."""
        return len(np.atleast_1d(self.constant))

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
        return type(self)(self.poles, residues, x[k], x[k + 1], self.parameter)

    def over(self, size: float) -> Self:
        """S/size, rounded."""
        return self.with_coefficients(self.coefficients / size)

    def moved_inside(self, by: float) -> Self:
        """Return S/(1 + by), or Z + by, farther inside the bound by that amount."""
        if self.parameter is Parameter.S:
            return self.over(1 + by)
        x = self.coefficients
        x[-2] += by * np.eye(self.ports).reshape(x.shape[1:])
        return self.with_coefficients(x)

    def at(self, w: NDArray) -> NDArray[np.complex128]:
        """Values at s = jw; w in rad/s, shape (n,)."""
        return np.tensordot(terms(self.poles, w), self.coefficients, 1)

    def matrices(self, w: NDArray) -> NDArray[np.complex128]:
        """Return the values with shape (n, p, p), of one port too."""
        return self.at(w).reshape(-1, self.ports, self.ports)

    def entry(self, i: int, k: int) -> "PoleResidueModel":
        """Return the transfer from port k to port i."""
        numbers = self.residues[:, i, k], self.constant[i, k], self.proportional[i, k]
        return PoleResidueModel(self.poles, *numbers, self.parameter)

    def rational(self) -> RationalFunction | RationalMatrix:
        """The function or matrix, its floats taken as the binary numbers they are."""
        if not np.ndim(self.constant):
            return self._sum()
        ports = range(self.ports)
        return RationalMatrix(tuple(tuple(self.entry(i, k)._sum() for k in ports) for i in ports))

    def _sum(self) -> RationalFunction:
        of = RationalFunction.from_coefficients
        total = of([self.proportional, self.constant], [1])
        for a, r in zip(self.poles, self.residues, strict=True):
            alpha, beta, u, v = (Fraction(float(x)) for x in (a.real, a.imag, r.real, r.imag))
            if beta:
                total += of([2 * u, -2 * (u * alpha + v * beta)], [1, -2 * alpha, alpha**2 + beta**2])
            else:
                total += of([u], [1, -alpha])
        return total

    def realised(self) -> tuple[NDArray, NDArray, NDArray, NDArray]:
        """A, B, C, D of dx/dt = A x + B a, b = C x + D a, without E.

        For each pole there is one state, for each pair two, for each port, but for those whose column of the residue is
        another's or its opposite.

        Examples
        --------
        >>> model = PoleResidueModel([-1 + 2j], [[[4 + 8j]]], [[0]])
        >>> A, B, C, D = model.realised()
        >>> (D + C @ np.linalg.solve(3j * np.eye(2) - A, B)).round(12) == model.at(np.array([3.0]))[0].round(12)
        array([[ True]])
        """
        from scipy.linalg import block_diag

        p, (parts, inputs, outputs) = self.ports, ([], [], [])
        for a, R in zip(self.poles, self.residues.reshape(-1, p, p), strict=True):
            size = 2.0 ** np.round(np.log2(np.linalg.norm(R)) / 2) if R.any() else 1.0  # nothing is rounded
            alike = (R[:, :, None] == R[:, None]).all(0) * 1.0 - (R[:, :, None] == -R[:, None]).all(0)
            first = np.flatnonzero((alike != 0).argmax(0) == np.arange(p))
            R, of, one = R[:, first], size * alike[first], np.eye(len(first))
            if a.imag > 0:
                parts.append(np.kron([[a.real, a.imag], [-a.imag, a.real]], one))
                inputs += [2 * of, 0 * of]
                outputs += [R.real / size, R.imag / size]
            else:
                parts.append(a.real * one)
                inputs.append(of)
                outputs.append(R.real / size)
        A = np.asarray(block_diag(*parts)) if parts else np.zeros((0, 0))
        return (
            A,
            np.vstack([np.zeros((0, p)), *inputs]),
            np.hstack([np.zeros((p, 0)), *outputs]),
            np.asarray(self.constant),
        )


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
