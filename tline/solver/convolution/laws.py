"""Laws beside a linear rest with memory, by the rest's weights of Radau's quadrature, slab by slab.

In waves about those before t = 0, α = c + S ∗ β with S = (Z - ρ)(Z + ρ)^-1 of the rest. A slab is one system in S_0 for
the laws that interact at once. The waves of earlier slabs are a sum: within blocks it is added up directly, and from
one block to the next, each as long as all before it, by Fourier transforms, in O(n log² n).

References
----------
E. Hairer, C. Lubich, M. Schlichte: Fast numerical solution of nonlinear Volterra convolution equations, SIAM J. Sci.
Stat. Comput. 6 (1985) 532-541, doi:10.1137/0906037.
"""

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from tline.compiled.structure import Packed, empty, pack
from tline.errors import NoFlowError
from tline.solver.assembly.workspace import work_for
from tline.solver.convolution.fronts import Fronts, Tangents
from tline.solver.convolution.nodal import LinearRest
from tline.solver.convolution.quadrature import Quadrature
from tline.solver.description.description import Description
from tline.solver.description.excitation import EDGE, Shape
from tline.solver.description.groups import Group, parts
from tline.solver.description.laws import laws_of, started, states_of, units_of_laws, with_basis
from tline.solver.description.switches import Moving
from tline.solver.kernel.laws.convolved import Convolution, advance_convolved
from tline.solver.kernel.network import Laws, Network, Run, State, Units
from tline.solver.kernel.units import law_addresses
from tline.solver.radau import Basis
from tline.solver.steady.steady_state import Before

BLOCK = 32  # slabs whose past is summed directly
APART = 1e-11  # of a wave; laws that send each other less within a slab do not interact at once
STEEP = 1e-9  # least share of a wave that a law sends back with its sign, for its tangent


class LawsAtPorts:
    """Laws and switches of a scene, with their state before t = 0."""

    def __init__(self, description: Description, network: LinearRest, before: Before):
        self.network, self.elements = network, network.laws
        effort: dict[str | None, float] = {**before.effort, None: 0.0}
        across = np.array([effort[e.from_node] - effort[e.to_node] for e in self.elements])
        through = dict(before.through)
        for element, e in zip(self.elements, across.tolist(), strict=True):
            if isinstance(element.law.factor, Moving):
                through[element.where] = element.law.factor.before * (e - element.above_level)
        laws = Group([*description.nodes.values()], [], self.elements, [])
        packed, self.controls = laws_of([laws], network.impedances.tolist(), 0, 0)
        self.moving = np.flatnonzero(packed.excitation_row >= 0).tolist()
        self.packed = started(packed, self.elements, before.effort, through, before.openings)
        self.states = states_of(self.elements, before.effort, before.openings)
        self.sent_before = 2 * across - self.packed.before

    def moves(self, t_end: float) -> NDArray:
        """Instants at which control signals jump or bend, s."""
        moves = np.unique(np.concatenate([np.empty(0), *(control.breaks(t_end) for control in self.controls)]))
        return moves[moves > 0]

    def fronts(self, tangents: Tangents, order: Basis, h: float, t_end: float) -> Iterator[Fronts]:
        """Yield what each law that moves at an edge of slabs sends there."""
        for k, control in zip(self.moving, self.controls, strict=True):
            at = control.breaks(t_end)
            at = at[(at > 0) & (at < t_end)]
            found = [tangents.front(k, round(t / h), order, h) for t in at.tolist()]
            node, weight = np.nonzero(self.network.ports[k])[0], -self.network.ports[k]
            jump, bend = np.array(found).reshape(-1, 2).T
            yield Fronts([(n, float(weight[n])) for n in node.tolist()], False, at, jump, bend)

    def waves(
        self, rule: Quadrature, order: Basis, h: float, ahead: float, driven: NDArray, from_laws: NDArray
    ) -> tuple[NDArray, Tangents]:
        """Transforms of the waves out of all laws, beyond those before t = 0, shape (points, K); and laws on slabs.

        Slabs of width h, s, begin `ahead` of them before t = 0; efforts are those at all points of the rule,
        under sources (points, N) and under each law (points, N, K).
        """
        ports, K = self.network.ports, len(self.elements)
        given = rule.backward(2 * np.einsum("pn,kn->pk", driven, ports))  # no threads of BLAS for so thin a product
        weights = rule.weights(2 * ports @ from_laws - np.eye(K))
        seen = np.abs(weights[0].reshape(K, order.s, K, order.s)).max(axis=(1, 3)) > APART
        here, there = np.nonzero(seen)
        part = parts(here, there, K)
        chosen = np.argsort(part, kind="stable")
        points = (chosen[:, None] * order.s + np.arange(order.s)).ravel()
        weights = np.ascontiguousarray(weights[:, points[:, None], points])
        given = np.ascontiguousarray(given[:, :, chosen].transpose(0, 2, 1).reshape(rule.n, -1))
        first = np.append(np.searchsorted(part[chosen], np.arange(part.max() + 1)), K)
        found = self._marched(weights, given, (chosen, first), order, h, ahead)
        back = np.argsort(chosen)
        sent, flow, slope = (each.reshape(rule.n, K, order.s).transpose(0, 2, 1)[:, :, back] for each in found)
        rho = self.network.impedances
        stateless = np.array([not element.kind.states for element in self.elements])
        slope = np.where(stateless, slope, 0.5 / rho)
        tangents = Tangents(sent + self.sent_before + rho * flow, flow, slope / np.maximum(1 - rho * slope, STEEP))
        return rule.forward(sent), tangents

    def _laws(self, order: Basis, h: float, chosen: NDArray, first: NDArray) -> Laws:
        laws = with_basis(self.packed, order, h, self.packed.record_row)
        each = "kind from_node to_node excitation_row control at state_at governor governor_state source_impedance"
        moved = {name: getattr(laws, name)[chosen] for name in (*each.split(), "before", "record_row")}
        return laws._replace(first=first, governed=np.zeros(len(first) - 1, bool), **moved)

    def _marched(
        self, weights: NDArray, given: NDArray, grouped: tuple[NDArray, NDArray], order: Basis, h: float, ahead: float
    ) -> tuple[NDArray, NDArray, NDArray]:
        """Waves out of the laws, beyond those before t = 0, flows through them and slopes of these, (n, K s) each."""
        (chosen, first), s, n = grouped, order.s, len(given)
        laws, rest = self._laws(order, h, chosen, first), np.repeat(self.sent_before[chosen], s)
        maps, given = [], given + np.repeat(laws.before, s)
        for low, high in zip(first[:-1] * s, first[1:] * s, strict=True):
            at_once = weights[0, low:high, low:high]
            maps.append((np.eye(high - low) + at_once).ravel() / 2)
            given[:, low:high] -= at_once @ rest[low:high]
        map_at, sent = np.cumsum([0, *map(len, maps)])[:-1], np.zeros_like(given)
        flow, slope = np.zeros_like(given), np.zeros_like(given)
        signals = [self.controls[row] if row >= 0 else None for row in laws.excitation_row]
        each = zip(signals, laws.control.tolist(), strict=True)
        control = np.array([_over_time(signal, now, order, h, ahead, n) for signal, now in each])
        run = _run(laws, np.concatenate(maps), self.states.copy(), s)
        run.work.circuit.largest[0] = np.abs(given).max()
        job = pack(Convolution(run, weights[1:], map_at, given, rest, sent, flow, slope, control))
        _Past(weights, given, sent).advance(0, n, lambda begin, end: self._advance(job, begin, end, h))
        return sent, flow, slope

    def _advance(self, job: Packed, begin: int, end: int, h: float) -> None:
        slab = advance_convolved(job, begin, end, h)
        if slab >= 0:
            where = " and ".join(element.where for element in self.elements)
            raise NoFlowError(where, f"no flow was found at {slab * h:.6g} s", "narrower slabs")


