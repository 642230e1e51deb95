"""Coupled conductors against lattices of modes, single lines where symmetric, and circuits at their ends."""

import numpy as np
import pytest

from tline import InputError, Scene, simulate

NS = 1e-9
EVEN, ODD = (60.0, 1.1 * NS), (40.0, 0.9 * NS)
PAIR = {
    "nodes1": ["a1", "a2"], "nodes2": ["b1", "b2"], "even": {"z0": 60, "delay": "1.1 ns"},
    "odd": {"z0": 40, "delay": "0.9 ns"},
}  # fmt: skip
RAMP = {"shape": "ramp", "to": 1, "at": "0.13 ns", "duration": "0.21 ns"}
PROBES = {at: {"at": at} for at in ("a1", "a2", "b1", "b2")}


def scene(**parts) -> Scene:
    whole = {"medium": "electrical", "t_end": "12 ns", "lines": {"pair": PAIR}, "probes": PROBES}
    return Scene(**whole | parts)


def resistor(at: str, ohm: float) -> dict:
    return {"at": at, "kind": "resistor", "resistance": ohm}


def driver(at: str, ohm: float, value: object = RAMP) -> dict:
    return {"at": at, "kind": "voltage", "resistance": ohm, "value": value}


@pytest.mark.parametrize(
    "load",
    [
        {"kind": "resistor", "resistance": 75},
        {"kind": "parallel", "resistance": 90, "capacitance": "3 pF"},
        {"kind": "series", "inductance": "4 nH"},
        {"kind": "open"},
    ],
)
def test_symmetric_ends_are_two_single_lines(load):
    """Even and odd mode do not see each other: half the sum and half the difference of two single lines."""
    coupled = simulate(
        scene(
            sources={"one": driver("a1", 30), "two": driver("a2", 30, 0)},
            loads={at: {"at": at} | load for at in ("b1", "b2")},
        ),
        tol=1e-9,
    )
    seen = {}
    for word, (z0, delay) in {"even": EVEN, "odd": ODD}.items():
        single = Scene(
            medium="electrical", t_end="12 ns", lines={"l": {"nodes": ["a", "b"], "z0": z0, "delay": delay}},
            sources={"s": driver("a", 30)}, loads={"b": {"at": "b"} | load},
            probes={"a": {"at": "a"}, "b": {"at": "b"}},
        )  # fmt: skip
        seen[word] = simulate(single, tol=1e-10).probes
    t = coupled.t[coupled.t < 12 * NS]
    for end in "ab":
        even, odd = (seen[word][end].at(t) for word in ("even", "odd"))
        for conductor, sign in ((1, 1), (2, -1)):
            probe = coupled.probes[f"{end}{conductor}"].at(t)
            assert np.abs(probe.u - (even.u + sign * odd.u) / 2).max() < 1e-8
            assert np.abs(probe.y - (even.y + sign * odd.y) / 2).max() < 1e-8 / 40


def lattice(T, z0, steps, conductances, driven, n):
    """Voltages of all conductors at both ends by the recursion of modal waves in whole steps, driven at end 1."""
    inverse = np.linalg.inv(T)
    Y = inverse.T @ np.diag(1 / z0) @ inverse
    arriving = np.zeros((2, len(z0), n + max(steps) + 1))
    seen = np.zeros((2, len(z0), n))
    for k in range(n):
        for end in (0, 1):
            w = arriving[end, :, k]
            flow = conductances[end] * driven[k] * (end == 0)
            flow[1:] = 0
            v = np.linalg.solve(Y + np.diag(conductances[end]), Y @ T @ w + flow)
            seen[end, :, k] = v
            sent = 2 * inverse @ v - w
            for m, delay in enumerate(steps):
                arriving[1 - end, m, k + delay] = sent[m]
    return seen


