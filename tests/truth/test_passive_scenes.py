"""Whole scenes as one function: what comes with the package is proved, with files that hold; what is active is not."""

import json
from pathlib import Path

import numpy as np
import pytest

import tline as tl
from passivity import is_bounded_real, is_positive_real
from passivity.verifier import check

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
