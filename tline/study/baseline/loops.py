"""Compiled loops of the baseline methods that step in time."""

from typing import NamedTuple

import numpy as np

from tline.compiled.structure import Flags, Floats, Floats2, Floats3, Integers, pack
from tline.compiled.unit import function, unit_of_long_loops
from tline.solver.kernel.arithmetic import TINY


class BaselineSignals(NamedTuple):
    """Arrays over the steps of a loop."""

    drive: Floats2  # (nodes, steps + 1) output of the sources
    seen: Integers  # (rows,) nodes whose efforts are recorded
    record: Floats2  # (rows, steps + 1)


@function
def put(signals, u, step):
    """Record efforts of nodes."""
    for row in range(signals.seen.size):
        signals.record[row, step] = u[signals.seen[row]]


class NodeScattering(NamedTuple):
    """Nodes as arrays, mapping the waves that arrive at line ends to those sent back; m states per load."""

    first: Integers  # (nodes + 1,) the ends at node k are ends[first[k]:first[k + 1]]
    ends: Integers
    weight: Floats  # (ends,) share in the Thévenin wave w
    row: Integers  # (nodes,) of its load, -1 for none
    x_x: Floats3  # (loads, m, m)
    x_before: Floats2  # (loads, m)
    x_now: Floats2  # (loads, m)
    u_x: Floats2  # (loads, m)
    u_w: Floats  # (loads,)


class NodeState(NamedTuple):
    """State of nodes and line ends at an instant."""

    w: Floats  # (nodes,)
    u: Floats  # (nodes,)
    x: Floats2  # (loads, m)
    new: Floats  # (m,)
    arriving: Floats  # (ends,)
    sent: Floats  # (ends,)


def at_rest(net: NodeScattering) -> NodeState:
    """Return the state at rest."""
    nodes, ends, m = len(net.row), len(net.ends), net.x_x.shape[1]
    return NodeState(np.zeros(nodes), np.zeros(nodes), np.zeros((len(net.x_x), m)), np.zeros(m), *np.zeros((2, ends)))


@function
def scatter(net, now, signals, step):
    """Scatter at all nodes at one instant: update w, x and u, set the waves sent from the ends, and record u."""
    w, x, new, u, arriving, sent = now.w, now.x, now.new, now.u, now.arriving, now.sent
    for k in range(net.row.size):
        wave, r = signals.drive[k, step], net.row[k]
        for j in range(net.first[k], net.first[k + 1]):
            wave += net.weight[j] * arriving[net.ends[j]]
        effort = wave
        if r >= 0:
            effort *= net.u_w[r]
            for i in range(new.size):
                new[i] = net.x_before[r, i] * w[k] + net.x_now[r, i] * wave
                for j in range(new.size):
                    new[i] += net.x_x[r, i, j] * x[r, j]
                effort += net.u_x[r, i] * new[i]
            for i in range(new.size):
                x[r, i] = new[i]
        w[k], u[k] = wave, effort
        for j in range(net.first[k], net.first[k + 1]):
            back = 2.0 * effort - arriving[net.ends[j]]
            sent[net.ends[j]] = 0.0 if abs(back) < TINY else back
    put(signals, u, step)


class Histories(NamedTuple):
    """Lines, with their histories, and nodes."""

    net: NodeScattering
    now: NodeState
    signals: BaselineSignals
    late: Integers  # (lines,) whole steps of the delay
    taps: Floats2  # (lines, 4) weights of the samples 1 step late, on time, 1 and 2 steps early
    history: Floats2  # (ends, zeros + steps + 1)


def advance_moc(net, late, taps, drive, seen, steps, record):
    """Advance a network at rest by a number of steps."""
    history = np.zeros((2 * len(late), steps + 1 + late.max() + 2))
    advance_histories(
        pack(Histories(net, at_rest(net), BaselineSignals(drive, seen, record), late, taps, history)), steps
    )


