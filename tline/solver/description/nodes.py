"""Nodes of a scene in numbers: conductances, prescribed efforts and flows, loads, switches.

In a scene with heights all efforts count from the level: the piezometric pressure of the liquid at rest, filled up to
the highest node. The effort across an element from a node to the open air is the gauge pressure, the effort less
`Height.above_level`.
"""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.heights import below
from tline.scene.load import Load, Matched, NoFlow, Reservoir, Short, Switch
from tline.scene.quantity import ZERO
from tline.scene.rational import MOST_STATES, RationalImpedance, Resistor
from tline.scene.refuse import refuse_cavities
from tline.scene.shape import Lowered
from tline.scene.source import Source
from tline.solver.description.circuit import StateSpace, reflection, reflection_of_poles
from tline.solver.description.excitation import just_before
from tline.solver.description.given import NO_HEIGHT, Constant, End, Height, Measured, Ratio, Scene, Shape
from tline.solver.description.lines import Columns, Line
from tline.words.wording import place


@dataclass
class Node:
    """One node: everything attached to it, side by side."""

    name: str
    ends: list[int] = field(default_factory=list)  # 2 * line for an end 1, 2 * line + 1 for an end 2
    sources: dict[str, Source] = field(default_factory=dict)  # attached here, by place
    loads: dict[str, Load] = field(default_factory=dict)
    lines: float = 0.0  # sum of 1/z0 of the ends
    lumped: float = 0.0  # sum of 1/z0 of the lumped lines' ends
    conductance: float = 0.0  # of resistors, constant loads and sources
    flows: list[tuple[Shape, float]] = field(default_factory=list)  # waveforms and what turns them into flows
    held: Shape | None = None  # the effort, where it is ideal
    load: Ratio | None = None  # all dynamic loads side by side
    load_name: str = ""
    measured: Any = None  # element from a file of S-parameters, if that is all of the load
    switches: list[Switch] = field(default_factory=list)
    alone: float = 1.0  # reference where nothing conducts
    height: Height = NO_HEIGHT
    hidden: bool = False  # whether it is nothing but what a source between two other nodes prescribes

    @property
    def total(self) -> float:
        """Conductance of lines, resistors and sources at the node; a reference value where there is none."""
        return self.alone if self.lines == 0 == self.conductance else self.lines + self.conductance

    @property
    def dead(self) -> bool:
        """Whether no line, resistor or source conducts, so that other elements determine the effort."""
        return self.held is None and self.lines == 0 == self.conductance

    @cached_property
    def reflection(self) -> StateSpace:
        """From the wave into the dynamic loads to the one out of them, against 1/total."""
        assert self.load is not None
        if self.measured is not None:
            return reflection_of_poles(self.measured.model.model, self.measured.z0 * self.total)
        return reflection(self.load, 1 / self.total, self.load_name)

    @property
    def above_level(self) -> float:
        """Effort at which the gauge pressure is zero."""
        return self.height.above_level

    def state_at_rest(self) -> NDArray:
        """State of the loads while the liquid is at rest.

        Capacitances without a path for a steady flow, or straight across, hold the gauge pressure; nothing flows in
        inductances.
        """
        A, b, c, d = self.reflection
        if self.above_level and self.load is not None:
            if np.isinf(self.load.at_zero()):
                return np.linalg.solve(A, b[:, 0]) * self.above_level
            if float(d[0, 0]) == -1.0:
                return b[:, 0] * (-2 * self.above_level / float((c @ b)[0, 0]))
        return np.zeros(len(A))

    @property
    def excitations(self) -> list[tuple[Shape, float]]:
        """Waveforms and their shares of the Thévenin wave."""
        if self.held is not None:
            return [(self.held, 1.0)]
        return [(waveform, factor / self.total) for waveform, factor in self.flows]

    def drives_as(self, other: "Node") -> bool:
        """Whether the Thévenin wave is that of another node with the same line ends."""
        return (self.conductance, self.held, self.flows) == (other.conductance, other.held, other.flows)

    def switched(self, t: float) -> float:
        """Conductance of the switches just before t."""
        resistances = [s.after if s.time < t else s.before for s in self.switches]
        return sum(np.inf if r == 0 else 1 / r for r in resistances)

    def flow_before(self) -> float:
        """Flow of the sources immediately before t = 0."""
        return sum(factor * just_before(waveform) for waveform, factor in self.flows)

    def attach(self, load: Load, where: str) -> None:
        """Attach the load of place `where` in the scene."""
        self.loads[where] = load
        match load:
            case Resistor():
                self._conduct(1 / load.resistance if load.resistance else np.inf)
            case Short():
                self._conduct(np.inf)
            case Reservoir():
                self.held = lowered(Constant(level=load.pressure), self.height.level)
            case Matched():
                self._conduct(self.lines + self.lumped)
            case Switch():
                self.switches.append(load)
            case RationalImpedance():
                self.respond(load.ratio, where, load if isinstance(load, Measured) else None)
            case NoFlow():
                pass

    def prescribe(self, source: Source, where: str) -> None:
        """Attach the source of place `where` in the scene; a pressure is piezometric."""
        self.sources[where] = source
        waveform, conductance, is_effort = source.value, source.conductance, source.is_effort
        if is_effort:
            waveform = lowered(waveform, self.height.level)
        if np.isinf(conductance):
            self.held = waveform
        elif is_effort:
            self.conductance += conductance
            self.flows.append((waveform, conductance))
        else:
            self.flows.append((waveform, 1.0))
            self._conduct(conductance)

    def _conduct(self, conductance: float) -> None:
        """Attach a conductance to the open air; an infinite one holds the node at no gauge pressure."""
        if np.isinf(conductance):
            self.held = Constant.model_validate({"level": self.above_level}) if self.above_level else NOTHING
            return
        self.conductance += conductance
        if conductance and self.above_level:
            self.flows.append((UNIT, conductance * self.above_level))

    def respond(self, impedance: Ratio, where: str, measured: Any = None) -> None:
        """Attach a rational impedance, or a measured one; without dynamics it is a resistance."""
        if impedance.degree == 0:
            resistance = impedance.at_zero()
            self._conduct(1 / resistance if resistance else np.inf)
            return
        self.load = impedance if self.load is None else self.load.parallel(impedance)
        self.load_name, self.measured = where, measured
        if measured is None and self.load.degree > MOST_STATES:
            problem = "with the loads beside it, its degree in s is too high"
            raise InputError(where, problem, f"at most {MOST_STATES}", f"{self.load.degree}")


