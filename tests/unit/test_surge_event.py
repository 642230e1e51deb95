"""Words for operations, and their waveforms."""

import pytest

from tline.errors import InputError
from tline.surge.event import read_event


def test_a_second_stage_begins_where_the_first_one_ends():
    event = read_event("close", "V1@1s+2s:25%+8s")
    assert event.control(0.8, 0.0)["points"] == [[1.0, 0.8], [3.0, 0.2], [11.0, 0.0]]


def test_a_course_follows_its_file(tmp_path):
    file = tmp_path / "shut.csv"
    file.write_text("s,opening\n0,1\n2,0.3\n9,0\n")
    points = read_event("close", f"V1@1s:{file}").control(1.0, 0.0)["points"]
    assert points == [[1.0, 1.0], [3.0, 0.3], [10.0, 0.0]]
    assert read_event("close", f"V1@1s:{file}").control(0.5, 0.0)["points"][:2] == [[1.0, 0.5], [1.0, 1.0]]


def test_a_pump_goes_to_a_speed_or_along_a_course(tmp_path):
    file = tmp_path / "speed.csv"
    file.write_text("0,1\n2,1.1\n9,0.6\n")
    ramp = read_event("speed", "P1:80%@1s+4s").control(1.0, 0.8)
    assert ramp == {"shape": "ramp", "duration": 4.0, "from": 1.0, "to": 0.8, "at": 1.0}
    assert read_event("speed", f"P1@1s:{file}").control(1.0, 0.0)["points"] == [[1.0, 1.0], [3.0, 1.1], [10.0, 0.6]]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("V1@1s:20%+8s", "close: no second stage, expected such as V1@1s"),
        ("V1@1s+2s:120%+8s", "close: a stage out of range"),
        ("V1@1s:nowhere.csv", "close: 'nowhere.csv' cannot be read"),
        ("V1@1s+2s:x.csv", "cannot be read"),
    ],
)
def test_a_closure_that_is_none(text, said):
    with pytest.raises(InputError, match=said):
        read_event("close", text)


@pytest.mark.parametrize(
    ("kind", "text", "said"),
    [
        ("close", "V1@2+1s", "close: a number without a unit, expected one with a unit, such as '2 s'"),
        ("close", "V1@2s+1", "close: a number without a unit, expected one with a unit, such as '1 s'"),
        ("burst", "J:20@1s", "burst: a number without a unit, expected one with a unit, such as '20 m"),
        ("stop", "P@1s:20%+8s", "stop: stages and courses are for close and open"),
        ("speed", "P@1s", "speed: not one speed to go to, or a course, expected PUMP:SHARE@TIME"),
        ("speed", "P:3@1s", "speed: out of range, expected 0 to 2 times the rated speed"),
    ],
)
def test_words_that_would_be_misread(kind, text, said):
    with pytest.raises(InputError, match=said):
        read_event(kind, text)
