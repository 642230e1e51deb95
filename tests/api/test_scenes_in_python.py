"""Scenes in Python: other values in a line, text of a file again, a drawing, and one sentence for each mistake."""

import copy
import json
import pickle
import re
import tomllib

import numpy as np
import pytest

import tline as tl

CABLE = tl.examples["cable_rc"]


@pytest.mark.parametrize("name", [*tl.examples])
def test_shipped_scenes_go_round(name):
    """Through pickle, copies, TOML and tables, with the same result."""
    scene = tl.examples[name]
    twins = [
        pickle.loads(pickle.dumps(scene)),
        copy.deepcopy(scene),
        tl.Scene(scene.folder, **tomllib.loads(scene.to_toml())),
        tl.Scene(scene.folder, **scene.table()),
    ]
    shortest = min(line.shortest for line in scene.lines.values())
    short = {"t_end": min(scene.t_end, 3 * shortest), "solver": {"order": 2}}
    first, *others = (tl.simulate(each.change(short)) for each in (scene, *twins))
    assert all(twin == scene for twin in twins)
    for other in others:
        for probe, seen in first.probes.items():
            np.testing.assert_array_equal(other.probes[probe].u, seen.u)
            np.testing.assert_array_equal(other.probes[probe].y, seen.y)


def test_values_change_by_path():
    other = CABLE.change({"lines.cable.z0": 60, "loads.receiver.capacitance": "5 pF", "t_end": "20 ns"})
    assert (other.lines["cable"].parameters.z0, other.loads["receiver"].capacitance, other.t_end) == (60, 5e-12, 20e-9)
    assert CABLE.lines["cable"].parameters.z0 == 50
    assert other != CABLE
    assert other.change({"lines.cable.z0": "50 ohm", "loads.receiver.capacitance": "4 pF", "t_end": "12 ns"}) == CABLE
    assert 'capacitance = "5 pF"' in other.to_toml()


def test_elements_are_added_replaced_and_removed_by_path():
    stub = {
        "lines.stub": {"nodes": ["far", "end"], "z0": 50, "delay": "0.5 ns"},
        "loads.receiver": tl.scene.Capacitor(at="end", capacitance="1 pF"),
        "probes.near": None,
        "probes.far.line": "cable",
    }
    scene = CABLE.change(stub)
    assert ([*scene.lines], [*scene.probes], scene.loads["receiver"].at) == (["cable", "stub"], ["far"], "end")
    here, there = tl.simulate(scene), tl.prepare(CABLE).run(stub)
    np.testing.assert_allclose(there.probes["far"].u, here.probes["far"].u, atol=1e-6)


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"loads.reciever.capacitance": 1}, "loads.reciever.capacitance: no such element, expected 'receiver', got"),
        ({"loads.receiver.capacitence": 1}, "loads.receiver.capacitence: unknown key, expected 'capacitance'"),
        ({"loads.receiver.capacitance": "5 pH"}, "this unit measures something else"),
        ({"loads.receiver": 5}, "loads.receiver: not an element, expected a table, an element, or None to remove it"),
        ({"loads.rx": None}, "loads.rx: no such element, expected 'receiver', got 'rx'"),
        ({"loads": {}}, "loads: not a value"),
        ({"t_and": 5}, "t_and: no such key, expected 't_end', got 't_and'"),
        ("t_end", "not values by path"),
    ],
)
def test_what_cannot_change_is_said_with_its_path(values, sentence):
    with pytest.raises(tl.InputError, match=re.escape(sentence)):
        CABLE.change(values)


@pytest.mark.parametrize(
    ("mistake", "sentence"),
    [
        (lambda: setattr(CABLE, "t_end", 3), "t_end: scenes and elements do not change, expected scene.change"),
        (lambda: delattr(CABLE, "t_end"), "t_end: scenes and elements do not change"),
        (lambda: setattr(CABLE.loads["receiver"], "resistance", 3), "resistance: scenes and elements do not change"),
        (lambda: tl.Scene({"medium": "electrical"}), "not a folder, expected keywords, such as Scene(**tables)"),
        (lambda: tl.Scene(), "medium: is missing"),
        (lambda: tl.scene.Parallel(at="far", capacitanc="4 pF"), "Parallel.capacitanc: unknown key"),
        (lambda: tl.scene.Parallel(at="far", capacitance=[]), "Parallel.capacitance: "),
    ],
)
def test_mistakes_are_told_in_our_words(mistake, sentence):
    with pytest.raises(tl.InputError, match=re.escape(sentence)) as told:
        mistake()
    assert "pydantic" not in str(told.value)


def test_a_scene_and_its_elements_show_themselves_shortly():
    assert repr(CABLE) == (
        "<Scene '50 Ω cable into 100 Ω ∥ 4 pF': electrical, 12 ns\n"
        "  lines    cable\n  sources  driver\n  loads    receiver\n  probes   near, far>"
    )
    element = CABLE.loads["receiver"]
    assert eval(repr(element), vars(tl.scene)) == element
    lines = {f"line{k}": {"nodes": [f"n{k}", f"n{k + 1}"], "z0": 50, "delay": 1} for k in range(5000)}
    long = tl.Scene(medium="electrical", t_end=1, lines=lines, probes={"p": {"at": "n0"}})
    assert "and 4,990 more" in repr(long)
    assert max(map(len, repr(long).splitlines())) <= 100
    assert "<img" not in long._repr_html_()  # it is not laid out


def test_tab_offers_what_is_ours():
    assert {"change", "to_toml", "lines", "plot"} <= {*dir(CABLE)}
    assert not [name for name in dir(CABLE) if name.startswith("model_") or name in ("dict", "json", "copy")]


def test_a_notebook_sees_the_network():
    html = CABLE._repr_html_()
    assert '<img alt="network"' in html
    assert "data:image/png;base64,iVBOR" in html
    nasty = CABLE.change({"title": "<script>alert(1)</script>"})
    assert "<script>" not in nasty._repr_html_()


def test_every_shipped_scene_is_drawn():
    for name, scene in tl.examples.items():
        picture = scene.plot()
        written = "\n".join(text.get_text() for text in picture.axes[0].texts)
        known = {*scene.lines, *(node for line in scene.lines.values() for node in line.nodes)}
        assert any(each in written for each in known), name


def test_tables_are_plain():
    assert tl.Scene(**json.loads(json.dumps(CABLE.table()))) == CABLE
