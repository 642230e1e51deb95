"""The Hermitian form of a state space at many frequencies: its lowest value and where it is negative."""

import math
from collections.abc import Iterable
from itertools import pairwise

import numpy as np

from passivity.multiport.float_system import FloatSystem, Place

_PER_DECADE, _MOST = 8, 200  # frequencies of the first grid
_MINIMA = 6  # of which the lowest are followed
_FARTHEST = 1e30
_GOLDEN = (np.sqrt(5) - 1) / 2

Band = tuple[float, float]


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
        """The lowest value that is known better than not at all."""
        known = [place for place in self.places.values() if np.isfinite(place.error)]
        return min(known, key=lambda place: place.value + place.error)

    def follow(self) -> None:
        """Go down to the lowest of the local minima, by golden sections."""
        row = self._sorted()
        inner = [x for x in zip(row, row[1:], row[2:], strict=False) if x[1].value <= min(x[0].value, x[2].value)]
        for before, here, after in sorted(inner, key=lambda x: x[1].value)[:_MINIMA]:
            high = after.w if np.isfinite(after.w) else 4 * here.w
            self._descend(before.w, high)

    def _descend(self, low: float, high: float) -> None:
        width = _GOLDEN * (high - low)
        left, right = self.add([high - width, low + width])
        for _ in range(60):
            if high - low <= 1e-8 * high:
                return
            if left.value < right.value:
                high, right = right.w, left
                (left,) = self.add([high - _GOLDEN * (high - low)])
            else:
                low, left = left.w, right
                (right,) = self.add([low + _GOLDEN * (high - low)])

    def bands(self) -> list[Band]:
        """Where the value is negative, the ends found by bisection; places where its sign is not known do not count."""
        row = [place for place in self._sorted() if place.is_known]
        ends = [0.0] if row and row[0].is_negative else []
        ends += [self._end(x, y) for x, y in pairwise(row) if x.is_negative != y.is_negative]
        if len(ends) % 2:
            ends.append(math.inf)
        return list(zip(ends[::2], ends[1::2], strict=True))

    def _end(self, x: Place, y: Place) -> float:
        """Between two places of which one is negative."""
        low, high = x.w, min(y.w, _FARTHEST)
        while high - low > 1e-12 * high:
            middle = (low + high) / 2 if high < 4 * low or low == 0 else math.sqrt(low * high)
            (place,) = self.system.on_axis(middle)
            low, high = (middle, high) if (place.value < 0) == x.is_negative else (low, middle)
        return y.w if high == _FARTHEST else (low + high) / 2

    def _sorted(self) -> list[Place]:
        return [self.places[w] for w in sorted(self.places)]
