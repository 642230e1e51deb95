"""The frequency domain against closed forms and scikit-rf."""

import numpy as np
import pytest
from one_line import FAR, one_line

from tline import InputError, Scene
from tline.frequency import impedance, resonances, respond, scattering_parameters

F = np.array([1e6, 3.7e7, 2.5e8, 9.1e8, 3.3e9])
S = 2j * np.pi * F
Z0, T = 50.0, 1e-9


def cable(load=None, **more):
    return one_line(1, {"z0": Z0, "delay": T}, None, None, load, **{"probes": FAR, "sources": {}} | more)


@pytest.mark.parametrize(
    ("load", "Z"),
    [
        ({"kind": "resistor", "resistance": 100}, lambda s: 100 + 0 * s),
        (
            {"kind": "series", "resistance": 10, "inductance": "20 nH", "capacitance": "3 pF"},
            lambda s: 10 + 20e-9 * s + 1 / (3e-12 * s),
        ),
        ({"kind": "parallel", "resistance": 70, "capacitance": "4 pF"}, lambda s: 1 / (1 / 70 + 4e-12 * s)),
        ({"kind": "short"}, lambda s: 0 * s),
    ],
    ids=["R", "RLC", "RC", "short"],
)
@pytest.mark.parametrize("sigma", [0.0, 3e8])
def test_input_impedance_of_a_loaded_line(load, Z, sigma):
    """z0 (Z + z0 tanh Ts)/(z0 + Z tanh Ts), Pozar (2.44)."""
    s = S + sigma
    t = np.tanh(T * s)
    exact = Z0 * (Z(s) + Z0 * t) / (Z0 + Z(s) * t)
    assert np.abs(impedance(cable(load), "near", s) / exact - 1).max() < 1e-9


def test_voltage_at_the_far_end_behind_a_source_resistance():
    source = {"s": {"at": "near", "kind": "voltage", "value": 1, "resistance": 25}}
    u = respond(cable({"kind": "resistor", "resistance": 100}, sources=source), S)["far"].u
    h_source, h_end, x = (25 - Z0) / (25 + Z0), (100 - Z0) / (100 + Z0), np.exp(-S * T)
    exact = Z0 / (Z0 + 25) * x * (1 + h_end) / (1 - h_source * h_end * x**2)
    assert np.abs(u - exact).max() < 1e-14


@pytest.mark.parametrize("sigma", [0.0, 3e8])
@pytest.mark.parametrize("kind", ["voltage", "current"])
@pytest.mark.parametrize("resistance", [None, 30])
def test_a_source_between_two_nodes_sees_what_is_behind_them_in_series(sigma, kind, resistance):
    """Both lines' input impedances, its own resistance, and an inductance behind a node without a line."""
    s, inductance, ends = S + sigma, 20e-9, {"left": 20, "right": 90}
    line = {"z0": Z0, "delay": T}
    scene = Scene(
        medium="electrical",
        t_end=1,
        lines={"one": line | {"nodes": ["left", "plus"]}, "two": line | {"nodes": ["behind", "right"]}},
        sources={"s": {"nodes": ["plus", "minus"], "kind": kind, "value": 1, "resistance": resistance}},
        links={"coil": {"nodes": ["minus", "behind"], "kind": "inductor", "inductance": inductance}},
        loads={node: {"at": node, "kind": "resistor", "resistance": r} for node, r in ends.items()},
        probes={"plus": {"at": "plus"}, "behind": {"at": "behind"}},
    )
    t = np.tanh(T * s)
    one, two = (Z0 * (r + Z0 * t) / (Z0 + r * t) for r in ends.values())
    if resistance is None and kind == "current":
        i = 1.0
    else:
        i = (1 if kind == "voltage" else resistance) / (one + two + s * inductance + (resistance or 0))
    seen = respond(scene, s)
    assert np.abs(seen["plus"].u / (one * i) - 1).max() < 1e-12
    assert np.abs(seen["behind"].u / (-two * i) - 1).max() < 1e-12
    assert np.abs(seen["behind"].y / -i - 1).max() < 1e-12


def test_a_quarter_wave_inside_the_line():
    """A probe at a place sees both waves: the standing wave of an open line is cos(ω(T - x/c)) up to a factor."""
    scene = cable(sources={"s": {"at": "near", "kind": "voltage", "value": 1}})
    probes = {"x": {"line": "line", "position": "30 %"}}
    s = S + 1e8
    u = respond(Scene(**scene.table() | {"probes": probes}), s)["x"].u
    assert np.abs(u - np.cosh(0.7 * T * s) / np.cosh(T * s)).max() < 1e-12


def test_scattering_parameters_against_scikit_rf():
    """A Y of three lines, one stub with a capacitor; the other program cascades and joins."""
    skrf = pytest.importorskip("skrf")
    lines = {
        "a": {"nodes": ["in", "tee"], "z0": 75, "delay": "0.7 ns"},
        "b": {"nodes": ["tee", "out"], "z0": 50, "delay": "1.1 ns"},
        "stub": {"nodes": ["tee", "end"], "z0": 60, "delay": "0.3 ns"},
    }
    loads = {"c": {"at": "end", "kind": "parallel", "capacitance": "2 pF"}}
    scene = Scene(medium="electrical", t_end=1, lines=lines, loads=loads, probes={"p": {"at": "in"}})
    ours = scattering_parameters(scene, ["in", "out"], S, [50, 75])
    frequency = skrf.Frequency.from_f(F, unit="Hz")

    def line(z0, delay):
        medium = skrf.media.DefinedGammaZ0(frequency, z0_port=50, z0=z0, gamma=2j * np.pi * F / 1.0)
        return medium.line(delay, unit="m")

    tee = skrf.media.DefinedGammaZ0(frequency, z0=50).tee()
    stub = (
        line(60, 0.3e-9)
        ** skrf.media.DefinedGammaZ0(frequency, z0=50).shunt_capacitor(2e-12)
        ** skrf.media.DefinedGammaZ0(frequency, z0=50).open()
    )
    joined = skrf.network.connect(tee, 2, stub, 0)
    theirs = line(75, 0.7e-9) ** joined ** line(50, 1.1e-9)
    theirs.renormalize([50, 75])
    assert np.abs(ours - theirs.s).max() < 1e-9


