"""Friction all along: the error at slab ends falls with the order, for fronts at any instant and any delays."""

import numpy as np
import pytest
from diamond_scenes import RISE, at_once, pipes, shut

from tline.solver.description.description import describe
from tline.solver.description.resolution import Resolution
from tline.solver.run import run

T_END = 8.0


def errors(scene, order: int, parts) -> np.ndarray:
    """Largest errors at whole delays, with so many slabs a delay, against a far finer run of a high order."""
    t, found = np.arange(1.0, T_END), []
    for s, n in ((8, 8), *((order, n) for n in parts)):
        found.append(run(describe(scene), Resolution(s, 1 / n, diamonds=True)).probes["valve"].at(t).u / RISE)
    return np.abs(np.array(found[1:]) - found[0]).max(axis=1)


def slope(parts, found) -> float:
    return -np.polyfit(np.log(parts), np.log(found), 1)[0]


@pytest.mark.parametrize(("order", "declared"), [(2, 2), (3, 4), (4, 6)])
def test_whole_slabs(order, declared):
    parts = [1, 2, 4] if order < 4 else [1, 2]
    scene = shut(at_once(0.0), pipes(1.0, kind="darcy", factor=0.4), T_END)
    assert slope(parts, errors(scene, order, parts)) > declared - 0.1


@pytest.mark.parametrize("order", [2, 3, 4])
def test_any_delays_and_fronts_at_any_instant(order):
    """The root mean square over random ones: where a front lies in its slab changes from width to width."""
    parts, rng = [1, 2, 4, 8], np.random.default_rng(1)
    scenes = [shut(at_once(a), pipes(1.0, 1 + d, kind="darcy", factor=0.4), T_END) for a, d in rng.random((4, 2))]
    found = np.array([errors(scene, order, parts) for scene in scenes])
    assert slope(parts, np.sqrt((found**2).mean(axis=0))) > order - 0.4
