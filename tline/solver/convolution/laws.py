"""Laws beside a linear rest with memory, by the rest's weights of Radau's quadrature, slab by slab.

In waves about those before t = 0, α = c + S ∗ β with S = (Z - ρ)(Z + ρ)^-1 of the rest. A slab is one system in S_0 for
the laws that interact at once. The waves of earlier slabs are a sum: within blocks it is added up directly, and from
one block to the next, each as long as all before it, by Fourier transforms, in O(n log² n).

References
----------
E. Hairer, C. Lubich, M. Schlichte: Fast numerical solution of nonlinear Volterra convolution equations, SIAM J. Sci.
Stat. Comput. 6 (1985) 532-541, doi:10.1137/0906037.

Where laws jump at instants that no slabs of one width have at edges, each of these has a clock of slabs with it at an
edge. On one clock a law stays as it is before its next jump; on the next only the change due to that jump is sought.
"""

from collections.abc import Callable, Iterator
from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.compiled.structure import Packed, empty, pack
from tline.distinct import distinct
from tline.errors import NoFlowError
from tline.solver.assembly.workspace import work_for
from tline.solver.convolution.families import SAME_FAMILY, changes_of, leads
from tline.solver.convolution.nodal import LinearRest
from tline.solver.convolution.quadrature import Quadrature
from tline.solver.description.description import Description
from tline.solver.description.excitation import EDGE
from tline.solver.description.given import Straight
from tline.solver.description.groups import Group, parts
from tline.solver.description.laws import laws_of, started, states_of, units_of_laws, with_basis
from tline.solver.kernel.laws.convolved import Convolution, advance_convolved
from tline.solver.kernel.network import Laws, Network, Run, State, Units
from tline.solver.kernel.units import law_addresses
from tline.solver.radau import Basis
from tline.solver.steady.steady_state import Before

BLOCK = 32  # slabs whose past is summed directly
APART = 1e-11  # of a wave; laws that send each other less within a slab do not interact at once
LEAST, DIGITS = 1e-4, 6  # of a tangent over its matched conductance, or the reverse; and of its logarithm
MOST_CLOCKS = 16  # clocks of slabs for jumps of laws


class Clock(NamedTuple):
    """Slabs that begin earlier than those of the scene: the first on which laws answer, and the next jump of one."""

    ahead: float  # slabs
    first: int
    until: float = inf  # s


class Fronts(NamedTuple):
    """Fronts that hold the effort at a node, or drive flows into nodes by weights."""

    into: list[tuple[int, float]]
    held: bool
    at: NDArray  # (fronts,) s
    jump: NDArray
    bend: NDArray  # 1/s

    def sizes(self, h: float) -> NDArray:
        """Largest jump and bend, the latter within a time h."""
        return np.array([np.abs(each).max(initial=0.0) for each in (self.jump, self.bend * h)])

    def some(self, chosen: list[int]) -> "Fronts":
        """Some of the fronts."""
        return self._replace(**{name: getattr(self, name)[chosen] for name in ("at", "jump", "bend")})


class Tangents(NamedTuple):
    """Laws at all points of slabs, (n, s, K): i = i0 + g (e - e0) across each, with few different g, none extreme."""

    effort: NDArray
    flow: NDArray
    conductance: NDArray

    def front(self, law: int, slab: int, order: Basis, h: float) -> tuple[float, float]:
        """Jump and bend, at the beginning of a slab, of the flow that a law has beyond its tangent behind it."""
        flow = self.flow[:, :, law] - self.conductance[slab, -1, law] * self.effort[:, :, law]
        powers, value = np.arange(order.s), order.evaluation([0.0, 1.0])
        slope = 2 / h * (powers * np.array([[-1.0], [1.0]]) ** np.maximum(powers - 1, 0)) @ order.to_powers
        before, behind = flow[slab - 1], flow[slab]
        return float(value[0] @ behind - value[1] @ before), float(slope[0] @ behind - slope[1] @ before)


