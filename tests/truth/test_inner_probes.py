"""Efforts at nodes where no line ends: against closed forms, and against what lines at both sides of them see."""

import numpy as np
import pytest

from tline import Scene, simulate
from tline.frequency import DelaySystem, respond

RS, R, L, Z1, Z2, DELAY, AT = 50.0, 20.0, 15.0, 50.0, 70.0, 1.0, 0.33


def scene(**more) -> Scene:
    """A step into a line, R and L in a row behind it, and a second line, both ends of which are matched."""
    given = {
        "medium": "electrical",
        "t_end": 6,
        "lines": {
            "one": {"nodes": ["left", "a"], "z0": Z1, "delay": DELAY},
            "two": {"nodes": ["b", "right"], "z0": Z2, "delay": 1.3},
        },
        "sources": {
            "s": {"at": "left", "kind": "voltage", "value": {"shape": "step", "to": 1, "at": AT}, "resistance": RS}
        },
        "links": {
            "r": {"kind": "resistor", "nodes": ["a", "inner"], "resistance": R},
            "l": {"kind": "inductor", "nodes": ["inner", "b"], "inductance": L},
        },
        "loads": {"end": {"at": "right", "kind": "matched"}},
        "probes": {"inner": {"at": "inner"}, "a": {"at": "a"}},
    }
    return Scene(**given | more)


def exact(t):
    """1 V less what the current takes, which rises with the time constant L/(Z1 + R + Z2)."""
    since, total = np.maximum(t - DELAY - AT, 0.0), Z1 + R + Z2
    return np.where(t > DELAY + AT, 1 + (Z1 + R) / total * np.expm1(-since * total / L), 0.0)


@pytest.mark.parametrize("inner_only", [False, True])
def test_between_slab_ends_to_a_tolerance(inner_only):
    probes = {"inner": {"at": "inner"}} if inner_only else {"inner": {"at": "inner"}, "b": {"at": "b"}}
    result = simulate(scene(probes=probes), tol=1e-8)
    t = np.linspace(0, 5.99, 1999)
    assert np.abs(result.probes["inner"].at(t).u - exact(t)).max() < 1e-8
    assert result.accuracy is not None
    assert 0 < result.accuracy.inside["inner"].u < 1e-8
    assert result.accuracy.inside["inner"].y == 0


def test_fronts_inside_slabs():
    """Neither the step nor the delays fit the slabs; pieces are followed at the inner node, too."""
    result = simulate(scene(solver={"order": 8, "slab": 0.11}), ledger=True)
    assert result.fronts.most > 0
    inner, t = result.probes["inner"], np.linspace(0, 5.9, 1001)
    assert inner.record.a1.breakpoints()[-1] == pytest.approx(DELAY + AT, abs=1e-12)
    assert np.abs(inner.at(t).u - exact(t)).max() < 1e-8


def test_it_is_what_the_resistor_leaves_of_the_line_end():
    """Beside a diode, so that laws are solved; from a steady state; at any instant."""
    diode = {"d": {"at": "inner", "kind": "diode", "saturation": 1e-9}}
    sine = {"shape": "sine", "offset": 0.2, "amplitude": 2, "frequency": 0.7}
    source = {"s": {"at": "left", "kind": "voltage", "resistance": RS, "value": sine}}
    for links in (
        scene().links,
        {"r": scene().links["r"], "l": {"kind": "resistor", "nodes": ["inner", "b"], "resistance": 5}},
    ):
        loads = diode | {"end": {"at": "right", "kind": "matched"}}
        result = simulate(scene(links=dict(links), loads=loads, sources=source), tol=1e-6)
        t = np.linspace(0, 5.99, 1999)
        inner, a = result.probes["inner"].at(t), result.probes["a"].at(t)
        assert np.abs(inner.u - (a.u - R * a.y)).max() < 1e-12
        assert 0.3 < inner.u.max() < 0.7  # what the diode lets through of more than a volt


def test_before_the_start_it_has_its_steady_effort():
    source = {"s": {"at": "left", "kind": "voltage", "resistance": RS, "value": 2}}
    inner = simulate(scene(sources=source, start="steady")).probes["inner"]
    assert inner.u == pytest.approx(2 * Z2 / (RS + R + Z2), rel=1e-12)
    assert inner.at(-1.0).u == pytest.approx(2 * Z2 / (RS + R + Z2), rel=1e-12)


def test_heights_count_from_its_own_elevation():
    pipe = {"nodes": ["lake", "a"], "radius": 0.1, "length": 1000, "wave_speed": 1000, "density": 1000}
    closing = {"shape": "ramp", "from": 1, "to": 0.2, "duration": 1}
    water = Scene(
        medium="hydraulic",
        t_end=4,
        start="steady",
        lines={"pipe": pipe},
        nodes={name: {"elevation": z} for name, z in (("lake", 5), ("a", 2), ("inner", -3))},
        sources={"lake": {"at": "lake", "kind": "pressure", "value": 3e5}},
        links={"screen": {"kind": "resistor", "nodes": ["a", "inner"], "resistance": 2e6}},
        loads={"valve": {"at": "inner", "kind": "orifice", "kv": 30, "opening": closing}},
        probes={"inner": {"at": "inner"}, "a": {"at": "a"}},
    )
    probes = simulate(water).probes
    inner, a = probes["inner"], probes["a"]
    assert np.abs(inner.u - (a.u - 2e6 * a.y)).max() < 1e-12 * 1e6
    assert inner.gauge_pressure - inner.u == pytest.approx(3 * 9.80665 * 1000)
    kv = 30 / 3600 / np.sqrt(1e5)  # m³/s at 1 Pa of water
    assert a.y[0] == pytest.approx(kv * np.sqrt(inner.gauge_pressure[0]), rel=1e-9)


def test_over_frequency():
    s = np.array([0.3 + 1j, 2j, 5.0])
    seen = respond(scene(), s)["inner"]
    across = (Z2 + s * L) / (Z1 + R + Z2 + s * L)
    np.testing.assert_allclose(seen.u, Z1 / (RS + Z1) * 2 * np.exp(-s * DELAY) * across, rtol=1e-13)
    assert not seen.y.any()
    H = DelaySystem(scene(), "inner")
    assert abs(H.to_control(9)(0.5j) - H(0.5j)) < 1e-9
    assert H.step([3.0], tol=1e-9)[0] == pytest.approx(float(exact(3.0 + AT)), abs=1e-8)
