"""Fronts of sources and of laws that move, and laws as they answer small waves behind a front: by their tangents."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.radau import Basis


class Fronts(NamedTuple):
    """Fronts that hold the effort at a node, or drive flows into nodes by weights."""

    into: list[tuple[int, float]]
    held: bool
    at: NDArray  # (fronts,) s
    jump: NDArray
    bend: NDArray  # 1/s

    def sizes(self, h: float) -> NDArray:
        """Largest jump and bend, the latter within a time h."""
        return np.array([np.abs(each).max(initial=0.0) for each in (self.jump, self.bend * h)])

    def some(self, chosen: list[int]) -> "Fronts":
        """Some of the fronts."""
        return self._replace(**{name: getattr(self, name)[chosen] for name in ("at", "jump", "bend")})


class Tangents(NamedTuple):
    """Laws at all points of slabs, (n, s, K): i = i0 + g (e - e0) across each, with few different g, none extreme."""

    effort: NDArray
    flow: NDArray
    conductance: NDArray

    def front(self, law: int, slab: int, order: Basis, h: float) -> tuple[float, float]:
        """Jump and bend, at the beginning of a slab, of the flow that a law has beyond its tangent behind it."""
        flow = self.flow[:, :, law] - self.conductance[slab, -1, law] * self.effort[:, :, law]
        powers, value = np.arange(order.s), order.evaluation([0.0, 1.0])
        slope = 2 / h * (powers * np.array([[-1.0], [1.0]]) ** np.maximum(powers - 1, 0)) @ order.to_powers
        before, behind = flow[slab - 1], flow[slab]
        return float(value[0] @ behind - value[1] @ before), float(slope[0] @ behind - slope[1] @ before)
