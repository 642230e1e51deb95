"""TSNet's published examples by `tline surge`, beside TSNet: python -m benchmarks.published_examples FOLDER [PYTHON]

FOLDER has Tnet1.inp to Tnet3.inp as they come with TSNet, and PYTHON is an interpreter that can import tsnet. Writes
docs/benchmarks-published.md. Each run is a process of its own. Needs tline[epanet].
"""

import csv
import json
import resource
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

from benchmarks.whole_grid import by_grid, by_tline

ROOT = Path(__file__).parent.parent
SPEED, LONGEST = 1200, 150  # m/s; s of a run
FINE = "1e-4"  # a hundredth of the usual tolerance
Heads = dict[str, tuple[float, float, float]]  # before, lowest and highest, m


class Example(NamedTuple):
    """An example: what it is, its event in the words of both programs, and the nodes of its figures."""

    file: str
    what: str
    operation: str
    duration: float  # s
    theirs: str
    nodes: tuple[str, ...]


EXAMPLES = (
    Example("Tnet1", "a valve closes in 0.6 s", "--close VALVE@0s+0.6s", 60,
            "tm.set_time(60, 0.1); tm.valve_closure('VALVE', [0.6, 0, 0, 1])", ("N2", "N3", "N7")),
    Example("Tnet1", "the same, with a tenth of TSNet's time step", "--close VALVE@0s+0.6s", 60,
            "tm.set_time(60, 0.01); tm.valve_closure('VALVE', [0.6, 0, 0, 1])", ("N2", "N3", "N7")),
    Example("Tnet2", "a pump's speed falls to nothing in 1 s", "--stop PUMP2@0s+1s", 10,
            "tm.set_time(10); tm.pump_shut_off('PUMP2', [1, 0, 0, 1])", ("10", "JUNCTION-105")),
    Example("Tnet3", "a burst of 0.01 m³/s/√m opens within 1 s", '--burst "JUNCTION-20:86.77 L/s@1s+1s"', 20,
            "tm.set_time(20); tm.add_burst('JUNCTION-20', 1, 1, 0.01)",
            ("JUNCTION-8", "JUNCTION-16", "JUNCTION-20", "JUNCTION-45", "JUNCTION-90")),
)  # fmt: skip

THEIRS = """
import json, sys
import tsnet
tm = tsnet.network.TransientModel(sys.argv[1])
tm.set_wavespeed({speed}.0)
{theirs}
tm = tsnet.simulation.Initializer(tm, 0.0, "DD")
tm = tsnet.simulation.MOCSimulator(tm, "out")
heads = [tm.get_node(name).head for name in {nodes}]
speeds = {{name: float(pipe.wavev) for name, pipe in tm.pipes()}}
found = [[float(h[0]), float(min(h)), float(max(h))] for h in heads]
print()
print(json.dumps([found, speeds]))
"""


def command(example: Example, folder: str) -> str:
    """What is typed."""
    speed = f'--wave-speed "{SPEED} m/s"'
    return f"tline surge {folder}{example.file}.inp {example.operation} --for {example.duration:g}s {speed}"


