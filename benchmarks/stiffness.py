"""LuGre from soft to stiff: time against true error, compared with numbalsoda: python -m benchmarks.stiffness.

Peers get the same right-hand side, compiled, with sign v as it is, and estimate no error; runs of ours estimate theirs,
and are checked by the witness. numbalsoda is left out where it is not installed (it builds where gfortran is).
"""

import time
from collections.abc import Callable
from functools import partial

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from benchmarks.harness import DOCS, table, timed, write
from friction import LuGre, Ramp, Sine, Spring, Status, Testbench, simulate
from friction.pictures import COLOURS

TIMES = np.linspace(0.0, 10.0, 21)
STIFFNESS = (50.0, 500.0, 1e4, 1e5)
BENCHES = {
    "ramp": Testbench(Ramp(0.5)), "sine": Testbench(Sine(2.0, 1.0)),
    "rig": Testbench(Ramp(0.0), spring=Spring(20.0, 0.05)),
}  # fmt: skip
TARGETS = (1e-4, 1e-6, 1e-9)  # true errors
TOLS = 10.0 ** -np.arange(3.0, 12.0)
RUNS = 3
Run = Callable[[float], NDArray]


def own(model: LuGre, bench: Testbench, method: str) -> Run:
    def run(tol: float) -> NDArray:
        made = simulate(model, bench, TIMES[-1], method, tol=tol, times=TIMES)
        assert made.status is Status.DONE
        return np.column_stack([made.x, made.v, made.z])

    return run


def peers() -> dict[str, Callable[[LuGre, Testbench], Run]]:
    try:
        import numbalsoda
    except ImportError:
        print("numbalsoda is left out")
        return {}
    from math import exp, sin

    from numba import cfunc

    def lugre(t, y, dy, p):  # p: σ0, slope, amplitude, angular frequency, stiffness, speed
        v, z = y[1], y[2]
        rate = v - p[0] * abs(v) * z / (1.0 + 0.2 * exp(-((v / 0.1) ** 2)))
        dy[0], dy[2] = v, rate
        dy[1] = p[1] * t + p[2] * sin(p[3] * t) + p[4] * (p[5] * t - y[0]) - p[0] * z - 0.05 * v

    address = cfunc(numbalsoda.lsoda_sig)(lugre).address

    def made(solve: Callable, model: LuGre, bench: Testbench) -> Run:
        drive = bench.drive
        p = np.array([model.sigma0, drive.slope[0], drive.amplitude, drive.omega, drive.stiffness, drive.speed])

        def run(tol: float) -> NDArray:
            found, succeeded = solve(address, np.zeros(3), TIMES, p, rtol=tol, atol=1e-3 * tol, mxstep=10_000_000)
            assert succeeded
            return found

        return run

    return {f"numbalsoda {name}": partial(made, getattr(numbalsoda, name)) for name in ("lsoda", "dop853")}


def measured(run: Run, exact: NDArray) -> list[tuple[float, float]]:
    """True error, of each column's largest value, and milliseconds of processor time, at each tolerance."""
    rows, sizes = [], np.abs(exact).max(axis=0)
    run(TOLS[0])
    for tol in TOLS:
        try:
            found, seconds = timed(partial(run, tol), 1)
            if seconds < 0.05:
                found, seconds = timed(partial(run, tol), RUNS)
        except AssertionError:
            continue
        rows.append((float(np.max(np.abs(found - exact) / sizes)), 1e3 * seconds))
        if seconds > 1.0:
            break
    return rows


def main() -> None:
    others = peers()
    names = ["taylor", "rosenbrock", *others]
    figure = Figure(figsize=(12, 12), dpi=110, layout="constrained")
    grid, rows = figure.subplots(len(STIFFNESS), len(BENCHES)), []
    for line, sigma0 in zip(grid, STIFFNESS, strict=True):
        for axes, (kind, bench) in zip(line, BENCHES.items(), strict=True):
            model = LuGre(sigma0=sigma0)
            fine = [own(model, bench, method)(1e-10) for method in names[:2]]
            apart = float(np.max(np.abs(fine[0] - fine[1]) / np.abs(fine[0]).max(axis=0)))
            runs = {name: own(model, bench, name) for name in names[:2]}
            runs |= {name: make(model, bench) for name, make in others.items()}
            cost = {name: measured(run, fine[0]) for name, run in runs.items()}
            for k, (name, points) in enumerate(cost.items()):
                errors, times = np.array(points).T
                style = {"color": COLOURS[k]} if k < 2 else {"color": ("#555555", "#999999")[k - 2], "linestyle": "--"}
                axes.loglog(np.maximum(errors, 1e-12), times, marker="o", label=name, markersize=3, **style)
            axes.set(title=f"{kind}, σ0 = {sigma0:g} N/m", xlim=(1.0, 1e-12), xlabel="true error", ylabel="time [ms]")
            axes.grid(alpha=0.3)
            for target in TARGETS:
                least = {n: min((ms for e, ms in points if e <= target), default=np.nan) for n, points in cost.items()}
                best, peer = min(least[n] for n in names[:2]), min((least[n] for n in others), default=np.nan)
                told = *least.values(), peer / best
                cells = ["not reached" if np.isnan(ms) else f"{ms:.2f}" for ms in told]
                rows.append((f"{sigma0:g}", kind, f"{target:.0e}", *cells))
            print(sigma0, kind, f"references differ by {apart:.0e}", flush=True)
    figure.legend(*grid[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=len(names))
    figure.savefig(DOCS / "pictures" / "friction_stiffness.png")
    head = "σ0 [N/m]|<motion|true error|" + "|".join(f"{name} [ms]" for name in names) + "|best peer over best of ours"
    write("benchmarks/pages/friction.md", table(head, rows), "stiffness")


if __name__ == "__main__":
    began = time.process_time()
    main()
    print(f"{time.process_time() - began:.0f} s of processor time")
