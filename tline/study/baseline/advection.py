"""Waves from cell to cell: upwind, and Lax and Wendroff."""

from collections.abc import Callable
from functools import partial

import numpy as np
from numba import njit
from numpy.typing import NDArray

from tline.scene.scene import Scene
from tline.solver.nodes import nodes_of
from tline.study.baseline.loads import scatter, scattering, trapezoid
from tline.study.baseline.method import Trace
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


def upwind(scene: Scene, n: float, courant: float = COURANT) -> Trace:
    """Each cell takes from the one behind it: linear interpolation along the line, what MOC does at Courant < 1."""
    return _cells(scene, n, courant, lambda C: C / 2)


def lax_wendroff(scene: Scene, n: float, courant: float = COURANT) -> Trace:
    """A parabola through the cell and both its neighbours; upwind in the last cell of a line."""
    return _cells(scene, n, courant, lambda C: C**2 / 2)


def _cells(scene: Scene, n: float, courant: float, diffusion: Callable[[NDArray], NDArray]) -> Trace:
    nodes, dt = nodes_of(scene), shortest_delay(scene) / n
    steps, cells = count_steps(scene, dt), cells_of(scene, dt, courant)
    within(2 * cells.sum() * steps, MOST_WORK)
    C = cells * dt / delays_of(scene)
    net = scattering(scene, list(nodes.values()), dt, trapezoid)
    loop = partial(advance_cells, net, cells, C, diffusion(C))
    return stepped(scene, loop, dt, steps, [node.drives for node in nodes.values()])


@njit(cache=True, error_model="numpy")
def advance_cells(net, cells, courant, diffusion, drive, seen, steps, record):
    """The wave sent from each end on a grid of its own, whose last point arrives at the other end."""
    ends, m = 2 * len(cells), net.x_x.shape[1]
    a = np.zeros((ends, np.max(cells) + 1))
    w, u, x, new = np.zeros(len(net.row)), np.zeros(len(net.row)), np.zeros((len(net.x_x), m)), np.zeros(m)
    arriving, sent = np.zeros(ends), np.zeros(ends)
    for k in range(steps + 1):
        for e in range(ends if k else 0):
            last, C, d = cells[e // 2], courant[e // 2], diffusion[e // 2]
            before, arriving[e ^ 1] = a[e, 0], a[e, last] - C * (a[e, last] - a[e, last - 1])
            for i in range(1, last):
                now, after = a[e, i], a[e, i + 1]
                a[e, i] = now - C / 2 * (after - before) + d * (after - 2 * now + before)
                before = now
            a[e, last] = arriving[e ^ 1]
        scatter(net, drive[:, k], arriving, w, x, new, u, sent)
        a[:, 0] = sent
        record[:, k] = u[seen]
