"""Pipes in TSNet, which needs an environment of its own: numpy 1.26, wntr 1.2 and six.

    python3 -m venv tsnet && tsnet/bin/pip install tsnet "numpy==1.26.*" "wntr==1.2.*" six
    TSNET_PYTHON=tsnet/bin/python tline chart peers friction

TSNet's demands depend on the pressure, but an operated valve between a pipe and a reservoir at the border of a network
prescribes the velocity there; so flows leave at the ends of single pipes. This works only in pipes whose other end is
not at the border, so a single pipe is divided into two halves. EPANET's steady state, computed in floats of 32 bits,
is replaced by the exact one, its friction factors too.
"""

import json
import os
import shutil
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from tline.errors import InputError
from tline.scene.friction import darcy
from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.solver.steady.steady_state import steady_state
from tline.study.charts.measure import TimedRun
from tline.study.programs.ngspice import corners

PYTHON = "TSNET_PYTHON"  # variable that names the interpreter
DENSITY, G, HEAD = 1000.0, 9.8, 2000.0  # kg/m³; m/s², as it has it; m, so high that nothing boils
WIDE = 1000  # mm, of valves
PATIENCE = 300.0  # s, after which the program is stopped
RUN = """
import contextlib, json, sys, time, warnings
import numpy as np
warnings.simplefilter("ignore")
with contextlib.redirect_stdout(None):
    import tsnet
    path, given, result = sys.argv[1:]
    with open(given) as file:
        given = json.load(file)
    model = tsnet.network.TransientModel(path)
    model.set_wavespeed([pipe["speed"] for pipe in given["pipes"]])
    model.set_time(given["end"], given["step"] * (1 - 1e-12))
    for valve, rule in given["rules"].items():
        model.valve_closure(valve, rule)
    model = tsnet.simulation.Initializer(model, 0)
    for (_, pipe), exact in zip(model.pipes(), given["pipes"]):
        pipe.roughness = exact["factor"]
        pipe.initial_velocity[:] = exact["velocity"]
        pipe.initial_head[:] = np.linspace(*exact["heads"], len(pipe.initial_head))
        pipe.start_node_head[0], pipe.end_node_head[0] = exact["heads"]
    begun = time.perf_counter()
    model = tsnet.simulation.MOCSimulator(model, path)
    seconds = time.perf_counter() - begun
heads = {name: getattr(model.get_link(pipe), end) for name, (pipe, end) in given["seen"].items()}
t = np.arange(len(next(iter(heads.values())))) * model.time_step
np.savez(result, t=t, seconds=seconds, **heads)
"""


def incompatibility(scene: Scene) -> str | None:
    """Reason why TSNet is not applicable to a scene; None if it is."""
    if scene.medium != "hydraulic":
        return "for water only"
    if scene.start != "steady":
        return "its flows stop, and none begins at rest"
    if not shutil.which(os.environ.get(PYTHON, "")):
        return f"{PYTHON} names no interpreter that has it; see tline/study/programs/tsnet.py"
    return None


def run(scene: Scene, n: int) -> TimedRun:
    """Run n reaches in the shortest pipe; heads count from that of the reservoir."""
    halves = 2 if len(scene.lines) == 1 else 1
    if n < 2 * halves:
        raise InputError("n", "its pipes have two reaches at least", f"{2 * halves}", f"{n}")
    with tempfile.TemporaryDirectory() as folder:
        network, given, result = (Path(folder, name) for name in ("network.inp", "given.json", "result.npz"))
        text, exact = _told(scene, n, halves)
        network.write_text(text, encoding="utf-8")
        given.write_text(json.dumps(exact), encoding="utf-8")
        begun = time.perf_counter()
        call = [os.environ[PYTHON], "-c", RUN, network, given, result]
        try:
            done = subprocess.run(call, capture_output=True, text=True, timeout=PATIENCE, check=False, cwd=folder)
        except subprocess.TimeoutExpired:
            raise InputError("TSNet", f"not done within {PATIENCE:g} s") from None
        seconds = time.perf_counter() - begun
        if done.returncode:
            raise InputError("TSNet", f"failed: {done.stderr.strip().splitlines()[-1]}")
        with np.load(result) as found:
            u = {name: (found[name] - HEAD) * DENSITY * G for name in scene.probes}
            return TimedRun(found["t"], u, float(found["seconds"]), seconds)


def _told(scene: Scene, n: int, halves: int) -> tuple[str, dict[str, Any]]:
    """Format the network for EPANET, and the values that replace EPANET's results."""
    description = describe(scene)
    nodes, (efforts, flows) = description.nodes, steady_state(description)
    heads = {name: HEAD + u / (DENSITY * G) for name, u in efforts.items()}
    held, free = ([name for name, node in nodes.items() if bool(node.held) is fixed] for fixed in (True, False))
    pipes, exact, seen = [], [], {}
    for (name, line), flow in zip(scene.single_lines.items(), flows[:, 0].tolist(), strict=True):
        pipe: Any = line.parameters
        first, last = line.nodes
        places = [first, *(f"{name}.{k}" for k in range(1, halves)), last]
        free += places[1:-1]
        levels = np.linspace(heads[first], heads[last], halves + 1).tolist()
        factor = line.losses.quadratic / darcy(1.0, DENSITY, pipe.area) if line.losses else 0.0
        for k in range(halves):
            pipes.append(
                f"{name}.{k} {places[k]} {places[k + 1]} {pipe.length / halves} {2000 * pipe.radius} 100 0 Open"
            )
            speeds = {"speed": pipe.length / pipe.delay, "velocity": flow / pipe.area}
            exact.append(speeds | {"factor": factor, "heads": levels[k : k + 2]})
        seen |= {first: (f"{name}.0", "start_node_head"), last: (f"{name}.{halves - 1}", "end_node_head")}
    valves, rules = [], {}
    for name, draw in scene.sources.items():
        (start, before), (end, after), *_ = corners(draw.value, scene.t_end) or []
        rules[name] = [end - start, start, after / before, 1.0]
        valves.append(f"{name} {draw.at} sink.{name} {WIDE} TCV 0 0")
        heads[f"sink.{name}"] = heads[str(draw.at)]
    sections = {
        "RESERVOIRS": [f"{name} {heads[name]}" for name in (*held, *(f"sink.{name}" for name in rules))],
        "JUNCTIONS": [f"{name} 0 0" for name in free],
        "PIPES": pipes,
        "VALVES": valves,
        "OPTIONS": ["UNITS CMH"],
        "TIMES": ["DURATION 0"],
        "END": [],
    }
    text = "".join(f"[{title}]\n" + "".join(f" {row}\n" for row in rows) for title, rows in sections.items())
    given = {
        "pipes": exact,
        "rules": rules,
        "seen": {name: seen[str(probe.at)] for name, probe in scene.probes.items()},
    }
    step = min(line.parameters.delay or 0.0 for line in scene.single_lines.values()) / n
    return text, given | {"end": scene.t_end, "step": step}
