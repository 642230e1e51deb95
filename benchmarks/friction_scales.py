"""Errors that runs of bristle laws tell, against true ones: python -m benchmarks.friction_scales [runs].

LuGre, Dahl and elasto-plastic contacts, v_s from 1e-3 to 100 m/s, 0.01 to 1000 kg, loads of 0.1 to 90 % of F_c,
tolerances from 1e-1 to 1e-9; the reference is `benchmarks.friction_series`. A true error is the largest difference
between 0 and the end relative to the largest magnitude of that column. Writes docs/friction-scales.md.
"""

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.friction_series import COLUMNS, reference
from friction import (
    Dahl,
    ElastoPlastic,
    LuGre,
    Model,
    Ramp,
    Result,
    Sine,
    Spring,
    Status,
    Steps,
    Table,
    Testbench,
    simulate,
)  # fmt: skip

SEED, RUNS, SAMPLES = 31, 600, 400
FORCES = ("ramp", "held", "sine", "steps", "noise", "rig")
PAGE = Path(__file__).parent.parent / "docs" / "friction-scales.md"


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
        Dahl(F_c, s0),
        ElastoPlastic(F_c, F_s, v_s, s0, s1, s2, rng.uniform(0.2, 0.95) * F_c / s0),
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


def page(runs: int) -> str:
    """The table, by force and by tolerance."""
    rows: dict[str, list[tuple[bool, float, float]]] = {}
    for n in range(runs):
        run, share, over = judge(n)
        decade = int(np.floor(np.log10(run.tol or 1.0) / 2.0)) * 2
        for kind in (FORCES[n % len(FORCES)], f"1e{decade} to 1e{decade + 2}", "all"):
            rows.setdefault(kind, []).append((run.status is Status.DONE, share, over))
    lines = [
        "# Told and true errors of friction", "",
        f"Written by `python -m benchmarks.friction_scales`: {runs} runs (seeds ({SEED}, n)) of LuGre, Dahl and",
        "elasto-plastic contacts, v_s from 1e-3 to 100 m/s, 0.01 to 1000 kg, loads of 0.1 to 90 % of F_c, tolerances",
        "from 1e-1 to 1e-9, against Taylor series of order 26 that share no code with the package. The true error of a",
        "column is its largest difference between 0 and the end, relative to its largest magnitude there; each is set",
        "beside the error told of the same column, and the worst column of a run counts.", "",
        "| force, or tolerance | runs | done | beyond told | beyond 3 × told | true over told, median | most "
        "| true over tolerance, most |",
        "|---|" + "---:|" * 7,
    ]  # fmt: skip
    for kind in (*FORCES, *sorted(set(rows) - {*FORCES, "all"}, key=lambda kind: float(kind.split()[0])), "all"):
        done, share, over = np.array(rows[kind], float).T
        share, over = share[done == 1.0], over[done == 1.0]
        counts = done.size, int(done.sum()), int(np.sum(~(over <= 1.0))), int(np.sum(~(over <= 3.0)))
        numbers = np.median(over), over.max(), share.max()
        shown = [*(str(count) for count in counts), *(f"{number:.2g}" for number in numbers)]
        lines.append(f"| {kind} | {' | '.join(shown)} |")
    return "\n".join([*lines, ""])


def main() -> None:
    PAGE.write_text(page(int(sys.argv[1]) if len(sys.argv) > 1 else RUNS), encoding="utf-8")


if __name__ == "__main__":
    main()
