"""Description of a scene: its data in SI, as runs need them."""

from collections.abc import Hashable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple

from numpy.typing import NDArray

from tline.scene.cavities import Boiling
from tline.scene.changed import changed, parts_of
from tline.scene.coupled import Coupled, ends_of
from tline.scene.law import NonLinear
from tline.scene.load import Switch
from tline.scene.ports import Multiport
from tline.scene.rational import RationalImpedance
from tline.scene.refuse import refuse_coupled
from tline.scene.stretches import expanded
from tline.scene.user_defined import user_elements
from tline.solver.description.elements import Branch, PlacedLaw, active_parts, branches_of, elements_of, impedances
from tline.solver.description.excitation import Shape
from tline.solver.description.given import (
    ElementLaw,
    End,
    Height,
    Medium,
    PipeTable,
    Scene,
    Stretches,
    readable,
    stretches_of,
)
from tline.solver.description.groups import Group, LumpedLine, grouped, regrouped, time_scales
from tline.solver.description.lines import Columns, Line, ProbePlace, columns_of, lines_of, probes_of
from tline.solver.description.nodes import NONE, Node, nodes_anew, nodes_of
from tline.words.wording import place

BESIDE = "description"  # what it is called among a scene's attributes
MOST_KEPT_LINES = 50_000  # lines of a scene that keeps it
LawsByPlace = dict[tuple[str, str], ElementLaw]
MOST_BESIDE_VALVES = 5e7  # diamonds of a run in slabs as wide as the shortest delay, with which fronts are followed


