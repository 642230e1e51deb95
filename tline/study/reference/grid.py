"""Pipes with quadratic friction as arrays: their steady state, and characteristics from point to point of a grid."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.compiled.structure import Floats, Floats2, Integers, pack
from tline.compiled.unit import function, unit

ROUNDS = 60  # of Newton's method for the steady state
LAST_STEP = 1e-9  # a step of Newton's method at a node, relative to the arriving wave; the error left is its square


class Pipes(NamedTuple):
    """Pipes as arrays; end 2j is end 1 of line j, end 2j + 1 its end 2."""

    first: Integers  # (nodes + 1,) the ends at node k are ends[first[k]:first[k + 1]]
    ends: Integers
    held: Floats  # (nodes,) the effort there; nan where none is held
    z0: Floats  # (lines,)
    lost: Floats  # (lines,) K of a drop K |y| y over the line


def joined(node: list[int], nodes: int, held: NDArray, z0: NDArray, lost: NDArray) -> Pipes:
    """Build pipes from the number of the node at each end."""
    first = np.cumsum([0, *np.bincount(node, minlength=nodes)])
    return Pipes(first, np.argsort(node, kind="stable"), held, z0, lost)


def steady(pipes: Pipes, given: NDArray) -> tuple[NDArray, NDArray]:
    """Effort of each node and flow of each line, from end 1 to end 2, for given flows into the nodes.

    Newton's method on all drops and balances at once.
    """
    nodes, lines = len(given), len(pipes.z0)
    node = np.empty(2 * lines, int)
    node[pipes.ends] = np.repeat(np.arange(nodes), np.diff(pipes.first))
    incidence = np.zeros((nodes, lines))  # contribution of a flow to a node
    incidence[node[::2], np.arange(lines)] -= 1
    incidence[node[1::2], np.arange(lines)] += 1
    fixed = ~np.isnan(pipes.held)
    scale = pipes.z0.mean()  # of efforts, so that all unknowns are flows
    balances, ties = np.where(fixed[:, None], 0.0, incidence), np.diag(fixed.astype(float))
    wanted = np.where(fixed, pipes.held / scale, -given)
    found = np.full(lines + nodes, np.abs(given).sum())
    for _ in range(ROUNDS):
        y = found[:lines]
        slope = pipes.lost * np.abs(y) / scale
        matrix = np.block([[np.diag(-2 * slope), -incidence.T], [balances, ties]])
        found = np.linalg.solve(matrix, np.concatenate([-slope * y, wanted]))
    return scale * found[lines:], found[:lines]


class GridState(NamedTuple):
    """Pipes in reaches, and the values at their points."""

    pipes: Pipes
    reaches: Integers  # (lines,)
    given: Floats2  # (nodes, steps + 1) flows into the nodes
    seen: Integers  # (rows,) nodes that are recorded
    record: Floats2  # (rows, steps + 1)
    effort: Floats  # (nodes,)
    u: Floats2  # (lines, points)
    y: Floats2
    plus: Floats2  # wave toward end 2
    minus: Floats2


def march(
    pipes: Pipes, reaches: NDArray, effort: NDArray, flow: NDArray, given: NDArray, seen: NDArray
) -> NDArray[np.float64]:
    """Efforts at some nodes at all steps, from a steady state, for given flows into the nodes."""
    record, (u, y, plus, minus) = np.zeros((len(seen), given.shape[1])), np.zeros((4, len(reaches), max(reaches) + 1))
    at_end = np.empty(2 * len(reaches))
    at_end[pipes.ends] = np.repeat(effort, np.diff(pipes.first))
    for j, n in enumerate(reaches):
        u[j, : n + 1] = at_end[2 * j] + (at_end[2 * j + 1] - at_end[2 * j]) / n * np.arange(n + 1)
        y[j, : n + 1] = flow[j]
    record[:, 0] = effort[seen]
    march_on(pack(GridState(pipes, reaches, given, seen, record, effort.copy(), u, y, plus, minus)))
    return record


@unit
def march_on(state: GridState) -> int:
    """Advance all points, step by step."""
    pipes, reaches, effort = state.pipes, state.reaches, state.effort
    u, y, plus, minus = state.u, state.y, state.plus, state.minus
    for step in range(1, state.given.shape[1]):
        for j in range(reaches.size):
            inside(u[j], y[j], plus[j], minus[j], reaches[j], pipes.z0[j], pipes.lost[j] / reaches[j])
        for k in range(effort.size):
            at_node(pipes, reaches, k, effort, state.given[k, step], plus, minus)
            for i in range(pipes.first[k], pipes.first[k + 1]):
                end = pipes.ends[i]
                into, _, _ = arriving(pipes, reaches, end, effort[k], plus, minus)
                j, sign = end // 2, 2.0 * (end % 2) - 1.0
                u[j, reaches[j] * (end % 2)], y[j, reaches[j] * (end % 2)] = effort[k], sign * into
        for row in range(state.seen.size):
            state.record[row, step] = effort[state.seen[row]]
    return 0


@function
def inside(u, y, plus, minus, n, z0, K):
    """Advance the points between the ends of a line by one step; the travelling waves are left in plus and minus."""
    for i in range(n + 1):
        half = K / 2 * abs(y[i]) * y[i]
        plus[i], minus[i] = u[i] + z0 * y[i] - half, u[i] - z0 * y[i] + half
    for i in range(1, n):
        w = plus[i - 1] - minus[i + 1]  # 2 z0 y + K |y| y
        y[i] = w / (z0 + np.sqrt(z0**2 + K * abs(w)))
        u[i] = (plus[i - 1] + minus[i + 1]) / 2


@function
def arriving(pipes, reaches, end, effort, plus, minus):
    """Flow out of an end of a line at an effort there, its decrease per effort, and the arriving wave."""
    j = end // 2
    w = plus[j, reaches[j] - 1] if end % 2 else minus[j, 1]  # effort + z0 flow + K/2 |flow| flow
    z0, K = pipes.z0[j], pipes.lost[j] / reaches[j]
    flow = 2 * (w - effort) / (z0 + np.sqrt(z0**2 + 2 * K * abs(w - effort)))
    return flow, 1 / (z0 + K * abs(flow)), w


@function
def at_node(pipes, reaches, k, effort, given, plus, minus):
    """Solve for the effort at which the flows into a node balance, by Newton's method from the previous effort."""
    if not np.isnan(pipes.held[k]):
        return
    for _ in range(50):
        flow, slope, size = given, 0.0, 0.0
        for i in range(pipes.first[k], pipes.first[k + 1]):
            into, falls, w = arriving(pipes, reaches, pipes.ends[i], effort[k], plus, minus)
            flow, slope, size = flow + into, slope + falls, size + abs(w)
        effort[k] += flow / slope
        if abs(flow / slope) <= LAST_STEP * size:
            return
