"""A pipe in TSNet, which needs an environment of its own: numpy 1.26, wntr 1.2 and six.

    python3 -m venv tsnet && tsnet/bin/pip install tsnet "numpy==1.26.*" "wntr==1.2.*" six
    TSNET_PYTHON=tsnet/bin/python tline chart peers friction

A valve between a pipe and a reservoir at the border of a network is a given velocity there, once it is operated; TSNet
has that at the second of two pipes only, so the pipe is two of half its length. The steady state that EPANET finds in
floats of 32 bits is replaced by the exact one, its friction factor too.
"""

import os
import shutil
import subprocess
import tempfile
import time
from math import pi
from pathlib import Path
from typing import Any

import numpy as np

from tline.charts.clock import Run
from tline.charts.ngspice import corners
from tline.errors import InputError
from tline.scene.scene import Scene

PYTHON = "TSNET_PYTHON"  # variable that names the interpreter
DENSITY, G, HEAD = 1000.0, 9.8, 2000.0  # kg/m³; m/s², as it has it; m, so high that nothing boils
PATIENCE = 300.0  # s, after which it is stopped
NETWORK = """[RESERVOIRS]
 tank {head}
 sink 0
[JUNCTIONS]
 mid 0 0
 far 0 0
[PIPES]
 one tank mid {half} {diameter} 100 0 Open
 two mid far {half} {diameter} 100 0 Open
[VALVES]
 valve far sink {diameter} TCV {loss} 0
[OPTIONS]
 UNITS CMH
[TIMES]
 DURATION 0
[END]
"""
RUN = """
import contextlib, sys, time, warnings
import numpy as np
warnings.simplefilter("ignore")
with contextlib.redirect_stdout(None):
    import tsnet
    path, result = sys.argv[1:3]
    head, half, diameter, speed, velocity, factor, shut, end, n = map(float, sys.argv[3:])
    model = tsnet.network.TransientModel(path)
    model.set_wavespeed(speed)
    model.set_time(end, half / speed / n * (1 - 1e-12))
    model.valve_closure("valve", [shut, 0.0, 0.0, 1.0])
    model = tsnet.simulation.Initializer(model, 0)
    lost = factor * half / diameter * velocity**2 / 2 / {g}
    for k, (_, pipe) in enumerate(model.pipes()):
        pipe.roughness = factor
        pipe.initial_velocity[:] = velocity
        pipe.initial_head[:] = head - lost * (k + np.linspace(0, 1, len(pipe.initial_head)))
        pipe.end_node_head[0] = pipe.initial_head[-1]
    begun = time.perf_counter()
    model = tsnet.simulation.MOCSimulator(model, path)
    seconds = time.perf_counter() - begun
np.savez(result, t=np.arange(len(pipe.end_node_head)) * model.time_step, head=pipe.end_node_head, seconds=seconds)
"""


def misfit(scene: Scene) -> str | None:
    """Why it cannot do a scene; None if it can."""
    if scene.medium != "hydraulic":
        return "for water only"
    if scene.start != "steady":
        return "its flows stop, and none begins at rest"
    if not shutil.which(os.environ.get(PYTHON, "")):
        return f"{PYTHON} names no interpreter that has it; see tline/charts/tsnet.py"
    return None


def run(scene: Scene, n: int) -> Run:
    """A run of n reaches, an even number; heads count from that of the reservoir.

    Raises
    ------
    InputError
        There are fewer than four reaches, or it fails or takes too long.
    """
    if n < 4:
        raise InputError("n", "its pipes have two reaches at least", "4 in two pipes", f"{n}")
    (line,), (draw,) = scene.single_lines.values(), scene.sources.values()
    pipe: Any = line.parameters
    area, diameter, half = pi * pipe.radius**2, 2 * pipe.radius, pipe.length / 2
    (_, flow), (shut, _), *_ = corners(draw.value, scene.t_end) or []
    velocity = -flow / area
    factor = line.losses.quadratic * 2 * diameter * area**2 / DENSITY if line.losses else 0.0
    loss = (HEAD - factor * pipe.length / diameter * velocity**2 / 2 / G) / (velocity**2 / 2 / G)
    with tempfile.TemporaryDirectory() as folder:
        network, result = Path(folder, "pipe.inp"), Path(folder, "result.npz")
        network.write_text(NETWORK.format(head=HEAD, half=half, diameter=diameter * 1000, loss=loss))
        given = (HEAD, half, diameter, pipe.length / pipe.delay, velocity, factor, shut, scene.t_end, n / 2)
        begun = time.perf_counter()
        call = [os.environ[PYTHON], "-c", RUN.format(g=G), network, result, *map(repr, given)]
        try:
            done = subprocess.run(call, capture_output=True, text=True, timeout=PATIENCE, check=False, cwd=folder)
        except subprocess.TimeoutExpired:
            raise InputError("TSNet", f"not done within {PATIENCE:g} s") from None
        first = time.perf_counter() - begun
        if done.returncode:
            raise InputError("TSNet", f"failed: {done.stderr.strip().splitlines()[-1]}")
        with np.load(result) as found:
            t, head, seconds = found["t"], found["head"], float(found["seconds"])
    u = np.asarray((head - HEAD) * DENSITY * G)
    return Run(t, dict.fromkeys(scene.probes, u), seconds, first)
