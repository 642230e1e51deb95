"""Instants at which tline run gives its numbers."""

import csv
import json

import numpy as np
import pytest
from click.testing import CliRunner
from run_scenes import VALVE

from tline.cli.main import main
from tline.scene.file import read_scene
from tline.solver import simulate as simulation


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
