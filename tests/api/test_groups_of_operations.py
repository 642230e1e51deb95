"""Operations of several elements at once, power that returns, and runs that go on until nothing is cut."""

from pathlib import Path
from typing import Any

import pytest

import tline as tl
from tline import InputError, operate
from tline.surge.event import Event, each_of

TOWN = Path(__file__).parents[2] / "scenes" / "town.toml"


@pytest.fixture(scope="module")
def town():
    scene = tl.read(TOWN)
    table = scene.table()
    duty = table["links"]["duty"] | {"speed": 1}
    pumps = {"links.duty": duty, "links.assist": duty, "links.spare": duty | {"speed": 0}}
    return scene.change(pumps)


@pytest.mark.parametrize(
    ("kind", "name", "means"),
    [
        ("trip", "*", {"duty", "assist"}),
        ("trip", "du*", {"duty"}),
        ("trip", "duty, assist", {"duty", "assist"}),
        ("start", "*", {"spare"}),
        ("close", "*", {"ease"}),
        ("close", "ea?e", {"ease"}),
        ("trip", "duty", {"duty"}),
    ],
)
def test_a_list_or_a_pattern_means_what_it_fits(town, kind, name, means):
    assert {event.name for event in each_of(town, Event(kind, name, 1.0))} == means


def test_all_pumps_trip_and_their_power_returns(town):
    given: Any = {"inertia": "1 kg m^2", "rated_speed": "1450 rpm", "t_end": "4 s"}
    surge = operate(town, trip="*@1s", start="*uty@2s", **given)
    speeds = {trace.where: trace.values for trace in surge.result.states if trace.word == "speed"}
    assert {*speeds} == {"links.duty", "links.assist"}
    assert speeds["links.duty"][-1] > speeds["links.duty"].min()
    assert speeds["links.assist"][-1] == speeds["links.assist"].min()


def test_a_pattern_that_fits_nothing_is_refused(town):
    with pytest.raises(InputError, match=r"trip: nothing that it may mean is called 'x\*', expected one of 'duty'"):
        operate(town, trip="x*@1s")


def test_a_run_goes_on_until_its_extremes_are_none_of_its_end():
    pipe = {"length": 500, "diameter": 0.3, "wave_speed": 1000, "density": 1000}
    tap = {"at": "c", "kind": "orifice", "flow": "20 L/s", "pressure_drop": "6 bar"}
    scene = tl.Scene(
        medium="hydraulic",
        t_end="1 s",
        start="steady",
        lines={"main": {"nodes": ["lake", "c"], **pipe}},
        loads={"lake": {"at": "lake", "kind": "reservoir", "pressure": "6 bar"}, "tap": tap},
        probes={"tap": {"at": "c"}},
    )
    given: Any = {"close": "tap@0s+2s", "t_end": "0.8 s", "tol": 0.05}
    cut, whole = (operate(scene, until_settled=on, **given) for on in (False, True))
    assert cut.worst.unfinished
    assert not whole.worst.unfinished
    assert float(whole.scene.t_end) == 1.6
    assert any("it was made again, up to 1.6 s" in note for note in whole.notes)
