"""Scattering of waves by the lines and nodes of a scene at complex frequencies s.

Waves w that arrive at the line ends come back as w = P(s) (S(s) w + g), with the lines' passage P, exp(-sT) without
losses, the scattering S of the nodes and the waves g of the sources. At a node with lines and resistances of
conductance Y and a load Z = p/q, the effort follows from f u = p (sum of w/z0 + J - i) with f = Y p + q, J the flow of
its sources and i that into branches, which relate efforts and flows of several nodes; 2u - w leaves each end.

A lossy line is exact in s: its transmission and reflection of waves referred to its z0, and the field inside it.
"""

from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.loss import LossyLine
from tline.solver.description.bundle import bundles_of
from tline.solver.description.description import Description
from tline.solver.description.elements import Branch
from tline.solver.description.groups import Group
from tline.solver.description.lines import Line
from tline.solver.description.nodes import Node
from tline.words.wording import place

CHUNK = 2e6  # complex entries held at once


def losses_of(name: str, line: Line) -> LossyLine:
    """Return the exact series impedance and shunt admittance of a line with losses."""
    losses = line.losses
    if losses is None or not losses.linear:
        problem = "depends on the size of the flow: there is no transfer function"
        raise InputError(place("lines", name, "friction"), problem, "kind = 'linear', 'laminar' or 'zielke'")
    return losses.exact


def carried(line: LossyLine, z0: float, s: NDArray, late: NDArray | float = 0.0) -> tuple[NDArray, NDArray]:
    """Transmission and reflection of a line for waves referred to z0; each of the shape of s.

    `late`, the part of a delay beyond sT, is added to Γl in the propagation of a wave.
    With A, B, C, A the chain matrix these are 2/(2A + B/z0 + C z0) and (B/z0 - C z0)/(2A + B/z0 + C z0).

    References
    ----------
    D. M. Pozar, Microwave Engineering, 4th ed., Wiley 2012, table 4.2.
    """
    series, shunt = line.series.at(s), line.shunt.at(s)
    total = np.sqrt(series) * np.sqrt(shunt) * line.length
    fallen = np.exp(-total - late)
    shape = _shape(total, late) * line.length  # sinh(Γl)/Γ exp(-Γl)
    b, c = series * shape / z0, shunt * shape * z0
    whole = 1 + fallen**2 + b + c
    return 2 * fallen / whole, (b - c) / whole


def inside(line: LossyLine, s: NDArray, share: float, u1: NDArray, u2: NDArray) -> tuple[NDArray, NDArray]:
    """Effort and flow at a share of the length, between the efforts at the ends."""
    total = line.gamma(s) * line.length
    near, far = share, 1 - share
    whole = _shape(total)
    decay = np.exp(-total * np.array([near, far, 1 + near, 1 + far])[:, None])
    u = (decay[0] * far * _shape(total * far) * u1 + decay[1] * near * _shape(total * near) * u2) / whole
    slopes = (decay[0] + decay[3]) * u1 - (decay[1] + decay[2]) * u2
    return u, slopes / (2 * line.series.at(s) * line.length * whole)


def _shape(total: NDArray, late: NDArray | float = 0.0) -> NDArray:
    """sinh(x)/x exp(-x), with x + `late` for x where it is no divisor."""
    return np.where(total == 0, 1, -np.expm1(-2 * (total + late)) / (2 * np.where(total == 0, 1, total)))


Parts = tuple[NDArray, NDArray, NDArray]


class Passage(NamedTuple):
    """Transmission and reflection of lines by the sending end, (n, ends), and those of modes that mix, (n, k, k)."""

    across: NDArray
    back: NDArray
    mixed: list[Parts]  # numbers of lines, transmission, reflection

    def arriving(self, sent: NDArray) -> NDArray:
        """Waves that arrive at all ends, of those that leave them, (n, ends, m)."""
        swapped = np.arange(sent.shape[1]) ^ 1
        found = self.back[:, :, None] * sent + (self.across[:, :, None] * sent)[:, swapped]
        for lines, across, back in self.mixed:
            for here, there in ((2 * lines, 2 * lines + 1), (2 * lines + 1, 2 * lines)):
                found[:, here] = across @ sent[:, there] + back @ sent[:, here]
        return found


