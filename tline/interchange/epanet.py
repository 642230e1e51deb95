"""Water networks from EPANET files, at the operating point that EPANET itself finds."""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from math import inf, nan, sqrt
from pathlib import Path
from typing import Any, NamedTuple

from tline.errors import InputError
from tline.interchange.confined import EpanetText, parse, read_text, solved
from tline.interchange.water_controls import water_controls
from tline.interchange.water_network import (
    EPANETS,
    FOOT,
    LEAST_DROP,
    STILL,
    TRICKLE,
    Basin,
    Friction,
    Pipe,
    Polyline,
    PowerLaw,
    Travel,
    Valve,
    WaterJunction,
    WaterNetwork,
    WaterPump,
    listed,
    pump_curve,
)
from tline.scene.connected import connected
from tline.scene.heights import GRAVITY
from tline.scene.rating import HOUR, WATER
from tline.units import to_si
from tline.words.wording import shown

VISCOSITY = 1.1e-5 * FOOT**2  # m²/s, EPANET's
LAST_HOUR = 8784.0  # of a year
HIGHEST, LARGEST = 1e5, 1e9  # m, of a head that is no accident of an unsolved network; and of other numbers
UNEVEN = 1e-4  # of the largest flow
KEPT = 1e-3  # of a setting, or so many of its units; EPANET keeps it so well
INCH, HORSEPOWER, KILOWATT = FOOT / 12, 745.7, 1e3
# in the order of EPANET's codes; the first five go with feet
FLOWS = "ft^3/s", "gpm", "MGD", "IMGD", "AFD", "L/s", "L/min", "ML/d", "m^3/h", "m^3/d"
TRADITIONAL = 5
FORMULAS = ("H-W", "D-W", "C-M")
JUNCTION, RESERVOIR, TANK = range(3)
ONE_WAY, PIPE, PUMP = range(3)
NO_HEAD = 0  # state of a pump that runs, and lifts less than it would have to
VALVES = ("PRV", "PSV", "PBV", "FCV", "TCV", "GPV")
WARNED = {
    2: "its solution may be unstable, for valves or pumps change their state again and again",
    4: "a pump cannot deliver the flow or the head that is asked for",
    5: "a valve cannot hold its setting",
    6: "pressures are negative",
}  # by EPANET's codes


class FileUnits(NamedTuple):
    """SI units of the numbers in a file."""

    length: float
    diameter: float
    flow: float
    power: float
    rough: float  # by Darcy and Weisbach


def read_epanet(path: str | Path, hour: float = 0.0, opened: Collection[str] = ()) -> WaterNetwork:
    """Read an EPANET file (2.0 to 2.3) and its operating point: the steady flow at an hour, 0 to 8784, after its start.

    Levels of tanks, demand patterns, controls and rules count as at that hour. Links closed then are left out, except
    check valves, regulating valves and pipes that are to be `opened`, and the notes name them. EPANET works in a
    process of its own, on a copy of the lines that bear on the flow: no file but this one is read, and none is written.
    """
    if not isinstance(hour, int | float) or not 0 <= hour <= LAST_HOUR:
        raise InputError("hour", "out of range", f"a number from 0 to {LAST_HOUR:g}", shown(hour))
    text = parse(read_text(str(path)), str(path))
    answer = solved(str(path), text.network, round(hour * HOUR))
    network = _network(answer, text, str(path), hour, opened)
    _check_magnitudes(network, str(path))
    return network


