"""Surges in processor time, beside TSNet and rthym-moc at equal error: `python -m benchmarks.surges FOLDER`.

Writes a table of docs/compared.md. The folder has Tnet1.inp, Tnet2.inp and Tnet3.inp of TSNet's examples, and TNET3.inp
of PTSNet's; TSNET_PYTHON names the interpreter that has TSNet. Calls count from a file to the highest heads at all
nodes, EPANET included. The reference is tline with delays rounded to slabs of 0.4 ms.
"""

import contextlib
import json
import os
import resource
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator
from functools import partial
from math import sqrt
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from benchmarks.harness import spent, table, timed, write
from tline.scene.friction import FOOT
from tline.scene.heights import GRAVITY
from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.solver.simulate import simulate
from tline.solver.steady.steady_state import above_level
from tline.study.programs.tsnet import PYTHON
from tline.surge.event import read_event
from tline.surge.operate import operated, read_network

HEAD, SPEED = 1e3 * GRAVITY, 1200.0  # Pa/m of water; m/s
FINEST = 0.1 / 2**8  # s, slabs of the reference
SLABS = [0.1 / 2**k for k in range(7)]  # s
STEPS = 0.02, 0.01, 0.005, 0.0025, 0.00125  # s, of rthym-moc
Heads = dict[str, float]  # highest, m, by node
TSNET = """
import contextlib, json, os, sys, time
import numpy as np
folder, file, speed, end, operation, arguments = sys.argv[1:]
os.chdir(folder)
with contextlib.redirect_stdout(None):
    import tsnet
    begun = time.process_time()
    model = tsnet.network.TransientModel(file)
    model.set_wavespeed(float(speed))
    model.set_time(float(end))
    getattr(model, operation)(*json.loads(arguments))
    model = tsnet.simulation.MOCSimulator(tsnet.simulation.Initializer(model, 0, "DD"), "results")
    seconds = time.process_time() - begun
heads = {name: float(np.max(node._head)) for name, node in model.nodes() if np.size(getattr(node, "_head", 0)) > 1}
print(json.dumps([model.time_step, seconds, heads]))
"""


class Run(NamedTuple):
    """One run of a program."""

    program: str
    step: float  # s
    seconds: float
    heads: Heads


class Case(NamedTuple):
    """Operation of a network in tline, and in other programs."""

    title: str
    scene: Callable[[], Scene]
    others: Callable[[], Iterator[Run]]


def processor_time() -> float:
    """Processor time of this process and of those it has waited for, s."""
    return time.process_time() + sum(resource.getrusage(resource.RUSAGE_CHILDREN)[:2])


def plainly(file: Path, t_end: float, kind: str, event: str) -> Scene:
    """Scene of a network with an event."""
    scene = read_network(file, wave_speed=SPEED)[0]
    return operated(scene, [read_event(kind, event)], more={"t_end": t_end})[0]


def with_falling_flow(file: Path, t_end: float) -> Scene:
    """Scene in which the flow at the valve of Tnet1 falls evenly, as TSNet has it at the border of a network."""
    scene = read_network(file, wave_speed=SPEED)[0]
    value = {"shape": "ramp", "from": -above_level(describe(scene)).through["links.VALVE"], "to": 0, "duration": 0.6}
    parts = scene.with_lines()
    near, far = parts["links"].pop("VALVE")["nodes"]
    parts["nodes"].pop(far, None)
    parts["loads"] = {name: load for name, load in parts["loads"].items() if load["at"] != far}
    parts["sources"] = {**parts.get("sources", {}), "valve": {"at": near, "kind": "flow", "value": value}}
    return Scene(scene.folder, **parts | {"t_end": t_end})


def with_valve_of_rthym(file: Path, t_end: float) -> Scene:
    """Scene in which VALVE-179 of TNET3 shuts as in rthym-moc: a loss coefficient of (100/s)² - 1, s falling evenly."""
    scene = read_network(file, wave_speed=4000 * FOOT)[0]
    whole = scene.table()["links"]["VALVE-179"]["loss_coefficient"]
    opened = np.linspace(1, 0, 101)
    share = opened * np.sqrt(whole / (1 + whole - opened**2))
    points = [[1 + t, float(s)] for t, s in zip(1 - opened, share, strict=True)]
    links = scene.with_lines()["links"]
    links["VALVE-179"].pop("characteristic")
    links["VALVE-179"]["opening"] = {"shape": "piecewise linear", "points": points}
    return scene.with_changes(t_end=t_end, links=links)


