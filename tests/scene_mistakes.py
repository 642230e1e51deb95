"""Two small scenes, changes to their text, and what is told of mistakes in them."""

import re
from pathlib import Path

import pytest

from tline.errors import InputError, SceneError
from tline.scene.file import read_scene
from tline.solver.assembly.assemble import assemble
from tline.solver.description.description import describe

CABLE = """
medium = "electrical"
t_end = "40 ns"
[lines.cable]
nodes = ["near", "far"]
z0 = "50 ohm"
delay = "5 ns"
[sources.gen]
at = "near"
kind = "voltage"
value = "1 V"
resistance = "50 ohm"
[loads.end]
at = "far"
kind = "resistor"
resistance = "75 ohm"
[probes.seen]
at = "far"
"""


PIPE = """
medium = "hydraulic"
t_end = "2 s"
[lines.pipe]
nodes = ["tank", "valve"]
radius = "10 cm"
density = 998
wave_speed = "1200 m/s"
length = "300 m"
[sources.pump]
at = "tank"
kind = "pressure"
value = "5 bar"
resistance = "1 bar/(m^3/s)"
[loads.outlet]
at = "valve"
kind = "resistor"
resistance = 1e8
[probes.seen]
at = "valve"
"""


def changed(scene: str, change: str) -> str:
    if change.startswith("^ "):
        return change[2:] + "\n" + scene
    if change.startswith(("+ ", "ideal + ")):
        scene = scene.replace('resistance = "50 ohm"\n', "") if change.startswith("ideal") else scene
        return scene + change.partition("+ ")[2]
    old, _, new = change.partition("->")
    assert old.strip() in scene
    return scene.replace(old.strip(), new.strip())


def mistakes_of(text: str | bytes, folder: Path) -> list[str]:
    """One sentence a mistake, from reading and assembling the scene."""
    file = folder / "scene.toml"
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(InputError) as caught:
        assemble(describe(read_scene(file)), set())
    found = caught.value.mistakes if isinstance(caught.value, SceneError) else [caught.value]
    return [str(mistake) for mistake in found]


def agree(sentences: list[str], begins: list[str]) -> None:
    """Each sentence begins as it should, is one line, and not long."""
    assert len(sentences) == len(begins), sentences
    for sentence, begin in zip(sentences, begins, strict=True):
        assert re.match(".*".join(map(re.escape, begin.split("…"))), sentence), sentence
        assert "\n" not in sentence
        assert len(sentence) < 400
