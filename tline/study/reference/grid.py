"""Pipes with quadratic friction on a staggered grid of characteristics, friction by the trapezoidal rule.

Points at whole steps alternate with points half a reach and half a step from them. A front that starts at a node runs
from point to point; there each wave has two values, one before the front in it and one behind, so that none is smeared.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.compiled.structure import Flags, Floats, Floats2, Floats3, Integers, pack
from tline.compiled.unit import function, unit_of_long_loops

ROUNDS = 60  # of Newton's method for the steady state
LAST_STEP = 1e-9  # a step of Newton's method at a node, relative to the arriving wave; the error left is its square


class Pipes(NamedTuple):
    """Pipes as arrays; end 2j is end 1 of line j, end 2j + 1 its end 2."""

    first: Integers  # (nodes + 1,) the ends at node k are ends[first[k]:first[k + 1]]
    ends: Integers
    held: Flags  # (nodes,) whether the effort is prescribed there
    conductance: Floats  # (nodes,) to earth
    z0: Floats  # (lines,)
    lost: Floats  # (lines,) K of a drop K |y| y over the line


def joined(node: list[int], held: NDArray, conductance: NDArray, z0: NDArray, lost: NDArray) -> Pipes:
    """Build pipes from the number of the node at each end."""
    first = np.cumsum([0, *np.bincount(node, minlength=len(held))])
    return Pipes(first, np.argsort(node, kind="stable"), held, conductance, z0, lost)


def steady(pipes: Pipes, given: NDArray) -> tuple[NDArray, NDArray]:
    """Effort of each node and flow of each line, from end 1 to end 2, for given efforts or flows into the nodes.

    Newton's method on all drops and balances at once.
    """
    nodes, lines = len(given), len(pipes.z0)
    node = np.empty(2 * lines, int)
    node[pipes.ends] = np.repeat(np.arange(nodes), np.diff(pipes.first))
    incidence = np.zeros((nodes, lines))  # contribution of a flow to a node
    incidence[node[::2], np.arange(lines)] -= 1
    incidence[node[1::2], np.arange(lines)] += 1
    scale = pipes.z0.mean()  # of efforts, so that all unknowns are flows
    balances, ties = np.where(pipes.held[:, None], 0.0, incidence), np.diag(pipes.held.astype(float))
    wanted = np.where(pipes.held, given / scale, -given)
    found = np.full(lines + nodes, np.abs(given[~pipes.held]).sum())
    for _ in range(ROUNDS):
        y = found[:lines]
        slope = pipes.lost * np.abs(y) / scale
        matrix = np.block([[np.diag(-2 * slope), -incidence.T], [balances, ties]])
        found = np.linalg.solve(matrix, np.concatenate([-slope * y, wanted]))
    return scale * found[lines:], found[:lines]


class GridState(NamedTuple):
    """Pipes in reaches, and the waves that leave their points, each before and behind its front.

    A wave leaves with what friction takes of it along the first half of its way to the next point.
    """

    pipes: Pipes
    reaches: Integers  # (lines,)
    given: Floats3  # (nodes, steps + 1, 2) efforts where they are prescribed, else flows into the nodes
    seen: Integers  # (rows,) nodes that are recorded
    record: Floats3  # (rows, steps + 1, 2)
    effort: Floats2  # (nodes, 2)
    a: Floats3  # (lines, points, 2) toward end 2, from points at whole steps
    b: Floats3  # toward end 1
    a_half: Floats3  # from points between them
    b_half: Floats3


def march(
    pipes: Pipes, reaches: NDArray, effort: NDArray, flow: NDArray, given: NDArray, seen: NDArray
) -> NDArray[np.float64]:
    """Efforts at some nodes at all steps, before and behind fronts, (rows, steps + 1, 2), from a steady state."""
    record, waves = np.zeros((len(seen), *given.shape[1:])), np.zeros((4, len(reaches), max(reaches) + 1, 2))
    at_end = np.empty(2 * len(reaches))
    at_end[pipes.ends] = np.repeat(effort, np.diff(pipes.first))
    for j, n in enumerate(reaches):
        u = at_end[2 * j] + (at_end[2 * j + 1] - at_end[2 * j]) / n * (np.arange(n) + 0.5)
        forward = pipes.z0[j] * flow[j] - pipes.lost[j] / n / 4 * abs(flow[j]) * flow[j]
        waves[2, j, :n], waves[3, j, :n] = (u + forward)[:, None], (u - forward)[:, None]
    march_on(pack(GridState(pipes, reaches, given, seen, record, np.repeat(effort[:, None], 2, axis=1), *waves)))
    return record


@unit_of_long_loops
def march_on(state: GridState) -> int:
    """Advance all points, step by step."""
    pipes, reaches, a, b = state.pipes, state.reaches, state.a, state.b
    for step in range(state.given.shape[1]):
        for j in range(reaches.size):
            n, z0, K = reaches[j], pipes.z0[j], pipes.lost[j] / reaches[j] / 2
            cross(state.a_half[j], state.b_half[j], a[j], b[j], n - 1, 1, z0, K)
        for k in range(state.effort.shape[0]):
            at_node(state, k, step)
        for row in range(state.seen.size):
            state.record[row, step, 0] = state.effort[state.seen[row], 0]
            state.record[row, step, 1] = state.effort[state.seen[row], 1]
        for j in range(reaches.size):
            n, z0, K = reaches[j], pipes.z0[j], pipes.lost[j] / reaches[j] / 2
            cross(a[j], b[j], state.a_half[j], state.b_half[j], n, 0, z0, K)
    return 0


@function
def cross(a, b, next_a, next_b, points, shift, z0, K):
    """Let the waves of neighbouring points meet in the points between them, half a reach further: K |y| y is lost."""
    for i in range(points):
        w, v = a[i, 0], b[i + 1, 0]
        y = flow_of(w - v, z0, K)
        lost = K / 2 * abs(y) * y
        w, v = w - lost, v + lost
        next_a[i + shift, 0] = next_a[i + shift, 1] = w - lost
        next_b[i + shift, 0] = next_b[i + shift, 1] = v + lost
        if a[i, 1] != a[i, 0] or b[i + 1, 1] != b[i + 1, 0]:  # behind a front there is another value of its wave
            behind_w = v + 2 * z0 * flow_of(a[i, 1] - v, z0, K / 2) if a[i, 1] != a[i, 0] else w
            behind_v = w - 2 * z0 * flow_of(w - b[i + 1, 1], z0, K / 2) if b[i + 1, 1] != b[i + 1, 0] else v
            next_a[i + shift, 0] = w - halved(w - behind_v, z0, K)
            next_a[i + shift, 1] = behind_w - halved(behind_w - behind_v, z0, K)
            next_b[i + shift, 0] = v + halved(behind_w - v, z0, K)
            next_b[i + shift, 1] = behind_v + halved(behind_w - behind_v, z0, K)


@function
def flow_of(w, z0, K):
    """Flow at which 2 z0 y + K |y| y is w."""
    return w / (z0 + np.sqrt(z0**2 + K * abs(w)))


@function
def halved(w, z0, K):
    """Half of the loss at the flow w/(2 z0)."""
    return K / 8 * abs(w) * w / z0**2


@function
def at_node(state, k, step):
    """Balance the flows into a node, before and behind a front that is there, and send the waves from it."""
    pipes, effort = state.pipes, state.effort
    two = state.given[k, step, 0] != state.given[k, step, 1]
    for i in range(pipes.first[k], pipes.first[k + 1]):
        two = two or wave_at(state, pipes.ends[i], 0) != wave_at(state, pipes.ends[i], 1)
    effort[k, 0] = balanced(state, k, step, 0, effort[k, 1])
    effort[k, 1] = balanced(state, k, step, 1, effort[k, 0]) if two else effort[k, 0]
    for i in range(pipes.first[k], pipes.first[k + 1]):
        end, leaving = pipes.ends[i], state.b if pipes.ends[i] % 2 else state.a
        j, place = end // 2, state.reaches[end // 2] * (end % 2)
        z0, K = pipes.z0[j], pipes.lost[j] / state.reaches[j] / 2
        into = flow_of(2 * (wave_at(state, end, 0) - effort[k, 0]), z0, K)
        between = flow_between(state, end, effort[k, 0]) if two else into
        leaving[j, place, 0] = leaving[j, place, 1] = effort[k, 0] - z0 * into + K / 2 * abs(between) * between
        if two:
            into, _ = flow_into(state, end, effort[k, 1], effort[k, 0], 1)
            leaving[j, place, 1] = effort[k, 1] - z0 * into + K / 2 * abs(into) * into


@function
def wave_at(state, end, side):
    """Wave that arrives at an end of a line: effort + z0 flow + K/2 |flow| flow, the flow out of the line."""
    j = end // 2
    return state.a_half[j, state.reaches[j] - 1, side] if end % 2 else state.b_half[j, 0, side]


@function
def flow_between(state, end, before):
    """Flow out of an end of a line between a front that arrives and the one that leaves, at an effort before both."""
    z0, K = state.pipes.z0[end // 2], state.pipes.lost[end // 2] / state.reaches[end // 2] / 2
    sent = before - z0 * flow_of(2 * (wave_at(state, end, 0) - before), z0, K)
    return flow_of(wave_at(state, end, 1) - sent, z0, K / 2)


@function
def flow_into(state, end, u, before, side):
    """Flow out of an end of a line at an effort there, and its decrease per effort; behind fronts for side 1."""
    z0, K = state.pipes.z0[end // 2], state.pipes.lost[end // 2] / state.reaches[end // 2] / 2
    flow = flow_of(2 * (wave_at(state, end, 0) - (before if side else u)), z0, K)
    if side:  # the wave that arrives has lost what it does between the fronts
        return (before - u) / z0 - flow + 2 * flow_between(state, end, before), 1 / z0
    return flow, 1 / (z0 + K * abs(flow))


@function
def balanced(state, k, step, side, effort):
    """Effort of a node at which the flows into it balance, by Newton's method from another."""
    pipes, before = state.pipes, state.effort[k, 0]
    if pipes.held[k]:
        return state.given[k, step, side]
    for _ in range(50):
        flow, slope, size = state.given[k, step, side] - pipes.conductance[k] * effort, pipes.conductance[k], 0.0
        for i in range(pipes.first[k], pipes.first[k + 1]):
            into, falls = flow_into(state, pipes.ends[i], effort, before, side)
            flow, slope = flow + into, slope + falls
            size += abs(wave_at(state, pipes.ends[i], side))
        effort += flow / slope
        if abs(flow / slope) <= LAST_STEP * size:
            break
    return effort
