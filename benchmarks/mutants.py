"""Detection by the witness of faults put into the kernel by hand: python -m benchmarks.mutants [NUMBER...].

Each mutant is a copy of the package in which one line of the kernel is wrong, and runs some scenes in a process of its
own. Prints a table and writes it to benchmarks/pages/mutants.md. Takes some ten minutes, nearly all of it compiling.
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import warnings
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from benchmarks import harness

KERNEL = "tline/solver/kernel"
TOL, INSTANTS = 1e-4, 200
COUNTED = 1.0  # times the tolerance, from which an answer counts as changed


class Mutant(NamedTuple):
    """Fault in the kernel: description, file, and the line before and after."""

    what: str
    file: str
    right: str
    wrong: str


MOVES = "if events.row[i] != SAME_MAP:"
BACK = "if events.row[i] == SAME_MAP:\n            network.step_row[g] = max(network.step_row[g] - 1, 0)\n        else:"
FILLING = "return y, 1.0, y, 1.0 / c[at + 2]"
MUTANTS = (
    Mutant("moves inside slabs are lost", "fronts/gather.py", MOVES, MOVES.replace("!=", "<")),
    Mutant("a move is forgotten where a law kinks", "fronts/gather.py", MOVES, BACK),
    Mutant("moves happen in the next slab", "fronts/gather.py", "<= begin + MERGE", "<= begin - 1.0"),
    Mutant("flow of an orifice doubled", "laws/quadratic.py",
           "    return i, capacity**2", "    return 2.0 * i, capacity**2"),
    Mutant("an orifice lets flow pass one way", "laws/quadratic.py", "(one_way > 0.0 and d < 0.0)", "d < 0.0"),
    Mutant("laws see the sample before", "laws/crossing.py", "v[i] - c[at], z", "v[max(i - 1, 0)] - c[at], z"),
    Mutant("openings are of the sample before", "laws/crossing.py", "control[i], v[i]", "control[0], v[i]"),
    Mutant("relief valve without its band", "laws/relief.py", "if d - z * i >= high:", "if d >= least:"),
    Mutant("demand without a limit", "laws/outflow.py", "if d - z * control * c[at + 1] >= c[at + 2]:", "if False:"),
    Mutant("table continued flat", "laws/table.py", "return last - slope * (stop - d), slope",
           "return min(last - slope * (stop - d), last), slope"),
    Mutant("diode at twice its temperature", "laws/diode.py", "c[at + 1], c[at + 2], d",
           "c[at + 1], 2.0 * c[at + 2], d"),
    Mutant("a tank half as wide", "stores/tank.py", FILLING, FILLING.replace("1.0 / c", "2.0 / c")),
    Mutant("gas of half the volume", "stores/gas.py", "c[at + 2] * effort, ratio / c[at + 3]",
           "c[at + 2] * effort, 2.0 * ratio / c[at + 3]"),
    Mutant("wrong sign of a store", "stores/tank.py", FILLING, FILLING.replace("1.0, y", "1.0, -y")),
    Mutant("a circuit forgets its state", "blocks.py", "states[np.uint64(x + i)] = 0.0 if abs(total) < TINY else total",
           "states[np.uint64(x + i)] = 0.5 * total"),
    Mutant("a rest of a delay is left out", "blocks.py",
           "row[k] += now * history[s - 1, k + 1] + then * history[s - 1, k]",
           "row[k] += now * history[s - 1, k + 1] + then * history[s - 1, k + 1]"),
    Mutant("fronts of sources are skipped", "fronts/gather.py",
           "if n < place.size and (sources.start[j] > 0.0 or sources.anew[now]):", "if False:"),
    Mutant("travelling fronts are skipped", "fronts/gather.py", "if strength > 0.0 and -MERGE / 2",
           "if strength < 0.0 and -MERGE / 2"),
    Mutant("a wave comes back with half its effort", "blocks.py", "back = 2.0 * u[q", "back = 1.98 * u[q"),
    Mutant("a piece is restricted at the wrong place", "fronts/gather.py", "span[j, 1], edges[k], edges[k + 1]",
           "span[j, 1], edges[k] * 0.99, edges[k + 1]"),
)  # fmt: skip


def water(loads: dict[str, Any], **more: Any) -> dict[str, Any]:
    """Two pipes from a reservoir; the last node is the third."""
    pipe = {"wave_speed": "1000 m/s", "diameter": "0.2 m", "density": "1000 kg/m^3"}
    return {
        "medium": "hydraulic", "t_end": "1 s", "start": "steady", "probes": {"end": {"at": "c"}, "mid": {"at": "b"}},
        "lines": {
            "p": pipe | {"nodes": ["a", "b"], "length": "100 m"}, "q": pipe | {"nodes": ["b", "c"], "length": "87 m"},
        },
        "loads": {"lake": {"at": "a", "kind": "reservoir", "pressure": "2 bar"}} | loads,
    } | more  # fmt: skip


def cable(loads: dict[str, Any], delay: str = "3.3 ns", at: str = "1 ns") -> dict[str, Any]:
    """Cable behind 50 ohm."""
    line = {"nodes": ["near", "far"], "z0": 50, "delay": delay}
    value = {"shape": "step", "to": 1.0, "at": at}
    return {
        "medium": "electrical", "t_end": "40 ns", "probes": {"far": {"at": "far"}},
        "lines": {"l": line, "m": line | {"nodes": ["far", "end"], "delay": "4.51 ns", "z0": 70}},
        "sources": {"s": {"at": "near", "kind": "voltage", "value": value, "resistance": 30}},
        "loads": loads,
    }  # fmt: skip


VALVE = {"at": "c", "kind": "valve", "before": 1e7, "after": 1e8, "time": "0.2 s"}
RATED = {"flow": "5 L/s", "pressure_drop": "1 bar"}
SHUT = {"shape": "ramp", "from": 1, "to": 0, "at": "0.1 s", "duration": "0.13 s"}
SCENES = {
    "valve, orifice": water({"v": VALVE, "o": {"at": "c", "kind": "orifice", "back_pressure": "3 bar"} | RATED}),
    "valve, relief": water(
        {"v": VALVE, "o": {"at": "c", "kind": "relief valve", "set_pressure": "2.2 bar", "band": "1 bar"} | RATED}
    ),
    "valve, demand": water(
        {"v": VALVE, "o": {"at": "c", "kind": "demand", "flow": "4 L/s", "required_pressure": "1.5 bar"}}
    ),
    "closing orifice": water({"o": {"at": "c", "kind": "orifice", "opening": SHUT} | RATED}),
    "tank": water({"v": VALVE, "t": {"at": "b", "kind": "surge tank", "tank_diameter": "1 cm", "density": 1000}}),
    "gas": water({"v": VALVE, "g": {"at": "b", "kind": "air vessel", "gas_volume": "10 L", "gas_pressure": "2 bar"}}),
    "RC": cable({"c": {"at": "end", "kind": "parallel", "resistance": 100, "capacitance": "20 pF"}}),
    "diode": cable({"d": {"at": "end", "kind": "diode", "saturation": "1 nA"}}),
    "switch, table": cable(
        {
            "s": {"at": "end", "kind": "switch", "before": 1000, "after": 50, "time": "17.7 ns"},
            "t": {"at": "end", "kind": "table", "points": [[-1, 0], [0.3, 0], [0.6, 0.001]]},
        }
    ),
}


def answers() -> dict[str, Any]:
    """Answers to all scenes, by the package that is imported."""
    import tline as tl

    found: dict[str, Any] = {}
    for name, table in SCENES.items():
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                result = tl.simulate(table, tol=TOL)
        except tl.InputError as error:
            found[name] = {"error": str(error)}
            continue
        t = np.random.default_rng(1).uniform(0, result.scene.t_end, INSTANTS)
        seen = [np.array([probe.at(t).u, probe.record.z0 * probe.at(t).y]) for probe in result.probes.values()]
        found[name] = {"met": result.accuracy.met, "limit": result.accuracy.limit, "values": np.array(seen).tolist()}
    return found


def ran(folder: Path) -> dict[str, Any]:
    """Answers of the package in a folder."""
    call = [sys.executable, "-P", str(Path(__file__).resolve()), "--answers"]
    try:
        said = harness.spent(call, {"PYTHONPATH": f"{folder}{os.pathsep}{harness.ROOT}"}).said
    except subprocess.CalledProcessError:
        return {name: {"error": "the process ended"} for name in SCENES}
    return json.loads(said.splitlines()[-1])


def copied(folder: Path, mutant: Mutant | None) -> Path:
    """Copy the package with one line of the kernel changed."""
    skipped = shutil.ignore_patterns("__pycache__")
    for package in ("tline", "passivity", "friction", "drives"):
        shutil.copytree(harness.ROOT / package, folder / package, ignore=skipped)
    if mutant is not None:
        file = folder / KERNEL / mutant.file
        text = file.read_text()
        assert text.count(mutant.right) == 1, mutant
        file.write_text(text.replace(mutant.right, mutant.wrong))
    return folder


def weighed(true: dict[str, Any], given: dict[str, Any]) -> dict[str, str]:
    """Outcome by scene: equal, reported, or wrong and not reported."""
    found = {}
    for name in SCENES:
        if "error" in given[name]:
            found[name] = "ends"
            continue
        right, wrong = np.array(true[name]["values"]), np.array(given[name]["values"])
        off = np.abs(wrong - right).max(axis=2).max() / np.abs(right).max()
        told = "disagree" in given[name]["limit"]
        if not given[name]["met"]:
            found[name] = "witness" if told else "not met"
        else:
            found[name] = "same" if off <= COUNTED * TOL else f"MISSED by {off:.1g}"
    return found


def main(chosen: list[int]) -> None:
    with tempfile.TemporaryDirectory() as folder:
        true = ran(copied(Path(folder), None))
    assert all(each.get("met") for each in true.values()), true
    rows = []
    for mutant in [MUTANTS[number] for number in chosen] or MUTANTS:
        with tempfile.TemporaryDirectory() as folder:
            given = weighed(true, ran(copied(Path(folder), mutant)))
        rows.append([mutant.what, *given.values()])
        print(*rows[-1], sep=" | ", flush=True)
    if not chosen:
        harness.write("benchmarks/pages/mutants.md", harness.table("<mutant|<" + "|<".join(SCENES), rows), "measured")


if __name__ == "__main__":
    if sys.argv[1:] == ["--answers"]:
        print(json.dumps(answers()))
    else:
        main([int(text) for text in sys.argv[1:]])
