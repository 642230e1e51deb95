"""Which runs a sweep consists of, what it keeps, how failures look; and searches of the smallest size."""

import numpy as np
import pytest
import xarray
from scipy import stats

import tline as tl
from tline.design.search import PRECISION, SizeSearch, Trial, rounded, smallest
from tline.sweeps.design import design

LINE = {
    "medium": "electrical",
    "t_end": 4.0,
    "lines": {"line": {"nodes": ["near", "far"], "z0": 50.0, "delay": 1.0}},
    "sources": {"s": {"at": "near", "kind": "voltage", "value": {"shape": "step", "to": 1.0}, "resistance": 50.0}},
    "loads": {"r": {"at": "far", "kind": "resistor", "resistance": 100.0}},
    "probes": {"far": {"at": "far"}},
}
SCENE = tl.Scene(**LINE)
Z0, R = "lines.line.z0", "loads.r.resistance"


def drawn(sample, values="uniform(0, 1)", seed=0):
    return design(SCENE, {Z0: values, R: "uniform(0, 1)"}, sample, seed).column(Z0)


def test_a_grid_has_every_combination_and_the_last_path_changes_fastest():
    found = design(SCENE, {Z0: [40, 50], R: "1 ohm:100 ohm:3:log"}, None, 0)
    assert (found.shape, found.sample) == ((2, 3), "grid")
    np.testing.assert_allclose(found.column(Z0), [40, 40, 40, 50, 50, 50])
    np.testing.assert_allclose(found.column(R), [1, 10, 100, 1, 10, 100])
    assert found.rows(np.array([4]))[0] == {Z0: 50, R: pytest.approx(10)}


def test_a_list_has_values_side_by_side():
    found = design(SCENE, {Z0: "40 ohm, 0.05 kohm", R: np.array([1.0, 2.0])}, "list", 0)
    assert found.rows(np.arange(2)) == [{Z0: 40.0, R: 1.0}, {Z0: 50.0, R: 2.0}]


@pytest.mark.parametrize("kind", ["latin", "sobol"])
def test_every_stratum_is_drawn_from_once(kind):
    assert sorted((64 * drawn(f"{kind}:64")).astype(int)) == [*range(64)]


@pytest.mark.parametrize("kind", ["random", "latin", "sobol"])
def test_seeds(kind):
    np.testing.assert_array_equal(drawn(f"{kind}:8"), drawn(f"{kind}:8", seed="0"))
    assert not np.isin(drawn(f"{kind}:8"), drawn(f"{kind}:8", seed=1)).any()


@pytest.mark.parametrize(
    ("text", "known"),
    [
        ("uniform(40 ohm, 0.06 kohm)", stats.uniform(40, 20)),
        ("normal(50, 2 ohm)", stats.norm(50, 2)),
        ("loguniform(1, 100)", stats.loguniform(1, 100)),
    ],
)
def test_distributions_are_those_of_scipy(text, known):
    np.testing.assert_allclose(drawn("latin:50", text), drawn("latin:50", known), rtol=1e-12)
    assert stats.kstest(drawn("random:2000", text), known.cdf).pvalue > 1e-3  # one seed in a thousand


def test_of_a_list_values_are_equally_probable():
    assert np.unique(drawn("latin:60", [40, 50, 60]), return_counts=True)[1].tolist() == [20, 20, 20]


def test_texts_and_tables_vary_too():
    shapes = [{"shape": "step", "to": 1.0}, {"shape": "ramp", "to": 1.0, "duration": 2.0}]
    found = tl.sweep(SCENE, {"sources.s.value": shapes, "loads.r.kind": ["resistor"]}, keep=[1.5], tol=1e-4)
    np.testing.assert_allclose(found["u"].ravel(), [2 / 3, 2 / 3 / 4], atol=1e-4)
    assert found["sources.s.value"][0] == str(shapes[0])


