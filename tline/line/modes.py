"""Modes of coupled conductors: independent waves, each with an impedance and a delay of its own."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tline.errors import InputError

ALIKE = 1e-9  # relative; smaller differences between entries are rounding
SMALLEST_LOSS = 1e-13  # relative to the largest loss of a mode; smaller ones are zero
NONE: Mapping[str, NDArray] = MappingProxyType({})


class MixedModesError(InputError):
    """Losses couple the modes, which are therefore no separate lines."""


class Modes(NamedTuple):
    """Modes of k conductors; voltages v = T u and currents i = T^-T y, so that v·i = u·y."""

    T: NDArray  # (k, k) column by column the voltages of a mode, of unit length, the largest positive
    z0: NDArray  # (k,) u over y of a wave of the mode, ohm
    delay: NDArray  # (k,) from end to end, s
    losses: Mapping[str, NDArray]  # (k,) those asked for by name: resistance per metre, ohm/m, or conductance, S/m

    @property
    def admittance(self) -> NDArray:
        """Characteristic admittance matrix T^-T z0^-1 T^-1, siemens: symmetric."""
        inverse = np.linalg.inv(self.T)
        return inverse.T / self.z0 @ inverse


def modes(
    inductance: ArrayLike,
    capacitance: ArrayLike,
    length: float,
    resistances: Mapping[str, ArrayLike] = NONE,
    conductances: Mapping[str, ArrayLike] = NONE,
) -> Modes:
    """Solve for modes of a uniform line, fastest first, from L, H/m, Maxwell's C, F/m, R, ohm/m and Maxwell's G, S/m.

    Losses must not couple the modes: then each is a lossy line of its own, exactly. This holds for equal conductors
    in a symmetric arrangement, and in a homogeneous insulation (L C = 1/v²) for any resistances.

    References
    ----------
    C. R. Paul: Analysis of Multiconductor Transmission Lines, 2nd ed., Wiley 2008, section 4.4 (lossless lines):
    C v = m L^-1 v, solved as symmetric generalised eigenproblem.
    """
    from scipy.linalg import eigh

    L, C = (_symmetric(inductance, "inductance"), _maxwell(capacitance, "capacitance"))
    for matrix, name in ((L, "inductance"), (C, "capacitance")):
        if np.linalg.eigvalsh(matrix)[0] <= ALIKE * np.abs(matrix).max():
            raise InputError(name, "not positive definite", "energy in every combination of currents or voltages")
    lossy = {name: _symmetric(R, name) for name, R in resistances.items()}
    lossy |= {name: _maxwell(G, name) for name, G in conductances.items()}
    for name, matrix in {"capacitance": C, **lossy}.items():
        if matrix.shape != L.shape:
            raise InputError(name, "not of the size of the other matrix", f"{len(L)} rows", f"{len(matrix)}")
        if np.linalg.eigvalsh(matrix)[0] < -ALIKE * np.abs(matrix).max():
            raise InputError(name, "creates power", "a matrix without negative eigenvalues")
    per_metre = np.abs(L).max() * np.abs(C).max()
    m, v = eigh(C / np.abs(C).max(), np.linalg.inv(L / np.abs(L).max()))  # v' L^-1 v = 1, v' C v = m
    inverse = np.linalg.inv(v)
    seen = {name: inverse @ lossy[name] @ inverse.T for name in resistances}
    seen |= {name: v.T @ lossy[name] @ v for name in conductances}
    axes = _shared_axes([np.diag(m), *seen.values()])
    m, v = axes.T**2 @ m, v @ axes
    size = np.linalg.norm(v, axis=0)
    signs = np.sign(np.take_along_axis(v, np.abs(v).argmax(axis=0)[None], axis=0))
    z0 = size**2 / np.sqrt(m) * np.sqrt(np.abs(L).max() / np.abs(C).max())
    losses = {name: _apart(axes.T @ matrix @ axes, name) for name, matrix in seen.items()}
    losses = {name: loss * size**2 if name in resistances else loss / size**2 for name, loss in losses.items()}
    return Modes(v / size * signs, z0, length * np.sqrt(m * per_metre), losses)


def even_and_odd(even: tuple[float, float], odd: tuple[float, float]) -> Modes:
    """Modes of two equal conductors, from z0 in ohm and delay in s of each."""
    T = np.array([[1.0, 1.0], [1.0, -1.0]]) / np.sqrt(2)
    z0, delay = np.array([even, odd]).T
    return Modes(T, z0, delay, {})


def _shared_axes(matrices: Sequence[NDArray]) -> NDArray:
    """Orthogonal axes of symmetric matrices, those of the first, and where these are free those of the next."""
    axes = np.eye(len(matrices[0]))
    free = [np.arange(len(axes))]
    for matrix in matrices:
        left = []
        for block in free:
            values, turn = np.linalg.eigh(axes[:, block].T @ matrix @ axes[:, block])
            axes[:, block] = axes[:, block] @ turn
            left += np.split(block, np.flatnonzero(np.diff(values) > ALIKE * np.abs(matrix).max()) + 1)
        free = left
    return axes


def _apart(matrix: NDArray, name: str) -> NDArray:
    """Diagonal of a loss, in units in which L is 1; its other entries must be zero."""
    diagonal = np.diag(matrix)
    largest, beside = np.abs(matrix).max(), np.abs(matrix - np.diag(diagonal)).max()
    if beside > ALIKE * largest:
        problem = f"couples the modes of inductance and capacitance by {beside / largest:.2g} of its largest entry"
        expected = f"at most {ALIKE:g}, as of conductors alike, or of any where L C = 1/v² to all digits"
        raise MixedModesError(name, problem, expected)
    return np.where(diagonal > SMALLEST_LOSS * largest, diagonal, 0.0)


def _maxwell(matrix: ArrayLike, name: str) -> NDArray:
    given = _symmetric(matrix, name)
    if (given - np.diag(np.diag(given)) > 0).any():
        expected = f"Maxwell's matrix: minus the {name} between two conductors"
        raise InputError(name, "positive beside its diagonal", expected)
    return given


def _symmetric(matrix: ArrayLike, name: str) -> NDArray:
    try:
        given = np.array(matrix, float)
    except ValueError:
        raise InputError(name, "not a square matrix", "rows of one length") from None
    if given.ndim != 2 or given.shape[0] != given.shape[1]:
        raise InputError(name, "not a square matrix", "as many rows as columns", " x ".join(map(str, given.shape)))
    if not np.isfinite(given).all() or (np.abs(given - given.T) > ALIKE * np.abs(given).max()).any():
        raise InputError(name, "not symmetric", "the same entry on both sides of the diagonal")
    return (given + given.T) / 2
