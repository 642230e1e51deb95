"""Large networks: streets of up to a million pipes, and the networks of wntr, at rest and disturbed.

``python -m benchmarks.networks [PIPES | NAME…]`` writes the tables of benchmarks/pages/networks.md: streets of at most
this number of pipes, or networks of these names; by default all, in some twenty-five minutes and ten gigabytes. Each
network is built and run in a process of its own, after a small one for which everything is compiled.
"""

import csv
import json
import resource
import runpy
import sys
import time
from math import log
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import tomli_w

from benchmarks.harness import ROOT, RUNS, apart, table, timed, write
from tline.scene.file import read_scene
from tline.scene.scene import Scene
from tline.solver.result.result import Result
from tline.solver.simulate import simulate
from tline.surge.event import Event
from tline.surge.operate import operated

SIDES = (8, 23, 71, 225, 708)
PIPES = [2 * side * (side - 1) for side in SIDES]  # 1e2 to 1e6
REPEATED, QUICK_SECONDS = 10_000, 5.0  # pipes up to which, and seconds below which, a run is repeated
MEGABYTE = 1e6 if sys.platform == "darwin" else 1e3  # in units of ru_maxrss
NAMES = ("Net1", "Net2", "Net3", "ky4", "ky10")
STILL, DISTURBED, HEAD = 10, 5, 9806.65  # s; Pa/m


