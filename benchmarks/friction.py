"""Friction: cost against error, failures predicted and measured, into docs/: python -m benchmarks.friction.

Every peer runs in its own process, gets its right-hand side compiled where it can take one, and is timed after a
warm-up; errors are against references in 50 digits (tests/truth/friction_cases.json). Figures are medians of 5 runs.
"""

import json
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from math import exp, nan

import numpy as np
from matplotlib.figure import Figure

import friction
from benchmarks.friction_failures import draw_failures, draw_maps, failure_rows
from benchmarks.harness import DOCS, RUNS, apart, table, timed, write
from friction import Karnopp, LuGre, Ramp, Status, Testbench, simulate
from friction.pictures import COLOURS

END, ENDS = 10.0, {"stribeck": 13.963289889871819666, "lugre": 13.985389460013207159}
TOLS = [10.0**-k for k in range(3, 13)]
GREYS = ("#555555", "#777777", "#999999", "#AAAAAA", "#666666", "#888888", "#BBBBBB")


def lugre_rates(t: float, y: list[float]) -> list[float]:
    v, z = y[1], y[2]
    rate = v - 500.0 * abs(v) * z / (1.0 + 0.2 * exp(-((v / 0.1) ** 2)))
    return [v, 0.5 * t - 500.0 * z - 0.05 * v, rate]


def stribeck_rates(t: float, y: list[float]) -> list[float]:
    v = y[1]
    if v == 0.0 and 0.5 * t <= 1.2:
        return [0.0, 0.0, 0.0]
    return [v, 0.5 * t - (1.0 + 0.2 * exp(-((v / 0.1) ** 2))) - 0.05 * v, 0.0]


RATES = {"lugre": lugre_rates, "stribeck": stribeck_rates}


def scipy_peer(case: str, solver: str) -> Callable[[float], float]:
    from numba import njit
    from scipy.integrate import solve_ivp

    compiled = njit(RATES[case])

    def rates(t: float, y: np.ndarray) -> tuple[float, ...]:
        return compiled(t, y)

    return lambda tol: float(solve_ivp(rates, (0.0, END), [0.0] * 3, solver, rtol=tol, atol=1e-3 * tol).y[1, -1])


def sundae_peer(case: str, solver: str) -> Callable[[float], float]:
    from numba import njit
    from sksundae.cvode import CVODE

    compiled = njit(RATES[case])

    def rates(t: float, y: np.ndarray, out: np.ndarray) -> None:
        out[:] = compiled(t, y)

    def run(tol: float) -> float:
        method = CVODE(rates, method=solver, rtol=tol, atol=1e-3 * tol, max_num_steps=1_000_000)
        return float(method.solve(np.array([0.0, END]), np.zeros(3)).y[-1, 1])

    return run


def own(case: str, method: str) -> Callable[[float], float]:
    model, bench = {"lugre": LuGre(), "stribeck": Karnopp()}[case], Testbench(Ramp(0.5))
    kind = friction.METHODS[method].step

    def run(knob: float) -> float:
        options = {"h": knob} if kind == "fixed" else {"times": [END]} | ({"tol": knob} if kind == "adaptive" else {})
        result = simulate(model, bench, END, method, **options)
        return float(result.v[-1]) if result.status is Status.DONE else nan

    return run


MAKERS = {"scipy": scipy_peer, "scikit-sundae": sundae_peer, "tline": own}
SOLVERS = {
    "lugre": [("scipy", m) for m in ("LSODA", "BDF", "Radau")] + [("scikit-sundae", "BDF")],
    "stribeck": [("scipy", m) for m in ("LSODA", "DOP853", "RK45", "BDF")]
    + [("scikit-sundae", m) for m in ("Adams", "BDF")],
}
OURS = {"lugre": ("rosenbrock", "exponential", "rk4"), "stribeck": ("events", "moreau", "rk4", "rk45-events")}


def knobs(who: str, solver: str) -> list[float]:
    if who != "tline":
        return TOLS
    step = friction.METHODS[solver].step
    return {"fixed": [END / n for n in (503, 5003, 50021, 200_003)], "adaptive": TOLS, "events": [0.0]}[step]


