"""Runs side by side are those of one scene at a time, whatever their order."""

from dataclasses import replace

import numpy as np
from hypothesis import given, settings, strategies as st

from tline import Scene, sweep
from tline.solver.description.description import describe
from tline.solver.description.resolution import Resolution
from tline.solver.many.batches import run as run_copies
from tline.solver.many.copies import copies_of, front_places, slab_edges
from tline.solver.run import run

ROUNDING = 7e-11  # of 36 slabs; the sum of modes at s = 9 rounds to 2e-12 in each
TIMES = np.linspace(0.05, 6.0, 40)
ELEMENTS = ("resistance", "inductance", "capacitance")


def scene(load, value=1.0):
    return Scene(
        medium="electrical",
        t_end=6.0,
        lines={
            "one": {"nodes": ["near", "middle"], "z0": 1.0, "delay": 0.5},
            "two": {"nodes": ["far", "middle"], "z0": 2.0, "delay": 1.0},
        },
        sources={"source": {"at": "near", "kind": "voltage", "value": value, "resistance": 0.5}},
        loads={"load": {"at": "far", **load}},
        probes={"middle": {"at": "middle", "line": "two"}, "far": {"at": "far"}},
    )


@settings(max_examples=4, deadline=None)
@given(
    kind=st.sampled_from(["series", "parallel"]),
    given_=st.sets(st.sampled_from(ELEMENTS), min_size=1),
    size=st.floats(0.2, 5.0),
    s=st.integers(2, 9),
    slabs=st.integers(1, 3),
)
def test_a_copy_alone_is_a_run_with_the_same_slabs(kind, given_, size, s, slabs):
    one = describe(scene({"kind": kind, **dict.fromkeys(sorted(given_), size)}))
    copies = copies_of(one, {"lines.one.z0": np.array([1.0])})
    ours = run_copies(
        one, copies, slab_edges(front_places(np.empty(0), copies.unit), slabs, 1.0), s, np.array([0]), TIMES
    )
    theirs = run(one, Resolution(s, 0.5 / slabs))
    for name, seen in ours.items():
        probe = theirs.probes[name]  # with the polynomials that slabs were computed with, which copies have
        samples = replace(probe, record=replace(probe.record, smeared=True)).at(TIMES)
        np.testing.assert_allclose(seen.u[0], samples.u, rtol=0, atol=ROUNDING)
        np.testing.assert_allclose(seen.y[0], samples.y, rtol=0, atol=ROUNDING)


def test_the_order_of_copies_does_not_matter():
    rng = np.random.default_rng(0)
    numbers = {"lines.one.z0": rng.uniform(0.5, 2, 150), "loads.load.capacitance": rng.uniform(0.5, 2, 150)}
    stretch = rng.uniform(0.5, 2, 150)
    numbers |= {"lines.one.delay": 0.5 * stretch, "lines.two.delay": stretch}
    one = scene({"kind": "series", "capacitance": 1.0}, {"shape": "ramp", "to": 1.0, "at": 0.3, "duration": 0.7})
    mixed = rng.permutation(150)
    straight = sweep(one, numbers, sample="list", keep=["extremes", TIMES])
    assert straight.method == "vectorised"
    mixed_numbers = {where: values[mixed] for where, values in numbers.items()}
    shuffled = sweep(one, mixed_numbers, sample="list", keep=["extremes", TIMES])
    for name in ("lowest", "lowest_at", "highest", "highest_at", "u", "y"):
        bound = 1e-6 if name.endswith("_at") else ROUNDING  # an extreme is flat: its instant is less certain
        np.testing.assert_allclose(straight[name][mixed], shuffled[name], rtol=0, atol=bound)
