"""One table tells what a probe shows: results, files, tables, plots and sweeps read it."""

import csv
import json

import numpy as np
import pytest
from one_line import FAR, one_line
from random_heights import sloping

import tline as tl
from tline.cli.report import as_table, summary
from tline.solver.result import quantities
from tline.solver.result.quantities import QUANTITIES, Bounds, Quantity, in_sweeps, quantity

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
