"""The non-linear elements of a scene: laws between nodes."""

from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np

from tline.solver.description.excitation import just_before
from tline.solver.description.given import ElementLaw, Governor, LawKind, Scene
from tline.solver.description.nodes import Node
from tline.words.wording import place


class PlacedLaw(NamedTuple):
    """A law between two nodes, or a node and the reference (None)."""

    where: str
    law: ElementLaw
    from_node: str | None
    to_node: str | None
    above_level: float = 0.0  # of a node that it leads from to the open air; of one that it leads to, less than zero
    levels: tuple[float, float] = (0.0, 0.0)  # of its nodes, each where its gauge pressure is zero
    control: float = 1.0  # what scales it over time, just before t = 0

    @property
    def kind(self) -> LawKind:
        """Kind of the law."""
        return self.law.of_kind

    @property
    def constants(self) -> tuple[float, ...]:
        """Constants of the law, the first (its reference effort) at the element's height, and of its governor."""
        first, *rest = self.law.constants
        return (first + self.above_level, *rest, *(self.governor.flat() if self.governor is not None else ()))

    @property
    def governor(self) -> Governor | None:
        """Governor of the opening, with set points referred to the level; a difference of efforts has none."""
        governor = self.law.governor
        if governor is None or (governor.here[0] and governor.there[0]):
            return governor
        here, there = (
            (gain, value + level)
            for (gain, value), level in zip((governor.here, governor.there), self.levels, strict=True)
        )
        return governor._replace(here=here, there=there)

    def share(self, opening: float) -> float:
        """Share of the capacity at an opening that moves by itself."""
        assert self.governor is not None
        if not self.governor.shares:
            return opening
        openings, shares = np.array(self.governor.shares).T
        return float(np.interp(opening, openings, shares))

    @property
    def nodes(self) -> list[str]:
        """Nodes of the element."""
        return [node for node in (self.from_node, self.to_node) if node is not None]

    def seen(self, nodes: Mapping[str, Node]) -> float:
        """Thévenin resistance at the nodes, of lines and resistances alone."""
        return sum(1 / abs(nodes[node].total) for node in self.nodes if nodes[node].held is None)


def elements_of(
    scene: Scene,
    laws: Mapping[tuple[str, str], ElementLaw],
    nodes: Mapping[str, Node],
    like: Iterable[PlacedLaw] = (),
) -> list[PlacedLaw]:
    """Select the non-linear elements of a scene, without those between prescribed efforts.

    An element equal to that at the same place in `like` is taken over, and so is an equal opening.
    """
    found, known = [], {element.where: element for element in like}
    for (part, name), law in laws.items():
        ends = (scene.links if part == "links" else scene.loads)[name].terminals
        if any(node is not None and nodes[node].held is None for node in ends):
            where, before = place(part, name), 1.0
            if where in known and known[where].law is law:
                found.append(known[where])
                continue
            from_node, to_node = reversed(ends) if law.reverse else ends
            levels = [nodes[node].above_level if node is not None else 0.0 for node in (from_node, to_node)]
            height = _height(nodes, from_node, to_node)
            if law.factor is not None and where in known and known[where].law.factor == law.factor:
                law, before = law._replace(factor=known[where].law.factor), known[where].control
            elif law.factor is not None:
                before = just_before(law.factor)
            found.append(PlacedLaw(where, law, from_node, to_node, height, (levels[0], levels[1]), before))
    return found


def _height(nodes: Mapping[str, Node], from_node: str | None, to_node: str | None) -> float:
    if from_node is not None and to_node is not None:
        return 0.0
    return nodes[from_node].above_level if from_node is not None else -nodes[to_node or ""].above_level
