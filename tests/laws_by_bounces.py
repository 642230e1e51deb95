"""Random networks of lossless lines with laws at their nodes, and their waves by recursion from bounce to bounce.

The flow out of a node rises with its pressure u: Σ (w - u)/z0 + (p - u)/R = law(u) has one root, found by halving.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tline.scene.scene import Scene

HALVINGS = 70
Function = Callable[[NDArray], NDArray]


@dataclass
class Network:
    """Lines, and what stands at their nodes: at each a source behind its resistance, or none, and a law, or none."""

    lines: list[tuple[int, int, float, float]]  # nodes, z0, delay
    sources: dict[int, tuple[dict[str, Any], float]]
    laws: dict[int, tuple[dict[str, Any], Function]] = field(default_factory=dict)
    t_end: float = 4.0

    @property
    def scene(self) -> Scene:
        ends = [(k, e) for k in range(len(self.lines)) for e in (0, 1)]
        return Scene(
            medium="hydraulic",
            t_end=self.t_end,
            lines={
                f"l{k}": {"nodes": [f"n{a}", f"n{b}"], "z0": z0, "delay": delay}
                for k, (a, b, z0, delay) in enumerate(self.lines)
            },
            sources={
                f"s{n}": {"at": f"n{n}", "kind": "pressure", "value": value, "resistance": behind}
                for n, (value, behind) in self.sources.items()
            },
            loads={f"x{n}": law | {"at": f"n{n}"} for n, (law, _) in self.laws.items()},
            probes={f"p{k}{e}": {"at": f"n{self.lines[k][e]}", "line": f"l{k}"} for k, e in ends},
        )

    def exact(self, t: NDArray) -> dict[str, tuple[NDArray, NDArray]]:
        """Pressure and flow at both ends of all lines."""
        found, known, scene = {}, {}, self.scene
        for k, line in enumerate(self.lines):
            for e in (0, 1):
                u, arriving = self._node(line[:2][e], (0,) * len(self.lines), t, known, scene)
                found[f"p{k}{e}"] = u, (arriving[k, e] - u) / line[2] * (1 if e else -1)
        return found

    def _node(self, n: int, shift: tuple[int, ...], t: NDArray, known: dict, scene: Scene):
        """Pressure at a node so many delays of each line earlier, and the waves that arrive."""
        if (n, shift) in known:
            return known[n, shift]
        here = t - sum(times * line[3] for times, line in zip(shift, self.lines, strict=True))
        total, drive, arriving = 0.0, np.zeros_like(t), {}
        for k, line in enumerate(self.lines):
            for e in (0, 1):
                if line[e] == n:
                    arriving[k, e] = w = self._sent(k, 1 - e, shift, t, here - line[3], known, scene)
                    total, drive = total + 1 / line[2], drive + w / line[2]
        if n in self.sources:
            behind = self.sources[n][1]
            value = scene.sources[f"s{n}"].value.value(here, here)
            total, drive = total + 1 / behind, drive + np.where(here > 0, value, 0.0) / behind
        u = drive / total
        if n in self.laws:
            low, high = np.minimum(u, 0.0), np.maximum(u, 0.0)  # for nothing flows at rest
            for _ in range(HALVINGS):
                middle = (low + high) / 2
                above = total * middle + self.laws[n][1](middle) > drive
                low, high = np.where(above, low, middle), np.where(above, middle, high)
            u = np.where(here > 0, (low + high) / 2, 0.0)
        known[n, shift] = u, arriving
        return u, arriving

    def _sent(self, k: int, end: int, shift: tuple[int, ...], t: NDArray, left: NDArray, known: dict, scene: Scene):
        """The wave that left an end of a line when it had to, to arrive."""
        if (left <= 0).all():
            return np.zeros_like(t)
        earlier = (*shift[:k], shift[k] + 1, *shift[k + 1 :])
        u, arriving = self._node(self.lines[k][:2][end], earlier, t, known, scene)
        return np.where(left > 0, 2 * u - arriving[k, end], 0.0)


def random_law(rng: np.random.Generator) -> tuple[dict[str, Any], Function]:
    """A law that lets nothing flow at rest."""
    size, at, band = float(10 ** rng.uniform(-1, 1)), float(rng.uniform(0.1, 0.6)), float(rng.uniform(0.05, 0.5))
    rated = {"flow": size, "pressure_drop": 1.0}
    laws: list[tuple[dict[str, Any], Function]] = [
        ({"kind": "orifice"} | rated, lambda u: size * np.copysign(np.sqrt(np.abs(u)), u)),
        ({"kind": "check valve"} | rated, lambda u: size * np.sqrt(np.maximum(u, 0))),
        (
            {"kind": "relief valve", "set_pressure": at, "band": band} | rated,
            lambda u: size * np.clip((u - at) / band, 0, 1) * np.sqrt(np.maximum(u, 0)),
        ),
        ({"kind": "leak", "flow": size, "pressure": 1.0}, lambda u: size * np.sqrt(np.maximum(u, 0))),
        ({"kind": "demand", "flow": size, "required_pressure": at}, lambda u: size * np.sqrt(np.clip(u / at, 0, 1))),
        (
            {"kind": "table", "points": [[-1, -size], [0, 0], [at, 0], [at + 1, size]]},
            lambda u: np.where(u < 0, size * u, size * np.maximum(u - at, 0)),
        ),
    ]
    return laws[int(rng.integers(len(laws)))]


def random_network(seed: int) -> Network:
    """One to three lines."""
    rng = np.random.default_rng(seed)
    count, to, at = int(rng.integers(1, 4)), float(rng.uniform(0.5, 2)), float(rng.uniform(0, 1))
    rise = float(10 ** rng.uniform(-2.5, -0.5))
    values = [
        {"shape": "step", "to": to, "at": at},
        {"shape": "ramp", "to": to, "at": at, "duration": float(rng.uniform(0.2, 2))},
        {"shape": "pulses", "high": to, "at": at, "width": 0.1, "rise": rise, "fall": rise},
        {"shape": "sine", "amplitude": to, "at": at, "frequency": float(rng.uniform(0.1, 3))},
        {"shape": "double exponential", "peak": to, "at": at, "rise": rise / 5, "decay": 1.0},
    ]
    value = values[int(rng.integers(len(values)))]
    pairs = [(0, 1), *((int(rng.integers(k)), k) for k in range(2, count + 1))]
    delays = np.ones(count) if rng.random() < 0.3 else rng.uniform(0.5, 1.5, count)
    lines = [
        (a, b, float(10 ** rng.uniform(-0.5, 0.5)), float(delay)) for (a, b), delay in zip(pairs, delays, strict=True)
    ]
    laws = {n: random_law(rng) for n in range(count + 1) if n == count or rng.random() < 0.6}
    return Network(lines, {0: (value, float(10 ** rng.uniform(-1, 0.5)))}, laws)
