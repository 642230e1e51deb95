"""The exact lattice of a resistive scene: every wave traced back to the sources, in whatever numbers it is given.

It owes nothing to the solver: no slabs, no polynomials; with fractions every value is exact.
"""

from collections.abc import Callable
from typing import Any


class Lattice:
    """Lines (node, node, z0, delay); of each node a shunt conductance and a flow driven into it, silent for t <= 0."""

    def __init__(self, lines: list[tuple[str, str, Any, Any]], conductance: dict[str, Any], flow: dict[str, Callable]):
        self.lines, self.conductance, self.flow = lines, conductance, flow
        self.known: dict[tuple[int, tuple[int, ...]], Any] = {}

    def effort(self, node: str, t: Any) -> Any:
        """u of a node at an instant."""
        return self._effort(node, t, (0,) * len(self.lines))

    def _time(self, t: Any, passed: tuple[int, ...]) -> Any:
        return t - sum((count * line[3] for count, line in zip(passed, self.lines, strict=True)), 0 * t)

    def _effort(self, node: str, t: Any, passed: tuple[int, ...]) -> Any:
        now = self._time(t, passed)
        if now <= 0:
            return 0 * t
        current, total = self.flow.get(node, lambda t: 0 * t)(now), self.conductance.get(node, 0)
        for k, (one, two, z0, _) in enumerate(self.lines):
            for side, end in enumerate((one, two)):
                if end == node:
                    total += 1 / z0
                    current += self._arriving(k, side, t, passed) / z0
        return current / total

    def _arriving(self, k: int, side: int, t: Any, passed: tuple[int, ...]) -> Any:
        """Wave that arrives at a line's end: it left the other end one delay ago."""
        key = (2 * k + side, tuple(n + (j == k) for j, n in enumerate(passed)), t)
        if key not in self.known:
            node = self.lines[k][1 - side]
            if self._time(t, key[1]) <= 0:
                self.known[key] = 0 * t
            else:
                self.known[key] = 2 * self._effort(node, t, key[1]) - self._arriving(k, 1 - side, t, key[1])
        return self.known[key]
