"""Loads and switches: each such node's map over a slab, and the instants from which on it is another one."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.load_step import LoadStep, StateSpace, load_step
from tline.solver.nodes import Node
from tline.solver.radau import Basis


class NodeMaps(NamedTuple):
    """All maps of a scene, padded to one size."""

    load_row: NDArray  # (nodes,) row of the node's state, -1 for an algebraic node
    step_row: NDArray  # (nodes,) row of its first map, -1 for an algebraic node
    steps: NDArray  # (maps, s + n, s + n) from (Thévenin wave, state) to (effort, next state)
    states: NDArray  # (loads, n) at the start
    systems: list[StateSpace]  # of each map, from the Thévenin wave to the effort
    changes: list[tuple[float, int, int]]  # (instant in slabs, node, row in steps), sorted


def node_maps(nodes: dict[str, Node], order: Basis, h: float, thevenin: NDArray) -> NodeMaps:
    """Maps of all nodes with loads or switches, at rest under the given Thévenin waves, shape (nodes,)."""
    load_row, step_row = np.full(len(nodes), -1), np.full(len(nodes), -1)
    systems: list[StateSpace] = []
    states: list[NDArray] = []
    changes: list[tuple[float, int, int]] = []
    for k, node in enumerate(nodes.values()):
        if node.held is not None or (node.load is None and not node.switches):
            continue
        load_row[k], step_row[k] = len(states), len(systems)
        states.append(node.effort(node.switched(0.0)).at_rest_under(thevenin[k]))
        times = sorted({float(switch.time) for switch in node.switches if switch.time >= 0})
        changes += [(time / h, k, len(systems) + 1 + j) for j, time in enumerate(times)]
        systems += [node.effort(node.switched(time)) for time in (*times, np.inf)]
    steps, padded = _padded([load_step(system, order, h) for system in systems], states, order.s)
    return NodeMaps(load_row, step_row, steps, padded, systems, sorted(changes))


def _padded(maps: list[LoadStep], states: list[NDArray], s: int) -> tuple[NDArray, NDArray]:
    n = max((len(state) for state in states), default=0)
    steps = np.zeros((len(maps), s + n, s + n))
    for row, step in enumerate(maps):
        m = step.x_x.shape[0]
        steps[row, :s, : s + m] = np.hstack([step.u_w, step.u_x])
        steps[row, s : s + m, : s + m] = np.hstack([step.x_w, step.x_x])
    return steps, np.array([np.pad(state, (0, n - len(state))) for state in states]).reshape(len(states), n)
