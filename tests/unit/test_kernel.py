"""The kernel's manners: it sees NaN, keeps within its arrays, and flushes what has died away."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from one_line import one_line
from random_scenes import random_scene

from tline import InputError, simulate
from tline.solver.assembly.assemble import assemble
from tline.solver.description.description import describe
from tline.solver.kernel.arithmetic import LOOKS, TINY, after
from tline.solver.ledger.recorder import Recorder
from tline.solver.loop.march import advance
from tline.solver.loop.slabs import Slabs
from tline.solver.result.envelope import watch

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
    watch(assemble(description, set()), Slabs(10, 1.0, 10.0))
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
