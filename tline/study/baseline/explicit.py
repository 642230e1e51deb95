"""Methods that step in time: characteristics, upwind, Lax and Wendroff, leapfrog."""

from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

from tline.scene.rational import RationalImpedance
from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.solver.description.nodes import node_of_end
from tline.solver.steady.steady_state import rest, steady_state
from tline.study.baseline.loops import Grid, advance_cells, advance_fdtd, advance_grid, advance_moc
from tline.study.baseline.method import (
    COURANT,
    MOST_KEPT,
    MOST_WORK,
    BaselineRun,
    cells_of,
    count_steps,
    delays_of,
    impedances_of,
    shortest_delay,
    stepped,
    within,
)
from tline.study.baseline.nodes import Euler, half_sections, on_capacitor, scattering, trapezoid
from tline.words.wording import place

Weights = Callable[[float], tuple[float, float, float, float]]


def nearest(f: float) -> tuple[float, float, float, float]:
    """Weights of the samples 1 step late, on time, 1 and 2 steps early; here f is 0."""
    return 0.0, 1.0, 0.0, 0.0


def linear(f: float) -> tuple[float, float, float, float]:
    """The wave a fraction f of a step before the sample on time, on a straight line."""
    return 0.0, 1.0 - f, f, 0.0


def cubic(f: float) -> tuple[float, float, float, float]:
    """The same on Lagrange's cubic."""
    return (
        -f * (1 - f) * (2 - f) / 6,
        (1 + f) * (1 - f) * (2 - f) / 2,
        (1 + f) * f * (2 - f) / 2,
        -(1 + f) * f * (1 - f) / 6,
    )


def moc(
    scene: Scene,
    n: float,
    rule: Callable[[NDArray, NDArray], Euler] = trapezoid,
    weights: Weights = nearest,
    offset: float = 0.0,
    whole: int | None = None,
) -> BaselineRun:
    """Characteristics: what arrives is what was sent one delay ago.

    Without interpolation the delays are rounded to whole steps: the wave speeds are adjusted. `offset` adds to n; with
    `whole` all lines count as that many steps late, and the rest of the delay, whatever it is, is the fraction.
    """
    nodes, dt = describe(scene).nodes, shortest_delay(scene) / (n + offset)
    steps, delays = count_steps(scene, dt), delays_of(scene) / dt
    late = np.maximum(np.round(delays) if weights is nearest else np.floor(delays + 1e-9), 1).astype(int)
    late = late if whole is None else np.full(len(late), whole)
    taps = np.array([weights(f) for f in (0.0 * delays if weights is nearest else delays - late)])
    within(2 * len(late) * (steps + late.max()), MOST_KEPT)
    net = scattering(scene, list(nodes.values()), dt, rule)
    loop = partial(advance_moc, net, late, taps)
    return stepped(scene, loop, dt, steps, [node.excitations for node in nodes.values()])


def moc_grid(scene: Scene, n: float) -> BaselineRun:
    """Characteristics from point to point; friction over a reach counts as K |y before| y after: second order.

    Delays are rounded to whole steps.
    """
    description, dt = describe(scene), shortest_delay(scene) / n
    steps, reaches = count_steps(scene, dt), np.maximum(np.round(delays_of(scene) / dt), 1).astype(int)
    within(reaches.sum() * steps, MOST_WORK)
    losses = [line.losses for line in scene.single_lines.values()]
    friction = np.array([x.quadratic * x.exact.length if x else 0.0 for x in losses])
    each = description.nodes.values()
    net = Grid(
        np.cumsum([0, *(len(node.ends) for node in each)]),
        np.array([end for node in each for end in node.ends]),
        np.array([node.held is not None for node in each]),
        np.array([node.conductance for node in each]),
        reaches,
        impedances_of(scene),
        friction / reaches,
    )
    efforts, flows = steady_state(description) if description.steady else rest(description)[:2]
    ends = np.array([[efforts[node] for node in line.nodes] for line in scene.lines.values()])
    parts = [[(node.held, 1.0)] if node.held else node.flows for node in each]
    return stepped(scene, partial(advance_grid, net, ends, flows[:, 0]), dt, steps, parts)


def no_friction(scene: Scene) -> str | None:
    """Why a grid is of no use for a scene, or cannot do it; None if it can."""
    for name, load in scene.loads.items():
        if isinstance(load, RationalImpedance):
            return f"{place('loads', name)}: has a state"
    frictionless = all(line.losses is None or line.losses.linear for line in scene.single_lines.values())
    return "without friction it is the same as without a grid" if frictionless else None


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
