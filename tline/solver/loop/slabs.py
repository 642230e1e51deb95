"""Slabs of a run; the last may extend beyond its end."""

from functools import lru_cache
from math import ceil, floor
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.excitation import EDGE
from tline.solver.loop.march import Noted, concatenated
from tline.solver.radau import Basis, thin_product


class Slabs(NamedTuple):
    """Slabs of equal width from t = 0 on; a run ends at `end`, its waves go on to the last slab's end."""

    number: int
    width: float  # s
    end: float  # of the run, s, in the last slab or at its end

    @classmethod
    def until(cls, t_end: float, width: float, number: int | None = None) -> "Slabs":
        """Make the slabs until t_end, or `number` of them; too few end before it."""
        needed = max(ceil(t_end / width - EDGE), 1)
        number = needed if number is None else number
        return cls(number, width, t_end if number >= needed else number * width)

    @property
    def whole(self) -> int:
        """Number of slabs that end in time."""
        return min(floor(self.end / self.width + EDGE), self.number)

    @property
    def rest(self) -> float:
        """Share of the slab behind the whole ones that lies before the end; 0 if there is none."""
        return self.end / self.width - self.whole if self.whole < self.number else 0.0

    @property
    def ends(self) -> NDArray:
        """Instants at which slabs begin or end, s: 0, h, 2h, … and the end of the run."""
        return _ends(self)


@lru_cache(maxsize=8)
def _ends(slabs: Slabs) -> NDArray:
    return np.append(np.arange(slabs.whole + (slabs.rest > 0)) * slabs.width, slabs.end)


def cut_at_end(slabs: Slabs, values: NDArray, pieces: Noted, order: Basis) -> tuple[Noted, Noted]:
    """Cut the slab in which a run ends at the end: its polynomials are restricted.

    Values (rows, 2, s) are waves in that slab, of rows not in pieces there; pieces are of these rows, in any slab.
    Returned are all pieces before the end, and those behind it.
    """
    inside = pieces.slab == slabs.whole
    earlier, held = (Noted(*(part[these] for part in pieces)) for these in (~inside, inside))
    rows = np.setdiff1d(np.arange(len(values)), held.row)
    alone = Noted(rows, np.full(len(rows), slabs.whole), np.tile([0.0, 1.0], (len(rows), 1)), values[rows])
    every = concatenated([held, alone], order.s)
    before, behind = (_part(every, *places, order) for places in ((0.0, slabs.rest), (slabs.rest, 1.0)))
    return concatenated([earlier, before], order.s), behind


def _part(pieces: Noted, low: float, high: float, order: Basis) -> Noted:
    span = np.clip(pieces.span, low, high)
    kept = span[:, 1] > span[:, 0]
    row, slab, whole, values = (part[kept] for part in pieces)
    span, width = span[kept], np.diff(whole, axis=1)
    shares = (span - whole[:, :1]) / width
    different, which = np.unique(shares, axis=0, return_inverse=True)
    found = np.empty_like(values)
    for k, (start, stop) in enumerate(different.tolist()):
        these = which.ravel() == k
        found[these] = thin_product(values[these], order.restriction(start, stop).T)
    return Noted(row, slab, span, found)