@dataclass(frozen=True, eq=False)
class Description:
    """Description of a scene; data that only some runs need are computed on first use."""

    scene: Scene  # as it was given, for the result
    medium: Medium
    t_end: float
    steady: bool
    lines: Mapping[str, Line]  # all that carry waves: single ones, and one for each mode of coupled conductors
    coupled: dict[str, tuple[End, End]]  # ends of coupled conductors
    heights: Mapping[str, Height]  # of nodes; empty without elevations
    # lines cut in slabs, which scenes with other values at the nodes share; kept by `tline.solver.assembly`
    grids: dict[Hashable, Any] = field(default_factory=dict, repr=False)
    # what was found of this scene, for its next run; kept by `tline.solver.simulate` and `tline.solver.assembly`
    known: dict[Hashable, Any] = field(default_factory=dict, init=False, repr=False)
    origin: "Origin | None" = field(default=None, repr=False)  # what it was changed from by values at some nodes

    def changed(self, values: Mapping[str, Any]) -> "Description":
        """The description of the scene with other values at dotted paths; lines that stay are not read again."""
        scene = changed(self.scene, values)
        touched = self._touched(scene, values)
        if touched is None:
            return describe(scene)
        return replace(self, scene=scene, origin=Origin(self, *touched, self.nodes))

    def _touched(self, scene: Scene, values: Iterable[str]) -> tuple[set[str], LawsByPlace] | None:
        """Nodes whose linear loads or sources have other values in a changed scene, and laws; None if more changes."""
        at, laws = set(), {}
        for path in values:
            part, *keys = parts_of(path)
            if part not in ("loads", "sources", "links") or len(keys) == 1:
                return None
            old, new = getattr(self.scene, part)[keys[0]], getattr(scene, part)[keys[0]]
            law = isinstance(new, NonLinear)
            if type(old) is not type(new) or getattr(old, "terminals", None) != getattr(new, "terminals", None):
                return None
            if not law and (part == "links" or new.at is None):
                return None
            at.update([] if law else [new.at])
            laws |= {(part, keys[0]): new.law()} if law else {}
        return None if self.scene.composed or self.stretches else (at, laws)

    def fits(self, other: "Description") -> bool:
        """Whether it differs from another by its elements, and the impedances of its lines, alone."""
        if self.origin is not None and self.origin.description is other:
            return True
        ours, theirs = (
            (each.t_end, each.steady, each.heights, each.scene.probes, each.scene.solver) for each in (self, other)
        )
        lines = ({name: line._replace(z0=1.0) for name, line in each.lines.items()} for each in (self, other))
        return ours == theirs and next(lines) == next(lines)

    @cached_property
    def anew(self) -> dict[str, Node]:
        """Nodes that differ from those of the description from which this one was changed."""
        if self.origin is None:
            return {}
        return nodes_anew(self.scene, self.origin.nodes, self.origin.changed)

    @property
    def ends(self) -> list[End]:
        """All ends of coupled conductors."""
        return [end for pair in self.coupled.values() for end in pair]

    @cached_property
    def columns(self) -> Columns:
        """The lines as arrays."""
        return columns_of(self.lines)

    @cached_property
    def lossy(self) -> bool:
        """Whether a line loses something."""
        return bool(self.columns.lossy.any())

    @cached_property
    def dispersive(self) -> bool:
        """Whether a line does more to waves than to delay and attenuate them, and lines are not all in diamonds."""
        return not self.diamonds and bool(self.columns.dispersive.any())

    @cached_property
    def diamonds(self) -> bool:
        """Whether some lines have losses, and all losses depend on the instantaneous flow alone."""
        return self.lossy and bool(self.columns.instant.all())

    @cached_property
    def crowded(self) -> bool:
        """Whether there are too many fronts to follow: moving valves beside very short lossy lines multiply them."""
        lossy = self.columns.delay[self.columns.dispersive]
        moving = (getattr(self.scene, part)[name].kind for part, name, _ in self.scene.waveforms)
        many = lossy.size > 0 and self.t_end * lossy.sum() > MOST_BESIDE_VALVES * lossy.min() ** 2
        return bool(many) and "orifice" in moving

    @cached_property
    def laws(self) -> LawsByPlace:
        """Law of each non-linear element, by section and name."""
        return self.scene.laws if self.origin is None else self.origin.description.laws | self.origin.laws

    @cached_property
    def blurred(self) -> bool:
        """Whether elements send fronts at instants of their own."""
        return any(law.of_kind.breaks for law in self.laws.values())

    @property
    def collapses(self) -> bool:
        """Whether the liquid boils at nodes."""
        return any(isinstance(load, Boiling) for load in self.scene.loads.values())

    @cached_property
    def nodes(self) -> dict[str, Node]:
        """Elements and line ends at each node, without lumped lines."""
        if self.origin is not None:
            return self.origin.nodes | self.anew
        return nodes_of(self.scene, self.lines, self.columns, self.ends)

    @cached_property
    def elements(self) -> list[PlacedLaw]:
        """Non-linear elements, except those between prescribed efforts."""
        return elements_of(self.scene, self.laws, self.nodes, self.origin.description.elements if self.origin else ())

    @cached_property
    def branches(self) -> list[Branch]:
        """Linear links, and sources between two nodes."""
        return list(branches_of(self.scene, self.nodes)) if self._like is None else self._like.branches

    @property
    def _like(self) -> "Description | None":
        """Description from which this one was changed, if the same elements connect the same nodes."""
        like = self.origin and self.origin.description
        return like if like and [e.where for e in like.elements] == [e.where for e in self.elements] else None

    @property
    def multiports(self) -> list[str]:
        """Names of links that are multiports."""
        return [name for name, link in self.scene.links.items() if isinstance(link, Multiport)]

    @cached_property
    def probes(self) -> dict[str, ProbePlace]:
        """Probes by name."""
        return self.origin.description.probes if self.origin else probes_of(self.scene, self.coupled)

    @cached_property
    def probed(self) -> set[str]:
        """Lines with probes."""
        return {line for probe in self.probes.values() for line in probe.lines}

    @cached_property
    def probed_nodes(self) -> list[str]:
        """Nodes without a line at which probes are."""
        return list(dict.fromkeys(probe.node for probe in self.probes.values() if probe.node is not None))

    @cached_property
    def waveforms(self) -> dict[str, Shape]:
        """All that is prescribed over time, by place."""
        return {place(part, name): given for (part, name, _), given in self.scene.prescribed(self.laws).items()}

    @cached_property
    def breaks(self) -> list[NDArray]:
        """Instants at which each waveform jumps or bends until the end of the run, s."""
        return [waveform.breaks(self.t_end) for waveform in self.waveforms.values()]

    @cached_property
    def switched(self) -> dict[str, float]:
        """Instants of switches by place, s."""
        return {place(*at): float(one.time) for at, one in self.scene.placed if isinstance(one, Switch)}

    @cached_property
    def time_scales(self) -> dict[str, tuple[float, float]]:
        """Shortest time scale of each curved waveform and dynamic load, and that of its oscillations, s."""
        return time_scales(self.waveforms, self.grouped()[0])

    @property
    def starts(self) -> dict[str, float]:
        """Piezometric pressure or voltage that nodes are to start with where nothing else determines it."""
        given = {name: site.start for name, site in self.scene.nodes.items() if name in self.nodes}
        return {name: float(start) for name, start in given.items() if start is not None}

    @property
    def tanks(self) -> dict[str, float]:
        """Efforts, counted from the level, at nodes of tanks that hold a level of their own at the start."""
        own = [tank for tank in self.surge_tanks.values() if tank.start is not None]
        return {tank.at: float(tank.start or 0.0) + self.nodes[tank.at].height.above_level for tank in own}

    @property
    def surge_tanks(self) -> dict[str, Any]:
        """Tanks by place."""
        return {place("loads", name): load for name, load in self.scene.loads.items() if load.kind == "surge tank"}

    @cached_property
    def stretches(self) -> dict[str, Stretches]:
        """Stretches that replace lines with cavities, or with losses and probes inside, in a run."""
        return stretches_of(self.scene)

    @cached_property
    def mixed(self) -> dict[str, list[str]]:
        """Lines of the modes of each of the coupled conductors whose losses mix these."""
        lines = ((name, self.scene.lines[name], near) for name, (near, _) in self.coupled.items())
        return {
            name: [node.removesuffix(", end 1") for node in near.modal]
            for name, line, near in lines
            if isinstance(line, Coupled) and line.mixing
        }

    def parted(self) -> "Description":
        """Description of the scene expanded into stretches; itself if there are none."""
        return describe(expanded(self.scene)) if self.stretches else self

    @property
    def own(self) -> set[str]:
        """Places of user-defined elements."""
        return {place(*at) for at in user_elements(self.scene)}

    @cached_property
    def active(self) -> dict[str, str]:
        """Sentence on each element that may be active, by place."""
        like = self.origin and self.origin.description
        return like.active if like and not like.impedances else active_parts(self.scene)

    @cached_property
    def impedances(self) -> dict[str, Any]:
        """Elements that are active or passive depending on their values, by place."""
        return impedances(self.scene)

    def grouped(
        self, sections: Mapping[str, int] = NONE, started: Mapping[str, float] = NONE
    ) -> tuple[list[Group], dict[str, Node]]:
        """Groups of nodes that something joins, and the nodes in their order.

        `sections` are those of lumped lines, `started` the flow in these before t = 0.
        """
        if not sections:
            return self._grouped
        nodes = nodes_of(self.scene, self.lines, self.columns, self.ends, sections)
        lumped_lines = [LumpedLine(name, self.lines[name], n, started.get(name, 0.0)) for name, n in sections.items()]
        return grouped(nodes, lumped_lines, self.elements, self.ends, self.branches)

    @cached_property
    def _grouped(self) -> tuple[list[Group], dict[str, Node]]:
        if self._like is not None:
            groups, order = self._like.grouped()
            return regrouped(groups, self.nodes, self.elements), {name: self.nodes[name] for name in order}
        return grouped(self.nodes, [], self.elements, self.ends, self.branches)

    def check_linear(self, what: str) -> None:
        """Refuse non-linear elements."""
        self.scene.check_linear(what, besides=Multiport | RationalImpedance | Switch)

    def refuse_coupled(self, what: str) -> None:
        """Refuse coupled conductors where something does not know them."""
        refuse_coupled(self.scene.lines, what)


