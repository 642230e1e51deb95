"""Short lines as lumped inductors and capacitors, and the state space of the nodes that they join.

A line cut in n LC sections is n inductors z0 T/n in a row, with a capacitor T/(n z0) between each two and half of one
at each end. Its states are the inductors' flows times z0 and the inner capacitors' efforts, in order along the line; so
all rates are n/T. The halves at the ends are part of the nodes' loads.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.components import parts
from tline.solver.description.coupled import EndPlaces, scattered
from tline.solver.description.elements import PlacedLaw
from tline.solver.description.given import End
from tline.solver.description.lines import Line
from tline.solver.description.load_step import NO_LOAD, StateSpace, side_by_side
from tline.solver.description.multiport import PlacedPorts, PortPlaces, with_multiports
from tline.solver.description.nodes import Node


class LumpedLine(NamedTuple):
    """A lumped line, and the places of its nodes in their group."""

    name: str
    line: Line
    sections: int
    u: float = 0.0  # before t = 0
    y: float = 0.0
    first: int = -1
    second: int = -1

    @property
    def states(self) -> int:
        """Inductors and the capacitors between them."""
        return 2 * self.sections - 1


FAST = 3.0  # over the slab's width: poles beyond are not resolved
LONG = 64.0  # delays, so that the steps of that time are too long for what rings in LC sections, but not in lines
GONE = 20.0  # time constants after which 2e-9 is left


class Group(NamedTuple):
    """Nodes that short lines, ends of coupled conductors, multiports or non-linear elements join, or one node."""

    nodes: list[Node]
    lumped_lines: list[LumpedLine]
    ends: list[EndPlaces]
    ports: list[PortPlaces]
    elements: list[PlacedLaw]

    @property
    def dynamic(self) -> bool:
        """Whether it has a state, or a switch."""
        free = [node for node in self.nodes if node.held is None]
        return bool(self.lumped_lines or self.ends or self.ports) or any(
            node.load is not None or node.switches for node in free
        )

    def system(self, switched: float) -> StateSpace:
        """From the nodes' Thévenin waves to their efforts, with switches of that conductance if it is one node."""
        if self.ends:
            return scattered(self.nodes, self.ends)
        if self.ports:
            return with_multiports(self.nodes, self.ports)
        if not self.lumped_lines:
            return self.nodes[0].response(switched)
        return coupled(self)

    def settles(self, h: float) -> float:
        """Time in which what lumped lines make faster than slabs of width h dies away, s."""
        if not self.lumped_lines:
            return 0.0
        poles = np.linalg.eigvals(self.system(0.0).A)
        decay = -float(poles.real[np.abs(poles) * h > FAST].max(initial=-np.inf))
        return max(GONE / decay, LONG * max(lumped.line.delay for lumped in self.lumped_lines)) if decay > 0 else np.inf

    def at_rest_under(self, waves: NDArray) -> NDArray:
        """Steady state under Thévenin waves, shape (nodes,), while the lumped lines carry their flows."""
        if not self.lumped_lines:
            return self.nodes[0].response(self.nodes[0].switched(0.0)).at_rest_under(waves[0])
        states, out, level = [], np.zeros(len(self.nodes)), np.zeros(len(self.nodes))
        for lumped in self.lumped_lines:
            level[[lumped.first, lumped.second]] = lumped.u
            out[lumped.first] += lumped.y
            out[lumped.second] -= lumped.y
        for node, wave, flow, u in zip(self.nodes, waves, out, level, strict=True):
            if node.held is None:
                states.append(node.response(0.0).at_rest_under(wave - flow / node.total + u * node.floating))
        inner = [np.resize([lumped.line.z0 * lumped.y, lumped.u], lumped.states) for lumped in self.lumped_lines]
        return np.concatenate([*states, *inner])

    def state_at_rest(self) -> NDArray:
        """State while the liquid stands still."""
        system = self.system(0.0)
        state, first = np.where(system.constant, 1.0, 0.0), 0
        for node in self.nodes:
            if node.held is None:
                own = node.state_at_rest()
                state[first : first + len(own)] = own
                first += len(own)
        return state


