"""Which flows into elements follow from those of the lines alone.

At each node of a group what the lines bring, less what known conductances and sources take, is the rest, r. Where only
one element has a port at a node, its flow is the rest; the flow of an element between two nodes is then known at the
other as well; and so on. What cannot be told apart so shares an account.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.components import parts


class Port(NamedTuple):
    """A port of an element at a node."""

    element: int
    node: int
    twin: int = -1  # the port from which the same flow comes out again


class Flows(NamedTuple):
    """What flows from nodes into elements, in terms of the rests."""

    shares: NDArray  # (rows, nodes) rows @ r are flows
    node: NDArray  # (rows,) from which
    elements: list[tuple[int, ...]]  # of each row, into which; none where a rest must vanish


def flows_of(ports: Sequence[Port], seen: Sequence[bool]) -> Flows:
    """Flows of a group's ports.

    Where a node's effort is not seen, the rest is nothing, and elements share an account.

    Examples
    --------
    Two nodes with a valve between them; at the second there is a vessel too.

    >>> flows = flows_of([Port(0, 0, 1), Port(0, 1, 0), Port(1, 1)], [True, True])
    >>> flows.shares.tolist(), flows.elements
    ([[1.0, 0.0], [-1.0, 0.0], [1.0, 1.0]], [(0,), (0,), (1,)])
    """
    n = len(seen)
    known, told, unknown = _followed(ports, n)
    together = [*unknown, *({port.element for port in ports if port.node == k} for k in range(n) if not seen[k])]
    pairs = [(min(elements), element) for elements in together for element in elements]
    first, second = np.array(pairs, int).reshape(-1, 2).T
    part = parts(first, second, 1 + max((port.element for port in ports), default=-1))
    part_of = [tuple(np.flatnonzero(part == own).tolist()) for own in part]
    shares, node, elements = [], [], []
    for p, port in enumerate(ports):
        if p in known and seen[port.node]:
            shares.append(known[p])
            node.append(port.node)
            elements.append(part_of[port.element])
    for k in range(n):
        left = np.eye(n)[k] - sum(known[p] for p, port in enumerate(ports) if p in known and port.node == k)
        if seen[k] and k not in told:
            shares.append(left)
            node.append(k)
            elements.append(part_of[min(unknown[k])] if unknown[k] else ())
    return Flows(np.array(shares).reshape(-1, n), np.array(node, int), elements)


def _followed(ports: Sequence[Port], n: int) -> tuple[dict[int, NDArray], set[int], list[set[int]]]:
    """Known flows by port, the nodes they were told from, and of each node the elements whose flows remain unknown."""
    known: dict[int, NDArray] = {}
    told: set[int] = set()
    waiting = [{p for p, port in enumerate(ports) if port.node == k} for k in range(n)]
    ready = [k for k in range(n) if len(waiting[k]) == 1]
    while ready:
        k = ready.pop(0)
        if len(waiting[k]) != 1:
            continue
        p = waiting[k].pop()
        others = (known[q] for q, port in enumerate(ports) if port.node == k and q in known)
        known[p] = np.eye(n)[k] - sum(others, np.zeros(n))
        told.add(k)
        twin = ports[p].twin
        if twin >= 0 and twin not in known:
            known[twin] = 0.0 - known[p]
            at = ports[twin].node
            waiting[at].discard(twin)
            ready.append(at)
    return known, told, [{ports[p].element for p in left} for left in waiting]
