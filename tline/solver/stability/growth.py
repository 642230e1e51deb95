"""Growth rate of the waves of a scene with active parts: the rightmost zero of its characteristic function.

Zeros in a rectangle are counted by the argument principle. The function is known by its logarithm, so it may be far
larger or smaller than floats are. The counts are as good as the sampling of the boundary, which is refined until no
step turns by more than TURN: reliable, not certified.
"""

import heapq
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.solver.description.description import Description
from tline.solver.stability.scattering import CHUNK, Scattering

NEGLIGIBLE = 1e-3  # relative growth within a run that is ignored
PERIODS = 4  # resonances of the shortest line that the searched band includes at least
OVER_CORNER = 4.0  # highest searched frequency over the highest corner frequency of the loads
ALIKE = 1e-6  # relative difference of growth rates that count as equal
SAMPLES = 4.0  # on the boundary, per radian of phase of all delays together
MOST_WORK = 3e9  # floating-point operations of all determinants, beyond which no search is made
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
    """Number of zeros in a rectangle, multiple ones counted as often."""
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
            for ports in (branch.ports for branch in branches):  # M + E (s - Q)⁻¹ P and N + E (s - Q)⁻¹ R
                roots.append(np.linalg.eigvals(ports.Q) * self.second)
                for matrix, driven in ((ports.M, ports.P), (ports.N, ports.R)):
                    if np.linalg.matrix_rank(matrix) == len(matrix):
                        own = np.linalg.eigvals(ports.Q + driven @ np.linalg.solve(matrix, ports.E))
                        roots.append(own * self.second)
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


@dataclass(frozen=True)
class Growth:
    """Fastest growing wave of a scene."""

    # of the waves exp(st) that grow fastest, the exponent, in 1/s; None if none grows by more than 0.1 % in the run
    s: complex | None
    highest: float  # highest angular frequency searched, rad/s


def growth(description: Description) -> Growth | None:
    """Fastest growing wave of a scene after its last switch has moved, None if it is too large to be searched.

    Zeros of the characteristic function are counted by the argument principle, on samples of the boundary: reliable,
    not certified. Beyond the searched frequencies waves may grow too, but with loads that have settled to constants
    there the same growth rates come again and again.
    """
    D = Characteristic(description)
    high = max(OVER_CORNER * D.corner, 2 * np.pi * PERIODS)
    step = 1 / (SAMPLES * 2 * D.delays.sum())
    if high / step * (2 * len(D.z0)) ** 3 > MOST_WORK:
        return None
    least = NEGLIGIBLE * D.second / description.t_end
    try:
        box = Box(least, right_of_all(D, high, least), -1.37e-4 * high, high)
        s, found = None, zeros(D.log, box, step, rightmost=True)
        while found:  # of waves that grow alike, the slowest to turn
            (s,) = found
            left, top = s.real * (1 - ALIKE), max(s.imag - ALIKE * box.high, box.low + ALIKE * box.high)
            found = zeros(D.log, box._replace(left=left, high=top), step, rightmost=True)
    except UncountableError:
        return None
    return Growth(None if s is None else complex(s.real, abs(s.imag)) / D.second, high / D.second)


def right_of_all(D: Characteristic, high: float, least: float) -> float:
    """Real part to the right of all zeros: the round-trip gain is below 1 there at all frequencies."""
    right = max(D.corner, least, 1.0)
    while True:
        s = right + 1j * np.linspace(0.0, high, 257)
        if np.abs(D.returned(s)).sum(axis=2).max() < 1:
            return right
        right *= 1.5


def growth_sentence(description: Description) -> str:
    """Describe each active part of a scene, and the growth of waves that they cause, in one sentence each."""
    parts = "; ".join(f"{where} {told}" for where, told in description.active.items())
    why = "the scene is too large to search, or its waves lie too close together"
    try:
        found = growth(description)
    except InputError as error:
        found, why = None, f"{error.where} {error.problem}"
    if found is None:
        return f"{parts}; whether the waves grow was not found out: {why}"
    if found.s is None:
        return f"{parts}; yet no wave grows by more than 0.1 % within the run"
    s = complex(found.s)
    turning = f", turning with {abs(s.imag):.4g} rad/s" if abs(s.imag) > 1e-9 * abs(s) else ""
    return f"{parts}; waves grow by a factor e every {1 / s.real:.4g} s{turning}"
