"""Unit strings: what is read, what is refused, with which words; and every hydraulic scene in US units."""

import math
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import tline as tl
from tline.errors import InputError
from tline.scene.element import Element
from tline.scene.quantity import Quantity
from tline.units import LONGEST, engineering, to_si

# every expected value is the decimal a reader would write; they are equal because the parser rounds only once
READ = [
    ("10 cm", "m", 0.1),
    ("30 bar", "Pa", 3e6),
    ("1.2e3 kg/m^3", "kg/m^3", 1200.0),
    ("467.9 bar/(m^3/s)", "Pa s/m^3", 4.679e7),
    ("5 Pa·s/m³", "Pa s/m^3", 5.0),
    ("5 Pa*s*m**-3", "Pa s/m^3", 5.0),
    ("11.1 pF/m", "F/m", 1.11e-11),
    ("50 ohm", "ohm", 50.0),
    ("50 Ω", "ohm", 50.0),
    ("50\u2126", "ohm", 50.0),  # the other Omega of Unicode
    ("2 ns", "s", 2e-9),
    ("3µs", "s", 3e-6),
    ("3 μs", "s", 3e-6),
    ("3 us", "s", 3e-6),
    ("1 L/s", "m^3/s", 1e-3),
    ("36 km/h", "m/s", 10.0),
    ("25 %", "", 0.25),
    ("20 degC", "K", 293.15),
    ("20 °C", "K", 293.15),
    ("-5 °C", "K", 268.15),
    ("0 ℃", "K", 273.15),
    ("300 K", "K", 300.0),
    ("1/s", "Hz", 1.0),
    ("5 /s", "Hz", 5.0),
    ("5 1/s", "Hz", 5.0),
    ("8 mm²", "m^2", 8e-6),
    ("4 (m/s)^2", "m^2/s^2", 4.0),
    ("4 ((m)/(s))²", "m^2/s^2", 4.0),
    ("1 in", "m", 0.0254),
    ("2 ft", "m", 0.6096),
    ("5 mil", "m", 0.000127),
    ("3 yd", "m", 2.7432),
    ("2 mi", "m", 3218.688),
    ("1 mile", "m", 1609.344),
    ("1 atm", "Pa", 101325.0),
    ("0.5 Nm", "N m", 0.5),
    ("20 mNm/rad", "N m", 0.02),
    ("10 mH2O", "Pa", 98066.5),
    ("1500", "m/s", 1500.0),
    ("20 m3/h", "m^3/s", 20 / 3600),
    ("998 kg/m3", "kg/m^3", 998.0),
    ("50 Ohm", "ohm", 50.0),
    ("3 Bar", "Pa", 3e5),
    ("10 centimeters", "m", 0.1),
    ("2 Kilometres", "m", 2000.0),
    ("7 feet", "m", 2.1336),
    ("6 inches", "m", 0.1524),
    ("68 degF", "K", 293.15),
    ("1000 gpm", "m^3/s", 231e3 * 0.0254**3 / 60),
    ("1 GPM", "m^3/s", 231 * 0.0254**3 / 60),
    ("24 MGD", "m^3/s", 1e6 * 231 * 0.0254**3 / 3600),
    ("24 imgd", "m^3/s", 4546.09 / 3600),
    ("2 cfs", "m^3/s", 2 * 0.3048**3),
    ("4 lps", "m^3/s", 4e-3),
    ("86.4 mld", "m^3/s", 1.0),
    ("86400 afd", "m^3/s", 43560 * 0.3048**3),
    ("3 fps", "m/s", 0.9144),
    ("2 lb", "kg", 0.90718474),
    (" +.5e1  m ", "m", 5.0),
    ("−3 m", "m", -3.0),
    ("5.\u00a0m", "m", 5.0),
    ("1e-400 m", "m", 0.0),
]


@pytest.mark.parametrize(("text", "unit", "value"), READ)
def test_read(text: str, unit: str, value: float) -> None:
    assert to_si(text, unit) == pytest.approx(value, rel=3e-16)  # some references above are rounded twice


