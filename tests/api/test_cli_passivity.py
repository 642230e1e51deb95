"""`tline passivity`: texts, exit codes, numbers in full, files."""

import json
import re
import shlex
import subprocess
import sys
import time
from fractions import Fraction
from pathlib import Path

import pytest
from click.testing import CliRunner
from matplotlib.image import imread

from passivity import RationalFunction, check_bounded_real, check_positive_real
from passivity.exact.picture import draw_verdict
from tline.cli.main import main

TOUCHING, NEGATIVE = "(s^2 + s + 1)/(s^2 + s + 4)", "(s + 2)/(s^2 + s + 1)"


def run(*arguments):
    return CliRunner().invoke(main, ["passivity", *arguments], catch_exceptions=False)


@pytest.mark.parametrize(
    ("arguments", "status", "words"),
    [
        (
            "'R + s*L + 1/(s*C)' --param R='50 ohm' --param L='10 nH' --param C=4p --z0 50",
            0,
            "smallest Re Z(jω)    = 50 ",
        ),
        (f"'{TOUCHING}'", 0, "Re Z(jω) >= 0 for all ω (equal at ω = 1.41421)"),
        (f"'{TOUCHING}' --within 1e-9", 0, "not the same for all"),
        (f"'{TOUCHING}' --within 0", 0, "each coefficient: the same"),
        (f"'{NEGATIVE}'", 1, "witness s = 1/4 + 2j\n    Z(s) = -12/4153 - 3104/4153j"),
        (f"'{NEGATIVE} + 0.155'", 0, "proved"),
        (f"'{NEGATIVE} + 0.154'", 1, "refuted"),
        ("'(1 - s)/(1 + s)' --kind br", 0, "bounded real: proved"),
        ("'(1 - s)/(1 + s)' --kind br", 0, "= 1            for all ω"),
        ("2 --kind br", 1, "H(s) = 2 + 0j"),
        ("1/0 --kind br", 1, "H(s) = infinite"),
        ("1/0", 0, "positive real: proved"),
        ("'25 + 1n*s' --z0 50 --delay '3 ns'", 0, "G1 = (1 - H1)/(1 + H1) is positive real: proved"),
        ("--delay 1 '(s + 3)/(s - 1)'", 1, "because |H1(s)| > 1 at s = 0.125 + 0j"),
        ("-s", 1, "pole at infinity with negative residue"),
        ("'1.000000000001*s/(s^2 + s + 1)' --kind br", 1, "= 1 + 1e-12"),
        ("'(s - 1)/(s - 1)'", 0, "common factor s - 1 is a hidden mode"),
        ("s+1e400", 0, "smallest Re Z(jω)    = 1e+400 "),
        ("s-1e400", 1, "Z(s) = -1e+400 + 0j"),
        ("s-1e-400", 1, "largest |H(jω)|      = 1 + 2e-400 "),
        ("s*1e-400+1e400", 0, "smallest Re Z(jω)    = 1e+400 "),
        ("1/(s+1e400)", 0, "smallest Re 1/Z(jω)  = 1e+400 "),
        ("'s+1e400/s-1'", 1, "smallest Re 1/Z(jω)  = -1           at ω = 1e+200 rad/s"),
        ("R --param 'R = 1e400'", 0, "= 1e+400"),
        ("'sqrt(s)-1e400'", 3, "undecided"),
        ("'2+exp(-s)/2+s*1e-400*exp(-s)/(1+s)^2*log(-2)'", 3, "not known to be real"),
        ("s --z0 1 --delay 1e400", 0, "delay T = 1e+400:"),
        ("s --z0 1e400", 0, "z0 = 1e400"),
        ("-s-1 --z0 1 --delay 1e400", 1, "delay T = 1e+400:"),
        ("s-1 --z0 1e400 --delay 1", 1, "z0 = 1e+400"),
        ("'[s,0;0,-1e400]'", 1, "= -2e+400"),
        ("'[s,0;0,-1e-400]'", 1, "= -2e-400"),
        ("s --within '5 %'", 0, "within 0.05 of each coefficient: the same"),
    ],
)
def test_answers(arguments, status, words):
    result = run(*shlex.split(arguments))
    assert words in result.output
    assert (result.exit_code, result.stderr) == (status, "")
    assert run(*shlex.split(arguments), "--json").exit_code == status


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ("'s +'", "column 4: the expression ends too early, expected a number, a name or '('"),
        ("'s + R'", "--param R: no value and no assumption, expected one for each of R"),
        ("s --param R=1", "--param R: not in the expression"),
        ("s+R --param R", "--param: not a name with a value, expected NAME=VALUE such as R='50 ohm', got 'R'"),
        ("s+R --param R=1 --param R=2", "--param R: given twice"),
        ("s+R --param R=abc", "--param R: not a number"),
        ("s --z0 0", "--z0: not positive, expected more than 0, got 0"),
        ("s --z0 x", "--z0: not a number"),
        ("s --delay=-1", "--delay: negative"),
        ("s --kind br --delay 1", "--delay: says nothing about reflections"),
        ("s --within 1", "--within: out of range"),
        ("s --kind br --within 0", "--within: says nothing about reflections"),
        ("s --kind br --z0 50", "--z0: says nothing about reflections"),
        ("s --error 1", "--error: says nothing about expressions"),
        ("s --within ''", "--within, column 1: the expression ends too early"),
        ("s --within 200%", "--within: out of range, expected at least 0 and below 1, got 2"),
        ("s --z0 ''", "--z0, column 1: the expression ends too early"),
        ("s --delay ''", "--delay, column 1: the expression ends too early"),
        ("R --param 'R>'", "--param R>, column 1: the expression ends too early"),
        ("pi*s", "--param pi: no value and no assumption, expected a rational number for it, such as pi=3.14"),
        ("-" * 9000 + "s", "column 102: nested too deeply"),
        ("s+1e400 --plot a.png", "coefficients: too far apart for floats"),
        ("s --z0 1e400 --plot a.png", "--z0: too large or too small to be drawn"),
        ("s --kind chain --z0 1 --delay 1 --plot a.png", "--plot: there is no picture of this"),
        ("'s + R' --param 'R>0' --delay 1", "--delay: says nothing about functions with names"),
        ("'exp(-s)' --delay 1", "--delay: says nothing about functions that are not rational"),
        ("'[s, 1; 2]'", "matrix, row 2: not square, expected 2 entries, got 1"),
        ("'[s, 1'", "matrix: its last bracket is missing"),
        ("'R + exp(-s)' --param 'R>0' --plot a.png", "--plot: there is no picture of this"),
        ("none.toml", "none.toml: cannot be read"),
        ("none.csv", "none.csv: cannot be read"),
        ("none.s2p", "none.s2p: cannot be read"),
        ("s --nearest model.txt", "--nearest: unknown kind of file, expected .json"),
        ("0/0", "expression: 0/0 has no value"),
        ("'tan(s)'", "column 1: unknown function"),
        ("s.real", "column 2: this character has no meaning here"),
        ("s --plot a.txt", "--plot: unknown kind of file, expected .png or .svg or .pdf, got 'a.txt'"),
        ("s --plot /nowhere/a.png", "/nowhere/a.png: cannot be written"),
    ],
)
def test_a_mistake_is_one_sentence_and_exit_2(arguments, sentence):
    result = run(*shlex.split(arguments))
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr.startswith(sentence)
    assert result.stderr.count("\n") == 1


