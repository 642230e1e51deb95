"""Waves from cell to cell: upwind, and Lax and Wendroff."""

from collections.abc import Callable
from functools import partial

from numpy.typing import NDArray

from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.study.baseline.kernel.cells import advance_cells
from tline.study.baseline.loads import scattering, trapezoid
from tline.study.baseline.method import BaselineRun
from tline.study.baseline.steps import (
    COURANT,
    MOST_WORK,
    cells_of,
    count_steps,
    delays_of,
    shortest_delay,
    stepped,
    within,
)


def upwind(scene: Scene, n: float, courant: float = COURANT) -> BaselineRun:
    """Each cell takes from the one behind it: linear interpolation along the line, what MOC does at Courant < 1."""
    return _cells(scene, n, courant, lambda C: C / 2)


def lax_wendroff(scene: Scene, n: float, courant: float = COURANT) -> BaselineRun:
    """A parabola through the cell and both its neighbours; upwind in the last cell of a line."""
    return _cells(scene, n, courant, lambda C: C**2 / 2)


def _cells(scene: Scene, n: float, courant: float, diffusion: Callable[[NDArray], NDArray]) -> BaselineRun:
    nodes, dt = describe(scene).nodes, shortest_delay(scene) / n
    steps, cells = count_steps(scene, dt), cells_of(scene, dt, courant)
    within(2 * cells.sum() * steps, MOST_WORK)
    C = cells * dt / delays_of(scene)
    net = scattering(scene, list(nodes.values()), dt, trapezoid)
    loop = partial(advance_cells, net, cells, C, diffusion(C))
    return stepped(scene, loop, dt, steps, [node.excitations for node in nodes.values()])
