"""Column separation, measured in the laboratory; see docs/measured.md."""

import runpy
from pathlib import Path

import pytest

MEASURED = runpy.run_path(str(Path(__file__).parents[2] / "docs" / "generate_measured.py"))


@pytest.mark.filterwarnings("ignore:fronts")  # spikes of collapses, more than a slab may hold
@pytest.mark.parametrize("experiment", MEASURED["EXPERIMENTS"], ids=lambda one: one.file)
def test_a_late_valve_gives_the_first_cavity_its_length_and_the_next_pulse_its_height(experiment):
    """Nothing is fitted, and how the valve shuts is not known: to half of its time, and to a fifth."""
    figures, (friction, *_) = MEASURED["figures"], MEASURED["FRICTION"]
    level, gone, highest, when = figures(experiment, *experiment.measured())
    t, u = experiment.computed(friction, 31, late=True)
    first, ours, high, then = figures(experiment, t, u, u)
    assert first == pytest.approx(level, rel=0.05)
    assert abs(ours - gone) < experiment.closes / 2
    assert high == pytest.approx(highest, rel=0.2)
    assert abs(then - when) < experiment.closes


@pytest.mark.filterwarnings("ignore:fronts")
@pytest.mark.parametrize("experiment", MEASURED["EXPERIMENTS"][::2], ids=lambda one: one.file)
def test_at_small_speeds_a_late_valve_is_nearer_to_the_measured_line(experiment):
    friction = MEASURED["FRICTION"][0]
    off = [MEASURED["off"](experiment, *experiment.computed(friction, 31, late)) for late in (False, True)]
    assert off[1] < 0.7 * off[0]
