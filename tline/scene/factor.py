"""Control signals that scale an element over time: the opening of a valve, the speed of a pump."""

from functools import lru_cache
from itertools import pairwise
from typing import Annotated

import numpy as np
from pydantic import PrivateAttr, SerializeAsAny

from tline.distinct import distinct
from tline.errors import InputError
from tline.scene.mistakes import Read
from tline.scene.quantity import LEVEL
from tline.scene.shape import Constant, Floats, Shape
from tline.scene.waveform import Waveform, read_waveform

LOOKS = 1000  # instants at which a curved waveform is sampled
STROKE_ROUNDING = 1e-9
PARTS, HALVINGS = 64, 60  # of a smooth piece, and of each part in which a level is passed


Factor = Annotated[Shape, Read(lambda value, info: read_waveform(value, "", info), Waveform | float | str)]
ALWAYS = Constant(level=LEVEL.parse(1, ""))


def check_range(factor: Shape, t_end: float, most: float) -> None:
    """Raise an error if a control signal leaves the range 0 to `most` before t_end."""
    edges = distinct(np.concatenate([[0.0, t_end], factor.breaks(t_end)]))
    edges = edges[edges <= t_end]
    inside = (edges[:-1] + edges[1:]) / 2 if len(edges) > 1 else edges
    share = np.linspace(0.0, 1.0, max(LOOKS // len(inside), 2))
    t = edges[: len(inside), None] + (np.diff(edges)[:, None] if len(edges) > 1 else 0.0) * share
    value = factor.value(t, inside[:, None])
    bad = (value < -STROKE_ROUNDING) | (value > most * (1 + STROKE_ROUNDING))
    if bad.any():
        got = f"{value[bad][0]:.6g} at {t[bad][0]:.6g} s"
        expected = f"from 0 to {most:g}" if np.isfinite(most) else "zero or more"
        raise InputError("", "out of range", expected, got)


class Characterised(Shape):
    """Share of its capacity that a valve has over time, by a table of openings and shares; not read from files."""

    opening: SerializeAsAny[Shape]
    shares: tuple[tuple[float, float], ...]
    _breaks: dict[float, Floats] = PrivateAttr(default_factory=dict)  # found before, by t_end

    def breaks(self, t_end):  # noqa: D102
        if t_end not in self._breaks:
            own = self.opening.breaks(t_end)
            edges = distinct([0.0, t_end, *own])
            crossings = _on_straight_pieces if np.isinf(self.opening.fastest()) else _on_curves
            levels = np.array([level for level, _ in self.shares[1:-1]])
            self._breaks[t_end] = distinct(np.concatenate([own, crossings(self.opening, edges, levels)]))
        return self._breaks[t_end]

    def value(self, t, inside):  # noqa: D102
        x, y = _columns(self.shares)
        levels = np.broadcast_to(self.opening.value(t, inside), np.broadcast_shapes(t.shape, inside.shape))
        middle = self.opening.value(inside, inside)
        piece = np.clip(np.searchsorted(x, middle) - 1, 0, len(x) - 2)
        return y[piece] + (y[piece + 1] - y[piece]) * (levels - x[piece]) / (x[piece + 1] - x[piece])

    def fastest(self):  # noqa: D102
        return self.opening.fastest()


@lru_cache
def _columns(shares: tuple[tuple[float, float], ...]) -> Floats:
    """Openings, and the shares at them."""
    return np.array(shares).T


def _on_straight_pieces(opening: Shape, edges: Floats, levels: Floats) -> Floats:
    """Instants at which an opening that is linear between edges crosses levels."""
    ends = np.stack([edges[:-1], edges[1:]], axis=1)
    first, last = opening.value(ends, ends.mean(axis=1, keepdims=True)).T
    piece, k = np.nonzero((first[:, None] > levels) != (last[:, None] > levels))
    share = (levels[k] - first[piece]) / (last[piece] - first[piece])
    return edges[piece] + share * (edges[piece + 1] - edges[piece])


def _on_curves(opening: Shape, edges: Floats, levels: Floats) -> Floats:
    """Instants at which an opening that is smooth between edges crosses levels, by bisection of 64 parts each."""
    found = [np.empty(0)]
    for low, high in pairwise(edges.tolist()):
        inside, parts = np.array((low + high) / 2), np.linspace(low, high, PARTS + 1)
        above = opening.value(parts, inside)[:, None] > levels
        part, k = np.nonzero(above[:-1] != above[1:])
        first, last = parts[part], parts[part + 1]
        for _ in range(HALVINGS if len(part) else 0):
            middle = (first + last) / 2
            same = (opening.value(middle, inside) > levels[k]) == above[part, k]
            first, last = np.where(same, middle, first), np.where(same, last, middle)
        found.append(last)
    return np.concatenate(found)
