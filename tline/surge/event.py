"""Operations in a network, with instants: words such as "VALVE-179@1s+5s" or "J73:20 L/s@2s", "*" for several."""

from collections.abc import Collection, Iterable, Iterator, Sequence
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any, NamedTuple

from tline.errors import InputError
from tline.interchange.water_valves import gate_of
from tline.scene.pump import Pump
from tline.scene.quantity import Quantity
from tline.scene.regulating import RegulatingValve
from tline.scene.scene import Scene
from tline.scene.valve import Orifice
from tline.scene.waveform import read_table
from tline.solver.description.excitation import just_before
from tline.words.wording import nearest, shown

Texts = str | Iterable[str]

OPERATIONS = {
    "trip": "PUMP@TIME",
    "start": "PUMP@TIME+DURATION",
    "stop": "PUMP@TIME+DURATION",
    "speed": "PUMP:SHARE@TIME+DURATION",
    "close": "LINK@TIME+DURATION",
    "open": "LINK@TIME+DURATION",
    "burst": "NODE:FLOW@TIME+DURATION",
    "demand": "NODE:+FLOW@TIME+DURATION",
}
FLOWING, TURNED = {"burst", "demand"}, {"close", "open"}
MOST_PROBED = 5  # nodes, where none are wanted
FASTEST = 2.0  # speed of a pump over the rated one


class Event(NamedTuple):
    """One operation."""

    kind: str  # one of OPERATIONS
    name: str  # of a link, a pipe or a node
    at: float  # at, duration: when it begins, and how long it takes; s
    duration: float = 0.0
    flow: float = 0.0  # of a burst, or the change of a demand, m³/s
    speed: float | None = None  # that a pump goes to, over the rated one
    # share of the way that is left when a second stage begins, and how long that takes, s; or none
    stage: tuple[float, ...] = ()
    # times after the beginning, s, and openings or speeds there, where a file says them; else none
    course: tuple[tuple[float, float], ...] = ()

    def control(self, before: float, after: float) -> dict[str, Any]:
        """The waveform that goes from one value to another meanwhile; a course of openings says itself where to."""
        if self.course:
            points = [(self.at, before), *((self.at + t, x) for t, x in self.course)]
            return {"shape": "piecewise linear", "points": [list(p) for p in points[points[0] == points[1] :]]}
        if self.stage:
            (share, more), middle = self.stage, self.at + self.duration
            bend = after + share * (before - after)
            points = [[self.at, before], [middle, bend], [middle + more, after]]
            return {"shape": "piecewise linear", "points": points}
        shape: dict[str, Any] = {"shape": "ramp", "duration": self.duration} if self.duration else {"shape": "step"}
        return shape | {"from": before, "to": after, "at": self.at}


def read_event(kind: str, text: str) -> Event:
    """The event that a text says, of a kind of OPERATIONS: name, flow with a unit if it takes one, time, duration.

    A valve may have a second stage, ``V1@1s+2s:20%+8s``, when 20 % of its way are left, or follow a CSV file of times
    after the beginning and openings, ``V1@1s:shut.csv``; and so may the speed of a pump.

    Examples
    --------
    >>> read_event("close", "VALVE-179@1s+5s")[:4]
    ('close', 'VALVE-179', 1.0, 5.0)
    >>> read_event("burst", "J73:20 L/s@2s").flow
    0.02
    >>> read_event("close", "V1@1s+2s:20%+8s").stage
    (0.2, 8.0)
    >>> read_event("speed", "P1:80%@1s+5s").speed
    0.8
    """
    where, expected = kind, OPERATIONS[kind]
    target, at, when = text.rpartition("@")
    name, flow, speed = target.strip(), 0.0, None
    if kind in FLOWING or (kind == "speed" and ":" in target):
        name, colon, typed = (part.strip() for part in target.rpartition(":"))
        if at and colon and name and kind == "speed":
            speed = _speed(typed)
        elif at and colon and name:
            flow = with_unit(typed.removeprefix("+"), "m^3/s", where)
    if not at or not name or (kind in FLOWING and not flow) or (kind == "burst" and flow < 0):
        raise InputError(where, "not an operation", f"{expected}, such as {_example(kind)}", f"'{text}'")
    when, colon, law = when.partition(":")
    if colon and kind not in {*TURNED, "speed"}:
        raise InputError(where, "stages and courses are for close and open, and for speed", expected, f"'{text}'")
    begin, plus, takes = when.partition("+")
    event = Event(kind, name, with_unit(begin, "s", where), with_unit(takes, "s", where) if plus else 0.0, flow, speed)
    if colon:
        event = _with_law(event, law.strip(), where, text)
    if kind == "speed" and (speed is None) == (not event.course):
        raise InputError(where, "not one speed to go to, or a course", expected, f"'{text}'")
    if event.at < 0 or event.duration < 0:
        raise InputError(where, "out of range", "times of zero and more", f"'{text}'")
    if kind == "trip" and event.duration:
        raise InputError(where, "a trip takes no time of its own", expected, f"'{text}'")
    return event


