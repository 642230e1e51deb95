"""The wave sent from each end on a grid of its own, whose last point arrives at the other end."""

from typing import NamedTuple

import numpy as np

from tline.compiled.structure import Floats, Floats2, Integers, pack
from tline.compiled.unit import unit
from tline.study.baseline.kernel.nodes import NodeScattering, NodeState, at_rest, scatter
from tline.study.baseline.kernel.signals import BaselineSignals


class AdvectedCells(NamedTuple):
    """Lines and nodes."""

    net: NodeScattering
    now: NodeState
    signals: BaselineSignals
    cells: Integers  # (lines,)
    courant: Floats  # (lines,)
    diffusion: Floats  # (lines,)
    a: Floats2  # (ends, points) waves


def advance_cells(net, cells, courant, diffusion, drive, seen, steps, record):
    """Advance a network at rest by so many steps."""
    a = np.zeros((2 * len(cells), cells.max() + 1))
    signals = BaselineSignals(drive, seen, record)
    advance_advection(pack(AdvectedCells(net, at_rest(net), signals, cells, courant, diffusion, a)), steps)


@unit
def advance_advection(run: AdvectedCells, steps: int) -> int:
    """Carry waves from cell to cell, and scatter what arrives."""
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
