"""The surface of `tline line`: what it prints, refuses and imports, and that its help is true."""

import cmath
import inspect
import json
import re
import shlex
import subprocess
import sys

import pytest
from click.testing import CliRunner, Result

from tline import ElectricalLine, HydraulicLine
from tline.cli.line import EARTH, MATERIALS, line
from tline.cli.main import COMMANDS, main

LINES = pytest.mark.parametrize("kind", [HydraulicLine, ElectricalLine])
HEAVY = {"numpy", "scipy", "numba", "pydantic", "pint", "matplotlib"}


def run(*arguments: str) -> Result:
    return CliRunner().invoke(main, list(arguments))


def test_the_pipe_of_the_exercise() -> None:
    result = run("line", "hydraulic", "--radius", "10 cm", "--wave-speed", "1500", "--density", "980")
    assert result.exit_code == 0
    assert result.stderr == ""
    rows = [re.split(r"\s{2,}", row) for row in result.stdout.splitlines()]
    assert ["bulk_modulus", "K", "2.205e+09 Pa", "22050 bar"] in rows
    assert ["z0", "z0", "4.67916e+07 Pa s/m^3", "467.9 bar/(m^3/s)"] in rows
    assert rows[-2:] == [["effort: pressure in Pa"], ["flow:", "volume flow in m^3/s"]]
    assert not any(row[0] == "delay" for row in rows)  # it does not follow


def test_the_overhead_line_of_the_exercise() -> None:
    result = run("line", "electrical", "--wave-speed", "3e8", "--z0", "300")
    assert result.exit_code == 0
    assert re.search(r"^inductance +L' +1e-06 H/m +1 µH/m$", result.stdout, re.MULTILINE)
    assert re.search(r"^capacitance +C' +1\.11111e-11 F/m +11\.11 pF/m$", result.stdout, re.MULTILINE)
    assert "effort: voltage in V\nflow:   current in A\n" in result.stdout


OVERHEAD = ("line", "electrical", "--height", "10 m", "--wire-diameter", "2 cm", "--earth", "100 ohm m")


def test_an_overhead_line_over_earth() -> None:
    result = run(*OVERHEAD, "--wire-resistance", "0.1 ohm/km")
    assert (result.exit_code, result.stderr) == (0, "")
    rows = [re.split(r"\s{2,}", row) for row in result.stdout.splitlines()]
    assert ["z0", "z0", "455.739 ohm", "455.7 ohm"] in rows
    assert ["wave_speed", "c", "2.99792e+08 m/s", "29.98 cm/ns"] in rows
    assert ["50 Hz", "149.3 mohm/km", "2.357 µH/m", "0.001137 dB/km", "239600 km/s"] in rows


def test_json_of_an_overhead_line_is_deris_impedance() -> None:
    told = json.loads(run(*OVERHEAD, "--json").stdout)
    assert told["z0"] == ElectricalLine(height=10, wire_diameter=0.02, velocity_factor=1).z0
    for row in told["over_earth"]:
        s = 2j * cmath.pi * row["frequency"]
        mirror = 10 + cmath.sqrt(100 / (s * 4e-7 * cmath.pi))
        z = s * 2e-7 * cmath.log(2 * mirror / 0.01)
        assert row["resistance"] + s * row["inductance"] == pytest.approx(z, rel=1e-6)
        gamma = cmath.sqrt(z * s * told["capacitance"])
        assert row["attenuation"] == pytest.approx(gamma.real * 8.685889638, rel=1e-6)
        assert row["wave_speed"] == pytest.approx(s.imag / gamma.imag, rel=1e-6)


def test_the_table_is_aligned() -> None:
    rows = run("line", "hydraulic", "--radius", "10 cm", "--fluid", "water").stdout.split("\n\n")[0].splitlines()
    assert {row.index(row.split()[1], len(row.split()[0])) for row in rows} == {rows[0].index("symbol")}


