"""Growth of scenes with active loads: against closed forms, delay margins, and the simulation itself."""

from math import log, pi, sqrt

import numpy as np
import pytest
from one_line import FAR, one_line

from tline import ActiveError, Scene, simulate
from tline.solver.description.description import describe
from tline.solver.stability.growth import growth


def cable(impedance: str, *, resistance=3.0, delay=1.0, t_end=1000.0):
    load = {"kind": "impedance", "expression": impedance}
    return one_line(t_end, {"z0": 1, "delay": delay}, 1, resistance, load, probes=FAR)


@pytest.mark.parametrize("ohms", [-1.2, -2.0, -2.9])
def test_a_negative_resistor_multiplies_every_round_trip(ohms):
    """|H_s H_2| > 1 behind H_s = 1/2: growth ln|H_s H_2|/(2T)."""
    found = growth(describe(cable(f"{ohms}")))
    assert found.s.real == pytest.approx(log(abs((ohms - 1) / (ohms + 1)) / 2) / 2, rel=1e-9)


def test_a_negative_resistor_that_the_source_outweighs():
    assert growth(describe(cable("-5"))).s is None  # H_s H_2 = 3/4
    assert describe(cable("-5")).active
    assert not describe(cable("5 + s")).active


@pytest.mark.parametrize(("share", "grows"), [(0.999, False), (1.001, True)])
def test_delay_margin(share, grows):
    """H2 = 2/(1 + s) on a shorted line: e^(-2Ts) H2 = -1 first at s = j sqrt 3, with 2T = 2 pi/(3 sqrt 3)."""
    margin = pi / (3 * sqrt(3))
    found = growth(describe(cable("(s + 3)/(s - 1)", resistance=0.0, delay=share * margin, t_end=1e6)))
    assert (found.s is not None) == grows
    if grows:
        assert found.s.imag == pytest.approx(sqrt(3), rel=2e-3)


@pytest.mark.parametrize(("gain", "grows"), [(3.0, True), (-2.0, True), (0.9, False)])
def test_a_loop_through_a_controlled_source(gain, grows):
    """A round trip of two lines multiplies by the gain: open ends double what two matched sources halve."""
    source = {"kind": "controlled source", "resistance": 1.0}
    scene = Scene(
        medium="electrical", t_end=100.0, probes={"far": {"at": "far"}},
        lines={"one": {"nodes": ["near", "mid"], "z0": 1.0, "delay": 1.0},
               "two": {"nodes": ["in", "far"], "z0": 1.0, "delay": 1.0}},
        links={"there": source | {"nodes": ["mid", "in"], "gain": gain},
               "back": source | {"nodes": ["far", "near"], "gain": 1.0}},
    )  # fmt: skip
    found = growth(describe(scene))
    assert (found.s is not None) == grows
    if grows:
        assert found.s.real == pytest.approx(log(abs(gain)) / 2, rel=1e-9)
        assert found.s.imag == pytest.approx(0.0 if gain > 0 else pi / 2, abs=1e-9)


def network(**changed):
    """A Y of three lines without common measure; a negative resistance beside a capacitor at one end."""
    sine = {"shape": "sine", "amplitude": 1, "frequency": 0.1, "until": 10.0}
    return Scene(
        medium="electrical",
        t_end=60.0,
        lines={
            "a": {"nodes": ["in", "mid"], "z0": 1.0, "delay": 1.0},
            "b": {"nodes": ["mid", "p"], "z0": 2.0, "delay": 2**0.5},
            "c": {"nodes": ["q", "mid"], "z0": 0.5, "delay": pi / 2},
        },
        sources={"s": {"at": "in", "kind": "voltage", "resistance": 0.2, "value": sine}},
        loads={
            "active": {"at": "p", "kind": "impedance", "expression": "-1.5/(1 - 1.5*0.3*s)"},
            "end": {"at": "q", "kind": "resistor", "resistance": 0.1},
        },
        probes={"p": {"at": "p"}},
        solver={"order": 6, "slab": 0.1},
    )


@pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")
def test_the_simulation_grows_at_the_rate_found():
    scene = network()
    found = growth(describe(scene))
    result = simulate(scene, active=True)
    late = np.linspace(35.0, 60.0, 2001)
    u = result.probes["p"].at(late).u
    # a wave exp(st) obeys u'' = 2 Re(s) u' - |s|^2 u: fitted over the last part of the run
    shift = 20
    now, then, before = u[shift:-shift], u[2 * shift :], u[: -2 * shift]
    (sum_, product), *_ = np.linalg.lstsq(np.stack([now, -before], axis=1), then, rcond=None)
    z = np.roots([1.0, -sum_, product]).astype(complex)
    s = np.log(z) / (shift * (late[1] - late[0]))
    fastest = s[np.argmax(s.real)]
    assert fastest.real == pytest.approx(found.s.real, rel=1e-3)
    assert abs(fastest.imag) == pytest.approx(abs(found.s.imag), abs=1e-3)


def test_an_active_scene_runs_only_when_asked_twice():
    scene = cable("-2")
    with pytest.raises(ActiveError, match=r"loads\.load is active: Re Z\(jω\) < 0 for all ω; waves grow by a factor e"):
        simulate(scene)
    short = cable("-2", t_end=20.0)
    assert "is active" in simulate(short, active=True).notes[0]


def test_a_scene_too_large_to_be_searched_says_so():
    many = {f"l{k}": {"nodes": [f"n{k}", f"n{k + 1}"], "z0": 1, "delay": 1 + 0.001 * k} for k in range(400)}
    scene = Scene(
        medium="electrical",
        t_end=10.0,
        lines=many,
        loads={"load": {"at": "n400", "kind": "impedance", "expression": "-3"}},
        probes={"far": {"at": "n0"}},
    )
    with pytest.raises(ActiveError, match="whether the waves grow was not found out"):
        simulate(scene)
