"""What tables, files and pictures of scenes with heights call their pressures."""

import csv
import json

import numpy as np
import pytest
from random_heights import WEIGHT, sloping

from tline import Result, Scene, plot, simulate, sweep
from tline.cli.report import as_table, judgement, summary
from tline.pictures import plot_space_time, route
from tline.pictures.sweep import plot_sweep
from tline.solver.result.export import save_csv, save_envelope, save_npz

pytestmark = pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")


@pytest.fixture(scope="module")
def high() -> Result:
    scene = sloping(3, 100.0, load="leak", start="steady", solver={"order": 3, "slab": 0.05})
    return simulate(scene, envelope=True, record=scene.lines)


def rows(path) -> list[list[str]]:
    with path.open() as file:
        return list(csv.reader(file))


def test_a_table_has_gauge_pressure_and_head(high):
    """At a summit a gauge shows less than density·g·head, perhaps a vacuum, which a note tells of, too."""
    accuracy = judgement(high)
    told = summary(high, accuracy)["probes"]["far"]
    assert list(told) == ["gauge pressure", "head", "flow"]
    elevation = float(high.scene.nodes["d"].elevation)
    for key in ("minimum", "maximum", "end"):
        assert told["head"][key] == pytest.approx(elevation + told["gauge pressure"][key] / WEIGHT, rel=1e-9)
    assert told["head"]["error"] == pytest.approx(told["gauge pressure"]["error"] / WEIGHT)
    text = as_table(high, accuracy)
    assert "gauge pressure [bar]" in text
    assert "head [m]" in text
    assert " pressure [" not in text.replace("gauge pressure", "")
    json.dumps(told)


def test_files_name_both(high, tmp_path):
    save_csv(high, tmp_path / "a.csv")
    head, *values = rows(tmp_path / "a.csv")
    assert head[1:4] == ["near gauge pressure [Pa]", "near head [m]", "near flow [m^3/s]"]
    np.testing.assert_array_equal([float(row[1]) for row in values], high.probes["near"].gauge_pressure)
    np.testing.assert_array_equal([float(row[2]) for row in values], high.probes["near"].head)
    save_npz(high, tmp_path / "a.npz")
    with np.load(tmp_path / "a.npz") as data:
        np.testing.assert_array_equal(data["far/gauge_pressure"], high.probes["far"].gauge_pressure)
        np.testing.assert_array_equal(data["far/head"], high.probes["far"].head)
        np.testing.assert_array_equal(data["far/u"], high.probes["far"].u)
    save_envelope(high, tmp_path / "e.csv")
    head, *values = rows(tmp_path / "e.csv")
    assert head[1] == "start gauge pressure [Pa]"
    assert head[-3:] == ["start head [m]", "lowest head [m]", "highest head [m]"]
    for node, *numbers in values:
        start, low, _, _, top, _, _, *heads = map(float, numbers)
        elevation = float(high.scene.nodes[node].elevation)
        np.testing.assert_allclose(heads, elevation + np.array([start, low, top]) / WEIGHT, rtol=1e-12)


def test_pictures_name_them(high):
    labels = [axes.get_ylabel() for axes in plot(high).axes]
    assert labels == ["gauge pressure [bar]", "head [m]", "flow [L/s]"]
    picture = plot_space_time(high, route(high.scene, "a", "d"))
    assert "head [m]" in [axes.get_ylabel() for axes in picture.axes]


def test_many_runs_at_heights_are_the_same_as_one_by_one(tmp_path):
    """With loads that let a steady flow out, and with one that does not."""
    table = sloping(7, load="resistor", solver={"tol": 1e-6}).table()
    loads = {"r": table["loads"]["end"], "c": {"at": "d", "kind": "series", "capacitance": "1e-8 m^3/Pa"}}
    lines = {k: v | {"length": 200} for k, v in table["lines"].items()}
    scene = Scene(**table | {"loads": loads, "lines": lines, "probes": {"far": {"at": "d"}}})
    times = np.linspace(0, 2.4, 9)
    runs = sweep(scene, {"loads.r.resistance": [1e7, 2e7]}, keep=["extremes", times])
    one = simulate(scene).probes["far"]
    seen = one.at(times)
    assert runs.method == "vectorised"
    for name in ("u", "gauge_pressure"):
        np.testing.assert_allclose(runs[name][0, 0], getattr(seen, name), rtol=0, atol=1e-5 * np.abs(one.u).max())
    np.testing.assert_allclose(runs["head"][0, 0], seen.head, rtol=0, atol=1e-5 * np.abs(one.head).max())
    runs.save(tmp_path / "many.csv")
    head, first, _ = rows(tmp_path / "many.csv")
    lowest = float(first[head.index("far lowest gauge pressure [Pa]")])
    assert lowest == pytest.approx(float(one.gauge_pressure.min()), abs=1e-4 * one.gauge_pressure.max())
    picture = plot_sweep(runs)
    assert picture.axes[0].get_ylabel().startswith("gauge pressure [")
