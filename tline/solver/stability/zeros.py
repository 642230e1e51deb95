"""Zeros of an analytic function in a rectangle, counted by the argument principle, and the rightmost of them found.

The function is known by its logarithm (the imaginary part up to multiples of 2 pi), so it may be far larger or smaller
than floats are. The counts are as good as the sampling of the boundary, which is refined until no step turns by more
than TURN: reliable, not certified.

The characteristic function of a scene: its zeros are the exponents s of waves exp(st) that sustain themselves.
"""

import heapq
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.description import Description
from tline.solver.description.given import Ports
from tline.solver.stability.scattering import CHUNK, Scattering

Log = Callable[[NDArray], NDArray]
TURN = 1.0  # largest change of phase (rad) and of log magnitude between two samples
PARTS = np.array([0.25, 0.5, 0.75])  # positions of refining samples between two
MOST_SAMPLES = 400_000
SAME_ZERO = 1e-9  # relative to the first rectangle; zeros nearer to each other count as one


class UncountableError(ArithmeticError):
    """A zero lies on the boundary, or the boundary needs more than MOST_SAMPLES samples."""


class Box(NamedTuple):
    """A rectangle of the s plane."""

    left: float
    right: float
    low: float
    high: float

    def halves(self, aspect: float) -> tuple["Box", "Box"]:
        """Two parts, cut across the longer side, a little off the middle: zeros like to lie on symmetry lines."""
        left, right, low, high = self
        if (right - left) * aspect >= high - low:
            cut = left + 0.4871 * (right - left)
            return Box(cut, right, low, high), Box(left, cut, low, high)
        cut = low + 0.4871 * (high - low)
        return Box(left, right, low, cut), Box(left, right, cut, high)

    @property
    def middle(self) -> complex:
        """Centre of the rectangle."""
        return complex(self.left + self.right, self.low + self.high) / 2


def count(log: Log, box: Box, step: float) -> int:
    """Number of zeros in a rectangle, multiple ones counted as often.

    Parameters
    ----------
    log : callable
        Logarithm of the function at an array of points.
    box : Box
    step : float
        Distance of samples on the boundary, before refinement.

    Raises
    ------
    UncountableError
    """
    left, right, low, high = box
    corners = np.array([complex(left, low), complex(right, low), complex(right, high), complex(left, high)])
    sides = np.roll(corners, -1) - corners
    if (np.abs(sides) > step * MOST_SAMPLES).any():
        raise UncountableError
    places = [np.linspace(0.0, 1.0, int(length / step) + 8, endpoint=False) for length in np.abs(sides)]
    points = [corner + t * side for corner, side, t in zip(corners, sides, places, strict=True)]
    return round(_turned(log, np.concatenate([*points, corners[:1]])) / (2 * np.pi))


def _turned(log: Log, s: NDArray) -> float:
    """Return the change of the argument along the polygon through the points s."""
    values = log(s)
    while True:
        rise = values[1:] - values[:-1]
        turn = (np.imag(rise) + np.pi) % (2 * np.pi) - np.pi
        coarse = np.flatnonzero((np.abs(turn) > TURN) | (np.abs(np.real(rise)) > TURN))
        if not len(coarse):
            return float(turn.sum())
        between = (s[coarse, None] + PARTS * (s[coarse + 1] - s[coarse])[:, None]).ravel()
        after = np.repeat(coarse + 1, len(PARTS))
        if len(s) + len(between) > MOST_SAMPLES or (between == s[after - 1]).any() or not np.isfinite(values).all():
            raise UncountableError
        s, values = np.insert(s, after, between), np.insert(values, after, log(between))


