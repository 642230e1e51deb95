"""What stands at each node of a scene, in numbers: conductances, prescribed efforts and flows, loads, switches."""

from dataclasses import dataclass, field

import numpy as np

from passivity import RationalFunction
from tline.errors import InputError
from tline.scene.load import Impedance, Matched, NoFlow, Parallel, Reservoir, Resistor, Series, Short, Switch
from tline.scene.quantity import ZERO
from tline.scene.scene import Scene
from tline.scene.waveform import Constant, Shape
from tline.solver.drive import just_before


@dataclass
class Node:
    """One node: everything attached to it, side by side."""

    ends: list[int] = field(default_factory=list)  # 2 * line for an end 1, 2 * line + 1 for an end 2
    lines: float = 0.0  # sum of 1/z0 of the ends
    conductance: float = 0.0  # of resistors, constant loads and sources
    flows: list[tuple[Shape, float]] = field(default_factory=list)  # waveforms and what turns them into flows
    held: Shape | None = None  # the effort, where it is ideal
    load: RationalFunction | None = None  # all dynamic loads side by side
    load_name: str = ""
    switches: list[Switch] = field(default_factory=list)

    @property
    def total(self) -> float:
        """Conductance that the waves see beside switches and dynamic loads."""
        return self.lines + self.conductance

    def switched(self, t: float) -> float:
        """Conductance of the switches just before t."""
        resistances = [s.after if s.time < t else s.before for s in self.switches]
        return sum(np.inf if r == 0 else 1 / r for r in resistances)

    def flow_before(self) -> float:
        """Flow of the sources immediately before t = 0."""
        return sum(factor * just_before(waveform) for waveform, factor in self.flows)

    def _hold(self, effort: Shape) -> None:
        self.held = effort

    def conduct(self, resistance: float) -> None:
        """Attach a resistance; zero holds the node at no effort."""
        if resistance == 0:
            self._hold(NOTHING)
        else:
            self.conductance += 1 / resistance

    def attach(self, impedance: RationalFunction, where: str) -> None:
        """Attach a rational load; one without dynamics is a resistance."""
        impedance = impedance.reduced()
        if impedance.degree == 0:
            self.conduct(float(impedance.at_zero()))
        else:
            self.load = impedance if self.load is None else self.load.parallel(impedance).reduced()
            self.load_name = where

    def prescribe(self, waveform: Shape, conductance: float, is_effort: bool) -> None:
        """Attach a source."""
        if np.isinf(conductance):
            self._hold(waveform if is_effort else NOTHING)
        else:
            self.conductance += conductance
            self.flows.append((waveform, conductance if is_effort else 1.0))


NOTHING = Constant(level=ZERO)


def nodes_of(scene: Scene) -> dict[str, Node]:
    """The nodes of a scene by name, in the order in which the lines name them."""
    nodes: dict[str, Node] = {}
    for k, line in enumerate(scene.lines.values()):
        for side, name in enumerate(line.nodes):
            node = nodes.setdefault(name, Node())
            node.ends.append(2 * k + side)
            node.lines += 1 / line.parameters.z0
    for source in scene.sources.values():
        nodes[source.at].prescribe(source.value, source.conductance, source.is_effort)
    for name, load in scene.loads.items():
        node = nodes[load.at]
        match load:
            case Resistor():
                node.conduct(load.resistance)
            case Short():
                node.conduct(0.0)
            case Reservoir():
                node.prescribe(Constant(level=load.pressure), np.inf, is_effort=True)
            case Matched():
                node.conductance += node.lines
            case Switch():
                node.switches.append(load)
            case Series() | Parallel() | Impedance():
                node.attach(load.rational(), f"loads.{name}")
            case NoFlow():
                pass
    for name, node in nodes.items():
        if node.total == 0:
            raise InputError(f"node '{name}'", "its active loads cancel the lines' conductance: no wave is defined")
    return nodes
