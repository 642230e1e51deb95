"""Checks across elements: names without a target, and elements that exclude each other."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Set
from math import inf
from typing import TYPE_CHECKING, Any

from tline.errors import InputError
from tline.scene.cavities import with_cavities
from tline.scene.coupled import Coupled, ends_of
from tline.scene.element import Measured, is_name
from tline.scene.factor import check_range
from tline.scene.heights import height_mistakes
from tline.scene.held import conflicting_holds, is_capacitive
from tline.scene.ibis import die_of
from tline.scene.law import NonLinear
from tline.scene.load import Matched
from tline.scene.pipe_table import PipeTable
from tline.scene.quantity import Quantity
from tline.scene.rational import RationalImpedance
from tline.scene.source import Source
from tline.scene.stretches import Stretches, stretches_of
from tline.words.wording import nearest, place, shown

if TYPE_CHECKING:
    from tline.scene.measure import Probe
    from tline.scene.scene import Scene

SAME_DELAY = 1 + 1e-12  # tolerance: a slab that exceeds a delay by less counts as equal
Ends = Mapping[str, list[str]]  # node -> lines that end there, twice if with both ends


def misplaced(data: Mapping[str, Any]) -> list[InputError]:
    """Find elements at nodes where no line ends, in tables as read, so that other mistakes do not hide these."""
    lines, found, table = _tables(data, "lines"), [], data.get("lines")
    for section in ("lines", "probes"):
        if section in data and not data[section] and not isinstance(table, str):
            missing = "there is nothing to simulate" if section == "lines" else "nothing would be recorded"
            found.append(InputError(section, missing, f"at least one table [{section}.NAME]"))
    if isinstance(table, PipeTable):
        lines, known, nodes = table, True, sorted(table.nodes)
    else:
        ends = [_ends(line) for line in lines.values()]
        known = bool(lines) and all(ends)
        nodes = sorted({node for pair in ends for node in pair}) if known else []
    there, linked = set(nodes), Counter(node for _, _, _, node in _joined(data))
    anywhere = there | linked.keys() | _dies(data)
    if known:
        found += _loose_ends(data, nodes, linked)
    for section in ("sources", "loads", "probes"):
        for name, table in _tables(data, section).items():
            at, line = table.get("at"), table.get("line")
            if known and isinstance(at, str) and at not in anywhere:
                where = place(section, name, "at")
                problem = "no line or link ends at this node" if linked else "no line ends at this node"
                found.append(InputError(where, problem, nearest(at, sorted(anywhere)), shown(at)))
            if section == "probes" and lines and isinstance(line, str) and line not in lines:
                where = place(section, name, "line")
                found.append(InputError(where, "no such line", nearest(line, [*lines]), shown(line)))
    for node in _tables(data, "nodes"):
        if known and node not in anywhere:
            found.append(InputError(place("nodes", node), "no line ends at this node", nearest(node, nodes)))
    return found


def _ends(line: Mapping[str, Any]) -> list[str]:
    """Nodes named in a line's table; none if they are not names."""
    parts = [line.get("nodes1"), line.get("nodes2")] if "nodes1" in line else [line.get("nodes")]
    if all(isinstance(p, list | tuple) and (len(p) == 2 or "nodes1" in line) and all(map(is_name, p)) for p in parts):
        return [node for part in parts for node in part or ()]
    return []


def _named(table: Mapping[str, Any]) -> list[str]:
    """Nodes named in the table of a link or a source; none if they are not names."""
    nodes = table.get("nodes")
    return [*nodes] if isinstance(nodes, list | tuple) and all(map(is_name, nodes)) else []


def _joined(data: Mapping[str, Any]) -> list[tuple[str, str, int, str]]:
    """Nodes named by links and by sources between nodes: section, name, index among their nodes, node."""
    return [
        (section, name, k, node)
        for section in ("links", "sources")
        for name, table in _tables(data, section).items()
        for k, node in enumerate(_named(table))
    ]


def _loose_ends(data: Mapping[str, Any], nodes: list[str], linked: Counter[str]) -> Iterator[InputError]:
    """Find ends of links, and of sources between nodes, at nodes without any other element."""
    there = {*nodes} | {str(table.get("at")) for part in ("sources", "loads") for table in _tables(data, part).values()}
    for section, name, k, node in _joined(data):
        if node not in there and linked[node] == 1:
            where = place(section, name, "nodes", k)
            yield InputError(where, "nothing else is at this node", nearest(node, nodes), shown(node))


def _dies(data: Mapping[str, Any]) -> set[str]:
    """Nodes of the dies of IBIS models, which packages separate from their pins."""
    return {die_of(name) for name, table in _tables(data, "loads").items() if table.get("kind") == "ibis"}


