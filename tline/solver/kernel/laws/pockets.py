"""Efforts between shut laws, which nothing determines: liquid that nothing reaches keeps its pressure.

Nodes that only laws reach, and that laws without a flow part from all others, are a pocket: at each point of a slab
their efforts may be shifted together, and Newton's method leaves them anywhere. They are brought back to what they were
at the point before, or as near to that as the laws around them stay shut.
"""

import numpy as np

from tline.compiled.unit import function, unit
from tline.solver.kernel.arithmetic import HALVINGS, ROUNDED, largest
from tline.solver.kernel.laws.answers import ask, exchange_states, unbalance
from tline.solver.kernel.network import Run

LEAST = 1e-6  # part of a shift with which laws stay shut; a smaller one is none
OPEN, JOINED, LIMITED, SHUT = 0, 1, 2, 3  # laws around it: one passes flow (and was asked), would if shifted, or none


@function
def inside(work, node, root):
    """Whether a node belongs to a pocket."""
    return node >= 0 and work.part[node] == root


@function
def shut_after(run, g, q, h, e, i, across, faint):
    """Whether nothing passes an element at point i if the wave into it changes by `across`.

    Where an opening ends at the last point of a slab it is there no more than rounding.
    """
    work, o = run.work.circuit, (e - run.network.laws.first[g]) * q
    for j in range(q):
        work.trial[o + j] = work.aimed[o + j] + (across if j == i else 0.0)
    exchange_states(run, g, True)
    ask(run, e, q, h, work.trial, o, work.other)
    return abs(work.other[o + i]) * run.network.laws.source_impedance[e] <= faint


@function
def around(run, g, q, h, i, root, by, faint):
    """Add to a pocket what open laws join to it, and tell what those around it do if it is shifted.

    Only where none around it passes flow are they asked.
    """
    laws, work, low = run.network.laws, run.work.circuit, run.network.group[g]
    asking, asked = False, False
    while True:
        state, grown = SHUT, False
        for e in range(laws.first[g], laws.first[g + 1]):
            one, other = laws.from_node[e], laws.to_node[e]
            here = inside(work, one, root)
            if here == inside(work, other, root):
                continue
            beyond = other if here else one
            flows = abs(work.flow[(e - laws.first[g]) * q + i]) * laws.source_impedance[e] > faint
            if flows == asking or (asking and shut_after(run, g, q, h, e, i, by if here else -by, faint)):
                continue
            if beyond >= 0 and laws.pocket[low + beyond]:
                work.part[beyond], grown = root, True
            elif flows:
                return JOINED if asked else OPEN
            else:
                state = LIMITED
        if asking and not grown:
            return state
        asking = not grown
        asked = asked or asking


@function
def stays_shut(run, g, q, h, i, root, by, faint):
    """Whether all laws around a pocket stay shut if it is shifted."""
    laws, work = run.network.laws, run.work.circuit
    for e in range(laws.first[g], laws.first[g + 1]):
        here = inside(work, laws.from_node[e], root)
        across = by if here else -by
        if here != inside(work, laws.to_node[e], root) and not shut_after(run, g, q, h, e, i, across, faint):
            return False
    return True


@function
def allowed(run, g, q, h, i, root, by, faint):
    """Part of a shift that leaves the laws around a pocket shut; -1 where one passes flow, and none was asked."""
    state = around(run, g, q, h, i, root, by, faint)
    if state != LIMITED:
        return -1.0 if state == OPEN else 0.0 if state == JOINED else 1.0
    if not stays_shut(run, g, q, h, i, root, LEAST * by, faint):
        return 0.0
    low, high = LEAST, 1.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if stays_shut(run, g, q, h, i, root, middle * by, faint):
            low = middle
        else:
            high = middle
    return low


@function
def effort(run, step, place):
    """Effort at a point of a node, whose row of a map begins at `place`."""
    total = 0.0
    for j in range(run.work.circuit.width[0]):
        total += step[place + j] * run.work.row[j]
    return total


@unit
def hold(run: Run, g: int, q: int, h: float, own: int) -> int:
    """Bring the pockets of a group back to the efforts that they had, at all points of a slab."""
    network, laws, work, row, asked = run.network, run.network.laws, run.work.circuit, run.work.row, False
    low, step, at = network.group[g], network.step, network.step_at[network.step_row[g]]
    if own != 0:
        step, at = run.work.map, np.int64(0)
    k = network.group[g + 1] - low
    first, m, width = laws.first[g], laws.first[g + 1] - laws.first[g], work.width[0]
    faint = ROUNDED * largest(row, (k + m) * q)
    for i in range(q):
        moved, passes = True, 0
        while moved and passes < k:  # what one takes along has to be brought back after it
            moved, passes = False, passes + 1
            for p in range(k):
                by = work.held[low + p] - effort(run, step, at + (p * q + i) * width) if laws.pocket[low + p] else 0.0
                if abs(by) <= faint:
                    continue
                for other in range(k):
                    work.part[other] = p if other == p else -1
                share = allowed(run, g, q, h, i, p, by, faint)
                asked, moved, by = asked or share >= 0.0, moved or share > 0.0, max(share, 0.0) * by
                for e in range(m if by != 0.0 else 0):
                    here = inside(work, laws.from_node[first + e], p)
                    if here != inside(work, laws.to_node[first + e], p):
                        work.aimed[e * q + i] += by if here else -by
                        row[(k + e) * q + i] = work.aimed[e * q + i]
        for p in range(k):
            if laws.pocket[low + p]:
                work.held[low + p] = effort(run, step, at + (p * q + i) * width)
    if asked:  # stores have moved
        unbalance(run, g, q, h, step, at, k, 0.0)
        for a in range(m * q):
            row[k * q + a] = work.sent[a]
    return 0
