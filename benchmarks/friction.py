"""Pictures of where methods fail on friction laws, and where that is predicted: python -m benchmarks.friction."""

from math import log10, nan

import numpy as np
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure

import friction
from benchmarks.harness import DOCS
from friction import (
    Coulomb,
    ElastoPlastic,
    Karnopp,
    LuGre,
    Ramp,
    Spring,
    Status,
    Table,
    Testbench,
    limits,
    lugre_drift,
    simulate,
)

STRIBECK_END = 13.963289889871819666  # m/s, after 10 s


def draw_maps() -> Figure:
    """Draw the error of explicit steps over (h, σ0) and (h, σ1), with the predicted borders."""
    figure = Figure(figsize=(12, 4.4), dpi=140, layout="constrained")
    colours = LinearSegmentedColormap.from_list("error", ["#0072B2", "#F7F7F7", "#D55E00"])
    colours.set_bad("#BBBBBB")
    steps, image = np.logspace(-4.0, -0.7, 41), None
    cases = [
        ("rk4", "sigma0", np.logspace(1.5, 4.5, 41), 6.0, "RK4, stick and slip, t = 6 s"),
        ("euler", "sigma1", np.logspace(-0.5, 3.0, 41), 2.0, "Euler, stick, t = 2 s"),
    ]
    for axes, (method, name, values, t, title) in zip(figure.subplots(1, 2), cases, strict=True):
        errors = np.full((steps.size, values.size), np.nan)
        border = []
        for k, value in enumerate(values):
            model = LuGre(**{name: float(value)})
            exact = simulate(model, Testbench(Ramp(0.5)), t, tol=1e-9, times=[t])
            inside = [getattr(limits(model, float(v)), method) for v in (0.0, exact.v[0])]
            border.append(min(inside))
            for j, h in enumerate(steps):
                run = simulate(model, Testbench(Ramp(0.5)), t, method, h=float(t / round(t / h)))
                if run.status is Status.DONE and abs(run.F_f[-1]) < 10.0:
                    errors[j, k] = log10(max(abs(run.F_f[-1] - exact.F_f[0]), 1e-12))
        image = axes.pcolormesh(values, steps, errors, cmap=colours, vmin=-8, vmax=0, shading="nearest")
        axes.loglog(values, border, "k-", linewidth=1.5, label="predicted limit")
        if name == "sigma0":
            axes.plot(500.0, 0.01, "o", color="black", markersize=7, markerfacecolor="white", label="the exercise")
        axes.set(
            xlabel={"sigma0": "σ0 [N/m]", "sigma1": "σ1 [N·s/m]"}[name], ylabel="step h [s]", ylim=(steps[0], steps[-1])
        )
        axes.set_title(f"{title}; grey: blown up")
        axes.legend(loc="lower left", fontsize=8)
    figure.colorbar(image, ax=figure.axes, label="log10 of the error of F_f [N]")
    return figure


def draw_failures(exact: float) -> Figure:
    figure = Figure(figsize=(12, 7.5), dpi=140, layout="constrained")
    (a, b, c), (d, e, f) = figure.subplots(2, 3)
    run = simulate(Coulomb(), Testbench(Ramp(0.5)), 3.0, "euler", h=0.01)
    a.plot(run.t, run.v, linewidth=0.6)
    for sign in (-1.0, 1.0):
        a.plot(run.t, np.where(run.t < 2.0, 0.01 * (run.F_a + sign), nan), "k--", linewidth=0.8)
    a.set(title="Euler on sign v, with predicted bounds", xlabel="t [s]", ylabel="v [m/s]", ylim=(-0.02, 0.05))
    tols = np.logspace(-1.5, -4.5, 7)
    b.loglog(
        tols, [simulate(Coulomb(), Testbench(Ramp(0.5)), 0.1, "rk45", tol=t, budget=50_000).steps for t in tols], "o-"
    )
    b.loglog(tols, 3e-1 / tols, "k--", linewidth=0.8, label="1/tolerance")
    b.set(title="RK45 on sign v: steps in 0.1 s", xlabel="tolerance", ylabel="steps")
    b.legend()
    for delta in (0.0002, 0.003, 0.006, 0.1):
        run = simulate(Karnopp(1.0, 1.0, 0.0, 0.1, delta), Testbench(Ramp(0.2), v0=-0.3172), 2.0, "euler", h=0.01)
        c.plot(run.t, run.v, linewidth=0.8, label=f"δ = {delta:g}")
    c.set(title="Dead zone of half width δ, h = 0.01 s", xlabel="t [s]", ylabel="v [m/s]", ylim=(-0.15, 0.05))
    c.legend()
    times = 8.0 * np.arange(13)
    force = Table(times, [0.3 if k % 2 == 0 else 0.9 for k in range(13)])
    for model in (LuGre(sigma1=10.0), ElastoPlastic(sigma1=10.0, z_ba=0.0019), Karnopp()):
        run = simulate(model, Testbench(force), times[-1])
        d.plot(run.t, 1e3 * run.x, label=model.name)
    told = 1e3 * lugre_drift(LuGre(), 0.3, 0.9)
    d.plot(times[::2], told * np.arange(7) + 1.2, "k--", linewidth=0.8, label="predicted slope")
    d.set(title="Drift under 0.3 to 0.9 N", xlabel="t [s]", ylabel="x [mm]")
    d.legend()
    steps = [10.0 / n for n in (157, 331, 627, 1259, 2511, 5003, 10_007, 50_021)]
    for method in ("rk4", "euler", "moreau"):
        e.loglog(
            steps,
            [abs(simulate(Karnopp(), Testbench(Ramp(0.5)), 10.0, method, h=h).v[-1] - exact) for h in steps],
            "o-",
            label=method,
        )
    e.loglog(steps, np.array(steps), "k--", linewidth=0.8, label="order 1")
    e.set(title="Through the Stribeck peak", xlabel="h [s]", ylabel="error of v(10 s) [m/s]")
    e.legend()
    bench, rig = Testbench(Ramp(0.0), spring=Spring(400.0, 0.05)), Karnopp(F_v=0.0, v_s=0.01)
    f.plot(*_xy(simulate(rig, bench, 1.5)), label="events")
    for h in (0.01, 0.1):
        f.plot(*_xy(simulate(rig, bench, 1.5, "moreau", h=h)), label=f"Moreau, h = {h:g} s")
    f.set_ylim(-0.02, 0.22)
    f.set(title=f"Stick–slip: π√(m/k) = {np.pi / 20:.2g} s", xlabel="t [s]", ylabel="v [m/s]")
    f.legend()
    return figure


def _xy(run: friction.Result) -> tuple[np.ndarray, np.ndarray]:
    return run.t, run.v


if __name__ == "__main__":
    for name, picture in (("limits", draw_maps()), ("failures", draw_failures(STRIBECK_END))):
        picture.savefig(DOCS / "pictures" / f"friction_{name}.png")
