"""Effort u and flow y on all points of all lines, by characteristics from point to point."""

from typing import NamedTuple

import numpy as np

from tline.compiled.structure import Flags, Floats, Floats3, Integers, pack
from tline.compiled.unit import function, unit
from tline.study.baseline.kernel.signals import BaselineSignals, put


class Grid(NamedTuple):
    """Lines in reaches and nodes that hold an effort or conduct, as arrays."""

    first: Integers  # (nodes + 1,) the ends at node k are ends[first[k]:first[k + 1]]
    ends: Integers
    held: Flags  # (nodes,)
    conductance: Floats  # (nodes,)
    reaches: Integers  # (lines,)
    z0: Floats  # (lines,)
    friction: Floats  # (lines,) K of a drop K |y| y over a reach


class GridPoints(NamedTuple):
    """A grid and what is on it, at this step and the next by turns."""

    net: Grid
    signals: BaselineSignals
    effort: Floats  # (nodes,)
    u: Floats3  # (2, lines, points)
    y: Floats3  # (2, lines, points)


def advance_grid(net, ends, flows, drive, seen, steps, record):
    """Advance by so many steps a grid that begins on straight lines between the efforts at the ends, (lines, 2)."""
    lines, most = len(net.reaches), net.reaches.max() + 1
    u, y, effort = np.zeros((2, lines, most)), np.zeros((2, lines, most)), ends.ravel()[net.ends[net.first[:-1]]]
    for j, last in enumerate(net.reaches):
        u[0, j, : last + 1] = ends[j, 0] + (ends[j, 1] - ends[j, 0]) / last * np.arange(last + 1)
        y[0, j, : last + 1] = flows[j]
    record[:, 0] = effort[seen]
    advance_points(pack(GridPoints(net, BaselineSignals(drive, seen, record), effort, u, y)), steps)


@unit
def advance_points(run: GridPoints, steps: int) -> int:
    """Go from point to point along the lines, and to the nodes."""
    net, effort, drive = run.net, run.effort, run.signals.drive
    for step in range(1, steps + 1):
        u, y, new_u, new_y = run.u[(step + 1) % 2], run.y[(step + 1) % 2], run.u[step % 2], run.y[step % 2]
        for j in range(net.reaches.size):
            inside(u[j], y[j], new_u[j], new_y[j], net.reaches[j], net.z0[j], net.friction[j])
        for k in range(effort.size):
            flow, conductance = drive[k, step], net.conductance[k]
            for i in range(net.first[k], net.first[k + 1]):
                w, z = arriving(net, net.ends[i], u, y)
                flow, conductance = flow + w / z, conductance + 1 / z
            effort[k] = drive[k, step] if net.held[k] else flow / conductance
            for i in range(net.first[k], net.first[k + 1]):
                end = net.ends[i]
                w, z = arriving(net, end, u, y)
                j, place, sign = end // 2, net.reaches[end // 2] * (end % 2), 2.0 * (end % 2) - 1.0
                new_u[j, place], new_y[j, place] = effort[k], sign * (w - effort[k]) / z
        put(run.signals, effort, step)
    return 0


@function
def arriving(net, end, u, y):
    """What comes to an end of a line: an effort behind an impedance."""
    j, place, sign = end // 2, (net.reaches[end // 2] - 1) * (end % 2) + 1 - end % 2, 2.0 * (end % 2) - 1.0
    before = y[j, place]
    return u[j, place] + sign * net.z0[j] * before, net.z0[j] + net.friction[j] * abs(before)


@function
def inside(u, y, new_u, new_y, reaches, z0, friction):
    """The points of a line between its ends."""
    for i in range(1, reaches):
        before, after = y[i - 1], y[i + 1]
        z_plus, z_minus = z0 + friction * abs(before), z0 + friction * abs(after)
        plus, minus = u[i - 1] + z0 * before, u[i + 1] - z0 * after
        flow = (plus - minus) / (z_plus + z_minus)
        new_y[i], new_u[i] = flow, plus - z_plus * flow
