"""Options of commands follow from functions; numbers beyond all measure get an answer, or a sentence."""

import json
from itertools import cycle
from pathlib import Path
from typing import Any

import click
import pytest
from click.testing import CliRunner

from tline.cli.docstrings import REQUIRED, arguments_of, documented_in, without_sections
from tline.cli.from_signature import Output, command, table
from tline.cli.main import main
from tline.errors import InputError

PLACES = {
    "tline.surge.operation:operate": ("wave_speed", "In the pipes of an .inp file without a material; 1000"),
    "tline.design.closure:closure": ("path", "Nodes between which all places keep the limits"),  # "as of" another
    "tline.sweeps.runs:sweep": ("tol", "Largest error of effort and flow"),
    "friction.testbench:Testbench": ("mass", "Mass [kg], positive."),
}


@pytest.mark.parametrize(("source", "argument", "words"), [(key, *each) for key, each in PLACES.items()])
def test_help_is_what_the_function_or_the_one_it_refers_to_says(source: str, argument: str, words: str) -> None:
    assert arguments_of(source)[argument].help.startswith(words)


def test_defaults_are_values_also_where_a_constant_names_them() -> None:
    found = arguments_of("tline.signal.tdr:reflectometry")
    assert (found["tol"].default, found["node"].default, found["z0"].default) == (1e-6, REQUIRED, None)
    assert arguments_of("friction.testbench:Testbench")["v0"].default == 0.0


def test_a_docstring_is_cut_at_its_sections() -> None:
    entries = "a, b : NUMBER\n    Two\n    `numbers`.\nc\n    A flag."
    text = f"What.\n\nMore of it.\n\nParameters\n----------\n{entries}\n\nReturns\n-------\nfloat"
    assert without_sections(text) == "What.\n\nMore of it."
    found = documented_in(text)
    assert {name: (each.help, each.kind) for name, each in found.items()} == {
        "a": ("Two numbers.", "NUMBER"), "b": ("Two numbers.", "NUMBER"), "c": ("A flag.", ""),
    }  # fmt: skip


@command(
    "friction.simulation:simulate",
    names={"h": "step"},
    omit=("model", "bench", "budget"),
    files={"csv": table("Numbers")},
)
def measure(place: str, *, often: tuple[str, ...] = (), steady: bool = True, **given: Any) -> Output:
    """Measure something.

    Parameters
    ----------
    often : WORD
        May be repeated.
    steady
        Wait for it.
    """
    with measure.named():
        if place == "nowhere":
            raise InputError("t_end", "is wrong", "another")
    told = {"place": place, "often": often, "steady": steady, "given": given, "si": measure.in_si(given)}
    return Output(["told"], lambda: told, {"csv": lambda file: Path(file).write_text("1")}, ["odd"], 1)


def run(*words: str) -> Any:
    return CliRunner().invoke(measure, [*words], standalone_mode=False)


def test_only_what_is_given_is_passed_on_and_units_are_those_of_the_docstring() -> None:
    seen = CliRunner().invoke(
        measure, ["here", "--often", "a", "--often", "b", "--step", "3 ms", "--no-steady", "--json"]
    )
    assert seen.exit_code == 1
    assert seen.stderr == "note: odd\n"
    assert '"given": {\n    "h": "3 ms"\n  }' in seen.stdout
    assert '"si": {\n    "h": 0.003\n  }' in seen.stdout
    assert '"steady": false' in seen.stdout


def test_files_are_checked_written_and_named(tmp_path: Path) -> None:
    seen = CliRunner().invoke(measure, ["here", "--csv", str(tmp_path / "a.csv")])
    assert seen.stdout == f"told\nwrote {tmp_path / 'a.csv'}\n"
    assert (tmp_path / "a.csv").read_text() == "1"
    assert str(run("here", "--csv", "a.txt").exception) == "--csv: unknown kind of file, expected .csv, got 'a.txt'"


def test_errors_name_options_and_not_arguments() -> None:
    assert str(run("nowhere").exception) == "--t-end: is wrong, expected another"


def _commands(group: click.Group) -> list[click.Command]:
    inner = [group.get_command(click.Context(group), name) for name in group.list_commands(click.Context(group))]
    return [one for each in inner if each for one in (_commands(each) if isinstance(each, click.Group) else [each])]


def test_every_option_of_every_command_is_explained_in_a_sentence() -> None:
    found = [(each.name, param) for each in _commands(main) for param in each.params if isinstance(param, click.Option)]
    assert len(found) > 250
    for name, option in found:
        assert option.help, (name, option.name)
        assert option.help.endswith("."), (name, option.name)
        assert "`" not in option.help.replace("`tline run`", ""), (name, option.name)


HUGE = [
    ("sech(1e400)", (0, 3)),
    ("1-coth(1e308)", (1, 3)),
    ("s*exp(1e30)", (0,)),
    ("csch(coth(4 pF))", (0,)),
    ("s + exp(-1e10)", (0,)),
    ("exp(exp(100))*s", (0, 2, 3)),
    ("1/(s + exp(-1e30))", (0, 3)),
    ("sqrt(exp(1e9) + s)", (0, 3)),
    ("log(exp(1e9)) + s", (0, 3)),
    ("exp(-1e308*s)", (1,)),
    ("((exp(-s) + 2)^200)^200", (1, 2, 3)),
    ("1/(1e308)^40+1", (0,)),
    ("(1e308)^200^2", (2,)),
    ("((1e308 + s)^200)^2", (2,)),
    ("1e400*s^2 + 1e-400*s + 1", (1,)),
    ("[1e308, s; s, 1e308]", (1,)),
    ("[(1e308)^40, 0; 0, 1e-308*s]", (0,)),
    ("[10, s, s; (2e100)^-200, s*s, 1n; 9e300 - s, s, 9e50]", (1, 3)),
]


@pytest.mark.parametrize(
    ("text", "statuses", "options"), [(*row, how) for row, how in zip(HUGE, cycle([[], ["--json"]]), strict=False)]
)
def test_huge_numbers_are_answered(text, statuses, options):
    result = CliRunner().invoke(main, ["passivity", text, *options])
    assert result.exit_code in statuses, result.output
    if options and result.exit_code != 2:
        assert json.loads(result.stdout)["status"]


def test_a_count_of_pulses_beyond_doubles_is_refused():
    from tline.scene.waveform import Pulses

    with pytest.raises(ValueError, match="not a whole number in range, expected one of at most 2\\^53"):
        Pulses.model_validate({"high": 1, "width": 1e-9, "period": 3e-9, "count": 10**400})
