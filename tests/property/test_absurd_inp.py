"""Whatever number stands in an .inp file, it is imported, or refused in one sentence."""

import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from networks import RING

from tline.cli.main import main

pytest.importorskip("wntr")
ABSURD = ("1e99", "-1e99", "1e308", "1e60", "1e20", "1e-99", "-1", "0")
EACH = 12


def done(folder: Path, text: str) -> tuple[int, str]:
    (folder / "absurd.inp").write_text(text)
    found = CliRunner().invoke(main, ["import", f"{folder}/absurd.inp", "-o", f"{folder}/out.toml"])
    return found.exit_code, found.stderr


@pytest.mark.parametrize("law", [("H-W", 120), ("D-W", 0.2), ("C-M", 0.012)], ids=lambda law: law[0])
def test_a_number_without_sense(tmp_path: Path, law: tuple[str, float]) -> None:
    text = RING.format(units="LPS", law=law[0], rough=law[1], exponent=0.5)
    numbers = [*re.finditer(r"(?<= )\d+(\.\d+)?(?=[ \n])", text[: text.index("[COORDINATES]")])]
    rng = np.random.default_rng(len(numbers))
    for _ in range(EACH):
        at, value = rng.choice(len(numbers)), rng.choice(ABSURD)
        code, said = done(tmp_path, text[: numbers[at].start()] + value + text[numbers[at].end() :])
        assert code in (0, 2), (numbers[at], value, said)
        assert code == 0 or said.count("\n") == 1, said


@pytest.mark.parametrize("value", ["1e99", "-1e99", "1e30"])
@pytest.mark.parametrize("junction", ["suction 2", "a 20", "d 20"])
def test_a_junction_beyond_the_sky(tmp_path: Path, junction: str, value: str) -> None:
    text = RING.format(units="LPS", law="H-W", rough=120, exponent=0.5)
    code, said = done(tmp_path, text.replace(f" {junction} ", f" {junction.split()[0]} {value} "))
    assert (code, said.count("\n")) == (2, 1)
    assert "beyond all numbers" in said or "no steady flow" in said
