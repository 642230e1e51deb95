"""Which runs keep a ledger unasked."""

from pathlib import Path

import pytest

from tline import Scene, simulate
from tline.scene.file import read_scene
from tline.study.charts.scenes import chart_scene

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