def test_angles_are_plain_numbers() -> None:
    assert to_si("45 deg", "") == math.pi / 4
    assert to_si("180°", "rad") == math.pi


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("1 rad/s", "Hz", 1 / (2 * math.pi)),
        ("2 krad/s", "Hz", 1e3 / math.pi),
        ("1e3 rad/s", "Hz", 1e3 / (2 * math.pi)),
        ("360 deg/s", "Hz", 1.0),
        ("90°/ms", "Hz", 250.0),
        ("1 (rad/s)", "Hz", 1 / (2 * math.pi)),
        ("1 Hz", "rad/s", 2 * math.pi),
        ("1 kHz", "rad/s", 2000 * math.pi),
        ("1 1/s", "rad/s", 1.0),
        ("1 1/s", "Hz", 1.0),
        ("60 1/min", "Hz", 1.0),
        ("7", "Hz", 7.0),
        ("7", "rad/s", 7.0),
        ("1 N m/Hz", "N m s/rad", 1 / (2 * math.pi)),
        ("1 rad Hz", "Hz", 1.0),
        ("1 rad/s", "", None),
    ],
)
def test_angles_and_cycles_are_told_apart(text: str, unit: str, value: float | None) -> None:
    if value is None:
        with pytest.raises(InputError):
            to_si(text, unit)
    else:
        assert to_si(text, unit) == pytest.approx(value, rel=1e-15)


def test_a_tower_of_angles_is_refused() -> None:
    with pytest.raises(InputError, match="a power in the unit is too large"):
        to_si("1 " + "(" * 30 + "rad" + "^12)" * 30 + "/s", "Hz")


@given(st.floats(1e-9, 1e9), st.sampled_from(["m", "k", "M", ""]))
def test_a_frequency_and_its_angular_frequency_are_one(number: float, prefix: str) -> None:
    hertz = to_si(f"{number!r} {prefix}Hz", "Hz")
    assert to_si(f"{number!r} {prefix}Hz", "rad/s") == pytest.approx(2 * math.pi * hertz, rel=1e-15)
    assert to_si(f"{2 * math.pi * hertz!r} rad/s", "Hz") == pytest.approx(hertz, rel=1e-15)


def test_quotients_are_read_from_left_to_right_and_a_space_multiplies() -> None:
    assert to_si("1 m / s m", "m^2/s") == 1.0
    assert to_si("1 m/(s m)", "1/s") == 1.0
    assert to_si("1 m/s/s", "m/s^2") == 1.0


def test_numbers_pass_as_si() -> None:
    assert to_si(3, "m") == 3.0
    assert to_si(np.float64(3.5), "m") == 3.5
    assert to_si(np.int64(3), "m") == 3.0  # type: ignore[arg-type]
    assert type(to_si(np.float32(0.5), "m")) is float  # type: ignore[arg-type]


def test_any_dimension_when_no_unit_is_expected() -> None:
    assert to_si("3 km", None) == 3000.0
    assert to_si("20 degC", None) == 293.15


def test_infinity_is_let_in_only_on_request() -> None:
    assert to_si("inf", "ohm", allow_infinite=True) == math.inf
    assert to_si("-inf ohm", "ohm", allow_infinite=True) == -math.inf
    with pytest.raises(InputError, match="not a finite number"):
        to_si("inf", "ohm")
    with pytest.raises(InputError, match="not a finite number"):
        to_si("nan", "ohm", allow_infinite=True)