class Scattering:
    """A scene after its last switch has moved; s counts in units of 1/`second`.

    Sources count with their resistances only; terminations are conductances added at nodes.
    """

    def __init__(self, description: Description, terminations: Mapping[str, float] | None = None):
        self._check(description)
        lines = list(description.lines.values())
        delays = np.array([line.delay for line in lines])
        self.second = float(delays.min())
        self.delays = delays / self.second
        self.z0 = np.array([line.z0 for line in lines])
        groups, nodes = description.grouped()
        self.names = list(nodes)
        more = terminations or {}
        own = [0.0 if node.dead else node.total for node in nodes.values()]
        extra = [self._last(node) + more.get(name, 0.0) for name, node in nodes.items()]
        self.totals = np.array(own) + extra
        self.held = np.array([node.held is not None or np.isinf(self._last(node)) for node in nodes.values()])
        self.ends = [np.array(node.ends, int) for node in nodes.values()]
        self.lossy = {
            k: losses_of(name, line) for k, (name, line) in enumerate(description.lines.items()) if line.losses
        }
        self.bundles = bundles_of(description)
        self.measured = [node.measured for node in nodes.values()]
        self.loads = [self._polynomials(*each) for each in zip(nodes.values(), self.totals, self.held, strict=True)]
        edges = np.cumsum([0, *(len(group.nodes) for group in groups)])
        last = [self._branches(group) for group in groups]
        self.groups = [(np.arange(*span), branches) for span, branches in zip(pairwise(edges), last, strict=True)]

    def _check(self, description: Description) -> None:
        description.check_linear("transfer functions and growth rates")

    def _last(self, node: Node) -> float:
        return node.switched(np.inf)

    def _branches(self, group: Group) -> list[Branch]:
        return [branch.before(np.inf) for branch in group.branches]

    def _polynomials(self, node: Node, total: float, held: bool) -> tuple[NDArray, NDArray]:
        """Coefficients of p and of f = Y p + q, one scale for both; p = 0 where the effort is held."""
        if held:
            return np.zeros(1), np.ones(1)
        if node.load is None:
            return np.ones(1), np.array([total])
        p, q = node.load.numerator, node.load.denominator
        through = [a / Fraction(self.second) ** k for k, a in enumerate(reversed(p))][::-1]
        rest = [b / Fraction(self.second) ** k for k, b in enumerate(reversed(q))][::-1]
        over = [a * Fraction(total) for a in through]
        scale = max(map(abs, over + rest))
        f = np.polyadd([float(a / scale) for a in over], [float(b / scale) for b in rest])
        return np.array([float(a / scale) for a in through]), f

    @property
    def size(self) -> int:
        """Number of line ends."""
        return 2 * len(self.z0)

    def sides(self, s: NDArray) -> tuple[NDArray, NDArray]:
        """Values of p and f of all nodes; two arrays of shape (n, nodes) for s of shape (n,)."""
        found = []
        for (p, f), load, total, held in zip(self.loads, self.measured, self.totals, self.held, strict=True):
            if load is None or held:
                found.append((np.polyval(p, s), np.polyval(f, s)))
            else:
                found.append(self._measured(load, total, s))
        p, f = zip(*found, strict=True)
        return np.stack(p, axis=1), np.stack(f, axis=1)

    def _measured(self, load: Any, total: float, s: NDArray) -> tuple[NDArray, NDArray]:
        """Values of p and f of a measured load with poles a and S = (Z - z0)/(Z + z0): Z = z0 (1 + S)/(1 - S)."""
        model = load.model.model
        S = model.at(s / (1j * self.second))
        a = np.concatenate([model.poles, model.poles[model.poles.imag > 0].conj()]) * self.second
        size, p = np.prod(s[..., None] - a, axis=-1), load.z0 * (1 + S)
        return size * p, size * (1 - S + total * p)

    def balances(self, s: NDArray) -> Iterator[Parts]:
        """Yield for each group its nodes, their p, and the matrix of efforts and of flows into branches.

        Shapes (k,), (n, k) and (n, k + flows, k + flows).
        """
        p, f = self.sides(s)
        for nodes, branches in self.groups:
            k, row = len(nodes), len(nodes)
            matrix = np.zeros((len(s), *2 * [k + sum(len(branch.nodes) for branch in branches)]), complex)
            matrix[:, range(k), range(k)] = f[:, nodes]
            for branch in branches:
                flows = np.arange(row, row + len(branch.nodes))
                through, binding = self._bound(branch, s)
                for j, node in enumerate(branch.nodes):  # which may have several of them
                    matrix[:, flows, node] += through[:, :, j]
                matrix[:, flows[:, None], flows] = binding
                matrix[:, branch.nodes, flows] = p[:, nodes[branch.nodes]]
                row += len(branch.nodes)
            yield nodes, p[:, nodes], matrix

    def _bound(self, branch: Branch, s: NDArray) -> tuple[NDArray, NDArray]:
        """Return M and N of a branch, M u + N i = 0, with its states eliminated."""
        M, N, E, Q, P, R = branch.ports
        states = np.linalg.solve(s[:, None, None] / self.second * np.eye(len(Q)) - Q, np.hstack([P, R])[None])
        less = E @ states
        return M - less[:, :, : len(M)], N - less[:, :, len(M) :]

    @staticmethod
    def answered(balances: Iterable[Parts]) -> Iterator[Parts]:
        """Yield for each group its nodes, their p, and W: efforts are W times (p × inflow, or the held effort)."""
        for nodes, p, matrix in balances:
            k = len(nodes)
            yield nodes, p, 1 / matrix if matrix.shape[1] == 1 else np.linalg.inv(matrix)[:, :k, :k]

    def passage(self, s: NDArray) -> Passage:
        """Transmission and reflection of lines by the sending end, and of coupled conductors whose modes mix."""
        across = np.exp(-np.outer(s, self.delays))
        back = np.zeros_like(across)
        for k, line in self.lossy.items():
            across[:, k], back[:, k] = carried(line, self.z0[k], s / self.second)
        mixed = []
        for bundle in self.bundles.values():
            own, other = bundle.admittances(s / self.second, np.zeros((len(s), len(bundle.lines))))
            same, one = (bundle.z0[:, None] * each for each in (own + other, own - other)), np.eye(len(bundle.lines))
            alike, opposite = (np.linalg.solve(one + each, one - each) for each in same)
            mixed.append((bundle.lines, (alike - opposite) / 2, (alike + opposite) / 2))
        return Passage(np.repeat(across, 2, axis=1), np.repeat(back, 2, axis=1), mixed)

    def returned(self, s: NDArray) -> NDArray:
        """Loop matrix P S of arriving waves, shape (n, ends, ends) for s of shape (n,)."""
        return self.sent_back(self.passage(s), self.answered(self.balances(s)))

    def sent_back(self, passage: Passage, answers: Iterable[Parts]) -> NDArray:
        """Loop matrix P S from the passage of the lines and the responses of the nodes."""
        matrix = np.zeros((len(passage.across), self.size, self.size), complex)
        for nodes, p, W in answers:
            ends = np.concatenate([self.ends[node] for node in nodes])
            at = np.repeat(np.arange(len(nodes)), [len(self.ends[node]) for node in nodes])
            scattering = 2 * (W * p[:, None])[:, at[:, None], at] / self.z0[ends // 2] - np.eye(len(ends))
            matrix[:, ends[:, None], ends] = scattering
        return passage.arriving(matrix)


def answers(network: Scattering, s: NDArray, held: NDArray, flows: NDArray) -> tuple[NDArray, NDArray]:
    """Waves arriving at the ends of lines, and efforts of the nodes, under efforts held and flows, (nodes,)."""
    parts = np.array_split(s, int(len(s) * network.size**2 / CHUNK) + 1)
    arriving, efforts = zip(*(_answers(network, part, held, flows) for part in parts), strict=True)
    return np.concatenate(arriving), np.concatenate(efforts)


def _answers(network: Scattering, s: NDArray, held: NDArray, flows: NDArray) -> tuple[NDArray, NDArray]:
    responses, passage = list(network.answered(network.balances(s))), network.passage(s)
    efforts, sent = np.empty((len(s), len(network.names)), complex), np.zeros((len(s), network.size, 1), complex)
    for nodes, p, W in responses:
        efforts[:, nodes] = (W @ (held[nodes] + p * flows[nodes])[:, :, None])[:, :, 0]
        for node in nodes:
            sent[:, network.ends[node], 0] = 2 * efforts[:, node, None]
    loop = np.eye(network.size) - network.sent_back(passage, responses)
    arriving = np.linalg.solve(loop, passage.arriving(sent))[:, :, 0]
    for nodes, p, W in responses:
        into = [(arriving[:, ends] / network.z0[ends // 2]).sum(axis=1) for ends in (network.ends[k] for k in nodes)]
        efforts[:, nodes] += (W @ (p * np.stack(into, axis=1))[:, :, None])[:, :, 0]
    return arriving, efforts
