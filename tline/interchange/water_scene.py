"""From a water network at its operating point to a scene that starts there."""

from collections import Counter
from dataclasses import replace
from math import pi, sqrt
from typing import Any

from tline.errors import InputError
from tline.interchange.epanet import read_epanet
from tline.interchange.head_loss import GRAVITY as EPANETS
from tline.interchange.compare_heads import differences
from tline.interchange.water_network import STILL, TRICKLE, Basin, Junction, Pipe, Pump, Valve, WaterNetwork, listed
from tline.scene.file import scene_from
from tline.scene.quantity import Quantity
from tline.scene.scene import Scene
from tline.scene.site import GRAVITY
from tline.scene.travel import open_loss, opening_of, shares

T_END, TOL = "10 s", 1e-3  # of the scene, for the user to change
LEAST_DROP = 1e-3  # m; less is none
TRAVELS = {"PRV": "globe", "PSV": "globe", "PBV": "globe", "FCV": "globe", "TCV": "butterfly", "GPV": "butterfly"}  # gates do not throttle
WIDE = 3.0  # times the bore of the pipes beside it: no valve's
FLAT = 1e-6  # share by which a head that is added falls with the flow


def read_inp(path: str, wave_speed: float | str) -> tuple[Scene, tuple[str, ...]]:
    """Scene of an EPANET file, and notes on what is left out or held.

    Parameters
    ----------
    path : str
        An ``.inp`` file.
    wave_speed : number or text
        In all pipes, such as ``"1000 m/s"``.

    Raises
    ------
    InputError
        The file cannot be read, or holds what no scene has.
    """
    Quantity(wave_speed, "m/s", "wave_speed")
    network = read_epanet(path)
    scene, notes = water_scene(network, wave_speed)
    return scene, (*notes, *differences(network, scene))


def water_scene(network: WaterNetwork, wave_speed: float | str) -> tuple[Scene, tuple[str, ...]]:
    """The scene of a network, and notes.

    Pressures are piezometric, density·g·head. The friction factor of a pipe is the one that the operating point has.
    Reservoirs and tanks hold their level, valves the opening that loses what they lose there; a demand is what an opening to the air lets out that
    gives the demand at the operating point. A pump has the parabola through its shut-off head with head and slope at
    the operating point.

    Raises
    ------
    InputError
        An element that no scene has.
    """
    weight, notes = network.density * GRAVITY, list(network.notes)
    tables: dict[str, Any] = {key: {} for key in ("lines", "links", "loads", "sources", "nodes")}
    for name, pipe in network.pipes.items():
        _add_pipe(tables, network, name, pipe, wave_speed)
    for name, pump in network.pumps.items():
        tables["links"][name] = _pump(network, name, pump, notes)
    valves = dict(zip(network.valves, _with_bores(network, notes), strict=True))
    shut = {name for name, valve in valves.items() if _is_shut(valve)}
    for name, valve in valves.items():
        tables["links"][name] = _valve(name, valve, network.density, name in shut, notes)
    for name, node in network.nodes.items():
        _add_node(tables, network, name, node, weight, notes)
    _close_ends(tables)
    for name in _pockets(network, shut) if network.sound else ():
        tables["nodes"][name]["start"] = weight * network.nodes[name].head
    tanks = [repr(name) for name, basin in network.basins.items() if basin.kind == "tank"]
    if tanks:
        notes.append(f"tanks: held at their level: {', '.join(tanks)}")
    if network.valves:
        notes.append("valves: held at the opening that they have at the operating point")
    for kind in sorted({*TRAVELS.values()}):
        names = [n for n in network.valves if tables["links"][n].get("characteristic") == kind]
        if names:
            guess = f"that of a {kind} valve is a guess; give them the characteristic that they have"
            notes.append(f"how valves lose on their way from open to shut: {guess}: {listed(names)}")
    head = {"title": network.title, "medium": "hydraulic", "t_end": T_END, "start": "steady", "solver": {"tol": TOL}}
    return scene_from(head | {key: table for key, table in tables.items() if table} | _probe(network)), tuple(notes)


