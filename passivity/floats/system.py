"""A state space in floating point: the Hermitian form that must not be negative, its error, and values on the axis."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple, Self

import numpy as np
from flint import fmpq_mat
from numpy.typing import NDArray

from passivity.rational.state_space import StateSpace
from passivity.status import Kind

if TYPE_CHECKING:
    from passivity.floats.axis import AxisAnalysis

_EPS = float(np.finfo(float).eps)
_PER_DECADE, _MOST = 8, 200  # frequencies of the first grid
_MINIMA = 6  # of which the lowest are followed
_FARTHEST = 1e30
_ROUNDS, _INSIDE = 12, 12  # in which minima are approached, and points between the neighbours of each
Band = tuple[float, float]


class Place(NamedTuple):
    """The smallest eigenvalue of the form at a frequency, and a bound of its error to first order."""

    value: float
    error: float
    w: float

    @property
    def is_known(self) -> bool:
        """Whether the sign of the value is beyond the error."""
        return abs(self.value) > self.error

    @property
    def is_negative(self) -> bool:
        """Below zero by more than the error."""
        return self.value < -self.error


@dataclass(frozen=True, eq=False)
class FloatSystem:
    """A, B, C, D with balanced states, at least one, and time in units that make A about 1."""

    kind: Kind  # the form F(s) is (Z + Z^H)/2, or I - S^H S
    a: NDArray[np.float64]
    b: NDArray[np.float64]
    c: NDArray[np.float64]
    d: NDArray[np.float64]
    unit: float  # a power of two, by which frequencies of this system are multiplied for the given one
    scale: NDArray[np.float64]  # powers of two, by which the given states are multiplied for those of this system

    @classmethod
    def of(cls, kind: Kind, system: StateSpace) -> Self:
        """The nearest doubles.

        Raises
        ------
        OverflowError
            If entries are too large for doubles.
        """
        from scipy.linalg import matrix_balance

        a, b, c, d = map(floats, (system.a, system.b, system.c, system.d))
        balanced: Any = matrix_balance(np.block([[a, b], [c, d]]), permute=False, separate=True)
        t = balanced[1][0][: len(a)]  # powers of two: nothing is rounded
        a, b, c = a / t[:, None] * t, b / t[:, None], c * t
        with np.errstate(over="ignore", invalid="ignore"):
            unit = power_of_two(np.linalg.norm(a, 2))
            level = power_of_two(np.sqrt(np.linalg.norm(c) / (np.linalg.norm(b) or 1) * unit))
            a, b, c = a / unit, b * (level / unit), c / level
        if not all(np.isfinite(x).all() for x in (a, b, c)):
            raise OverflowError("entries too large to multiply in doubles")
        return cls(kind, a, b, c, d, unit, level / t)

    @cached_property
    def analysis(self) -> "AxisAnalysis":
        """Results of the Hamiltonian test and of samples on the axis."""
        from passivity.floats.axis import analyse

        return analyse(self)

    @cached_property
    def schur(self) -> tuple[Any, Any, Any]:
        """T, U^H B and C U with A = U T U^H."""
        from scipy.linalg import schur

        found: Any = schur(self.a, output="complex")
        t, u = found
        return t, u.conj().T @ self.b, self.c @ u

    @cached_property
    def poles(self) -> NDArray[np.complex128]:
        """Eigenvalues of A, of conjugate ones the upper."""
        found: Any = np.linalg.eigvals(self.a)
        return found[found.imag >= 0]

    @cached_property
    def popov(self) -> tuple[Any, Any, Any]:
        """Q, S, R with F = R + S^T X + X^H S + X^H Q X on the axis, where X = (sI - A)^-1 B."""
        if self.kind is Kind.PR:
            return np.zeros_like(self.a), self.c.T / 2, (self.d + self.d.T) / 2
        return -self.c.T @ self.c, -self.c.T @ self.d, np.eye(len(self.d)) - self.d.T @ self.d

    def at(self, *points: complex) -> list[Place]:
        """The form at some points, with an infinite error where that is a pole.

        With X and Y near (sI - A)^-1 B and (sI - A)^-H C^T, the error of C X is Y^H (B - (sI - A) X) to first order. To
        the residual are added n roundings of |A| + |s|, |A| being about 1: those of A, B and C, and of Schur's form.
        """
        t, b, c = self.schur
        n, s = len(t), np.array(points, np.complex128)
        with np.errstate(all="ignore"):
            x = _upper(t, s, b)
            y = _upper(t.conj().T[::-1, ::-1], s.conj(), c.conj().T[::-1])
            rest = np.linalg.norm(b[..., None] - s * x + np.tensordot(t, x, 1), axis=(0, 1))
            rest += n * _EPS * (1 + abs(s)) * np.linalg.norm(x, axis=(0, 1))
            z = np.moveaxis(self.d[..., None] + np.tensordot(c, x, 1), 2, 0)
            error = np.linalg.norm(y, axis=(0, 1)) * rest + _EPS * np.linalg.norm(z, axis=(1, 2))
        return [self._place(*given) for given in zip(z, error.tolist(), s.imag.tolist(), strict=True)]

    def on_axis(self, *frequencies: float) -> list[Place]:
        """The form at jw, or its limit."""
        limit = self._place(self.d, _EPS * float(np.linalg.norm(self.d)), np.inf)
        finite = iter(self.at(*(1j * w for w in frequencies if np.isfinite(w))))
        return [next(finite) if np.isfinite(w) else limit for w in frequencies]

    def _place(self, z: NDArray, error: float, w: float) -> Place:
        if not np.isfinite(z).all() or not np.isfinite(error):
            return Place(0.0, np.inf, w)
        if self.kind is Kind.PR:
            return Place(float(np.linalg.eigvalsh((z + z.conj().T) / 2)[0]), error, w)
        size = float(np.linalg.norm(z, 2))
        return Place((1 - size) * (1 + size), (2 * size + error) * error + _EPS, w)


def _upper(t: NDArray, s: NDArray, b: NDArray) -> NDArray:
    """(sI - T)^-1 B for all s at once, T upper triangular: for matrices of this size faster than one after another."""
    rest = np.repeat(b[..., None].astype(complex), len(s), axis=2)
    for k in reversed(range(len(t))):
        rest[k] /= s - t[k, k]
        rest[:k] += t[:k, k, None, None] * rest[k]
    return rest


def floats(given: fmpq_mat) -> NDArray[np.float64]:
    """The nearest doubles."""
    shape = given.nrows(), given.ncols()
    return np.array([int(x.p) / int(x.q) for x in given.entries()]).reshape(shape)


def power_of_two(x: Any) -> float:
    """Return the power of two nearest to a size, 1 for zero."""
    return float(2.0 ** np.round(np.log2(x))) if x else 1.0


def first_grid(system: FloatSystem) -> list[float]:
    """Zero, infinity, frequencies around each pole, and an even grid from far below the poles to far beyond them."""
    poles = system.poles
    sizes = abs(poles)[abs(poles) > 0]
    low, high = (sizes.min() / 100, sizes.max() * 100) if len(sizes) else (0.01, 100.0)
    even = np.geomspace(low, high, min(_MOST, int(_PER_DECADE * np.log10(high / low)) + 2))
    near = np.unique(np.abs([poles.imag, poles.imag - poles.real, poles.imag + poles.real]))
    near = near[:: len(near) // _MOST + 1]
    return [0.0, *np.unique([*even, *near[near > 0]]).tolist(), np.inf]


class Samples:
    """Places on the axis in rising order, ever more of them."""

    def __init__(self, system: FloatSystem):
        self.system = system
        self.places: dict[float, Place] = {}
        self.add(first_grid(system))
        self.follow()

    def add(self, frequencies: Iterable[float]) -> list[Place]:
        """Look at more frequencies."""
        new = self.system.on_axis(*frequencies)
        self.places |= {place.w: place for place in new}
        return new

    @property
    def lowest(self) -> Place:
        """Place with the least upper bound of its value, of those with a finite error."""
        known = [place for place in self.places.values() if np.isfinite(place.error)]
        return min(known, key=lambda place: place.value + place.error)

    def follow(self) -> None:
        """Go down to the lowest of the local minima, closer in each round."""
        for _ in range(_ROUNDS):
            row = self._sorted()
            inner = [x for x in zip(row, row[1:], row[2:], strict=False) if x[1].value <= min(x[0].value, x[2].value)]
            lowest = sorted(inner, key=lambda x: x[1].value)[:_MINIMA]
            ends = [(before.w, min(after.w, 4 * here.w)) for before, here, after in lowest]
            self.add(w for low, high in ends if high - low > 1e-8 * high for w in np.linspace(low, high, _INSIDE)[1:-1])

    def bands(self) -> list[Band]:
        """Where the value is negative, the ends found by bisection; places where its sign is not known do not count."""
        row = [place for place in self._sorted() if place.is_known]
        ends = [0.0] if row and row[0].is_negative else []
        ends += [self._end(x, y) for x, y in pairwise(row) if x.is_negative != y.is_negative]
        if len(ends) % 2:
            ends.append(math.inf)
        return list(zip(ends[::2], ends[1::2], strict=True))

    def _end(self, x: Place, y: Place) -> float:
        """Bisect the end of a band between two places, one of them negative."""
        low, high = x.w, min(y.w, _FARTHEST)
        while high - low > 1e-12 * high:
            middle = (low + high) / 2 if high < 4 * low or low == 0 else math.sqrt(low * high)
            (place,) = self.system.on_axis(middle)
            low, high = (middle, high) if (place.value < 0) == x.is_negative else (low, middle)
        return y.w if high == _FARTHEST else (low + high) / 2

    def _sorted(self) -> list[Place]:
        return [self.places[w] for w in sorted(self.places)]
