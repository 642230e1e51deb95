"""Waveforms of sources: smooth pieces between breaks.

A waveform is evaluated at instants t *relative to* an instant inside one of its smooth pieces, so that a jump has two
sides and rounding never picks the wrong one. ``breaks`` lists the jumps and corners.
"""

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import SerializeAsAny, model_serializer

from tline.scene.element import Element, optional, required
from tline.scene.quantity import ZERO, Level, Time

Floats = NDArray[np.floating]


class Shape(Element):
    """Base of all waveforms."""

    def breaks(self, t_end: float) -> Floats:
        """Instants at which the waveform jumps or has a corner, sorted: at least those before t_end that matter.

        Those of a periodic waveform before t = 0 are left out, but for one period, as a steady start needs it.
        """
        raise NotImplementedError

    def value(self, t: Floats, inside: Floats) -> Floats:
        """Value at t of the smooth piece that contains `inside`, continued; shapes broadcast."""
        raise NotImplementedError

    def fastest(self) -> float:
        """Shortest time scale of the smooth pieces, s; infinite if all are straight."""
        return np.inf


class Constant(Shape):
    """Constant value; in a scene file the plain number or text."""

    shape: Literal["constant"] = "constant"
    level: Level = required("the value")

    @model_serializer
    def _plain(self) -> int | float | str:
        return self.level.typed

    def __repr__(self) -> str:
        return f"Constant(level={self._plain()!r})"

    def breaks(self, t_end):  # noqa: D102
        return np.empty(0)

    def value(self, t, inside):  # noqa: D102
        return np.full(np.broadcast_shapes(t.shape, inside.shape), float(self.level))


class Lowered(Shape):
    """Waveform less a constant; not read from files."""

    waveform: SerializeAsAny[Shape]
    by: float

    def breaks(self, t_end):  # noqa: D102
        return self.waveform.breaks(t_end)

    def value(self, t, inside):  # noqa: D102
        return self.waveform.value(t, inside) - self.by

    def fastest(self):  # noqa: D102
        return self.waveform.fastest()


class Straight(NamedTuple):
    """Waveform of straight pieces between fronts, of which there is one at least."""

    at: Floats  # (fronts,) s
    level: Floats  # (fronts + 1,) before the first front, and behind each
    slope: Floats  # (fronts + 1,) 1/s; 0 before the first front

    def breaks(self, t_end: float) -> Floats:
        """Instants of the fronts, s."""
        return self.at[self.at < t_end]

    def value(self, t: Floats, inside: Floats) -> Floats:
        """Value at t of the piece that contains `inside`, continued."""
        piece = np.searchsorted(self.at, inside)
        return self.level[piece] + self.slope[piece] * (t - self.at[piece - 1])

    def fastest(self) -> float:
        """No time scale."""
        return np.inf


class Step(Shape):
    """Jump from one level to another."""

    shape: Literal["step"] = "step"
    from_: Level = optional("level before the jump", ZERO, alias="from")
    to: Level = required("level after the jump")
    at: Time = optional("instant of the jump", ZERO)

    def breaks(self, t_end):  # noqa: D102
        return np.array([float(self.at)])

    def value(self, t, inside):  # noqa: D102
        return np.where(inside < self.at, float(self.from_), float(self.to)) + 0.0 * t
