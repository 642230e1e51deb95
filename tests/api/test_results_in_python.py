"""Results in Python: a screen of text, tables and files of others, pictures, several of them on one axis."""

import copy
import pickle
import re
import sys

import numpy as np
import pandas
import pytest
import xarray
from matplotlib.figure import Figure

import tline as tl

CABLE, PIPE = tl.simulate(tl.examples["cable_rc"]), tl.simulate(tl.examples["water_pipe"])
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
    t, other = np.linspace(0, 12e-9, 999), way(CABLE)
    np.testing.assert_array_equal(other.probes["far"].at(t).u, CABLE.probes["far"].at(t).u)
    assert repr(other) == repr(CABLE)
    assert other.scene == CABLE.scene


def test_a_dataframe_has_what_the_probes_saw():
    frame = CABLE.to_dataframe()
    np.testing.assert_array_equal(frame["far", "u"], CABLE.probes["far"].u)
    np.testing.assert_array_equal(frame.index, CABLE.t)
    t = [1.5e-9, 3e-9]
    np.testing.assert_array_equal(CABLE.to_dataframe(t)["near", "y"], CABLE.probes["near"].at(t).y)
    assert {key for _, key in TOWN.to_dataframe().columns} == {"u", "y", "a", "b", "gauge_pressure", "head"}
    assert isinstance(frame, pandas.DataFrame)


def test_a_dataset_has_units_the_scene_and_its_accuracy():
    data = TOWN.to_xarray()
    assert (data.u.units, data.y.units, data["head"].units, data.time.units) == ("Pa", "m^3/s", "m", "s")
    np.testing.assert_array_equal(data["head"].sel(probe="b"), TOWN.probes["b"].head)
    assert CABLE.to_xarray().attrs["scene"] == CABLE.scene.to_toml()
    assert CABLE.to_xarray().attrs["error"] == CABLE.accuracy.worst
    alone = TOWN.scene.change({"probes.inner": {"at": "d"}})
    inner = tl.simulate(alone).to_xarray().sel(probe="inner")
    assert np.isfinite(inner.u).all()
    assert np.isnan(inner.y).all()


def test_files_give_the_numbers_back(tmp_path):
    for suffix in (".csv", ".npz", ".nc", ".h5", ".zarr"):
        CABLE.save(tmp_path / f"out{suffix}")
        CABLE.save(tmp_path / f"out{suffix}")  # one that exists is replaced
    u = CABLE.probes["far"].u
    np.testing.assert_array_equal(pandas.read_csv(tmp_path / "out.csv")["far voltage [V]"], u)
    np.testing.assert_array_equal(np.load(tmp_path / "out.npz")["far/u"], u)
    for suffix in (".nc", ".h5"):
        with xarray.open_dataset(tmp_path / f"out{suffix}", engine="h5netcdf") as data:
            np.testing.assert_array_equal(data.u.sel(probe="far"), u)
    np.testing.assert_array_equal(xarray.open_zarr(tmp_path / "out.zarr", consolidated=False).u.sel(probe="far"), u)


def test_pictures_are_shown_without_being_asked_to():
    imported = set(sys.modules)
    prepared = tl.prepare(CABLE.scene)
    several = {c: prepared.run({"loads.receiver.capacitance": c}) for c in ("2 pF", "8 pF")}
    pictures = [
        CABLE.plot(), CABLE.plot(quantity="current"), tl.plot(several, probes=["far"]), CABLE.plot_waves("far"),
        CABLE.plot_waves(line="cable"), PIPE.plot_space_time(), PIPE.plot_profile(), PIPE.plot_lattice(),
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
    small = CABLE.scene.change({"sources.driver.value.to": "1 mV"})
    CABLE.plot(axes, probes=["far"], label="1 V")
    assert tl.simulate(small).plot(axes, probes=["far"], label="1 mV") is axes
    first, second = axes.lines
    assert axes.get_ylabel() == "voltage at far [mV]"
    np.testing.assert_allclose(max(second.get_ydata()), max(first.get_ydata()) / 1000, rtol=1e-5)
    assert [text.get_text().strip() for text in axes.get_legend().get_texts()] == ["1 V", "1 mV"]
    assert first.get_color() != second.get_color()


def test_waves_are_what_the_effort_is_made_of():
    *_, effort = CABLE.plot_waves("far").axes[0].lines
    a, b = CABLE.plot_waves("far").axes[0].lines[:2]
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
        (lambda: CABLE.plot(probes=["fra"]), "probes: no such probe, expected 'far', got 'fra'"),
        (lambda: CABLE.plot(quantity="pressure"), "quantity: not known, expected one of 'voltage', 'current', got"),
        (lambda: CABLE.plot_waves(), "probe: several, and none is named, expected one of 'near', 'far'"),
        (lambda: CABLE.plot_waves("fra"), "probe: no such probe, expected 'far', got 'fra'"),
        (lambda: CABLE.plot_waves(line="cabel"), "line: no such line, expected 'cable', got 'cabel'"),
        (lambda: CABLE.save("out.xls"), "out.xls: unknown kind of file"),
        (lambda: CABLE.save("none/out.nc"), "none/out.nc: cannot be written"),
        (lambda: CABLE.to_dataframe([1.0]), "probes.near: instant not in the run"),
        (lambda: CABLE.plot_map(), "the run kept no envelope"),
        (lambda: CABLE.animate("x", "y"), "path: no such node"),
        (lambda: tl.plot({}), "results: not results"),
        (lambda: tl.plot(3), "results: not results"),  # pyright: ignore[reportArgumentType]
        (lambda: tl.plot({"a": CABLE, "b": PIPE}), "results: of two media"),
    ],
)
def test_mistakes_get_a_sentence(mistake, sentence):
    with pytest.raises(tl.InputError, match=re.escape(sentence)):
        mistake()


NEEDING = {
    "pandas": lambda: CABLE.to_dataframe(),
    "xarray": lambda: CABLE.to_xarray(),
    "h5netcdf": lambda: CABLE.save("out.nc"),
    "zarr": lambda: CABLE.save("out.zarr"),
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
