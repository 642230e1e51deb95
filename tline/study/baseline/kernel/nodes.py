"""Nodes that scatter waves at one instant, with loads whose states are integrated by a rule."""

from typing import NamedTuple

import numpy as np

from tline.compiled.structure import Floats, Floats2, Floats3, Integers
from tline.compiled.unit import function
from tline.study.baseline.kernel.signals import put

TINY = 1e-150  # waves below are flushed to zero, as in the production kernel


class NodeScattering(NamedTuple):
    """Nodes as arrays: from the waves that arrive at their ends to those sent back; m states a load."""

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
    """What is known of nodes and line ends at an instant."""

    w: Floats  # (nodes,)
    u: Floats  # (nodes,)
    x: Floats2  # (loads, m)
    new: Floats  # (m,)
    arriving: Floats  # (ends,)
    sent: Floats  # (ends,)


def at_rest(net: NodeScattering) -> NodeState:
    """Nothing moves."""
    nodes, ends, m = len(net.row), len(net.ends), net.x_x.shape[1]
    return NodeState(np.zeros(nodes), np.zeros(nodes), np.zeros((len(net.x_x), m)), np.zeros(m), *np.zeros((2, ends)))


@function
def scatter(net, now, signals, step):
    """All nodes at one instant: w, x and u are brought up to it, sent is what leaves the ends, and u is recorded."""
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