@unit_of_long_loops
def advance_histories(run: Histories, steps: int) -> int:
    """Read the arriving waves from the histories, scatter them, and store those sent."""
    history, late, taps, now = run.history, run.late, run.taps, run.now
    ends, pad = history.shape[0], history.shape[1] - steps - 1
    for k in range(steps + 1):
        for e in range(ends):
            at = k + pad - late[e // 2]
            arriving = 0.0
            for j in range(4):
                if taps[e // 2, j] != 0.0:
                    arriving += taps[e // 2, j] * history[e ^ 1, at + 1 - j]
            now.arriving[e] = arriving
        scatter(run.net, now, run.signals, k)
        for e in range(ends):
            history[e, k + pad] = now.sent[e]
    return 0


class AdvectedCells(NamedTuple):
    """Lines in cells, and nodes."""

    net: NodeScattering
    now: NodeState
    signals: BaselineSignals
    cells: Integers  # (lines,)
    courant: Floats  # (lines,)
    diffusion: Floats  # (lines,)
    a: Floats2  # (ends, points) waves


def advance_cells(net, cells, courant, diffusion, drive, seen, steps, record):
    """Advance a network at rest by a number of steps."""
    a = np.zeros((2 * len(cells), cells.max() + 1))
    signals = BaselineSignals(drive, seen, record)
    advance_advection(pack(AdvectedCells(net, at_rest(net), signals, cells, courant, diffusion, a)), steps)


@unit_of_long_loops
def advance_advection(run: AdvectedCells, steps: int) -> int:
    """Carry waves from cell to cell, and scatter the arriving ones."""
    a, arriving, sent = run.a, run.now.arriving, run.now.sent
    ends = a.shape[0]
    for k in range(steps + 1):
        for e in range(ends if k else 0):
            last, C, d = run.cells[e // 2], run.courant[e // 2], run.diffusion[e // 2]
            before, arriving[e ^ 1] = a[e, 0], a[e, last] - C * (a[e, last] - a[e, last - 1])
            for i in range(1, last):
                now, after = a[e, i], a[e, i + 1]
                a[e, i] = now - C / 2 * (after - before) + d * (after - 2 * now + before)
                before = now
            a[e, last] = arriving[e ^ 1]
        scatter(run.net, run.now, run.signals, k)
        for e in range(ends):
            a[e, 0] = sent[e]
    return 0


class Staggered(NamedTuple):
    """Lines on staggered grids, and nodes."""

    cells: Integers  # (lines,)
    courant: Floats  # (lines,)
    z0: Floats  # (lines,)
    at: Integers  # (ends,) node of each line end
    held: Flags  # (nodes,)
    x_x: Floats3  # (nodes, m, m)
    x_i: Floats2  # (nodes, m)
    signals: BaselineSignals
    u: Floats2  # (lines, edges)
    y: Floats2  # (lines, cells)
    x: Floats2  # (nodes, m)
    new: Floats  # (m,)
    effort: Floats  # (nodes,)
    flow: Floats  # (nodes,)


def advance_fdtd(cells, courant, z0, at, held, x_x, x_i, drive, seen, steps, record):
    """Advance a network at rest by a number of steps."""
    lines, nodes, m, most = len(cells), len(held), x_x.shape[1], cells.max()
    work = np.zeros((lines, most + 1)), np.zeros((lines, most)), np.zeros((nodes, m)), np.zeros(m)
    signals, at = BaselineSignals(drive, seen, record), np.array(at, np.int64)
    run = Staggered(cells, courant, z0, at, held, x_x, x_i, signals, *work, np.zeros(nodes), np.zeros(nodes))
    advance_staggered(pack(run), steps)


@unit_of_long_loops
def advance_staggered(run: Staggered, steps: int) -> int:
    """Leap from flows to efforts, along the lines and at the nodes."""
    cells, courant, z0, at, u, y, x, new = run.cells, run.courant, run.z0, run.at, run.u, run.y, run.x, run.new
    effort, flow, drive, m = run.effort, run.flow, run.signals.drive, run.new.size
    for k in range(steps + 1):
        for node in range(flow.size):
            flow[node] = (drive[node, k] + drive[node, max(k - 1, 0)]) / 2
        for j in range(cells.size if k else 0):
            n = cells[j]
            for i in range(n):
                y[j, i] -= courant[j] * (u[j, i + 1] - u[j, i])
            for i in range(1, n):
                u[j, i] -= courant[j] * (y[j, i] - y[j, i - 1])
            flow[at[2 * j]] -= y[j, 0] / z0[j]
            flow[at[2 * j + 1]] += y[j, n - 1] / z0[j]
        for node in range(flow.size):
            if k:
                for i in range(m):
                    new[i] = run.x_i[node, i] * flow[node]
                    for j in range(m):
                        new[i] += run.x_x[node, i, j] * x[node, j]
                for i in range(m):
                    x[node, i] = new[i]
            effort[node] = drive[node, k] if run.held[node] else x[node, 0]
        for j in range(cells.size):
            u[j, 0], u[j, cells[j]] = effort[at[2 * j]], effort[at[2 * j + 1]]
        put(run.signals, effort, k)
    return 0
