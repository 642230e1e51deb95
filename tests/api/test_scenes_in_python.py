"""Scenes and results in Python: other values, texts, tables and files, pictures, a sentence for each mistake."""

import copy
import json
import pickle
import re
import subprocess
import sys
import tomllib

import numpy as np
import pandas
import pytest
import xarray
from matplotlib.figure import Figure

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


RESULT, PIPE = tl.simulate(tl.examples["cable_rc"]), tl.simulate(tl.examples["water_pipe"])
TOWN = tl.simulate(tl.examples["town"].change({"t_end": "1 s", "solver": {"order": 2}}))


def test_a_result_fits_on_a_screen():
    text = repr(PIPE)
    assert len(text.splitlines()) < 25
    assert "15.3 bar … 44.7 bar" in text
    assert "1e-06 asked and met" in text
    for part in (PIPE.probes["valve"], PIPE.lines["pipe"], PIPE.lines["pipe"].a1, PIPE.probes["valve"].samples):
        assert len(repr(part)) < 100


@pytest.mark.parametrize("way", [lambda x: pickle.loads(pickle.dumps(x)), copy.deepcopy])
def test_results_travel_with_all_they_hold(way):
    t, other = np.linspace(0, 12e-9, 999), way(RESULT)
    np.testing.assert_array_equal(other.probes["far"].at(t).u, RESULT.probes["far"].at(t).u)
    assert repr(other) == repr(RESULT)
    assert other.scene == RESULT.scene


def test_a_dataframe_has_what_the_probes_saw():
    frame = RESULT.to_dataframe()
    np.testing.assert_array_equal(frame["far", "u"], RESULT.probes["far"].u)
    np.testing.assert_array_equal(frame.index, RESULT.t)
    t = [1.5e-9, 3e-9]
    np.testing.assert_array_equal(RESULT.to_dataframe(t)["near", "y"], RESULT.probes["near"].at(t).y)
    assert {key for _, key in TOWN.to_dataframe().columns} == {"u", "y", "a", "b", "gauge_pressure", "head"}
    assert isinstance(frame, pandas.DataFrame)


def test_a_dataset_has_units_the_scene_and_its_accuracy():
    data = TOWN.to_xarray()
    assert (data.u.units, data.y.units, data["head"].units, data.time.units) == ("Pa", "m^3/s", "m", "s")
    np.testing.assert_array_equal(data["head"].sel(probe="b"), TOWN.probes["b"].head)
    assert RESULT.to_xarray().attrs["scene"] == RESULT.scene.to_toml()
    assert RESULT.to_xarray().attrs["error"] == RESULT.accuracy.worst
    alone = TOWN.scene.change({"probes.inner": {"at": "d"}})
    inner = tl.simulate(alone).to_xarray().sel(probe="inner")
    assert np.isfinite(inner.u).all()
    assert np.isnan(inner.y).all()


def test_files_give_the_numbers_back(tmp_path):
    for suffix in (".csv", ".npz", ".nc", ".h5", ".zarr"):
        RESULT.save(tmp_path / f"out{suffix}")
        RESULT.save(tmp_path / f"out{suffix}")  # one that exists is replaced
    u = RESULT.probes["far"].u
    np.testing.assert_array_equal(pandas.read_csv(tmp_path / "out.csv")["far voltage [V]"], u)
    np.testing.assert_array_equal(np.load(tmp_path / "out.npz")["far/u"], u)
    for suffix in (".nc", ".h5"):
        with xarray.open_dataset(tmp_path / f"out{suffix}", engine="h5netcdf") as data:
            np.testing.assert_array_equal(data.u.sel(probe="far"), u)
    np.testing.assert_array_equal(xarray.open_zarr(tmp_path / "out.zarr", consolidated=False).u.sel(probe="far"), u)


def test_pictures_are_shown_without_being_asked_to():
    imported = set(sys.modules)
    prepared = tl.prepare(RESULT.scene)
    several = {c: prepared.run({"loads.receiver.capacitance": c}) for c in ("2 pF", "8 pF")}
    pictures = [
        RESULT.plot(), RESULT.plot(quantity="current"), tl.plot(several, probes=["far"]), RESULT.plot_waves("far"),
        RESULT.plot_waves(line="cable"), PIPE.plot_space_time(), PIPE.plot_profile(), PIPE.plot_lattice(),
    ]  # fmt: skip
    for picture in pictures:
        png, size = picture._repr_png_()
        assert png.startswith(b"\x89PNG")
        assert len(png) > 5000
        assert 600 < size["width"] < 1000
    page = PIPE.animate()._repr_html_()
    assert page.startswith('<iframe srcdoc="&lt;!DOCTYPE html&gt;')
    assert "matplotlib.pyplot" not in set(sys.modules) - imported


def test_results_share_axes_and_units():
    axes = Figure().subplots()
    small = RESULT.scene.change({"sources.driver.value.to": "1 mV"})
    RESULT.plot(axes, probes=["far"], label="1 V")
    assert tl.simulate(small).plot(axes, probes=["far"], label="1 mV") is axes
    first, second = axes.lines
    assert axes.get_ylabel() == "voltage at far [mV]"
    np.testing.assert_allclose(max(second.get_ydata()), max(first.get_ydata()) / 1000, rtol=1e-5)
    assert [text.get_text().strip() for text in axes.get_legend().get_texts()] == ["1 V", "1 mV"]
    assert first.get_color() != second.get_color()


