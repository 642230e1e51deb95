"""Friction: time against true error, soft to rigid, beside other solvers: python -m benchmarks.stiffness.

Others get the same right-hand side, compiled, with sign v as it is, and estimate no error; runs of ours estimate
theirs, and are checked by the witness. What is not installed is left out (numbalsoda builds where gfortran is).
"""

from collections.abc import Callable, Iterator
from functools import partial
from math import copysign, exp, sin

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from benchmarks.harness import DOCS, table, timed, write
from friction import Karnopp, LuGre, Model, Ramp, Sine, Spring, Status, Testbench, simulate
from friction.pictures import COLOURS

TIMES = np.linspace(0.0, 10.0, 21)
BENCHES = {
    "ramp": Testbench(Ramp(0.5)), "sine": Testbench(Sine(2.0, 1.0)),
    "rig": Testbench(Ramp(0.0), spring=Spring(20.0, 0.05)),
}  # fmt: skip
CASES: list[tuple[str, str, Model]] = [
    (f"LuGre, σ0 = {s:g} N/m", kind, LuGre(sigma0=s)) for s in (50.0, 500.0, 1e4, 1e5) for kind in BENCHES
]
CASES += [("Stribeck, by events", "ramp", Karnopp())]
TARGETS = (1e-4, 1e-6, 1e-9)  # true errors
TOLS = 10.0 ** -np.arange(1.0, 12.0)
RUNS = 3
GREYS = ("#333333", "#666666", "#888888", "#AAAAAA")
Run = Callable[[float], NDArray]


def own(model: Model, bench: Testbench, method: str) -> Run:
    def run(tol: float) -> NDArray:
        asked = None if method == "events" else tol
        made = simulate(model, bench, TIMES[-1], method, tol=asked, times=TIMES)
        assert made.status is Status.DONE
        return np.column_stack([made.x, made.v, made.z])

    return run


def rates(t, y, dy, p):
    """Time derivatives of x, v, z; p: σ0 (0: rigid), slope, amplitude, angular frequency, stiffness, speed."""
    v, z = y[1], y[2]
    g, force = 1.0 + 0.2 * exp(-((v / 0.1) ** 2)), p[1] * t + p[2] * sin(p[3] * t) + p[4] * (p[5] * t - y[0])
    dy[0], dy[2] = v, v - p[0] * abs(v) * z / g
    dy[1] = force - p[0] * z - 0.05 * v
    if p[0] == 0.0:
        dy[1], dy[2] = force - copysign(g, v) - 0.05 * v, 0.0
        if v == 0.0 and abs(force) <= 1.2:
            dy[1] = 0.0


def numbalsoda_peers() -> Iterator[tuple[str, Callable]]:
    import numbalsoda
    from numba import cfunc

    address = cfunc(numbalsoda.lsoda_sig)(rates).address

    def run(solve: Callable, p: NDArray, tol: float) -> NDArray:
        found, succeeded = solve(address, np.zeros(3), TIMES, p, rtol=tol, atol=1e-3 * tol, mxstep=10_000_000)
        assert succeeded
        return found

    for name in ("lsoda", "dop853"):
        yield f"numbalsoda {name}", partial(run, getattr(numbalsoda, name))


def scipy_peers() -> Iterator[tuple[str, Callable]]:
    from numba import njit
    from scipy.integrate import solve_ivp

    compiled, dy = njit(rates), np.zeros(3)

    def run(p: NDArray, tol: float) -> NDArray:
        def rate(t: float, y: NDArray) -> NDArray:
            compiled(t, y, dy, p)
            return dy

        made = solve_ivp(rate, (0.0, TIMES[-1]), np.zeros(3), "LSODA", t_eval=TIMES, rtol=tol, atol=1e-3 * tol)
        assert made.success
        return made.y.T

    yield "SciPy LSODA", run


