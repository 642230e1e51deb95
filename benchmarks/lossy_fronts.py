"""What it costs to shift the clock of a scene with a lossy line: `python -m benchmarks.lossy_fronts [COUNT]`.

A step into 0.2 m of cable with 20 ohm/m, at random instants, to 1e-8; and a pulse, a short ramp and a train of pulses.
Seconds are of whole calls, samples those of all runs of a call; both also over those of the scene at t = 0. Errors are
against inverse Laplace, at random instants between slab ends.
"""

import sys
from statistics import median
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np

from tline.scene.scene import Scene
from tline.solver.simulate import simulate
from tline.study.reference.lossy_scene import LossySolution

TOL, SEEN = 1e-8, 20
SHAPES: dict[str, dict[str, Any]] = {
    "step": {"shape": "step", "to": 1},
    "pulse of 0.41 ns": {"shape": "pulses", "high": 1, "width": "0.41 ns"},
    "ramp of 1 ps": {"shape": "ramp", "to": 1, "duration": "1 ps"},
    "pulses every 1.37 ns": {"shape": "pulses", "high": 1, "width": "0.41 ns", "period": "1.37 ns"},
}


class Cost(NamedTuple):
    """Of one call."""

    seconds: float
    samples: int
    error: float  # largest at some instants, V
    met: bool


def cable(value: dict[str, Any], at: float) -> Scene:
    """The scene, with its source so late, s."""
    return Scene(
        medium="electrical",
        t_end="20 ns",
        lines={"line": {"nodes": ["near", "far"], "length": "0.2 m", "z0": 50, "delay": "1 ns", "resistance": 20}},
        sources={"s": {"at": "near", "kind": "voltage", "value": value | {"at": at}, "resistance": 25}},
        loads={"r": {"at": "far", "kind": "resistor", "resistance": 100}},
        probes={"near": {"at": "near"}, "far": {"at": "far"}},
    )


def cost(scene: Scene, rng: np.random.Generator) -> Cost:
    """Run it."""
    started = perf_counter()
    result = simulate(scene, tol=TOL)
    seconds = perf_counter() - started
    t = rng.uniform(0.1e-9, 20e-9, SEEN)
    exact = LossySolution(scene, "far").at([repr(float(x)) for x in t], digits=20)
    error = float(np.abs(result.probes["far"].at(t).u - np.array(exact.u, float)).max())
    assert result.accuracy is not None
    return Cost(seconds, sum(attempt.samples for attempt in result.accuracy.attempts), error, result.accuracy.met)


def main(count: int = 100) -> None:
    """Print a line for each shape."""
    rng = np.random.default_rng(1)
    for name, value in SHAPES.items():
        cost(cable(value, 0.0), rng)  # compiles, and finds maps
        first = cost(cable(value, 0.0), rng)
        found = [cost(cable(value, float(at)), rng) for at in rng.uniform(0.0, 3e-9, count)]
        slow, typical = max(each.seconds for each in found), median(each.seconds for each in found)
        print(
            f"{name}: {first.seconds:.3f} s at t = 0; at {count} instants {typical:.3f} s, {slow:.3f} s at most "
            f"({typical / first.seconds:.1f} and {slow / first.seconds:.1f} times); "
            f"samples {max(each.samples for each in found) / first.samples:.2f} times at most; "
            f"{sum(each.met for each in found)} met, largest error {max(each.error for each in found):.1e} V",
            flush=True,
        )


if __name__ == "__main__":
    main(*(int(argument) for argument in sys.argv[1:]))