def _network(
    answer: Mapping[str, Any], text: EpanetText, path: str, hour: float, opened: Collection[str]
) -> WaterNetwork:
    nodes = {node["name"]: node for node in answer["nodes"]}
    links = {link["name"]: link for link in answer["links"]}
    units = _units(answer["units"])
    viscosity, formula = answer["viscosity"] * VISCOSITY, FORMULAS[int(answer["law"])]
    for node in nodes.values():
        node |= {key: node[key] * units.length for key in ("elevation", "head")}
    for name, link in links.items():
        link["opened"] = name in opened and link["type"] == PIPE and not link["status"]
        link["flow"] *= units.flow
        link["drop"] = nodes[link["ends"][0]]["head"] - nodes[link["ends"][1]]["head"]
    highest = max(nodes.values(), key=lambda node: abs(node["head"] - node["elevation"]))
    scale = highest["pressure"] / ((highest["head"] - highest["elevation"]) or 1.0)  # pressure of a metre in the file
    density = WATER * answer["gravity"]
    closed = {name for name, link in links.items() if _is_closed(link)}
    reached = _reached(nodes, links, closed)
    _check_heads({name: nodes[name]["head"] for name in sorted(reached)}, path)
    reached |= _pockets(nodes, links, closed, reached)
    kept = {
        name for name, link in links.items() if {*link["ends"]} <= reached and not _is_left_out(link, name in closed)
    }
    cut_off = set(nodes) - reached
    lost = sum(nodes[name]["demand"] for name in cut_off) * units.flow
    torn = _unbalanced(nodes, links, units.flow, cut_off)
    piped = {end for name in kept if links[name]["type"] in (ONE_WAY, PIPE) for end in links[name]["ends"]}
    dry = reached - connected(piped, (links[name]["ends"] for name in kept))
    reached -= dry
    used = {name: links[name] for name in links if name in kept and not {*links[name]["ends"]} & dry}
    return WaterNetwork(
        title=text.title,
        density=density,
        viscosity=viscosity,
        exponent=answer["exponent"],
        junctions={
            name: _junction(node, answer["exponent"], scale, units, text)
            for name, node in nodes.items()
            if name in reached and node["type"] == JUNCTION
        },
        basins={
            name: _basin(node, units, text)
            for name, node in nodes.items()
            if name in reached and node["type"] != JUNCTION
        },
        pipes={
            name: _pipe(link, units, formula, text.vertices.get(name, []))
            for name, link in used.items()
            if link["type"] in (ONE_WAY, PIPE)
        },
        pumps={
            name: _pump(f"{path}: pump '{name}'", link, units) for name, link in used.items() if link["type"] == PUMP
        },
        valves={
            name: _valve(link, nodes, scale, units, text.travels.get(name, ()))
            for name, link in used.items()
            if link["type"] > PUMP
        },
        sound=not (abs(lost) > STILL or torn),
        notes=tuple(_notes(answer["warning"], hour if text.held else None, closed - kept, cut_off, dry, lost, torn)),
        units=_told(answer["units"]),
        controls=water_controls(answer, text.controls, nodes, scale, units.length, density * GRAVITY),
    )


def _units(code: int) -> FileUnits:
    flow = to_si(f"1 {FLOWS[code]}", "m^3/s")
    if code < TRADITIONAL:
        return FileUnits(FOOT, INCH, flow, HORSEPOWER, FOOT * 1e-3)
    return FileUnits(1.0, 1e-3, flow, KILOWATT, 1e-3)


def _told(code: int) -> str:
    """Units of a file as scenes name them; of systems the usual unit of flow goes without saying."""
    flow, system = FLOWS[code], "US" if code < TRADITIONAL else "SI"
    return system if flow in ("gpm", "L/s") else f"{system}, {flow}"


def _check_heads(heads: Mapping[str, float], path: str) -> None:
    unsolved = [f"a head of {head:.3g} m at '{name}'" for name, head in heads.items() if not abs(head) < HIGHEST]
    if unsolved or not heads:
        got = unsolved[0] if heads else "none that a link joins"
        raise InputError(path, "EPANET finds no steady flow", "a network fed by reservoirs or tanks", got)


