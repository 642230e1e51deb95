"""What stands at s = 0 at each node and joins nodes without a fall: what is held, driven, conducted; lossless lines.

To the first order in s there are capacities to the reference, and an inertia along each join.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.description import Description
from tline.solver.description.excitation import just_before
from tline.solver.description.links import admittance
from tline.solver.steady.lossy_lines import falling, pi


class AtNodes(NamedTuple):
    """Of each node, shape (nodes,)."""

    given: NDArray  # effort that is held, else nan
    conductance: NDArray  # to the reference
    driven: NDArray  # flow of sources
    capacity: NDArray  # to the reference
    tie: NDArray  # 1/inertia between the node and what holds it: infinite where that is ideal


class Lines(NamedTuple):
    """Of each line, shape (lines,)."""

    ends: NDArray  # (lines, 2), numbers of nodes
    z0: NDArray
    delay: NDArray
    leak: NDArray  # conductance at each end
    falls: NDArray  # whether effort falls along it


class Joins(NamedTuple):
    """Lossless lines, and then inductors, between nodes that have one effort in a steady state."""

    ends: NDArray  # (joins, 2)
    inertia: NDArray  # (joins,)
    names: list[str]  # of the lines


def lines_of(description: Description, number: Mapping[str, int]) -> Lines:
    """Numbers of all lines."""
    lines = description.lines.values()
    ends = np.array([[number[node] for node in line.nodes] for line in lines], int)
    values = [(line.z0, line.delay, pi(line)[1], falling(line)) for line in lines]
    z0, delay, leak, falls = np.array(values).T
    return Lines(ends, z0, delay, leak, falls > 0)


def at_nodes(description: Description, number: Mapping[str, int], lines: Lines) -> AtNodes:
    """Balances of all nodes, with half of what leaks from a line and of what it stores at each of its ends."""
    n = len(number)
    given, conductance, driven, capacity, tie = np.full(n, np.nan), *np.zeros((4, n))
    for k, node in enumerate(description.nodes.values()):
        switched = node.switched(0.0)
        if node.held is not None:
            given[k], tie[k] = just_before(node.held), np.inf
        elif switched == np.inf:
            given[k], tie[k] = node.above_level, np.inf
        else:
            driven[k], conductance[k] = node.flow_before(), node.conductance + switched
            driven[k] += switched * node.above_level
            if node.load is not None and node.load.at_zero() == 0:  # an inductor: a short, with an inertia
                inertia = node.load.numerator[-2] / node.load.denominator[-1]
                given[k], tie[k] = node.above_level, 1 / inertia if inertia else np.inf
            elif node.load is not None:
                conducted, capacity[k] = admittance(node.load)
                conductance[k] += conducted
                driven[k] += conducted * node.above_level
    for name, effort in description.tanks.items():
        given[number[name]], tie[number[name]] = effort, np.inf
    for end in lines.ends.T:
        conductance += np.bincount(end, lines.leak, n)
        capacity += np.bincount(end, lines.delay / lines.z0 / 2, n)
    return AtNodes(given, conductance, driven, capacity, tie)


def joins_of(description: Description, number: Mapping[str, int], lines: Lines) -> Joins:
    """Lines along which nothing falls, and links that are shorts to a steady flow."""
    shorts, lossless = description.inductive, ~lines.falls
    pairs = np.array([[number[first], number[second]] for first, second, _ in shorts], int).reshape(-1, 2)
    inertia = np.concatenate([(lines.z0 * lines.delay)[lossless], [inertia for _, _, inertia in shorts]])
    names = [name for name, kept in zip(description.lines, lossless.tolist(), strict=True) if kept]
    return Joins(np.vstack([lines.ends[lossless], pairs]), inertia, names)
