"""Problem 1: a box of 1 kg on a table, pushed by a ramp of 0.5 or 2 N/s for 10 s."""

from typing import Any

import numpy as np

from friction import Coulomb, Karnopp, Kind, LuGre, Model, Ramp, Result, Status, Testbench, simulate
from friction.pictures import Panel
from friction.predict import dead_zone, euler_chatter, limits
from tline.exercises.answer import Found

SLOPES = (0.5, 2.0)  # N/s
H, T_END = 0.01, 10.0  # s
LOCATED, IN_A_ROW = 1e-13, 1000  # s, how well a crossing is located; crossings after which Simulink gives up
NARROW = 1e-5  # m/s, half width of a zone that Euler's method jumps over


def _ramp(
    model: Model, slope: float = 0.5, method: str | None = None, v0: float = 0.0, h: float | None = None
) -> Result:
    return simulate(model, Testbench(Ramp(slope), v0=v0), T_END, method, h=h)


def _found(numbers: dict[str, Any], runs: dict[str, Result], *panels: Panel) -> Found:
    return Found(
        numbers,
        draw=("draw_panels", runs, panels),
        details={"runs": {name: run.to_dict() for name, run in runs.items()}},
    )


def _changes(run: Result) -> int:
    return sum(event.kind is Kind.REVERSAL for event in run.events)


def _ended(run: Result) -> str:
    if run.status is Status.DONE:
        return f"reaches 10 s after {run.steps:,} steps"
    if run.status is Status.BUDGET:
        return f"has spent its budget of {run.steps:,} steps at t = {run.t[-1]:.3g} s"
    return f"gives up at t = {run.t[-1]:.3g} s, after {run.steps:,} step{'s' * (run.steps != 1)}"


def _told(run: Result) -> str:
    return ", ".join(f"{event.kind} at {event.t:.6g} s" for event in run.events)


def _sign_block(slope: float) -> tuple[float, float]:
    """Simulate a sign block with zero-crossing detection: time and largest |v| after `IN_A_ROW` crossings, s and m/s.

    Each crossing is overshot by its localisation error; from there friction leads back, v' = F_a ∓ F_c, to the next.
    """
    t, largest, side = LOCATED, 0.0, 1.0
    v = slope * t**2 / 2
    for _ in range(IN_A_ROW):
        t += abs(v) / (1.0 - side * slope * t) + LOCATED
        side = -side
        v = side * (1.0 + side * slope * t) * LOCATED
        largest = max(largest, abs(v))
    return t, largest


def bare_coulomb() -> Found:
    """Answer 1a: Coulomb's law, by solvers without events."""
    law = Coulomb()
    variable, implicit = (
        simulate(law, Testbench(Ramp(0.5)), T_END, method, tol=1e-6, times=np.linspace(0.0, T_END, 100_001))
        for method in ("rk45", "bdf")
    )
    slow, fast = (_ramp(law, slope, "euler", h=H) for slope in SLOPES)
    expected = [euler_chatter(1.0, slope, H) for slope in SLOPES]
    crossed, overshoot = _sign_block(0.5)
    numbers = {
        "located": LOCATED,
        "crossings": IN_A_ROW,
        "crossed": crossed,
        "overshoot": overshoot,
        "variable": _ended(variable),
        "implicit": _ended(implicit),
        "changes_slow": _changes(slow),
        "changes_fast": _changes(fast),
        "expected_slow": expected[0].sign_changes,
        "expected_fast": expected[1].sign_changes,
        "end_slow": slow.events[-1].t,
        "end_fast": fast.events[-1].t,
        "drift_slow": float(np.interp(1.0 / 0.5, slow.t, slow.x)),
        "drift_fast": float(np.interp(1.0 / 2.0, fast.t, fast.x)),
        "expected_drift": expected[0].drift,
        "v_slow": float(slow.v[-1]),
        "v_fast": float(fast.v[-1]),
        "exact_slow": (T_END - 1.0 / 0.5) ** 2 * 0.5 / 2.0,
        "exact_fast": (T_END - 1.0 / 2.0) ** 2 * 2.0 / 2.0,
    }
    runs = {"Euler, 0.5 N/s": slow, "Euler, 2 N/s": fast}
    return _found(numbers, runs, Panel("v", tuple(runs), (0.0, 0.6)), Panel("v", tuple(runs), (0.0, T_END)))


def karnopp() -> Found:
    """Answer 1b: sticking and sliding, with events."""
    runs = {f"{slope:g} N/s": _ramp(Coulomb(), slope) for slope in SLOPES}
    runs |= {f"{slope:g} N/s, v(0) = −1": _ramp(Coulomb(), slope, v0=-1.0) for slope in SLOPES}
    named = dict(zip(("slow", "fast", "slow_thrown", "fast_thrown"), runs.values(), strict=True))
    numbers = {name: _told(run) for name, run in named.items()}
    numbers |= {f"v_{name}": float(run.v[-1]) for name, run in named.items()} | {"steps": named["slow"].steps}
    return _found(numbers, runs, Panel("v", tuple(runs), (0.0, 3.0)), Panel("F_f", tuple(runs), (0.0, 3.0)))