@pytest.mark.parametrize(
    ("file", "text", "arguments", "sentence"),
    [
        ("one.csv", "f,re,im\n1,-1,0\n", "--error 1e400", "--error: not a number of reasonable size"),
        ("one.csv", "f,re,im\n1,-1,0\n", "--error ''", "--error, column 1: the expression ends too early"),
        ("one.csv", "f,re,im\n1,-1,0\n", "--z0 1e400", "--z0: not a number of reasonable size"),
        (
            "two.csv",
            "f,re,im\n1,1,0\n2,1,0\n",
            "--nearest m.json",
            "response: too few samples for a model, expected at ",
        ),
        ("no.s1p", "", "", "no.s1p: not a Touchstone file, expected samples, Touchstone version 1 or 2\n"),
    ],
)
def test_a_mistake_about_samples(file, text, arguments, sentence, folder):
    (folder / file).write_text(text, encoding="utf-8")
    result = run(file, *shlex.split(arguments))
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr.startswith(sentence)


def test_a_long_option_that_does_not_exist_is_not_echoed():
    result = run("--" + "a" * 9000)
    assert result.exit_code == 2
    assert len(result.stderr) < 300


def test_a_verdict_is_printed_without_its_margins(monkeypatch):
    monkeypatch.setattr("passivity.polynomial.infimum.MAX_ROUNDS", 0)
    result = run(NEGATIVE)
    assert result.exit_code == 1
    assert "witness s = 1/4 + 2j" in result.stdout
    assert "margins not found: the smallest value of a function of degree 2 takes over 0 tests" in result.stdout


