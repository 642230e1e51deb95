"""Scene of a water network, which starts at its operating point."""

from collections import Counter
from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from typing import Any

from tline.errors import InputError
from tline.interchange.epanet import read_epanet
from tline.interchange.pipe_walls import Keys, keys_of, notes_on, wave_speeds
from tline.interchange.water_controls import WaterControl
from tline.interchange.water_network import (
    LEAST_DROP,
    LISTED,
    STILL,
    TRICKLE,
    Basin,
    Pipe,
    WaterJunction,
    WaterNetwork,
    WaterPump,
    friction_of,
    listed,
)
from tline.interchange.water_valves import guesses, is_shut, put_gate, regulators, valve_link, with_bores
from tline.scene.connected import connected
from tline.scene.file import scene_from
from tline.scene.heights import GRAVITY
from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.solver.steady.steady_state import steady_state
from tline.words.wording import first_of

ADDED = 1e-4  # of the length of all pipes
LONGEST = 3.0  # m, that a pipe is made
WORTH = 1.5  # times the length of the shortest; by less nothing is gained


def least_length(lengths: Collection[float]) -> float:
    """The length to which shorter pipes are brought for ADDED of all length, m; at most LONGEST.

    Examples
    --------
    >>> least_length([0.1, 5000.0, 5000.0]), least_length([0.1, 50.0, 50.0])
    (1.1, 0.11)
    """
    rising, budget, total = sorted(lengths), ADDED * sum(lengths), 0.0
    for k, length in enumerate(rising):
        if k * length - total > budget:
            break
        total += length
    else:
        k = len(rising)
    return min(float(f"{(budget + total) / max(k, 1):.3g}"), LONGEST)


def without_short_pipes(network: WaterNetwork) -> WaterNetwork:
    """The network with very short pipes made longer, with friction over the length that they had; a note names them."""
    least = least_length([pipe.length for pipe in network.pipes.values()])
    short = {name: pipe for name, pipe in network.pipes.items() if pipe.length < least}
    if not short or least < WORTH * min(pipe.length for pipe in short.values()):
        return network
    longer = {name: replace(pipe, length=least) for name, pipe in short.items()}
    added = sum(least - pipe.length for pipe in short.values()) / sum(pipe.length for pipe in network.pipes.values())
    why = f"taken as long as that, which adds {added:.1g} of the network's length, and lose no more"
    note = f"pipes shorter than {least:g} m: {why}: {listed(short)}"
    return replace(network, pipes={**network.pipes, **longer}, notes=(*network.notes, note))


ACCURATE, RELATIVE = 1e-3, 1e-5  # m, and share of the head: accuracy of EPANET's own solution


def differences(network: WaterNetwork, scene: Scene) -> Iterator[str]:
    """Notes on differences between the scene's steady state and the network's."""
    weight, nodes = network.density * GRAVITY, network.nodes
    try:
        effort, _ = steady_state(describe(scene))
    except InputError as error:
        yield f"the scene has no steady state of its own: {error}"
        return
    off = {name: effort[name] / weight - node.head for name, node in nodes.items() if name in effort}
    bad = {name: by for name, by in off.items() if abs(by) > ACCURATE + RELATIVE * abs(nodes[name].head)}
    if bad:
        worst = sorted(bad, key=lambda name: -abs(bad[name]))
        listed = first_of([f"'{name}' by {bad[name]:+.3g} m" for name in worst], LISTED)
        yield f"the steady state of the scene differs from EPANET's heads: {listed}"


AROUND = (1 / 3, 1 / 2, 2 / 3, 5 / 6, 1.0, 7 / 6, 3 / 2, 2.0, 3.0)  # flows of a pump of constant power
T_END, TOL = "10 s", 1e-3  # of the scene, for the user to change


def read_inp(
    path: str,
    wave_speed: float | str | None = None,
    *,
    material: str | None = None,
    hour: float = 0.0,
    moving_tanks: bool = False,
) -> tuple[Scene, tuple[str, ...]]:
    """Read the scene of an EPANET file, with notes on omissions and on levels that are held.

    Parameters
    ----------
    path : str
        An ``.inp`` file.
    wave_speed : number or text, optional
        In the pipes of an .inp file without a material; 1000 m/s if not given.
    material : str, optional
        A CSV file with rows pipe, wall, thickness or pipe, wave speed; the pipe * is all others.
    hour : float
        Hours after an .inp file's start of time at which the scene begins.
    moving_tanks : bool
        Let tanks of an .inp file fill and empty, instead of holding their levels.

    Raises
    ------
    InputError
        A file cannot be read, or has contents that no scene has.
    """
    scene, notes, controls = read_with_controls(path, wave_speed, material, hour, moving_tanks)
    waits = "controls and rules: `tline surge` lets those of the .inp file act within a run, and this scene has none"
    return scene, (*notes, *[waits] * bool(controls))