NOTHING, UNIT = Constant(level=ZERO), Constant.model_validate({"level": 1})
NONE: Mapping[str, Any] = {}  # results hold it, and no proxy of it can be pickled
CANCELLED = 1e-9  # share of the lines' conductance that active loads must leave


def lowered(pressure: Shape, level: float) -> Shape:
    """A prescribed pressure less the level."""
    if not level:
        return pressure
    if isinstance(pressure, Constant):
        return Constant.model_validate({"level": below(pressure.level, level)})
    return Lowered.model_construct(waveform=pressure, by=level)


def nodes_of(
    scene: Scene,
    lines: Mapping[str, Line],
    columns: Columns,
    coupled: Iterable[End],
    sections: Mapping[str, int] = NONE,
) -> dict[str, Node]:
    """The nodes of a scene by name, in the order in which lines and links name them."""
    refuse_cavities(scene.lines, "what is asked")
    at, n, lumped = columns.ends.ravel(), len(columns.nodes), np.zeros(2 * len(columns.z0), bool)
    if sections:
        lumped = np.repeat([name in sections for name in lines], 2)
    admittance, end = np.repeat(1 / columns.z0, 2), np.cumsum(~lumped) - 1  # 2 * line for an end 1, and the next
    kept = np.flatnonzero(~lumped)
    order = kept[np.argsort(at[kept], kind="stable")]
    first = np.searchsorted(at[order], np.arange(n + 1)).tolist()
    ends = end[order].tolist()
    sums = (np.bincount(at, admittance * part, n).tolist() for part in (~lumped, lumped))
    nodes = {
        name: Node(name, ends[first[k] : first[k + 1]], lines=own, lumped=other)
        for k, (name, own, other) in enumerate(zip(columns.nodes, *sums, strict=True))
    }
    for end in coupled:
        for at in end.conductors:
            nodes.setdefault(at, Node(at))
    for _, joined in scene.between:
        for at in joined:
            nodes.setdefault(at, Node(at))
    floating = {place("sources", name): source for name, source in scene.sources.items() if source.nodes is not None}
    nodes |= {where: Node(where, hidden=True) for where, source in floating.items() if source.is_effort}
    usual = float(1 / np.mean(columns.z0))
    for node in nodes.values():
        node.alone = usual
    for name, height in scene.heights.items():
        nodes[name].height = height
    _attach_all(scene, nodes)
    for name, n in sections.items():
        half = Fraction(lines[name].delay) / (2 * n * Fraction(lines[name].z0))
        for at in lines[name].nodes:
            nodes[at].respond(Ratio.of_fractions([1], [half, 0]), place("lines", name))
    _check_waves(nodes)
    return nodes