def town(side: int, friction: bool, folder: Path) -> Path:
    """Write a town, its pipes in a table of their own."""
    scene = runpy.run_path(str(ROOT / "scenes" / "street_grid.py"))["grid"](side, friction=friction) | {"t_end": "2 s"}
    heads = ["name", "from", "to", "length [m]", "diameter [mm]", "wave_speed [m/s]", "density [kg/m^3]"]
    with (folder / "pipes.csv").open("w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(heads + ["friction.kind", "friction.factor"] * friction)
        for name, pipe in scene["lines"].items():
            sizes = (pipe[key].split()[0] for key in ("length", "diameter", "wave_speed", "density"))
            rows.writerow([name, *pipe["nodes"], *sizes, *pipe.get("friction", {}).values()])
    path = folder / "town.toml"
    path.write_text(tomli_w.dumps(scene | {"lines": "pipes.csv"}), encoding="utf-8")
    return path


def street_grid(file: str, small: str) -> dict[str, float]:
    """Seconds of the processor to read and to run a town, and the most memory of this process, MB."""
    simulate(read_scene(small), ledger=False)
    scene, read = timed(lambda: read_scene(file), 1)
    result, simulated = timed(lambda: simulate(scene, ledger=False), 1)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / MEGABYTE
    return {"read": read, "simulate": simulated, "steps": result.seconds, "memory": memory}


def streets(most: int) -> None:
    """Write the table of towns up to a number of pipes."""
    if 1.1 * most < PIPES[0]:
        raise SystemExit(f"the smallest town has {PIPES[0]:,} pipes")
    rows = []
    for friction in (False, True):
        before: tuple[float, ...] = ()
        for side, pipes in zip(SIDES, PIPES, strict=True):
            if pipes > 1.1 * most:
                continue
            with TemporaryDirectory() as folder, TemporaryDirectory() as beside:
                towns = (side, folder), (SIDES[0], beside)  # written apart: a process starts with its parent's memory
                files = [apart("benchmarks.networks", "town", size, int(friction), at) for size, at in towns]
                asked = ("benchmarks.networks", "street", *files)
                runs = [apart(*asked, limit=3600) for _ in range(RUNS if pipes <= REPEATED else 1)]
            read, simulated, steps, memory = (median(run[key] for run in runs) for key in runs[0])
            whole = read + simulated
            slope = f"{log(whole / before[1]) / log(pipes / before[0]):.2f}" if before else ""
            before = pipes, whole
            figures = f"{read:.3g}", f"{simulated:.3g}", f"{steps:.2g}", f"{memory / 1e3:.2g}"
            rows.append((f"{pipes:,}", "Darcy" if friction else "none", *figures, slope))
            print(*rows[-1], sep=" | ", file=sys.stderr)
    head = "pipes|<friction|read, s|simulate, s|steps, s|memory, GB|slope"
    write("benchmarks/pages/networks.md", table(head, rows), "streets")


def repeated(scene: Scene) -> tuple[Result, float]:
    """Run with extremes of all nodes, and measure its seconds by the clock: the median of several if it is short."""
    result, seconds = timed(lambda: simulate(scene, envelope=True, ledger=False), 1, time.perf_counter)
    if seconds > QUICK_SECONDS:
        return result, seconds
    return timed(lambda: simulate(scene, envelope=True, ledger=False), RUNS, time.perf_counter)


def moved(result: Result) -> float:
    """Largest rise or fall of any node, Pa."""
    seen = result.envelope
    assert seen is not None
    return float(np.maximum(seen.highest - seen.start, seen.start - seen.lowest).max())


def disturbed(scene: Scene) -> dict[str, Scene]:
    """Operate one element of a scene at a time: largest demand shut, first pump stopped, a hole of 10 L/s there."""
    demands = {load.at: float(load.flow) for load in scene.loads.values() if load.kind == "check valve"}
    largest = max(demands, key=demands.__getitem__)
    events = {
        "closure": Event("demand", largest, 0.5, 0.5, -demands[largest]),
        "leak": Event("burst", largest, 0.5, 0.5, 10e-3),
    }
    pump = next((name for name, link in scene.links.items() if link.kind == "pump"), None)
    if pump is not None:
        events["trip"] = Event("stop", pump, 0.5, 0.5)
    return {key: operated(scene, [event], more={"t_end": DISTURBED})[0] for key, event in events.items()}


def shipped(name: str) -> dict[str, Any]:
    """All figures of a network that comes with wntr."""
    import wntr

    from tline.interchange.epanet import read_epanet
    from tline.interchange.pipe_walls import wave_speeds
    from tline.interchange.water_scene import water_scene

    walls, folder = wave_speeds("1000 m/s", None), Path(wntr.__file__).parent / "library" / "networks"

    def scene_of(file: str) -> tuple[Scene, Any, float, float]:
        network, read = timed(lambda: read_epanet(folder / f"{file}.inp"), 1, time.perf_counter)
        (scene, _), built = timed(lambda: water_scene(network, walls), 1, time.perf_counter)
        return scene.with_changes(t_end=STILL, solver={"order": 1}), network, read, built

    for each in disturbed(scene_of("Net1")[0]).values():
        simulate(each, envelope=True)
    scene, network, read, built = scene_of(name)
    result, seconds = repeated(scene)
    seen = result.envelope
    assert seen is not None
    start = dict(zip(seen.nodes, seen.start, strict=True))
    off = max(abs(start[at] / HEAD - node.head) for at, node in network.nodes.items() if at in start)
    found = {"pipes": len(scene.lines), "read": read, "build": built, "off": 1e3 * off, "hold": seconds}
    found |= {"steps": result.seconds, "drift": moved(result) / max(map(abs, start.values()))}
    for event, changed in disturbed(scene).items():
        result, seconds = repeated(changed)
        found[event] = f"{seconds:.2g} s, {moved(result) / HEAD:.3g} m"
    return found


def of_wntr(names: list[str]) -> None:
    """Write the tables of networks that come with wntr."""
    still, events = [], []
    for name in names:
        f = apart("benchmarks.networks", "shipped", name, limit=1200)
        figures = f"{f['read']:.2g}", f"{f['build']:.2g}", f"{f['off']:.1g}", f"{f['hold']:.3g}", f"{f['steps']:.3g}"
        still.append((name, f"{f['pipes']:,}", *figures, f"{f['drift']:.0e}"))
        events.append((name, *(f.get(key, "no pump") for key in ("closure", "trip", "leak"))))
        print(*still[-1], *events[-1], sep=" | ", file=sys.stderr)
    head = "<network|pipes|read, s|build, s|off, mm|hold, s|steps, s|moved"
    write("benchmarks/pages/networks.md", table(head, still), "still")
    write("benchmarks/pages/networks.md", table("<network|demand shut|pump stops|hole opens", events), "disturbed")


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["town", side, friction, folder]:
            print(json.dumps(str(town(int(side), friction == "1", Path(folder)))))
        case ["street", file, small]:
            print(json.dumps(street_grid(file, small)))
        case ["shipped", name]:
            print(json.dumps(shipped(name)))
        case [most] if most.isdigit():
            streets(int(most))
        case names:
            if not names:
                streets(1_000_000)
            of_wntr(names or list(NAMES))
