"""Exact lattice of a resistive scene: every wave traced back to the sources, in numbers of any type."""

from collections.abc import Callable, Iterable
from fractions import Fraction
from typing import Any

from tline.errors import InputError
from tline.scene.scene import Scene
from tline.study.reference.network import ReferenceNetwork, ReferenceNode, decimal, level, straight, switched
from tline.words.wording import place

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
