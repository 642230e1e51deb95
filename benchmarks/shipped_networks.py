"""The networks that come with wntr, held still and disturbed: python -m benchmarks.shipped_networks [NAME...].

Prints tables and writes them to docs/benchmarks-shipped.md. Each network is run in a process of its own, after a small
scene for which everything is compiled. Takes some ten minutes; needs tline[epanet].
"""

import json
import subprocess
import sys
import time
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from tline.interchange.epanet import read_epanet
from tline.interchange.pipe_walls import wave_speeds
from tline.interchange.water_scene import water_scene
from tline.scene.scene import Scene
from tline.solver.assembly.assemble import assemble
from tline.solver.assembly.loss_elements import loss_elements_in
from tline.solver.description.description import describe
from tline.solver.description.lines import lines_of
from tline.solver.result.result import Result
from tline.solver.simulate import simulate
from tline.solver.steady.steady_state import steady_state

ROOT = Path(__file__).parent.parent
NETWORKS = ("Net1", "Net2", "Net3", "ky4", "ky10")
SPEED = "1000 m/s"
WALLS = wave_speeds(SPEED, None)
STILL, DISTURBED = 10, 5  # s
SOON = {"at": 0.5, "duration": 0.5}  # when what is operated changes, s
REPEATED, FEW = 5, 5.0  # times that a run is repeated if one takes less than so many seconds
HEAD = 9806.65  # Pa/m


def path_of(name: str) -> Path:
    import wntr

    return Path(wntr.__file__).parent / "library" / "networks" / f"{name}.inp"


def fixed(scene: Scene, t_end: float) -> dict[str, Any]:
    """Its tables, to be run once with order 1."""
    return scene.table() | {"solver": {"order": 1}, "t_end": t_end}


def steps(scene: Scene) -> tuple[Result, float]:
    """A run with extremes of all nodes, and the seconds of all of it: the median of several if it is short."""
    seconds = []
    while True:
        begun = time.perf_counter()
        result = simulate(scene, envelope=True, ledger=False)
        seconds.append(time.perf_counter() - begun)
        if seconds[0] > FEW or len(seconds) == REPEATED:
            return result, median(seconds)


def moved(result: Result) -> float:
    """Largest rise or fall of any node, Pa."""
    seen = result.envelope
    assert seen is not None
    return float(np.maximum(seen.highest - seen.start, seen.start - seen.lowest).max())