def zone() -> Found:
    """Answer 1c: the dead zone in place of events, from rest and from −1 m/s."""
    wide, narrow = (Karnopp(F_c=1.0, F_s=1.0, F_v=0.0, delta=delta) for delta in (0.5, NARROW))
    rest, thrown = _ramp(wide), _ramp(wide, v0=-1.0)
    euler = _ramp(wide, method="euler", v0=-1.0, h=H)
    missed = _ramp(narrow, method="euler", v0=-1.0, h=H)
    held = thrown.t[(thrown.mode == 0) & (thrown.t <= 2.0)]
    frozen = dead_zone(0.5, 1.0, H, F_a=0.5 * held[0])

    def gained(column: np.ndarray) -> float:
        return float(np.interp(2.0, thrown.t, column) - np.interp(held[0], thrown.t, column))

    numbers = {
        "v_rest": float(rest.v[-1]),
        "held": float(held[0]),
        "creep": -gained(thrown.x),
        "work": gained(thrown.W_f),
        "frozen": float(euler.v[np.searchsorted(euler.t, 1.5)]),
        "low": frozen.frozen_low,
        "high": frozen.frozen_high,
        "narrow": NARROW,
        "chatter": int(np.count_nonzero(np.diff(np.sign(missed.v[missed.t < 2.0])))),
    }
    runs = {"v(0) = 0": rest, "v(0) = −1": thrown, "no zone, v(0) = −1": _ramp(Coulomb(), v0=-1.0)}
    runs["v(0) = −1, Euler"] = euler
    return _found(numbers, runs, Panel("v", tuple(runs), (0.0, 4.0)), Panel("x", tuple(runs), (0.0, 4.0)))


def stribeck() -> Found:
    """Answer 1d: Stribeck's curve compared with Coulomb's law."""
    law, coulomb = _ramp(Karnopp()), _ramp(Coulomb())
    numbers = {
        "t_break": law.events[0].t,
        "t_coulomb": coulomb.events[0].t,
        "x": float(law.x[-1]),
        "v": float(law.v[-1]),
        "F_f": float(law.F_f[-1]),
        "x_coulomb": float(coulomb.x[-1]),
        "v_coulomb": float(coulomb.v[-1]),
        "growth": 0.2 / 0.1 * np.sqrt(2.0 / np.e) - 0.05,
    }
    runs = {"Stribeck": law, "Coulomb": coulomb}
    return _found(numbers, runs, Panel("v", tuple(runs), (0.0, T_END)), Panel("F_f", tuple(runs), (0.0, T_END)))


def lugre() -> Found:
    """Answer 1e: LuGre compared with Stribeck's curve."""
    runs = {"Stribeck": _ramp(Karnopp())}
    runs |= {
        f"σ0 = {s0:g}, σ1 = {s1:g}": _ramp(LuGre(sigma0=s0, sigma1=s1))
        for s0, s1 in ((500.0, 0.0), (50.0, 0.0), (500.0, 20.0))
    }
    run, stiff = runs["σ0 = 500, σ1 = 0"], _ramp(LuGre(sigma0=1e5))
    blown = {m: float(simulate(LuGre(), Testbench(Ramp(0.5)), T_END, m, h=H).t[-1]) for m in ("euler", "rk4")}
    slip = limits(LuGre(), 8.0)
    z = float(np.interp(2.0, run.t, run.z))
    numbers = {
        "steady": abs(float(run.F_f[-1] - Karnopp().steady_force(run.v[-1]))),
        "v": float(run.v[-1]),
        "v_stribeck": float(runs["Stribeck"].v[-1]),
        "bend": 1.2 / 500.0,
        "wiggle": 0.5 * np.sqrt(1 / 500.0),
        "drift": float(np.interp(2.0, run.t, run.x)),
        "elastic": z,
        "longer": np.sqrt(500.0 / 50.0),
        "critical": 2 * np.sqrt(500.0),
        "limit_euler": slip.euler,
        "limit_rk4": slip.rk4,
        "blown_euler": blown["euler"],
        "blown_rk4": blown["rk4"],
        "steps": run.steps,
        "steps_stiff": stiff.steps,
        "v_stiff": float(stiff.v[-1]),
    }
    return _found(numbers, runs, Panel("v", tuple(runs), (1.5, 4.0)), Panel("F_f", tuple(runs), (0.0, 3.5)))


FOUND = {"1a": bare_coulomb, "1b": karnopp, "1c": zone, "1d": stribeck, "1e": lugre}