def test_a_fault_of_the_program_is_no_answer(monkeypatch):
    def fails(*_):
        raise ZeroDivisionError("by\nzero")

    monkeypatch.setattr("passivity.report.reason", fails)
    result = run("s")
    assert (result.exit_code, result.stdout) == (70, "")
    assert re.fullmatch(r"tline: a fault of the program, please report .*: ZeroDivisionError in line \d+ of "
                        r"test_cli_passivity.py: by zero\n", result.stderr)  # fmt: skip


def test_the_outputs_on_the_page_are_those_of_the_program(folder):
    page = (Path(__file__).parents[2] / "docs" / "passivity.md").read_text(encoding="utf-8")
    for start, name in (("medium =", "scene.toml"), ("f,re,im", "measured.csv")):
        (text,) = re.findall(rf"```\w+\n({start}.*?)```", page, re.DOTALL)
        (folder / name).write_text(text, encoding="utf-8")
    shown = re.findall(r"^\$ tline passivity (.*)\n((?:[^$`].*\n)+)", page, re.MULTILINE)
    assert len(shown) == page.count("$ tline passivity ") == 8
    for arguments, output in shown:
        printed = run(*shlex.split(arguments)).stdout.splitlines()
        assert [line for line in output.splitlines() if line not in printed] == []


def test_undecided_exits_3(monkeypatch):
    monkeypatch.setattr("passivity.polynomial.sign.MAX_PIECES", 0)
    result = run("(s^2 + s + 1)/(s^2 + s + 4) + 1p")
    assert result.exit_code == 3
    assert "undecided\n  because the sign of a polynomial" in result.stdout


def test_json_of_a_proof_holds_the_certificate():
    told = json.loads(run(TOUCHING, "--json", "--within", "1e-9").stdout)
    assert (told["status"], told["lossless"], told["hidden_factor"]) == ("proved", False, None)
    assert told["certificate"]["sums"][0]["sign_factors"] == [{"factor": ["1", "-2"], "power": 2}]
    assert [float(pivot) for pivot in told["certificate"]["routh_column"]] == [5, 2, 2]
    assert told["certificate"]["verified"] is True
    assert told["robustness"]["same"] is False
    assert told["margins"]["input"]["low"] == told["margins"]["input"]["high"] == "0"
    assert told["margins"]["input"]["frequency"] == pytest.approx(2**0.5, rel=1e-15)


def test_json_of_a_refutation_holds_the_exact_witness():
    told = json.loads(run(NEGATIVE, "--json").stdout)
    point = told["witness"]
    u, v, re, im = (Fraction(point[key]) for key in ("re", "im", "value_re", "value_im"))
    # (re + j im) (s^2 + s + 1) = s + 2
    a, b = u * u - v * v + u + 1, 2 * u * v + v
    assert (re * a - im * b, re * b + im * a) == (u + 2, v)
    assert u > 0 > re
    assert told["margins"]["output"] == {"value": -1, "low": "-1", "high": "-1", "frequency": "inf"}


def test_json_through_a_line():
    told = json.loads(run("--json", "--delay", "1", "--", "-5").stdout)
    assert told["line"]["status"] == "refuted"
    assert [step["status"] for step in told["line"]["steps"]] == ["refuted"] * 4
    assert told["line"]["witness"] == {"re": "1/8", "im": "0", "value_re": "3/2", "value_im": "0"}


@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_pictures_are_written(tmp_path, suffix):
    file = tmp_path / f"plot.{suffix}"
    result = run(NEGATIVE, "--plot", str(file))
    assert result.exit_code == 1
    assert result.stdout.endswith(f"wrote {file}\n")
    assert file.stat().st_size > 5000


@pytest.mark.parametrize(
    "expression", ["0", "1/0", "5", "s", "1/s", "-1", "s^3", "s/(s^2 + 1)", "1e-9*s + 1e12/s + 3", NEGATIVE]
)
@pytest.mark.parametrize("check", [check_positive_real, check_bounded_real])
def test_everything_can_be_drawn(expression, check, tmp_path):
    verdict = check(RationalFunction.from_expression(expression))
    figure = draw_verdict(verdict, verdict.margins)
    figure.savefig(tmp_path / "a.png", dpi=40)
    assert imread(tmp_path / "a.png").std() > 0
    for axes in figure.axes:
        assert axes.get_xlabel()
        assert axes.get_ylabel()


