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
import tomllib
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


DATA = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
MUTANTS = [Mutant(**each) for each in DATA["mutants"]]
SCENES: dict[str, dict[str, Any]] = DATA["scenes"]


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
