"""Groups of nodes that linear multiports join.

To a node's own wave and load the flow i into multiports is another driven flow: with g its conductance the wave becomes
w - i/g. Where nothing conducts, a reference stands for g, and the node gets back its own effort: w - i/g + u. With what
binds efforts and flows in the multiports, M u + N i = E x, that is one linear system; their states x follow.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.solver.description.given import Ports
from tline.solver.description.load_step import NO_LOAD, StateSpace, side_by_side
from tline.solver.description.nodes import Node

SINGULAR = 1e-13  # reciprocal condition number


class PlacedPorts(NamedTuple):
    """A multiport: its place in the scene, its nodes, and its equations."""

    where: str
    nodes: Sequence[str]
    ports: Ports


class PortPlaces(NamedTuple):
    """The same in a group: with its nodes' places there."""

    where: str
    nodes: NDArray
    ports: Ports


def counted_from(levels: NDArray, ports: Ports) -> Ports:
    """Equations whose efforts count from levels, shape (k,); their last state is then 1 and nothing moves it."""
    if not levels.any():
        return ports
    M, N, E, Q, P, R = ports
    none = np.zeros((1, len(M)))
    Q = np.block([[Q, -(P @ levels)[:, None]], [np.zeros((1, len(Q) + 1))]])
    return Ports(M, N, np.hstack([E, (M @ levels)[:, None]]), Q, np.vstack([P, none]), np.vstack([R, none]))


def with_multiports(nodes: Sequence[Node], multiports: Sequence[PortPlaces]) -> StateSpace:
    """State space of a group with multiports, from the nodes' Thévenin waves to their efforts.

    Raises
    ------
    InputError
        The efforts do not follow: two of them are prescribed at once, or none.
    """
    k, held = len(nodes), np.array([node.held is not None for node in nodes])
    heights = np.array([node.above_level for node in nodes])
    everywhere = [counted_from(heights[part.nodes], part.ports) for part in multiports]
    states = [ports.E.shape[1] for ports in everywhere]
    loads = [NO_LOAD if node.held is not None else node.response(0.0) for node in nodes]
    A, B, C, D = side_by_side(loads, sum(states))
    own = np.diag([float(node.held is None and (node.dead or node.floating)) for node in nodes])
    unit = np.mean([node.total for node in nodes])  # of flows, so that both unknowns are of one size
    per_flow = np.diag([0.0 if fixed else unit / node.total for node, fixed in zip(nodes, held, strict=True)])
    flows = sum(len(part.nodes) for part in multiports)
    into = np.zeros((k, flows))  # from flows to the nodes' sums of them
    bound, given = np.zeros((flows, k + flows)), np.zeros((flows, len(A)))
    driven = np.zeros((len(A), k + flows))
    row, state = 0, len(A) - sum(states)
    for part, ports, n in zip(multiports, everywhere, states, strict=True):
        rows, those = slice(row, row + len(part.nodes)), slice(state, state + n)
        into[part.nodes, np.arange(rows.start, rows.stop)] = 1.0
        M, N, E, Q, P, R = ports
        size = np.maximum(np.abs(M).max(axis=1), np.abs(N).max(axis=1) * unit)[:, None]
        bound[rows, part.nodes], bound[rows, k + row : k + rows.stop] = M / size, N * unit / size
        given[rows, those], A[those, those] = E / size, Q
        driven[those, part.nodes], driven[those, k + row : k + rows.stop] = P, R * unit
        row, state = rows.stop, those.stop
    whole = np.block([[np.eye(k) - D @ own, D @ per_flow @ into], [bound[:, :k], bound[:, k:]]])
    if 1 / np.linalg.cond(whole) < SINGULAR:
        where = " and ".join(part.where for part in multiports)
        raise InputError(where, "no efforts and flows follow from what is at its nodes", "a resistance in between")
    x, w = np.linalg.solve(whole, np.vstack([C, given])), np.linalg.solve(whole, np.vstack([D, np.zeros((flows, k))]))
    rates = B @ np.hstack([own, -per_flow @ into]) + driven  # from efforts and flows, through the nodes' waves too
    return StateSpace(A + rates @ x, B + rates @ w, x[:k], w[:k])
