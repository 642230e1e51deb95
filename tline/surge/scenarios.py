"""Scenarios of a study: a network and variants of it, and the operations in each, by one file.

A variant is a part of a scene that is laid over the network's; an event has arguments of `operate`, once or for each
pump, valve, pipe or node in turn.
"""

import inspect
import json
import re
from collections.abc import Iterator, Mapping
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

from tline.errors import InputError, check_kind
from tline.pictures.path import route
from tline.scene.held import held_nodes
from tline.scene.pump import Pump
from tline.scene.regulating import RegulatingValve
from tline.scene.scene import Scene
from tline.scene.text_file import read_toml
from tline.scene.valve import Orifice
from tline.surge.event import FLOWING, OPERATIONS, TURNED, as_texts, matching, read_event, to_open
from tline.surge.operate import Network, read_network
from tline.surge.operation import Operation, operate
from tline.words.wording import nearest, shown

READING = "wave_speed", "material", "hour", "moving_tanks"  # arguments of `read_network`
AS_READ = "as it is"  # the network without a variant
EACH = {"pumps": {*OPERATIONS} - FLOWING - TURNED, "valves": TURNED, "pipes": TURNED, "nodes": FLOWING}
TABLES = {"title", "network", "reading", "run", "paths", "variants", "events"}
OTHERS = {"network", "when", "record", "progress", *OPERATIONS, *READING}  # arguments of `operate` that no [run] has

Tables = Mapping[str, Any]


class Scenario(NamedTuple):
    """One event in one variant."""

    event: str
    element: str  # the element, where an event is for several in turn; else empty
    variant: str
    network: Network
    options: Tables  # of `operate`

    @property
    def name(self) -> str:
        """Name of the scenario."""
        alone = f"{self.event} {self.element}".rstrip()
        return alone if self.variant == AS_READ else f"{alone}, {self.variant}"

    @property
    def file(self) -> str:
        """Name of the scenario's files without a suffix: another one if anything about it is another."""
        made_of = [self.network.scene.to_toml(), repr(self.network.controls), self.options, version("tline")]
        key = sha256(json.dumps(made_of, sort_keys=True, default=str).encode()).hexdigest()
        return f"{re.sub(r'[^A-Za-z0-9.-]+', '_', self.name)[:80]}-{key[:10]}"

    def carried_out(self) -> Operation:
        """Run the scenario."""
        return operate(self.network, **self.options)


class Plan(NamedTuple):
    """Plan of a study."""

    title: str
    variants: Mapping[str, Network]
    paths: tuple[tuple[str, ...], ...]
    scenarios: tuple[Scenario, ...]


def read_plan(given: str | Path | Tables) -> Plan:
    """The plan in a file, or in its tables."""
    check_kind("study", given, str, Path, dict)
    folder = Path(given).parent if isinstance(given, str | Path) else Path()
    tables = read_toml(Path(given), "a study in TOML") if isinstance(given, str | Path) else given
    _check("", tables, TABLES)
    for key in ("network", "events"):
        if not tables.get(key):
            raise InputError(key, "is missing", "a network and at least one event")
    known = inspect.signature(operate).parameters.keys() - OTHERS
    run, runs = _table("run", tables.get("run", {}), known), dict[str, Tables]()
    reading, read = _table("reading", tables.get("reading", {}), READING), dict[str, Network]()
    variants = dict[str, Network]()
    events = {name: _table(f"events.{name}", one) for name, one in _table("events", tables["events"]).items()}
    opened = to_open(text for event in events.values() for text in as_texts("open", event.get("open", ())))
    for name, changes in {AS_READ: {}, **_table("variants", tables.get("variants", {}))}.items():
        more = dict(_table(f"variants.{name}", changes))
        options = {**reading, **_table(f"variants.{name}.reading", more.pop("reading", {}), READING)}
        runs[name] = {**run, **_table(f"variants.{name}.run", more.pop("run", {}), known)}
        key = json.dumps(options, sort_keys=True, default=str)
        read[key] = read.get(key) or _network(tables["network"], folder, options | {"opened": opened})
        variants[name] = _laid_over(read[key], more, f"variants.{name}")
    scenarios = [
        Scenario(event, element, variant, network, {**runs[variant], **operations})
        for event, table in events.items()
        for variant, network in variants.items()
        for element, operations in _in_turn(f"events.{event}", table, network.scene)
    ]
    paths = tuple(tuple(path) for path in tables.get("paths", ()))
    for path in paths:
        route(variants[AS_READ].scene, *path)
    return Plan(str(tables.get("title", "")), variants, paths, tuple(scenarios))


def _network(given: Any, folder: Path, options: Tables) -> Network:
    if isinstance(given, str) and (folder / given).exists():
        given = str(folder / given)
    more = dict(options)
    if isinstance(material := more.get("material"), str):
        more["material"] = str(folder / material)
    return read_network(given, **more)


def _laid_over(network: Network, changes: Tables, where: str) -> Network:
    if not changes:
        return network
    scene = network.scene
    try:
        return network._replace(scene=Scene(scene.folder, **_over(scene.table(), changes)))
    except InputError as error:
        raise InputError(where, str(error)) from None


def _over(tables: Tables, more: Tables) -> dict[str, Any]:
    """Tables with others over them; one of another kind takes the place of the one there."""
    found = dict(tables)
    for key, value in more.items():
        there = found.get(key)
        if isinstance(there, Mapping) and isinstance(value, Mapping):
            found[key] = _over(there, value) if value.get("kind", there.get("kind")) == there.get("kind") else value
        else:
            found[key] = value
    return found


def _in_turn(where: str, table: Any, scene: Scene) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield each element of an event, and its operations."""
    given = dict(_table(where, table, {*OPERATIONS, "when", "each"}))
    each = given.pop("each", None)
    if each is None:
        yield "", given
        return
    if each not in EACH:
        raise InputError(f"{where}.each", "unknown", nearest(str(each), [*EACH]), shown(each))
    kinds = [kind for kind in given if kind in EACH[each]]
    if len(kinds) != 1 or not isinstance(given[kinds[0]], str):
        expected = f"one text, of {' or '.join(sorted(EACH[each]))}"
        raise InputError(f"{where}.each", f"no single operation for {each} in turn", expected, shown(given))
    text = given[kinds[0]].strip()
    event = read_event(kinds[0], text)
    for one in matching(_elements(scene, each), event):
        yield one.name, given | {kinds[0]: one.name + text[len(event.name) :]}


def _elements(scene: Scene, each: str) -> list[str]:
    if each == "nodes":
        held = held_nodes(scene)
        return [*dict.fromkeys(node for line in scene.lines.values() for node in line.nodes if node not in held)]
    if each == "pipes":
        return [*scene.lines]
    kind = Pump if each == "pumps" else Orifice | RegulatingValve
    return [name for name, link in scene.links.items() if isinstance(link, kind)]


def _table(where: str, given: Any, known: Any = None) -> Tables:
    if not isinstance(given, Mapping):
        raise InputError(where, "not a table", "a table", shown(given))
    if known is not None:
        _check(f"{where}.", given, known)
    return given


def _check(front: str, given: Tables, known: Any) -> None:
    for key in given:
        if key not in known:
            raise InputError(f"{front}{key}", "unknown key", nearest(key, sorted(known)), f"'{key}'")
