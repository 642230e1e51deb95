"""Lines that remember, as convolutions and in segments: `python -m benchmarks.memory_lines [slow]`.

Seconds are of whole calls, in one process; errors are against inverse Laplace, from a hundredth of the delay behind
each front on. With `slow`, the same scenes in segments with circuits for their laws, which takes minutes.
"""

import sys
from statistics import median
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np

from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.solver.result.result import Result
from tline.solver.simulate import simulate
from tline.solver.tolerance.lossy import with_losses
from tline.solver.tolerance.search import Search
from tline.study.reference.lossy_scene import LossySolution

REPEATS, SEEN, BLURRED = 3, 24, 0.0101
SKIN = {"length": "0.2 m", "z0": 50, "delay": "1 ns", "skin": {"resistance": 60, "frequency": "10 GHz"}}
PIPE = {"length": "36.09 m", "radius": "12.7 mm", "density": 878, "wave_speed": 1324}
ZIELKE = PIPE | {"friction": {"kind": "zielke", "viscosity": "0.0347 Pa s"}}
EDGE = {"shape": "ramp", "to": 1, "duration": "1 ns"}


class Case(NamedTuple):
    """A scene, its tolerance, and its delay if there is a reference for it, s."""

    scene: Scene
    tol: float
    delay: float = 0.0


def scene(lines: list[dict[str, Any]], value: Any, t_end: str, **more: Any) -> Scene:
    """Lines in a row, between 25 ohm and 100 ohm."""
    nodes = [*(f"n{k}" for k in range(len(lines))), "far"]
    return Scene(
        medium="electrical",
        t_end=t_end,
        lines={f"line{k}": {"nodes": nodes[k : k + 2]} | line for k, line in enumerate(lines)},
        sources={"s": {"at": "n0", "kind": "voltage", "value": value, "resistance": 25}},
        loads={"r": {"at": "far", "kind": "resistor", "resistance": 100}},
        probes={"near": {"at": "n0"}, "far": {"at": "far"}},
        **more,
    )


def closed_pipe() -> Scene:
    """Pressure at one end, the other closed."""
    return Scene(
        medium="hydraulic",
        t_end=0.3,
        lines={"line": {"nodes": ["near", "far"]} | ZIELKE},
        sources={"s": {"at": "near", "kind": "pressure", "value": 1, "resistance": 0}},
        probes={"near": {"at": "near"}, "far": {"at": "far"}},
    )


def cases() -> dict[str, Case]:
    """By name."""
    late = {"shape": "step", "to": 1, "at": 0.33371e-9}
    rg58 = [{"cable": "RG-58", "length": length} for length in ("37 m", "23 m")]
    return {
        "skin effect, a jump": Case(scene([SKIN], 1, "10 ns"), 1e-6, 1e-9),
        "skin effect, a jump at 0.33371 ns": Case(scene([SKIN], late, "10 ns"), 1e-6, 1e-9),
        "Zielke, a jump": Case(closed_pipe(), 1e-6, 36.09 / 1324),
        "RG-58, 37 m and 23 m, an edge of 1 ns": Case(scene(rg58, EDGE, "1 us"), 1e-4),
        "skin effect, delays 2 : 3": Case(
            scene([SKIN, SKIN | {"delay": "1.5 ns", "length": "0.3 m"}], 1, "10 ns"), 1e-6
        ),
        "skin effect, delays 2 : 3.111…": Case(
            scene([SKIN, SKIN | {"delay": 1.1e-9 * 2**0.5, "length": 0.22 * 2**0.5}], 1, "10 ns"), 1e-6
        ),
    }


def error(case: Case, result: Result) -> float:
    """The largest at random instants at the far end, V or Pa."""
    t = np.random.default_rng(1).uniform(0.0, float(case.scene.t_end), SEEN)
    sources = case.scene.sources["s"].value.breaks(1.0)
    at = float(sources[-1]) if len(sources) else 0.0
    t = t[np.abs((t - at) / case.delay - np.round((t - at) / case.delay)) > BLURRED]
    exact = LossySolution(case.scene, "far").at([repr(float(x)) for x in t], digits=13)
    return float(np.abs(result.probes["far"].at(t).u - np.array(exact.u, float)).max())


def main(slow: str = "") -> None:
    """Print a line for each case."""
    simulate(scene([SKIN], 1, "1 ns"), tol=1e-3)
    for name, case in cases().items():
        results, seconds = [], []
        for _ in range(REPEATS):
            started = perf_counter()
            results.append(simulate(case.scene, tol=case.tol))
            seconds.append(perf_counter() - started)
        result, most = results[-1], median(seconds)
        told = result.accuracy
        assert told is not None
        text = f"{name}: {most:.2f} s to {case.tol:.0e}, {'met' if told.met else 'NOT met'}, estimate {told.worst:.1e}"
        if case.delay:
            text += f", error {error(case, result):.1e}"
        if slow:
            started = perf_counter()
            before = with_losses(Search(describe(case.scene), case.tol, [], False)).accuracy
            took = perf_counter() - started
            assert before is not None
            text += f"; in segments {took:.1f} s ({took / most:.0f} times), estimate {before.worst:.1e}"
        print(text, flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