def test_json_has_every_quantity_in_full_precision() -> None:
    result = run("line", "hydraulic", "--radius", "10 cm", "--wave-speed", "1500", "--density", "980", "--json")
    expected = HydraulicLine(radius=0.1, wave_speed=1500, density=980)
    quantities = {item.name: getattr(expected, item.name) for item in HydraulicLine.quantities}
    assert json.loads(result.stdout) == quantities | {"notes": []}
    assert json.loads(result.stdout)["delay"] is None
    result = run("line", "electrical", "--z0", "50", "--velocity-factor", "66 %", "--json")
    assert json.loads(result.stdout)["inductance"] == ElectricalLine(z0=50, velocity_factor=0.66).inductance


def test_what_is_hardly_meant_is_a_note_and_in_json() -> None:
    result = run("line", "hydraulic", "--radius", "10", "--wave-speed", "1500", "--density", "980", "--json")
    note = "radius: 10 m is outside what is built, 50 µm to 8 m: meant 10 cm?"
    assert (result.exit_code, result.stderr) == (0, f"note: {note}\n")
    assert json.loads(result.stdout)["notes"] == [note]


MISTAKES = [
    ("hydraulic", "hydraulic line: z0 and wave_speed or delay cannot be found, add for example wave_speed with z0"),
    ("hydraulic --radius 1 --density 1000", "hydraulic line: z0 and wave_speed or delay cannot be found, add wave_"),
    (
        "hydraulic --radius 1 --diameter 3",
        "hydraulic line: radius and diameter clash: 2*radius gives 2 m but diameter is 3 m, 33.3 % apart",
    ),
    ("hydraulic --radius -1", "--radius: not positive, expected more than 0, got '-1'"),
    ("hydraulic --radius=-1m", "--radius: not positive, expected more than 0, got '-1m'"),
    ("hydraulic --radius 0", "--radius: not positive, expected more than 0, got '0'"),
    ("hydraulic --wave-speed nan", "--wave-speed: not a finite number, expected a speed such as '1 m/s', got 'nan'"),
    ("hydraulic --wave-speed inf", "--wave-speed: not a finite number, expected a speed such as '1 m/s', got 'inf'"),
    ("hydraulic --radius '10 s'", "--radius: this unit measures something else, expected a length such as '1 m', got"),
    ("hydraulic --radius '10 cn'", "--radius: unknown unit 'cn', expected"),
    ("hydraulic --radius ''", "--radius: there is no number in front, expected a length such as '1 m', got ''"),
    ("hydraulic --radius 1 --fluid watr", "--fluid: unknown fluid, expected 'water' (known are 'water' or 'hydraulic"),
    (
        "hydraulic --radius 1 --fluid water --temperature '15 C'",
        "--temperature: C is the coulomb, expected a temperature such as '20 degC' or '300 K', got '15 C'",
    ),
    ("hydraulic --radius 1 --fluid water --temperature 20", "--temperature: no liquid water at 0.1 MPa, expected"),
    ("electrical --inner-diameter 1 --spacing 2", "electrical line: not one complete geometry, expected"),
    ("electrical --wire-diameter 1 --spacing 1", "--spacing: the conductors touch or overlap, expected more than 1 m"),
    (
        "electrical --wire-diameter '2 cm' --height '5 mm' --earth 100",
        "--height: the conductors touch or overlap, expected more than 0.01 m",
    ),
    ("electrical --wire-diameter '2 cm' --height '10 m' --earth='-100 ohm m'", "--earth: not positive, expected"),
    ("electrical --wire-diameter '2 cm' --height '10 m' --earth ''", "--earth: there is no number in front"),
    (
        "electrical --wire-diameter '2 cm' --height '10 m' --earth 100 --z0 300",
        "--z0: follows from height and wire_diameter in air, too",
    ),
    ("electrical --z0 300 --earth 100", "--earth: is below a wire over ground, expected --height and --wire-diameter"),
    ("electrical --z0 50 --wire-resistance 1", "--wire-resistance: is of a wire over earth, expected --earth, too"),
    ("electrical --z0 50 --wave-speed 4e8", "--wave-speed: the wave would be faster than light, expected"),
]