def disturbed(tables: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """Tables of the scene with one thing operated, by what that is."""
    events = {}
    down = {"shape": "ramp", "from": 1, "to": 0} | SOON
    pumps = [name for name, link in tables.get("links", {}).items() if link["kind"] == "pump"]
    demands = {name: load["flow"] for name, load in tables["loads"].items() if load["kind"] == "check valve"}
    largest = max(demands, key=demands.__getitem__)
    load = tables["loads"][largest]
    hole = {"at": load["at"], "kind": "orifice"}  # to the air at that height
    shut = {"flow": load["flow"], "pressure_drop": load["pressure_drop"], "opening": down}
    events["closure"] = "loads", largest, hole | shut
    if pumps:
        events["trip"] = "links", pumps[0], tables["links"][pumps[0]] | {"speed": down}
    burst = {"flow": "10 L/s", "pressure_drop": 30 * HEAD, "opening": down | {"from": 0, "to": 1}}
    events["leak"] = "loads", "leak", hole | burst
    return {key: tables | {part: tables[part] | {name: one}} for key, (part, name, one) in events.items()}


def measured(name: str) -> dict[str, Any]:
    """All figures of a network."""
    small = fixed(water_scene(read_epanet(path_of("Net1")), WALLS)[0], STILL)
    for table in disturbed(small).values():
        simulate(Scene(**table), envelope=True)
    begun = time.perf_counter()
    network = read_epanet(path_of(name))
    read = time.perf_counter()
    scene, _ = water_scene(network, WALLS)
    built = time.perf_counter()
    effort, _ = steady_state(describe(scene))
    steady = time.perf_counter()
    still = Scene(**fixed(scene, STILL))
    result, seconds = steps(still)
    h, lines = result.resolution.h, lines_of(still)
    blocks = assemble(describe(still), set(), result.resolution).network.blocks
    delays = np.sort([line.delay for line in lines.values()])
    largest = max(map(abs, effort.values()))
    found = {
        "pipes": len(lines),
        "read": read - begun,
        "build": built - read,
        "steady": steady - built,
        "off": 1e3 * max(abs(effort[at] / HEAD - node.head) for at, node in network.nodes.items()),
        "hold": seconds,
        "steps": result.seconds,
        "drift": moved(result) / largest,
        "delays": [float(np.quantile(delays, q)) for q in (0, 0.01, 0.1, 0.5, 1)],
        "slab": h,
        "loss elements": sum(loss_elements_in(lines, h, result.resolution.loss_elements).values()),
        "half slabs": int(sum(max(2 * int(delay / h + 1e-9) - 1, 1) for delay in delays)),
        "stride": blocks.stride,
        "far": len(blocks.far_groups) / (len(blocks.far_groups) + len(blocks.near_groups)),
    }
    for event, table in disturbed(fixed(scene, DISTURBED)).items():
        result, seconds = steps(Scene(**table))
        found[event] = [seconds, moved(result) / HEAD]
    return found


def in_a_process(name: str) -> dict[str, Any]:
    call = [sys.executable, "-W", "ignore", "-m", "benchmarks.shipped_networks", "one", name]
    return json.loads(subprocess.run(call, check=True, stdout=subprocess.PIPE, cwd=ROOT).stdout)


INTRODUCTION = f"""# Benchmarks of networks that come with wntr

Written by `python -m benchmarks.shipped_networks`, from the files as `tline import` reads them: {SPEED} in all
pipes, one run of order 1 in the slabs that the solver chooses, extremes at all nodes, no ledger. Seconds are those of
the clock, for what takes less than {FEW:g} s medians of {REPEATED} runs.

## Read, and held still

*Read* is EPANET's own solution included, *build* the scene, *steady* the steady state, which is *off* by so much from
EPANET's heads of 32 bits. Then nothing is operated for {STILL} s: *hold* is all of the run, *steps* what the kernel
takes of it, and *moved* the most that the pressure of any node leaves the steady one, over the largest; extremes count
from 1e-12 on.

| network | pipes | read, s | build, s | steady, s | off, mm | hold, s | steps, s | moved |
|---|---:|---:|---:|---:|---:|---:|---:|---:|
"""
EVENTS = f"""
## Disturbed

What is operated changes between 0.5 and 1 s; the run ends at {DISTURBED} s. The largest demand is shut, the first pump
loses its speed, or a hole of 10 L/s at 30 m opens where the largest demand is. Beside the seconds stands the most that
the head moves at any node; nothing boils, so a fall may be deeper than water bears.

| network | demand shut | pump stops | hole opens |
|---|---:|---:|---:|
"""
SHORT = """
## Short pipes

No slab is longer than the shortest delay, unless that line can be lumped; at demands, pumps and valves none is. Loss
elements of friction are at most 64 in the longest pipe and in others in proportion, at least one: their number hardly
follows the slab, as the number *at most*, half a slab apart, does. *Far* are the nodes from which all lines, and all
gaps between loss elements, are a *stride* or longer: they go so many slabs at once, the others meanwhile step by step.
*Each* is the time of the kernel's steps by line and slab.

| network | delays to 0, 1, 10, 50, 100 %, ms | slab, ms | slabs in 1 s | loss elements | at most | stride | far | each,
ns | |---|---|---:|---:|---:|---:|---:|---:|---:|
"""


def told(found: dict[str, Any], event: str) -> str:
    return f"{found[event][0]:.2g} s, {found[event][1]:.3g} m" if event in found else "no pump"


def report(names: list[str]) -> str:
    parts = [INTRODUCTION, EVENTS, SHORT]
    for name in names:
        f = in_a_process(name)
        still = "< 1e-12" if f["drift"] == 0 else f"{f['drift']:.0e}"
        each = f["steps"] / (STILL / f["slab"]) / f["pipes"] * 1e9
        delays = ", ".join(f"{1e3 * delay:.3g}" for delay in f["delays"])
        slab, elements = (
            f"{1e3 * f['slab']:.3g} | {1 / f['slab']:,.0f}",
            f"{f['loss elements']:,} | {f['half slabs']:,}",
        )
        rows = (
            f"| {name} | {f['pipes']:,} | {f['read']:.2g} | {f['build']:.2g} | {f['steady']:.2g} | {f['off']:.1g} "
            f"| {f['hold']:.3g} | {f['steps']:.3g} | {still} |",
            f"| {name} | {told(f, 'closure')} | {told(f, 'trip')} | {told(f, 'leak')} |",
            f"| {name} | {delays} | {slab} | {elements} | {f['stride']} | {100 * f['far']:.0f} % | {each:.0f} |",
        )
        for k, row in enumerate(rows):
            parts[k] += row + "\n"
            print(row, file=sys.stderr)
    return "".join(parts)


if __name__ == "__main__":
    if sys.argv[1:2] == ["one"]:
        print(json.dumps(measured(sys.argv[2])))
    else:
        text = report(sys.argv[1:] or list(NETWORKS))
        print(text)
        (ROOT / "docs" / "benchmarks-shipped.md").write_text(text, encoding="utf-8")
