"""Law of straight lines between points, which tables have, and switches in a run."""

import numpy as np
from numpy.typing import NDArray

from tline.scene.law import ANY_DROP, Bend, Constants, LawKind

CURVED = 16  # number of points from which a table is a curve: narrower slabs cost less than fronts at all corners


class Tabled(LawKind):
    """Law of a table; constants: effort beyond the element, number n, n efforts, n flows."""

    name, unit = "table", "laws.table.table"
    control = "scale"
    returns = True  # as it may hold a source

    def bends(self, c, rho):  # noqa: D102
        if c[1] < CURVED:
            for e, i in _columns(c).T[1:-1].tolist():
                yield Bend(c[0] + e, rho * i)

    def holds(self, c, control):  # noqa: D102
        if not control:
            return ANY_DROP
        drops, flows = _columns(c)
        still = drops[flows == 0]
        return (c[0] + still.min(), c[0] + still.max()) if still.size else (0.0, 0.0)

    def source(self, c):  # noqa: D102
        return "" if through_origin(*_columns(c)) else "a table that misses the origin, so that it holds a source"

    def flow(self, c):  # noqa: D102
        efforts, flows = _columns(c)
        if (np.diff(efforts) <= 0.0).any():
            efforts = efforts + 1e-15 * np.ptp(efforts) * np.arange(len(efforts))  # where it is upright
        first, last = ((flows[k + 1] - flows[k]) / (efforts[k + 1] - efforts[k]) for k in (0, -2))

        def flow(d: NDArray) -> NDArray:
            beyond = last * np.maximum(d - efforts[-1], 0.0) + first * np.minimum(d - efforts[0], 0.0)
            return np.interp(d, efforts, flows) + beyond

        return flow


def _columns(c: Constants) -> NDArray:
    """Efforts and flows among the constants of a table."""
    return np.reshape(c[2 : 2 + 2 * int(c[1])], (2, -1))


def through_origin(efforts: NDArray, flows: NDArray) -> bool:
    """Whether the polyline through the points, its ends extended, meets the origin; effort and flow must not fall.

    Examples
    --------
    >>> through_origin(np.array([1.0, 2.0]), np.array([2.0, 4.0])), through_origin(np.ones(2), np.arange(2.0))
    (True, False)
    """
    begin = (np.arange(len(efforts) - 1) == 0) | ((efforts[:-1] <= 0) & (flows[:-1] <= 0))
    end = (np.arange(len(efforts) - 1) == len(efforts) - 2) | ((efforts[1:] >= 0) & (flows[1:] >= 0))
    return bool((begin & end & (efforts[:-1] * flows[1:] == efforts[1:] * flows[:-1])).any())
