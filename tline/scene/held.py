"""Prescribed efforts, at a node or between two, and the elements that they exclude."""

from __future__ import annotations

from collections.abc import Iterator
from math import inf
from typing import TYPE_CHECKING, Any

from tline.errors import InputError
from tline.scene.connected import Joined
from tline.scene.load import Reservoir, Short, Switch
from tline.scene.rational import RationalImpedance, Resistor
from tline.words.wording import place

if TYPE_CHECKING:
    from tline.scene.scene import Scene

Terminals = tuple[str, str | None]  # the second is None for the reference


class _Rigid:
    """Nodes between which the effort is prescribed or cannot jump; None stands for the reference."""

    def __init__(self) -> None:
        self._joined = Joined()
        self._holders: list[tuple[str, Terminals]] = []

    def join(self, where: str, terminals: Terminals) -> None:
        self._joined.join(*terminals)
        self._holders.append((where, terminals))

    def joins(self, terminals: Terminals) -> bool:
        first, second = map(self._joined.root, terminals)
        return first == second

    def holder(self, terminals: Terminals) -> str:
        """Element that prescribes the effort between joined terminals, or one of several that do."""
        across = (where for where, others in self._holders if {*others} == {*terminals})
        nodes = {*terminals} - {None}
        return next(across, "") or next(where for where, others in self._holders if nodes.intersection(others))


def conflicting_holds(scene: Scene) -> Iterator[InputError]:
    """Find elements across prescribed efforts: a second ideal effort, a capacitor, a switch without a resistance."""
    held = _Rigid()
    for where, terminals in ideal_efforts(scene):
        if held.joins(terminals):
            problem = f"{_told(terminals)} is already held by {held.holder(terminals)}"
            yield InputError(where, problem, "one ideal effort or short at a node")
        else:
            held.join(where, terminals)
    capacitive = [
        (place(*at), element.terminals)
        for at, element in scene.placed
        if isinstance(element, RationalImpedance) and is_capacitive(element)
    ]
    for where, terminals in capacitive:
        if held.joins(terminals):
            source = held.holder(terminals)
            problem = f"its impedance vanishes at high frequency: a jump of {source} drives an infinite flow"
            yield InputError(where, problem, "a source with a resistance")
    for where, terminals in capacitive:
        held.join(where, terminals)
    for at, element in scene.placed:
        if isinstance(element, Switch) and 0 in (element.before, element.after):
            terminals = element.terminals
            if held.joins(terminals):
                problem = f"shorts {_told(terminals)}, which {held.holder(terminals)} holds"
                yield InputError(place(*at), problem, "a resistance above zero")


def ideal_efforts(scene: Scene) -> list[tuple[str, Terminals]]:
    """Elements that prescribe an effort, and their terminals."""
    ideal = [(place("sources", name), s.terminals) for name, s in scene.sources.items() if s.conductance == inf]
    return ideal + [(place("loads", name), (load.at, None)) for name, load in scene.loads.items() if _is_ideal(load)]


def held_nodes(scene: Scene) -> set[str]:
    """Nodes whose effort against the reference is prescribed."""
    return {node for _, (node, other) in ideal_efforts(scene) if other is None}


def _told(terminals: Terminals) -> str:
    first, second = terminals
    return f"node '{first}'" if second is None else f"what is between nodes '{first}' and '{second}'"


def _is_ideal(load: Any) -> bool:
    return (
        isinstance(load, Short | Reservoir)
        or (isinstance(load, Resistor) and load.resistance == 0)
        or (isinstance(load, RationalImpedance) and load.ratio.is_zero)
    )


def is_capacitive(element: RationalImpedance) -> bool:
    """Whether the effort across an element cannot jump, although it is not a short."""
    ratio = element.ratio
    return not ratio.is_zero and ratio.at_infinity() == 0
