"""The kernel's manners: it sees NaN, keeps within its arrays, flushes what has died away; blocks change nothing."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from one_line import one_line
from random_scenes import random_scene

from tline import InputError, simulate
from tline.scene.scene import Scene
from tline.solver.assembly import layout
from tline.solver.assembly.assemble import assemble
from tline.solver.assembly.layout import LONGEST, blocks_of
from tline.solver.description.description import describe
from tline.solver.description.resolution import Resolution
from tline.solver.kernel.arithmetic import LOOKS, TINY, after
from tline.solver.kernel.network import Blocks
from tline.solver.ledger.ledger import Recorder
from tline.solver.loop.march import advance
from tline.solver.loop.slabs import Slabs
from tline.solver.result.envelope import Extremes
from tline.solver.run import run

SILENT, UNRECORDED = np.zeros((0, 0)), np.zeros((0, 2, 0))


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_a_wave_that_is_no_number_is_reported(bad):
    assembly = assemble(describe(random_scene(1, loads=False, solver={"order": 3, "slab": 0.1})), set())
    assembly.state.waves[5] = bad
    assert advance(assembly.network, assembly.state, 100, SILENT, UNRECORDED, 0) >= 0


def test_a_wave_that_is_no_number_between_slab_ends_is_reported():
    """Whole delays and resistive nodes leave it inside its slab: no node sees it at an end, the last look does."""
    assembly = assemble(describe(random_scene(1, loads=False, solver={"order": 3, "slab": 0.1})), set())
    assembly.network.shift_row[:] = -1
    assembly.state.waves[1] = np.nan
    nodes = assembly.network.first.size - 1
    assert advance(assembly.network, assembly.state, 100, SILENT, UNRECORDED, 0) == nodes


def test_an_active_load_is_named_when_it_runs_away():
    amplifier = {"kind": "impedance", "expression": "-3 + s"}
    scene = one_line(1e5, {"z0": 1, "delay": 1}, 1, 3, amplifier, solver={"order": 2, "slab": 0.5})
    with pytest.raises(InputError, match=r"loads\.load: the waves grow beyond all bounds"):
        simulate(scene, active=True)


def test_waves_below_the_smallest_that_count_become_zero():
    assembly = assemble(describe(random_scene(2, loads=False, solver={"order": 2, "slab": 0.1})), set())
    assembly.state.waves[:] = 0.5 * TINY
    advance(assembly.network, assembly.state, 100, SILENT, UNRECORDED, 0)
    assert not assembly.state.waves.any()


def test_rows_that_ledgers_and_envelopes_record_are_theirs_alone():
    """The next run of the same scene has no room for them."""
    description = describe(random_scene(3, loads=False, solver={"order": 3, "slab": 0.1}))
    Recorder(assemble(description, set()), Slabs(10, 1.0, 10.0))
    Extremes(assemble(description, set()), Slabs(10, 1.0, 10.0))
    assert (assemble(description, set()).network.record_row < 0).all()


def test_no_access_outside_any_array(tmp_path):
    """Property tests that run the kernels with numba's bounds check on, in a cache of its own."""
    root = Path(__file__).parents[2]
    names = (
        "symmetry.py::test_the_kernel_is_its_plain_twin",
        "side_by_side.py::test_the_order_of_copies_does_not_matter",
    )
    tests = [str(root / "tests" / "property" / f"test_{name}") for name in names]
    environment = os.environ | {"NUMBA_BOUNDSCHECK": "1", "NUMBA_CACHE_DIR": str(tmp_path), "NUMBA_OPT": "0"}
    call = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *tests]
    done = subprocess.run(call, cwd=root, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout[-2000:]


@pytest.mark.parametrize("s", range(1, 17))
def test_each_look_is_beyond_the_last_one(s):
    places = [k / (LOOKS * s) for k in range(LOOKS * s + 1)]
    assert [after(place, s) for place in places[:-1]] == places[1:]


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
