"""The linear rest of a scene in s, by nodal analysis: efforts at its nodes under sources, and under waves from laws.

A law is replaced by its reference resistance ρ and the wave β = e - ρ i that comes out of it: ρ joins its nodes, and
β/ρ flows. The rest is linear: one matrix of the nodes at each s, with lines exactly as they are: y1 = Y11 u1 + Y12 u2
flows into end 1, Y11 = (1 + P²)/(1 - P²)/Zc and Y12 = -2P/(1 - P²)/Zc with P = exp(-Γl).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.description import Description
from tline.solver.description.elements import Branch
from tline.solver.description.groups import Group
from tline.solver.description.laws import switches_of
from tline.solver.description.nodes import Node
from tline.solver.stability.scattering import CHUNK, Scattering


class Block(NamedTuple):
    """Coupled conductors among the unknown efforts: places of their ends, from these to modes, and numbers of pairs."""

    one: NDArray  # (k,)
    other: NDArray
    back: NDArray  # (k, k)
    pairs: NDArray  # (k, k); -1 where modes do not couple

    def between(self, modal: NDArray) -> NDArray:
        """Flow into conductors per effort of conductors, (n, k, k), from that of all pairs of modes, (n, P)."""
        own = np.where(self.pairs >= 0, modal[:, self.pairs], 0.0)
        return self.back.T @ own @ self.back


class LinearRest(Scattering):
    """Scene in s without its laws and switches, each replaced by a resistance and a source of waves.

    Laws are in the order of groups, then switches, behind `impedances` (K,): about that of the rest within the shortest
    delay. `ports` (K, N) leads from efforts at nodes to those across laws. `pairs` (P, 2) are numbers of lines, where
    the second's efforts drive the first's flows: each line with itself, and modes that mix.
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
        self._join(description, at)

    def _join(self, description: Description, at: dict[str, int]) -> None:
        """Which efforts are unknown: those of modes follow from those of conductors."""
        modal = [at[node] for end in description.ends for node in end.modal]
        self.known_by = np.eye(len(at))[:, np.setdiff1d(np.arange(len(at)), modal)]  # (N, unknown)
        self.place = np.where(self.known_by.any(axis=1), np.cumsum(self.known_by.any(axis=1)) - 1, -1)
        numbers = {name: k for k, name in enumerate(description.lines)}
        pair_of = {(k, j): pair for pair, (k, j) in enumerate(self.pairs.tolist())}
        self.blocks: list[Block] = []
        for ends in description.coupled.values():
            lines = [numbers[node.removesuffix(", end 1")] for node in ends[0].modal]
            back = np.linalg.inv(ends[0].modes.T)
            one, other = (self.place[[at[node] for node in end.conductors]] for end in ends)
            for end, places in zip(ends, (one, other), strict=True):
                self.known_by[np.array([at[node] for node in end.modal])[:, None], places] = back
            pairs = np.array([[pair_of.get((k, j), -1) for j in lines] for k in lines])
            self.blocks.append(Block(one, other, back, pairs))
        joined = {int(pair) for block in self.blocks for pair in block.pairs.flat}
        single = [(pair, self.node_of[2 * k : 2 * k + 2]) for (k, _), pair in pair_of.items() if pair not in joined]
        self.single = [(pair, *self.place[ends].tolist()) for pair, ends in single]

    def _check(self, description: Description) -> None:
        """Accept any description: laws are behind their impedances, and modes of conductors are lines."""

    def _last(self, node: Node) -> float:
        return 0.0

    def _branches(self, group: Group) -> list[Branch]:
        """Branches without switches, and without ends of conductors, which have no place in the scene."""
        return [branch for branch in group.branches if branch.switch is None and branch.where]

    def propagation(self, s: NDArray) -> tuple[NDArray, NDArray]:
        """Γl and Zc of all lines, (n, lines)."""
        total, impedance = np.outer(s, self.delays), np.broadcast_to(self.z0, (len(s), len(self.z0))).astype(complex)
        for k, line in self.lossy.items():
            series, shunt = (np.sqrt(law.at(s / self.second)) for law in (line.series, line.shunt))
            total[:, k], impedance[:, k] = series * shunt * line.length, series / shunt
        return total, impedance

    def admittances(self, s: NDArray, late: NDArray) -> tuple[NDArray, NDArray]:
        """Y11 and Y12 of all pairs, shape (n, P) each; `late`, of shape (n, lines), is the excess of delays over sT."""
        total, impedance = self.propagation(s)
        total, impedance = (total + late)[:, self.alone], impedance[:, self.alone]
        passed, twice = np.exp(-total), -np.expm1(-2 * total)
        found = [((2 - twice) / (twice * impedance), -2 * passed / (twice * impedance))]
        for bundle in self.bundles.values():
            blocks = bundle.admittances(s / self.second, late[:, bundle.lines])
            found.append((blocks[0].reshape(len(s), -1), blocks[1].reshape(len(s), -1)))
        own, other = zip(*found, strict=True)
        return np.concatenate(own, axis=1), np.concatenate(other, axis=1)

    def efforts(
        self, s: NDArray, at: NDArray, held: NDArray, flows: NDArray, lines: tuple[NDArray, NDArray]
    ) -> tuple[NDArray, NDArray]:
        """Efforts at n places in s, of N nodes, under k sets of sources, (n, N, k), and under each law, (n, N, K).

        Laws send waves of 1. Sources at some nodes hold efforts and drive flows, shape (n, nodes, k) each; `lines` are
        the `admittances` of lines, shape (n, P) each.
        """
        size = self.known_by.shape[1] + sum(len(branch.nodes) for _, branches in self.groups for branch in branches)
        parts = int(len(s) * size * (size + held.shape[2] + len(self.laws)) / CHUNK) + 1
        split = (np.array_split(each, parts) for each in (s, held, flows, *lines))
        driven, from_laws = zip(*(self._efforts(at, *part) for part in zip(*split, strict=True)), strict=True)
        return np.concatenate(driven), np.concatenate(from_laws)

    def _efforts(
        self, at: NDArray, s: NDArray, held: NDArray, flows: NDArray, same: NDArray, other: NDArray
    ) -> tuple[NDArray, NDArray]:
        matrix, p = self.system(s, (same, other))
        unknown, sets = p.shape[1], held.shape[2]
        right, known = np.zeros((*matrix.shape[:2], sets + len(self.laws)), complex), self.known_by[at].T
        right[:, :unknown, :sets] = known @ held + p[:, :, None] * (known @ flows)  # none at modes
        right[:, :unknown, sets:] = p[:, :, None] * (self.ports @ self.known_by / self.impedances[:, None]).T
        found = self.known_by @ np.linalg.solve(matrix, right)[:, :unknown]
        return found[:, :, :sets], found[:, :, sets:]

    def system(self, s: NDArray, lines: tuple[NDArray, NDArray]) -> tuple[NDArray, NDArray]:
        """Matrix of the unknown efforts, and behind them flows into branches; and p at these efforts."""
        balances, (same, other) = list(self.balances(s)), lines
        unknown = self.known_by.shape[1]
        size = unknown + sum(own.shape[1] - len(at) for at, _, own in balances)
        matrix, p, row = np.zeros((len(s), size, size), complex), np.empty((len(s), unknown), complex), unknown
        for at, factor, own in balances:
            here, branches = np.flatnonzero(self.place[at] >= 0), own.shape[1] - len(at)
            rows = np.concatenate([self.place[at[here]], np.arange(row, row + branches)])
            part = np.concatenate([here, np.arange(len(at), own.shape[1])])
            matrix[:, rows[:, None], rows], p[:, self.place[at[here]]] = own[:, part[:, None], part], factor[:, here]
            row += branches
        for pair, *ends in self.single:
            own = same[:, pair] - 1 / self.z0[self.pairs[pair, 0]]
            for here, there in (ends, ends[::-1]):
                matrix[:, here, here] += p[:, here] * own
                matrix[:, here, there] += p[:, here] * other[:, pair]
        for block in self.blocks:
            own, across = block.between(same), block.between(other)
            for here, there in ((block.one, block.other), (block.other, block.one)):
                matrix[:, here[:, None], here] += p[:, here, None] * own
                matrix[:, here[:, None], there] += p[:, here, None] * across
        for port, impedance in zip(self.ports @ self.known_by, self.impedances, strict=True):
            for node in np.flatnonzero(port):
                matrix[:, node, :unknown] += (p[:, node] * port[node] / impedance)[:, None] * port
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
