"""Limits and exits of docs/trust.md: where input, output and the program end, and what is said then."""

import json
import os
import re
import subprocess
import sys
import warnings
from pathlib import Path
from types import SimpleNamespace

import click
import pytest
from click.testing import CliRunner
from command_line import call, tline

from passivity.expression.parse import MAX_CHARACTERS, MAX_DEPTH, MAX_DIGITS, MAX_EXPONENT
from passivity.rational.matrix import MAX_PORTS
from passivity.sampled.read import MAX_BYTES, MAX_LINE
from tline.cli.main import COMMANDS, main
from tline.compiled import object_code
from tline.frequency.response import MOST_POINTS
from tline.interchange.deck import DEEPEST, MOST_CARDS
from tline.scene.mistakes import MOST_MISTAKES
from tline.scene.quantity import LARGEST as LARGEST_NUMBER
from tline.scene.text_file import LARGEST_FILE
from tline.scene.waveform import MOST_PULSES
from tline.solver.description import resolution
from tline.solver.tolerance import ladder
from tline.sweeps.design import MOST_RUNS

PAGE = (Path(__file__).parents[2] / "docs" / "trust.md").read_text(encoding="utf-8")
SCENE = str(Path(__file__).parents[2] / "scenes" / "cable_rc.toml")


def test_the_limits_on_the_page_are_those_of_the_program():
    table = dict(re.findall(r"^\| (.*?) \| (.*?) \|$", PAGE.partition("## Limits")[2], re.MULTILINE))
    assert table["a scene, table or netlist"] == f"{LARGEST_FILE:,} bytes"
    assert (
        table["a Touchstone file, or samples for `tline passivity`"] == f"{MAX_BYTES:,} bytes, {MAX_LINE:,} in a line"
    )
    assert table["elements of a netlist, subcircuits opened"] == f"{MOST_CARDS:,}, {DEEPEST} subcircuits in each other"
    expression = (
        f"{MAX_CHARACTERS:,} characters, {MAX_DEPTH} levels, powers to {MAX_EXPONENT}, numbers of {MAX_DIGITS:,} digits"
    )
    assert table["an expression"] == expression
    assert table["a matrix"] == f"{MAX_PORTS} ports"
    assert table["a number of a scene"].startswith(f"{LARGEST_NUMBER:g} in size")
    assert table["slabs of a run"] == f"{int(resolution.MOST_SLABS):,}"
    assert table["samples on the lines at once"] == f"{int(resolution.LARGEST):,}"
    assert table["pulses before the end of a run"] == f"{MOST_PULSES:,}"
    assert table["runs of a sweep"] == f"{MOST_RUNS:,}"
    assert table["frequencies of `tline frequency`"] == f"{MOST_POINTS:,}"
    assert table["mistakes of a scene that are told"] == f"{MOST_MISTAKES}"
    assert f"{int(ladder.MOST_SAMPLES):,} line-end samples or {ladder.MOST_SECONDS} s" in PAGE
    assert len(table) == 13  # and the heading


def test_a_closed_or_full_stderr_changes_nothing():
    closed = {"preexec_fn": lambda: os.close(2), "stderr": None}
    done = tline("run", SCENE, "--json", stdout=subprocess.PIPE, **closed)
    assert (done.returncode, json.loads(done.stdout)["medium"]) == (0, "electrical")
    assert tline("run", "none.toml", stdout=subprocess.PIPE, **closed).returncode == 2
    with open("/dev/full", "w") as full:
        assert tline("run", "none.toml", stdout=subprocess.PIPE, stderr=full).returncode == 2


def test_output_that_cannot_be_printed_is_said():
    with open("/dev/full", "w") as full:
        done = tline("schema", stdout=full)
        assert (done.returncode, done.stderr) == (2, "output: cannot be written, got no space left on device\n")
    done = tline("schema", preexec_fn=lambda: os.close(1))
    assert (done.returncode, done.stderr) == (2, "output: cannot be written, got bad file descriptor\n")


@pytest.mark.parametrize("args", [("schema",), ("--help",)])
def test_a_reader_who_leaves_early_is_no_mistake(args):
    reading, writing = os.pipe()
    os.close(reading)
    done = tline(*args, stdout=writing)
    os.close(writing)
    assert (done.returncode, done.stderr) == (141, "")


def test_an_interrupted_run_says_so(monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("tline.interchange.any_file.read", interrupted)
    result = call("export", SCENE)
    assert (result.exit_code, result.stderr.strip()) == (130, "interrupted")


def test_too_little_memory_is_said(monkeypatch):
    def too_large(*_, **__):
        raise MemoryError

    monkeypatch.setattr("tline.interchange.any_file.read", too_large)
    result = call("export", SCENE)
    assert (result.exit_code, result.stderr) == (
        2,
        "memory: there is not enough of it for this, expected a smaller input\n",
    )


def test_a_fault_of_the_program_is_no_answer(monkeypatch):
    monkeypatch.setattr("tline.interchange.any_file.read", lambda *_, **__: 1 / 0)
    result = call("export", SCENE)
    assert result.exit_code == 70
    assert re.match("tline: a fault of the program, please report it with the command: ZeroDivision", result.stderr)


SCENES = Path(__file__).parents[2] / "scenes"


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (["--version"], 0, "tline "),
        (["line", "electrical", "--wave-speed", "3e8", "--z0", "300"], 0, "z0"),
        (["run", "no-such-scene.toml"], 2, ""),
        (["passivity", "s - 1"], 1, "refuted"),
    ],
)
def test_exit_code_and_output(arguments, code, said):
    done = subprocess.run([sys.executable, "-m", "tline", *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == code, done.stderr
    assert said.lower() in done.stdout.lower()
    assert "Traceback" not in done.stderr


def test_a_long_output_into_a_pipe_is_whole():
    command = [sys.executable, "-m", "tline", "run", str(SCENES / "cable_rc.toml"), "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.endswith("}\n")


@click.command()
def compiling() -> None:
    """A command whose kernels find no folder, twice."""
    object_code._not_kept("no folder for it can be written")
    object_code._not_kept("no folder for it can be written")
    click.echo("42")


def test_one_line_beside_the_answer(monkeypatch):
    monkeypatch.setattr(object_code, "_said", set())
    monkeypatch.setitem(sys.modules, "compiling", SimpleNamespace(compiling=compiling))
    monkeypatch.setitem(COMMANDS, "compiling", ("compiling:compiling", ""))
    shown = warnings.showwarning
    done = CliRunner().invoke(main, ["compiling"], catch_exceptions=False)
    assert done.exit_code == 0
    assert done.stdout == "42\n"
    said = "note: compiled code is not kept, so every process compiles anew: no folder for it can be written\n"
    assert done.stderr == said
    assert warnings.showwarning is shown
