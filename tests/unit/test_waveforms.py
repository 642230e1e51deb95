"""Waveforms against their formulas by hand, on both sides of every break; and their projection on slabs."""

from fractions import Fraction
from math import exp, expm1, log, pi, sin

import numpy as np
import pytest

from tline.errors import InputError
from tline.scene.shape import Constant, Shape, Step
from tline.scene.waveform import (
    MOST_PULSES,
    DoubleExponential,
    Exponential,
    ModulatedSine,
    PiecewiseLinear,
    Pulses,
    Ramp,
    Sine,
    Table,
    read_table,
)
from tline.solver.convolution.families import changes_of, family_of, leads
from tline.solver.description.excitation import EDGE, jumps_of, just_before, places_of
from tline.solver.radau import basis
from tline.study.baseline.explicit import projected

ROUNDING = 1e-14  # of a level of size 1; a handful of operations


def at(waveform: Shape, t: float, inside: float) -> float:
    return float(waveform.value(np.array(t), np.array(inside)))


def sides(waveform: Shape, t: float, reach: float = 1e-3) -> tuple[float, float]:
    """Value at t seen from the left and from the right."""
    return at(waveform, t, t - reach), at(waveform, t, t + reach)


PULSE = Pulses(low="1 V", high=3, at=2, rise=0.5, width=1, fall=0.25)
TRAIN = Pulses(low=-1, high=1, at="1 s", width=0.5, period=2)
SINE = Sine(amplitude=2, frequency="0.25 Hz", phase="30 deg", offset=1, at=1, until=6)
JUMPS = PiecewiseLinear(points=[[1, 5], [2, 7], [2, -1], [4, -1], [5, 0], [5, 2]])


@pytest.mark.parametrize(
    ("waveform", "breaks", "values"),
    [
        (Constant(level="2 V"), [], {-5: 2, 0: 2, 7: 2}),
        (Step(to=1), [0], {-1: 0, 1: 1}),
        (Step(from_=3, to="-1 V", at=2), [2], {1: 3, 1.999: 3, 2.001: -1, 9: -1}),
        (Ramp(from_=1, to=3, at=1, duration=4), [1, 5], {0: 1, 1: 1, 2: 1.5, 5: 3, 6: 3}),
        (PiecewiseLinear(points=[[0, 0], [1, 2], [3, -2]]), [0, 1, 3], {-9: 0, 0.25: 0.5, 2: 0, 3: -2, 9: -2}),
        (JUMPS, [1, 2, 4, 5], {0: 5, 1.5: 6, 3: -1, 4.5: -0.5, 6: 2}),
        (PULSE, [2, 2.5, 3.5, 3.75], {0: 1, 2.25: 2, 3: 3, 3.625: 2, 9: 1}),
        (TRAIN, [1, 1.5, 3, 3.5, 5, 5.5, 7, 7.5], {0: -1, 1.2: 1, 1.8: -1, 3.2: 1, 7.2: 1, 7.8: -1, 101.2: 1}),
        (SINE, [1, 6], {0: 2, 1: 2, 2: 1 + 2 * sin(2 * pi / 3), 6: 1 + 2 * sin(2 * pi * (1.25 + 1 / 12))}),
        (SINE, [1, 6], {6.5: 1 + 2 * sin(2 * pi * (1.25 + 1 / 12)), 99: 1 + 2 * sin(2 * pi * (1.25 + 1 / 12))}),
        (Sine(amplitude=1, frequency=1), [0], {-3: 0, 0.25: 1, 100.75: -1}),
        (ModulatedSine(amplitude=2, frequency=0.25, offset=1, at=1, decay=2), [1], {0: 1, 2: 1 + 2 * exp(-0.5)}),
        (ModulatedSine(amplitude=2, frequency=0.25, at=-1, index=0.5, modulation=0.125), [-1],
         {-2: 0, 0: 2 * sin(pi / 2 + 0.5 * sin(pi / 4)), 1: 2 * sin(pi + 0.5), 3: 0}),
        (Exponential(from_=2, to=-1, at=1, time_constant=3), [1], {0: 2, 1: 2, 4: -1 + 3 / exp(1), 1e9: -1}),
        (Exponential(to=1, time_constant=1e12), [0], {1: -expm1(-1e-12)}),
    ],
)  # fmt: skip
def test_formulas(waveform, breaks, values):
    np.testing.assert_array_equal(waveform.breaks(8.0), breaks)
    for t, value in values.items():
        assert at(waveform, t, t - 1e-6 if t in breaks else t) == pytest.approx(value, abs=1e-13)


