"""What is operated once a pressure is reached, at the instant that a closed form gives."""

import numpy as np
import pytest

from tline.errors import InputError
from tline.scene.heights import GRAVITY
from tline.scene.scene import Scene
from tline.solver.simulate import simulate
from tline.surge.control import read_control, triggered
from tline.surge.operate import operated

PIPE = {"length": 200, "diameter": 0.3, "wave_speed": 1000, "density": 1000}
Z0 = 1000 * 1000 / (np.pi / 4 * 0.3**2)
P0, RISE = 5e5, 2e5


def scene() -> Scene:
    """A pressure that rises, a matched pipe, and a valve at its end: what arrives is what was sent 0.2 s ago."""
    ramp = {"shape": "ramp", "from": P0, "to": P0 + RISE, "at": 1, "duration": 3}
    valve = {"at": "b", "kind": "orifice", "flow": 0.01, "pressure_drop": P0}
    return Scene(
        medium="hydraulic",
        t_end=3,
        start="steady",
        lines={"p": {"nodes": ["a", "b"], **PIPE}},
        loads={"v": valve},
        sources={"s": {"at": "a", "kind": "pressure", "value": ramp, "resistance": Z0}},
        probes={"b": {"at": "b"}},
    )


def build(done, watched) -> Scene:
    assert {*watched} <= {"b"}  # where the scene has a probe
    return operated(scene(), done)[0]


def pressure(t: float) -> float:
    """At the valve: u + z0·q is what arrives, q = C·sqrt(u)."""
    capacity = 0.01 / np.sqrt(P0)
    arrives = np.interp(t - 0.2, [1, 4], [P0, P0 + RISE])
    return ((-Z0 * capacity + np.sqrt((Z0 * capacity) ** 2 + 4 * arrives)) / 2) ** 2


@pytest.mark.parametrize("at", [1.7, 2.345678])
def test_a_valve_shuts_when_the_pressure_is_reached(at):
    control = read_control(f"b>{float(pressure(at))!r} Pa: close v+0.5s")
    events, waiting, (note,) = triggered([control], [], build, lambda each: simulate(each, tol=1e-9))
    assert not waiting
    assert events[0].at == pytest.approx(at, abs=1e-9)
    assert f"after {at:.6g} s" in note
    assert (events[0].kind, events[0].name, events[0].duration) == ("close", "v", 0.5)


def test_what_is_never_reached_and_what_holds_at_the_start():
    def found(text: str):
        return triggered([read_control(text)], [], build, lambda each: simulate(each))

    events, (waiting,), (note,) = found("b > 90 bar: close v")
    assert waiting.pressure == 9e6
    assert (events, note) == ([], "'b > 90 bar: close v': not before the end")
    assert found("b < 90 bar: close v")[0][0].at == 0.0


def test_names_are_looked_up_before_anything_runs():
    for text, said in (("c > 1 bar: close v", "when: no such node"), ("b > 1 bar: close w", "close: not a valve")):
        with pytest.raises(InputError, match=said):
            triggered([read_control(text)], [], build, simulate)


def test_a_level_counts_metres_of_water():
    assert read_control("tower<4 m: open V2+1s").pressure == pytest.approx(4000 * GRAVITY)
    assert read_control("tower<40 mbar: trip P").pressure == pytest.approx(4000)


@pytest.mark.parametrize("text", ["tower: close V1", "tower>5 bar close V1", "tower>5 bar: explode V1", ""])
def test_what_is_no_control(text):
    with pytest.raises(InputError, match="when: not a control"):
        read_control(text)