def test_a_failed_run_is_a_row_whatever_failed():
    def picky(result):
        if float(result.scene.lines["line"].z0) > 70:
            raise ZeroDivisionError("too\nmuch")
        return np.zeros(2 if float(result.scene.lines["line"].z0) > 55 else 3)

    found = tl.sweep(SCENE, {Z0: [40, 50, 60, -1, 80]}, keep=picky, tol=1e-3)
    assert found.errors == {
        0: "keep: picky has another shape than before",
        1: "keep: picky has another shape than before",
        3: "lines.line.z0: z0 out of range, expected more than 0, got -1",
        4: "ZeroDivisionError: too much",
    }
    assert (found.good.tolist(), found["picky"].shape) == ([2], (5, 2))
    first, second = repr(found).splitlines()
    assert first == "lines.line.z0; kept: estimate, picky"
    assert second.startswith("5 runs, 4 failed in ")


def test_a_grid_is_a_dataset_with_its_axes(tmp_path):
    found = tl.sweep(SCENE, {Z0: [40, 50], R: [50, 100, -1]}, keep=["extremes", [0.5, 1.5]], tol=1e-4)
    there = found.to_xarray()
    assert dict(there.sizes) == {Z0: 2, R: 3, "probe": 1, "time": 2}
    assert float(there.highest.sel({Z0: 50, R: 100, "probe": "far"})) == pytest.approx(2 / 3, abs=1e-4)
    assert there.error.sel({Z0: 40, R: -1}).item().startswith("loads.r.resistance: ")
    assert (there.u.attrs["units"], there.highest_at.attrs["units"]) == ("V", "s")
    assert tl.Scene(**__import__("tomllib").loads(there.attrs["scene"])) == SCENE
    found.save(tmp_path / "runs.nc")
    with xarray.open_dataset(tmp_path / "runs.nc", engine="h5netcdf") as read:
        xarray.testing.assert_identical(read.load().drop_attrs(), there.drop_attrs())


def test_runs_that_are_no_grid_have_one_axis():
    found = tl.sweep(SCENE, {Z0: "uniform(40, 60)"}, sample="latin:4", tol=1e-4).to_xarray()
    assert found.highest.dims == ("run", "probe")
    assert found[Z0].dims == ("run",)


def test_a_table_has_a_row_for_each_run(tmp_path):
    found = tl.sweep(SCENE, {Z0: [50, -1]}, keep={"end": lambda result: result.probes["far"].u[-2:]}, tol=1e-4)
    found.save(tmp_path / "runs.csv")
    head, first, second = (tmp_path / "runs.csv").read_text().splitlines()
    assert head == "lines.line.z0,estimate,end 0,end 1,error"
    assert first.endswith(",")
    assert second.startswith("-1.0,nan,nan,nan,")


def test_an_instant_that_rounding_puts_behind_the_end_is_the_end():
    late, end = (tl.sweep(SCENE, {Z0: [50]}, keep=[t])["u"] for t in (np.nextafter(4.0, 5.0), 4.0))
    np.testing.assert_array_equal(late, end)


def test_unknown_names_are_refused_with_the_nearest():
    found = tl.sweep(SCENE, {Z0: [50]}, tol=1e-4)
    with pytest.raises(tl.InputError, match="sweep: holds no such array, expected 'highest', got 'higest'"):
        found["higest"]


@pytest.mark.parametrize(
    ("vary", "more", "sentence"),
    [
        ({}, {}, "vary: nothing varies"),
        ({Z0: 50}, {}, "lines.line.z0: not a sequence of values, expected values, FROM:TO:COUNT"),
        ({Z0: []}, {}, "lines.line.z0: no values, or too many, expected 1 to 1,000,000, got 0"),
        ({Z0: [50], 'lines."line".z0': [60]}, {}, "varies twice"),
        ({Z0: [50], R: range(1000), "t_end": range(100000)}, {}, "vary: too many runs, expected at most 10,000,000"),
        ({Z0: "normal(20 degC, 2 degC)"}, {"sample": "latin:3"}, "lines.line.z0: a deviation is no temperature"),
        ({Z0: [50]}, {"keep": "lowest"}, "keep: unknown, expected 'extremes', instants in s"),
        ({Z0: [50]}, {"keep": [5.0]}, "keep: not instants of the run, expected 0 to 4 s, got 5 s"),
        ({Z0: [50]}, {"keep": lambda result: 1}, None),
        (
            {Z0: [50]},
            {"keep": {"u": lambda result: 1}},
            "keep: 'u' cannot name an array, expected a dict with another name",
        ),
        ({Z0: [50]}, {"workers": 0}, "workers: not a whole number in range"),
        ({Z0: [50]}, {"tol": 1.0}, "tol: tolerance out of range"),
    ],
)
def test_mistakes_are_told_in_one_sentence(vary, more, sentence):
    if sentence is None:
        assert "lambda" in tl.sweep(SCENE, vary, **more).kept
        return
    with pytest.raises(tl.InputError) as told:
        tl.sweep(SCENE, vary, **more)
    assert sentence in str(told.value)
    assert "\n" not in str(told.value)