def coupled(group: Group) -> StateSpace:
    """State space of a group with lumped lines: those of its nodes, whose Thévenin waves lose what the inductors take.

    With g the conductance and i the flow out of a node into inductors, its wave becomes w - i/g. A node where nothing
    but short lines conducts takes their sum for g, and gets back its own effort, w - i/g + u; with a capacitor there, u
    does not depend on that wave but through the state.
    """
    own = [NO_LOAD if node.held is not None else node.response(0.0) for node in group.nodes]
    first = np.cumsum([0, *(len(system.A) for system in own), *(lumped.states for lumped in group.lumped_lines)])
    k = len(own)
    A, B, C, D = side_by_side(own, sum(lumped.states for lumped in group.lumped_lines))
    wave = np.zeros_like(C)  # what the states add to the waves
    for p, node in enumerate(group.nodes):
        if node.held is None and node.floating:
            wave[p] += C[p]
    for lumped, at in zip(group.lumped_lines, first[k:-1], strict=True):
        last = at + lumped.states - 1
        for p, place, sign in ((lumped.first, at, 1.0), (lumped.second, last, -1.0)):
            if group.nodes[p].held is None:
                wave[p, place] -= sign / (lumped.line.z0 * group.nodes[p].total)
    A += B @ wave
    C += D @ wave
    for lumped, at in zip(group.lumped_lines, first[k:-1], strict=True):
        last, rate = at + lumped.states - 1, lumped.sections / lumped.line.delay
        for j in range(at, last):  # neighbours along the line
            A[j, j + 1], A[j + 1, j] = -rate, rate
        for p, place, sign in ((lumped.first, at, 1.0), (lumped.second, last, -1.0)):
            A[place] += sign * rate * C[p]
            B[place] += sign * rate * D[p]
    return StateSpace(A, B, C, D)


def grouped(
    nodes: dict[str, Node],
    lumped_lines: Sequence[LumpedLine],
    elements: Sequence[PlacedLaw],
    coupled_ends: Sequence[End],
    multiports: Sequence[PlacedPorts],
) -> tuple[list[Group], dict[str, Node]]:
    """Groups of the nodes that lumped or coupled lines, multiports or elements join, and the nodes in their order."""
    if not lumped_lines and not elements and not coupled_ends and not multiports:
        return [Group([node], [], [], [], []) for node in nodes.values()], nodes
    names, number = list(nodes), {name: k for k, name in enumerate(nodes)}
    joined_nodes = [lumped.line.nodes for lumped in lumped_lines] + [element.nodes for element in elements]
    joined_nodes += [(*end.conductors, *end.modal) for end in coupled_ends] + [link.nodes for link in multiports]
    pairs = [[number[joint[0]], number[at]] for joint in joined_nodes for at in joint]
    first, second = np.array(pairs).T
    part = parts(first, second, len(names))
    order = np.argsort(part, kind="stable")
    place = np.argsort(order) - np.searchsorted(part[order], part)  # of each node in its group
    groups = [Group([], [], [], [], []) for _ in range(part.max() + 1)]
    for k in order:
        groups[part[k]].nodes.append(nodes[names[k]])
    for element in elements:
        groups[part[number[element.nodes[0]]]].elements.append(element)
    for end in coupled_ends:
        conductors, modal = (place[[number[at] for at in nodes]] for nodes in (end.conductors, end.modal))
        groups[part[number[end.modal[0]]]].ends.append(EndPlaces(conductors, modal, end.modes))
    for link in multiports:
        at = [number[node] for node in link.nodes]
        groups[part[at[0]]].ports.append(PortPlaces(link.where, place[at], link.ports))
    for lumped in lumped_lines:
        one, other = (number[node] for node in lumped.line.nodes)
        groups[part[one]].lumped_lines.append(lumped._replace(first=place[one], second=place[other]))
    return groups, {names[k]: nodes[names[k]] for k in order}
