"""Sweeps on several processes and on Dask, and side by side: python -m benchmarks.sweeps.

Prints a page and writes it to docs/benchmarks-sweeps.md. Processor seconds are given beside wall seconds, for other
work on the machine changes these and hardly those.
"""

import os
import resource
import signal
import threading
import time
import tracemalloc
import warnings
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks import side_by_side
from tline.scene.file import read_scene
from tline.scene.scene import Scene
from tline.solver.prepared import prepare
from tline.solver.simulate import UnresolvedWarning
from tline.sweeps import Sweep, sweep
from tline.sweeps.batches import Task, run_batch
from tline.sweeps.keep import kept_of

ROOT = Path(__file__).parent.parent
CLOSURES, ON_DASK, CHEAP, SIDE = 200, 40, 100_000, 6
ALONE = 2_000  # cheap runs without a sweep, to compare with


def network() -> Scene:
    """A grid of 24 pipes with friction, a reservoir at one corner, a pipe to a valve at the opposite one."""
    pipe = {"length": "480 m", "diameter": "200 mm", "wave_speed": "1200 m/s", "density": "1000 kg/m^3"}
    pipe |= {"friction": {"kind": "darcy", "factor": 0.02}}
    across = [([i, j], [i, j + 1]) for i in range(SIDE) for j in range(SIDE - 1)]
    pairs = [*across, *((a[::-1], b[::-1]) for a, b in across), ([SIDE - 1, SIDE - 1], "valve")]
    return Scene(
        medium="hydraulic",
        start="steady",
        t_end="8 s",
        solver={"tol": 1e-3},
        lines={f"{a} {b}": pipe | {"nodes": [str(a), str(b)]} for a, b in pairs},
        loads={
            "tank": {"at": "[0, 0]", "kind": "reservoir", "pressure": "6 bar"},
            "valve": {
                "at": "valve",
                "kind": "orifice",
                "kv": 100,
                "opening": {"shape": "ramp", "from": 1, "to": 0, "at": "0.4 s", "duration": "1 s"},
            },
        },
        probes={"valve": {"at": "valve"}},
    )


def closures(count: int, **where) -> Sweep:
    """Closures of its valve."""
    vary = {"loads.valve.opening.duration": "uniform(0.4 s, 4 s)", "loads.valve.kv": "uniform(50, 200)"}
    return sweep(network(), vary, sample=f"latin:{count}", **where)


def cheap(count: int, **where) -> Sweep:
    """Runs of less than a millisecond or two, for which a function is kept so that they are made one at a time."""
    one = read_scene(ROOT / "scenes" / "cable_rc.toml").with_changes(
        t_end="2 ns", solver={"order": 2, "slab": "0.5 ns"}
    )
    return sweep(one, {"lines.cable.z0": "uniform(40, 60)"}, sample=f"random:{count}", keep=last, **where)


def last(result) -> float:
    """Voltage at the end."""
    return result.probes["far"].u[-1]


def measured(run: Callable[[], Sweep]) -> tuple[Sweep, float, float, float]:
    """A sweep, its wall seconds, and processor seconds of this process and of those that it started."""
    begun, own, others = time.perf_counter(), time.process_time(), _children()
    found = run()
    wall, own = time.perf_counter() - begun, time.process_time() - own
    time.sleep(1.0)  # until processes that ended have told
    return found, wall, own, _children() - others


def _children() -> float:
    told = resource.getrusage(resource.RUSAGE_CHILDREN)
    return told.ru_utime + told.ru_stime


def same(one: Sweep, other: Sweep) -> bool:
    """Whether all that is kept is the same to the last bit."""
    return all(np.array_equal(one[name], other[name], equal_nan=True) for name in one.kept)


def on_dask(run: Callable[..., Sweep], processes: bool, kill: bool = False) -> Sweep:
    """A sweep on eight local workers, of which one is killed after three seconds if that is wanted."""
    from dask.distributed import Client

    with Client(processes=processes, n_workers=8, threads_per_worker=1, dashboard_address=":0") as client:
        if kill:
            pid = next(iter(client.run(os.getpid).values()))
            threading.Timer(3.0, os.kill, [pid, signal.SIGKILL]).start()
        return run(executor=client.get_executor())