def sundials_peers() -> Iterator[tuple[str, Callable]]:
    from numba import njit
    from sksundae.cvode import CVODE

    compiled = njit(rates)

    def run(p: NDArray, tol: float) -> NDArray:
        def rate(t: float, y: NDArray, dy: NDArray) -> None:
            compiled(t, y, dy, p)

        made = CVODE(rate, method="BDF", rtol=tol, atol=1e-3 * tol, max_num_steps=1_000_000).solve(TIMES, np.zeros(3))
        assert made.success
        return made.y

    yield "CVODE BDF", run


def peers() -> dict[str, Callable]:
    found = dict[str, Callable]()
    for made in (numbalsoda_peers, sundials_peers, scipy_peers):
        try:
            found.update(made())
        except ImportError as error:
            print(f"left out: {error}")
    return found


def measured(run: Run, exact: NDArray) -> list[tuple[float, float]]:
    """True error, of each column's largest value, and milliseconds of processor time, at each tolerance."""
    rows, sizes = [], np.maximum(np.abs(exact).max(axis=0), 1e-300)
    for tol in TOLS:
        try:
            run(tol)
            found, seconds = timed(partial(run, tol), RUNS)
        except AssertionError:
            continue
        rows.append((float(np.max(np.abs(found - exact) / sizes)), 1e3 * seconds))
        if seconds > 0.3:
            break
    return rows


def main() -> None:
    others, rows = peers(), []
    figure = Figure(figsize=(12, 15), dpi=110, layout="constrained")
    grid = figure.subplots(5, 3)
    for axes in grid.flat[len(CASES) :]:
        axes.set_axis_off()
    for axes, (law, kind, model) in zip(grid.flat, CASES, strict=False):
        bench, drive = BENCHES[kind], BENCHES[kind].drive
        methods = ("taylor", "rosenbrock") if isinstance(model, LuGre) else ("events",)
        p = np.array([model.law.sigma0, drive.slope[0], drive.amplitude, drive.omega, drive.stiffness, drive.speed])
        exact, *more = (own(model, bench, method)(1e-10) for method in methods)
        apart = max((float(np.max(np.abs(exact - one) / np.abs(exact).max(axis=0))) for one in more), default=0.0)
        cost = {name: measured(own(model, bench, name), exact) for name in methods}
        cost |= {name: measured(partial(run, p), exact) for name, run in others.items()}
        for k, (name, points) in enumerate(cost.items()):
            errors, times = np.array(points or [(1.0, np.nan)]).T
            ours = k < len(methods)
            style = {"color": COLOURS[k]} if ours else {"color": GREYS[k - len(methods)], "linestyle": "--"}
            axes.loglog(np.clip(errors, 1e-12, 1.0), times, marker="o", label=name, markersize=3, **style)
        axes.set(title=f"{law}, {kind}", xlim=(1.0, 1e-12), xlabel="true error", ylabel="time [ms]")
        axes.grid(alpha=0.3)
        for target in TARGETS:
            least = {n: min((ms for e, ms in points if e <= target), default=np.nan) for n, points in cost.items()}
            best = min(methods, key=lambda name, least=least: np.nan_to_num(least[name], nan=np.inf))
            told = [least[name] for name in (best, *others)]
            told.append(np.nanmin([*told[1:], np.inf]) / told[0])
            cells = ["not reached" if not np.isfinite(ms) else f"{ms:.2f}" for ms in told]
            rows.append((law, kind, f"{target:.0e}", best, *cells))
        print(law, kind, f"references differ by {apart:.0e}", flush=True)
    figure.legend(*grid[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=len(others) + 2)
    figure.savefig(DOCS / "pictures" / "friction_stiffness.png")
    head = "<law|<motion|true error|<ours by|ours [ms]|" + "|".join(f"{name} [ms]" for name in others)
    write("benchmarks/pages/friction.md", table(f"{head}|best of the others over ours", rows), "stiffness")


if __name__ == "__main__":
    main()
