"""The linear rest of a scene in s, by nodal analysis: efforts at its nodes under sources, and under waves from laws.

A law is replaced by the resistance ρ behind which it is seen and the wave β = e - ρ i that comes out of it: between its
nodes stands ρ, and β/ρ flows. What is left is linear, and one matrix of the nodes at each s, with lines exactly as they
are: y1 = Y11 u1 + Y12 u2 flows into end 1, Y11 = (1 + P²)/(1 - P²)/Zc and Y12 = -2P/(1 - P²)/Zc with P = exp(-Γl).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.branches import Branch
from tline.solver.description.bundle import bundles_of
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
    bundles : dict of str to Bundle
        Coupled conductors whose losses mix the modes.
    pairs : ndarray, shape (P, 2)
        Numbers of lines of which the second's efforts drive the first's flows: each line itself, and modes that mix.
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
        self.bundles = bundles_of(description)
        mixed = [
            np.array(np.meshgrid(*2 * [each.lines], indexing="ij")).reshape(2, -1).T for each in self.bundles.values()
        ]
        alone = np.setdiff1d(
            np.arange(len(self.z0)), np.concatenate([[-1], *(each.lines for each in self.bundles.values())])
        )
        self.alone, self.pairs = alone, np.concatenate([np.stack([alone, alone], axis=1), *mixed])
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

    def propagation(self, s: NDArray) -> tuple[NDArray, NDArray]:
        """Γl and Zc of all lines, (n, lines)."""
        total, impedance = np.outer(s, self.delays), np.broadcast_to(self.z0, (len(s), len(self.z0))).astype(complex)
        for k, line in self.lossy.items():
            series, shunt = (np.sqrt(law.at(s / self.second)) for law in (line.series, line.shunt))
            total[:, k], impedance[:, k] = series * shunt * line.length, series / shunt
        return total, impedance

    def admittances(self, s: NDArray, late: NDArray) -> tuple[NDArray, NDArray]:
        """Y11 and Y12 of all pairs, each of shape (n, P); `late`, of shape (n, lines), is what delays are beyond sT."""
        total, impedance = self.propagation(s)
        total, impedance = (total + late)[:, self.alone], impedance[:, self.alone]
        passed, twice = np.exp(-total), -np.expm1(-2 * total)
        found = [((2 - twice) / (twice * impedance), -2 * passed / (twice * impedance))]
        for bundle in self.bundles.values():
            blocks = bundle.admittances(s / self.second, late[:, bundle.lines[0]])
            found.append((blocks[0].reshape(len(s), -1), blocks[1].reshape(len(s), -1)))
        own, other = zip(*found, strict=True)
        return np.concatenate(own, axis=1), np.concatenate(other, axis=1)

    def efforts(self, s: NDArray, held: NDArray, flows: NDArray, lines: tuple[NDArray, NDArray]) -> Efforts:
        """Efforts under all sources, and under each law.

        Parameters
        ----------
        s : ndarray of complex, shape (n,)
            In the unit of the scattering.
        held, flows : ndarray, shape (n, N)
            Efforts that sources hold, and flows that they drive.
        lines : pair of ndarray, shape (n, P)
            Their `admittances`.
        """
        size = len(self.names) + sum(len(branch.nodes) for _, branches in self.groups for branch in branches)
        parts = int(len(s) * size * (size + len(self.laws)) / CHUNK) + 1
        split = (np.array_split(each, parts) for each in (s, held, flows, *lines))
        found = [self._efforts(*part) for part in zip(*split, strict=True)]
        return Efforts(*(np.concatenate(each) for each in zip(*found, strict=True)))

    def _efforts(self, s: NDArray, held: NDArray, flows: NDArray, same: NDArray, other: NDArray) -> Efforts:
        matrix, p = self.system(s, (same, other))
        nodes = p.shape[1]
        right = np.zeros((*matrix.shape[:2], 1 + len(self.laws)), complex)
        right[:, :nodes, 0] = held + p * flows
        for k, (port, impedance) in enumerate(zip(self.ports, self.impedances, strict=True), 1):
            for node in np.flatnonzero(port):
                right[:, node, k] = p[:, node] * port[node] / impedance
        found = np.linalg.solve(matrix, right)[:, :nodes]
        return Efforts(found[:, :, 0], found[:, :, 1:])

    def system(self, s: NDArray, lines: tuple[NDArray, NDArray]) -> tuple[NDArray, NDArray]:
        """What efforts at nodes, and behind them flows into branches, are multiplied by; and p of the nodes."""
        balances, (same, other) = list(self.balances(s)), lines
        size, nodes = sum(matrix.shape[1] for _, _, matrix in balances), len(self.names)
        matrix, p, row = np.zeros((len(s), size, size), complex), np.empty((len(s), nodes), complex), nodes
        for at, factor, own in balances:
            branches = own.shape[1] - len(at)
            rows = np.concatenate([at, np.arange(row, row + branches)])
            matrix[:, rows[:, None], rows], p[:, at] = own, factor
            row += branches
        at = self.node_of.reshape(-1, 2)
        for pair, (k, j) in enumerate(self.pairs.tolist()):
            own = same[:, pair] - (1 / self.z0[k] if k == j else 0.0)
            for end in (0, 1):
                here = at[k, end]
                matrix[:, here, at[j, end]] += p[:, here] * own
                matrix[:, here, at[j, 1 - end]] += p[:, here] * other[:, pair]
        for port, impedance in zip(self.ports, self.impedances, strict=True):
            for node in np.flatnonzero(port):
                matrix[:, node, :nodes] += (p[:, node] * port[node] / impedance)[:, None] * port
        return matrix, p

    def arriving(self, efforts: NDArray, lines: tuple[NDArray, NDArray], ends: NDArray) -> NDArray:
        """Waves that arrive at some line ends, shape (n, ends), under efforts at all nodes."""
        found, at = efforts[:, self.node_of[ends]], self.node_of.reshape(-1, 2)
        for column, (line, end) in enumerate(zip(*np.divmod(ends, 2), strict=True)):
            here = np.flatnonzero(self.pairs[:, 0] == line)
            beside = at[self.pairs[here, 1]]
            flow = lines[0][:, here] * efforts[:, beside[:, end]] + lines[1][:, here] * efforts[:, beside[:, 1 - end]]
            found[:, column] -= self.z0[line] * flow.sum(axis=1)
        return found