@pytest.mark.parametrize(
    ("waveform", "t", "left", "right"),
    [
        (Step(from_=3, to=-1, at=2), 2, 3, -1),
        (JUMPS, 1, 5, 5),
        (JUMPS, 2, 7, -1),
        (JUMPS, 4, -1, -1),
        (JUMPS, 5, 0, 2),
        (PULSE, 2, 1, 1),
        (PULSE, 2.5, 3, 3),
        (PULSE, 3.75, 1, 1),
        (TRAIN, 1, -1, 1),
        (TRAIN, 1.5, 1, -1),
        (TRAIN, 2001.0, -1, 1),
        (TRAIN, 2001.5, 1, -1),
        (Pulses(high=1, width=1, fall=1, at=1), 1, 0, 1),
        (Pulses(high=1, width=1, fall=1, at=1), 2, 1, 1),
        (SINE, 1, 2, 2),
        (Exponential(from_=2, to=1, time_constant=1, at=3), 3, 2, 2),
        (DoubleExponential(peak=1, rise=1, decay=2, at=3), 3, 0, 0),
    ],
)
def test_both_sides_of_every_break(waveform, t, left, right):
    assert sides(waveform, t) == pytest.approx((left, right), abs=1e-12)


@pytest.mark.parametrize(("count", "until"), [(None, 31), (1, 1), (3, 3), (1000, 31)])
@pytest.mark.parametrize(("rise", "fall", "start"), [(0, 0, 0), (0, 0, 0.3), (0.1, 0, -2.05), (0.2, 0.3, 0.7)])
def test_trains_of_pulses_by_counting(count, until, rise, fall, start):
    """Every pulse laid down one by one, in fractions."""
    train = Pulses(low=1, high=2, at=start, rise=rise, width=0.4, fall=fall, period=1.1, count=count)
    up, top, down = (Fraction(str(x)) for x in (rise, 0.4, fall))
    marks = []
    for k in range(until):
        begin = Fraction(str(start)) + k * Fraction("1.1")
        marks += [begin, begin + up, begin + up + top, begin + up + top + down]
    expected = sorted({m for m in marks if -1.1 < m < 30})
    found = train.breaks(30.0)
    assert np.allclose(found[(found > -1.1) & (found < 30)], [float(m) for m in expected], rtol=0, atol=1e-13)
    for t in np.random.default_rng(1).uniform(-3, 30, 300):  # no break among them
        since = min((t - float(m) for m in marks[::4] if m <= t), default=-1.0)
        down_at = rise + 0.4
        if since < 0 or since > down_at + fall:
            level = 1.0
        elif since < rise:
            level = 1.0 + since / rise
        else:
            level = 2.0 if since < down_at else 2.0 - (since - down_at) / fall
        assert at(train, t, t) == pytest.approx(level, abs=1e-12)


def test_a_surge_reaches_its_peak():
    surge = DoubleExponential(peak="5 kV", rise="0.4 us", decay="68.2 us", at="1 us")
    t = np.linspace(0, 400e-6, 400_001)
    u = surge.value(t, t)
    assert u.max() == pytest.approx(5e3, rel=1e-7)  # the grid misses the top by 1 ns at most
    top = 0.4e-6 * 68.2 / 67.8 * log(68.2 / 0.4)
    assert at(surge, 1e-6 + top, 1e-6 + top) == pytest.approx(5e3, rel=1e-14)
    assert t[u.argmax()] == pytest.approx(1e-6 + top, abs=1e-9)


def test_a_surge_with_nearly_equal_times_is_its_limit():
    """For rise = decay it becomes peak·e·(t/T)·e^(-t/T)."""
    surge = DoubleExponential(peak=1, rise=2 * (1 - 1e-13), decay=2)
    for t in (1e-9, 0.5, 2.0, 5.0):
        assert at(surge, t, t) == pytest.approx(t / 2 * exp(1 - t / 2), rel=1e-12)


CURVED = Exponential(to=1, time_constant=1), DoubleExponential(peak=1, rise=1, decay=2)
STRAIGHT = Constant(level=1), Step(to=1, at=2), Ramp(to=1, duration=2), JUMPS, TRAIN, PULSE


@pytest.mark.parametrize("waveform", [*STRAIGHT, *CURVED, SINE])
def test_shapes_broadcast(waveform):
    middle = np.array([[0.5], [1.75], [2.75], [4.5]])
    t = middle + np.array([-0.1, 0.0, 0.1])
    table = waveform.value(t, middle)
    assert table.shape == (4, 3)
    for i in range(4):
        assert waveform.value(t[i], middle[i]) == pytest.approx(table[i], abs=0)
        for j in range(3):
            assert at(waveform, t[i, j], middle[i, 0]) == table[i, j]


