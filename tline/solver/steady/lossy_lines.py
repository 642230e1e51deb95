"""Lossy lines in a steady flow: what falls along them, what leaks from them, and efforts and flows inside.

Of its resistance r and conductance g per metre such a line of length l makes a π: R = Zc sinh γl between its ends and
G = tanh(γl/2)/Zc at each, with Zc = √(r/g) and γ = √(r g). Friction that depends on the flow adds its fall to R's.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.loss.flow_law import side_by_side
from tline.solver.description.lines import Line

FAINTEST = 1e-150  # wave that a table knows

Slopes = tuple[NDArray, NDArray, NDArray, NDArray]


class FrictionTable(NamedTuple):
    """Friction of a line as its loss elements have it."""

    elements: int
    scale: float  # c: looked up at c |w|
    entries: NDArray  # as in `LossElements`, of all lines
    at: int  # place of its own


def pi(line: Line) -> tuple[float, float]:
    """Resistance between the ends and conductance at each, to a steady flow, without what depends on its size."""
    if line.losses is None:
        return 0.0, 0.0
    exact = line.losses.exact
    r, g = exact.series.loss * exact.length, exact.shunt.loss * exact.length
    x = np.sqrt(r * g)
    return (r * np.sinh(x) / x, g * np.tanh(x / 2) / x) if x else (r, g / 2)


def falling(line: Line) -> bool:
    """Whether effort falls along a line in a steady flow."""
    return line.losses is not None and any(line.losses.steady_drop(1.0))


class Falls:
    """What falls along lines, over one unknown each: z0·y, or the wave that a tabled loss element sees.

    Attributes
    ----------
    z0 : ndarray, shape (lines,)
    """

    def __init__(self, lines: Mapping[str, Line], tables: Mapping[str, FrictionTable]):
        self.z0 = np.array([line.z0 for line in lines.values()])
        self._resistance = np.array([pi(line)[0] for line in lines.values()])
        laws = [line.losses.flow_law if line.losses else None for line in lines.values()]
        self._length = np.array([line.losses.exact.length if line.losses else 0.0 for line in lines.values()])
        names = [*lines]
        self._tabled = np.array([k for k, name in enumerate(names) if name in tables], int)
        self._tables = [tables[names[k]] for k in self._tabled]
        self._laws = side_by_side(None if name in tables else law for name, law in zip(names, laws, strict=True))

    def solved(self, a: NDArray) -> Slopes:
        """Falls and flows, and their slopes over a."""
        if not len(a):
            return a, a, a, a
        y, dy = a / self.z0, 1 / self.z0
        fall, slope = self._resistance * y, self._resistance * dy
        for here, law in self._laws:
            drop, steep = law(np.abs(y[here]))
            fall[here] += np.sign(y[here]) * drop * self._length[here]
            slope[here] += steep * self._length[here] * dy[here]
        if self._tables:
            k = self._tabled
            share, steep = _looked_up(self._tables, a[k])
            elements = np.array([table.elements for table in self._tables])
            y[k], dy[k] = (1 - share) * a[k] / (2 * self.z0[k]), (1 - steep) / (2 * self.z0[k])
            fall[k] = elements * share * a[k] + self._resistance[k] * y[k]
            slope[k] = elements * steep + self._resistance[k] * dy[k]
        return fall, y, slope, dy


def _looked_up(tables: Sequence[FrictionTable], w: NDArray) -> tuple[NDArray, NDArray]:
    """Shares e/w as the kernel looks them up, and slopes of e."""
    entries, at = tables[0].entries, np.array([table.at for table in tables])
    first, points, n = entries[at], entries[at + 1], entries[at + 2]
    size = np.array([table.scale for table in tables]) * np.abs(w)
    x = np.minimum((np.log2(np.maximum(size, FAINTEST)) - first) * points, n - 1.0)
    k = np.clip(x.astype(int), 0, n.astype(int) - 2)
    below, above = entries[at + 3 + k], entries[at + 4 + k]
    share = np.exp2((1 - (x - k)) * below + (x - k) * above)
    return share, share * np.where(x < n - 1, 1 + (above - below) * points, 1.0)


class Ends(NamedTuple):
    """A line in a steady flow: efforts, and flows from end 1 to end 2."""

    line: Line
    u: NDArray  # (2,)
    y: NDArray  # (2,)

    def at(self, part: NDArray) -> tuple[NDArray, NDArray]:
        """Effort and flow times z0 at parts of its length."""
        (u1, u2), (y1, y2) = self.u, self.y
        losses, z0 = self.line.losses, self.line.z0
        assert losses is not None
        x = losses.attenuation
        if not x:
            return u1 + part * (u2 - u1), z0 * (y1 + part * (y2 - y1))
        Zc = np.sqrt(losses.exact.series.loss / losses.exact.shunt.loss)
        u = (u1 * np.sinh(x * (1 - part)) + u2 * np.sinh(x * part)) / np.sinh(x)
        y = (u1 * np.cosh(x * (1 - part)) - u2 * np.cosh(x * part)) / (Zc * np.sinh(x))
        return u, z0 * y