def _tables(data: Mapping[str, Any], section: str) -> dict[str, dict[str, Any]]:
    tables = data.get(section)
    tables = tables if isinstance(tables, dict) else {}
    return {
        str(name): table if isinstance(table, dict) else getattr(table, "__dict__", {})
        for name, table in tables.items()
    }


def conflict_alike(one: Any, other: Any) -> bool:
    """Whether two elements at the same place, each valid alone, exclude the same other elements.

    For linear ones that depends on their kind, and on whether they are shorts or capacitors to a jump; for
    sources on whether they are ideal; for others on waveforms alone.
    """
    if type(one) is not type(other):
        return False
    if isinstance(one, NonLinear | Source):
        pairs = [(getattr(one, name), getattr(other, name)) for name in type(one).model_fields]
        alike = all(a is b or (isinstance(a, Quantity) and isinstance(b, Quantity)) for a, b in pairs)
        return alike and (isinstance(one, NonLinear) or (one.conductance == inf) == (other.conductance == inf))
    if not isinstance(one, RationalImpedance):
        return False
    ratio, anew = one.ratio, other.ratio
    degrees, now = [*map(len, ratio)], [*map(len, anew)]
    return ratio.is_zero == anew.is_zero and (degrees == now or is_capacitive(one) == is_capacitive(other))


def conflicts(scene: Scene) -> Iterator[InputError]:
    """Find elements, each valid alone, that exclude each other; misplaced ones do not count."""
    ends = scene.lines_at
    yield from _waveforms(scene)
    yield from conflicting_holds(scene)
    yield from height_mistakes(scene)
    yield from _coupled(scene)
    yield from _cavities(scene)
    yield from _steady(scene)
    yield from _measured(scene)
    linked = {node for _, nodes in scene.between for node in nodes} - set(ends)
    for name, load in scene.loads.items():
        if isinstance(load, Matched) and load.at in linked:
            yield InputError(place("loads", name), f"no line ends at node '{load.at}' to be matched", "a resistor")
        elif isinstance(load, Matched) and len(ends.get(load.at, [""])) != 1:
            problem = f"node '{load.at}' is a junction, and only the end of one line can be matched"
            yield InputError(place("loads", name), problem, "a resistor", f"{len(ends[load.at])} ends")
    hidden = scene.delay_lines
    ends = {node: [line for line in lines if line not in hidden] for node, lines in ends.items()}
    mistakes = [*_probes(scene, ends, linked)]
    yield from mistakes
    stretches = {} if mistakes else stretches_of(scene)
    yield from _slab(scene, stretches)
    yield from _names(scene, stretches)
    for name, measure in scene.measures.items():
        for key, probe in measure.probes:
            if probe not in scene.probes:
                known = nearest(probe, [*scene.probes])
                yield InputError(place("measures", name, *key.split(".")), "no such probe", known, shown(probe))


def _slab(scene: Scene, cut: Mapping[str, Stretches]) -> Iterator[InputError]:
    slab = scene.solver.slab
    if scene.solver.rounded and scene.solver.order not in (None, 1):
        yield InputError("solver.order", "delays are rounded in the first order alone", "1", f"{scene.solver.order}")
    if slab is None or not scene.lines or scene.solver.rounded:
        return
    if isinstance(scene.lines, PipeTable):
        k = int(scene.lines.delay.argmin())
        least, shortest = float(scene.lines.delay[k]), scene.lines.names[k]
    else:
        widths = {name: min(each.widths) for name, each in cut.items()}
        delays = ((line.shortest * widths.get(name, 1.0), name) for name, line in scene.lines.items())
        least, shortest = min(delays, key=lambda each: each[0])
    if slab > least * SAME_DELAY:
        expected = f"at most that of {place('lines', shortest)}, {least:.6g} s"
        yield InputError("solver.slab", "longer than the shortest delay", expected, f"{slab:.6g} s")


def _coupled(scene: Scene) -> Iterator[InputError]:
    """Find matched loads at coupled conductors, and names that their modes need."""
    if isinstance(scene.lines, PipeTable):
        return
    coupled = {node for line in scene.lines.values() if isinstance(line, Coupled) for node in line.nodes}
    modal = {node for end in ends_of(scene.lines) for node in end.modal}
    modal |= {node.rpartition(",")[0] for node in modal}
    for name in modal & {*scene.lines, *(node for line in scene.lines.values() for node in line.nodes)}:
        yield InputError("lines", "a name that a mode of coupled conductors has", "another name", f"'{name}'")
    for name, load in scene.loads.items():
        if load.at in coupled and isinstance(load, Matched):
            problem = f"a {load.kind} load at node '{load.at}' of coupled conductors"
            yield InputError(place("loads", name), problem, "a resistor")


