"""The exercise, answered: a box of 1 kg on a table, pushed by a ramp of 0.5 or 2 N/s for 10 s.

F_c = 1 N, F_s = 1.2 N, F_v = 0.05 N·s/m, v_s = 0.1 m/s.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from friction.models import Coulomb, Karnopp, LuGre, Model
from friction.predict import dead_zone, euler_chatter, limits
from friction.result import Kind, Result, Status
from friction.simulate import simulate
from friction.testbench import Ramp, Testbench

SLOPES = (0.5, 2.0)
H = 0.01  # s, the step of the exercise


class Panel(NamedTuple):
    """What of a part is drawn: a quantity of some runs within a window of time."""

    quantity: str
    labels: tuple[str, ...]
    window: tuple[float, float]


class Part(NamedTuple):
    """One part of the exercise: its answer in a paragraph, and the runs that show it."""

    title: str
    text: str
    runs: dict[str, Result]
    panels: tuple[Panel, ...]


def _ramp(
    model: Model, slope: float = 0.5, method: str | None = None, v0: float = 0.0, h: float | None = None
) -> Result:
    return simulate(model, Testbench(Ramp(slope), v0=v0), 10.0, method, h=h)


def _changes(run: Result) -> int:
    return sum(event.kind is Kind.REVERSAL for event in run.events)


def _ended(run: Result) -> str:
    if run.status is Status.DONE:
        return f"reaches 10 s after {run.steps:,} steps"
    if run.status is Status.BUDGET:
        return f"has spent its budget of {run.steps:,} steps at t = {run.t[-1]:.3g} s"
    return f"gives up at t = {run.t[-1]:.3g} s, after {run.steps:,} step{'s' * (run.steps != 1)}"


def part_a() -> Part:
    """The bare law, by solvers that know nothing of events."""
    law = Coulomb()
    variable, implicit = (
        simulate(law, Testbench(Ramp(0.5)), 10.0, method, tol=1e-6, times=np.linspace(0.0, 10.0, 100_001))
        for method in ("rk45", "bdf")
    )
    euler = {slope: _ramp(law, slope, "euler", h=H) for slope in SLOPES}
    expected = {slope: euler_chatter(1.0, slope, H) for slope in SLOPES}
    exact = {slope: (10.0 - 1.0 / slope) ** 2 * slope / 2.0 for slope in SLOPES}
    seen = {slope: _changes(run) for slope, run in euler.items()}
    text = (
        "The law jumps at v = 0, where the box should stand. A variable-step solver starts well, since the force is "
        "0, but with the first velocity friction jumps to the other side, the error estimate is h·F_c however small h "
        f"is, and the step is cut until that meets the tolerance: RK45 at 1e-6 {_ended(variable)}; BDF "
        f"{_ended(implicit)}. Steps grow like 1/tolerance, whatever the order. Euler with h = {H} s cannot stall; it "
        f"chatters: {seen[0.5]} changes of sign at 0.5 N/s (predicted F_c/(2·slope·h) = "
        f"{expected[0.5].sign_changes:.0f}) and {seen[2.0]} at 2 N/s ({expected[2.0].sign_changes:.0f}), drifting by "
        f"{expected[0.5].drift:.3g} m before it breaks away. It ends at v = {euler[0.5].v[-1]:.4f} and "
        f"{euler[2.0].v[-1]:.4f} m/s, where {exact[0.5]:g} and {exact[2.0]:g} are exact. (Where the exercise writes "
        "F_s in this law, it can only mean F_c: there is no other force in it.)"
    )
    runs = {f"Euler, {slope} N/s": run for slope, run in euler.items()}
    panels = (Panel("v", tuple(runs), (0.0, 0.6)), Panel("v", tuple(runs), (0.0, 10.0)))
    return Part("The bare Coulomb law", text, runs, panels)


def part_b() -> Part:
    """Stuck or sliding, with events."""
    runs = {f"{slope} N/s": _ramp(Coulomb(), slope) for slope in SLOPES}
    runs |= {f"{slope} N/s, v(0) = −1": _ramp(Coulomb(), slope, v0=-1.0) for slope in SLOPES}
    slow, fast = runs["0.5 N/s, v(0) = −1"], runs["2.0 N/s, v(0) = −1"]
    told = {label: ", ".join(f"{event.kind} at {event.t:.6g} s" for event in run.events) for label, run in runs.items()}
    text = (
        f"With two modes, stuck and sliding, and their changes located as events, nothing chatters: {told['0.5 N/s']} "
        f"and v(10) = {runs['0.5 N/s'].v[-1]:.12g} m/s; {told['2.0 N/s']} and v(10) = {runs['2.0 N/s'].v[-1]:.12g} "
        f"m/s; both are exact to rounding, in {runs['0.5 N/s'].steps} steps. Thrown backwards with 1 m/s, the box "
        f"shows at 0.5 N/s: {told['0.5 N/s, v(0) = −1']}, v(10) = {slow.v[-1]:.6g} m/s; at 2 N/s the force has passed "
        f"F_c before the box stops, and it turns without sticking: {told['2.0 N/s, v(0) = −1']}, v(10) = "
        f"{fast.v[-1]:.6g} m/s."
    )
    panels = (Panel("v", tuple(runs), (0.0, 3.0)), Panel("F_f", tuple(runs), (0.0, 3.0)))
    return Part("Karnopp with events", text, runs, panels)


def part_c() -> Part:
    """The dead zone."""
    zone = Karnopp(F_c=1.0, F_s=1.0, F_v=0.0, delta=0.5)
    runs = {"v(0) = 0": _ramp(zone), "v(0) = −1": _ramp(zone, v0=-1.0), "no zone, v(0) = −1": _ramp(Coulomb(), v0=-1.0)}
    runs["v(0) = −1, Euler"] = _ramp(zone, method="euler", v0=-1.0, h=H)
    thrown, euler = runs["v(0) = −1"], runs["v(0) = −1, Euler"]
    held = thrown.t[(thrown.mode == 0) & (thrown.t <= 2.0)]
    range_ = dead_zone(0.5, 1.0, H, F_a=0.5 * held[0])
    creep = float(np.interp(2.0, thrown.t, thrown.x) - np.interp(held[0], thrown.t, thrown.x))
    text = (
        "Within |v| <= δ = 0.5 m/s the friction force is set to the applied force, so v cannot change there. From "
        f"rest all is well: v(10) = {runs['v(0) = 0'].v[-1]:.6g} m/s. With v(0) = −1 the box does not stop: it freezes "
        f"at −δ from {held[0]:.3f} s until break-away and creeps by {creep:.3f} m, against {0.0:.0f} m for the law "
        f"itself; Euler freezes at {euler.v[np.searchsorted(euler.t, 1.5)]:.4f} m/s (predicted: "
        f"{range_.frozen_low:.3g} to {range_.frozen_high:.3g}). Friction then pushes along the motion: its work "
        "between these instants is "
        f"{np.interp(2.0, thrown.t, thrown.W_f) - np.interp(held[0], thrown.t, thrown.W_f):+.3f} J, so the zone "
        "creates energy. A narrow zone creeps less, but for 2δ < h(F_c + |F_a|)/m Euler may jump over it, and "
        "chatters again."
    )
    return Part(
        "Karnopp with a dead zone",
        text,
        runs,
        (Panel("v", tuple(runs), (0.0, 4.0)), Panel("x", tuple(runs), (0.0, 4.0))),
    )


def part_d() -> Part:
    """Stribeck against Coulomb."""
    runs = {"Coulomb": _ramp(Coulomb()), "Stribeck": _ramp(Karnopp())}
    law = runs["Stribeck"]
    text = (
        f"With F_s = 1.2 N the box holds until {law.events[0].t:.12g} s instead of {runs['Coulomb'].events[0].t:.12g} "
        "s; then friction falls within a few v_s from 1.2 to 1 N, the box jerks, and F_v·v slowly grows. At 10 s it "
        f"is at x = {law.x[-1]:.10g} m with v = {law.v[-1]:.10g} m/s and F_f = {law.F_f[-1]:.10g} N; with Coulomb's "
        f"law, x = {runs['Coulomb'].x[-1]:.6g} m and v = {runs['Coulomb'].v[-1]:.6g} m/s. On the falling part a "
        f"disturbance grows at up to {0.2 / 0.1 * np.sqrt(2.0 / np.e) - 0.05:.3g} per second: a break-away found late "
        "makes an error that grows, and RK4 loses its order there."
    )
    return Part(
        "Stribeck against Coulomb",
        text,
        runs,
        (Panel("v", tuple(runs), (1.5, 4.0)), Panel("F_f", tuple(runs), (0.0, 10.0))),
    )


def part_e() -> Part:
    """LuGre."""
    runs = {"Stribeck": _ramp(Karnopp())}
    runs |= {
        f"σ0 = {s0:g}, σ1 = {s1:g}": _ramp(LuGre(sigma0=s0, sigma1=s1))
        for s0, s1 in ((500.0, 0.0), (50.0, 0.0), (500.0, 20.0))
    }
    lugre = runs["σ0 = 500, σ1 = 0"]
    stiff = _ramp(LuGre(sigma0=1e5))
    blown = {m: simulate(LuGre(), Testbench(Ramp(0.5)), 10.0, m, h=H).t[-1] for m in ("euler", "rk4")}
    slip = limits(LuGre(), 8.0)
    text = (
        "g(v) = F_c + (F_s − F_c)·e^(−(v/v_s)²) and σ2 = F_v give LuGre the steady force of (d). At σ0 = 500 N/m it "
        f"ends at v = {lugre.v[-1]:.10g} m/s against {runs['Stribeck'].v[-1]:.10g}: it gives way by up to "
        f"F_s/σ0 = {1.2 / 500.0:g} m and creeps before 2.4 s, instead of holding. In stick, box and bristles are an "
        f"oscillator; the ramp excites a force of amplitude slope·√(m/σ0) = {0.5 * np.sqrt(1 / 500.0):.3g} N, smaller "
        "for stiffer bristles, and without σ1 only slip damps it, at a rate that does not depend on σ0; σ1 of the "
        f"order of 2√(m·σ0) = {2 * np.sqrt(500.0):.3g} removes it. What a solver adds to that wiggle is its own. In "
        "slip the bristle relaxes at σ0·|v|/g, so the equations grow stiffer as the box gets faster: at 8 m/s "
        f"explicit steps are limited to {slip.euler:.2g} s (Euler) and {slip.rk4:.2g} s (RK4), and with h = {H} s both "
        f"blow up, at t = {blown['euler']:.2f} and {blown['rk4']:.2f} s, whatever the exercise says of fixed steps. An "
        f"L-stable method does not care: {lugre.steps:,} steps at σ0 = 500, {stiff.steps:,} at 10⁵ N/m, v(10) = "
        f"{stiff.v[-1]:.10g} m/s."
    )
    return Part("LuGre", text, runs, (Panel("F_f", tuple(runs), (0.0, 3.0)), Panel("v", tuple(runs), (1.5, 4.0))))


PARTS: dict[str, Callable[[], Part]] = {"a": part_a, "b": part_b, "c": part_c, "d": part_d, "e": part_e}