SCENE = """
medium = "electrical"
t_end = 20
[lines.l]
nodes = ["near", "far"]
z0 = 1
delay = 1
[loads.end]
at = "far"
kind = "impedance"
expression = "{}"
[probes.p]
at = "far"
"""


def test_a_scene_is_checked_load_by_load(tmp_path):
    (tmp_path / "scene.toml").write_text(SCENE.format("-2"), encoding="utf-8")
    result = run(str(tmp_path / "scene.toml"))
    assert result.exit_code == 1
    assert "loads.end: refuted" in result.stdout
    assert "waves grow by a factor e every 1.82 s" in result.stdout  # 2/ln 3: H = 3 at one end, 1 at the other


def test_a_circuit_may_be_passive_though_an_element_is_not(tmp_path):
    links = """
[links.in]
nodes = ["far", "inner"]
kind = "resistor"
resistance = {}
[links.negative]
nodes = ["inner", "end"]
kind = "impedance"
expression = "-2"
[lines.next]
nodes = ["end", "last"]
z0 = 1
delay = "1 s"
"""
    for resistance, status, words in ((3, 0, "S^H S <= I for all ω"), (1, 1, "S has a singular value above 1")):
        scene = SCENE.partition("[loads.end]")[0] + links.format(resistance) + '[probes.p]\nat = "near"\n'
        (tmp_path / "scene.toml").write_text(scene, encoding="utf-8")
        result = run(str(tmp_path / "scene.toml"))
        assert (result.exit_code, result.stderr) == (status, "")
        verdict = "refuted" if status else "proved"
        assert f"  circuit at nodes 'far', 'inner', 'end', 2 ports: {verdict}\n    because {words}" in result.stdout
        told = json.loads(run("--json", str(tmp_path / "scene.toml")).stdout)
        assert told["status"] == verdict
        assert told["circuits"][0]["scattering"][0][0] == f"({resistance - 2})/({resistance})"


def test_impedances_between_nodes_are_checked_too(tmp_path):
    link = '[links.in]\nnodes = ["far", "beyond"]\nkind = "impedance"\nexpression = "s + 2"\n'
    link += '[loads.beyond]\nat = "beyond"\nkind = "resistor"\nresistance = 1\n'
    (tmp_path / "scene.toml").write_text(SCENE.format("3") + link, encoding="utf-8")
    told = json.loads(run("--json", str(tmp_path / "scene.toml")).stdout)
    assert (told["status"], told["links"]) == ("proved", {"in": "proved"})


@pytest.mark.parametrize(
    ("arguments", "status", "words"),
    [
        ("'exp(2*s)/2' --kind br", 1, "|H(s)| = "),
        ("'1/(s + 1 + exp(-s))'", 0, "[inverse]"),
        ("'k*(1 - s*t)/(1 + s*t)' --kind br --param 't>0' --param '-1<=k<=1'", 0, "bounded real: proved"),
        ("'k*(1 - s*t)/(1 + s*t)' --kind br --param 't>0' --param 'k real'", 1, "exactly if -1 <= k <= 1"),
        ("'[R, -r; r, R]' --param R=1 --param r=7", 0, "positive real, 2 ports: proved"),
        ("'[0, 1; 1, 0]' --kind br", 0, "S^H S = I for all ω, and all poles of S"),
        ("'[1/s, 2/s; 2/s, 1/s]'", 1, "v = (-1 + 0j, 1/2 + 0j)"),
    ],
)
def test_answers_beyond_rational_one_ports(arguments, status, words):
    result = run(*shlex.split(arguments))
    assert words in result.output
    assert (result.exit_code, result.stderr) == (status, "")
    told = json.loads(run(*shlex.split(arguments), "--json").stdout)
    assert told["status"] == ("proved" if status == 0 else "refuted")


def test_an_answer_without_picture_loads_nothing_heavy():
    code = (
        "import sys\nfrom tline.cli.main import main\n"
        f"try:\n    main(['passivity', {NEGATIVE!r}])\nexcept SystemExit:\n    pass\n"
        "print(*sys.modules, file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert "refuted" in done.stdout
    assert not {"numba", "scipy", "matplotlib", "numpy", "pint", "pydantic"} & set(done.stderr.split())


def test_a_hostile_expression_is_refused_quickly():
    started = time.process_time()
    for text in ("(" * 5000 + "s", "s^1000000000", "9" * 9000, "+".join("1/(s+%d)" % k for k in range(900))):  # noqa: UP031
        assert run(text).exit_code == 2
    assert time.process_time() - started < 4
