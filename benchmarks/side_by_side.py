"""Runs side by side against one run at a time and against ngspice; `benchmarks.sweeps` prints the table.

Every figure is a median; every claim is a ratio measured in the same run.
"""

import time
from statistics import median

import numpy as np

from tline.scene.scene import Scene
from tline.solver.simulate import simulate
from tline.study.programs import ngspice
from tline.study.reference import Solution
from tline.sweeps import sweep

COPIES, RUNS, ALONE, NETLISTS, JUDGED, INSTANTS = 10_000, 5, 20, 20, 10, 40
TOLERANCES = (1e-4, 1e-6, 1e-8)
STEPS = 20  # of ngspice in a delay: what an exported netlist asks for


def scene(z0: float = 50.0, delay: float = 1e-9, resistance: float = 100.0, capacitance: float = 4e-12) -> Scene:
    """Twenty transits of 50 ohm and 1 ns, a ramp behind 25 ohm, and a receiver."""
    return Scene(
        medium="electrical",
        t_end=20e-9,
        lines={"cable": {"nodes": ["near", "far"], "z0": float(z0), "delay": float(delay)}},
        sources={
            "driver": {
                "at": "near",
                "kind": "voltage",
                "resistance": 25.0,
                "value": {"shape": "ramp", "to": 1.0, "duration": 1e-10},
            }
        },
        loads={
            "end": {"at": "far", "kind": "parallel", "resistance": float(resistance), "capacitance": float(capacitance)}
        },
        probes={"far": {"at": "far"}},
    )


def numbers() -> dict[str, np.ndarray]:
    """All within 10 % of the nominal ones."""
    rng = np.random.default_rng(0)
    nominal = {
        "lines.cable.z0": 50.0,
        "lines.cable.delay": 1e-9,
        "loads.end.resistance": 100.0,
        "loads.end.capacitance": 4e-12,
    }
    return {where: value * rng.uniform(0.9, 1.1, COPIES) for where, value in nominal.items()}


def alone_in(one: Scene) -> float:
    """Seconds of one run."""
    started = time.perf_counter()
    simulate(one, tol=1e-6)
    return time.perf_counter() - started


def report() -> list[str]:
    vary = numbers()
    times = np.linspace(0.0, 20e-9, INSTANTS)
    alone = [scene(*(values[k] for values in vary.values())) for k in range(ALONE)]
    exact = [Solution(one, "far") for one in alone[:JUDGED]]
    truth = np.array([solution.at(times.tolist()).efforts for solution in exact])
    simulate(alone[0], tol=1e-6)
    single = median(alone_in(one) for one in alone)
    spice = [ngspice.run(one, STEPS) for one in alone[:NETLISTS]]
    wall, transient = (median(getattr(run, key) for run in spice) for key in ("first", "seconds"))
    wrong = max(
        np.abs(solution.at(run.t[run.t > 0].tolist()).efforts - run.u["far"][run.t > 0]).max()
        for run, solution in zip(spice, exact, strict=False)
    )
    rows = [
        f"{COPIES:,} runs of twenty transits of a cable (50 Ω, 1 ns, a ramp of 0.1 ns behind 25 Ω, 100 Ω with 4 pF",
        "at its end; z0, delay, R and C each within 10 %), lowest and highest voltage of each. Medians of",
        f"{RUNS} calls without compiling. *Runs/s* are per second of one core's time, of whole calls with the choice",
        "of order and slabs on a sample. Errors are against exact solutions at any instants, relative to the step.",
        "The last three columns are ratios of wall times, of a whole call's share for a run.",
        "",
        "| tolerance | estimate | error | runs/s | faster than `simulate` | than ngspice | than its transient figure |",
        "|---:|---:|---:|---:|---:|---:|---:|",
    ]
    for tol in TOLERANCES:
        seen = sweep(scene(), vary, sample="list", keep=times, tol=tol)
        error = np.abs(seen["u"][:JUDGED, 0] - truth).max()
        walls, cores = zip(*(taken(vary, tol) for _ in range(RUNS)), strict=True)
        core, share = median(cores) / COPIES, median(walls) / COPIES
        ratios = " | ".join(f"{seconds / share:,.0f}" for seconds in (single, wall, transient))
        rows.append(f"| {tol:.0e} | {seen['estimate'].max():.0e} | {error:.0e} | {1 / core:,.0f} | {ratios} |")
    return [
        *rows,
        "",
        f"One `simulate(scene, tol=1e-6)` takes {single * 1e3:.1f} ms.",
        f"One ngspice process takes {wall * 1e3:.0f} ms, its figure for the transient analysis",
        f"(it counts milliseconds) is {transient * 1e3:.1f} ms; its largest error is {wrong:.0e}, with the",
        f"{STEPS} steps in a delay that an exported netlist asks for.",
        "",
    ]


def taken(vary: dict[str, np.ndarray], tol: float) -> tuple[float, float]:
    """Wall and processor seconds of a sweep."""
    wall, processor = time.perf_counter(), time.process_time()
    sweep(scene(), vary, sample="list", tol=tol)
    return time.perf_counter() - wall, time.process_time() - processor
