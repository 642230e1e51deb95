"""An envelope taken on the way, window by window, is that of a run whose record is kept whole."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings, strategies as st
from random_scenes import random_scene

from tline import InputError, simulate
from tline.scene.file import read_scene
from tline.solver.description.description import describe
from tline.solver.description.resolution import resolution
from tline.solver.loop import march
from tline.solver.result.dense_output import extremes
from tline.solver.result.result import ProbeResult
from tline.solver.run import run

SEEDS = st.integers(0, 10**6)
SAME = 1e-12  # roundings of another order
CLOSE = 1e-6  # places searched in a slab


def windowed_as_whole(scene, chosen, window):
    """Compare the two; `window` is in slabs."""
    lines = scene.lines
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(march, "LOOK", 2 * len(lines) * chosen.s * window)
        whole = run(describe(scene), chosen, record=lines)
        windowed = run(describe(scene), chosen, envelope=True)
    assert windowed.envelope is not None
    assert set(windowed.envelope.nodes) == {node for line in lines.values() for node in line.nodes}
    # the probe's record, put together from the windows, and its pieces
    t = np.linspace(0.0, whole.t[-1] * 0.99937, 777)  # no instant at which a front passes
    once, again = whole.probes["p"].at(t).u, windowed.probes["p"].at(t).u
    assert np.abs(once - again).max() <= SAME * np.abs(once).max()
    for node in windowed.envelope.nodes:
        name, line = next((name, line) for name, line in lines.items() if node in line.nodes)
        share = float(line.nodes[0] != node)
        record = replace(whole.lines[name], smeared=False)
        vars(record).update(at_end1=(record.a1, record.b1), at_end2=(record.a2, record.b2))  # as slabs were computed
        probe = ProbeResult(node, name, share, record, whole.slabs)
        seen, close = windowed.envelope.of(node), CLOSE * np.abs(probe.u).max()
        assert seen["start"] == pytest.approx(probe.u[0], abs=close)
        for extreme, (level, _) in zip(("lowest", "highest"), extremes(probe, "u"), strict=True):
            assert seen[extreme] == pytest.approx(level, abs=close)
            at = seen[f"{extreme}_at"] + np.array([-1e-7, 0.0, 1e-7]) * chosen.h  # either side of a jump
            assert np.abs(probe.at(np.clip(at, 0.0, probe.t[-1])).u - level).min() <= 10 * close


@settings(max_examples=5, deadline=None)
@given(seed=SEEDS, order=st.integers(1, 5), slab=st.floats(0.05, 0.45), window=st.integers(1, 400))
@example(seed=3, order=3, slab=0.1, window=7)
def test_window_by_window_as_from_the_whole(seed, order, slab, window):
    """Fronts of switches and sources at any instants, delays without common measure."""
    scene = random_scene(seed, sources=True, start="steady", solver={"order": order, "slab": slab})
    windowed_as_whole(scene, resolution(describe(scene)), window)


def test_a_node_that_is_not_there():
    scene = random_scene(1, solver={"order": 2, "slab": 0.2})
    envelope = run(describe(scene), resolution(describe(scene)), envelope=True).envelope
    assert envelope is not None
    with pytest.raises(InputError, match="'nowhere'"):
        envelope.of("nowhere")


NO_SKIN = {"lines.cable.skin": None}


@pytest.mark.parametrize(("file", "without"), [("pipe_friction", {}), ("lossy_cable", NO_SKIN), ("lossy_cable", {})])
def test_a_run_to_a_tolerance_with_losses_has_its_envelope(file, without):
    """In diamonds, in cells, by convolution; the extremes are those of slabs at least as narrow."""
    scene = read_scene(Path(__file__).parents[2] / "scenes" / f"{file}.toml").change(without)
    result = simulate(scene, tol=1e-3, envelope=True)
    assert result.envelope is not None
    for name, probe in scene.probes.items():
        k, u = result.envelope.nodes.index(probe.at), result.probes[name].u
        off = 2e-3 * np.abs(u).max()
        assert result.envelope.lowest[k] <= u.min() + off
        assert result.envelope.highest[k] >= u.max() - off
