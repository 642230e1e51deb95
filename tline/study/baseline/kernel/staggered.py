"""Efforts u of each line at cell edges, flows y (times z0) between; x are the states of the nodes."""

from typing import NamedTuple

import numpy as np

from tline.compiled.structure import Flags, Floats, Floats2, Floats3, Integers, pack
from tline.compiled.unit import unit
from tline.study.baseline.kernel.signals import BaselineSignals, put


class Staggered(NamedTuple):
    """Lines and nodes."""

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
    """Advance a network at rest by so many steps."""
    lines, nodes, m, most = len(cells), len(held), x_x.shape[1], cells.max()
    work = np.zeros((lines, most + 1)), np.zeros((lines, most)), np.zeros((nodes, m)), np.zeros(m)
    signals, at = BaselineSignals(drive, seen, record), np.array(at, np.int64)
    run = Staggered(cells, courant, z0, at, held, x_x, x_i, signals, *work, np.zeros(nodes), np.zeros(nodes))
    advance_staggered(pack(run), steps)


@unit
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