def test_three_unlike_conductors_follow_the_recursion():
    """L and C whose modes have delays of whole steps: the recursion is exact at its steps."""
    steps, step, n = np.array([17, 20, 26]), 0.05 * NS, 240
    C = np.array([[1.2, -0.3, -0.1], [-0.3, 1.4, -0.35], [-0.1, -0.35, 1.1]]) * 1e-10
    vectors = np.linalg.eigh(C)[1] @ np.diag([1.0, 0.8, 1.25])  # of modes; L = v l v', C = v'^-1 c v^-1
    inverse, unit = np.linalg.inv(vectors), 3e-7
    L, C = unit * vectors @ vectors.T, inverse.T @ np.diag((steps * step) ** 2 / unit) @ inverse
    assert (C[~np.eye(3, dtype=bool)] < 0).all()
    size = np.linalg.norm(vectors, axis=0)
    T, z0 = vectors / size, unit * size**2 / (steps * step)
    near, far = ["a1", "a2", "a3"], ["b1", "b2", "b3"]
    ohms = np.array([[35.0, 120.0, 60.0], [80.0, 45.0, 300.0]]) * z0.mean() / 50
    loads = {at: resistor(at, ohm) for at, ohm in zip(near[1:] + far, ohms.ravel()[1:].tolist(), strict=True)}
    wires = {"nodes1": near, "nodes2": far, "length": 1, "inductance": L.tolist(), "capacitance": C.tolist()}
    ramp = {"shape": "ramp", "to": 1, "duration": 4 * step}
    made = scene(
        t_end=(n - 1) * step, lines={"wires": wires}, sources={"s": driver("a1", ohms[0, 0], ramp)}, loads=loads,
        probes={at: {"at": at} for at in near + far},
    )  # fmt: skip
    assert made.lines["wires"].modes.delay == pytest.approx(steps * step, rel=1e-12)
    exact = lattice(T, z0, steps, 1 / ohms, np.clip(np.arange(n) / 4, 0, 1), n)
    result, times = simulate(made, tol=1e-10), np.arange(n) * step
    for end, nodes in enumerate((near, far)):
        for conductor, at in enumerate(nodes):
            assert np.abs(result.probes[at].at(times).u - exact[end, conductor]).max() < 1e-10


def test_what_a_short_wire_carries_back():
    """Backward crosstalk of a matched pair, by the first-order formula of inductive and capacitive coupling."""
    L, C, k = 3e-7, 1.2e-10, 1e-3
    made = scene(
        t_end="20 ns",
        lines={"pair": {
            "nodes1": ["a1", "a2"], "nodes2": ["b1", "b2"], "length": "0.5 m",
            "inductance": [[L, k * L], [k * L, L]], "capacitance": [[C, -k * C], [-k * C, C]],
        }},
        sources={"one": driver("a1", 50, {"shape": "ramp", "to": 1, "duration": "0.1 ns"})},
        loads={at: resistor(at, 50) for at in ("a2", "b1", "b2")},
    )  # fmt: skip
    probes = simulate(made, tol=1e-9).probes
    # near end (1/4)(Lm/L + Cm/C) V, with V = 1/2, for a round trip; far end nothing, for k is the same in L and C
    assert probes["a2"].u.max() == pytest.approx((k + k) / 4 / 2, rel=2e-6)
    assert np.abs(probes["b2"].u).max() < 2 * k**2


def test_probes_of_modes_see_what_both_conductors_have():
    """Voltages and currents of each; a mode's z0 is that of the pair in it: 2·Z_odd and Z_even/2."""
    modes = {"even": {"z0": 60, "delay": "1.1 ns"}, "odd": {"z0": 40, "delay": "0.9 ns"}}
    pair = {"nodes1": ["a1", "a2"], "nodes2": ["b1", "b2"]} | modes
    ends = {node: {"at": node} for node in ("a1", "a2", "b1", "b2")}
    sides = {f"{mode} {end}": {"at": f"{end}1", "beside": f"{end}2", "mode": mode}
             for mode in ("differential", "common") for end in "ab"}  # fmt: skip
    scene = Scene(
        medium="electrical", t_end="9 ns", lines={"pair": pair}, probes=ends | sides, solver={"tol": 1e-9},
        sources={"s": {"at": "a1", "kind": "voltage", "value": {"shape": "ramp", "to": 1, "duration": "0.3 ns"},
                       "resistance": 30}},
        loads={"r": {"at": "b1", "kind": "resistor", "resistance": 70}, "c": {"at": "b2", "kind": "resistor",
               "resistance": 20}, "d": {"at": "a2", "kind": "resistor", "resistance": 50}},
    )  # fmt: skip
    seen = simulate(scene).probes
    t = np.linspace(0, 9e-9, 301)
    for end in "ab":
        first, second = (seen[f"{end}{k}"].at(t) for k in (1, 2))
        differential, common = (seen[f"{mode} {end}"].at(t) for mode in ("differential", "common"))
        np.testing.assert_allclose(differential.u, first.u - second.u, atol=1e-13)
        np.testing.assert_allclose(differential.y, (first.y - second.y) / 2, atol=1e-15)
        np.testing.assert_allclose(common.u, (first.u + second.u) / 2, atol=1e-13)
        np.testing.assert_allclose(common.y, first.y + second.y, atol=1e-15)
    assert seen["differential b"].record.z0 == pytest.approx(80)
    assert seen["common b"].record.z0 == pytest.approx(30)


