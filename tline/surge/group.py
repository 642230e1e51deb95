"""Which elements an operation means: one by its name, several by a list, or by a pattern such as "*" or "north*"."""

from collections.abc import Collection, Iterable, Iterator
from fnmatch import fnmatchcase

from tline.errors import InputError
from tline.scene.pump import Pump
from tline.scene.regulating import RegulatingValve
from tline.scene.scene import Scene
from tline.scene.valve import Orifice
from tline.solver.description.excitation import just_before
from tline.surge.event import FLOWING, TURNED, Event


def each_of(scene: Scene, event: Event, tripped: Collection[str] = ()) -> Iterator[Event]:
    """The event for each element that its name means.

    A name that the scene has means that. Of pumps a pattern means those that run, or to start them those that stand or
    have tripped; of what opens and shuts the valves, or pipes in a scene without valves.

    Examples
    --------
    >>> import tline as tl
    >>> [event.name for event in each_of(tl.examples["pump_group"], Event("trip", "*", 1.0))]
    ['pump']
    """
    if event.name in {*scene.lines, *scene.links, *scene.loads, *_nodes(scene)} or not {*event.name} & {*"*?,"}:
        yield event
        return
    yield from matching(_candidates(scene, event.kind, tripped), event)


def matching(names: Iterable[str], event: Event) -> Iterator[Event]:
    """The event for each of some names that the list, or the pattern, of its own name means.

    Examples
    --------
    >>> [event.name for event in matching(["north 1", "south", "north 2"], Event("close", "north*", 1.0))]
    ['north 1', 'north 2']
    """
    known, found = [*names], dict[str, None]()
    for part in (part.strip() for part in event.name.split(",")):
        fits = {name: None for name in known if fnmatchcase(name, part)} if {*part} & {*"*?"} else {part: None}
        if not fits:
            expected = f"one of {', '.join(map(repr, [*known][:4]))}" if known else "a scene that has some"
            raise InputError(event.kind, f"nothing that it may mean is called '{part}'", expected)
        found |= fits
    yield from (event._replace(name=name) for name in found)


def _nodes(scene: Scene) -> dict[str, None]:
    return {node: None for line in scene.lines.values() for node in line.nodes}


def _candidates(scene: Scene, kind: str, tripped: Collection[str]) -> list[str]:
    if kind in FLOWING:
        return [*_nodes(scene)]
    if kind in TURNED:
        valves = [name for name, link in scene.links.items() if isinstance(link, Orifice | RegulatingValve)]
        return valves or [*scene.lines]
    pumps = {name: link for name, link in scene.links.items() if isinstance(link, Pump)}
    runs = {name for name, pump in pumps.items() if just_before(pump.speed) > 0}
    return [name for name in pumps if (name not in runs or name in tripped if kind == "start" else name in runs)]