def test_missing_xarray_is_told_with_the_line_that_installs_it(monkeypatch):
    found = tl.sweep(SCENE, {Z0: [50]}, tol=1e-4)
    monkeypatch.setitem(__import__("sys").modules, "xarray", None)
    with pytest.raises(tl.InputError, match=r"to_xarray: xarray is missing, expected pip install .*\[data\]'"):
        found.to_xarray()


def search(margin, first=1.0, largest=float("inf"), error=0.0):
    runs = []

    def run(size):
        runs.append(size)
        return Trial(size, 0.0, 0.0, margin(size), error)

    return smallest(run, first, largest), runs


def size_of(search: SizeSearch) -> float:
    assert search.found is not None
    return search.found.size


@pytest.mark.parametrize("root", [3e-4, 0.17, 1.0, 42.0, 3e4])
@pytest.mark.parametrize("law", [lambda x: x - 1, lambda x: 1 - x**-2.0, lambda x: (x - 1) ** 3, lambda x: x**8 - 1])
def test_the_size_is_the_root_from_above_with_few_runs(root, law):
    found, runs = search(lambda size: law(size / root))
    assert root * (1 - 1e-12) <= size_of(found) <= root * PRECISION * 1.001
    assert len(runs) == len(set(runs)) <= 45
    assert found.turns is None


def test_a_plateau_and_a_jump_are_bisected():
    found, _ = search(lambda size: -1.0 if size < 7.77 else 1.0)
    assert size_of(found) == pytest.approx(7.77, rel=3e-3)


def test_a_larger_size_that_fails_is_seen_and_passed():
    found, _ = search(lambda size: -1.0 if size < 2 or 4 < size < 6 else 1.0)
    assert size_of(found) == pytest.approx(6, rel=3e-3)
    assert found.turns is not None


def test_errors_of_the_runs_are_no_turn():
    found, _ = search(lambda size: size - 3 + 1e-3 * (-1) ** round(1e6 * size), error=2e-3)
    assert found.turns is None


def test_where_none_is_large_enough_nothing_is_found():
    found, runs = search(lambda size: -1 / size, largest=10.0)
    assert found.found is None
    assert max(runs) == 10.0


def test_where_all_are_large_enough_the_smallest_tried_is_found():
    found, runs = search(lambda size: 1.0)
    assert size_of(found) == min(runs)


def test_sizes_have_four_digits():
    assert (rounded(0.00123456), rounded(123456.0)) == (0.001235, 123500.0)


def test_a_size_that_is_not_enough_is_told_with_its_unit():
    scene = tl.examples["pump_trip"].change({"t_end": "10 s"})
    with pytest.raises(
        tl.InputError, match=r"lowest: no size up to \d+ kg m\^2 keeps this gauge pressure at all nodes"
    ):
        tl.design.flywheel(scene, "pump", lowest="3.9999 bar", tol=1e-2)


def test_what_trials_do_not_resolve_is_a_note_and_no_warning():
    fast = {"at": "valve", "kind": "parallel", "resistance": 1e12, "capacitance": 1e-14}
    scene = tl.examples["valve_closure"].change({"loads.fast": fast, "solver": {"order": 2, "slab": "0.05 s"}})
    found = tl.design.closure(scene, "valve", highest="12 bar")
    assert [note for note in found.notes if note.startswith("loads.fast: its time scale")]
