"""Method of characteristics from point to point of a grid, with quadratic friction in each reach."""

from functools import partial
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from tline.scene.mistakes import place
from tline.scene.rational_load import Rational
from tline.scene.scene import Scene
from tline.solver.nodes import nodes_of
from tline.solver.steady import rest, steady_state
from tline.study.baseline.method import Trace
from tline.study.baseline.steps import MOST_WORK, count_steps, delays_of, impedances_of, shortest_delay, stepped, within


class Grid(NamedTuple):
    """Lines in reaches and nodes that hold an effort or conduct, as arrays."""

    first: NDArray  # (nodes + 1,) the ends at node k are ends[first[k]:first[k + 1]]
    ends: NDArray
    held: NDArray  # (nodes,)
    conductance: NDArray  # (nodes,)
    reaches: NDArray  # (lines,)
    z0: NDArray  # (lines,)
    friction: NDArray  # (lines,) K of a drop K |y| y over a reach


def moc_grid(scene: Scene, n: float) -> Trace:
    """Characteristics from point to point; friction over a reach counts as K |y before| y after: second order.

    Delays are rounded to whole steps.
    """
    nodes, dt = nodes_of(scene), shortest_delay(scene) / n
    steps, reaches = count_steps(scene, dt), np.maximum(np.round(delays_of(scene) / dt), 1).astype(int)
    within(reaches.sum() * steps, MOST_WORK)
    losses = [line.losses for line in scene.single_lines.values()]
    friction = np.array([x.quadratic * x.exact.length if x else 0.0 for x in losses])
    each = nodes.values()
    net = Grid(
        np.cumsum([0, *(len(node.ends) for node in each)]),
        np.array([end for node in each for end in node.ends]),
        np.array([node.held is not None for node in each]),
        np.array([node.conductance for node in each]),
        reaches,
        impedances_of(scene),
        friction / reaches,
    )
    efforts, flows = (steady_state if scene.start == "steady" else rest)(scene, nodes)
    ends = np.array([[efforts[node] for node in line.nodes] for line in scene.lines.values()])
    parts = [[(node.held, 1.0)] if node.held else node.flows for node in each]
    return stepped(scene, partial(advance_grid, net, ends, flows[:, 0]), dt, steps, parts)


@njit(cache=True, error_model="numpy")
def advance_grid(net, ends, flows, drive, seen, steps, record):
    """Effort u and flow y on all points of all lines, begun on straight lines between the ends."""
    lines = len(net.reaches)
    most, effort = np.max(net.reaches) + 1, np.zeros(len(net.held))
    u, y, new_u, new_y = (
        np.zeros((lines, most)),
        np.zeros((lines, most)),
        np.zeros((lines, most)),
        np.zeros((lines, most)),
    )
    for j in range(lines):
        last = net.reaches[j]
        u[j, : last + 1] = ends[j, 0] + (ends[j, 1] - ends[j, 0]) / last * np.arange(last + 1)
        y[j, : last + 1] = flows[j]
    for k in range(len(net.held)):
        end = net.ends[net.first[k]]
        effort[k] = ends[end // 2, end % 2]
    record[:, 0] = effort[seen]
    for step in range(1, steps + 1):
        for j in range(lines):
            inside(u[j], y[j], new_u[j], new_y[j], net.reaches[j], net.z0[j], net.friction[j])
        for k in range(len(net.held)):
            flow, conductance = drive[k, step], net.conductance[k]
            for end in net.ends[net.first[k] : net.first[k + 1]]:
                w, z = arriving(net, end, u, y)
                flow, conductance = flow + w / z, conductance + 1 / z
            effort[k] = drive[k, step] if net.held[k] else flow / conductance
            for end in net.ends[net.first[k] : net.first[k + 1]]:
                w, z = arriving(net, end, u, y)
                j, place, sign = end // 2, net.reaches[end // 2] * (end % 2), 2.0 * (end % 2) - 1.0
                new_u[j, place], new_y[j, place] = effort[k], sign * (w - effort[k]) / z
        u, y, new_u, new_y = new_u, new_y, u, y
        record[:, step] = effort[seen]


@njit(cache=True, error_model="numpy")
def arriving(net, end, u, y):
    """What comes to an end of a line: an effort behind an impedance."""
    j, place, sign = end // 2, (net.reaches[end // 2] - 1) * (end % 2) + 1 - end % 2, 2.0 * (end % 2) - 1.0
    before = y[j, place]
    return u[j, place] + sign * net.z0[j] * before, net.z0[j] + net.friction[j] * abs(before)


@njit(cache=True, error_model="numpy")
def inside(u, y, new_u, new_y, reaches, z0, friction):
    """The points of a line between its ends."""
    for i in range(1, reaches):
        before, after = y[i - 1], y[i + 1]
        z_plus, z_minus = z0 + friction * abs(before), z0 + friction * abs(after)
        plus, minus = u[i - 1] + z0 * before, u[i + 1] - z0 * after
        flow = (plus - minus) / (z_plus + z_minus)
        new_y[i], new_u[i] = flow, plus - z_plus * flow


def no_friction(scene: Scene) -> str | None:
    """Why a grid is of no use for a scene, or cannot do it; None if it can."""
    for name, load in scene.loads.items():
        if isinstance(load, Rational):
            return f"{place('loads', name)}: has a state"
    frictionless = all(line.losses is None or line.losses.linear for line in scene.single_lines.values())
    return "without friction it is the same as without a grid" if frictionless else None
