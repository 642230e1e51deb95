"""What is refused of Touchstone files of several ports in scenes, each in one sentence, and what is printed."""

import json
import pickle
import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from touchstone_files import FILTER, SHIPPED, frequencies, stretch, write_ports

from tline.cli.main import main
from tline.errors import SceneError
from tline.scene.file import read_scene, scene_from, scene_text
from tline.scene.touchstone import MeasuredMultiport

SCENE = f"""
medium = "electrical"
t_end = "6 ns"
[lines.cable]
nodes = ["near", "in"]
z0 = 75
delay = "1 ns"
[sources.driver]
at = "near"
kind = "voltage"
value = 1
resistance = 75
[links.filter]
nodes = ["in", "out"]
kind = "touchstone"
file = "{FILTER}"
nearest = true
[loads.end]
at = "out"
kind = "resistor"
resistance = 50
[probes.in]
at = "in"
"""
GIVEN = f'file = "{FILTER}"\nnearest = true'
DELAYED = 'file = "delayed.s2p"\ndelays = ["0.3 ns", 0]'


@pytest.fixture(autouse=True)
def folder(folder):
    """A folder with files of many kinds."""
    Path("scene.toml").write_text(SCENE, encoding="utf-8")
    Path("words.s2p").write_text("not numbers at all\n", encoding="utf-8")
    f, one = frequencies(20e9, 100), np.eye(2)
    write_ports("three.s3p", f, np.tile(0.5 * np.eye(3), (100, 1, 1)))
    write_ports("few.s2p", f[:2], np.tile(0.5 * one, (2, 1, 1)))
    write_ports("active.s2p", f, np.tile([[0, 0.2], [1.5, 0]], (100, 1, 1)))
    write_ports("line.s2p", f, stretch(f, 75, 20e-12))
    write_ports("noise.s2p", f[:30], np.random.default_rng(1).uniform(-0.4, 0.4, (30, 2, 2)))
    turned = np.exp(-2j * np.pi * f[:, None] * [0.3e-9, 0])
    write_ports("delayed.s2p", f, turned[:, :, None] * [[0.2, 0.4], [0.4, 0.2]] * turned[:, None, :])
    return folder


MISTAKES = [
    ('file = "gone.s2p"', "file: 'gone.s2p' cannot be read, got No such file or directory"),
    ('file = "words.s2p"', "file: 'words.s2p': not a Touchstone file"),
    ('file = "three.s3p"', "file: 'three.s3p': not one port for each node, expected 2, got 3 ports"),
    (f'file = "{SHIPPED}"', f"file: '{SHIPPED}': not one port for each node, expected 2, got 1 port"),
    ('file = "few.s2p"', "file: 'few.s2p': too few for a model, expected at least 3, got 2"),
    ('file = "active.s2p"', "file: 'active.s2p': S has a singular value of 1.5 at 2e+08 Hz: no passive network"),
    ('file = "noise.s2p"', "tolerance: no model of up to 24 poles is that near to the samples, expected at least 0."),
    (f'file = "{FILTER}"\ntolerance = 0', "tolerance: tolerance out of range, expected at least 1e-13, got 0"),
    (f'file = "{FILTER}"\ndelays = ["1 ns"]', "delays: not one for each node, expected 2, got 1"),
    (f'file = "{FILTER}"\ndelays = ["1 ns", "-1 ns"]', "delays[1]: delay out of range, expected at least 0"),
    ("", "file: is missing"),
]  # fmt: skip


def mistake(text):
    Path("scene.toml").write_text(text, encoding="utf-8")
    with pytest.raises(SceneError) as caught:
        read_scene("scene.toml")
    assert len(caught.value.mistakes) == 1
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize(("given", "told"), MISTAKES)
def test_one_sentence_for_each_mistake(given, told):
    assert mistake(SCENE.replace(GIVEN, given)).startswith(f"links.filter.{told}")


def test_a_fit_that_is_not_passive_is_refused_with_its_band():
    """Of a line without losses, from 6 poles: ripples around |S| = 1 up to 20 GHz, and no bound beyond."""
    said = mistake(SCENE.replace(GIVEN, 'file = "line.s2p"'))
    found = re.fullmatch(
        r"links.filter.file: 'line.s2p': the model with 6 poles is not proved passive: S has a singular value above 1 "
        r"from (\S+) Hz to (\S+) Hz, by up to (\S+) at (\S+) Hz, expected nearest = true, or another tolerance",
        said,
    )
    low, high, beyond, at = map(float, found.groups())
    assert 0 < low < at < high
    assert 0 < beyond < 1e-3