def read_with_controls(
    path: str,
    wave_speed: float | str | None,
    material: str | None,
    hour: float,
    moving_tanks: bool,
    opened: Collection[str] = (),
) -> tuple[Scene, tuple[str, ...], tuple[WaterControl, ...]]:
    """Scene and notes as of `read_inp`, with closed pipes that are to be opened, and the controls that act later."""
    walls = wave_speeds(wave_speed, material)
    network = read_epanet(path, hour, opened)
    scene, notes = water_scene(network, walls, moving_tanks=moving_tanks)
    told = notes_on(walls, network.pipes, given=wave_speed is not None)
    return scene, (*told, *notes, *differences(network, scene)), network.controls


def water_scene(
    network: WaterNetwork, walls: Mapping[str, Keys], *, moving_tanks: bool = False
) -> tuple[Scene, tuple[str, ...]]:
    """The scene of a network whose pipes have these keys by their names, and notes.

    Pressures of reservoirs are piezometric, density·g·head. Pipes have the friction of the file at any flow, and pipes
    far shorter than all others are lengthened. Reservoirs hold their level, and so do tanks, unless they are to move;
    valves have the opening that gives their loss there, and regulate if they do so there. A demand is an outflow
    through an opening to the air at its node's height, equal to the demand at the operating point. A pump has points of
    its curve, that of the operating point among them.
    """
    network = without_short_pipes(network)
    weight, notes = network.density * GRAVITY, list(network.notes)
    tables: dict[str, Any] = {key: {} for key in ("lines", "links", "loads", "sources", "nodes")}
    for name, pipe in network.pipes.items():
        _add_pipe(tables, network, name, pipe, keys_of(name, walls))
    for name, pump in network.pumps.items():
        tables["links"][name] = _pump(network, name, pump, notes)
    shut = {name for name, pipe in network.pipes.items() if pipe.shut}
    if shut:
        notes.append(f"pipes: the file closes them, and a gate valve at their second end does: {listed(shut)}")
    for name, valve in with_bores(network, notes):
        tables["links"][name] = valve_link(name, valve, network.density, notes)
        shut |= {name} if is_shut(valve) else set()
    for name, node in network.nodes.items():
        _add_node(tables, network, name, node, weight, notes)
    _close_ends(tables)
    for name in _pockets(network, shut) if network.sound else ():
        tables["nodes"][name]["start"] = weight * network.nodes[name].head
    stand = {name for name, pump in network.pumps.items() if not pump.speed}
    if stand:
        notes.append(f"pumps: they stand, behind check valves: {listed(stand)}")
    tanks = {name for name, basin in network.basins.items() if basin.kind == "tank"}
    moving = {name for name in tanks if moving_tanks and network.basins[name].diameter}
    for name in moving:
        tables["loads"][name] = _tank(name, network.basins[name], network.density)
    if tanks - moving:
        notes.append(f"tanks: held at their level: {listed(tanks - moving)}")
    held = [name for name in network.valves if tables["links"][name]["kind"] != "regulating valve"]
    if held:
        notes.append(f"valves: held at the opening that they have at the operating point: {listed(held)}")
    notes += [*regulators(tables["links"]), *guesses(tables["links"])]
    head = {"title": network.title, "medium": "hydraulic", "t_end": T_END, "start": "steady", "solver": {"tol": TOL}}
    head |= {"units": network.units} if network.units != "SI" else {}
    return scene_from(head | {key: table for key, table in tables.items() if table} | _probe(network)), tuple(notes)


def _add_pipe(tables: dict[str, Any], network: WaterNetwork, name: str, pipe: Pipe, keys: Keys) -> None:
    one, two = pipe.nodes
    if pipe.one_way:
        valve = f"{name}:valve"
        if valve in network.nodes:
            problem = "its check valve needs a name that a node has"
            raise InputError(f"pipe '{name}'", problem, f"no node '{valve}'")
        tables["links"][name] = {"kind": "check valve", "nodes": [one, valve]}
        tables["nodes"][valve] = _site(network.nodes[one])
        one = valve
    if pipe.shut:
        two = put_gate(tables, name, two, {"diameter": pipe.diameter, "density": network.density, "opening": 0.0})
        tables["nodes"][two] = _site(network.nodes[pipe.nodes[1]])
    tables["lines"][name] = {
        "nodes": [one, two],
        "length": pipe.length,
        "diameter": pipe.diameter,
        "density": network.density,
        **keys,
        "friction": friction_of(pipe, network.density, network.viscosity),
    } | ({"vertices": [list(vertex) for vertex in pipe.vertices]} if pipe.vertices else {})


