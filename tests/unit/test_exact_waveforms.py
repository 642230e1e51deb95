"""Waveforms as exact motions against their own values, at random instants."""

from fractions import Fraction

import numpy as np
import pytest
from flint import ctx

from tline.errors import InputError
from tline.scene.shape import Shape
from tline.scene.source import Source
from tline.study.reference.network import level, motions, starts, straight

WAVEFORMS = [
    2.5,
    {"shape": "step", "from": 1, "to": 3, "at": 0.7},
    {"shape": "step", "from": 1, "to": 3, "at": -0.7},
    {"shape": "ramp", "from": -1, "to": 3, "at": 0.2, "duration": 0.9},
    {"shape": "ramp", "to": 3, "at": -0.4, "duration": 0.9},
    {"shape": "piecewise linear", "points": [[-1, 2], [0.3, 1], [0.3, 4], [2, -1]]},
    {"shape": "pulses", "low": 1, "high": 2, "at": 0.1, "width": 0.3, "rise": 0.05, "fall": 0.1},
    {"shape": "pulses", "high": 2, "at": -0.6, "width": 0.3, "rise": 0.05, "period": 0.45},
    {"shape": "pulses", "high": 2, "at": 0.1, "width": 0.3, "fall": 0.1, "period": 0.5, "count": 2},
    {"shape": "pulses", "high": 2, "at": 50, "width": 0.3, "period": 0.5},
    {"shape": "pulses", "high": 2, "at": -1e6, "width": 0.3, "period": 0.5},
    {"shape": "pulses", "high": 2, "at": -1e6, "width": 0.3, "period": 0.5, "count": 10},
    {"shape": "sine", "amplitude": 2, "frequency": 0.7, "phase": 0.4, "offset": 1, "at": 0.3},
    {"shape": "sine", "amplitude": 2, "frequency": 0.7, "phase": "30 deg", "at": -0.3, "until": 1.1},
    {"shape": "exponential", "from": 2, "to": -1, "at": 0.4, "time_constant": 0.3},
    {"shape": "exponential", "to": 2, "at": -0.4, "time_constant": 0.3},
    {"shape": "double exponential", "peak": 3, "rise": 0.1, "decay": 0.8, "at": 0.2},
]
T_END = Fraction(3)
TIMES = [Fraction(k, 10**6) for k in np.random.default_rng(1).integers(1, 3_000_000, 40).tolist()]


def shape_of(value) -> Shape:
    return Source(at="a", kind="voltage", value=value).value


@pytest.mark.parametrize("value", WAVEFORMS)
def test_the_motions_that_begin_add_up_to_the_waveform(value):
    shape = shape_of(value)
    with ctx.workprec(100):
        begun = starts(shape, T_END, "s")
        for t in TIMES:
            found = float(sum(motion.at(t - at).mid() for at, motion in begun if at < t))
            expected = float(shape.value(np.array(float(t)), np.array(float(t))))
            assert abs(found - expected) < 1e-14
    assert all(0 <= at < T_END for at, _ in begun)


@pytest.mark.parametrize("value", WAVEFORMS[:12])
def test_straight_pieces_are_exact(value):
    shape = shape_of(value)
    pieces = straight(shape, T_END)
    for t in TIMES:
        expected = float(shape.value(np.array(float(t)), np.array(float(t))))
        assert abs(float(level(pieces, t)) - expected) < 1e-14


def test_at_a_jump_the_level_is_that_before_it():
    pieces = straight(shape_of({"shape": "step", "to": 1, "at": 0.7}), T_END)
    assert level(pieces, Fraction(7, 10)) == 0
    assert level(pieces, Fraction(7, 10) + Fraction(1, 10**30)) == 1


def test_an_unknown_shape_is_refused():
    class Odd(Shape):
        pass

    assert straight(Odd(), T_END) is None
    with pytest.raises(InputError, match=r"sources\.s: its waveform has no exact transform"):
        motions(Odd(), T_END, "sources.s")