def timed(call: list[str], folder: str) -> tuple[str, float] | None:
    """What a process prints, and its CPU seconds; none if it takes too long."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    try:
        done = subprocess.run(call, capture_output=True, text=True, cwd=folder, timeout=LONGEST)
    except subprocess.TimeoutExpired:
        return None
    if not done.stdout or done.returncode > 1:
        raise SystemExit(done.stderr)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return done.stdout, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def ours(example: Example, inputs: Path, more: str = "") -> tuple[Heads, float] | None:
    """Heads by `tline surge`, and its CPU seconds."""
    with tempfile.TemporaryDirectory() as folder:
        line = f"{command(example, f'{inputs}/')} {more} --envelope heads.csv"
        done = timed([sys.executable, "-m", "tline", *shlex.split(line)[1:]], folder)
        if done is None:
            return None
        with open(Path(folder, "heads.csv"), encoding="utf-8") as file:
            rows = {row["node"]: row for row in csv.DictReader(file)}
    columns = [f"{what} head [m]" for what in ("start", "lowest", "highest")]
    heads = {node: tuple(float(rows[node][column]) for column in columns) for node in example.nodes}
    return heads, done[1]  # type: ignore[return-value]


def others(example: Example, inputs: Path, python: str) -> tuple[Heads, float, dict[str, float]] | None:
    """Heads by TSNet, its CPU seconds, and the wave speeds that it takes, by pipe."""
    program = THEIRS.format(speed=SPEED, theirs=example.theirs, nodes=example.nodes)
    with tempfile.TemporaryDirectory() as folder:
        done = timed([python, "-W", "ignore", "-c", program, str(inputs / f"{example.file}.inp")], folder)
    if done is None:
        return None
    heads, speeds = json.loads(done[0].splitlines()[-1])
    return dict(zip(example.nodes, heads, strict=True)), done[1], speeds


def with_speeds(example: Example, inputs: Path, speeds: dict[str, float]) -> tuple[Heads, float] | None:
    """Heads by `tline surge` with these wave speeds by pipe, m/s."""
    with tempfile.NamedTemporaryFile("w", suffix=".csv") as file:
        file.writelines(["pipe, wave speed\n", *(f"{name}, {speed} m/s\n" for name, speed in speeds.items())])
        file.flush()
        return ours(example, inputs, f"--material {file.name}")


def section(example: Example, inputs: Path, python: str | None) -> str:
    """Text and table of an example."""
    runs = {"tline": ours(example, inputs), f"tline, --tol {FINE}": ours(example, inputs, f"--tol {FINE}")}
    text = f"\n## {example.file}: {example.what}\n\n```console\n{command(example, '')}\n```\n\n"
    if python:
        found = others(example, inputs, python)
        runs["TSNet"] = found and found[:2]
        if found:
            runs["tline, TSNet's wave speeds"] = with_speeds(example, inputs, found[2])
            slowest, fastest = min(found[2].values()), max(found[2].values())
            text += f"TSNet's wave speeds are {slowest:.0f} to {fastest:.0f} m/s.\n\n"
    text += "| | CPU, s | " + " | ".join(example.nodes) + " |\n|---|---:" + "|---:" * len(example.nodes) + "|\n"
    for name, run in runs.items():
        if run is None:
            text += f"| {name} | more than {LONGEST} s of a shared machine |" + " |" * len(example.nodes) + "\n"
            continue
        cells = ["{:.2f}: {:.2f} to {:.2f}".format(*run[0][node]) for node in example.nodes]
        text += f"| {name} | {run[1]:.1f} | " + " | ".join(cells) + " |\n"
    return text


def decided(inputs: Path) -> str:
    """Tnet1 with TSNet's law of its valve, by tline and by the textbook's method."""
    nodes, file = EXAMPLES[0].nodes, inputs / "Tnet1.inp"
    text = DECIDED + "| | " + " | ".join(nodes) + " |\n|---" + "|---:" * len(nodes) + "|\n"
    for name, heads in (("tline", by_tline(file, nodes)), ("whole grid of 1 m", by_grid(file, nodes))):
        cells = ["{:.2f}: {:.2f} to {:.2f}".format(*heads[node]) for node in nodes]
        text += f"| {name} | " + " | ".join(cells) + " |\n"
    return text


DECIDED = f"""
## Tnet1: who is right

Behind its valve there is a node with a demand and no pipe. TSNet takes such a valve as the end of the pipe before it,
and lets the velocity there fall evenly with time (`valve_end` in its `simulation/solver.py`); here the valve's loss
rises as it shuts, and most of the flow stops in the last part of the stroke. Below that end has TSNet's flow, by tline
and by the textbook's method of characteristics on a grid of 1 m and 1/{SPEED} s (`benchmarks/whole_grid.py`): all pipes
are whole numbers of metres long, so that no wave speed is changed and nothing interpolated. So the law of the valve
explains what differs above, but for what TSNet's time step does.

"""

PAGE = f"""# TSNet's published examples

Written by `python -m benchmarks.published_examples`: the three examples of TSNet's documentation, with {SPEED} m/s in
all pipes, by `tline surge` at its usual tolerance of 0.01, at a hundredth of it, and by TSNet where it is installed.
Cells are heads in m before the event, then the lowest and the highest one, at nodes that the documentation shows and
those next to the event. CPU seconds are those of the whole process, of a shared machine.

Differences from the documentation: its third example has random wave speeds and a leak beside the burst, and its
second one lasts 50 s in the text and 10 s in the script. The burst's flow is that of 75.29 m, the gauge pressure at
its node before.
"""

if __name__ == "__main__":
    page = PAGE
    for each in EXAMPLES:
        page += section(each, Path(sys.argv[1]).resolve(), sys.argv[2] if sys.argv[2:] else None)
        print(page, flush=True)
        (ROOT / "docs" / "benchmarks-published.md").write_text(page, encoding="utf-8")
    page += decided(Path(sys.argv[1]).resolve())
    (ROOT / "docs" / "benchmarks-published.md").write_text(page, encoding="utf-8")