def speedup() -> list[str]:
    closures(2, workers=1)  # compiles
    one, wall1, own1, _ = measured(lambda: closures(CLOSURES, workers=1))
    two, wall2, own2, others = measured(lambda: closures(CLOSURES, workers=2))
    rows = [
        "Closures of a valve in a network of 61 pipes with friction (tolerance 1e-3):",
        "",
        "| | closures | wall s | processor s, caller | workers | as one process, to the last bit |",
        "|---|---:|---:|---:|---:|---|",
        f"| one process | {CLOSURES} | {wall1:.1f} | {own1:.1f} | | |",
        f"| two processes | {CLOSURES} | {wall2:.1f} | {own2:.1f} | {others:.1f} | {same(one, two)} |",
    ]
    by_processor = 2 * own1 / (own2 + others)
    few = closures(ON_DASK, workers=1)
    for name, more in (
        ("eight Dask threads", {"processes": False}),
        ("eight Dask processes", {"processes": True}),
        ("eight Dask processes, one killed", {"processes": True, "kill": True}),
    ):
        found, wall, own, others = measured(lambda more=more: on_dask(partial(closures, ON_DASK), **more))
        rows.append(f"| {name} | {ON_DASK} | {wall:.1f} | {own:.1f} | {others:.1f} | {same(few, found)} |")
    return [
        *rows,
        "",
        f"Two processes are {wall1 / wall2:.2f} times as fast as one by wall time. By",
        f"processor time, start of the processes included, they are {by_processor:.2f} times as fast",
        "where each has a core of its own.",
        "",
    ]


def overhead() -> list[str]:
    cheap(10, workers=1)  # compiles
    found, _, own, _ = measured(lambda: cheap(CHEAP, workers=1))
    values = [{"lines.cable.z0": value} for value in found["lines.cable.z0"][:ALONE]]
    task = Task(prepare(found.scene), kept_of(found.scene, last), None, False, {})
    run_batch(task, values[:10])
    begun = time.process_time()
    for each in values:
        task.run(each)
    bare = (time.process_time() - begun) / ALONE
    pool, wall, mine, others = measured(lambda: cheap(CHEAP, workers=2))
    tracemalloc.start()
    sizes = []
    for count in (CHEAP // 100, CHEAP // 10):
        tracemalloc.reset_peak()
        before = tracemalloc.get_traced_memory()[0]
        held = cheap(count, workers=2)
        sizes.append((count, tracemalloc.get_traced_memory()[1] - before, sum(a.nbytes for a in held.kept.values())))
    tracemalloc.stop()
    told = ", ".join(f"{peak / 1e6:.2f} MB at most for {n:,} runs ({own / 1e6:.2f} MB kept)" for n, peak, own in sizes)
    return [
        f"{CHEAP:,} runs of {1e3 * bare:.2f} ms each (a cable of fixed order and slab): sweeping them in one process",
        f"takes {own:.0f} s of processor time, {100 * (own / (CHEAP * bare) - 1):.1f} % more than the runs alone. On",
        f"two the caller takes {mine:.1f} s, {100 * mine / (mine + others):.1f} % of {mine + others:.0f} s in all "
        f"({wall:.0f} s of wall time); the same to the last bit: {same(found, pool)}.",
        f"Memory of the caller: {told}.",
        "",
    ]


def main() -> None:
    warnings.simplefilter("ignore", UnresolvedWarning)
    load, cores = os.getloadavg()[0], os.cpu_count()
    head = f"Written by `python -m benchmarks.sweeps` on {cores} cores, with a load of {load:.0f} as it began; where"
    head += "\nother work loads them, wall times are longer than they would be."
    parts = ["# Benchmarks of sweeps", "", head, "", "## On several processes", "", *speedup()]
    parts += ["## Overhead", "", *overhead(), "## Side by side", "", *side_by_side.report()]
    text = "\n".join(parts)
    print(text)
    (ROOT / "docs" / "benchmarks-sweeps.md").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
