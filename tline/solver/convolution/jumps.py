"""When jumps of sources arrive where."""

from heapq import heappop, heappush
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tline.solver.convolution.families import changes_of
from tline.solver.description.description import Description
from tline.solver.description.switches import switches_of

MOST = 10_000  # arrivals
SAME = 1e-9  # of the shortest delay; arrivals so near are one


def arrivals(description: Description) -> dict[str, NDArray]:
    """Instants until the end of the run at which each node meets a jump, s; none anywhere if they are too many.

    Jumps are those of sources and switches, and all that they become at other nodes, however small.
    """
    groups, nodes = description.grouped()
    names = list(nodes)
    edges = np.cumsum([0, *(len(group.nodes) for group in groups)])
    group_of = {name: g for g, (low, high) in enumerate(pairwise(edges)) for name in names[low:high]}
    ways: list[list[tuple[int, float]]] = [[] for _ in groups]
    for line in description.lines.values():
        near, far = (group_of[name] for name in line.nodes)
        ways[near].append((far, line.delay))
        ways[far].append((near, line.delay))
    heap: list[tuple[float, int]] = []
    for name, node in nodes.items():
        for waveform in (*([] if node.held is None else [node.held]), *(flow for flow, _ in node.flows)):
            changes = changes_of(waveform, description.steady, description.t_end)
            heap += [(float(t), group_of[name]) for t in changes.at[np.abs(changes.jump) > 0.0]]
    for switch in switches_of(description):
        moves = np.empty(0) if switch.law.factor is None else switch.law.factor.breaks(description.t_end)
        heap += [(float(t), group_of[switch.nodes[0]]) for t in moves[moves >= 0]]
    same = SAME * min(line.delay for line in description.lines.values())
    heap, found = sorted(heap), [[-np.inf] for _ in groups]
    while heap:
        t, group = heappop(heap)
        if t - found[group][-1] <= same:
            continue
        found[group].append(t)
        if sum(map(len, found)) > MOST:
            return dict.fromkeys(names, np.empty(0))
        for far, delay in ways[group]:
            if t + delay < description.t_end:
                heappush(heap, (t + delay, far))
    return {name: np.array(found[group][1:]) for name, group in group_of.items()}
