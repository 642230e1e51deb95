"""One table tells what a probe shows, and at what instants: results, files, tables, plots and sweeps read it."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from one_line import FAR, one_line
from random_heights import sloping
from run_scenes import VALVE

import drives
import friction
import tline as tl
from tline import Scene, simulate
from tline.cli.main import main
from tline.cli.report import as_table, summary
from tline.scene.file import read_scene
from tline.solver import simulate as simulation
from tline.solver.result import quantities
from tline.solver.result.quantities import QUANTITIES, Bounds, Quantity, in_sweeps, quantity
from tline.study.charts.scenes import chart_scene

POWER = Quantity(
    "power",
    "power",
    "W",
    lambda seen: seen.u * seen.y,
    lambda off: off.largest_u * off.y + off.largest_y * off.u + off.u * off.y,
    flows=True,
)


@pytest.fixture
def with_power(monkeypatch):
    monkeypatch.setattr(quantities, "QUANTITIES", (*QUANTITIES, POWER))


def matched(**more) -> tl.Scene:
    ramp = {"shape": "ramp", "to": 2, "duration": "2 ns"}
    return one_line("20 ns", {"z0": 50, "delay": "3 ns"}, ramp, None, 20, **{"probes": FAR} | more)


@pytest.mark.usefixtures("with_power")
def test_a_new_column_is_one_entry(tmp_path):
    result = tl.simulate(matched(), tol=1e-6)
    power = result.probes["far"].u * result.probes["far"].y
    result.save(tmp_path / "a.csv")
    with (tmp_path / "a.csv").open() as file:
        head, *rows = csv.reader(file)
    np.testing.assert_array_equal([float(row[head.index("far power [W]")]) for row in rows], power)
    result.save(tmp_path / "a.npz")
    with np.load(tmp_path / "a.npz") as data:
        np.testing.assert_array_equal(data["far/power"], power)
    np.testing.assert_array_equal(result.to_dataframe()["far", "power"], power)
    assert result.to_xarray().power.attrs["units"] == "W"
    told = summary(result, result.accuracy, np.array([1e-8]))
    seen = told["probes"]["far"]["power"]
    assert seen["unit"] == "W"
    assert seen["maximum"] == pytest.approx(power.max(), rel=1e-3)
    assert 0 < seen["error_inside_slabs"] <= 3e-6 * seen["maximum"]
    assert told["samples"]["probes"]["far"]["power"]
    json.dumps(told)
    assert "power [mW]" in as_table(result, result.accuracy)
    assert "W …" in repr(result)
    assert len(result.plot(quantity="power").axes) == 1
    for values in ([20.0], [20.0, 30.0]):
        for scene in (matched(), matched(solver={"order": 4})):
            runs = tl.sweep(scene, {"loads.load.resistance": values}, keep=[5e-9, 15e-9])
            np.testing.assert_allclose(runs["power"], runs["u"] * runs["y"], rtol=1e-12)
            assert runs.unit("power") == "W"
            assert runs.dims("power") == ("probe", "time")


@pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")  # of fronts that are smeared
def test_u_is_one_number_everywhere(tmp_path):
    """In a scene with elevations the piezometric pressure, of single runs and of sweeps, one by one or side by side."""
    scene = sloping(3, 100.0, load="resistor", solver={"tol": 1e-5})
    times = [0.1, 0.2, 0.37]
    result = tl.simulate(scene)
    path = "loads.end.resistance"
    value = float(scene.loads["end"].resistance)
    for kept in (times, [times, lambda result: 0.0]):
        runs = tl.sweep(scene, {path: [value]}, keep=kept)
        for k, probe in enumerate(result.probes.values()):
            seen = probe.at(times)
            for each in in_sweeps(scene):
                of = each.of(seen)
                np.testing.assert_allclose(runs[each.key][0, k], of, rtol=0, atol=1e-4 * np.abs(of).max())
            assert np.abs(runs["u"] - runs["gauge_pressure"]).max() > 0
    result.save(tmp_path / "a.npz")
    with np.load(tmp_path / "a.npz") as data:
        for name, probe in result.probes.items():
            np.testing.assert_array_equal(data[f"{name}/u"], probe.u)


def test_errors_follow_from_those_of_effort_and_flow():
    off = Bounds(2.0, 0.5, 10.0, 4.0, 100.0, 3.0)
    found = {each.key: each.error(off) for each in QUANTITIES}
    assert found == {"u": 2.0, "gauge_pressure": 2.0, "head": 0.5, "y": 0.5, "a": 7.0, "b": 7.0}
    assert POWER.error(off) == 100 * 0.5 + 3 * 2 + 1.0
    assert quantity("y").flows


TORQUE = drives.Torque.step(0.1)
RESULTS = {
    "run": lambda: friction.simulate(friction.LuGre(), friction.Testbench(), 3.0, times=[0.0, 1.0, 3.0]),
    "moved": lambda: friction.prescribe(friction.Dahl(), velocity=friction.Sine(1.0, 0.25), times=[0.0, 0.5, 1.0]),
    "drives": lambda: drives.simulate(drives.CoupledDrives(), TORQUE, TORQUE, t_end=2.0, step=0.5),
}


@pytest.mark.parametrize("name", RESULTS)
def test_columns_are_saved_as_they_are(name, tmp_path):
    result = RESULTS[name]()
    columns = result.columns
    assert next(iter(columns)) == "t"
    assert columns.keys() - {"t"} <= result.units.keys()
    for suffix in (".csv", ".npz", ".json"):
        result.save(tmp_path / f"all{suffix}")
    head, *rows = (tmp_path / "all.csv").read_text().splitlines()
    assert head.split(",") == [*columns]
    assert [[float(cell) for cell in row.split(",")] for row in rows] == np.column_stack([*columns.values()]).tolist()
    with np.load(tmp_path / "all.npz") as arrays:
        assert {key: column.tolist() for key, column in arrays.items()} == {k: x.tolist() for k, x in columns.items()}
    whole = json.loads((tmp_path / "all.json").read_text())
    assert whole["columns"] == {key: column.tolist() for key, column in columns.items()}
    assert whole.items() >= json.loads(json.dumps(result.to_dict())).items()


def test_another_kind_of_file_is_refused(tmp_path):
    with pytest.raises(friction.InputError, match=r"unknown kind of file, expected \.csv, \.npz or \.json"):
        RESULTS["run"]().save(tmp_path / "all.txt")


SCENES = Path(__file__).parents[2] / "scenes"


@pytest.fixture
def rc() -> Scene:
    return chart_scene("rc").scene


def test_a_small_run_keeps_one_unless_told_not_to(rc):
    kept = simulate(rc).ledger
    assert kept is not None
    assert kept.notes == ()
    assert kept == simulate(rc, ledger=True).ledger
    assert simulate(rc, ledger=False).ledger is None


@pytest.mark.parametrize("limit", [8000, 40000])
def test_a_large_one_only_if_asked(monkeypatch, rc, limit):
    """Two nodes count as 8000 samples at line ends, and there are some thousand of those."""
    monkeypatch.setattr("tline.solver.run.LARGEST_LEDGER", limit)
    assert (simulate(rc).ledger is not None) == (limit > 8000)
    assert simulate(rc, ledger=True).ledger is not None


def test_coupled_conductors_keep_none():
    assert simulate(read_scene(SCENES / "coupled_pair.toml")).ledger is None


def test_instants_of_the_users_own(tmp_path):
    """Rows, JSON and arrays at the instants asked, as the probe's `at` has them."""
    (tmp_path / "valve.toml").write_text(VALVE)
    files = [f"--{kind}={tmp_path / f'out.{kind}'}" for kind in ("csv", "npz")]
    done = CliRunner().invoke(main, ["run", str(tmp_path / "valve.toml"), "--at", "0:2 s:21", "--json", *files])
    assert done.exit_code == 0, done.output
    samples = json.loads(done.stdout)["samples"]
    result = simulation.simulate(read_scene(tmp_path / "valve.toml"))
    expected = result.probes["middle"].at(np.linspace(0, 2, 21))
    assert samples["time"] == pytest.approx(np.linspace(0, 2, 21).tolist())
    assert samples["probes"]["middle"]["pressure"] == expected.u.tolist()
    with (tmp_path / "out.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [float(row["middle flow [m^3/s]"]) for row in rows] == expected.y.tolist()
    assert np.load(tmp_path / "out.npz")["middle/u"].tolist() == expected.u.tolist()


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("0:1 s", "not two instants and a count"),
        ("1 s:0:5", "does not run from an instant to a later one"),
        ("0:3 s:5", "ends after the run, expected at most 2 s"),
        ("0:1 s:1", "not a count, expected 2 to 10,000,000 instants"),
        ("0:1 bar:9", "this unit measures something else"),
    ],
)
def test_instants_that_are_refused(tmp_path, text, told):
    (tmp_path / "valve.toml").write_text(VALVE)
    done = CliRunner().invoke(main, ["run", str(tmp_path / "valve.toml"), "--at", text])
    assert done.exit_code == 2
    assert f"--at: {told}" in done.stderr