def _cavities(scene: Scene) -> Iterator[InputError]:
    """Find lines with cavities at places of unknown height."""
    high = {name for name, site in scene.nodes.items() if site.elevation is not None}
    for name, line in with_cavities(scene.lines).items():
        missing = [node for node in line.nodes if high and node not in high]
        if missing:
            where, problem = place("lines", name, "cavities"), f"the height of node '{missing[0]}' is not known"
            yield InputError(where, problem, "elevations of both ends of the line, or of no node")


def _names(scene: Scene, cut: Mapping[str, Stretches]) -> Iterator[InputError]:
    """Find names that the parts of lines in stretches need."""
    joining = [*scene.lines.values(), *scene.links.values()] if cut else []
    known = {*scene.lines, *scene.loads, *(node for each in joining for node in each.nodes)}
    for name, stretches in cut.items():
        for own in {*stretches.lines, *stretches.places} & known:
            yield InputError("lines", f"a name that a part of {place('lines', name)} has", "another name", f"'{own}'")


def _waveforms(scene: Scene) -> Iterator[InputError]:
    for (part, name, key), waveform in scene.waveforms.items():
        try:
            waveform.breaks(scene.t_end)
            if part != "sources":
                check_range(waveform, scene.t_end, 1.0 if key == "opening" else inf)
        except InputError as error:
            where = place(part, name, key, *filter(None, [error.where]))
            yield InputError(where, error.problem, error.expected, error.got)


def _steady(scene: Scene) -> Iterator[InputError]:
    """Find values that only a steady start determines or allows."""
    for at, element in scene.placed if scene.start != "steady" else ():
        mistake = isinstance(element, NonLinear) and element.mistake_at_rest
        if mistake:
            yield InputError(place(*at, mistake.where), mistake.problem, mistake.expected)


def _measured(scene: Scene) -> Iterator[InputError]:
    """Find measured one-ports beside rational impedances: only alone are they as well conditioned as their fits."""
    at: dict[str, list[str]] = defaultdict(list)
    for name, load in scene.loads.items():
        if isinstance(load, RationalImpedance):
            at[load.at].append(name)
    for names in at.values():
        one = next((name for name in names if isinstance(scene.loads[name], Measured)), None)
        other = next((name for name in names if name != one), None)
        if one and other:
            yield InputError(place("loads", one), f"stands beside {place('loads', other)}", "a line between them")


def _probes(scene: Scene, ends: Ends, linked: Set[str]) -> Iterator[InputError]:
    dies = {die_of(own) for own in scene.loads}
    for name, probe in scene.probes.items():
        where = place("probes", name)
        if (probe.at is None or probe.at in ends or probe.at in linked) and (
            probe.line is None or probe.line in scene.lines
        ):
            yield from _probe(scene, where, probe, ends)
        elif probe.at in dies:
            yield InputError(f"{where}.at", "no package parts this die from its pin", "the pin's node")


def _probe(scene: Scene, where: str, probe: Probe, ends: Ends) -> Iterator[InputError]:
    if (probe.at is None) == (probe.position is None):
        yield InputError(where, "its place is not given once", "either at, or line with position")
    elif probe.at is not None:
        here = list(dict.fromkeys(ends.get(probe.at, ())))
        either = " or ".join(map(repr, here[:6]))
        if probe.line is not None and probe.line not in here:
            yield InputError(f"{where}.line", f"does not end at '{probe.at}'", either or "none", repr(probe.line))
        elif probe.beside is not None or probe.mode is not None:
            yield from _pair(scene, where, probe, here)
    elif probe.beside is not None or probe.mode is not None:
        yield InputError(f"{where}.mode", "modes are recorded at nodes", "at = a node in place of a position")
    elif probe.line is None:
        yield InputError(f"{where}.line", "is missing")
    elif isinstance(scene.lines[probe.line], Coupled):
        yield InputError(f"{where}.position", "nothing is recorded within coupled conductors", "at = one of its nodes")
    else:
        try:
            probe.fraction(scene.lines[probe.line])
        except InputError as error:
            yield InputError(f"{where}.{error.where}", error.problem, error.expected, error.got)


def _pair(scene: Scene, where: str, probe: Probe, here: list[str]) -> Iterator[InputError]:
    """Check a mode of two coupled conductors: it needs both, at one end of the only line there or of the named one."""
    if probe.beside is None or probe.mode is None:
        missing = "beside" if probe.beside is None else "mode"
        yield InputError(f"{where}.{missing}", "is missing", "beside and mode")
        return
    line = scene.lines[probe.line or here[0]] if probe.line or len(here) == 1 else None
    ends = [end for end in (line.nodes1, line.nodes2) if probe.at in end] if isinstance(line, Coupled) else []
    others = [node for end in ends for node in end if node != probe.at]
    if probe.beside not in others:
        expected = " or ".join(map(repr, others)) or "a probe at conductors with nodes1 and nodes2"
        yield InputError(f"{where}.beside", "no conductor beside it at the same end", expected, shown(probe.beside))