def test_waves_are_what_the_effort_is_made_of():
    *_, effort = RESULT.plot_waves("far").axes[0].lines
    a, b = RESULT.plot_waves("far").axes[0].lines[:2]
    np.testing.assert_allclose(effort.get_ydata(), (a.get_ydata() + b.get_ydata()) / 2, atol=1e-12)
    lossy = tl.simulate(tl.examples["pipe_friction"].change({"t_end": "3 s"}))
    (line,) = lossy.lines
    images = [axes.images[0].get_array() for axes in lossy.plot_waves(line=line).axes[:2]]
    assert [np.ptp(image) > 1 for image in images] == [True, True]
    late, early = images[0][100, [5, -5]]
    assert late > early  # a runs from left to right


@pytest.mark.parametrize(
    ("mistake", "sentence"),
    [
        (lambda: RESULT.plot(probes=["fra"]), "probes: no such probe, expected 'far', got 'fra'"),
        (lambda: RESULT.plot(probes=0.5), "probes: something else, expected str, Iterable or NoneType, got 0.5"),
        (lambda: RESULT.plot(probes=[]), "probes: no such probe"),
        (lambda: RESULT.plot_waves(["far"]), "probe: no such probe"),
        (lambda: RESULT.probes["far"].at("late"), "t: not numbers, expected a number or an array of them, got 'late'"),
        (lambda: RESULT.to_dataframe({}), "t: not numbers"),
        (lambda: tl.sweep(CABLE, 5), "vary: nothing varies"),
        (lambda: tl.surge_study(None), "study: something else, expected str, Path or dict, got None"),
        (lambda: tl.frequency.respond(CABLE, "1 GHz"), "s: not numbers"),
        (lambda: tl.frequency.scattering_parameters(CABLE, 3), "ports: something else, expected str, list or tuple"),
        (lambda: tl.frequency.resonances(CABLE, "1 GHz"), "highest: something else, expected int or float"),
        (lambda: tl.signal.jitter(CABLE), "seen: something else, expected Eye"),
        (lambda: tl.signal.statistical_eye(RESULT), "pulse: something else, expected PulseResponse"),
        (lambda: tl.signal.prbs("PRBS9"), "order: no pseudo-random pattern"),
        (lambda: tl.passivity.check_samples([1.0]), "response: something else, expected SampledResponse, got [1.0]"),
        (lambda: tl.passivity.RationalMatrix([[1.0]]), "entry (1, 1): something else, expected RationalFunction"),
        (lambda: tl.passivity.read_touchstone(7), "path: something else, expected str or Path, got 7"),
        (lambda: RESULT.plot(quantity="pressure"), "quantity: not known, expected one of 'voltage', 'current', got"),
        (lambda: RESULT.plot_waves(), "probe: several, and none is named, expected one of 'near', 'far'"),
        (lambda: RESULT.plot_waves("fra"), "probe: no such probe, expected 'far', got 'fra'"),
        (lambda: RESULT.plot_waves(line="cabel"), "line: no such line, expected 'cable', got 'cabel'"),
        (lambda: RESULT.save("out.xls"), "out.xls: unknown kind of file"),
        (lambda: RESULT.save("none/out.nc"), "none/out.nc: cannot be written"),
        (lambda: RESULT.to_dataframe([1.0]), "probes.near: instant not in the run"),
        (lambda: RESULT.plot_map(), "the run kept no envelope"),
        (lambda: RESULT.animate("x", "y"), "path: no such node"),
        (lambda: tl.plot({}), "results: not results"),
        (lambda: tl.plot(3), "results: not results"),  # pyright: ignore[reportArgumentType]
        (lambda: tl.plot({"a": RESULT, "b": PIPE}), "results: of two media"),
    ],
)
def test_mistakes_get_a_sentence(mistake, sentence):
    with pytest.raises(tl.InputError, match=re.escape(sentence)):
        mistake()


NEEDING = {
    "pandas": lambda: RESULT.to_dataframe(),
    "xarray": lambda: RESULT.to_xarray(),
    "h5netcdf": lambda: RESULT.save("out.nc"),
    "zarr": lambda: RESULT.save("out.zarr"),
}


@pytest.mark.parametrize("package", NEEDING)
def test_missing_packages_are_named_with_the_line_that_installs_them(package, monkeypatch):
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(tl.MissingExtraError, match=rf"{package} is missing, expected pip install -e '\.\[data\]'"):
        NEEDING[package]()


def test_what_names_a_missing_extra_survives_pickle():
    error = tl.MissingExtraError("a.inp", "wntr is missing", "epanet")
    assert str(pickle.loads(pickle.dumps(error))) == str(error)
    assert "[epanet]" in str(error)


def test_a_switch_needs_no_other_element():
    """In a process that has met no table, whose law it has beside another law."""
    code = """if True:
        import tline
        pipe = {"length": 100, "wave_speed": 1000, "diameter": 0.2, "density": 1000}
        relief = {"kind": "relief valve", "set_pressure": 1e5, "band": 1e4, "flow": 5e-3, "pressure_drop": 1e5}
        moves = {"kind": "valve", "before": 1e7, "after": 1e8, "time": 0.2}
        tline.simulate({
            "medium": "hydraulic", "t_end": 1, "start": "steady", "probes": {"v": {"at": "v"}},
            "lines": {"p": {"nodes": ["r", "v"], **pipe}, "q": {"nodes": ["w", "e"], **pipe}},
            "loads": {"lake": {"at": "r", "kind": "reservoir", "pressure": 2e5}},
            "links": {"m": {"nodes": ["v", "w"], **moves}, "x": {"nodes": ["v", "w"], **relief}},
        }, tol=1e-3)
    """
    subprocess.run([sys.executable, "-c", code], check=True)
