"""Leapfrog of efforts and flows on staggered grids (FDTD)."""

from functools import partial

import numpy as np

from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.solver.description.nodes import node_of_end
from tline.study.baseline.kernel.staggered import advance_fdtd
from tline.study.baseline.loads import trapezoid
from tline.study.baseline.method import BaselineRun
from tline.study.baseline.node_systems import half_sections, on_capacitor
from tline.study.baseline.steps import (
    COURANT,
    MOST_WORK,
    cells_of,
    count_steps,
    delays_of,
    impedances_of,
    shortest_delay,
    stepped,
    within,
)


def fdtd(scene: Scene, n: float, courant: float = COURANT) -> BaselineRun:
    """Effort at cell edges and whole steps, flow between them; half a cell of every line belongs to its node."""
    nodes, dt = describe(scene).nodes, shortest_delay(scene) / n
    steps, cells = count_steps(scene, dt), cells_of(scene, dt, courant)
    within(2 * cells.sum() * steps, MOST_WORK)
    systems = [on_capacitor(node, half, dt) for node, half in half_sections(scene, nodes, cells)]
    m = max(len(system.A) for system in systems)
    maps = [trapezoid(system.A, system.B[:, 0]) for system in systems]
    x_x = np.array([np.pad(x, (0, m - len(x))) for x, _, _ in maps])
    x_i = np.array([np.pad(2 * half, (0, m - len(half))) for _, half, _ in maps])
    held = np.array([node.held is not None for node in nodes.values()])
    parts = [[(node.held, 1.0)] if node.held else node.flows for node in nodes.values()]
    C = cells * dt / delays_of(scene)
    loop = partial(advance_fdtd, cells, C, impedances_of(scene), node_of_end(nodes.values()), held, x_x, x_i)
    return stepped(scene, loop, dt, steps, parts)