@pytest.mark.parametrize(
    ("probe", "sentence"),
    [
        ({"at": "a1", "mode": "common"}, "probes.p.beside: is missing"),
        ({"at": "a1", "beside": "a2"}, "probes.p.mode: is missing"),
        ({"at": "a1", "beside": "b2", "mode": "common"}, "probes.p.beside: no conductor beside it at the same end, "
                                                         "expected 'a2', got 'b2'"),
        ({"at": "c", "beside": "b2", "mode": "common"}, "probes.p.beside: no conductor beside it at the same end"),
        ({"line": "one", "position": "10 %", "mode": "common"}, "probes.p.mode: modes are recorded at nodes"),
    ],
)  # fmt: skip
def test_a_mode_that_is_none_is_refused(probe, sentence):
    pair = {
        "nodes1": ["a1", "a2"],
        "nodes2": ["b1", "b2"],
        "even": {"z0": 60, "delay": 1},
        "odd": {"z0": 40, "delay": 1},
    }
    one = {"nodes": ["b1", "c"], "z0": 50, "delay": 1}
    with pytest.raises(InputError) as found:
        Scene(medium="electrical", t_end=1, lines={"pair": pair, "one": one}, probes={"p": probe})
    assert sentence in str(found.value)


LL, LM, CC, CM = 3e-7, 1e-7, 1e-10, -2e-11
STEP = {"shape": "pulses", "high": 2, "width": 4 * NS, "rise": 0.5 * NS, "fall": 0.5 * NS, "at": 0.3 * NS}
ALIKE = {"p": {
    "nodes1": ["a1", "a2"], "nodes2": ["b1", "b2"], "length": 0.2, "inductance": [[LL, LM], [LM, LL]],
    "capacitance": [[CC, CM], [CM, CC]],
}}  # fmt: skip
SINGLE = {
    f"p{k}": {"nodes": [f"a{k}", f"b{k}"], "length": 0.2, "inductance": LL + LM, "capacitance": CC + CM} for k in "12"
}
EXTRA = {
    "links": {},
    "a switch": {"loads": {"S": {"at": "b", "kind": "switch", "before": 1e3, "after": 20, "time": 5 * NS}}},
    "a diode": {"loads": {"D": {"at": "b", "kind": "diode", "saturation": 1e-9}}},
    "a source between nodes": {
        "sources": {"O": {"nodes": ["b", "y"], "kind": "voltage", "value": 0.2}},
        "loads": {"Y": {"at": "y", "kind": "resistor", "resistance": 200}},
    },
    "a transformer": {
        "links": {"N": {"kind": "transformer", "nodes": ["b", "y"], "ratio": 2}},
        "loads": {"Y": {"at": "y", "kind": "resistor", "resistance": 20}},
    },
}  # fmt: skip
COMMON = {
    "sources": {"V": {"at": "s", "kind": "voltage", "value": STEP}},
    "links": {
        "R": {"nodes": ["s", "a"], "kind": "resistor", "resistance": 30},
        "L": {"nodes": ["b", "x"], "kind": "inductor", "inductance": 3e-9},
    },
    "loads": {"C": {"at": "x", "kind": "capacitor", "capacitance": 2e-12}},
}


def twice(section: str, extra: dict) -> dict:
    """Elements once for each conductor, their nodes with its number."""
    tables = COMMON[section] | extra.get(section, {})
    return {
        name + k: table
        | ({"at": table["at"] + k} if "at" in table else {"nodes": [node + k for node in table["nodes"]]})
        for name, table in tables.items()
        for k in "12"
    }


@pytest.mark.parametrize("extra", EXTRA.values(), ids=EXTRA)
def test_a_pair_driven_alike_is_two_single_lines(extra):
    elements = {section: twice(section, extra) for section in COMMON}
    pair, single = (
        simulate(
            Scene(
                medium="electrical", t_end=12 * NS, lines=lines, solver={"tol": 1e-7},
                probes={at: {"at": f"{at}1"} for at in "abx"}, **elements,
            )
        )
        for lines in (ALIKE, SINGLE)
    )  # fmt: skip
    t = np.linspace(0.01 * NS, 11.9 * NS, 500)
    for at in "abx":
        one, other = (result.probes[at].at(t).u for result in (pair, single))
        assert np.abs(one - other).max() < 2e-7 * np.abs(other).max()