def zeros(log: Log, box: Box, step: float, rightmost: bool = False) -> list[complex]:
    """Zeros in a rectangle, multiple ones once, in no order; or only the one of the largest real part."""
    aspect = (box.high - box.low) / (box.right - box.left)
    waiting, found = [(-box.right, abs(box.low), box, count(log, box, step))], []
    while waiting:
        *_, part, number = heapq.heappop(waiting)
        if number == 0:
            continue
        if rightmost and found and part.right <= found[0].real:
            break
        small = part.right - part.left < SAME_ZERO * (box.right - box.left)
        zero = part.middle if small else _polished(log, part) if number == 1 else None
        if zero is None:
            for half in part.halves(aspect):
                heapq.heappush(waiting, (-half.right, abs(half.low), half, count(log, half, step)))
        elif rightmost:
            found = [max([zero, *found], key=lambda zero: zero.real)]
        else:
            found.append(zero)
    return found


def _polished(log: Log, box: Box) -> complex | None:
    """The zero in a rectangle that holds one, by the secant method; None where that leaves it."""
    start = box.middle
    size = max(box.right - box.left, box.high - box.low)
    (origin,) = log(np.array([start]))

    def relative(s: complex) -> complex:
        return complex(np.exp(log(np.array([s]))[0] - origin))

    a, b = start + 0.01 * size, start
    fa, fb = relative(a), 1.0 + 0.0j
    for _ in range(60):
        if fb == fa:
            return None
        a, fa, b = b, fb, b - fb * (b - a) / (fb - fa)
        if not (box.left <= b.real <= box.right and box.low <= b.imag <= box.high):
            return None
        if abs(b - a) <= 4e-15 * abs(b) + 1e-300:
            return b
        fb = relative(b)
    return None


class Characteristic(Scattering):
    """D(s) = det(I - P S) times the product of all f: without poles; see `scattering` for the names.

    For nodes that branches join, the determinants of their balance and of the branches' s - Q replace the f.
    """

    def _check(self, description: Description) -> None:
        super()._check(description)
        description.refuse_coupled("a growth rate")

    @property
    def corner(self) -> float:
        """Modulus of s beyond which loads behave as at infinity: that of the largest root of all p, q and f.

        Of branches, that of the largest root of their Q, and of the determinants of M u and N i alone.
        """
        roots = [
            np.roots(side)
            for (p, f), total in zip(self.loads, self.totals, strict=True)
            for side in (p, f, np.polysub(f, p * total))
        ]
        for _, branches in self.groups:
            roots += [each * self.second for branch in branches for each in _roots(branch.ports)]
        return float(max((np.abs(r).max() for r in roots if len(r)), default=0.0))

    def log(self, s: NDArray) -> NDArray:
        """Logarithm of D, its imaginary part up to multiples of 2 pi; s and result of shape (n,)."""
        return np.concatenate([self._log(part) for part in np.array_split(s, int(len(s) * self.size**2 / CHUNK) + 1)])

    def _log(self, s: NDArray) -> NDArray:
        balances = list(self.balances(s))
        total = _log_det(np.eye(self.size) - self.sent_back(self.passage(s), self.answered(balances)))
        for (_, branches), (_, _, matrix) in zip(self.groups, balances, strict=True):
            total = total + _log_det(matrix)
            for branch in branches:
                Q = branch.ports.Q * self.second
                total = total + _log_det(s[:, None, None] * np.eye(len(Q)) - Q)
        return total


def _log_det(matrices: NDArray) -> NDArray:
    sign, size = np.linalg.slogdet(matrices)
    return size + np.log(sign.astype(complex))


def _roots(ports: Ports) -> list[NDArray]:
    """Roots of det(s - Q) and of the determinants of M + E(s - Q)⁻¹P and N + E(s - Q)⁻¹R, in 1/s."""
    found: list[NDArray] = [np.linalg.eigvals(ports.Q)]
    for matrix, driven in ((ports.M, ports.P), (ports.N, ports.R)):
        if np.linalg.matrix_rank(matrix) == len(matrix):
            found.append(np.linalg.eigvals(ports.Q + driven @ np.linalg.solve(matrix, ports.E)))
    return found
