"""What a user waits for: ``python -m benchmarks.time_to_answer [--against CHECKOUT] [--runs N]``.

Prints a page and writes it to docs/benchmarks-time-to-answer.md. Everything is measured in one run, in processes of its
own, the same with an older checkout of tline where one is named.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

from benchmarks.time_to_answer_page import KINDS, Answers, page

ROOT = Path(__file__).parent.parent
INSIDE = Path(__file__).with_name("time_to_answer_inside.py")
CABLE, VALVE = "scenes/cable_rc.toml", "scenes/valve_closure.toml"
AGAIN = 9  # calls in one process
INSIDE_ASKED = {
    "cable": ("repeated", CABLE, AGAIN),
    "valve": ("repeated", VALVE, AGAIN),
    "prepared": ("prepared", CABLE, "loads.receiver.capacitance", [4e-12, 5e-12, 6e-12], AGAIN),
}
RTHYM = """
import rthym_moc as moc
def filled(record, **fields):
    for name, value in fields.items():
        setattr(record, name, value)
    return record
solver = moc.MOCSolver()
solver.add_node(filled(moc.NodeInput(), id="tank", type="PressureBoundary", head=5000.0))
solver.add_node(filled(moc.NodeInput(), id="far", type="Junction", head=4900.0))
ends = {"from_node": "tank", "to_node": "far", "length": 4000.0, "diameter": 12.0, "flow_gpm": 3170.0}
solver.add_pipe(filled(moc.PipeInput(), id="pipe", roughness=100.0, **ends))
solver.set_demand_schedule("far", [(0.0, 3170.0), (0.5, 0.0), (20.0, 0.0)])
solver.run(total_time=20.0, dt=1 / 16)
"""  # the pipe of the friction chart
LONG = 20.0  # CPU seconds beyond which one run of a compilation is enough


class Spent(NamedTuple):
    """What a process took."""

    wall: float
    cpu: float
    told: str


class Checkout(NamedTuple):
    """A tline, where its bytecode and compiled code are kept."""

    path: Path
    bytecode: Path
    compiled: Path

    def process(self, *arguments: str, compiled: Path | None = None) -> Spent:
        """Run Python with it."""
        own = {"PYTHONPATH": self.path, "PYTHONPYCACHEPREFIX": self.bytecode}
        own["NUMBA_CACHE_DIR"] = compiled or self.compiled
        return spent([sys.executable, "-P", "-W", "ignore", *arguments], own, self.path)

    def inside(self, *asked: Any) -> Any:
        """What a measurement in a process of its own prints."""
        what, *rest = asked
        return json.loads(self.process(str(INSIDE), what, *map(json.dumps, rest)).told)


def spent(call: list[str], own: dict[str, Any], folder: Path) -> Spent:
    """Run a program to its end.

    Raises
    ------
    subprocess.CalledProcessError
        It failed.
    """
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
    with tempfile.TemporaryFile() as out:
        started = time.perf_counter()
        child = subprocess.Popen(
            call,
            env=environment | {k: str(v) for k, v in own.items()},
            cwd=folder,
            stdout=out,
            stderr=subprocess.DEVNULL,
        )
        _, status, usage = os.wait4(child.pid, 0)
        wall = time.perf_counter() - started
        child.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        told = out.read().decode()
    if child.returncode not in (0, 1):  # 1: a tolerance is not met
        raise subprocess.CalledProcessError(child.returncode, call, told)
    return Spent(wall, usage.ru_utime + usage.ru_stime, told)


@contextmanager
def checkout(path: Path) -> Iterator[Checkout]:
    """A checkout whose bytecode is written, with an empty cache of compiled code."""
    with tempfile.TemporaryDirectory() as folder:
        found = Checkout(path, Path(folder, "bytecode"), Path(folder, "compiled"))
        with tempfile.TemporaryDirectory() as other:
            found.process(str(INSIDE), "answer", json.dumps(CABLE), compiled=Path(other))
            found.process("-c", "import numba")
        yield found


def compilation(tline: Checkout, scene: str, runs: int) -> float:
    """CPU seconds by which a process with an empty cache takes longer than the next one."""
    found: list[float] = []
    while len(found) < runs and not (found and found[0] > LONG):
        with tempfile.TemporaryDirectory() as folder:
            cold, warm = (
                tline.process(str(INSIDE), "answer", json.dumps(scene), compiled=Path(folder)).cpu for _ in range(2)
            )
        found.append(cold - warm)
    return median(found)


def whole_processes(tlines: dict[str, Checkout], runs: int) -> dict[str, tuple[float, float]]:
    """Seconds of whole processes and their ratios to ``import numba``, one after the other in each round."""
    one = next(iter(tlines.values()))
    works = {"numba": lambda: one.process("-c", "import numba")}
    for name, tline in tlines.items():
        works[name] = lambda tline=tline: tline.process("-m", "tline", "run", CABLE)
    with tempfile.TemporaryDirectory() as folder:
        deck = Path(folder, "cable.cir")
        deck.write_text(one.process("-m", "tline", "export", CABLE).told, encoding="utf-8")
        if shutil.which("ngspice"):
            call = ["ngspice", "-b", "-r", str(Path(folder, "cable.raw")), str(deck)]
            works["ngspice"] = lambda: spent(call, {}, ROOT)
        if one.process("-c", "import importlib.util as u; print(u.find_spec('rthym_moc'))").told.strip() != "None":
            works["rthym-moc"] = lambda: one.process("-c", RTHYM)
        rounds = [{name: work().wall for name, work in works.items()} for _ in range(runs + 1)][1:]
    return {
        name: (median(each[name] for each in rounds), median(each[name] / each["numba"] for each in rounds))
        for name in works
    }


def measured(tlines: dict[str, Checkout], scenes: list[str], runs: int) -> dict[str, Answers]:
    """All that concerns single checkouts, which take turns: a machine that others use is not always as fast."""
    cpu: dict[str, dict[str, float]] = {name: {} for name in tlines}
    for scene in scenes:
        for name, tline in tlines.items():
            cpu[name][scene] = compilation(tline, scene, runs)
            print(f"{name}: {scene} {cpu[name][scene]:.2f} s to compile", file=sys.stderr)
    found: dict[str, dict[str, Any]] = {name: {what: [] for what in INSIDE_ASKED} for name in tlines}
    for _ in range(runs):
        for what, asked in INSIDE_ASKED.items():
            for name, tline in tlines.items():
                found[name][what].append(tline.inside(*asked))
    for name, tline in tlines.items():
        medians = {
            what: {key: median(each[key] for each in told) for key in told[0]} for what, told in found[name].items()
        }
        found[name] = medians | {"pipe": tline.inside("pipe")}
    return {name: Answers(cpu[name], **found[name]) for name in tlines}


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--against", type=Path, help="an older checkout of tline")
    arguments.add_argument("--runs", type=int, default=5, help="of which medians are taken")
    arguments.add_argument("--only", nargs="*", default=[], help="scenes to compile besides those of the first table")
    asked = arguments.parse_args()
    shipped = sorted(f"scenes/{path.name}" for path in (ROOT / "scenes").glob("*.toml"))
    scenes = [scene for scene in shipped if not asked.only or scene in {*asked.only, *KINDS.values()}]
    with checkout(ROOT) as now, checkout((asked.against or ROOT).resolve()) as then:
        tlines = {"now": now} | ({"before": then} if asked.against else {})
        processes = whole_processes(tlines, max(asked.runs, 5))
        text = page(measured(tlines, scenes, asked.runs), processes, asked.runs)
    print(text)
    (ROOT / "docs" / "benchmarks-time-to-answer.md").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