def test_before_time_zero():
    assert just_before(Step(from_=2, to=1)) == 2
    assert just_before(Step(from_=2, to=1, at=-1)) == 1
    assert just_before(Constant(level=3)) == 3
    assert just_before(PiecewiseLinear(points=[[-1, 0], [1, 2]])) == 1
    assert just_before(PiecewiseLinear(points=[[-1, 0], [0, 2], [0, 5]])) == 2
    assert just_before(SINE) == 2
    assert just_before(Sine(amplitude=1, frequency=1, at=-0.25)) == pytest.approx(1, abs=ROUNDING)
    assert just_before(TRAIN) == -1
    assert just_before(Exponential(to=1, time_constant=1, at=-1)) == pytest.approx(1 - exp(-1), abs=ROUNDING)


@pytest.mark.parametrize(
    ("train", "level"),
    [
        (Pulses(high=1, width=1, period=2, at=-1), 1),  # the pulse ends at zero
        (Pulses(high=1, width=1, period=2, at=-1000), 0),  # one begins at zero
        (Pulses(high=1, width=1, period=2, at=-1000.5), 1),
        (Pulses(high=1, width=1, period=2, at=-999.5), 0),
        (Pulses(high=1, width=0.1, fall=0.9, period=1, at="-3 s"), 0),  # no gap between pulses
        (Pulses(high=1, width=0.3, period=0.3, at=-0.9), 1),  # nothing but pulses
        (Pulses(high=1, width=0.05, period=0.1, count=3, at=-10), 0),  # long over
        (Pulses(high=1, width=0.05, period=0.1, count=3, at=-1.2), 0),
        (Pulses(high=1, width=1, period=2, at="-1e15 s"), 0),
    ],
)
def test_trains_that_began_before_time_zero(train, level):
    assert just_before(train) == pytest.approx(level, abs=1e-9)


def test_too_many_pulses_are_refused():
    train = Pulses(high=1, width="1 ns", period="2 ns")
    assert len(train.breaks(1e-6)) == 1000
    with pytest.raises(InputError, match=f"at most {MOST_PULSES:,}, got 5e\\+08"):
        train.breaks(1.0)
    assert len(Pulses(high=1, width="1 ns", period="2 ns", count=7).breaks(1.0)) == 14


def test_csv_tables(tmp_path):
    file = tmp_path / "points.csv"
    file.write_bytes(b"\xef\xbb\xbftime [s], level [V]\r\n# made by hand\r\n0, 1\r\n\r\n 2e-1 ,-3\r\n0.2,4\r\n")
    assert read_table(file, "") == ((0.0, 0.2, 0.2), (1.0, -3.0, 4.0))
    assert at(Table(file=str(file)), 0.1, 0.1) == pytest.approx(-1)
    file.write_text("0,1\n1,2")
    assert read_table(file, "") == ((0.0, 1.0), (1.0, 2.0))


# waveforms on slabs


def test_a_jump_by_hand():
    """Order 2, jump at 1/4 of a slab: the straight line with the moments 3/4 and 15/32."""
    u = projected(Step(to=1, at=0.25), np.array([0.25]), basis(2), 1.0, 0, 1)[0]
    # c0 + c1 x with c0 + c1/2 = 3/4 and c0/2 + c1/3 = 15/32: c1 = 9/8, c0 = 3/16, at the points x = 1/3 and 1
    assert u == pytest.approx([3 / 16 + 3 / 8, 3 / 16 + 9 / 8], abs=ROUNDING)


def test_away_from_breaks_nothing_but_sampling():
    b, h = basis(5), 0.1
    values = projected(SINE, SINE.breaks(10.0), b, h, 15, 40)
    t = (15 + np.arange(40))[:, None] * h + h * b.c
    np.testing.assert_array_equal(values, SINE.value(t, t - h * 1e-3))


@pytest.mark.parametrize("off", [0.0, 1e-13, -1e-13, EDGE / 3, -EDGE / 3])
@pytest.mark.parametrize("slab", [0, 1, 7, 1000])
def test_a_break_on_an_edge_is_clean(slab, off):
    h = 0.3
    step = Step(from_=2, to=5, at=(slab + off) * h)
    values = projected(step, step.breaks(1e9), basis(4), h, max(slab - 3, 0), 6)
    expected = np.where(np.arange(max(slab - 3, 0), max(slab - 3, 0) + 6) < slab, 2.0, 5.0)
    np.testing.assert_array_equal(values, np.repeat(expected[:, None], 4, axis=1))


