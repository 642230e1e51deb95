"""Waves of a linear scene as rays: each left its source once and is scattered at every node on its path.

A ray that has passed lines of delays T1, T2, ... is exp(-s (T1 + T2 + ...)) times a rational function of s; the delay
is kept as a fraction and the function as partial fractions, so that each ray in time is a closed form that begins at an
exact instant (L. V. Bewley, Traveling Waves on Transmission Systems, 2nd ed., Wiley 1951, chapter 4).
"""

import heapq
from collections import defaultdict
from collections.abc import Callable, Iterable
from fractions import Fraction
from typing import Any

from flint import acb, arb, fmpq, fmpq_poly

from tline.errors import InputError
from tline.scene.scene import Scene
from tline.study.reference.motion import ExponentialSum, Pole, Ray, rational, roots
from tline.study.reference.network import ReferenceNetwork, ReferenceNode, decimal, level, starts, straight, switched
from tline.words.wording import place

MOST_ARRIVALS = 200_000  # of rays at nodes

Begun = list[tuple[Fraction, ExponentialSum]]  # motions and the instants at which they begin


class Scatterer:
    """Junction in s: effort u = F (sum of w/z0 + J), with F = 1/(Y + 1/Z); 2u - w leaves each end."""

    def __init__(self, name: str, junction: ReferenceNode, z0: list[Fraction]):
        self.held, self.ends = junction.held, junction.ends
        self.admittance = {end: rational(1 / z0[end // 2]) for end in junction.ends}
        self.zeros: list[Pole] = []
        self.poles: list[Pole] = []
        self.gain = fmpq(0)
        if junction.held:
            return
        p, q = fmpq_poly([1]), fmpq_poly([0])
        if junction.load is not None:
            p, q = (
                fmpq_poly([rational(c) for c in reversed(side)])
                for side in (junction.load.numerator, junction.load.denominator)
            )
        f = p * rational(junction.conductance) + q
        if f.degree() < p.degree():
            raise InputError(f"node '{name}'", "its loads cancel the conductance of the lines: no wave is defined")
        self.gain = p.leading_coefficient() / f.leading_coefficient()
        self.zeros, self.poles = roots(p), roots(f)

    def effort(self, flow: Ray) -> Ray:
        """Effort caused by a flow into the junction."""
        return flow.through(self.gain, self.zeros, self.poles)

    def scattered(self, arriving: dict[int, Ray]) -> Iterable[tuple[int, Ray]]:
        """Waves that leave each end when these waves arrive."""
        if self.held or self.poles:
            u = Ray() if self.held else self.effort(_sum(w * self.admittance[end] for end, w in arriving.items()))
            return [(end, u * fmpq(2) + arriving.get(end, Ray()) * fmpq(-1)) for end in self.ends]
        share = {end: 2 * self.gain * y for end, y in self.admittance.items()}
        out = {end: _sum(w * (share[e] - (e == end)) for e, w in arriving.items()) for end in self.ends}
        return out.items()


def _sum(rays: Iterable[Ray]) -> Ray:
    total = Ray()
    for ray in rays:
        total = total + ray
    return total


def rays(
    network: ReferenceNetwork, scatterers: dict[str, Scatterer], node: str, until: Fraction, line: int
) -> tuple[dict[Fraction, Ray], dict[Fraction, Ray]]:
    """Waves that leave ends 1 and 2 of a line after a unit impulse at a node, by the delay so far.

    The impulse is one of effort where that is prescribed, else of flow.
    """
    first = scatterers[node]
    u = Ray(acb(1)) if first.held else first.effort(Ray(acb(1)))
    leaving: dict[int, dict[Fraction, Ray]] = {2 * line: {}, 2 * line + 1: {}}
    under_way: dict[tuple[Fraction, str], dict[int, Ray]] = defaultdict(dict)
    queue: list[tuple[Fraction, str]] = []

    def send(now: Fraction, end: int, wave: Ray) -> None:
        if wave.silent:
            return
        if end in leaving:
            leaving[end][now] = leaving[end][now] + wave if now in leaving[end] else wave
        key = now + network.delay[end // 2], network.node[end ^ 1]
        if key[0] > until:
            return
        if key not in under_way:
            heapq.heappush(queue, key)
        under_way[key][end ^ 1] = wave

    for end in first.ends:
        send(Fraction(0), end, u * fmpq(2))
    for _ in range(MOST_ARRIVALS):
        if not queue:
            return leaving[2 * line], leaving[2 * line + 1]
        now, at = key = heapq.heappop(queue)
        for end, wave in scatterers[at].scattered(under_way.pop(key)):
            send(now, end, wave)
    raise InputError("scene", "too many reflections for an exact solution", f"at most {MOST_ARRIVALS:,}")


def arrivals(network: ReferenceNetwork, probe: str, until: Fraction) -> tuple[Begun, Begun]:
    """Components of waves a and b at a probe: motions, and the instants before `until` at which they begin."""
    line, share = network.seen_by(probe)
    delay = network.delay[line]
    scatterers = {name: Scatterer(name, each, network.z0) for name, each in network.junctions.items()}
    begun: tuple[Begun, Begun] = [], []
    for node, junction in network.junctions.items():
        if not junction.drives:
            continue
        sides = rays(network, scatterers, node, until, line)
        started = [
            (at, motion * rational(factor))
            for shape, factor in junction.drives
            for at, motion in starts(shape, until, f"node '{node}'")
        ]
        if len(started) * sum(map(len, sides)) > MOST_ARRIVALS:
            problem = f"{len(started):,} corners times {sum(map(len, sides)):,} reflections are too many"
            raise InputError(f"node '{node}'", problem, f"at most {MOST_ARRIVALS:,}")
        for wave, side, way in zip(begun, sides, (share * delay, (1 - share) * delay), strict=True):
            wave += [
                (at + passed + way, ray.driven(motion))
                for passed, ray in side.items()
                for at, motion in started
                if at + passed + way < until
            ]
    return begun


def sampled(begun: Begun, times: list[Fraction]) -> list[arb]:
    """Sum of the motions that have begun, at instants in order of time; at a jump the value before it."""
    order, values = iter(sorted(begun, key=lambda each: each[0])), []
    now, carried = Fraction(0), ExponentialSum()
    following = next(order, None)
    for t in times:
        while following is not None and following[0] < t:
            carried = carried.shifted(following[0] - now) + following[1]
            now, following = following[0], next(order, None)
        values.append(carried.at(t - now))
    return values


MOST_WAVES = 500_000

Arrival = tuple[Fraction, int]  # instant and end


def lattice(
    scene: Scene, times: Iterable[Any], probe: str, number: Callable[[Any], Any] = Fraction
) -> tuple[list[Any], list[Any]]:
    """Effort and flow of a resistive scene, at rest before t = 0, from its lattice diagram.

    Lines, resistors, switches, and sources with straight pieces, computed in numbers of a type: Fraction (exact),
    float, mpmath.mpf. Instants are in s; a float counts as its shortest decimal.

    A wave that arrives at an end left the other end one delay before, when 2u - w left a node where w arrived. Instants
    are fractions, so simultaneous arrivals are exactly equal; at a jump the value is that before it.

    References
    ----------
    L. V. Bewley, Traveling Waves on Transmission Systems, 2nd ed., Wiley 1951, chapter 4.
    """
    network = ReferenceNetwork(scene)
    refuse_unless_resistive(network)
    line, share = network.seen_by(probe)
    instants, delay = [instant(t) for t in times], network.delay[line]
    trace = _Trace(network, number, max(instants, default=Fraction(0)))
    # a arrives at end 2 later by the rest of the way, b at end 1
    ways = [(2 * line + 1, (1 - share) * delay), (2 * line, share * delay)]
    a, b = ([trace.wave((t + way, end)) for t in instants] for end, way in ways)
    half = number(1) / number(2)
    z0 = trace.converted(network.z0[line])
    return [(p + q) * half for p, q in zip(a, b, strict=True)], [(p - q) * half / z0 for p, q in zip(a, b, strict=True)]


def instant(t: Any) -> Fraction:
    """Convert an instant to a fraction; a float counts as its shortest decimal."""
    return t if isinstance(t, Fraction) else Fraction(repr(float(t)) if isinstance(t, float) else str(t))


def refuse_unless_resistive(network: ReferenceNetwork) -> None:
    """Raise an error for elements that have no lattice."""
    for node in network.loaded():
        raise InputError(f"node '{node}'", "not resistive: the lattice has no place for its load", "resistances")
    for name, source in network.scene.sources.items():
        if straight(source.value, decimal(network.scene.t_end)) is None:
            raise InputError(place("sources", name), "its waveform is curved", "one of straight pieces")


class _Trace:
    """Known waves, and their dependence on each other."""

    def __init__(self, network: ReferenceNetwork, number: Callable[[Any], Any], until: Fraction):
        self.network, self.number, self.known = network, number, {}
        self.drives = {
            name: [(straight(shape, until) or [], factor) for shape, factor in junction.drives]
            for name, junction in network.junctions.items()
        }

    def converted(self, value: Fraction) -> Any:
        return self.number(value.numerator) / self.number(value.denominator)

    def wave(self, wanted: Arrival) -> Any:
        """Wave of an arrival; all earlier ones that it depends on are computed first."""
        waiting = [wanted]
        while waiting:
            arrival = waiting[-1]
            missing = [] if arrival in self.known else [w for w in self._before(arrival) if w not in self.known]
            if missing:
                waiting += missing
                continue
            if arrival not in self.known:
                self.known[arrival] = self._follows(arrival)
                if len(self.known) > MOST_WAVES:
                    raise InputError("scene", "too many waves for the lattice", f"at most {MOST_WAVES:,}")
            waiting.pop()
        return self.known[wanted]

    def _left(self, arrival: Arrival) -> tuple[Fraction, ReferenceNode, str, int]:
        t, end = arrival
        name = self.network.node[end ^ 1]
        return t - self.network.delay[end // 2], self.network.junctions[name], name, end ^ 1

    def _before(self, arrival: Arrival) -> list[Arrival]:
        """Waves at the node of departure, at that instant."""
        t, junction, _, end = self._left(arrival)
        return [] if t <= 0 else [(t, end)] if junction.held else [(t, other) for other in junction.ends]

    def _follows(self, arrival: Arrival) -> Any:
        """Compute 2u - w at the node of departure, from the waves that arrived there."""
        t, junction, name, end = self._left(arrival)
        if t <= 0:
            return self.number(0)
        driven = self.converted(sum((f * level(pieces, t) for pieces, f in self.drives[name]), Fraction(0)))
        closed = switched(junction, t)
        if junction.held:
            u = driven
        elif closed is None:
            u = self.number(0)
        else:
            coming = (self.known[t, e] / self.converted(self.network.z0[e // 2]) for e in junction.ends)
            u = sum(coming, driven) / self.converted(junction.conductance + closed)
        return 2 * u - self.known[t, end]