REFUSED = [
    ("3 s", "m", "x: this unit measures something else, expected a length such as '1 m', got '3 s'"),
    ("3 m", "", "x: this unit measures something else, expected a plain number such as '0.5', got '3 m'"),
    ("20 °C", "m", "x: this unit measures something else, expected a length such as '1 m', got '20 °C'"),
    ("3 mpa", "Pa", "x: unknown unit 'mpa', expected 'mPa' or 'MPa'"),
    ("20 gpmm", "m^3/s", "x: unknown unit 'gpmm', expected 'gpm', got 'gpmm'"),
    ("5 lpx", "Pa", "x: unknown unit 'lpx', expected a pressure such as '1 Pa', got 'lpx'"),
    ("3 furlong", "m", "x: unknown unit 'furlong', expected a length such as '1 m', got 'furlong'"),
    ("5 lps", "Pa", "x: this unit measures something else, expected a pressure such as '1 Pa', got '5 lps'"),
    ("1 J/degC", None, "x: unknown unit 'degC', expected 'K' inside a product"),
    ("cm", "m", "x: there is no number in front, expected a length such as '1 m', got 'cm'"),
    ("", "K", "x: there is no number in front, expected a temperature such as '20 degC' or '300 K', got ''"),
    ("15 C", "K", "x: C is the coulomb, expected a temperature such as '20 degC' or '300 K', got '15 C'"),
    ("60 F", "K", "x: F is the farad, expected a temperature such as '20 degC'"),
    ("3 V", "N m", "x: this unit measures something else, expected a torque such as '1 N m', got '3 V'"),
    ("0,5 m", "m", "x: cannot read the unit, expected a decimal point, got ',5 m'"),
    ("3 m^2^3", "m", "x: cannot read the unit"),
    ("3 m^0.5", "m", "x: cannot read the unit"),
    ("3 m^99", "m", "x: a power in the unit is too large, expected at most 12"),
    ("3 (m", "m", "x: cannot read the unit"),
    ("3 m)", "m", "x: cannot read the unit"),
    ("3 *m", "m", "x: cannot read the unit"),
    ("3 m/", "m", "x: cannot read the unit"),
    ("3 #0", "m", "x: cannot read the unit"),
    ("3 4", "m", "x: cannot read the unit"),
    ("1_000 m", "m", "x: cannot read the unit"),
    ("1e999 m", "m", "x: not a finite number"),
    ("1e99999999999 m", "m", "x: not a finite number"),
    (10**400, "m", "x: not a finite number, expected a length such as '1 m', got inf"),
    (math.nan, "m", "x: not a finite number, expected a length such as '1 m', got nan"),
    (True, "m", "x: not a number"),
    (None, "m", "x: not a number, expected a length such as '1 m', got None"),
    ([1], None, "x: not a number, expected a number with a unit"),
]


@pytest.mark.parametrize(("value", "unit", "sentence"), REFUSED)
def test_refused_in_one_sentence(value: object, unit: str | None, sentence: str) -> None:
    with pytest.raises(InputError) as caught:
        to_si(value, unit, "x")  # type: ignore[arg-type]
    assert str(caught.value).startswith(sentence)
    assert "\n" not in str(caught.value)


HOSTILE = [
    "(" * 1_000_000,
    "9" * 1_000_000,
    "1 " + "m" * 1_000_000,
    "1 " + "(" * 98 + "m" + ")" * 98,
    "1 " + "(" * 98,
    "1 " + "(" * 30 + "psi" + "^12)" * 30,
    "1 " + "psi^12 " * 28,
    "9" * 150 + "e-99999999 m",
]


@pytest.mark.parametrize("text", HOSTILE, ids=range(len(HOSTILE)))
def test_hostile_text_costs_little(text: str) -> None:
    with pytest.raises(InputError) as caught:
        to_si(text, "s")
    assert len(str(caught.value)) < 300


@settings(deadline=None)
@given(st.text(st.characters(exclude_categories=["Cs"]), max_size=LONGEST + 5))  # a codec would take a second
def test_any_text_is_read_or_refused(text: str) -> None:
    with suppress(InputError):
        assert math.isfinite(to_si(text, None))


@settings(deadline=None)
@given(st.text(alphabet="0123456789.eE+-*/^()µΩ°% mskgPabrVAFHoh²³⁻", max_size=30))
def test_any_near_miss_is_read_or_refused(text: str) -> None:
    with suppress(InputError):
        assert math.isfinite(to_si("1 " + text, None))