def _speed(typed: str) -> float:
    value = Quantity(typed, "", "speed")
    if not 0 <= value <= FASTEST:
        raise InputError("speed", "out of range", f"0 to {FASTEST:g} times the rated speed", f"'{typed}'")
    return float(value)


def with_unit(typed: str, unit: str, where: str) -> float:
    """A number in SI, whose unit is to be there.

    Examples
    --------
    >>> with_unit("20 L/s", "m^3/s", "burst")
    0.02
    """
    value = Quantity(typed.strip(), unit, where)
    if not any(c.isalpha() and c not in "eE" for c in typed):
        raise InputError(
            where, "a number without a unit", f"one with a unit, such as '{typed.strip()} {unit}'", f"'{typed.strip()}'"
        )
    return float(value)


def _with_law(event: Event, law: str, where: str, text: str) -> Event:
    """The event with a second stage, or with the course that a file says."""
    if law.lower().endswith(".csv"):
        times, openings = read_table(Path(law), where)
        most = FASTEST if event.kind == "speed" else 1.0
        bad = next((x for x in openings if not 0 <= x <= most), None)
        if event.duration or times[0] < 0 or bad is not None:
            got = f"'{text}'" if event.duration else f"{times[0]:g} s" if times[0] < 0 else f"{bad:g}"
            raise InputError(
                where, f"no course of {event.kind}", f"TIME:FILE.csv, of times >= 0 and values 0 to {most:g}", got
            )
        return event._replace(course=tuple(zip(times, openings, strict=True)))
    share, plus, takes = (part.strip() for part in law.partition("+"))
    if not plus or not event.duration:
        raise InputError(
            where, "no second stage", f"such as V1@1s+2s:20%+8s, or a file {event.name}@1s:FILE.csv", f"'{text}'"
        )
    stage = float(Quantity(share, "", where)), with_unit(takes, "s", where)
    if not 0 < stage[0] < 1 or stage[1] <= 0:
        raise InputError(
            where, "a stage out of range", "a share between 0 and 1 that is left, and a duration", f"'{text}'"
        )
    return event._replace(stage=stage)


def _example(kind: str) -> str:
    if kind in FLOWING:
        return "J73:20L/s@2s" if kind == "burst" else "J9:+5L/s@0s"
    return {"trip": "P1@1s", "speed": "P1:80%@1s+5s", "start": "P1@1s", "stop": "P1@1s+5s"}.get(kind, "V1@1s+5s")


def to_open(texts: Iterable[str]) -> set[str]:
    """Names that texts of `open` have, patterns left out."""
    return {part.strip() for text in texts for part in text.rpartition("@")[0].split(",")}


def each_of(scene: Scene, event: Event, tripped: Collection[str] = ()) -> Iterator[Event]:
    """The event for each element that its name means.

    A name in the scene means its element, and that of a pipe with a gate valve the valve. Of pumps a pattern means
    those that run, or to start them those at rest or tripped; to open and shut, the valves, or pipes in a scene without
    valves.
    """
    if event.name in {*scene.lines, *scene.links, *scene.loads, *_nodes(scene)} or not {*event.name} & {*"*?,"}:
        yield event._replace(name=gate) if (gate := gate_of(event.name)) in scene.links else event
        return
    yield from matching(_candidates(scene, event.kind, tripped), event)


def matching(names: Iterable[str], event: Event) -> Iterator[Event]:
    """Yield the event for each of some names meant by the list, or the pattern, of its own name."""
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


def as_texts(where: str, given: Texts) -> tuple[str, ...]:
    """Return the given texts as a tuple."""
    texts = (given,) if isinstance(given, str) else tuple(given) if isinstance(given, Iterable) else (given,)
    for text in texts:
        if not isinstance(text, str):
            raise InputError(where, "unknown value", "a text, or a list of texts", shown(text))
    return texts


def probed_nodes(scene: Scene, events: Iterable[Event], wanted: Sequence[str]) -> Sequence[str]:
    """Nodes to probe: those wanted, or those at the ends of pipes at which something is operated."""
    nodes = {*_nodes(scene)}
    alone = {node for link in scene.links.values() for node in link.nodes}
    found: list[str] = []
    for event in events:
        if event.kind in FLOWING:  # at a node, which may have the name of a pipe
            found.append(event.name)
            continue
        link, load, pipe = scene.links.get(event.name), scene.loads.get(event.name), scene.lines.get(event.name)
        here = link.nodes if link else [load.at] if load else [event.name]
        found += [gate_of(event.name), pipe.nodes[1]] if pipe else here
        nodes |= {gate_of(event.name)} if pipe else set()
    for node in wanted:
        if node not in nodes | alone:
            raise InputError("at", "no such node", nearest(node, sorted(nodes | alone)), f"'{node}'")
    return wanted or [node for node in dict.fromkeys(found) if node in nodes][:MOST_PROBED]
