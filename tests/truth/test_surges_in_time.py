"""Operations end within their time with what is known of their error, and say what is not."""

import pytest

import tline as tl
from tline.surge.report import band_text

TOWN = tl.examples["town"]


def test_a_class_comes_with_the_error_that_is_left():
    brief, long = (tl.operate(TOWN, close="ab@1s+1s", t_end="4 s", seconds=s, cavities=False) for s in (1e-3, 20))
    assert [len(each.result.accuracy.attempts) for each in (brief, long)] == [2, 3]
    highest = [each.worst.highest for each in (brief, long)]
    assert abs(highest[0].highest - highest[1].highest) <= highest[0].highest_error + highest[1].highest_error
    assert brief.worst.spread >= highest[0].highest_error > 0


def test_no_class_where_cavities_had_no_time():
    surge = tl.operate(TOWN, trip="duty@1s", close="ab@1s", t_end="4 s", seconds=1e-3)
    assert surge.worst.needed is None
    assert "no pressure class is named" in str(surge)
    assert any("another run would take the total beyond 0.001 s" in note for note in surge.notes)


def test_time_is_asked_in_seconds():
    with pytest.raises(tl.InputError, match="seconds: duration out of range"):
        tl.operate(TOWN, seconds=0)


def test_guesses_for_which_no_time_is_left_are_named():
    surge = tl.operate(TOWN, close="ab@1s+1s", t_end="1 s", cavities=False)
    band = surge.band(seconds=1e-3)
    assert band.varied == ()
    assert "wave speed × 0.85" in band.left
    assert "not varied, for want of time: wave speed × 0.85" in "\n".join(band_text(surge.result, band))
