"""Efforts between shut laws, which nothing determines: liquid that nothing reaches keeps its pressure.

Nodes that only laws reach, and that laws without a flow part from all others, are a pocket: at each point of a slab
their efforts may be shifted together, and Newton's method leaves them anywhere. They are brought back to what they were
at the point before, or as near to that as the laws around them stay shut.
"""

from tline.compiled.unit import function
from tline.solver.kernel.arithmetic import largest
from tline.solver.kernel.laws.answers import ask, exchange_states, unbalance

HALVINGS = 40  # for the part of a shift with which laws stay shut
ROUNDED = 1e-12  # of the largest wave: shifts and flows below are none
OPEN, LIMITED, SHUT = 0, 1, 2  # laws around a pocket: one passes flow, one would after the whole shift, or none


@function
def inside(work, node, root):
    """Whether a node belongs to a pocket."""
    return node >= 0 and work.part[node] == root


@function
def shut_after(run, g, q, h, e, i, across):
    """Whether nothing passes an element at point i if the wave into it changes by `across`."""
    work, o = run.work.circuit, (e - run.network.laws.first[g]) * q
    for j in range(q):
        work.trial[o + j] = work.aimed[o + j] + (across if j == i else 0.0)
    exchange_states(run, g, True)
    ask(run, e, q, h, work.trial, o, work.other)
    return work.other[o + i] == 0.0


@function
def around(run, g, q, h, i, root, by, faint):
    """Add to a pocket what open laws join to it, and tell what those around it do if it is shifted."""
    laws, work, low = run.network.laws, run.work.circuit, run.network.group[g]
    state, grown = SHUT, True
    while grown:
        state, grown = SHUT, False
        for e in range(laws.first[g], laws.first[g + 1]):
            one, other = laws.from_node[e], laws.to_node[e]
            here = inside(work, one, root)
            if here == inside(work, other, root):
                continue
            beyond = other if here else one
            flows = abs(work.flow[(e - laws.first[g]) * q + i]) * laws.source_impedance[e] > faint
            if not flows and shut_after(run, g, q, h, e, i, by if here else -by):
                continue
            if beyond >= 0 and laws.pocket[low + beyond]:
                work.part[beyond], grown = root, True
            elif flows:
                return OPEN
            else:
                state = LIMITED
    return state


@function
def stays_shut(run, g, q, h, i, root, by):
    """Whether all laws around a pocket stay shut if it is shifted."""
    laws, work = run.network.laws, run.work.circuit
    for e in range(laws.first[g], laws.first[g + 1]):
        here = inside(work, laws.from_node[e], root)
        if here != inside(work, laws.to_node[e], root) and not shut_after(run, g, q, h, e, i, by if here else -by):
            return False
    return True


@function
def allowed(run, g, q, h, i, root, by, faint):
    """Part of a shift that leaves the laws around a pocket shut."""
    state = around(run, g, q, h, i, root, by, faint)
    low, high = (1.0, 1.0) if state == SHUT else (0.0, 1.0 if state == LIMITED else 0.0)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if low < middle < high:
            if stays_shut(run, g, q, h, i, root, middle * by):
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


@function
def hold(run, g, q, h, step, at, k):
    """Bring the pockets of a group back to the efforts that they had, at all points of a slab."""
    laws, work, row, low, asked = run.network.laws, run.work.circuit, run.work.row, run.network.group[g], False
    first, m, width = laws.first[g], laws.first[g + 1] - laws.first[g], work.width[0]
    faint = ROUNDED * largest(row, (k + m) * q)
    for i in range(q):
        for p in range(k):
            work.part[p] = -1
        for p in range(k):
            by = work.held[low + p] - effort(run, step, at + (p * q + i) * width)
            if not laws.pocket[low + p] or work.part[p] >= 0 or abs(by) <= faint:
                continue
            work.part[p], asked = p, True
            by *= allowed(run, g, q, h, i, p, by, faint)
            for e in range(m if by != 0.0 else 0):
                here = inside(work, laws.from_node[first + e], p)
                if here != inside(work, laws.to_node[first + e], p):
                    work.aimed[e * q + i] += by if here else -by
                    row[(k + e) * q + i] = work.aimed[e * q + i]
        for p in range(k):
            work.held[low + p] = effort(run, step, at + (p * q + i) * width)
    if asked:  # stores have moved
        unbalance(run, g, q, h, step, at, k, 0.0)
        for a in range(m * q):
            row[k * q + a] = work.sent[a]
