"""Scenes with circuits against their equations written by hand, and the electrical ones against ngspice."""

import shutil
from functools import cache
from pathlib import Path

import pytest
from circuit_decks import DECKS, in_ngspice
from electrical_by_hand import ELECTRICAL
from hydraulic_by_hand import HYDRAULIC

from tline.scene.file import read_scene
from tline.solver.simulate import simulate

SCENES = Path(__file__).parents[2] / "scenes"
STEPS = {"ac_coupled": 80}  # of ngspice in the shortest delay; many delays make it slow
BY_HAND = ELECTRICAL | HYDRAULIC


@cache
def result_of(name):
    return simulate(read_scene(SCENES / f"{name}.toml"), tol=1e-9)


@pytest.mark.parametrize("name", BY_HAND)
def test_a_scene_is_its_delay_equations(name):
    """SciPy's DOP853 at 1e-13, from corner to corner and from event to event, of which steps halved show 2e-11."""
    result = result_of(name)
    at_slab_ends = BY_HAND[name].differences(result.probes)
    assert max(at_slab_ends.values()) < 1e-9, at_slab_ends
    inside = BY_HAND[name].differences(result.probes, inside=500)
    assert max(inside.values()) < 1e-8, inside


@pytest.mark.skipif(shutil.which("ngspice") is None, reason="ngspice is not installed")
@pytest.mark.parametrize("name", DECKS)
def test_ngspice_agrees_within_its_own_error(name):
    """Which is a third of what halving its steps changes, as it is of second order."""
    result = result_of(name)
    steps = STEPS.get(name, 640)
    coarse, fine = (in_ngspice(name, result, n) for n in (steps, 2 * steps))
    assert fine.distance < fine.change(coarse) + 1e-12
    assert fine.distance < 1e-3