def _site(node: WaterJunction | Basin) -> dict[str, Any]:
    return {"elevation": node.elevation, "position": list(node.position)}


def _tank(name: str, tank: Basin, density: float) -> dict[str, Any]:
    level = tank.head - tank.elevation
    limits = {"lowest_level": min(tank.lowest, level), "highest_level": max(tank.highest, level)}
    table = {"at": name, "kind": "surge tank", "tank_diameter": tank.diameter, "density": density, "level": level}
    return table | {key: value for key, value in limits.items() if tank.highest > tank.lowest}


def _close_ends(tables: dict[str, Any]) -> None:
    """Close nodes at which a link ends and nothing else is."""
    ends = Counter(node for link in tables["links"].values() for node in link["nodes"])
    there = {node for line in tables["lines"].values() for node in line["nodes"]}
    there |= {table["at"] for part in ("loads", "sources") for table in tables[part].values()}
    tables["loads"] |= {
        node: {"at": node, "kind": "closed"} for node, n in ends.items() if n == 1 and node not in there
    }


def _pockets(network: WaterNetwork, shut: set[str]) -> list[str]:
    """Nodes that nothing joins with a basin but shut valves, and check valves through which nothing flows."""
    still = {name for name, pipe in network.pipes.items() if pipe.one_way and abs(pipe.flow) <= TRICKLE}
    still |= {name for name, pump in network.pumps.items() if abs(pump.flow) <= TRICKLE}
    links = {**network.pipes, **network.pumps, **network.valves}
    found = connected(network.basins, (links[name].nodes for name in links.keys() - shut - still))
    return [name for name in network.nodes if name not in found]


def _pump(network: WaterNetwork, name: str, pump: WaterPump, notes: list[str]) -> dict[str, Any]:
    """A pump with points of its curve, that of the operating point among them."""
    weight = network.density * GRAVITY
    at = max(pump.flow, 0.0) / pump.speed if pump.flow > TRICKLE else 0.0
    if pump.curve is None:  # constant power: head·flow is constant
        one, two = (network.nodes[node].head for node in pump.nodes)
        power = (two - one) / pump.speed**2 * at
        points = [(at * share, power / (at * share)) for share in AROUND]
        given = f"it gives that from {points[0][0] * pump.speed:.4g} to {points[-1][0] * pump.speed:.4g} m³/s"
        notes.append(f"pump '{name}': constant power: {given}, and beyond that goes on like other pumps")
    else:
        points = pump.curve.points(at)
    speed = {} if pump.speed == 1 else {"speed": pump.speed}
    curve = [[q, weight * h] for q, h in points]
    return {"kind": "pump", "nodes": list(pump.nodes), "curve": curve, "check_valve": True} | speed


def _add_node(
    tables: dict[str, Any],
    network: WaterNetwork,
    name: str,
    node: WaterJunction | Basin,
    weight: float,
    notes: list[str],
) -> None:
    tables["nodes"][name] = _site(node)
    if isinstance(node, Basin):
        tables["loads"][name] = {"at": name, "kind": "reservoir", "pressure": weight * node.head}
        return
    outside = {"at": name, "kind": "check valve"}
    height = node.head - node.elevation
    if node.demand > STILL and height > LEAST_DROP:
        tables["loads"][name] = outside | {"flow": node.demand, "pressure_drop": weight * height}
    elif abs(node.demand) > STILL:
        tables["sources"][name] = {"at": name, "kind": "flow", "value": -node.demand}
        if node.demand > 0:
            notes.append(f"junction '{name}': no pressure, so its demand is a constant flow")
    if node.emitter and f"{name}:emitter" in network.nodes:
        problem = "its emitter needs a name that a node has"
        raise InputError(f"junction '{name}'", problem, f"no node '{name}:emitter'")
    if node.emitter:
        leak = {"at": name, "kind": "leak", "flow": node.emitter, "pressure": weight, "exponent": network.exponent}
        tables["loads"][f"{name}:emitter"] = leak


def _probe(network: WaterNetwork) -> dict[str, Any]:
    """A probe at the junction with the largest demand, for the user to move."""
    ends = {node: name for name, pipe in network.pipes.items() for node in pipe.nodes[pipe.one_way : 2 - pipe.shut]}
    if not ends:
        raise InputError("pipes", "there are none in use", "a network with a pipe")
    drawn = {node: network.junctions[node].demand for node in ends if node in network.junctions}
    at = max(drawn, key=drawn.__getitem__, default=next(iter(ends)))
    return {"probes": {at: {"at": at, "line": ends[at]}}}