def nodes_anew(scene: Scene, nodes: Mapping[str, Node], names: Iterable[str]) -> dict[str, Node]:
    """Rebuild nodes of a scene with changed loads and sources; lines and heights are kept."""
    fresh = {}
    for name in names:
        node = nodes[name]
        fresh[name] = Node(name, node.ends, lines=node.lines, alone=node.alone, height=node.height)
    _attach_all(scene, fresh)
    _check_waves(fresh)
    return fresh


def _attach_all(scene: Scene, nodes: Mapping[str, Node]) -> None:
    floating = []
    for name, source in scene.sources.items():
        if source.nodes is not None:
            floating.append((place("sources", name), source))
        elif source.at is not None and source.at in nodes:
            nodes[source.at].prescribe(source, place("sources", name))
    for where, source in floating:
        if source.is_effort and where in nodes:
            nodes[where].held = source.value
        elif not source.is_effort:
            for at, sign in zip(source.nodes, (1.0, -1.0), strict=True):
                if at in nodes:
                    nodes[at].flows.append((source.value, sign))
    for name, load in scene.loads.items():
        if load.at in nodes:
            nodes[load.at].attach(load, place("loads", name))


def _check_waves(nodes: Mapping[str, Node]) -> None:
    """Refuse active loads that leave no wave defined."""
    for name, node in nodes.items():
        if node.held is None and abs(node.total) < CANCELLED * (node.lines + node.lumped):
            at_node = [where for where, load in node.loads.items() if isinstance(load, RationalImpedance)]
            if at_node:  # else it is small, not cancelled
                problem = f"cancels the conductance of the lines at node '{name}': no wave is defined"
                raise InputError(at_node[0], problem, "another resistance")


def weights_of(nodes: Collection[Node], z0: NDArray) -> NDArray:
    """Share of each end's arriving wave in the Thévenin wave of its node, node by node; 0 where the effort is held."""
    own = 1 / z0[np.array([end for node in nodes for end in node.ends], int) // 2]
    at = np.repeat(np.arange(len(nodes)), [len(node.ends) for node in nodes])
    total = np.bincount(at, own, len(nodes)) + [node.conductance for node in nodes]
    held = np.array([node.held is not None for node in nodes], bool)
    return np.where(held[at], 0.0, own / np.where(held, 1.0, total)[at])


def node_of_end(nodes: Collection[Node]) -> NDArray:
    """Number of the node at which each line end is."""
    at = np.empty(sum(len(node.ends) for node in nodes), int)
    for k, node in enumerate(nodes):
        at[node.ends] = k
    return at