@pytest.mark.parametrize(("arguments", "sentence"), MISTAKES)
def test_a_mistake_is_one_sentence_on_stderr_and_exit_2(arguments: str, sentence: str) -> None:
    result = run("line", *shlex.split(arguments))
    assert result.exit_code == 2
    assert result.stdout == ""
    assert result.stderr.startswith(sentence)
    assert result.stderr.count("\n") == 1


def test_what_is_odd_is_a_note_on_stderr() -> None:
    result = run("line", "hydraulic", "--radius", "10 cm", "--fluid", "water", "--density", "1000", "--json")
    assert (result.exit_code, json.loads(result.stdout)["density"]) == (0, 1000)
    assert result.stderr == "note: density: 1000 kg/m^3 as given, instead of 998.207 kg/m^3 of the fluid\n"


@pytest.mark.parametrize("arguments", ["--radios 1", "--radius", "extra", "--json yes"])
def test_wrong_usage_exits_2(arguments: str) -> None:
    result = run("line", "hydraulic", *shlex.split(arguments))
    assert result.exit_code == 2
    assert result.stdout == ""
    assert "Error: " in result.stderr


def test_an_unknown_command_exits_2() -> None:
    result = run("lines")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "No such command 'lines'" in result.stderr


@LINES
def test_the_constructor_the_options_and_the_table_are_the_same(kind: type[HydraulicLine | ElectricalLine]) -> None:
    arguments = list(inspect.signature(kind).parameters)
    name, words, more = ("hydraulic", [*MATERIALS], []) if kind is HydraulicLine else ("electrical", [], [*EARTH])
    assert arguments == [item.name for item in kind.quantities] + words
    options = [option.name for option in line.commands[name].params]
    assert options == [*arguments, *(item.name for item in more), "as_json"]


@LINES
def test_every_argument_is_documented_and_no_other(kind: type[HydraulicLine | ElectricalLine]) -> None:
    text = inspect.getdoc(kind) or ""
    section = text.split("Parameters\n----------\n")[1].split("\n\n")[0]
    named = [name for names in re.findall(r"^(\S.*) : ", section, re.MULTILINE) for name in names.split(", ")]
    assert sorted(named) == sorted(inspect.signature(kind).parameters)


def _imported_by(arguments: list[str]) -> tuple[int, set[str]]:
    code = (
        "import sys\nfrom tline.cli.main import main\n"
        f"try:\n    main({arguments!r})\nexcept SystemExit as end:\n    status = end.code\n"
        "print(*sys.modules, file=sys.stderr)\nsys.exit(status)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    return done.returncode, {name.partition(".")[0] for name in done.stderr.split()} | set(done.stderr.split())


def test_the_calculator_imports_nothing_heavy() -> None:
    status, modules = _imported_by(["line", "hydraulic", "--radius", "10 cm", "--fluid", "water", "--json"])
    assert status == 0
    assert not modules & HEAVY
    assert "tline.cli.line" in modules


@pytest.mark.parametrize("arguments", [["--help"], ["--version"]])
def test_the_overview_imports_no_subcommand(arguments: list[str]) -> None:
    status, modules = _imported_by(arguments)
    assert status == 0
    assert not modules & HEAVY
    assert not {target.partition(":")[0] for target, _ in COMMANDS.values()} & modules


def test_the_overview_lists_every_command() -> None:
    result = run("--help")
    assert result.exit_code == 0
    for name, (_, summary) in COMMANDS.items():
        assert name in result.stdout
        assert summary.split()[0] in result.stdout


def test_version() -> None:
    result = run("--version")
    assert result.exit_code == 0
    assert re.fullmatch(r"tline \d+\.\d+\.\d+\S*\n", result.stdout)


@pytest.mark.parametrize("arguments", ["line hydraulic --help", "line hydraulic --radius '1 Ω'"])
def test_a_terminal_without_greek_letters_shows_question_marks(arguments: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", "from tline.cli.main import main; main()", *shlex.split(arguments)],
        capture_output=True,
        env={"PYTHONIOENCODING": "cp1252"},
        check=False,
    )
    assert b"Traceback" not in done.stderr
    assert b"?" in done.stdout + done.stderr
