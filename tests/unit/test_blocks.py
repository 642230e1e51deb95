"""Nodes far from short lines go many slabs at once, and nothing comes out otherwise than slab by slab."""

import numpy as np
import pytest
from random_scenes import random_scene

from tline.scene.scene import Scene
from tline.solver.assembly import layout
from tline.solver.assembly.assemble import assemble
from tline.solver.assembly.layout import LONGEST, blocks_of
from tline.solver.description.description import describe
from tline.solver.description.resolution import Resolution
from tline.solver.kernel.network import Blocks
from tline.solver.run import run

SLAB = 0.05


def mixed(seed: int) -> Scene:
    """A random network in which one line is some slabs long; delays are not whole."""
    table = random_scene(seed, loads=True, sources=True).table()
    for k, line in enumerate(table["lines"].values()):
        line["delay"] *= 2 * SLAB if k == 0 else 1.0
    return Scene(**table)


def of_chain(delays: list[int]) -> Blocks:
    """The blocks of lines one after the other."""
    n = len(delays)
    ends = np.array([0, *(e for k in range(n - 1) for e in (2 * k + 1, 2 * k + 2)), 2 * n - 1])
    first = np.array([0, *range(1, 2 * n, 2), 2 * n])
    return blocks_of(np.array(delays), first, ends, np.arange(n + 2))


def test_a_short_line_keeps_only_its_own_nodes_back():
    found = of_chain([100] * 20 + [2] + [100] * 20)
    assert (found.stride, found.step) == (100, 2)
    assert found.near_lines.tolist() == [20]
    assert found.near_groups.tolist() == [20, 21]
    assert found.waits.sum() == 40


def test_equal_lines_are_all_far_and_lines_of_one_slab_all_near():
    equal, least = of_chain([7, 7, 7]), of_chain([1, 1])
    assert (equal.stride, equal.near_groups.size) == (7, 0)
    assert (least.stride, least.step, least.far_groups.size) == (LONGEST, 1, 0)


def test_a_node_without_lines_beside_lines_of_one_slab_makes_nothing_far_of_them():
    found = blocks_of(np.array([1]), np.array([0, 1, 2, 2]), np.array([0, 1]), np.arange(4))
    assert (found.stride, found.near_lines.tolist(), found.far_groups.tolist()) == (LONGEST, [0], [2])


@pytest.mark.parametrize("order", [1, 3])
@pytest.mark.parametrize("seed", range(4))
def test_the_same_comes_out_as_slab_by_slab(monkeypatch, seed, order):
    scene, resolution = mixed(seed), Resolution(order, SLAB)
    chosen = assemble(describe(scene), set(), resolution).network.blocks
    assert chosen.far_groups.size
    assert chosen.near_groups.size
    at_once = run(describe(scene), resolution).probes["p"].u
    assert np.abs(at_once).max() > 0
    monkeypatch.setattr(layout, "_stride", lambda *_: LONGEST)
    scene = mixed(seed)  # one that keeps no grid
    assert not assemble(describe(scene), set(), resolution).network.blocks.far_groups.size
    assert np.array_equal(at_once, run(describe(scene), resolution).probes["p"].u)