def _check_magnitudes(network: WaterNetwork, path: str) -> None:
    for kind, table in vars(network).items():
        for name, element in table.items() if isinstance(table, dict) else ():
            values = vars(element)
            friction = vars(values["friction"]) if "friction" in values else {}
            for key, value in (values | friction).items():
                largest = HIGHEST if key in ("elevation", "head", "drop") else LARGEST
                if isinstance(value, float) and not abs(value) <= largest:
                    problem = f"its {key} is beyond all numbers of a water network"
                    raise InputError(f"{path}: {kind}.{name}", problem, f"at most {largest:g} in SI", f"{value:g}")


def _is_closed(link: Mapping[str, Any]) -> bool:
    """Whether nothing can flow from one of its nodes to the other."""
    if link["type"] == PUMP:
        without = not link["curve"] and abs(link["flow"]) <= TRICKLE  # its head is any then
        return not link["status"] or link["setting"] <= 0 or without
    return not link["status"]


def _is_left_out(link: Mapping[str, Any], closed: bool) -> bool:
    """Whether a scene omits a link: not shut valves, which can be opened, nor stopped pumps, which can be started.

    A pipe shut against a flow that would overfill a tank cannot be represented as a check valve.
    """
    if link["type"] == PUMP:
        return closed and (not link["curve"] or link["drop"] > 0)
    return closed and (
        (link["type"] == PIPE and not link["opened"]) or (link["type"] == ONE_WAY and link["drop"] > LEAST_DROP)
    )


def _reached(nodes: Mapping[str, Any], links: Mapping[str, Any], closed: set[str]) -> set[str]:
    """Nodes that open links join with a reservoir or a tank."""
    open_ = [links[name]["ends"] for name in links.keys() - closed]
    basins = {name for name, node in nodes.items() if node["type"] != JUNCTION}
    return connected(basins & {end for ends in open_ for end in ends}, open_)


def _pockets(nodes: Mapping[str, Any], links: Mapping[str, Any], closed: set[str], reached: set[str]) -> set[str]:
    """Nodes without demand, and basins, that shut valves, check valves among them, join with those that are reached."""
    basins = {name for name, node in nodes.items() if node["type"] != JUNCTION}
    quiet = {
        name
        for name, node in nodes.items()
        if name not in reached and node["type"] == JUNCTION and not node["demand"] and not node["emitter"]
    }
    loud = set(nodes) - reached - quiet
    open_ = [links[name]["ends"] for name in links.keys() - closed]
    quiet -= connected(loud, open_)
    shut = [links[name]["ends"] for name in closed if not _is_left_out(links[name], True)]
    return connected(reached, open_ + shut, quiet | basins) - reached


def _pipe(link: Mapping[str, Any], units: FileUnits, formula: str, vertices: list) -> Pipe:
    length, diameter = link["length"] * units.length, link["diameter"] * units.diameter
    roughness = link["roughness"] * (units.rough if formula == "D-W" else 1.0)
    friction = Friction(formula, roughness, length, link["minor"])
    one_way, shut = link["type"] == ONE_WAY, link["opened"]
    return Pipe(_ends(link), length, diameter, link["flow"], friction, one_way, tuple(vertices), shut)


def _ends(link: Mapping[str, Any]) -> tuple[str, str]:
    one, two = link["ends"]
    return one, two


def _pump(where: str, link: Mapping[str, Any], units: FileUnits) -> WaterPump:
    curve = _curve(where, link["curve"], units) if link["curve"] else None
    speed = link["setting"]
    if curve and _is_closed(link):
        runs = link["state"] == NO_HEAD and curve.head(0.0) * speed**2 + link["drop"] <= 0
        speed = speed if runs else 0.0
    return WaterPump(_ends(link), curve, None if curve else link["power"] * units.power, speed, link["flow"])


def _curve(where: str, points: list[tuple[float, float]], units: FileUnits) -> PowerLaw | Polyline:
    try:
        return pump_curve([(flow * units.flow, head * units.length) for flow, head in points])
    except InputError as error:
        raise InputError(where, error.problem, error.expected, error.got) from None


