"""What must not matter does not: directions, names and order, splitting a line, units; and the plain twin agrees."""

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from random_scenes import random_scene
from twin import efforts

from tline.scene.scene import Scene
from tline.solver.assemble import assemble
from tline.solver.kernel import SCRATCH
from tline.solver.simulate import simulate

SEEDS = st.integers(0, 2**32 - 1)
pytestmark = pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")
SOLVER = {"order": 4, "slab": 0.12}
# 170 slabs through some ten operations each; the amplitude is below 2
SAME = 1e-11


def probed(scene: Scene) -> np.ndarray:
    return simulate(scene).probes["p"].u


def changed(scene: Scene, **sections) -> Scene:
    return Scene(**{**scene.table(), **sections})


@settings(max_examples=25, deadline=None)
@given(seed=SEEDS)
def test_reversing_lines(seed):
    scene = random_scene(seed, sources=True, solver=SOLVER)
    turned = {k: line | {"nodes": line["nodes"][::-1]} for k, line in scene.table()["lines"].items()}
    assert np.abs(probed(scene) - probed(changed(scene, lines=turned))).max() < SAME


@settings(max_examples=25, deadline=None)
@given(seed=SEEDS)
def test_permuting_elements(seed):
    scene = random_scene(seed, sources=True, solver=SOLVER)
    rng = np.random.default_rng(seed)

    def shuffled(section):
        items = list(scene.table().get(section, {}).items())
        return dict(items[i] for i in rng.permutation(len(items)))

    assert np.abs(probed(scene) - probed(changed(scene, lines=shuffled("lines"), loads=shuffled("loads")))).max() < SAME


@settings(max_examples=25, deadline=None)
@given(seed=SEEDS, share=st.floats(0.2, 0.8))
def test_splitting_a_line(seed, share):
    """Exact when the parts are whole slabs: a junction of equal lines lets everything pass."""
    scene = random_scene(seed, sources=True, solver={"order": 4, "slab": 0.125})
    lines = {k: line | {"delay": round(line["delay"] / 0.125) * 0.125} for k, line in scene.table()["lines"].items()}
    whole = changed(scene, lines=lines)
    name, line = max(lines.items(), key=lambda item: item[1]["delay"])
    first = max(round(share * line["delay"] / 0.125), 1) * 0.125
    assume(first < line["delay"] and scene.probes["p"].line != name)
    parts = {
        name: line | {"nodes": [line["nodes"][0], "cut"], "delay": first},
        "rest": line | {"nodes": ["cut", line["nodes"][1]], "delay": line["delay"] - first},
    }
    assert np.abs(probed(whole) - probed(changed(scene, lines=lines | parts))).max() < SAME


@settings(max_examples=25, deadline=None)
@given(seed=SEEDS, factor=st.floats(1e-9, 1e9))
def test_rescaling_time(seed, factor):
    """All times, inductances and capacitances by one factor: the same samples."""
    scene = random_scene(seed, sources=True, solver=SOLVER)
    table = scene.table()
    scaled = {
        "t_end": table["t_end"] * factor,
        "solver": {"order": 4, "slab": 0.12 * factor},
        "lines": {k: line | {"delay": line["delay"] * factor} for k, line in table["lines"].items()},
        "loads": {
            k: {key: v * factor if key in ("inductance", "capacitance", "time") else v for key, v in load.items()}
            for k, load in table.get("loads", {}).items()
        },
        "sources": {
            k: source | {"value": source["value"] | {"frequency": 0.2 / factor, "until": 5.0 * factor}}
            for k, source in table["sources"].items()
        },
    }
    n = len(probed(scene))
    assert np.abs(probed(scene) - probed(changed(scene, **scaled))[:n]).max() < 1e-8  # scaled delays round differently


@settings(max_examples=25, deadline=None)
@given(seed=SEEDS, order=st.integers(1, 6), slab=st.floats(0.05, 0.45))
@example(seed=7, order=6, slab=0.003)  # a block of more slabs than one tile holds
@example(seed=8, order=1, slab=0.0009)
def test_the_kernel_is_its_plain_twin(seed, order, slab):
    scene = random_scene(seed, sources=True, solver={"order": order, "slab": slab})
    assembly = assemble(scene, set())
    node = assembly.nodes.index(scene.probes["p"].at)
    seen = probed(scene)[1 : max(61, 2 * SCRATCH // order)]
    plain = efforts(assembly, len(seen))[node, :, -1]
    assert np.abs(seen - plain).max() < SAME