class Origin(NamedTuple):
    """Description from which another was changed, with the nodes and laws whose values differ."""

    description: Description
    changed: set[str]
    laws: LawsByPlace
    nodes: dict[str, Node]  # of that description, computed before: cached properties must not wait for each other


class Beside:
    """Cached description of a scene, dropped when the scene is copied or sent to another process."""

    def __init__(self, description: Description | None = None):
        self.description = description
        self.read = None if description is None else _elements(description.scene)

    def __reduce__(self) -> tuple[type, tuple[()]]:
        return Beside, ()


def _elements(scene: Scene) -> list[dict[str, Any]]:
    others = scene.sources, scene.loads, scene.links, scene.probes, scene.nodes
    lines = scene.lines if isinstance(scene.lines, PipeTable) else dict(scene.lines)
    return [lines, *map(dict, others)]


def describe(scene: Scene) -> Description:
    """Read a scene, once."""
    known: Beside = vars(scene).get(BESIDE) or Beside()
    if known.description is not None and known.description.scene is scene and known.read == _elements(scene):
        return known.description
    ends = ends_of(scene.lines)
    names = [name for name, line in scene.lines.items() if isinstance(line, Coupled)] if ends else []
    description = Description(
        scene=scene,
        medium=readable(scene),
        t_end=float(scene.t_end),
        steady=scene.start == "steady",
        lines=lines_of(scene),
        coupled=dict(zip(names, zip(ends[::2], ends[1::2], strict=True), strict=True)),
        heights=scene.heights,
    )
    if len(scene.lines) <= MOST_KEPT_LINES:
        vars(scene)[BESIDE] = Beside(description)
    return description