def by_tsnet(file: Path, t_end: float, operation: str, *arguments: Any) -> Iterator[Run]:
    """Run TSNet with the step that it chooses."""
    with tempfile.TemporaryDirectory() as folder:
        call = [os.environ[PYTHON], "-W", "ignore", "-c", TSNET, folder, file, SPEED, t_end, operation]
        said = spent([*map(str, call), json.dumps(arguments)]).said
    yield Run("TSNet", *json.loads(said.splitlines()[-1]))


def by_rthym(file: Path, t_end: float) -> Iterator[Run]:
    """Run rthym-moc, its unsteady friction and vapour switched off, stubs of one reach beside valves and pumps."""
    import rthym_moc

    def run(dt: float) -> Heads:
        solver = rthym_moc.load_inp(str(file), stub_length_ft=4000 * dt)
        opened = 100 / sqrt(1.5)
        solver.set_valve_schedule("_VALVE_VALVE-179", [(0, opened), (1, opened), (2, 0), (t_end, 0)])
        heads = solver.run(total_time=t_end, dt=dt, p_vapor_psi=-1e9, usf_tau=dt, k_bru=0.0)["node_head"]
        return {name: FOOT * float(np.max(each)) for name, each in heads.items()}

    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        run(STEPS[0])
        for dt in STEPS:
            heads, seconds = timed(partial(run, dt), clock=processor_time)
            yield Run("rthym-moc", dt, seconds, heads)


def cases(folder: Path) -> Iterator[Case]:
    """All operations of networks in a folder."""
    one, two, three, four = (folder.resolve() / f"{name}.inp" for name in ("Tnet1", "Tnet2", "Tnet3", "TNET3"))
    yield Case(
        "Tnet1: a flow is stopped in 0.6 s",
        partial(with_falling_flow, one, 60),
        partial(by_tsnet, one, 60, "valve_closure", "VALVE", [0.6, 0, 0, 1]),
    )
    yield Case(
        "Tnet2: a pump stops in 1 s",
        partial(plainly, two, 10, "stop", "PUMP2@0s+1s"),
        partial(by_tsnet, two, 10, "pump_shut_off", "PUMP2", [1, 0, 0, 1]),
    )
    yield Case(
        "Tnet3: a burst of 87 L/s",
        partial(plainly, three, 20, "burst", "JUNCTION-20:86.77 L/s@1s+1s"),
        partial(by_tsnet, three, 20, "add_burst", "JUNCTION-20", 1, 1, 0.01),
    )
    yield Case("TNET3: a valve shuts in 1 s", partial(with_valve_of_rthym, four, 20), partial(by_rthym, four, 20))


def measured(case: Case) -> Iterator[tuple[str, ...]]:
    """Rows of a case: each run of another program, and the quickest of tline's that is no farther off."""

    def run(slab: float) -> Heads:
        solver = {"rounded": True, "order": 1, "slab": slab}
        seen = simulate(case.scene().with_changes(solver=solver), envelope=True, ledger=False).envelope
        assert seen is not None
        return dict(zip(seen.nodes, seen.highest / HEAD, strict=True))

    exact, own = run(FINEST), []

    def off(heads: Heads) -> float:
        return max(abs(heads[name] - exact[name]) for name in exact if name in heads)

    for slab in SLABS:
        heads, seconds = timed(partial(run, slab), clock=processor_time)
        own.append((seconds, slab, off(heads)))
    for other in case.others():
        limit = off(other.heads)
        seconds, slab, error = min(each for each in own if each[2] <= limit)
        cells = 1e3 * other.step, other.seconds, limit, 1e3 * slab, seconds, error, other.seconds / seconds
        yield case.title, other.program, *(f"{each:.3g}" for each in cells)


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    found = [row for case in cases(Path(sys.argv[1])) for row in measured(case)]
    head = "<operation|<program|step, ms|CPU, s|off, m|tline, slab, ms|CPU, s|off, m|times"
    write("docs/compared.md", table(head, found), "surges")