def worker(case: str, who: str, solver: str) -> None:
    """One solver in this process: rows of (knob, ms, error)."""
    run = MAKERS[who](case, solver)
    _, first = timed(lambda: run(knobs(who, solver)[0]), 1, time.perf_counter)
    rows = []
    for knob in knobs(who, solver):
        call = partial(_or_nan, run, knob)
        v, seconds = timed(call, 1, time.perf_counter)
        if seconds < 0.3:
            v, seconds = timed(call, RUNS, time.perf_counter)
        rows.append((knob, 1e3 * seconds, abs(v - ENDS[case])))
    print(json.dumps({"rows": rows, "first": first}))


def _or_nan(run: Callable[[float], float], knob: float) -> float:
    try:
        return run(knob)
    except Exception:  # noqa: BLE001 (a failure is drawn as one)
        return nan


def measured(case: str) -> dict[tuple[str, str], dict]:
    found = {}
    for who, solver in [("tline", m) for m in OURS[case]] + SOLVERS[case]:
        try:
            found[who, solver] = apart("benchmarks.friction", case, who, solver, limit=200)
        except subprocess.CalledProcessError:  # not installed
            print(case, who, solver, "is left out")
    return found


def cost_at(rows: list, error: float) -> float:
    """Least time of those that are as good; NaN if none is."""
    good = [ms for _, ms, got in rows if got <= error]
    return min(good, default=nan)


def cost_table(found: dict) -> str:
    rows, best = [], {e: {True: nan, False: nan} for e in (1e-6, 1e-9)}
    for (who, solver), told in found.items():
        cells = []
        for e in best:
            ms = cost_at(told["rows"], e)
            best[e][who == "tline"] = np.fmin(best[e][who == "tline"], ms)
            cells.append("not reached" if np.isnan(ms) else f"{ms:.3g}")
        rows.append((f"{who} {solver}", *cells, f"{told['first']:.2g}"))
    ratios = " and ".join(f"{best[e][False] / best[e][True]:.1f} at {e:.0e}" for e in best)
    said = f"Best peer over best of ours: {ratios}."
    return table("<solver|ms at 1e-6|ms at 1e-9|first call [s]", rows) + "\n\n" + said


def draw_cost(all_found: dict[str, dict]) -> Figure:
    figure = Figure(figsize=(12, 5), dpi=140, layout="constrained")
    for axes, (case, found) in zip(figure.subplots(1, 2), all_found.items(), strict=True):
        floor, colours, greys = 1e-16, iter(COLOURS), iter(GREYS)
        for (who, solver), told in found.items():
            ours = who == "tline"
            colour = next(colours) if ours else next(greys)
            errors = [min(max(e, floor), 1.0) if e == e else 1.0 for _, _, e in told["rows"]]
            times = [ms for _, ms, _ in told["rows"]]
            axes.loglog(
                errors, times, "o-" if ours else "s--", color=colour, markersize=4, linewidth=1.6 if ours else 1.0
            )
            axes.annotate(
                solver if ours else f"{who} {solver}", (errors[-1], times[-1]), (-4, 4), textcoords="offset points",
                color=colour, fontsize=8, ha="right",
            )  # fmt: skip
        axes.set(
            xlabel="error of v at 10 s [m/s]; at the left border: 1 or more, or failed", ylabel="time of one run [ms]"
        )
        axes.set_title({"lugre": "LuGre, σ0 = 500 N/m", "stribeck": "Stribeck"}[case])
        axes.set_xlim(2.0, 1e-19)
        axes.grid(alpha=0.3)
    return figure


def main() -> None:
    page, costs = "benchmarks/pages/friction.md", {case: measured(case) for case in ENDS}
    pictures = {"cost": draw_cost(costs), "limits": draw_maps(), "failures": draw_failures(ENDS["stribeck"])}
    for name, picture in pictures.items():
        picture.savefig(DOCS / "pictures" / f"friction_{name}.png")
    for case, found in costs.items():
        write(page, cost_table(found), case)
    rows = []
    for what, predicted, got in failure_rows():
        off = f"{100 * abs(got / predicted - 1.0):.2f} %" if predicted else "exact 0" if got == 0.0 else f"{got:.1g}"
        rows.append((what, f"{predicted:.6g}", f"{got:.6g}", off))
    write(page, table("<failure|predicted|measured|off by", rows), "failures")


if __name__ == "__main__":
    worker(*sys.argv[1:]) if len(sys.argv) == 4 else main()
