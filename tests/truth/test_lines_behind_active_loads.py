"""Lines and whole scenes as one function: proved, or refuted with witnesses that mpmath evaluates."""

import json
from pathlib import Path

import mpmath
import numpy as np
import pytest

import tline as tl
from passivity import is_bounded_real, is_positive_real
from passivity.verifier import check

LOSSY = "line(sqrt((1 + 2*s)/(3 + s)), sqrt((1 + 2*s)*(3 + s))/5, {})"


def cascade(load, *parts):
    """Lines of z0 and tenths of a second one before the other, and resistances in series, as quotients in tanh."""
    told = f"let q0 = {load}; "
    for k, part in enumerate(parts):
        form = f"(q{k} + {part})"
        if isinstance(part, tuple):
            z0, wave = part[0], f"tanh({part[1]}*s/10)"
            form = f"(q{k} + ({z0})*{wave})/(1 + q{k}*{wave}/({z0}))"
        elif isinstance(part, str):
            form = part.format(f"q{k}")
        told += f"let q{k + 1} = {form}; "
    return f"{told}q{len(parts)}"


def value(text, s):
    """Z at a point, with the digits that mpmath is set to."""
    names = {"s": s, "tanh": mpmath.tanh, "sqrt": mpmath.sqrt}
    names["line"] = lambda z, b, q: z * (q + z * mpmath.tanh(b)) / (z + q * mpmath.tanh(b))
    *lets, last = text.split("; ")
    for each in lets:
        name, expression = each.removeprefix("let ").split(" = ")
        names[name] = eval(expression, names)
    return eval(last, names)


PASSIVE = [
    LOSSY.format("-150"),
    cascade("1/(s/50 + 1/100) - 200", LOSSY),
    cascade("50", LOSSY.replace("{}", "{} - 200"), (75, 3)),
    cascade("50", (25, 7), (25, 1), (50, 7), -12),
    cascade("50", (25, 7), (40, 1), -12, (40, 2), (120, 3)),
]


@pytest.mark.parametrize("text", PASSIVE)
def test_what_a_line_loses_may_be_more_than_its_load_gives(text):
    conclusion = is_positive_real(text)
    assert conclusion.proved
    assert check(json.loads(json.dumps(conclusion.proof))) is None
    with mpmath.workdps(30):
        assert all(mpmath.re(value(text, mpmath.mpc("1e-9", k) / 7)) > 0 for k in range(1, 300))


ACTIVE = [
    cascade("25 + s - 200", LOSSY),  # poles at 173.6, of which the line takes 43 digits away
    cascade("25 + s", (10, 1), -200, LOSSY, (120, 2), (50, 1), (75, 2)),  # and at many turns of the first line
    cascade("1/(s/50 + 1/100)", (10, 2), -200, LOSSY, (40, 2), (50, 2), (10, 3), (40, 3), (50, 2), (25, 3), (10, 1)),
    cascade("50", (50, 1), (10, 2), (75, 1), (300, 2), (25, 2), (-50, 2), (300, 2), (120, 2), (10, 1)),
]


@pytest.mark.parametrize("text", ACTIVE)
def test_an_active_load_that_hardly_shows_is_found(text):
    witness = is_positive_real(text).witness
    with mpmath.workdps(300):
        re, im = (mpmath.mpf(x.numerator) / x.denominator for x in (witness.re, witness.im))
        assert re > 0
        assert mpmath.re(value(text, mpmath.mpc(re, im))) < 0


SCENES = sorted((Path(__file__).parents[2] / "scenes").glob("*.toml"))
TWO_LINES = """
medium = "electrical"
t_end = 1
[lines.one]
nodes = ["in", "m"]
z0 = 50
delay = 0.125
[lines.two]
nodes = ["n", "out"]
z0 = 75
delay = 0.25
[links.active]
nodes = ["m", "n"]
kind = "impedance"
expression = "{}"
[loads.end]
at = "out"
kind = "impedance"
expression = "30 + s"
[probes.p]
at = "in"
"""


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_the_scenes_that_come_with_the_package(path):
    """Their elements are R, L, C, laws that never fall, multiports and lines above zero, all passive by hand."""
    scene = tl.read(path)
    found = is_positive_real(scene)
    assert found.proved
    assert check(json.loads(json.dumps(found.evidence))) is None
    assert is_bounded_real(scene).proved


@pytest.mark.parametrize(("expression", "passive"), [("5 + 1/s", True), ("-5", False), ("5 - 10/(1 + s)", False)])
def test_an_element_between_lines(expression, passive, tmp_path):
    """Beside it stands what the scene shows at the ends of the lines there, by S-parameters in floats."""
    file = tmp_path / "scene.toml"
    file.write_text(TWO_LINES.format(expression), encoding="utf-8")
    scene = tl.read(file)
    assert is_positive_real(scene).proved == passive
    assert is_positive_real(scene).refuted != passive
    s = 1e-9 + 1j * np.linspace(0.05, 40, 400)
    seen = np.linalg.norm(tl.frequency.scattering_parameters(scene, ["m", "n"], s), 2, axis=(1, 2))
    assert (seen.max() <= 1 + 1e-9) == passive