@pytest.mark.parametrize("waveform", [TRAIN, JUMPS, SINE, PULSE, Step(to=1, at=3.21)])
def test_chunks_do_not_show(waveform):
    b, h, breaks = basis(3), 0.17, waveform.breaks(30.0)
    whole = projected(waveform, breaks, b, h, 0, 60)
    parts = [projected(waveform, breaks, b, h, first, 12) for first in range(0, 60, 12)]
    np.testing.assert_allclose(np.concatenate(parts), whole, rtol=0, atol=1e-12)


def test_a_late_break_is_projected_too():
    """In slab 10⁶ the place of a break is known to 10⁻¹⁰ slabs."""
    h, slab = 0.1, 1_000_000
    step = Step(to=1, at=(slab + 0.25) * h)
    u = projected(step, step.breaks(1e9), basis(2), h, slab - 1, 3)
    assert u.ravel() == pytest.approx([0, 0, 9 / 16, 21 / 16, 1, 1], abs=1e-9)


def test_jumps_and_corners_in_one_slab_are_told_from_corners():
    """A step inside a ramp of 4 slabs, and one of a tenth of a slab: neither the ramp's corners nor t = 0 jump."""
    parts = [(Step(to=1, at=2.5), 2.0), (Ramp(to=1, at=1.2, duration=4), 1.0), (Ramp(to=1, at=7, duration=0.1), 1.0)]
    places = places_of(parts, 10.0, 1.0)
    assert jumps_of(parts, places, 10.0, 1.0, steady=True).tolist() == pytest.approx([2.5, 7.0, 7.1])
    assert jumps_of(parts, places, 10.0, 1.0, steady=False).tolist() == pytest.approx([0.0, 2.5, 7.0, 7.1])


END = 10.0
WAVEFORMS = [
    Step(to=2, at=1.3),
    Step(from_=1, to=2, at=0),
    Pulses(low=0.5, high=1, at=0.3, width=0.4, rise=0.05, fall=0.1, period=1.7),
    PiecewiseLinear(points=[(0.0, 0.0), (1.0, 3.0), (2.5, 3.0), (2.5, -1.0), (7.0, 0.0)]),
]


def test_leads_put_instants_at_edges():
    ahead = leads(np.array([0.3, 1.3 + 1e-12, 5.0, 7.25]))
    assert ahead == pytest.approx([0.0, 0.7, 0.75], abs=1e-9)
    assert family_of(np.array([2.0, 0.3, 4.25, 3.0 - 1e-12]), ahead).tolist() == [0, 1, 2, 0]


@pytest.mark.parametrize("waveform", WAVEFORMS, ids=lambda waveform: waveform.shape)
@pytest.mark.parametrize("steady", [True, False])
def test_parts_add_up_on_their_own_clocks(waveform, steady):
    changes = changes_of(waveform, steady, END)
    ahead = leads(changes.at)
    which = family_of(changes.at, ahead)
    parts = [changes.part(which == k, float(late)) for k, late in enumerate(ahead)]
    t = np.linspace(0.001, END - 0.001, 500)
    total = sum(part.value(t + late, t + late) for part, late in zip(parts, ahead, strict=True))
    assert total + changes.before == pytest.approx(waveform.value(t, t), abs=1e-12)
    just_before = [part.value(np.array(late / 2), np.array(-1e-3)) for part, late in zip(parts, ahead, strict=True)]
    assert sum(just_before) == 0.0
    for part, late in zip(parts, ahead, strict=True):
        assert np.abs(part.breaks(END + 1) - np.round(part.breaks(END + 1))).max(initial=0.0) < 1e-9, late


def test_nothing_happens_where_a_waveform_goes_on():
    assert changes_of(Step(to=1, at=2), steady=False, t_end=END).at.tolist() == [2.0]
    assert changes_of(Step(from_=1, to=2, at=2), steady=True, t_end=END).at.tolist() == [2.0]
    assert changes_of(Step(from_=1, to=2, at=2), steady=False, t_end=END).at.tolist() == [0.0, 2.0]
    straight = PiecewiseLinear(points=[(0.0, 0.0), (1.0, 1.0), (2.0, 2.0)])
    assert changes_of(straight, steady=True, t_end=END).at.tolist() == [0.0, 2.0]


def test_curved_waveforms_stay_whole():
    sine = Sine(amplitude=1, frequency=4 / END)  # zero at both ends of the run
    changes = changes_of(sine, steady=True, t_end=END)
    assert changes.curved
    assert len(changes.at) >= 1
    late = changes.part(np.ones(len(changes.at), bool), 0.25)
    t = np.linspace(0.01, 9, 50)
    assert changes.before + late.value(t + 0.25, t + 0.25) == pytest.approx(sine.value(t, t))
    assert late.fastest() == sine.fastest()
