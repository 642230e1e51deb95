"""Errors that runs of bristle laws tell, against true ones.

LuGre, Dahl and elasto-plastic contacts, v_s from 1e-3 to 100 m/s, 0.01 to 1000 kg, loads of 0.1 to 90 % of F_c,
tolerances from 1e-1 to 1e-9; the reference is `friction_series`. A true error is the largest difference between 0
and the end relative to the largest magnitude of that column.
"""

import numpy as np
from friction_series import COLUMNS, reference
from numpy.typing import NDArray

import friction
from friction import LuGre, Model, Ramp, Result, Sine, Spring, Status, Steps, Table, Testbench, simulate

SEED, SAMPLES = 31, 400
FORCES = ("ramp", "held", "sine", "steps", "noise", "rig")


def power(rng: np.random.Generator, low: float, high: float) -> float:
    """10 to a random power."""
    return float(10.0 ** rng.uniform(low, high))


def random_case(rng: np.random.Generator, force: str) -> tuple[Model, Testbench, float, float]:
    """A model, a testbench, the end, and a tolerance."""
    F_c, v_s, mass = power(rng, -1, 2), power(rng, -3, 2), power(rng, -2, 3)
    F_s, s0 = F_c * rng.uniform(1.0, 1.6), F_c * power(rng, 2, 6)
    critical = (s0 * mass) ** 0.5
    s1, s2 = critical * float(rng.choice([0.0, power(rng, -2, 0.5)])), F_c * float(rng.choice([0.0, power(rng, -2, 0)]))
    model = (
        LuGre(F_c, F_s, v_s, s0, s1, s2),
        friction.Dahl(F_c, s0),
        friction.ElastoPlastic(F_c, F_s, v_s, s0, s1, s2, rng.uniform(0.2, 0.95) * F_c / s0),
    )[rng.integers(3)]
    rate = (s0 / mass) ** 0.5
    damped = getattr(model, "sigma1", 0.0) > 0.0
    end = min(power(rng, -1, 1.5), (1e5 if damped else 1e3) / rate)
    load = F_c * power(rng, -3, np.log10(0.9))
    v0 = float(rng.choice([0.0, 0.0, rng.uniform(-1.0, 1.0) * load / critical]))
    n = int(power(rng, 0.5, 2.0))
    times, noise = np.linspace(0.0, end, n + 1)[:-1], rng.uniform(-load, load, n)
    bench = {
        "ramp": lambda: Testbench(Ramp(load / end), mass, v0),
        "held": lambda: Testbench(Ramp(0.0, load), mass, v0),
        "sine": lambda: Testbench(Sine(load, rate * power(rng, -3, 0.3)), mass, v0),
        "steps": lambda: Testbench(Steps(times.tolist(), noise.tolist()), mass, v0),
        "noise": lambda: Testbench(Table(times.tolist(), noise.tolist()), mass, v0),
        "rig": lambda: Testbench(Ramp(0.0), mass, v0, Spring(k := s0 * power(rng, -3, 0), load / end / k)),
    }[force]()
    return model, bench, end, power(rng, -9, -1)


def true_errors(run: Result, exact: NDArray) -> dict[str, float]:
    """Largest difference of each column over its largest magnitude."""
    got = np.column_stack([getattr(run, name) for name in COLUMNS])
    sizes = np.maximum(np.abs(exact).max(axis=0), np.finfo(float).tiny)
    return dict(zip(COLUMNS, (np.abs(got - exact).max(axis=0) / sizes).tolist(), strict=True))


def judge(n: int, seed: int = SEED) -> tuple[Result, float, float]:
    """Run n: its result, the largest true error of a column over the tolerance, and over what is told of that column.

    Both are NaN if the run does not say that it is done. A sine of a large angle is rounded, which is no fault of runs.
    """
    model, bench, end, tol = random_case(np.random.default_rng((seed, n)), FORCES[n % len(FORCES)])
    times = np.unique(np.r_[np.linspace(0.0, end, SAMPLES), np.geomspace(1e-4, 1.0, SAMPLES) * end])
    run = simulate(model, bench, end, tol=tol, times=times)
    if run.status is not Status.DONE:
        return run, np.nan, np.nan
    true, floor = true_errors(run, reference(model, bench, run.t)), 1e-12 + 1e-15 * bench.force.sine[1] * end
    return run, max(true.values()) / tol, max(true[name] / (run.errors[name] + floor) for name in COLUMNS)
