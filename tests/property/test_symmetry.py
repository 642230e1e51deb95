"""What must not matter does not: directions, names and order, splitting a line, units; and the plain twin agrees."""

import numpy as np
import pytest
from hypothesis import assume, example, given, settings, strategies as st
from random_scenes import random_scene
from twin import efforts, efforts_in_pieces

from tline import Scene, simulate
from tline.solver.assembly.assemble import assemble
from tline.solver.assembly.workspace import SAMPLES
from tline.solver.description.description import describe
from tline.solver.description.resolution import Resolution, resolution
from tline.solver.loop.march import Stepper
from tline.solver.run import run

SEEDS = st.integers(0, 2**32 - 1)
pytestmark = pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")
SOLVER = {"order": 4, "slab": 0.12}
# 170 slabs through some ten operations each; the amplitude is below 2
SAME = 1e-11
LUMPED = st.dictionaries(st.sampled_from(["l0", "l1", "l2"]), st.integers(1, 3), max_size=2)  # LC sections


def apart(one: Scene, other: Scene) -> float:
    """Largest difference, beside what fronts beyond the number that a slab may hold cost: which, is luck."""
    results = simulate(one), simulate(other)
    seen = [result.probes["p"] for result in results]
    n = min(len(probe.u) for probe in seen)
    smeared = sum(result.fronts.lost * np.abs(probe.a).max() for result, probe in zip(results, seen, strict=True))
    return np.abs(seen[0].u[:n] - seen[1].u[:n]).max() - smeared


def lumping(scene: Scene, lumped: dict[str, int]) -> Resolution:
    """As the scene says, with some lines in so many LC sections, but not the one that is probed."""
    return resolution(describe(scene), sections={k: n for k, n in lumped.items() if k != scene.probes["p"].line})


def changed(scene: Scene, **sections) -> Scene:
    return Scene(**{**scene.table(), **sections})


@settings(max_examples=6, deadline=None)
@given(seed=SEEDS)
def test_reversing_lines(seed):
    scene = random_scene(seed, sources=True, solver=SOLVER)
    turned = {k: line | {"nodes": line["nodes"][::-1]} for k, line in scene.table()["lines"].items()}
    assert apart(scene, changed(scene, lines=turned)) < SAME


@settings(max_examples=6, deadline=None)
@given(seed=SEEDS)
def test_permuting_elements(seed):
    scene = random_scene(seed, sources=True, solver=SOLVER)
    rng = np.random.default_rng(seed)

    def shuffled(section):
        items = list(scene.table().get(section, {}).items())
        return dict(items[i] for i in rng.permutation(len(items)))

    assert apart(scene, changed(scene, lines=shuffled("lines"), loads=shuffled("loads"))) < SAME


@settings(max_examples=6, deadline=None)
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
    assert apart(whole, changed(scene, lines=lines | parts)) < SAME


@settings(max_examples=6, deadline=None)
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
    assert apart(scene, changed(scene, **scaled)) < 1e-8  # scaled delays round differently


@settings(max_examples=6, deadline=None)
@given(seed=SEEDS, order=st.integers(1, 6), slab=st.floats(0.05, 0.45), lumped=LUMPED)
@example(seed=7, order=6, slab=0.003, lumped={})  # a block of more slabs than one tile holds
@example(seed=8, order=1, slab=0.0009, lumped={})
def test_the_kernel_is_its_plain_twin(seed, order, slab, lumped):
    """Block by block, no front followed; lumped lines join nodes to groups."""
    scene = random_scene(seed, sources=True, switches=False, solver={"order": order, "slab": slab})
    line = scene.probes["p"].line
    assembly = assemble(describe(scene), {line}, lumping(scene, lumped))
    node, n = [*assembly.nodes].index(scene.probes["p"].at), max(60, 2 * SAMPLES // order)
    plain = efforts(assembly, n)[node, :, -1]
    record = np.empty((2, 2, n * order))
    steps = Stepper(assembly, n, record)
    steps.fronts = None
    steps.advance(0, n)
    side = scene.lines[line].nodes.index(scene.probes["p"].at)
    assert np.abs(record[side].mean(axis=0)[order - 1 :: order] - plain).max() < SAME


@settings(max_examples=4, deadline=None)
@given(seed=SEEDS, order=st.integers(1, 6), slab=st.floats(0.1, 0.45), whole=st.booleans(), lumped=LUMPED)
def test_the_kernel_with_fronts_is_its_plain_twin(seed, order, slab, whole, lumped):
    """Every front followed from end to end, sources and switches at any instants; or lumped lines."""
    scene = random_scene(seed, lines=3, sources=True, switches=not lumped, solver={"order": order, "slab": slab})
    if whole:
        lines = {k: line | {"delay": max(round(line["delay"] / slab), 1) * slab} for k, line in lines_of(scene).items()}
        scene = changed(scene, lines=lines)
    chosen = lumping(scene, lumped)
    result, assembly = run(describe(changed(scene, t_end=8.0)), chosen), assemble(describe(scene), set(), chosen)
    assume(result.fronts.dropped == result.fronts.dissolved == 0)
    seen = result.probes["p"].at_slab_ends.u[1:]
    plain = efforts_in_pieces(assembly, len(seen))[[*assembly.nodes].index(scene.probes["p"].at)]
    assert np.abs(seen - plain).max() < SAME


def lines_of(scene: Scene) -> dict:
    return scene.table()["lines"]
