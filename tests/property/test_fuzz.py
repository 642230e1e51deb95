"""Hostile input through every door, as many as seconds allow; `python tests/fuzz_commands.py` takes a million."""

from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

import click
import pytest
from fuzz import flags, scenes, warm
from fuzz.case import Case
from fuzz.doors import DOORS, case_of
from fuzz.judge import verdict
from fuzz.warm import LOWER

from tline.cli.main import main

SEED = 5
CASES = dict.fromkeys(DOORS, 60) | {"scenes": 20, "matrices": 20, "touchstone": 10, "flags": 10} | {
    "friction": 8, "drives": 8,
}  # fmt: skip


@pytest.fixture(autouse=True)
def folder(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where the commands run, with limits at which what is legitimately long is refused."""
    for (module, name), limit in LOWER.items():
        monkeypatch.setattr(import_module(module), name, limit)
    return folder


@pytest.mark.parametrize("door", DOORS)
@pytest.mark.filterwarnings("default")  # a command shows none, whatever its input
def test_input_is_answered_or_refused_in_a_sentence_and_touches_nothing_else(door, folder):
    for index in range(CASES[door]):
        assert not verdict(case_of(SEED, door, index), folder), f"--seed {SEED} --door {door} --first {index}"


def test_all_commands_are_driven_and_none_that_are_gone():
    """By the tree of commands itself: each with its options, and each that reads a scene with scenes."""
    tree = set(_leaves((), main))
    assert set(flags.commands()) == tree
    begun = {case_of(SEED, "flags", index).args[0] for index in range(1000)}
    assert begun >= {words[0] for words in tree}
    listed = [*scenes.COMMANDS, *scenes.RARE, *warm.COMMANDS]
    assert {tuple(each[:1]) for each in listed} <= {words[:1] for words in tree}
    reading = {
        words for words, command in flags.commands().items() if "scene" in [each.name for each in command.params]
    }
    driven = {words for words in tree for each in scenes.COMMANDS if tuple(each[: len(words)]) == words}
    assert reading - {("chart", "peers"), ("chart", "work-precision")} <= driven  # charts measure for minutes


def _leaves(words: tuple[str, ...], command: click.Command) -> Iterator[tuple[str, ...]]:
    if not isinstance(command, click.Group):
        yield words
        return
    for name in command.list_commands(click.Context(command)):
        inner = command.get_command(click.Context(command), name)
        assert inner is not None
        yield from _leaves((*words, name), inner)


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
