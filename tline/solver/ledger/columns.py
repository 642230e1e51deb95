"""Stretches of time on which all waves at a group of nodes are polynomials: slabs, or their pieces."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.excitation import broken
from tline.solver.description.given import Shape
from tline.solver.radau import Basis


class Columns(NamedTuple):
    """Slabs in one piece, or pieces of slabs."""

    basis: Basis
    h: float
    slab: NDArray  # (m,)
    span: NDArray | None = None  # (m, 2) start and end in slab time; None for whole slabs

    @property
    def width(self) -> NDArray:
        """Of each, s; shape (m,)."""
        return np.full(len(self.slab), self.h) if self.span is None else self.h * (self.span[:, 1] - self.span[:, 0])

    @property
    def middle(self) -> NDArray:
        """Of each, s; shape (m,)."""
        return self.h * (self.slab + (0.5 if self.span is None else self.span.mean(axis=1)))

    def values(self, shape: Shape, breaks: NDArray) -> NDArray:
        """A waveform with breaks at instants in slabs, at the points of each; shape (m, s)."""
        basis, h = self.basis, self.h
        start = self.middle - self.width / 2
        values = shape.value(start[:, None] + self.width[:, None] * basis.c, self.middle[:, None])
        inside = breaks[breaks % 1 != 0]
        if self.span is None and len(inside):
            low, n = int(self.slab[0]), len(self.slab)
            parts = broken([(shape, 1.0)], inside, basis, h, low, n)
            first = np.cumsum([0, *parts.parts])
            for slab, a, b in zip(parts.slab, first[:-1], first[1:], strict=True):
                values[slab - low] = sum(
                    basis.projection(parts.start[j], parts.stop[j]) @ (basis.to_points @ parts.coef[j])
                    for j in range(a, b)
                )
        return values

    def integral(self, x: NDArray, y: NDArray) -> NDArray:
        """Of products of polynomials over each, exact; shapes (…, m, s) to (…, m)."""
        return (x * y) @ self.basis.A[-1] * self.width

    def integral_of(self, x: NDArray) -> NDArray:
        """Of polynomials over each; shapes (…, m, s) to (…, m)."""
        return x @ self.basis.A[-1] * self.width