class _Past:
    """Waves given to slabs, and waves sent by them; n slabs of M points."""

    def __init__(self, weights: NDArray, given: NDArray, sent: NDArray):
        self.weights, self.given, self.sent = weights, given, sent
        self.transforms: dict[int, NDArray] = {}

    def advance(self, begin: int, end: int, block: Callable[[int, int], None]) -> None:
        """Advance slabs from `begin` to `end`, by blocks whose past is given to them before."""
        if end - begin <= BLOCK:
            block(begin, end)
            return
        half = BLOCK
        while 2 * half < end - begin:
            half *= 2
        middle = begin + half
        self.advance(begin, middle, block)
        if 2 * half not in self.transforms:
            self.transforms[2 * half] = np.fft.rfft(self.weights[: 2 * half], 2 * half, axis=0)
        waves = np.fft.rfft(self.sent[begin:middle], 2 * half, axis=0)
        due = np.fft.irfft((self.transforms[2 * half] @ waves[:, :, None])[:, :, 0], 2 * half, axis=0)
        self.given[middle:end] += due[half : half + end - middle]
        self.advance(middle, end, block)


def _run(laws: Laws, step: NDArray, states: NDArray, s: int) -> Run:
    """Pack a run of units of laws, without lines and with unnumbered nodes."""
    nodes = np.zeros(len(laws.first), np.int64)
    network = empty(Network)._replace(first=np.zeros(1, np.int64), group=nodes, step=step, laws=laws)
    state = empty(State)._replace(before=np.zeros((1, s)), load=states)
    units = empty(Units)._replace(law=law_addresses(units_of_laws(laws)))
    return Run(network, state, units, work_for(network, state), np.empty((0, 0)), np.empty((0, 2, 0)))


def _over_time(signal: Shape | None, now: float, order: Basis, h: float, ahead: float, n: int) -> NDArray:
    """A control signal at the points of n slabs, or the value that it always has."""
    if signal is None:
        return np.full(n * order.s, now)
    slab, inside = np.arange(n)[:, None] - ahead, np.minimum(order.c, 1 - EDGE)  # at a slab's end the value before it
    t, inside = (((slab + places) * h).ravel() for places in (order.c, inside))
    return np.where(inside < 0, now, signal.value(np.maximum(t, 0.0), np.maximum(inside, 0.0)))