class LawsAtPorts:
    """Laws and switches of a scene, with their state before t = 0."""

    def __init__(self, description: Description, network: LinearRest, before: Before):
        self.network, self.elements = network, network.laws
        effort: dict[str | None, float] = {**before.effort, None: 0.0}
        across = np.array([effort[e.from_node] - effort[e.to_node] for e in self.elements])
        through = dict(before.through)
        for element, e in zip(self.elements, across.tolist(), strict=True):
            if isinstance(element.law.factor, Straight):  # a switch
                through[element.where] = element.control * (e - element.above_level)
        laws = Group([*description.nodes.values()], [], self.elements, [])
        packed, self.controls = laws_of([laws], network.impedances.tolist(), 0, 0)
        self.moving = np.flatnonzero(packed.excitation_row >= 0).tolist()
        self.packed = started(packed, self.elements, before.effort, through, before.openings)
        self.states = states_of(self.elements, before.effort, before.openings)
        self.sent_before = 2 * across - self.packed.before
        t_end = description.t_end
        moves = distinct(np.concatenate([np.empty(0), *(control.breaks(t_end) for control in self.controls)]))
        self.moves = moves[moves > 0]  # instants at which control signals jump or bend, s
        changes = [changes_of(control, True, t_end) for control in self.controls]
        self.jumps = [each.at[(each.jump != 0) & (each.at > 0)] for each in changes]

    def clocks(self, h: float) -> list[Clock]:
        """Slabs of width h from t = 0 on, and for each jump of a law that is at no edge of those before."""
        first = leads(self.moves / h)
        several = len(first) > 1 and not len(self.states)
        jumps = distinct(np.concatenate([*self.jumps, np.empty(0)])) if several else np.empty(0)
        first = leads(jumps[:1] / h) if len(jumps) else first
        found = [Clock(float(first[0]) if len(first) == 1 else 0.0, 0)]
        for at in jumps.tolist():
            ahead = float(leads(np.array([at / h]))[0])
            if abs((ahead - found[-1].ahead + 0.5) % 1.0 - 0.5) > SAME_FAMILY:
                found = [*found[:-1], found[-1]._replace(until=at), Clock(ahead, round(at / h + ahead))]
        return found if len(found) <= MOST_CLOCKS else [Clock(0.0, 0)]

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
        self, rule: Quadrature, order: Basis, clocks: list[Clock], driven: NDArray, from_laws: NDArray
    ) -> Iterator[tuple[NDArray, Tangents]]:
        """Yield transforms of the waves out of all laws, beyond those before t = 0, (points, K); and laws on slabs.

        These are parts that add up, on one clock each.

        Efforts are those at all points of the rule, under sources on the first clock (points, N) and under each law
        (points, N, K).
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
        first = np.append(np.searchsorted(part[chosen], np.arange(part.max() + 1)), K)
        laws = self._laws(order, rule.h, chosen, first)
        given = given[:, :, chosen].transpose(0, 2, 1).reshape(rule.n, -1) + np.repeat(laws.before, order.s)
        out = np.tile(np.repeat(self.sent_before[chosen], order.s), (rule.n, 1))
        before, back = clocks[0], np.argsort(chosen)
        for clock in clocks:
            if clock is not before:
                given, out = (_on_clock(each, before.ahead - clock.ahead, order) for each in (given, out))
            given, sent, flow, slope = self._marched(weights, given, out, laws, order, rule.h, clock)
            before, out = clock, out + sent
            found = (each.reshape(rule.n, K, order.s).transpose(0, 2, 1) for each in (sent, out, flow, slope))
            sent_there, *answers = (each[:, :, back] for each in found)
            yield rule.forward(sent_there), self._tangents(*answers)

    def _tangents(self, out: NDArray, flow: NDArray, slope: NDArray) -> Tangents:
        """Laws by waves out of them, flows, and slopes of these, (n, s, K); of those with a state about any slope."""
        rho = self.network.impedances
        stateless = np.array([not element.kind.states for element in self.elements])
        seen = np.where(stateless, rho * slope, 0.5)
        seen = np.clip(seen / np.maximum(1 - seen, LEAST), LEAST, 1 / LEAST)
        return Tangents(out + rho * flow, flow, 10 ** np.round(np.log10(seen), DIGITS) / rho)

    def _laws(self, order: Basis, h: float, chosen: NDArray, first: NDArray) -> Laws:
        laws = with_basis(self.packed, order, h, self.packed.record_row)
        each = "kind from_node to_node excitation_row control at state_at governor governor_state source_impedance"
        moved = {name: getattr(laws, name)[chosen] for name in (*each.split(), "before", "record_row")}
        return laws._replace(first=first, governed=np.zeros(len(first) - 1, bool), **moved)

    def _marched(
        self, weights: NDArray, given: NDArray, out: NDArray, laws: Laws, order: Basis, h: float, clock: Clock
    ) -> tuple[NDArray, NDArray, NDArray, NDArray]:
        """Waves into laws and, from a clock's first slab on, those out of them beyond `out`, flows, and slopes."""
        given, s, n = given.copy(), order.s, len(given)
        sent, flow, slope = (np.zeros_like(given) for _ in range(3))
        spans = list(zip(laws.first[:-1] * s, laws.first[1:] * s, strict=True))
        at_once = [weights[0, low:high, low:high] for low, high in spans]
        for (low, high), own in zip(spans, at_once, strict=True):
            given[:, low:high] -= out[:, low:high] @ own.T
        maps = [(np.eye(len(own)) + own).ravel() / 2 for own in at_once]
        map_at = np.cumsum([0, *map(len, maps)])[:-1]
        each = zip(laws.excitation_row.tolist(), laws.control.tolist(), strict=True)
        control = np.array([self._over_time(row, now, order, h, clock, n) for row, now in each])
        run = _run(laws, np.concatenate(maps), self.states.copy(), s)
        run.work.circuit.largest[0] = np.abs(given).max()
        job = pack(Convolution(run, weights[1:], map_at, given, out, sent, flow, slope, control))
        _Past(weights, given, sent).advance(clock.first, n, lambda begin, end: self._advance(job, begin, end, h))
        for (low, high), own in zip(spans, at_once, strict=True):
            given[:, low:high] += (out + sent)[:, low:high] @ own.T
        return given, sent, flow, slope

    def _over_time(self, row: int, now: float, order: Basis, h: float, clock: Clock, n: int) -> NDArray:
        """A control signal at the points of n slabs, up to a jump at the end of the clock; or its one value."""
        if row < 0:
            return np.full(n * order.s, now)
        inside = np.minimum(order.c, 1 - EDGE)  # at a slab's end the value before it
        slab, until = np.arange(n)[:, None] - clock.ahead, clock.until
        t, inside = (((slab + places) * h).ravel() for places in (order.c, inside))
        if (np.abs(self.jumps[row] - until) <= SAME_FAMILY * h).any():
            t, inside = np.minimum(t, until), np.minimum(inside, until - EDGE * h)
        return np.where(inside < 0, now, self.controls[row].value(np.maximum(t, 0.0), np.maximum(inside, 0.0)))

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


def _on_clock(waves: NDArray, late: float, order: Basis) -> NDArray:
    """Waves (n, K s) on slabs that begin later by that share of a slab, by least squares."""
    each = waves.reshape(len(waves), -1, order.s)
    back = int(late < 0)
    later, sooner = order.shift(1.0 - late % 1.0)
    each = np.concatenate([each[:1]] * back + [each, each[-1:]])
    return (each[:-1] @ sooner.T + each[1:] @ later.T)[: len(waves)].reshape(waves.shape)
