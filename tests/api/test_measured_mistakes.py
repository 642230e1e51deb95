"""What is refused of Touchstone files in scenes and by `tline fit`, each in one sentence, and what is printed."""

import json
import pickle
import re
from pathlib import Path

import numpy as np
import pytest
from command_line import run
from run_scenes import driven_cable
from touchstone_files import SHIPPED, behind_cable, frequencies, write

from tline.errors import SceneError
from tline.scene.file import read_scene, scene_from, scene_text

SCENE = driven_cable(f'[loads.antenna]\nat = "far"\nkind = "touchstone"\nfile = "{SHIPPED}"', z0=75, resistance=75)
F = frequencies(4e9, 100)


@pytest.fixture(autouse=True)
def folder(folder):
    """A folder with files of many kinds."""
    Path("scene.toml").write_text(SCENE, encoding="utf-8")
    Path("words.s1p").write_text("not numbers at all\n", encoding="utf-8")
    Path("empty.s1p").write_text("# Hz S RI R 50\n", encoding="utf-8")
    Path("two.s2p").write_text("# Hz S RI R 50\n1 0 0 1 0 1 0 0 0\n2 0 0 1 0 1 0 0 0\n3 0 0 1 0 1 0 0 0\n")
    Path("few.s1p").write_text("# Hz S RI R 50\n1 0.5 0\n2 0.5 0\n", encoding="utf-8")
    Path("data.csv").write_text("f,re,im\n1,0.5,0\n2,0.5,0\n", encoding="utf-8")
    write("active.s1p", F, 1.2 + 0 * F)
    write("noise.s1p", F[:30], np.random.default_rng(1).uniform(-0.5, 0.5, 30))
    write("series.s1p", F, 1.000001 * behind_cable("10 + s*5n + 1/(s*2p)", F, 0))  # |S| = 1.000001 at 0 and infinity
    return folder


MISTAKES = [
    ('file = "gone.s1p"', "file: 'gone.s1p' cannot be read, got No such file or directory"),
    (
        'file = "words.s1p"',
        "file: 'words.s1p': not a Touchstone file: line 1 is before the option line, expected # Hz S RI",
    ),
    ('file = "empty.s1p"', "file: 'empty.s1p': "),
    ('file = "few.s1p"', "file: 'few.s1p': too few for a model, expected at least 3, got 2"),
    ('file = "data.csv"', "file: 'data.csv': not a Touchstone file, expected .s1p to .s16p, or .ts, got .csv"),
    ('file = "two.s2p"', "file: 'two.s2p': not a reflection, expected S of one port, got S of 2 ports"),
    ('file = "active.s1p"', "file: 'active.s1p': |S| = 1.2 at 4e+07 Hz: no passive one-port within the tolerance"),
    ('file = "series.s1p"', "file: 'series.s1p': the model with 2 poles is not proved passive: |S| > 1 "),
    ('file = "noise.s1p"', "tolerance: no model of up to 24 poles is that near to the samples, expected at least 0."),
    ('file = "a\\u0000b.s1p"', "file: 'a\\x00b.s1p' cannot be read"),
    (f'file = "{SHIPPED}"\ntolerance = 0', "tolerance: tolerance out of range, expected at least 1e-13, got 0"),
    (f'file = "{SHIPPED}"\ndelay = "-1 ns"', "delay: delay out of range, expected at least 0, got '-1 ns'"),
    (f'file = "{SHIPPED}"\nnearest = 3', "nearest: "),
    ("", "file: is missing"),
]


@pytest.mark.parametrize(("given", "told"), MISTAKES)
def test_one_sentence_for_each_mistake(given, told):
    text = SCENE.replace(f'file = "{SHIPPED}"', given)
    Path("scene.toml").write_text(text, encoding="utf-8")
    with pytest.raises(SceneError) as caught:
        read_scene("scene.toml")
    assert len(caught.value.mistakes) == 1
    assert str(caught.value).startswith(f"loads.antenna.{told}")
    assert "\n" not in str(caught.value)


BESIDE = [
    ('[loads.c]\nat = "far"\nkind = "series"\ncapacitance = "1 pF"', None),
    ('[lines."loads.antenna"]\nnodes = ["far", "end"]\nz0 = 50\ndelay = 1', "a name that a part of loads"),
    ('[loads.m]\nat = "far"\nkind = "matched"', "node 'far' is a junction"),
]