def _add_pipe(tables: dict[str, Any], network: WaterNetwork, name: str, pipe: Pipe, wave_speed: float | str) -> None:
    one, two = pipe.nodes
    if pipe.one_way:
        valve = f"{name}:valve"
        if valve in network.nodes:
            problem = "its check valve needs a name that a node has"
            raise InputError(f"pipe '{name}'", problem, f"no node '{valve}'")
        tables["links"][name] = {"kind": "check valve", "nodes": [one, valve]}
        tables["nodes"][valve] = _site(network.nodes[one])
        one = valve
    tables["lines"][name] = {
        "nodes": [one, two],
        "length": pipe.length,
        "diameter": pipe.diameter,
        "wave_speed": wave_speed,
        "density": network.density,
        "friction": {"kind": "darcy", "factor": pipe.factor * (GRAVITY / EPANETS)},  # of the same head
    } | ({"vertices": [list(vertex) for vertex in pipe.vertices]} if pipe.vertices else {})


def _site(node: Junction | Basin) -> dict[str, Any]:
    return {"elevation": node.elevation, "position": list(node.position)}


def _with_bores(network: WaterNetwork, notes: list[str]) -> list[Valve]:
    """The valves; where files give a bore that no valve has, with that of the pipes beside it."""
    beside: dict[str, float] = {}
    for pipe in network.pipes.values():
        for node in pipe.nodes:
            beside[node] = max(beside.get(node, 0.0), pipe.diameter)
    found, changed = [], []
    for name, valve in network.valves.items():
        usual = max(beside.get(node, 0.0) for node in valve.nodes)
        if usual and valve.diameter > WIDE * usual:
            changed.append(name)
            valve = replace(valve, diameter=usual)
        found.append(valve)
    if changed:
        notes.append(f"valves: much wider than the pipes beside them, and taken as wide as these: {listed(changed)}")
    return found


def _is_shut(valve: Valve) -> bool:
    """Whether it holds a head and lets nothing pass."""
    return abs(valve.flow) <= TRICKLE and abs(valve.drop) > LEAST_DROP


def _valve(name: str, valve: Valve, density: float, shut: bool, notes: list[str]) -> dict[str, Any]:
    """A valve at the opening at which it loses what it loses at the operating point.

    If that is less than such a valve loses wide open, it loses so much less all along its travel.
    """
    if valve.flow * valve.drop < 0 and abs(valve.flow) > TRICKLE and abs(valve.drop) > LEAST_DROP:
        return _adding(name, valve, density * GRAVITY, notes)
    kind = TRAVELS[valve.kind]
    usual, speed = open_loss(kind, valve.diameter), abs(valve.flow) / (pi / 4 * valve.diameter**2)
    opening, loss = 0.0 if shut else 1.0, usual
    if abs(valve.flow) > TRICKLE:
        per_head = 2 * GRAVITY / speed**2
        lost = max(abs(valve.drop), LEAST_DROP) * per_head
        loss = min(lost, usual)
        opening = opening_of(shares(kind, loss), sqrt(loss / lost))
    return {
        "kind": "orifice",
        "nodes": list(valve.nodes),
        "loss_coefficient": loss,
        "diameter": valve.diameter,
        "density": density,
        "opening": opening,
        "characteristic": kind,
    }


def _adding(name: str, valve: Valve, weight: float, notes: list[str]) -> dict[str, Any]:
    """What stands for a pressure breaker against whose setting water flows: EPANET lets it add head."""
    rise, flow = abs(valve.drop), abs(valve.flow)
    says = f"water flows through it backward, and EPANET lets it add {rise:.4g} m of head, as no valve can"
    notes.append(f"valve '{name}': {says}; a pump of that head stands for it, so check the network")
    one, two = valve.nodes if valve.flow > 0 else reversed(valve.nodes)
    return {"kind": "pump", "nodes": [one, two], "curve": [[0.0, weight * rise * (1 + FLAT)], [flow, weight * rise]]}


def _close_ends(tables: dict[str, Any]) -> None:
    """Close nodes at which a link ends and nothing else is."""
    ends = Counter(node for link in tables["links"].values() for node in link["nodes"])
    there = {node for line in tables["lines"].values() for node in line["nodes"]}
    there |= {table["at"] for part in ("loads", "sources") for table in tables[part].values()}
    tables["loads"] |= {node: {"at": node, "kind": "closed"} for node, n in ends.items() if n == 1 and node not in there}