@pytest.mark.parametrize(
    ("nodes", "told"),
    [
        ('["in", "in"]', "links.filter.nodes: two ports are at one node, expected different nodes"),
        ('["in"]', "links.filter.nodes: not a list of nodes"),
    ],
)
def test_nodes_that_no_file_fits(nodes, told):
    assert mistake(SCENE.replace('["in", "out"]', nodes).replace('at = "out"', 'at = "in"')).startswith(told)


def test_more_ports_than_proofs_take():
    with pytest.raises(SceneError, match="nodes: too many ports, expected at most 8, got 9"):
        MeasuredMultiport(nodes=[*"abcdefghi"], file=str(FILTER))


def test_a_line_that_has_the_name_of_a_delay_is_refused():
    more = '[lines."links.filter.1"]\nnodes = ["far", "end"]\nz0 = 50\ndelay = 1\n'
    text = SCENE.replace(GIVEN, DELAYED) + more
    assert "a name that a part of links.filter takes" in mistake(text)


def test_not_in_hydraulic_scenes():
    table = {"medium": "hydraulic", "t_end": 1, "lines": {"p": {"nodes": ["a", "b"], "z0": 1e7, "delay": 1}}}
    link = {"nodes": ["a", "b"], "kind": "touchstone", "file": str(FILTER)}
    with pytest.raises(SceneError, match=r"links\.l\.kind: not a word of hydraulic scenes"):
        scene_from(table | {"links": {"l": link}, "probes": {"p": {"at": "b"}}})


def test_a_scene_is_written_as_it_was_read():
    Path("scene.toml").write_text(SCENE.replace(GIVEN, DELAYED), encoding="utf-8")
    scene = read_scene("scene.toml")
    assert list(scene.lines) == ["cable", "links.filter.1"]
    assert scene.links["filter"].nodes == ("links.filter.1", "out")
    assert list(scene.table()["lines"]) == ["cable"]
    assert scene_from(json.loads(json.dumps(scene.table()))) == scene
    assert 'nodes = [\n    "in",\n    "out",\n]' in scene_text(scene)
    sent = pickle.loads(pickle.dumps(scene))
    assert sent.links["filter"].ports().P.tolist() == scene.links["filter"].ports().P.tolist()


def test_a_run_says_how_well_the_model_fits():
    done = CliRunner().invoke(main, ["run", "scene.toml"], catch_exceptions=False)
    assert re.search(
        r"links.filter: .*filter.s2p, 2 ports, 4 poles, proved passive, \|ΔS\| up to 6.7e-06 "
        r"\(150 samples, 40 MHz to 6 GHz\)",
        done.output,
    )
    done = CliRunner().invoke(main, ["run", "scene.toml", "--json"], catch_exceptions=False)
    told = json.loads(done.output)["measured_links"]["filter"]
    assert (told["status"], told["order"], told["z0"]) == ("proved", 4, [50, 50])
    assert told["error"] < 1e-5
    Path("scene.toml").write_text(SCENE.replace(str(FILTER), "line.s2p"), encoding="utf-8")
    done = CliRunner().invoke(main, ["run", "scene.toml"], catch_exceptions=False)
    assert "proved passive" in done.output
    assert re.search(r", of which being passive cost \d\.\de-\d\d \(100 samples", done.output)


def test_fit_prints_the_poles_of_several_ports_and_draws():
    done = CliRunner().invoke(main, f"fit {FILTER} --nearest --plot fit.png".split())
    assert done.exit_code == 0
    assert "2 ports, 4 poles, proved passive, |ΔS| up to 6.7e-06" in done.output
    assert len(re.findall(r"^    pole ", done.output, re.MULTILINE)) == 3  # two are a pair
    assert Path("fit.png").stat().st_size > 10_000


def test_fit_takes_delays_in_front_of_ports_out(tmp_path):
    T = np.array([0.4e-9, 0.7e-9])
    S = np.full((2, 2), 0.3) * np.exp(-2j * np.pi * frequencies()[:, None, None] * (T[:, None] + T))
    write_ports(tmp_path / "line.s2p", frequencies(), S)
    done = CliRunner().invoke(main, ["fit", str(tmp_path / "line.s2p"), "--delay", "0.4 ns, 0.7 ns", "--json"])
    told = json.loads(done.output)
    assert told["order"] == 0
    assert told["status"] == "proved"
    assert np.array(told["constant"]) == pytest.approx(0.3 * np.ones((2, 2)), abs=1e-9)
