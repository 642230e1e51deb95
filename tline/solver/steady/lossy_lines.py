"""Lossy lines in a steady flow: what falls along them, what leaks from them, and efforts and flows inside.

Of its resistance r and conductance g per metre such a line of length l makes a π: R = Zc sinh γl between its ends and
G = tanh(γl/2)/Zc at each, with Zc = √(r/g) and γ = √(r g). Friction that depends on the flow adds its fall to R's.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.lines import Line

FAINTEST = 1e-150  # wave that a table knows

Slopes = tuple[NDArray, NDArray, NDArray, NDArray]


class FrictionTable(NamedTuple):
    """Friction of a line as its loss elements have it."""

    elements: int
    entries: NDArray  # as in `LossElements`: e/w over log2 |w|


def pi(line: Line) -> tuple[float, float]:
    """Resistance between the ends and conductance at each, to a steady flow, without what depends on its size."""
    if line.losses is None:
        return 0.0, 0.0
    exact = line.losses.exact
    r, g = exact.series.loss * exact.length, exact.shunt.loss * exact.length
    x = np.sqrt(r * g)
    return (r * np.sinh(x) / x, g * np.tanh(x / 2) / x) if x else (r, g / 2)


class Falls:
    """What falls along lines, over one unknown each: z0·y, or the wave that a tabled loss element sees.

    Attributes
    ----------
    z0 : ndarray, shape (lines,)
    """

    def __init__(self, lines: Mapping[str, Line], tables: Mapping[str, FrictionTable]):
        self.z0 = np.array([line.z0 for line in lines.values()])
        self._resistance = np.array([pi(line)[0] for line in lines.values()])
        losses = [line.losses for line in lines.values()]
        self._quadratic = np.array([each.quadratic * each.exact.length if each else 0.0 for each in losses])
        self._tables = {k: tables[name] for k, name in enumerate(lines) if name in tables}
        curved = [(k, each) for k, each in enumerate(losses) if each is not None and each.curve is not None]
        self._curves = [(k, each) for k, each in curved if k not in self._tables]

    def solved(self, a: NDArray) -> Slopes:
        """Falls and flows, and their slopes over a."""
        y, dy = a / self.z0, 1 / self.z0
        fall = (self._resistance + self._quadratic * np.abs(y)) * y
        slope = (self._resistance + 2 * self._quadratic * np.abs(y)) * dy
        for k, losses in self._curves:
            more, steep = losses.friction(y[k])
            fall[k], slope[k] = fall[k] + more, slope[k] + steep * dy[k]
        for k, (elements, entries) in self._tables.items():
            share, steep = _looked_up(entries, a[k])
            y[k], dy[k] = (1 - share) * a[k] / (2 * self.z0[k]), (1 - steep) / (2 * self.z0[k])
            fall[k] = elements * share * a[k] + self._resistance[k] * y[k]
            slope[k] = elements * steep + self._resistance[k] * dy[k]
        return fall, y, slope, dy


def _looked_up(entries: NDArray, w: float) -> tuple[float, float]:
    """Share e/w as the kernel looks it up, and slope of e."""
    first, points, n = entries[0], entries[1], int(entries[2])
    at = min(max((np.log2(max(abs(w), FAINTEST)) - first) * points, 0.0), n - 1.0)
    k = min(int(at), n - 2)
    below, above = entries[3 + k], entries[4 + k]
    share = (1 - (at - k)) * below + (at - k) * above
    return share, share + ((above - below) * points / np.log(2) if 0 < at < n - 1 else 0.0)


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
