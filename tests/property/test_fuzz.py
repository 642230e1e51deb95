"""Hostile input through every door, as many as seconds allow; `python -m benchmarks.fuzz` takes a million."""

from importlib import import_module
from pathlib import Path

import pytest

from benchmarks.fuzz.case import Case
from benchmarks.fuzz.doors import DOORS, case_of
from benchmarks.fuzz.judge import verdict
from benchmarks.fuzz.warm import LOWER

SEED = 5
CASES = dict.fromkeys(DOORS, 60) | {"scenes": 20, "matrices": 20, "touchstone": 10, "flags": 10} | {
    "friction": 8, "drives": 8,
}  # fmt: skip


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where the commands run, with limits at which what is legitimately long is refused."""
    monkeypatch.chdir(tmp_path)
    for (module, name), limit in LOWER.items():
        monkeypatch.setattr(import_module(module), name, limit)
    return tmp_path


@pytest.mark.parametrize("door", DOORS)
@pytest.mark.filterwarnings("default")  # a command shows none, whatever its input
def test_input_is_answered_or_refused_in_a_sentence_and_touches_nothing_else(door, folder):
    for index in range(CASES[door]):
        assert not verdict(case_of(SEED, door, index), folder), f"--seed {SEED} --door {door} --first {index}"


def test_a_case_is_the_same_whatever_ran_before():
    assert case_of(1, "scenes", 3) == case_of(1, "scenes", 3) != case_of(2, "scenes", 3)


@pytest.mark.parametrize(
    ("case", "said"),
    [
        (Case(["schema", "-o", "other"], {}, frozenset({"out"})), "file 'other' was written"),
        (Case(["schema", "-o", "../other"]), "os.rename"),
        (Case(["schema", "-o", "in"], {"in": b"mine"}), "file 'in' was written"),
    ],
)
def test_the_judge_sees_files_that_nobody_asked_for(case, said, folder):
    inside = folder / "inside"
    inside.mkdir()
    assert said in " ".join(_judged(case, inside))


@pytest.mark.parametrize(
    ("done", "said"),
    [
        (lambda: 1 / 0, "exit status 70"),
        (lambda: exec("import os; os.system('true')"), "os.system"),
        (
            lambda: Path("/dev/shm/x").write_text("") if Path("/dev/shm").exists() else Path("../x").write_text(""),
            "opened",
        ),
    ],
)
def test_the_judge_sees_what_a_command_does(done, said, folder, monkeypatch):
    inside = folder / "inside"
    inside.mkdir()
    monkeypatch.setattr("tline.scene.file.schema", lambda: done() or {})
    found = " ".join(_judged(Case(["schema"]), inside))
    assert said in found


def _judged(case: Case, folder: Path) -> list[str]:
    import os

    here = os.getcwd()
    os.chdir(folder)
    try:
        return verdict(case, folder)
    finally:
        os.chdir(here)
