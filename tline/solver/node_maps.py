"""Loads and switches: each such node's map over a slab, and the slabs from which on it is another one."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.drive import EDGE
from tline.solver.load_step import LoadStep, stepwise
from tline.solver.nodes import Node
from tline.solver.radau import Basis


class NodeMaps(NamedTuple):
    """All maps of a scene, padded to one size."""

    load_row: NDArray  # (nodes,) row of the node's state, -1 for an algebraic node
    steps: NDArray  # (maps, s + n, s + n) from (Thévenin wave, state) to (effort, next state)
    states: NDArray  # (loads, n) at the start
    changes: list[tuple[int, int, int]]  # (slab from which on, node, row in steps), sorted; every map has its first


def node_maps(nodes: dict[str, Node], order: Basis, h: float, thevenin: NDArray) -> NodeMaps:
    """Maps of all nodes with loads or switches, at rest under the given Thévenin waves, shape (nodes,)."""
    rows = np.full(len(nodes), -1)
    maps: list[LoadStep] = []
    states: list[NDArray] = []
    changes: list[tuple[int, int, int]] = []
    for k, node in enumerate(nodes.values()):
        if node.held is not None or (node.load is None and not node.switches):
            continue
        rows[k] = len(states)
        states.append(node.effort(node.switched(0.0)).at_rest_under(thevenin[k]))
        for slab, pieces in _slabs_of(node, h):
            changes.append((slab, k, len(maps)))
            maps.append(stepwise([(p, q, node.effort(g)) for p, q, g in pieces], order, h))
    return NodeMaps(rows, *_padded(maps, states, order.s), sorted(changes))


def _padded(maps: list[LoadStep], states: list[NDArray], s: int) -> tuple[NDArray, NDArray]:
    n = max((len(state) for state in states), default=0)
    steps = np.zeros((len(maps), s + n, s + n))
    for row, step in enumerate(maps):
        m = step.x_x.shape[0]
        steps[row, :s, : s + m] = np.hstack([step.u_w, step.u_x])
        steps[row, s : s + m, : s + m] = np.hstack([step.x_w, step.x_x])
    return steps, np.array([np.pad(state, (0, n - len(state))) for state in states]).reshape(len(states), n)


def _slabs_of(node: Node, h: float) -> list[tuple[int, list[tuple[float, float, float]]]]:
    """Where the node's map changes: (slab, pieces (start, end, switched conductance) in slab time)."""
    times = sorted({float(switch.time) for switch in node.switches if switch.time > 0})
    changes: dict[int, list[tuple[float, float, float]]] = {
        0: [(0.0, 1.0, node.switched(times[0] if times else np.inf))]
    }
    for k, time in enumerate(times):
        after = node.switched(times[k + 1] if k + 1 < len(times) else np.inf)
        slab, place = int(time / h), time / h - int(time / h)
        if place > 1 - EDGE:
            slab, place = slab + 1, 0.0
        if place < EDGE:
            changes[slab] = [(0.0, 1.0, after)]
            continue
        pieces = changes.get(slab) or [(0.0, 1.0, node.switched(time))]
        start, _, g = pieces[-1]
        changes[slab] = [*pieces[:-1], (start, place, g), (place, 1.0, after)]
        changes[slab + 1] = [(0.0, 1.0, after)]
    return sorted(changes.items())
