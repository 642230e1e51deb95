"""Elements beside what they cannot be solved with: what a line between them would part."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from typing import TYPE_CHECKING

from tline.errors import InputError
from tline.scene.element import AtNode
from tline.scene.load import Switch
from tline.scene.multiport import Multiport
from tline.scene.rational_load import Rational
from tline.scene.touchstone import Touchstone
from tline.wording import place

if TYPE_CHECKING:
    from tline.scene.scene import Scene

WITH_STATE = {
    "gas": "an air vessel or cavity",
    "tank": "a surge tank",
    "rotor": "a pump that trips",
    "vapour": "a vapour cavity",
    "air": "an air valve",
}
APART = "a line between them"


def crowded(scene: Scene, held: set[str]) -> Iterator[InputError]:
    """Elements that see others without a line between; `held` are nodes of ideal efforts."""
    yield from _multiports(scene)
    yield from _measured(scene)
    at: dict[str, list[tuple[str, str]]] = defaultdict(list)  # free node -> places and kinds of what is there
    for (part, name), law in scene.laws.items():
        for node in scene.links[name].nodes if part == "links" else (scene.loads[name].at,):
            if node not in held:
                at[node].append((place(part, name), law.kind))
    for name, load in scene.loads.items():
        if isinstance(load, Switch | Rational) and load.at in at:
            other, _ = at[load.at][0]
            problem = f"stands beside {other}, which is non-linear"
            yield InputError(place("loads", name), problem, APART)
    told = set()
    for things in at.values():
        for where, kind in things:
            others = [other for other, _ in things if other != where]
            if kind in WITH_STATE and others and where not in told:
                told.add(where)
                yield InputError(where, f"{WITH_STATE[kind]} stands beside {others[0]}", APART)


def _multiports(scene: Scene) -> Iterator[InputError]:
    """Elements at multiports that are not linear, or that move."""
    linked = {
        node: place("links", name)
        for name, link in scene.links.items()
        if isinstance(link, Multiport)
        for node in link.nodes
    }
    if not linked:
        return
    if scene.start == "steady":
        yield InputError("start", f"{next(iter(linked.values()))} has no steady state here", "'rest'", "'steady'")
    laws = scene.laws
    for where, element in scene.placed:
        if where in laws or isinstance(element, Switch):
            at = [element.at] if isinstance(element, AtNode) else element.nodes
            for node in linked.keys() & at:
                problem = f"stands beside {linked[node]}, which takes linear elements that do not move"
                yield InputError(place(*where), problem, APART)


def _measured(scene: Scene) -> Iterator[InputError]:
    """Measured one-ports beside loads with states: only alone they are as well conditioned as their fits."""
    at: dict[str, list[str]] = defaultdict(list)
    for name, load in scene.loads.items():
        if isinstance(load, Rational):
            at[load.at].append(name)
    for names in at.values():
        one = next((name for name in names if isinstance(scene.loads[name], Touchstone)), None)
        other = next((name for name in names if name != one), None)
        if one and other:
            yield InputError(place("loads", one), f"stands beside {place('loads', other)}", APART)
