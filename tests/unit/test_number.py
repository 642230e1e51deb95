"""A number that is parsed alone makes the element that reading all of it anew makes."""

import pytest

import tline as tl
from tline.errors import InputError
from tline.scene.changed import with_number

RC, VALVE = tl.examples["cable_rc"], tl.examples["valve_closure"]
PLACES = [
    (RC, "loads", "receiver", ("capacitance",), "5 pF"),
    (RC, "loads", "receiver", ("resistance",), 75),
    (RC, "sources", "driver", ("resistance",), "30 ohm"),
    (RC, "sources", "driver", ("value", "to"), "2 V"),
    (VALVE, "loads", "valve", ("opening", "from"), 0.9),
    (VALVE, "loads", "valve", ("opening", "duration"), "2 s"),
    (VALVE, "loads", "valve", ("kv",), 150),
]


@pytest.mark.parametrize(("scene", "part", "name", "keys", "value"), PLACES)
def test_is_as_read_from_its_table(scene, part, name, keys, value):
    found = with_number(getattr(scene, part)[name], keys, value)
    table = scene.table()
    at = table[part][name]
    for key in keys[:-1]:
        at = at[key]
    at[keys[-1]] = value
    anew = getattr(tl.Scene(**table), part)[name]
    assert found == anew
    assert found.table() == anew.table()
    if part == "loads" and scene is RC:
        assert found.ratio == anew.ratio


def test_what_is_no_number_is_left_to_others():
    driver = RC.sources["driver"]
    assert with_number(driver, ("kind",), "current") is None
    assert with_number(driver, ("value",), 3) is None  # a waveform so far
    assert with_number(driver, ("colour",), 3) is None
    assert with_number(RC.loads["receiver"], ("inductance",), "1 nH") is None  # there was none


@pytest.mark.parametrize("value", ["5 kg", -1, "five", None, [1]])
def test_a_bad_number_is_refused(value):
    with pytest.raises(InputError):
        with_number(RC.loads["receiver"], ("capacitance",), value)


def test_an_element_still_checks_itself():
    lone = tl.Scene(**RC.table() | {"sources": {"s": {"at": "near", "kind": "current", "value": 1, "resistance": 5}}})
    with pytest.raises(InputError, match="takes all of it"):
        with_number(lone.sources["s"], ("resistance",), 0)