def _valve(link: Mapping[str, Any], nodes: Mapping[str, Any], scale: float, units: FileUnits, way: Travel) -> Valve:
    kind = VALVES[link["type"] - PUMP - 1]
    flow = link["flow"] if link["status"] else 0.0
    here, there = (scale * (nodes[end]["head"] - nodes[end]["elevation"]) for end in link["ends"])
    kept = {"PRV": there, "PSV": here, "FCV": flow / units.flow}.get(kind, nan)
    active = flow > TRICKLE and abs(kept - link["setting"]) <= KEPT * max(abs(kept), KEPT)
    valve = Valve(_ends(link), kind, link["diameter"] * units.diameter, flow, link["drop"], active)
    if not way or not link["minor"]:
        return valve
    share = sqrt(link["minor"] / max(link["setting"], link["minor"])) if link["status"] else 0.0
    return replace(valve, loss=link["minor"] * GRAVITY / EPANETS, share=share, travel=way)


def _junction(
    node: Mapping[str, Any], exponent: float, scale: float, units: FileUnits, text: EpanetText
) -> WaterJunction:
    elevation, head = node["elevation"], node["head"]
    try:
        emitter = node["emitter"] * units.flow * scale**exponent
        leaking = emitter * max(head - elevation, 0.0) ** exponent if emitter else 0.0
    except OverflowError:
        emitter, leaking = inf, 0.0  # which is refused by the junction's name
    return WaterJunction(elevation, head, _position(node, text), node["demand"] * units.flow - leaking, emitter)


def _basin(node: Mapping[str, Any], units: FileUnits, text: EpanetText) -> Basin:
    if node["type"] != TANK:
        return Basin("reservoir", node["head"], node["head"], _position(node, text))
    upright = 0.0 if node["curve"] else node["diameter"]
    sizes = (units.length * size for size in (upright, node["lowest"], node["highest"]))
    return Basin("tank", node["elevation"], node["head"], _position(node, text), *sizes)


def _position(node: Mapping[str, Any], text: EpanetText) -> tuple[float, float]:
    return text.positions.get(node["name"], (0.0, 0.0))


def _unbalanced(nodes: Mapping[str, Any], links: Mapping[str, Any], unit: float, cut_off: set[str]) -> set[str]:
    """Junctions at which more flows in than out, or less, in EPANET's solution."""
    rest = {name: -node["demand"] * unit for name, node in nodes.items() if node["type"] == JUNCTION}
    for link in links.values():
        for node, sign in zip(link["ends"], (-1, 1), strict=True):
            if node in rest:
                rest[node] += sign * link["flow"]
    largest = max((abs(link["flow"]) for link in links.values()), default=0.0)
    beside = {end for link in links.values() for end in link["ends"] if {*link["ends"]} & cut_off}
    return {name for name, by in rest.items() if abs(by) > TRICKLE + UNEVEN * largest and name not in beside | cut_off}


def _notes(
    warning: int, hour: float | None, closed: set[str], cut_off: set[str], dry: set[str], lost: float, torn: set[str]
) -> Iterator[str]:
    for names, why in (
        (closed, "closed or without flow"),
        (cut_off, "no open link leads there from a reservoir or tank"),
        (dry, "no pipe in use leads there"),
    ):
        if names:
            yield f"left out, {why}: {listed(names)}"
    if abs(lost) > STILL:
        yield f"left out, a demand of {lost:.3g} m³/s there: EPANET takes it out of the network through what is closed"
    if torn:
        yield f"EPANET's flows do not balance at {listed(torn)}: its solution is none there"
    if hour is not None:
        when = f"after {hour:g} h" if hour else "at the start of time"
        yield f"patterns, controls and rules: as they stand {when}"
    if warning in WARNED:
        yield f"EPANET warns: {WARNED[warning]}"
