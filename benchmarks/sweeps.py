"""Sweeps on several processes and on Dask, and side by side: ``python -m benchmarks.sweeps``.

Writes the tables of benchmarks/pages/sweeps.md. Processor seconds are given with wall seconds, as other work on the
machine changes the latter and hardly the former.
"""

import os
import resource
import time
import warnings
from collections.abc import Callable
from functools import partial
from statistics import median

import numpy as np

from benchmarks.harness import RUNS, table, timed, write
from tline import examples
from tline.scene.scene import Scene
from tline.solver.simulate import UnresolvedWarning, simulate
from tline.study.charts.scenes import chart_scene
from tline.study.programs import ngspice
from tline.study.reference import Solution
from tline.sweeps import Sweep, sweep

PAGE = "benchmarks/pages/sweeps.md"
CLOSURES, ON_DASK, SIDE = 200, 40, 6
COPIES, ALONE, JUDGED, INSTANTS, STEPS = 10_000, 20, 10, 40, 20  # steps of ngspice in a delay: what is exported asks
TOLERANCES = (1e-4, 1e-6, 1e-8)
LAWS = {
    ("valve_closure", "loads.valve.kv"): 200.0,
    ("valve_closure", "loads.valve.opening.duration"): 1.5,
    ("diode_clamp", "links.clamp.saturation"): 1e-12,
}
WITH_LAWS = 1_000  # runs of each


def network() -> Scene:
    """Grid of 24 pipes with friction, a reservoir at one corner, a pipe to a valve at the opposite one."""
    pipe = {"length": "480 m", "diameter": "200 mm", "wave_speed": "1200 m/s", "density": "1000 kg/m^3"}
    pipe |= {"friction": {"kind": "darcy", "factor": 0.02}}
    across = [([i, j], [i, j + 1]) for i in range(SIDE) for j in range(SIDE - 1)]
    pairs = [*across, *((a[::-1], b[::-1]) for a, b in across), ([SIDE - 1, SIDE - 1], "valve")]
    shut = {"shape": "ramp", "from": 1, "to": 0, "at": "0.4 s", "duration": "1 s"}
    return Scene(
        medium="hydraulic",
        start="steady",
        t_end="8 s",
        solver={"tol": 1e-3},
        lines={f"{a} {b}": pipe | {"nodes": [str(a), str(b)]} for a, b in pairs},
        loads={
            "tank": {"at": "[0, 0]", "kind": "reservoir", "pressure": "6 bar"},
            "valve": {"at": "valve", "kind": "orifice", "kv": 100, "opening": shut},
        },
        probes={"valve": {"at": "valve"}},
    )


def closures(count: int, **where) -> Sweep:
    """Sweep over closures of the network's valve."""
    vary = {"loads.valve.opening.duration": "uniform(0.4 s, 4 s)", "loads.valve.kv": "uniform(50, 200)"}
    return sweep(network(), vary, sample=f"latin:{count}", **where)


def measured(run: Callable[[], Sweep]) -> tuple[Sweep, float, float, float]:
    """Run a sweep; return its wall seconds, and processor seconds of this process and of those that it started."""
    begun, own, others = time.perf_counter(), time.process_time(), _children()
    found = run()
    wall, own = time.perf_counter() - begun, time.process_time() - own
    time.sleep(1.0)  # until ended processes have reported
    return found, wall, own, _children() - others


def _children() -> float:
    told = resource.getrusage(resource.RUSAGE_CHILDREN)
    return told.ru_utime + told.ru_stime


def same(one: Sweep, other: Sweep) -> bool:
    """Whether all kept results are equal to the last bit."""
    return all(np.array_equal(one[name], other[name], equal_nan=True) for name in one.kept)


def on_dask(processes: bool) -> Sweep:
    """Sweep closures on eight local workers."""
    from dask.distributed import Client

    with Client(processes=processes, n_workers=8, threads_per_worker=1, dashboard_address=":0") as client:
        return closures(ON_DASK, executor=client.get_executor())


def on_processes() -> str:
    """Measure closures on one process, on two, and on Dask's threads and processes."""
    closures(2, workers=1)  # compiles
    rows, alone = [], {CLOSURES: closures(CLOSURES, workers=1), ON_DASK: closures(ON_DASK, workers=1)}
    for name, count, run in (
        ("one process", CLOSURES, partial(closures, CLOSURES, workers=1)),
        ("two processes", CLOSURES, partial(closures, CLOSURES, workers=2)),
        ("eight Dask threads", ON_DASK, partial(on_dask, False)),
        ("eight Dask processes", ON_DASK, partial(on_dask, True)),
    ):
        found, wall, own, others = measured(run)
        rows.append((name, count, f"{wall:.1f}", f"{own:.1f}", f"{others:.1f}", same(alone[count], found)))
    return table("<|closures|wall s|processor s, caller|workers|<as one process, to the last bit", rows)


def side_by_side() -> str:
    """Measure runs side by side against one at a time and against ngspice, all values within 10 % of the chart's."""
    scene, rng, rows = chart_scene("rc").scene, np.random.default_rng(0), []
    nominal = {"lines.line.z0": 50.0, "lines.line.delay": 1e-9, "loads.load.resistance": 100.0}
    nominal["loads.load.capacitance"] = 4e-12
    vary = {where: value * rng.uniform(0.9, 1.1, COPIES) for where, value in nominal.items()}
    times = np.linspace(0.0, scene.t_end, INSTANTS)
    alone = [scene.change({where: values[k] for where, values in vary.items()}) for k in range(ALONE)]
    truth = np.array([Solution(one, "far").at(times.tolist()).efforts for one in alone[:JUDGED]])
    simulate(alone[0], tol=1e-6)
    single = median(timed(lambda one=one: simulate(one, tol=1e-6), 1, time.perf_counter)[1] for one in alone)
    peer = None
    if ngspice.incompatibility(scene) is None:
        peer = median(ngspice.run(one, STEPS).seconds for one in alone)
    for tol in TOLERANCES:
        seen = sweep(scene, vary, sample="list", keep=times, tol=tol)
        error = np.abs(seen["u"][:JUDGED, 0] - truth).max()
        run = partial(sweep, scene, vary, sample="list", tol=tol)
        core, wall = (timed(run, RUNS, clock)[1] / COPIES for clock in (time.process_time, time.perf_counter))
        ratios = [f"{seconds / wall:,.0f}" if seconds else "–" for seconds in (single, peer)]
        rows.append((f"{tol:.0e}", f"{seen['estimate'].max():.0e}", f"{error:.0e}", f"{1 / core:,.0f}", *ratios))
    return table("tolerance|estimate|error|runs/s|faster than `simulate`|than ngspice", rows)


def with_laws() -> str:
    """Measure sweeps of valves and diodes, whose runs are made one at a time."""
    rows, factors = [], np.random.default_rng(0).uniform(0.9, 1.1, WITH_LAWS)
    for (name, path), nominal in LAWS.items():
        run = partial(sweep, examples[name], {path: nominal * factors}, sample="list", tol=1e-6, workers=1)
        told, seconds = run()["estimate"].max(), timed(run, RUNS, time.process_time)[1]
        rows.append((f"`{name}`", f"`{path}`", f"{told:.0e}", f"{WITH_LAWS / seconds:,.0f}"))
    return table("<scene|<number|largest estimate|runs/s", rows)


if __name__ == "__main__":
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    warnings.simplefilter("ignore", UnresolvedWarning)
    write(PAGE, on_processes(), "processes")
    write(PAGE, side_by_side(), "side by side")
    write(PAGE, with_laws(), "with laws")
