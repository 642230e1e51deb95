"""Scene as the reference solutions use it: nodes, delays and impedances as fractions, waveforms as pieces."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import count as count_from, pairwise, takewhile
from math import inf

from flint import acb, acb_poly, arb

from passivity import RationalFunction
from tline.errors import InputError
from tline.scene.load import Load, Matched, NoFlow, Reservoir, Short, Switch
from tline.scene.rational import RationalImpedance, Resistor
from tline.scene.refuse import refuse_floating, refuse_heights, refuse_losses
from tline.scene.scene import Scene
from tline.scene.waveform import Constant, DoubleExponential, Exponential, Points, Pulses, Shape, Sine, Step
from tline.study.reference.motion import ExponentialSum, rate, rational, rotation
from tline.words.wording import nearest, place

Straight = tuple[Fraction | None, Fraction, Fraction]  # start (None: ever since), level there, slope


def straight(shape: Shape, t_end: Fraction) -> list[Straight] | None:
    """Split a waveform into straight pieces in order of time; None if it is curved."""
    match shape:
        case Constant():
            return [(None, decimal(shape.level), Fraction(0))]
        case Step():
            return [(None, decimal(shape.from_), Fraction(0)), (decimal(shape.at), decimal(shape.to), Fraction(0))]
        case Points():
            times, levels = shape.points()
            return _between([(decimal(t), decimal(level)) for t, level in zip(times, levels, strict=True)])
        case Pulses():
            return _between(_corners(shape, t_end) or [(Fraction(0), decimal(shape.low))])
    return None


def _corners(pulses: Pulses, t_end: Fraction) -> list[tuple[Fraction, Fraction]]:
    low, high, period = decimal(pulses.low), decimal(pulses.high), decimal(pulses.period or 0.0)
    widths = [decimal(w) for w in (pulses.rise, pulses.width, pulses.fall)]
    begin, count = decimal(pulses.at), (pulses.count or inf) if period else 1
    first = max(int(-begin / period) - 1, 0) if period else 0  # at least one before t = 0, if there is any
    corners = []
    for k in takewhile(lambda k: k < count and begin + k * period <= t_end, count_from(first)):
        start = begin + k * period
        instants = [start + sum(widths[:j], Fraction(0)) for j in range(4)]
        corners += zip(instants, (low, high, high, low), strict=True)
    return corners


def _between(points: list[tuple[Fraction, Fraction]]) -> list[Straight]:
    pieces: list[Straight] = [(None, points[0][1], Fraction(0))]
    for (t, level), (after, then) in pairwise(points):
        if after > t:
            pieces.append((t, level, (then - level) / (after - t)))
    return [*pieces, (*points[-1], Fraction(0))]


def level(pieces: list[Straight], t: Fraction) -> Fraction:
    """Value of straight pieces at t; at a jump the one before it."""
    start, first, slope = next(piece for piece in reversed(pieces) if piece[0] is None or piece[0] < t)
    return first if start is None else first + slope * (t - start)


def motions(shape: Shape, t_end: Fraction, where: str) -> list[tuple[Fraction | None, ExponentialSum]]:
    """Split a waveform into motions, each counted from its start."""
    pieces = straight(shape, t_end)
    if pieces is not None:
        return [(start, _polynomial(first, slope)) for start, first, slope in pieces]
    match shape:
        case Sine():
            return _sine(shape)
        case Exponential():
            low, high = decimal(shape.from_), decimal(shape.to)
            fall = ExponentialSum({rate(-1 / decimal(shape.time_constant)): acb_poly([acb(rational(low - high))])})
            return [(None, _polynomial(low)), (decimal(shape.at), _polynomial(high) + fall)]
        case DoubleExponential():
            return [(None, ExponentialSum()), (decimal(shape.at), _surge(shape))]
    raise InputError(where, "its waveform has no exact transform", "a straight, exponential or sine one")


def _polynomial(*coefficients: Fraction) -> ExponentialSum:
    return ExponentialSum({rate(Fraction(0)): acb_poly([acb(rational(c)) for c in coefficients])})


def _sine(sine: Sine) -> list[tuple[Fraction | None, ExponentialSum]]:
    f, offset, at = decimal(sine.frequency), _polynomial(decimal(sine.offset)), decimal(sine.at)
    phase, half = arb(rational(decimal(sine.phase))), arb(rational(decimal(sine.amplitude))) / 2
    turn = acb(0, phase).exp() * acb(0, -half)  # half the amplitude over i
    waving = ExponentialSum({rotation(f, 1): acb_poly([turn]), rotation(f, -1): acb_poly([turn.conjugate()])})

    def still(at: Fraction) -> ExponentialSum:
        return offset + ExponentialSum({rate(Fraction(0)): acb_poly([acb(waving.at(at))])})

    pieces: list[tuple[Fraction | None, ExponentialSum]] = [(None, still(Fraction(0))), (at, offset + waving)]
    return pieces if sine.until is None else [*pieces, (decimal(sine.until), still(decimal(sine.until) - at))]


def _surge(surge: DoubleExponential) -> ExponentialSum:
    rise, decay = decimal(surge.rise), decimal(surge.decay)
    top = rational(rise * decay / (decay - rise)) * arb(rational(decay / rise)).log()
    height = (-top / rational(decay)).exp() - (-top / rational(rise)).exp()
    scale = acb(rational(decimal(surge.peak)) / height)
    return ExponentialSum({rate(-1 / decay): acb_poly([scale]), rate(-1 / rise): acb_poly([-scale])})


def starts(shape: Shape, t_end: Fraction, where: str) -> list[tuple[Fraction, ExponentialSum]]:
    """Motions that begin at instants from 0 on and add up to the waveform, zero before."""
    pieces = motions(shape, t_end, where)
    past = [piece for piece in pieces if piece[0] is None or piece[0] <= 0]
    start, motion = past[-1]
    begun = [(Fraction(0), motion if start is None else motion.shifted(-start))]
    for (before, old), (now, new) in pairwise(pieces[len(past) - 1 :]):
        if now is not None and now < t_end:
            seen = old if before is None else old.shifted(now - before)
            begun.append((now, new + seen * rational(Fraction(-1))))
    return begun


def decimal(value: float) -> Fraction:
    """Shortest decimal that gives this float."""
    return value if isinstance(value, Fraction) else Fraction(repr(float(value)))


@dataclass
class ReferenceNode:
    """Elements at a node."""

    ends: list[int] = field(default_factory=list)  # 2 * line for an end 1, 2 * line + 1 for an end 2
    conductance: Fraction = Fraction(0)  # of lines, resistors and sources
    load: RationalFunction | None = None
    held: bool = False  # whether the effort is prescribed
    drives: list[tuple[Shape, Fraction]] = field(default_factory=list)  # efforts if held, else flows: times a factor
    switches: list[Switch] = field(default_factory=list)


class ReferenceNetwork:
    """Lines and junctions of a scene.

    Attributes
    ----------
    delay, z0 : list of Fraction
        By line, s and ohm or Pa s/m³.
    node : list of str
        By end: name of its node.
    junctions : dict of str to Junction
    """

    def __init__(self, scene: Scene):
        scene.check_linear("exact solutions")
        refuse_floating(scene.sources, "exact solutions")
        refuse_heights(scene, "exact solutions")
        refuse_losses(scene, "no exact solution of that kind; see tline.study.reference.lossy")
        lines = [line.parameters for line in scene.lines.values()]
        self.scene = scene
        self.delay = [decimal(line.delay or 0.0) for line in lines]
        self.z0 = [decimal(line.z0) for line in lines]
        self.node = [name for line in scene.lines.values() for name in line.nodes]
        self.junctions: dict[str, ReferenceNode] = {name: ReferenceNode() for name in self.node}
        for end, name in enumerate(self.node):
            self.junctions[name].ends.append(end)
            self.junctions[name].conductance += 1 / self.z0[end // 2]
        for name, load in scene.loads.items():
            self._attach(name, load)
        for source in scene.sources.values():
            junction, ideal = self.junctions[source.terminals[0]], source.conductance in (0.0, inf)
            conductance = Fraction(0) if ideal else 1 / decimal(source.resistance or 0.0)
            junction.conductance += conductance
            if source.conductance == inf:
                junction.held, junction.drives = True, [(source.value, Fraction(1))]
            elif not junction.held:
                junction.drives.append((source.value, conductance if source.is_effort else Fraction(1)))

    def _attach(self, name: str, load: Load) -> None:
        junction = self.junctions[load.at]
        match load:
            case Resistor(resistance=0) | Short():
                junction.held = True
            case Resistor():
                junction.conductance += _conductance(load.resistance)
            case Reservoir():
                junction.held, junction.drives = True, [(Constant(level=load.pressure), Fraction(1))]
            case Matched():
                junction.conductance += 1 / self.z0[junction.ends[0] // 2]
            case Switch():
                junction.switches.append(load)
            case RationalImpedance():
                impedance = load.rational().reduced()
                if impedance.is_zero:
                    junction.held = True
                else:
                    junction.load = impedance if junction.load is None else junction.load.parallel(impedance).reduced()
            case NoFlow():
                pass
            case _:
                raise InputError(place("loads", name), "has no exact solution", "a linear load")

    def seen_by(self, probe: str) -> tuple[int, Fraction]:
        """Line of a probe, and its place as a share of the delay."""
        if probe not in self.scene.probes:
            raise InputError("probe", "no such probe", nearest(probe, list(self.scene.probes)), f"'{probe}'")
        lines, own = self.scene.lines, self.scene.probes[probe]
        line = self.scene.probed_line(probe) or next(name for name in lines if own.at in lines[name].nodes)
        return list(lines).index(line), decimal(own.fraction(lines[line]))

    def loaded(self) -> Iterator[str]:
        """Nodes with a load other than a resistance."""
        return (name for name, junction in self.junctions.items() if junction.load is not None and not junction.held)


def _conductance(resistance: float) -> Fraction:
    return Fraction(0) if resistance == inf else 1 / decimal(resistance)


def switched(junction: ReferenceNode, t: Fraction) -> Fraction | None:
    """Conductance of a junction's switches just before t; None is a short."""
    states = [switch.after if decimal(switch.time) < t else switch.before for switch in junction.switches]
    return None if 0 in states else sum(map(_conductance, states), Fraction(0))
