"""A scene in exact numbers: the decimals that were typed, as fractions."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from math import inf

from passivity import RationalFunction
from tline.errors import InputError
from tline.scene.heights import refuse_heights
from tline.scene.load import Load, Matched, NoFlow, Reservoir, Resistor, Short
from tline.scene.lossless import refuse_losses
from tline.scene.rational import RationalImpedance
from tline.scene.scene import Scene
from tline.scene.source import refuse_floating
from tline.scene.switch import Switch
from tline.scene.waveform import Constant, Shape
from tline.words.wording import nearest, place


def decimal(value: float) -> Fraction:
    """The shortest decimal that is this float."""
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
        """Line of a probe, and its place as a share of the delay.

        Raises
        ------
        InputError
            There is no such probe.
        """
        if probe not in self.scene.probes:
            raise InputError("probe", "no such probe", nearest(probe, list(self.scene.probes)), f"'{probe}'")
        lines, own = self.scene.lines, self.scene.probes[probe]
        line = self.scene.probed_line(probe) or next(name for name in lines if own.at in lines[name].nodes)
        return list(lines).index(line), decimal(own.fraction(lines[line]))

    def loaded(self) -> Iterator[str]:
        """Nodes with a load that is no resistance."""
        return (name for name, junction in self.junctions.items() if junction.load is not None and not junction.held)


def _conductance(resistance: float) -> Fraction:
    return Fraction(0) if resistance == inf else 1 / decimal(resistance)


def switched(junction: ReferenceNode, t: Fraction) -> Fraction | None:
    """Conductance of a junction's switches just before t; None is a short."""
    states = [switch.after if decimal(switch.time) < t else switch.before for switch in junction.switches]
    return None if 0 in states else sum(map(_conductance, states), Fraction(0))
