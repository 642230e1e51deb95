"""Imported networks after a start-up, a burst and a closing: run until their waves have faded, against EPANET's own
steady state of what is left.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from tline import InputError, Scene, simulate
from tline.interchange.epanet import read_epanet
from tline.interchange.pipe_walls import wave_speeds
from tline.interchange.water_network import STILL, TRICKLE, WaterNetwork
from tline.interchange.water_scene import water_scene
from tline.scene.heights import GRAVITY
from tline.surge.event import Event
from tline.surge.operate import operated

WALLS = wave_speeds("1000 m/s", None)
BEGIN, TAKES = 1.0, 10.0  # s
HORIZONS = (100.0, 300.0, 1000.0, 3000.0)  # s, until what still moves is
FADED = 2e-4  # of the largest change, or
ACCURATE = 1e-3  # m, as good as EPANET's heads are
FILE = 2e-3  # of the largest change: the accuracy that EPANET's files ask of flows is 1e-3
LEAST = 0.01  # m; a change that is smaller tells nothing
SHOWN = 40  # nodes
DRAWN = 0.2  # a burst lets out so much of all demands


@dataclass(frozen=True)
class Operation:
    """What is operated, and lines of an EPANET file that say what is left."""

    event: Event
    status: str = ""
    hole: tuple[str, float] = ("", 0.0)  # flow over the root of the pressure head, m³/s and m


def operations(network: WaterNetwork) -> Iterator[Operation]:
    """A pump that stands is started, a hole opens at a dead end, and the pipe with most flow is shut."""
    for name, pump in network.pumps.items():
        if not pump.speed:
            yield Operation(Event("start", name, BEGIN, TAKES), f"{name} Open")
            break
    ends = [node for pipe in network.pipes.values() for node in pipe.nodes]
    heights = {name: node.head - node.elevation for name, node in network.junctions.items()}
    dead = [name for name, height in heights.items() if height > 5.0 and ends.count(name) == 1]
    total = sum(max(node.demand, 0.0) for node in network.junctions.values())
    for name in dead or [max(heights, key=heights.__getitem__)]:
        flow = DRAWN * (total or 0.05)
        yield Operation(Event("burst", name, BEGIN, TAKES, flow), hole=(name, flow / heights[name] ** 0.5))
        break
    for name in sorted(network.pipes, key=lambda name: -abs(network.pipes[name].flow)):
        if not network.pipes[name].one_way:
            yield Operation(Event("close", name, BEGIN, TAKES), f"{name} Closed")


def left(path: Path, network: WaterNetwork, operation: Operation, folder: Path) -> WaterNetwork:
    """EPANET's steady state after an operation, with demands that follow the pressure as those of scenes do."""
    text = path.read_text(encoding="utf-8", errors="replace")
    head = text[: text.upper().rindex("[END]")] if "[END]" in text.upper() else text
    other, file = next(iter(network.junctions)), folder / "left.inp"
    options = "[OPTIONS]\nDEMAND MULTIPLIER 1e-12\nEMITTER EXPONENT 0.5\n"
    file.write_text(f"{head}\n{options}[EMITTERS]\n{other} 1\n[END]\n")
    unit = read_epanet(file).junctions[other].emitter
    holes = {
        name: node.emitter + (node.demand / (node.head - node.elevation) ** 0.5 if node.demand > STILL else 0.0)
        for name, node in network.junctions.items()
    }
    where, hole = operation.hole
    if where:
        holes[where] += hole
    emitters = "\n".join(f"{name} {hole / unit:.12g}" for name, hole in holes.items() if hole)
    file.write_text(f"{head}\n{options}[EMITTERS]\n{emitters}\n[STATUS]\n{operation.status}\n[END]\n")
    return read_epanet(file)


def settled(
    network: WaterNetwork, scene: Scene, event: Event, nodes: list[str]
) -> tuple[dict[str, float], dict[str, float], float]:
    """Mean heads at last and how far they still move, m, and when that is, s."""
    changed, _ = operated(scene, [event])
    probes = {f"probe {k}": {"at": node} for k, node in enumerate(nodes)}
    moving, heads, weight, t_end = {}, {}, network.density * GRAVITY, 0.0
    for t_end in HORIZONS:
        horizon = changed.with_changes(probes=probes, t_end=t_end, solver={"order": 1}, measures={})
        seen = simulate(horizon, ledger=False).probes
        for name, probe in seen.items():
            u = probe.u[probe.t > 0.9 * t_end] / weight
            heads[probes[name]["at"]], moving[probes[name]["at"]] = float(u.mean()), float(np.ptp(u))
        change = max(abs(float(probe.u[-1] - probe.u[0])) for probe in seen.values()) / weight
        if max(moving.values()) <= ACCURATE + FADED * change:
            break
    return heads, moving, t_end


def _left_standing(network: WaterNetwork, after: WaterNetwork, operated: str) -> bool:
    """Whether something flowed and is shut off, so that the waves decide what pressure it keeps, or sucks air."""
    links = {**network.pipes, **network.pumps, **network.valves}
    now = {**after.pipes, **after.pumps, **after.valves}
    flowed = [name for name, link in links.items() if abs(link.flow) > TRICKLE and name != operated]
    shut = any(name not in now or abs(now[name].flow) <= TRICKLE for name in flowed)
    return shut or any(after.nodes[name].head < node.elevation for name, node in network.junctions.items())


def measured(path: Path) -> Iterator[dict[str, Any]]:
    """Figures of a network after each kind of operation; why not, of one that is left out."""
    network = read_epanet(path)
    scene, _ = water_scene(network, WALLS)
    odd = any(node.demand < -STILL for node in network.junctions.values())
    low = any(node.demand > STILL and node.head - node.elevation < 1e-3 for node in network.junctions.values())
    emitters = any(node.emitter for node in network.junctions.values()) and network.exponent != 0.5
    if odd or low or emitters or not network.sound:
        yield {"left out": "inflows, demands without pressure, or emitters of another exponent"}
        return
    done: set[str] = set()
    for operation in operations(network):
        kind = operation.event.kind
        if kind in done:
            continue
        with TemporaryDirectory() as folder:
            try:
                after = left(path, network, operation, Path(folder))
            except InputError:
                continue
        same = after.sound and after.junctions.keys() == network.junctions.keys()
        if not same or _left_standing(network, after, operation.event.name):
            continue
        change = {name: after.nodes[name].head - node.head for name, node in network.junctions.items()}
        ordered = sorted(change, key=lambda name: -abs(change[name]))
        if abs(change[ordered[0]]) < LEAST:
            continue
        done.add(kind)
        nodes = ordered[:: max(len(ordered) // SHOWN, 1)]
        heads, moving, t_end = settled(network, scene, operation.event, nodes)
        off = max(nodes, key=lambda name: abs(heads[name] - after.nodes[name].head))
        yield {
            "kind": kind,
            "name": operation.event.name,
            "change": change[ordered[0]],
            "off": heads[off] - after.nodes[off].head,
            "moving": max(moving.values()),
            "t_end": t_end,
            "pipes": len(network.pipes),
            "still": sum(abs(pipe.flow) < 0.01 * np.pi / 4 * pipe.diameter**2 for pipe in network.pipes.values()),
            "formula": next(iter(network.pipes.values())).friction.formula,
        }


def good(found: dict[str, Any]) -> bool:
    return abs(found["off"]) <= ACCURATE + FILE * abs(found["change"])
