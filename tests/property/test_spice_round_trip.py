"""A scene written as netlist and read again does the same."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from tline import Scene, simulate
from tline.interchange import read_spice, spice_text

NS, level = 1e-9, st.floats(-3, 3)
SURGE = {"shape": "double exponential", "rise": 0.4 * NS, "decay": 2 * NS}
SHAPES = st.one_of(
    level,
    st.builds(lambda to, at: {"shape": "ramp", "to": to, "at": at * NS, "duration": NS}, level, st.floats(-3, 3)),
    st.builds(
        lambda low, high, at, period: {
            "shape": "pulses", "low": low, "high": high, "at": at * NS, "rise": 0.3 * NS, "fall": 0.2 * NS,
            "width": NS,
        } | ({"period": period * NS} if period else {}),
        level, level, st.floats(0, 3), st.none() | st.floats(1.6, 30),
    ),
    st.builds(
        lambda a, f, at, phase: {"shape": "sine", "amplitude": a, "frequency": f / NS, "at": at * NS, "phase": phase},
        level, st.floats(0.05, 0.5), st.floats(0, 2), st.floats(-3, 3),
    ),
    st.builds(
        lambda low, to, at: {"shape": "exponential", "from": low, "to": to, "at": at * NS, "time_constant": 0.7 * NS},
        level, level, st.floats(0, 3),
    ),
    st.builds(
        lambda peak, at: SURGE | {"peak": peak, "at": at * NS},
        level, st.floats(0, 3),
    ),
)  # fmt: skip
R, L, C = st.floats(5, 500), st.floats(1e-9, 1e-7), st.floats(1e-13, 1e-11)
KINDS = st.sampled_from(["series", "parallel"])
LOADS = st.one_of(
    st.sampled_from([{"kind": "open"}, {"kind": "short"}, {"kind": "matched"}]),
    st.builds(lambda r: {"kind": "resistor", "resistance": r}, R),
    st.builds(lambda k, r, c: {"kind": k, "resistance": r, "capacitance": c}, KINDS, R, C),
    st.builds(lambda r, x, c: {"kind": "series", "resistance": r, "inductance": x, "capacitance": c}, R, L, C),
    st.builds(lambda r, x: {"kind": "impedance", "expression": f"{r!r}*s*{x!r}/({r!r} + s*{x!r})"}, R, L),
)  # fmt: skip
LINKS = st.one_of(
    st.builds(lambda r: {"kind": "gyrator", "resistance": r}, R),
    st.builds(lambda gain, r: {"kind": "controlled source", "gain": gain, "resistance": r}, st.floats(0.1, 3), R),
    st.builds(
        lambda one, two, k: {"kind": "coupled inductors", "inductance": [one, two], "coupling": k},
        L, L, st.floats(-0.9, 0.9).map(lambda k: round(k, 6)),
    ),
    st.builds(
        lambda z0, a, b: {"kind": "junction", "z0": z0, "scattering": [[a, b], [0.3, -a]]},
        R, st.floats(-0.6, 0.6), st.floats(-0.6, 0.6),
    ),
)  # fmt: skip


@st.composite
def scenes(draw):
    """A chain of lines with a source in front, one in the middle, loads, and perhaps a multiport beyond the end."""
    n = draw(st.integers(1, 3))
    kind = st.sampled_from(["voltage", "current"])
    lines = {
        f"line {k}": {"nodes": [f"n {k}", f"n {k + 1}"], "z0": draw(R), "delay": draw(st.floats(0.5, 2)) * NS}
        for k in range(n)
    }
    front = {"at": "n 0", "kind": draw(kind), "value": draw(SHAPES), "resistance": draw(R)}
    beside = {"at": f"n {draw(st.integers(0, n))}", "kind": "current", "value": draw(SHAPES)}
    loads = {"end": {"at": f"n {n}"} | draw(LOADS)}
    if n > 1 and draw(st.booleans()):
        loads["middle"] = {"at": "n 1", "kind": "parallel", "resistance": draw(R), "capacitance": draw(C)}
    probes = {"near": {"at": "n 0"}, "far": {"at": f"n {n}"}}
    start = draw(st.sampled_from(["rest", "steady"]))
    sources = {"front": front} | ({"beside": beside} if draw(st.booleans()) else {})
    if start == "rest" and loads["end"]["kind"] != "matched" and draw(st.booleans()):
        link, lines["beyond"] = draw(LINKS), {"nodes": ["m 0", "m 1"], "z0": draw(R), "delay": NS}
        probes["beyond"], links = {"at": "m 1"}, {"link": {"nodes": [f"n {n}", "m 0"]} | link}
    else:
        links = {}
    return {
        "medium": "electrical", "t_end": 8 * NS, "start": start, "lines": lines, "sources": sources, "loads": loads,
        "links": links, "probes": probes, "solver": {"order": 7, "slab": 0.05 * NS},
    }  # fmt: skip


@settings(max_examples=30, deadline=None)
@given(table=scenes())
@pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")
def test_scene_to_netlist_to_scene_gives_the_same_transient(table):
    scene = Scene(**table)
    with TemporaryDirectory() as folder:
        file = Path(folder, "scene.cir")
        file.write_text(spice_text(scene), encoding="utf-8")
        again = read_spice(file)[0]
    again = Scene(**again.table() | {"solver": table["solver"]})
    assert len(again.lines) == len(scene.lines)
    ours, theirs = simulate(scene, active=True), simulate(again, active=True)
    for one, other in zip(ours.probes.values(), theirs.probes.values(), strict=True):
        size = max(np.abs(one.u).max(), one.record.z0 * np.abs(one.y).max(), 1e-3)  # of waves, whose parts u and y are
        assert np.abs(one.u - other.u).max() <= 1e-9 * size  # rounding of the values written
        assert np.abs(one.y - other.y).max() <= 1e-9 * size / one.record.z0
