"""Modes of coupled conductors: waves that keep their shape, each with a delay of its own."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tline.errors import InputError

ALIKE = 1e-9  # relative; entries that differ by less are the same


class Modes(NamedTuple):
    """k modes of k conductors; voltages v = T u and currents i = T^-T y, so that v·i = u·y.

    Attributes
    ----------
    T : ndarray, shape (k, k)
        Column by column the voltages of a mode, of unit length, the largest positive.
    z0 : ndarray, shape (k,)
        u over y of a wave of the mode, ohm.
    delay : ndarray, shape (k,)
        From end to end, s.
    """

    T: NDArray
    z0: NDArray
    delay: NDArray

    @property
    def admittance(self) -> NDArray:
        """Characteristic admittance matrix T^-T z0^-1 T^-1, siemens: symmetric."""
        inverse = np.linalg.inv(self.T)
        return inverse.T / self.z0 @ inverse


def modes(inductance: ArrayLike, capacitance: ArrayLike, length: float) -> Modes:
    """Modes of a uniform lossless line, fastest first.

    Parameters
    ----------
    inductance, capacitance : array_like, shape (k, k)
        L in H/m and Maxwell's C in F/m, symmetric and positive definite.
    length : float
        In m.

    Raises
    ------
    InputError
        A matrix is not square, symmetric or positive definite, or their sizes differ; or C has positive entries beside
        its diagonal.

    References
    ----------
    C. R. Paul: Analysis of Multiconductor Transmission Lines, 2nd ed., Wiley 2008, section 4.4 (lossless lines):
    C v = m L^-1 v, solved as symmetric generalised eigenproblem.

    Examples
    --------
    >>> pair = modes([[3e-7, 1e-7], [1e-7, 3e-7]], [[1e-10, -2e-11], [-2e-11, 1e-10]], 1.0)
    >>> pair.z0.round(3).tolist()  # odd: sqrt(2e-7/1.2e-10), even: sqrt(4e-7/0.8e-10)
    [40.825, 70.711]
    """
    from scipy.linalg import eigh

    L, C = _checked(inductance, "inductance"), _checked(capacitance, "capacitance")
    if L.shape != C.shape:
        raise InputError("capacitance", "not of the size of the other matrix", f"{len(L)} rows", f"{len(C)}")
    if (C - np.diag(np.diag(C)) > 0).any():
        problem = "positive beside its diagonal"
        raise InputError("capacitance", problem, "Maxwell's matrix: minus the capacitance between two conductors")
    per_metre = np.abs(L).max() * np.abs(C).max()
    m, v = eigh(C / np.abs(C).max(), np.linalg.inv(L / np.abs(L).max()))  # v' L^-1 v = 1, v' C v = m
    size = np.linalg.norm(v, axis=0)
    signs = np.sign(np.take_along_axis(v, np.abs(v).argmax(axis=0)[None], axis=0))
    z0 = size**2 / np.sqrt(m) * np.sqrt(np.abs(L).max() / np.abs(C).max())
    return Modes(v / size * signs, z0, length * np.sqrt(m * per_metre))


def even_and_odd(even: tuple[float, float], odd: tuple[float, float]) -> Modes:
    """Modes of two conductors alike, from z0 in ohm and delay in s of each."""
    T = np.array([[1.0, 1.0], [1.0, -1.0]]) / np.sqrt(2)
    return Modes(T, *np.array([even, odd]).T)


def _checked(matrix: ArrayLike, name: str) -> NDArray:
    try:
        given = np.array(matrix, float)
    except ValueError:
        raise InputError(name, "not a square matrix", "rows of one length") from None
    if given.ndim != 2 or given.shape[0] != given.shape[1]:
        raise InputError(name, "not a square matrix", "as many rows as columns", " x ".join(map(str, given.shape)))
    if not np.isfinite(given).all() or (np.abs(given - given.T) > ALIKE * np.abs(given).max()).any():
        raise InputError(name, "not symmetric", "the same entry on both sides of the diagonal")
    if np.linalg.eigvalsh(given)[0] <= ALIKE * np.abs(given).max():
        raise InputError(name, "not positive definite", "energy in every combination of currents or voltages")
    return (given + given.T) / 2
