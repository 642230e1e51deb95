"""Method of characteristics from point to point of a grid, with quadratic friction in each reach."""

from functools import partial

import numpy as np

from tline.scene.rational import RationalImpedance
from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.solver.steady.steady_state import rest, steady_state
from tline.study.baseline.kernel.grid import Grid, advance_grid
from tline.study.baseline.method import BaselineRun
from tline.study.baseline.steps import MOST_WORK, count_steps, delays_of, impedances_of, shortest_delay, stepped, within
from tline.words.wording import place


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
