"""The linear rest of a scene in s, by nodal analysis: efforts at its nodes under sources, and under waves from laws.

A law is replaced by the resistance ρ behind which it is seen and the wave β = e - ρ i that comes out of it: between its
nodes stands ρ, and β/ρ flows. What is left is linear, and one matrix of the nodes at each s, with lines exactly as they
are: y1 = Y11 u1 + Y12 u2 flows into end 1, Y11 = (1 + P²)/(1 - P²)/Zc and Y12 = -2P/(1 - P²)/Zc with P = exp(-Γl).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.branches import Branch
from tline.solver.description.description import Description
from tline.solver.description.groups import Group
from tline.solver.description.nodes import Node
from tline.solver.description.switches import switches_of
from tline.solver.stability.scattering import Scattering

CHUNK = 1e6  # complex entries of matrices held at once


class Efforts(NamedTuple):
    """Efforts at n places in s, of N nodes, under all sources and under waves of 1 from each of K laws."""

    driven: NDArray  # (n, N)
    from_laws: NDArray  # (n, N, K)


class LinearRest(Scattering):
    """A scene in s without its laws and switches, of which each is a resistance and a source of waves.

    Parameters
    ----------
    description : Description

    Attributes
    ----------
    laws : list of PlacedLaw
        Elements in the order of groups, then switches.
    impedances : ndarray, shape (K,)
        Behind which they are seen: about what they see of the rest within the shortest delay.
    ports : ndarray, shape (K, N)
        From efforts at nodes to those across laws.
    """

    def __init__(self, description: Description):
        super().__init__(description)
        groups, switches = description.grouped()[0], list(switches_of(description))
        self.laws = [*(element for group in groups for element in group.elements), *switches]
        seen = [z for group in groups for z in group.matched(1 / self.second)]
        usual = float(self.z0.mean())
        self.impedances = np.array([*seen, *(switch.seen(description.nodes) or usual for switch in switches)])
        self.ports = np.zeros((len(self.laws), len(self.names)))
        at = {name: k for k, name in enumerate(self.names)}
        for row, law in zip(self.ports, self.laws, strict=True):
            for node, sign in ((law.from_node, 1.0), (law.to_node, -1.0)):
                if node is not None:
                    row[at[node]] += sign
        self.node_of = np.empty(self.size, int)
        for node, ends in enumerate(self.ends):
            self.node_of[ends] = node

    def _check(self, description: Description) -> None:
        """Laws stand behind their impedances, and modes of conductors are lines."""

    def _last(self, node: Node) -> float:
        """Conductance of switches, which are laws."""
        return 0.0

    def _branches(self, group: Group) -> list[Branch]:
        return [branch for branch in group.branches if branch.switch is None]

    def admittances(self, s: NDArray, late: NDArray) -> tuple[NDArray, NDArray]:
        """Y11 and Y12 of all lines, each of shape (n, lines); `late`, likewise, is what their delays are beyond sT."""
        total, impedance = np.outer(s, self.delays), np.broadcast_to(self.z0, (len(s), len(self.z0))).astype(complex)
        for k, line in self.lossy.items():
            series, shunt = (np.sqrt(law.at(s / self.second)) for law in (line.series, line.shunt))
            total[:, k], impedance[:, k] = series * shunt * line.length, series / shunt
        passed, twice = np.exp(-total - late), -np.expm1(-2 * (total + late))
        return (2 - twice) / (twice * impedance), -2 * passed / (twice * impedance)

    def efforts(self, s: NDArray, held: NDArray, flows: NDArray, lines: tuple[NDArray, NDArray]) -> Efforts:
        """Efforts under all sources, and under each law.

        Parameters
        ----------
        s : ndarray of complex, shape (n,)
            In the unit of the scattering.
        held, flows : ndarray, shape (n, N)
            Efforts that sources hold, and flows that they drive.
        lines : pair of ndarray, shape (n, lines)
            Their `admittances`.
        """
        size = len(self.names) + sum(len(branch.nodes) for _, branches in self.groups for branch in branches)
        parts = int(len(s) * size * (size + len(self.laws)) / CHUNK) + 1
        split = (np.array_split(each, parts) for each in (s, held, flows, *lines))
        found = [self._efforts(*part) for part in zip(*split, strict=True)]
        return Efforts(*(np.concatenate(each) for each in zip(*found, strict=True)))

    def _efforts(self, s: NDArray, held: NDArray, flows: NDArray, same: NDArray, other: NDArray) -> Efforts:
        balances = list(self.balances(s))
        size, nodes = sum(matrix.shape[1] for _, _, matrix in balances), len(self.names)
        matrix, p, row = np.zeros((len(s), size, size), complex), np.empty((len(s), nodes), complex), nodes
        for at, factor, own in balances:
            branches = own.shape[1] - len(at)
            rows = np.concatenate([at, np.arange(row, row + branches)])
            matrix[:, rows[:, None], rows], p[:, at] = own, factor
            row += branches
        for k, z0 in enumerate(self.z0):
            ends = self.node_of[2 * k], self.node_of[2 * k + 1]
            for here, there in (ends, ends[::-1]):
                matrix[:, here, here] += p[:, here] * (same[:, k] - 1 / z0)
                matrix[:, here, there] += p[:, here] * other[:, k]
        right = np.zeros((len(s), size, 1 + len(self.laws)), complex)
        right[:, :nodes, 0] = held + p * flows
        for k, (port, impedance) in enumerate(zip(self.ports, self.impedances, strict=True), 1):
            for node in np.flatnonzero(port):
                right[:, node, k] = p[:, node] * port[node] / impedance
                matrix[:, node, :nodes] += right[:, node, k, None] * port
        found = np.linalg.solve(matrix, right)[:, :nodes]
        return Efforts(found[:, :, 0], found[:, :, 1:])

    def arriving(self, efforts: NDArray, lines: tuple[NDArray, NDArray], ends: NDArray) -> NDArray:
        """Waves that arrive at some line ends, shape (n, ends), under efforts at all nodes."""
        same, other = (each[:, ends // 2] for each in lines)
        here, there = efforts[:, self.node_of[ends]], efforts[:, self.node_of[ends ^ 1]]
        return here - self.z0[ends // 2] * (same * here + other * there)
