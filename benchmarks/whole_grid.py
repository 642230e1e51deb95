"""Tnet1 by the textbook's method of characteristics, on a grid of 1 m: every pipe is a whole number of metres long.

No wave speed is changed, and nothing is interpolated; it shares nothing with tline but the scene's numbers. The valve
before the dead end is told by the flow that passes it, which TSNet lets fall evenly with time.

References
----------
E. B. Wylie, V. L. Streeter: Fluid Transients in Systems (1993), chapter 3.
"""

from pathlib import Path
from typing import Any

import numpy as np

from tline.interchange.water_scene import read_inp
from tline.scene.scene import Scene
from tline.scene.site import GRAVITY
from tline.solver.description.description import describe
from tline.solver.simulate import simulate
from tline.solver.steady.steady_state import steady_state

SPEED, T_END, END, CLOSES = 1200.0, 60.0, "N7", 0.6  # m/s, s, the valve's node, s
Heads = dict[str, tuple[float, float, float]]  # before, lowest and highest, m


def with_flow(path: Path) -> Scene:
    """Tnet1 whose valve is a flow that falls evenly to nothing, as in TSNet."""
    scene, _ = read_inp(str(path), SPEED)
    table = scene.table()
    flow = table["loads"]["N8"]["flow"]
    del table["links"], table["loads"]["N8"], table["nodes"]["N8"]
    falls = {"shape": "ramp", "from": -flow, "to": 0, "at": 0, "duration": CLOSES}
    table["sources"] = {"valve": {"at": END, "kind": "flow", "value": falls}}
    return Scene(**table | {"t_end": T_END, "probes": {END: {"at": END}}, "solver": {"tol": 1e-3}})


def by_tline(path: Path, nodes: tuple[str, ...]) -> Heads:
    """Heads of that scene."""
    scene = with_flow(path)
    seen = simulate(scene, envelope=True).envelope
    assert seen is not None
    metre = 1000.0 * GRAVITY
    return {
        node: tuple(seen.of(node)[key] / metre for key in ("start", "lowest", "highest"))  # type: ignore[misc]
        for node in nodes
    }


def by_grid(path: Path, nodes: tuple[str, ...]) -> Heads:
    """Heads by the method of characteristics with 1 m and 1/1200 s."""
    scene = with_flow(path)
    effort, _ = steady_state(describe(scene))
    head = {name: value / (1000.0 * GRAVITY) for name, value in effort.items()}
    table = scene.table()
    drawn = {one["at"]: one["flow"] / head[one["at"]] ** 0.5 for one in table["loads"].values() if "flow" in one}
    supply = next(one["at"] for one in table["loads"].values() if one["kind"] == "reservoir")
    valve = -table["sources"]["valve"]["value"]["from"]
    pipes: list[Any] = []
    ends: dict[str, list[tuple[int, int]]] = {name: [] for name in head}
    for k, line in enumerate(table["lines"].values()):
        (one, two), diameter = line["nodes"], line["diameter"]
        area, n = np.pi / 4 * diameter**2, round(line["length"])
        impedance = SPEED / (GRAVITY * area)
        loss = line["friction"]["factor"] / (2 * GRAVITY * diameter * area**2)  # of a metre
        h = np.linspace(head[one], head[two], n + 1)
        drop = (head[one] - head[two]) / n / loss
        pipes.append((h, np.full(n + 1, np.sign(drop) * abs(drop) ** 0.5), impedance, loss))
        ends[one].append((k, 0))
        ends[two].append((k, -1))
    seen = {node: [head[node]] for node in nodes}
    for step in range(1, round(T_END * SPEED) + 1):
        fresh = []
        for h, q, b, loss in pipes:
            friction = loss * q * abs(q)
            plus, minus = h + b * q - friction, h - b * q + friction
            new_h, new_q = np.empty_like(h), np.empty_like(q)
            new_h[1:-1] = (plus[:-2] + minus[2:]) / 2
            new_q[1:-1] = (plus[:-2] - minus[2:]) / (2 * b)
            fresh.append((new_h, new_q, minus[1], plus[-2]))
        for node, joined in ends.items():
            weight = sum(1 / pipes[k][2] for k, _ in joined)
            known = sum(fresh[k][2 if end == 0 else 3] / pipes[k][2] for k, end in joined)
            if node == supply:
                here = head[node]
            else:
                known -= valve * max(1 - step / SPEED / CLOSES, 0.0) if node == END else 0.0
                c = drawn.get(node, 0.0)
                root = 2 * known / (c + (c * c + 4 * weight * known) ** 0.5)
                here = root * root
            for k, end in joined:
                new_h, new_q, minus, plus = fresh[k]
                new_h[end] = here
                new_q[end] = (here - minus) / pipes[k][2] if end == 0 else (plus - here) / pipes[k][2]
            if node in seen:
                seen[node].append(here)
        pipes = [(new[0], new[1], *old[2:]) for new, old in zip(fresh, pipes, strict=True)]
    return {node: (head[node], float(min(each)), float(max(each))) for node, each in seen.items()}
