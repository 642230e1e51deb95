"""Non-linear elements beside what they cannot be solved with: what a line between them would part."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from typing import TYPE_CHECKING

from tline.errors import InputError
from tline.scene.load import Switch
from tline.scene.mistakes import place
from tline.scene.rational_load import Rational

if TYPE_CHECKING:
    from tline.scene.scene import Scene

WITH_STATE = {"gas": "an air vessel or cavity", "tank": "a surge tank", "rotor": "a pump that trips"}
APART = "a line between them"


def crowded(scene: Scene, held: set[str]) -> Iterator[InputError]:
    """Elements with states of their own that see others without a line between; `held` are nodes of ideal efforts."""
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
