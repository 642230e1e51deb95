"""One measurement in a process of its own, of the tline that is on the path: ``time_to_answer_inside.py WHAT …``.

Run by `benchmarks.time_to_answer`, also with an older tline, so it asks for nothing that is new. Prints JSON.
"""

import json
import sys
import time
import warnings
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from itertools import cycle, takewhile
from statistics import median
from typing import Any

SETTLED = 5  # calls before the clock starts
TOL = 1e-6
PIPE, PIPE_ERROR = "friction", 1e-3  # of the charts


def scene_of(name: str) -> Any:
    """A scene file, or one of the charts' by ``chart:NAME``."""
    if name.startswith("chart:"):
        from tline.study.charts.scenes import chart_scene

        return chart_scene(name.removeprefix("chart:")).scene
    from tline.scene.file import read_scene

    return read_scene(name)


def answer(name: str) -> None:
    """Run a scene to its tolerance."""
    from tline.solver.simulate import simulate

    simulate(scene_of(name))


def clocked(work: Callable[[], Any], runs: int) -> float:
    """Median seconds of a call, in a process that has made some."""
    for _ in range(SETTLED):
        work()
    seconds = []
    for _ in range(runs):
        started = time.perf_counter()
        work()
        seconds.append(time.perf_counter() - started)
    return median(seconds)


def repeated(name: str, runs: int) -> dict[str, float]:
    """Seconds of `simulate` again, and the share of them in compiled code."""
    from tline.solver.simulate import simulate

    work = partial(simulate, scene_of(name), tol=TOL)
    seconds, spent = clocked(work, runs), in_compiled_code()
    compiled = []
    for _ in range(runs):
        spent[0] = 0.0
        work()
        compiled.append(spent[0])
    return {"seconds": seconds, "share": median(compiled) / seconds}


def in_compiled_code() -> list[float]:
    """The seconds, counted from now on, between calls from Python into compiled code and their returns."""
    spent = [0.0]

    def counted(function: Any) -> Any:
        def call(*arguments: Any) -> Any:
            started = time.perf_counter()
            try:
                return function(*arguments)
            finally:
                spent[0] += time.perf_counter() - started

        return call

    for module in [each for name, each in sys.modules.items() if name.partition(".")[0] == "tline"]:
        for name, value in list(vars(module).items()):
            if type(value).__name__ == "CPUDispatcher":
                setattr(module, name, counted(value))
    with suppress(ImportError):
        from tline.compiled.unit import Unit

        Unit.__call__ = counted(Unit.__call__)
    return spent


def prepared(name: str, key: str, values: list[float], runs: int) -> dict[str, float]:
    """Seconds of a prepared scene with other values, each time different; nothing where tline has no such thing."""
    try:
        from tline.solver.prepared import prepare
    except ImportError:
        return {}
    ready, turn = prepare(scene_of(name)), cycle(values)
    return {"seconds": clocked(lambda: ready.run({key: next(turn)}, tol=TOL), runs)}


def pipe() -> dict[str, Any]:
    """Least seconds of stepping that leave a true error below 1e-3, of slabs and of rthym-moc."""
    from tline.study.charts.clock import FULL
    from tline.study.charts.judge import Judge
    from tline.study.charts.table import ChartTable
    from tline.study.charts.work_precision import add, production
    from tline.study.programs import rthym

    scene = scene_of(f"chart:{PIPE}")
    judge, table = Judge(scene, FULL.instants), ChartTable(PIPE, scene.title)
    table.rows += takewhile(lambda row: row.kind == "ours", production(scene, judge, FULL._replace(longest=0.01)))
    why = rthym.incompatibility(scene)
    if why is None:
        add(table, "rthym-moc", "peer", partial(rthym.run, scene), judge, FULL)
    best: dict[str, Any] = {"why": why}
    for row in table.rows:
        if row.error_at_own <= PIPE_ERROR and row.kind in ("ours", "peer"):
            best[row.kind] = min(row.stepping, best.get(row.kind, row.stepping))
    return best


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    what, *rest = sys.argv[1:]
    given = [json.loads(each) for each in rest]
    known = {"answer": answer, "repeated": repeated, "prepared": prepared, "pipe": pipe}
    print(json.dumps(known[what](*given)))