def test_lossless_networks_scatter_unitarily():
    scene = cable({"kind": "series", "inductance": "20 nH"})
    h = scattering_parameters(scene, ["near"], S)[:, 0, 0]
    assert np.abs(np.abs(h) - 1).max() < 1e-13
    assert not np.isfinite(impedance(cable(), "near", [0.0])).any()  # an open line has no impedance at rest


def test_resonances_are_roots_of_the_closed_form():
    """Rs, RL on a line: s = (ln(H_s H_L) + 2 pi j k)/(2T); a capacitor shifts them to cot(ωT) = ω C z0."""
    source = {"s": {"at": "near", "kind": "voltage", "value": 1, "resistance": 200}}
    found = resonances(cable({"kind": "resistor", "resistance": 400}, sources=source), 2.1e9)
    decay = np.log(150 / 250 * 350 / 450) / (2 * T)
    assert [mode.s for mode in found] == pytest.approx([complex(decay, np.pi * k / T) for k in (1, 2, 3, 4)], rel=1e-9)
    assert [mode.decay_time for mode in found] == pytest.approx([-1 / decay] * 4, rel=1e-9)
    C = 3e-12
    shorted = {"s": {"at": "near", "kind": "voltage", "value": 1}}
    modes = resonances(cable({"kind": "parallel", "capacitance": C}, sources=shorted), 1e9)
    for mode in modes:
        w = mode.s.imag
        assert mode.quality == mode.decay_time == np.inf
        assert abs(np.cos(w * T) - w * C * Z0 * np.sin(w * T)) < 1e-8
    assert len(modes) == 2


def test_two_equal_undamped_lines_do_not_grow():
    """Open quarter waves on either side of a short: double zeros on the axis."""
    lines = {name: {"nodes": ["mid", name], "z0": Z0, "delay": T} for name in ("left", "right")}
    loads = {"s": {"at": "mid", "kind": "short"}}
    scene = Scene(medium="electrical", t_end=1, lines=lines, loads=loads, probes={"p": {"at": "left"}})
    found = resonances(scene, 1.4e9)
    assert [mode.frequency for mode in found] == pytest.approx([0.25e9, 0.75e9, 1.25e9], rel=1e-8)
    assert min(mode.decay_time for mode in found) > 1e8 * T  # double zeros are found to some 1e-9 of 1/T


@pytest.mark.parametrize(("source", "load"), [(25, -90), (200, -90), (200, -51)])
def test_waves_that_grow_are_found_however_fast(source, load):
    """s = (ln|H_s H_L| + j(k pi or 2 k pi))/(2T) where the product is negative or positive; k = 0 does not turn."""
    drive = {"s": {"at": "near", "kind": "voltage", "value": 1, "resistance": source}}
    found = resonances(cable({"kind": "impedance", "expression": str(load)}, sources=drive), 1.1e9)
    product = (source - Z0) / (source + Z0) * (load - Z0) / (load + Z0)
    first = 0 if product > 0 else 1
    turns = np.arange(first, 2 * T * 1.1e9 * 2, 2)
    exact = [complex(np.log(abs(product)), np.pi * k) / (2 * T) for k in turns if k <= 4.4]
    assert [mode.s for mode in found] == pytest.approx(exact, rel=1e-9)
    for mode in found:
        assert mode.decay_time == pytest.approx(-2 * T / np.log(abs(product)), rel=1e-9)
        assert mode.decay_time < 0
        assert mode.quality < 0


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: respond(cable(), S), "source: there is no source"),
        (
            lambda: respond(cable(sources={"s": {"at": "near", "kind": "voltage", "value": 1}}), S, "t"),
            "source: no such source, expected 's', got 't'",
        ),
        (
            lambda: respond(cable(sources={"s": {"at": "near", "kind": "voltage", "value": 1}}), [np.nan]),
            "s: not finite",
        ),
        (lambda: scattering_parameters(cable(), ["near", "fat"], S), "ports: no such node, expected 'far', got 'fat'"),
        (lambda: scattering_parameters(cable(), ["near", "near"], S), "ports: named twice"),
        (
            lambda: scattering_parameters(cable({"kind": "short"}), ["far"], S),
            "ports: a load or switch holds the effort there",
        ),
        (lambda: scattering_parameters(cable(), ["near"], S, -50), "z0: not positive"),
        (lambda: scattering_parameters(cable(), ["near"], S, [50, 50]), "z0: not one for each port"),
        (lambda: resonances(cable(), 0.0), "highest: not a positive frequency"),
        (lambda: resonances(cable(), 1e16), "highest: too many waves"),
    ],
)
def test_mistakes(call, message):
    with pytest.raises(InputError) as caught:
        call()
    assert str(caught.value).startswith(message)
