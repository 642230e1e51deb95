"""What the command line says where compiled code cannot be kept: one line, and the answer all the same."""

import sys
import warnings
from types import SimpleNamespace

import click
from click.testing import CliRunner

from tline.cli.main import COMMANDS, main
from tline.compiled import object_code


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