def _pockets(network: WaterNetwork, shut: set[str]) -> list[str]:
    """Nodes that nothing joins with a basin but shut valves, and check valves through which nothing flows."""
    beside: dict[str, list[str]] = {name: [] for name in network.nodes}
    still = {name for name, pipe in network.pipes.items() if pipe.one_way and abs(pipe.flow) <= TRICKLE}
    links = {**network.pipes, **network.pumps, **network.valves}
    for name in links.keys() - shut - still:
        one, two = links[name].nodes
        beside[one].append(two)
        beside[two].append(one)
    new = list(network.basins)
    found = set(new)
    while new:
        new = [other for node in new for other in beside[node] if other not in found]
        found |= {*new}
    return [name for name in network.nodes if name not in found]


def _pump(network: WaterNetwork, name: str, pump: Pump, notes: list[str]) -> dict[str, Any]:
    """A pump whose parabola has head and slope of the curve at the operating point, and its shut-off head if it can."""
    weight, flow = network.density * GRAVITY, pump.flow / pump.speed
    if pump.curve is None:  # constant power: head·flow is constant
        one, two = (network.nodes[node].head for node in pump.nodes)
        head = (two - one) / pump.speed**2
        slope, shut_off = -head / flow, None
    else:
        flow = flow if pump.flow > TRICKLE else pump.curve.last / 2
        head, slope, shut_off = pump.curve.head(flow), pump.curve.slope(flow), pump.curve.head(0.0)
    if head < 0:
        where, problem = f"pump '{name}'", f"works beyond its curve, at a head of {head:.4g} m"
        raise InputError(where, problem, "a head above zero")
    fall = -slope * flow
    if shut_off is not None and shut_off - head <= fall <= 2 * (shut_off - head) * (1 + 1e-12):
        bend = fall - (shut_off - head)
        half = shut_off - (2 * (shut_off - head) - fall) / 2 - bend / 4
        points = [[0.0, shut_off], [flow / 2, half], [flow, head]]
    else:
        points = [[0.0, head + fall / 2], [flow, head]]
        given = "constant power" if shut_off is None else f"{shut_off:.4g} m in the file"
        notes.append(f"pump '{name}': no flow at a head of {head + fall / 2:.4g} m ({given})")
    speed = {} if pump.speed == 1 else {"speed": pump.speed}
    curve = [[q, weight * h] for q, h in points]
    return {"kind": "pump", "nodes": list(pump.nodes), "curve": curve, "check_valve": True} | speed


def _add_node(
    tables: dict[str, Any], network: WaterNetwork, name: str, node: Junction | Basin, weight: float, notes: list[str]
) -> None:
    tables["nodes"][name] = _site(node)
    if isinstance(node, Basin):
        tables["loads"][name] = {"at": name, "kind": "reservoir", "pressure": weight * node.head}
        return
    outside = {"at": name, "kind": "check valve", "back_pressure": weight * node.elevation}
    height = node.head - node.elevation
    if node.demand > STILL and height > LEAST_DROP:
        tables["loads"][name] = outside | {"flow": node.demand, "pressure_drop": weight * height}
    elif abs(node.demand) > STILL:
        tables["sources"][name] = {"at": name, "kind": "flow", "value": -node.demand}
        if node.demand > 0:
            notes.append(f"junction '{name}': no pressure, so its demand is a constant flow")
    if node.emitter and network.exponent != 0.5:
        problem = f"the exponent of emitters is {network.exponent:g}, and a scene has square roots"
        raise InputError(f"junction '{name}'", problem, "0.5")
    if node.emitter and f"{name}:emitter" in network.nodes:
        problem = "its emitter needs a name that a node has"
        raise InputError(f"junction '{name}'", problem, f"no node '{name}:emitter'")
    if node.emitter:
        tables["loads"][f"{name}:emitter"] = outside | {"flow": node.emitter, "pressure_drop": weight}


def _probe(network: WaterNetwork) -> dict[str, Any]:
    """A probe at the junction with the largest demand, for the user to move."""
    ends = {node: name for name, pipe in network.pipes.items() for node in pipe.nodes[pipe.one_way :]}
    if not ends:
        raise InputError("pipes", "there are none in use", "a network with a pipe")
    drawn = {node: network.junctions[node].demand for node in ends if node in network.junctions}
    at = max(drawn, key=drawn.__getitem__, default=next(iter(ends)))
    return {"probes": {at: {"at": at, "line": ends[at]}}}
