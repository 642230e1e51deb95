"""Rational models of several ports with common poles."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from passivity.errors import ExpressionError
from passivity.sampled.fit import up_to
from passivity.sampled.model import PoleResidueModel
from passivity.sampled.poles import coefficients, count, poles_of
from passivity.sampled.response import MAX_SAMPLES, Parameter, SampledResponse


@dataclass(frozen=True, eq=False)
class MatrixModel:
    """S(s) = D + sum of R/(s - a), where each a with Im a > 0 stands for itself and its conjugate, with R and conj R.

    Parameters
    ----------
    poles : ndarray of complex, shape (m,)
        a, rad/s, Im a >= 0.
    residues : ndarray of complex, shape (m, p, p)
        R, real where the pole is.
    constant : ndarray, shape (p, p)
        D.

    Examples
    --------
    >>> model = MatrixModel(np.array([-2.0]), np.array([[[1, 2], [3, 4]]]), np.zeros((2, 2)))
    >>> model.at(np.zeros(1))[0].real.tolist()
    [[0.5, 1.0], [1.5, 2.0]]
    """

    poles: NDArray[np.complex128]
    residues: NDArray[np.complex128]
    constant: NDArray[np.float64]

    @property
    def order(self) -> int:
        """Number of poles, both of a pair counted."""
        return count(self.poles)

    def at(self, w: NDArray) -> NDArray[np.complex128]:
        """Values at s = jw, shape (n, p, p); w in rad/s, shape (n,)."""
        s, a = 1j * w[:, None], self.poles
        mirrored = np.where(a.imag > 0, 1 / (s - a.conj()), 0.0)
        return (
            self.constant
            + np.tensordot(1 / (s - a), self.residues, 1)
            + np.tensordot(mirrored, self.residues.conj(), 1)
        )

    def entry(self, i: int, k: int) -> PoleResidueModel:
        """What goes from port k to port i."""
        return PoleResidueModel(self.poles, self.residues[:, i, k], self.constant[i, k], 0.0, Parameter.S)

    @classmethod
    def of_coefficients(cls, poles: NDArray[np.complex128], x: NDArray) -> Self:
        """From the real numbers by which `terms` are multiplied, shape (order + 1, p, p), the constant last."""
        residues, k = np.zeros((len(poles), *x.shape[1:]), complex), 0
        for i, a in enumerate(poles):
            residues[i] = x[k] + (1j * x[k + 1] if a.imag > 0 else 0.0)
            k += 1 + (a.imag > 0)
        return cls(poles, residues, x[-1])

    @property
    def coefficients(self) -> NDArray:
        """What `of_coefficients` takes."""
        parts = [
            part
            for a, R in zip(self.poles, self.residues, strict=True)
            for part in ([R.real, R.imag][: 1 + (a.imag > 0)])
        ]
        return np.array([*parts, self.constant])

    def over(self, size: float) -> Self:
        """S/size, rounded."""
        return type(self)(self.poles, self.residues / size, self.constant / size)

    def realised(self) -> tuple[NDArray, NDArray, NDArray, NDArray]:
        """A, B, C, D of dx/dt = A x + B a, b = C x + D a: for each pole one state a port, for each pair two.

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


def fit_matrix(response: SampledResponse, order: int) -> MatrixModel:
    """A model of S with so many poles in Re s < 0, common to all entries, not necessarily passive.

    Parameters
    ----------
    response : SampledResponse
        S, at most MAX_SAMPLES.
    order : int
        Number of poles, both of a pair counted, from 0 to n - 2.

    Raises
    ------
    ExpressionError
        If there are too many samples, or too few for the order, or all are at f = 0.

    Examples
    --------
    >>> f = np.linspace(0, 1, 30)
    >>> S = np.array([[0.5, 0.2], [0.3, 0.1]]) / (1 + 2j * np.pi * f)[:, None, None]
    >>> fit_matrix(SampledResponse(f, S, "S"), 1).poles.round(9)
    array([-1.+0.j])
    """
    *_, model = matrix_fits(response, up_to(order))
    return model


def matrix_fits(response: SampledResponse, orders: Iterable[int]) -> Iterator[MatrixModel]:
    """Models of S of rising orders, each beginning where the one before ended; see `fit_matrix`."""
    n, p, orders = len(response.f), response.ports, tuple(orders)
    if not orders[-1] + 2 <= n <= MAX_SAMPLES or not response.f[-1]:
        expected = f"{orders[-1] + 2} to {MAX_SAMPLES}, not all at f = 0"
        raise ExpressionError("samples", f"cannot be fitted with {orders[-1]} poles", expected, f"{n}")
    unit, size = 2 * np.pi * response.f[-1], float(np.abs(response.values).max()) or 1.0
    w, h = 2 * np.pi * response.f / unit, response.values.reshape(n, -1) / size
    reciprocal = (response.values == response.values.swapaxes(1, 2)).all()
    distinct = np.flatnonzero(np.triu(np.ones((p, p)))) if reciprocal else slice(None)
    for poles in poles_of(w, h[:, distinct], orders):
        x = coefficients(poles, w, h) * size
        x[:-1] *= unit
        yield MatrixModel.of_coefficients(poles * unit, x.reshape(-1, p, p))
