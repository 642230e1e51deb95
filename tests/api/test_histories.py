"""Results over time of friction and drives: the same columns in Python, in a table, in arrays and as plain data."""

import json

import numpy as np
import pytest

import drives
import friction

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