@pytest.mark.parametrize(("more", "told"), BESIDE)
def test_beside_others(more, told):
    """Behind its delay a measured load stands alone; where it has none, nothing with states may stand beside it."""
    text = f"{SCENE}{more}\n"
    Path("scene.toml").write_text(text, encoding="utf-8")
    if told is None:
        assert read_scene("scene.toml").loads["antenna"].at == "loads.antenna"
        Path("scene.toml").write_text(text.replace(str(SHIPPED), 'series.s1p"\nnearest = true\ndelay = "0'))
        told = "stands beside loads.c, expected a line between them"
    with pytest.raises(SceneError, match=re.escape(told)):
        read_scene("scene.toml")


def test_not_in_hydraulic_scenes():
    table = {"medium": "hydraulic", "t_end": 1, "lines": {"p": {"nodes": ["a", "b"], "z0": 1e7, "delay": 1}}}
    load = {"at": "b", "kind": "touchstone", "file": str(SHIPPED)}
    with pytest.raises(SceneError, match=re.escape("loads.l.kind: not a word of hydraulic scenes")):
        scene_from(table | {"loads": {"l": load}, "probes": {"p": {"at": "b"}}})


def test_a_scene_is_written_as_it_was_read():
    scene = read_scene("scene.toml")
    assert list(scene.lines) == ["cable", "loads.antenna"]
    assert scene.lines["loads.antenna"].parameters.z0 == 50
    again = scene_from(json.loads(json.dumps(scene.table())))
    assert again == scene
    assert "loads.antenna" not in scene.table()["lines"]
    assert 'at = "far"' in scene_text(scene)
    sent = pickle.loads(pickle.dumps(scene))
    assert sent.loads["antenna"].model.delay == scene.loads["antenna"].model.delay


def test_a_run_says_how_well_the_model_fits():
    done = run("run scene.toml")
    assert re.search(
        r"loads.antenna: .*antenna.s1p, 4 poles behind 700 ps of 50 ohm, proved passive, \|ΔS\| up to 6.9e-06 "
        r"\(200 samples, 20 MHz to 4 GHz\)",
        done.output,
    )
    told = json.loads(run("run scene.toml --json").output)["measured"]["antenna"]
    assert told["status"] == "proved"
    assert told["error"] < 1e-5
    assert told["cost"] == 0


def test_the_nearest_passive_model_is_taken_only_if_asked():
    done = run("fit series.s1p")
    assert done.exit_code == 1
    assert "2 poles against 50 ohm, not passive" in done.output
    asked = run("fit series.s1p --nearest --json")
    assert asked.exit_code == 0
    told = json.loads(asked.output)
    assert told["status"] == "proved"
    assert told["cost"] == pytest.approx(1e-6, rel=1e-2)  # as much as |S| is beyond 1
    text = SCENE.replace(str(SHIPPED), 'series.s1p"\nnearest = true\n#')
    Path("scene.toml").write_text(text, encoding="utf-8")
    assert "of which being passive cost" in run("run scene.toml").output


def test_fit_prints_poles_and_draws():
    done = run(f"fit {SHIPPED} --delay '0.7 ns' --plot fit.png")
    assert done.exit_code == 0
    assert len(re.findall(r"^    pole -.*j, residue .*j, and their conjugates$", done.output, re.MULTILINE)) == 2
    assert Path("fit.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("line", "code", "told"),
    [
        ("fit noise.s1p", 1, "--tol: no model of up to 24 poles is that near to the samples"),
        ("fit active.s1p", 2, "active.s1p: |S| = 1.2 at 4e+07 Hz: no passive one-port within the tolerance"),
        ("fit two.s2p --delay '1 ns, 2 ns, 3 ns'", 2, "--delay: not one for each port, expected 2, got 3"),
        ("fit two.s2p --delay '1 ns, -2 ns'", 2, "--delay: delay out of range, expected at least 0, got '-2 ns'"),
        ("fit gone.s1p", 2, "gone.s1p: cannot be read"),
        ("fit series.s1p --tol much", 2, "--tol: "),
        ("fit series.s1p --delay '3 m'", 2, "--delay: "),
        ("fit series.s1p --plot fit.doc", 2, "--plot: unknown kind of file"),
    ],
)
def test_mistakes_on_the_command_line(line, code, told):
    done = run(line)
    assert done.exit_code == code
    assert done.output.startswith(told)
    assert done.output.count("\n") == 1
