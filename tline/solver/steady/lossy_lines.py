"""Lossy lines in a steady flow: what falls along them, what leaks from them, and efforts and flows inside.

Of its resistance r and conductance g per metre such a line of length l makes a π: R = Zc sinh γl between its ends and
G = tanh(γl/2)/Zc at each, with Zc = √(r/g) and γ = √(r g). Friction that depends on the flow adds its fall to R's.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.loss.flow_law import side_by_side
from tline.solver.description.lines import Line

Slopes = tuple[NDArray, NDArray, NDArray, NDArray]


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
    """What falls along lines, over one unknown each: z0·y."""

    def __init__(self, lines: Mapping[str, Line]):
        self.z0 = np.array([line.z0 for line in lines.values()])
        self._resistance = np.array([pi(line)[0] for line in lines.values()])
        laws = [line.losses.flow_law if line.losses else None for line in lines.values()]
        self._length = np.array([line.losses.exact.length if line.losses else 0.0 for line in lines.values()])
        self._laws = side_by_side(laws)

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
        return fall, y, slope, dy


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
