"""Waiting times of a user: ``python -m benchmarks.time_to_answer [SCENE…]`` writes docs/time-to-answer.md.

Everything is measured in one run, whole processes in turn; with names of scenes only these are compiled.
"""

import json
import shutil
import sys
import tempfile
from functools import partial
from itertools import cycle
from pathlib import Path
from statistics import median
from typing import Any

from benchmarks.harness import ROOT, RUNS, apart, in_turn, spent, table, timed, write

CABLE, VALVE = "scenes/cable_rc.toml", "scenes/valve_closure.toml"
TOL, LONG = 1e-6, 20.0  # CPU seconds beyond which one run of a compilation is enough
AGAIN = 9
RTHYM = "from tline.study.programs import rthym; from tline.study.charts.scenes import chart_scene as scene;"
RTHYM += "rthym.run(scene('friction').scene, 16)"
ANSWER = "import sys; from tline.scene.file import read_scene; from tline.solver.simulate import simulate;"
ANSWER += "simulate(read_scene(sys.argv[1]))"


def compilation(scene: str) -> float:
    """CPU seconds by which a process with an empty cache takes longer than the next one."""
    found: list[float] = []
    while len(found) < RUNS and not (found and found[0] > LONG):
        with tempfile.TemporaryDirectory() as folder:
            call = [sys.executable, "-W", "ignore", "-c", ANSWER, scene]
            cold, warm = (spent(call, {"NUMBA_CACHE_DIR": folder}).cpu for _ in range(2))
        found.append(cold - warm)
    return median(found)


def processes() -> tuple[str, float]:
    """Table of whole processes in turn, and the ratio of `tline run` to ``import numba``."""
    from tline.study.charts.scenes import chart_scene
    from tline.study.programs import rthym

    def wall(*arguments: str) -> float:
        return spent([sys.executable, "-W", "ignore", *arguments]).wall

    works = {"`python -c 'import numba'`": partial(wall, "-c", "import numba")}
    works |= {f"`tline run {CABLE}`": partial(wall, "-m", "tline", "run", CABLE)}
    absent = []
    with tempfile.TemporaryDirectory() as folder:
        deck = Path(folder, "cable.cir")
        deck.write_text(spent([sys.executable, "-m", "tline", "export", CABLE]).said, encoding="utf-8")
        if shutil.which("ngspice"):
            call = ["ngspice", "-b", "-r", str(Path(folder, "cable.raw")), str(deck)]
            works[f"ngspice on `tline export {CABLE}`"] = lambda: spent(call).wall
        else:
            absent.append("ngspice")
        if rthym.incompatibility(chart_scene("friction").scene) is None:
            works["rthym-moc on the pipe of the friction chart, 16 steps per transit"] = partial(wall, "-c", RTHYM)
        else:
            absent.append("rthym-moc")
        found = in_turn(works)
    rows = ((name, f"{seconds:.3f}", f"{ratio:.2f}") for name, (seconds, ratio) in found.items())
    said = table("<process|seconds|ratio to `import numba`", rows)
    said += f"\n\nNot installed, so not measured: {', '.join(absent)}." if absent else ""
    return said, found[f"`tline run {CABLE}`"][1]


def again() -> dict[str, str]:
    """Milliseconds of calls in this process, which has made some."""
    from tline.scene.file import read_scene
    from tline.solver.prepared import prepare
    from tline.solver.simulate import simulate

    cable, valve = (read_scene(ROOT / name) for name in (CABLE, VALVE))
    ready, turn = prepare(cable), cycle([4e-12, 5e-12, 6e-12])
    calls = {
        "`simulate(cable_rc)` to 1e-6 again": lambda: simulate(cable, tol=TOL),
        "the same prepared, other values": lambda: ready.run({"loads.receiver.capacitance": next(turn)}, tol=TOL),
        "`simulate(valve_closure)` to 1e-6 again": lambda: simulate(valve, tol=TOL),
    }
    for call in calls.values():
        timed(call)
    return {name: f"{1e3 * timed(call, AGAIN)[1]:.3g} ms" for name, call in calls.items()}


def main(names: list[str]) -> None:
    """Write the page."""
    page = "docs/time-to-answer.md"
    scenes = [f"scenes/{path.name}" for path in sorted((ROOT / "scenes").glob("*.toml"))]
    cpu = {scene: compilation(scene) for scene in scenes if not names or Path(scene).stem in names}
    most = max(cpu, key=cpu.__getitem__)
    told, ratio = processes()
    answers: dict[str, Any] = {
        f"CPU to compile, the slowest of the scenes below ({Path(most).stem})": f"{cpu[most]:.1f} s",
        f"`tline run {CABLE}`, cache filled, over `import numba`": f"{ratio:.2f}",
        **apart("benchmarks.time_to_answer", "again"),
    }
    write(page, table("<what the user waits for|now", answers.items()), "answers")
    write(page, told, "processes")
    write(page, table("<scene|CPU to compile, s", ((Path(n).stem, f"{s:.1f}") for n, s in cpu.items())), "compiled")


if __name__ == "__main__":
    if sys.argv[1:] == ["again"]:
        print(json.dumps(again()))
    else:
        main(sys.argv[1:])