@settings(deadline=None)
@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_printed_number_is_read_back_exactly(number: float) -> None:
    assert to_si(repr(number), "m") == number
    assert to_si(f"{number!r} m", "m") == number


PRINTED = [
    (11.1e-12, "F/m", "11.1 pF/m"),
    (4.679e7, "bar/(m^3/s)", "467.9 bar/(m^3/s)"),
    (2.205e9, "bar", "22050 bar"),
    (0.1, "m", "100 mm"),
    (999.96e-9, "H/m", "1 µH/m"),  # rounding moves it to the next prefix
    (50.0, "ohm", "50 ohm"),
    (0.0, "Pa", "0 Pa"),
    (-3e-4, "V", "-300 µV"),
    (0.01, "cm^2", "100 cm^2"),
    (1e-20, "F", "1e-05 fF"),
    (1e18, "Pa", "1e+06 TPa"),
    (math.inf, "ohm", "inf ohm"),
    (0.66, "%", "66 %"),
    (20.0, "", "20"),
    (5.0, "m^2", "5 m^2"),  # a prefix would be raised too
]


@pytest.mark.parametrize(("value", "unit", "text"), PRINTED)
def test_engineering(value: float, unit: str, text: str) -> None:
    assert engineering(value, unit) == text


@settings(deadline=None)
@given(st.floats(1e-15, 1e15), st.sampled_from(["m", "Pa", "F/m", "bar/(m^3/s)", "ohm", "kg/m^3", "%"]))
def test_what_is_printed_is_read_back(value: float, unit: str) -> None:
    # four significant digits: half a unit of the fourth is 5e-4 relative at most
    assert to_si(engineering(value, unit), unit) == pytest.approx(value, rel=5.0001e-4)


US = {
    "m": "ft", "m^2": "ft^2", "m^3": "ft^3", "m/s": "ft/s", "m^3/s": "gpm", "Pa": "psi", "kg/m^3": "lb/ft^3",
    "kg m^2": "lb ft^2", "Pa s": "psi s", "m^2/s": "ft^2/s", "N/m": "lbf/in", "kg": "lb", "K": "degR", "Hz": "rpm",
}  # fmt: skip
SCENES = [name for name, scene in tl.examples.items() if scene.medium == "hydraulic"]


def in_us(part: Any) -> Any:
    """What was given, as a table, with every quantity that has a US unit in it."""
    if isinstance(part, Quantity):
        unit = US.get(part.unit or "")
        return part.typed if unit is None else f"{float(part) / to_si(f'1 {unit}', part.unit)!r} {unit}"
    if isinstance(part, Element):
        fields = type(part).model_fields
        return {fields[name].alias or name: in_us(getattr(part, name)) for name in part.model_fields_set}
    if isinstance(part, Mapping):
        return {key: in_us(value) for key, value in part.items()}
    return [in_us(value) for value in part] if isinstance(part, list | tuple) else part


@pytest.mark.parametrize("name", SCENES)
def test_the_same_scene_in_us_units(name):
    scene = tl.examples[name]
    other = tl.Scene(scene.folder, **in_us(scene))
    close: Any = {"rtol": 1e-12, "atol": 0.0}
    for key, line in scene.lines.items():
        ours, theirs = line.parameters, other.lines[key].parameters
        assert [theirs.z0, theirs.delay] == pytest.approx([ours.z0, ours.delay], rel=1e-12)
    for (where, one), (_, two) in zip(scene.placed, other.placed, strict=True):
        if hasattr(one, "law"):
            np.testing.assert_allclose(two.law().constants, one.law().constants, **close, err_msg=str(where))
    t = np.linspace(0.0, float(scene.t_end), 40)
    for key, source in scene.sources.items():
        np.testing.assert_allclose(other.sources[key].value.value(t, t), source.value.value(t, t), rtol=1e-11)
