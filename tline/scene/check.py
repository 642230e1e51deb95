"""What no element can see alone: names that lead nowhere, and elements that exclude each other."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from tline.errors import InputError
from tline.scene.load import Impedance, Matched, NoFlow, Parallel, Reservoir, Resistor, Series, Short, Switch
from tline.scene.medium import MEDIA
from tline.scene.mistakes import nearest

if TYPE_CHECKING:
    from tline.scene.scene import Scene

SECTIONS = ("sources", "loads", "probes")


def misplaced(data: Mapping[str, Any]) -> list[InputError]:
    """Elements at nodes where no line ends; works on tables as read, so that other mistakes do not hide these."""
    lines = _tables(data, "lines")
    nodes = sorted({str(node) for line in lines.values() for node in _as_list(line.get("nodes"))})
    found = []
    for section in ("lines", "probes"):
        if not _tables(data, section):
            missing = "there is nothing to simulate" if section == "lines" else "nothing would be recorded"
            found.append(InputError(section, missing, f"at least one table [{section}.NAME]"))
    for section in SECTIONS:
        for name, table in _tables(data, section).items():
            if nodes and isinstance(table.get("at"), str) and table["at"] not in nodes:
                where = f"{section}.{name}.at"
                found.append(
                    InputError(where, "no line ends at this node", nearest(table["at"], nodes), repr(table["at"]))
                )
            if section == "probes" and isinstance(table.get("line"), str) and table["line"] not in lines:
                found.append(
                    InputError(
                        f"probes.{name}.line",
                        "no such line",
                        nearest(table["line"], list(lines)),
                        repr(table["line"]),
                    )
                )
    return found


def _tables(data: Mapping[str, Any], section: str) -> dict[str, dict[str, Any]]:
    tables = data.get(section)
    tables = tables if isinstance(tables, dict) else {}
    return {
        name: table if isinstance(table, dict) else getattr(table, "__dict__", {}) for name, table in tables.items()
    }


def _as_list(nodes: Any) -> list[Any]:
    return list(nodes) if isinstance(nodes, list | tuple) else []


def conflicts(scene: Scene) -> Iterator[InputError]:
    """Elements of a scene, each valid alone, that exclude each other."""
    lines_at: dict[str, list[str]] = defaultdict(list)
    for name, line in scene.lines.items():
        for node in line.nodes:
            lines_at[node].append(name)
    yield from _words(scene)
    yield from _ideal_efforts(scene)
    for name, load in scene.loads.items():
        if isinstance(load, Matched) and len(lines_at[load.at]) != 1:
            yield InputError(
                f"loads.{name}", "a matched end needs a node with one line", got=f"{len(lines_at[load.at])}"
            )
    for name, probe in scene.probes.items():
        yield from _probe(scene, f"probes.{name}", probe, lines_at)


def _words(scene: Scene) -> Iterator[InputError]:
    medium = MEDIA[scene.medium]
    for name, load in scene.loads.items():
        if isinstance(load, NoFlow) and load.kind != medium.no_flow:
            yield InputError(
                f"loads.{name}.kind",
                f"not a word of {medium.name} scenes",
                f"'{medium.no_flow}' for no flow",
                f"'{load.kind}'",
            )
        if isinstance(load, Switch) and load.kind != medium.switch:
            yield InputError(
                f"loads.{name}.kind",
                f"not a word of {medium.name} scenes",
                f"'{medium.switch}'",
                f"'{load.kind}'",
            )
        if isinstance(load, Reservoir) and scene.medium != "hydraulic":
            yield InputError(
                f"loads.{name}.kind",
                "not a word of electrical scenes",
                "a voltage source, or 'short'",
                "'reservoir'",
            )


def _ideal_efforts(scene: Scene) -> Iterator[InputError]:
    """Nodes where an effort is prescribed, and what cannot stand beside it."""
    held: dict[str, str] = {}
    shorts = []
    for name, source in scene.sources.items():
        if source.conductance == float("inf"):
            shorts.append((f"sources.{name}", source.at))
    for name, load in scene.loads.items():
        zero = (
            isinstance(load, Short | Reservoir)
            or (isinstance(load, Resistor) and load.resistance == 0)
            or (isinstance(load, Impedance) and load.rational().is_zero)
        )
        if zero:
            shorts.append((f"loads.{name}", load.at))
    for where, node in shorts:
        if node in held:
            yield InputError(
                where, f"node '{node}' is already held by {held[node]}", "one ideal effort or short at a node"
            )
        held.setdefault(node, where)
    for name, load in scene.loads.items():
        if load.at not in held:
            continue
        if isinstance(load, Switch) and 0 in (load.before, load.after):
            yield InputError(
                f"loads.{name}",
                f"shorts node '{load.at}', which {held[load.at]} holds",
                "a resistance above zero",
            )
        if (
            isinstance(load, Series | Parallel | Impedance)
            and load.rational().at_infinity() == 0
            and not load.rational().is_zero
        ):
            problem = (
                f"at high frequency its impedance vanishes; {held[load.at]} is ideal, so a jump drives an infinite flow"
            )
            yield InputError(f"loads.{name}", problem, "a source with a resistance")


def _probe(scene: Scene, where: str, probe: Any, lines_at: Mapping[str, list[str]]) -> Iterator[InputError]:
    if (probe.at is None) == (probe.position is None):
        yield InputError(where, "its place is not given once", "either at, or line with position")
    elif probe.at is not None:
        here = lines_at[probe.at]
        if probe.line is None and len(here) > 1:
            yield InputError(
                where,
                f"{len(here)} lines meet at '{probe.at}': whose flow is meant?",
                f"line = {' or '.join(map(repr, here[:6]))}",
            )
        if probe.line is not None and probe.line not in here:
            yield InputError(
                f"{where}.line",
                f"does not end at '{probe.at}'",
                " or ".join(map(repr, here[:6])),
                repr(probe.line),
            )
    elif probe.line is None:
        yield InputError(f"{where}.line", "is missing")
    else:
        try:
            probe.fraction(scene.lines[probe.line])
        except InputError as error:
            yield InputError(f"{where}.position", error.problem, error.expected, error.got)
