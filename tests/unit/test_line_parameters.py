"""HydraulicLine and ElectricalLine: what follows from what, and what is refused."""

import copy
import math
import pickle
from collections.abc import Iterable, Iterator
from itertools import chain, combinations

import pytest

from tline import ElectricalLine, HydraulicLine, InputError
from tline.line.materials import HYDRAULIC_OIL, WALLS, water

ROUNDING = 1e-14  # a chain of some ten operations, each to half a unit of the last place

RIGID = HydraulicLine(radius=0.1, wave_speed=1500, density=980, length=300)
ELASTIC = HydraulicLine(
    diameter="0.2 m",
    density=1000,
    bulk_modulus="2.2 GPa",
    wall_thickness="5 mm",
    youngs_modulus="200 GPa",
    restraint=0.9,
)
CABLE = ElectricalLine(z0=50, velocity_factor=0.66, length=10)


def _values(line: HydraulicLine | ElectricalLine) -> dict[str, float]:
    return {name: value for name, value in vars(line).items() if isinstance(value, float)}


def test_hydraulic_formulas() -> None:
    area = math.pi * 0.01
    assert _values(RIGID) == pytest.approx(
        {
            "radius": 0.1, "diameter": 0.2, "area": area, "wave_speed": 1500, "density": 980,
            "bulk_modulus": 980 * 1500**2, "effective_bulk_modulus": 980 * 1500**2, "z0": 980 * 1500 / area,
            "length": 300, "delay": 0.2, "inertance": 980 / area, "compliance": area / (980 * 1500**2),
        },
        rel=ROUNDING,
    )  # fmt: skip


def test_elastic_formulas() -> None:
    effective = 1 / (1 / 2.2e9 + 0.9 * 0.2 / (200e9 * 5e-3))
    assert ELASTIC.effective_bulk_modulus == pytest.approx(effective, rel=ROUNDING)
    assert ELASTIC.wave_speed == pytest.approx(math.sqrt(effective / 1000), rel=ROUNDING)
    assert ELASTIC.bulk_modulus == 2.2e9


def test_electrical_formulas() -> None:
    speed = 0.66 * 299_792_458
    assert _values(CABLE) == pytest.approx(
        {
            "z0": 50, "velocity_factor": 0.66, "wave_speed": speed, "length": 10, "delay": 10 / speed,
            "inductance": 50 / speed, "capacitance": 1 / (50 * speed), "permittivity": 0.66**-2,
        },
        rel=ROUNDING,
    )  # fmt: skip


def test_the_constructor_takes_texts_and_numbers_alike() -> None:
    assert HydraulicLine(radius="10 cm", wave_speed="1.5 km/s", density="0.98 kg/L", length="0.3 km") == RIGID


@pytest.mark.parametrize("line", [RIGID, ELASTIC, CABLE], ids=["rigid", "elastic", "cable"])
def test_any_sufficient_set_gives_the_same_line(line: HydraulicLine | ElectricalLine) -> None:
    whole = _values(line)
    wall = {name: whole[name] for name in ("youngs_modulus", "restraint") if name in whole}  # to be elastic
    tried = [_attempt(type(line), wall | {name: whole[name] for name in names}) for names in _small_sets(whole)]
    again = [found for found in tried if not isinstance(found, InputError)]
    assert len(again) > 20
    # too few is the only complaint there can be, never a clash
    assert all("cannot be found" in str(found) for found in tried if isinstance(found, InputError))
    for values in map(_values, again):
        # a wall inferred from a difference of reciprocals amplifies roundings a few times
        assert values == pytest.approx({name: whole[name] for name in values}, rel=1e-13)


def _small_sets(names: Iterable[str]) -> Iterator[tuple[str, ...]]:
    names = list(names)
    return chain.from_iterable(combinations(names, size) for size in (2, 3))


def _attempt(
    kind: type[HydraulicLine | ElectricalLine], given: dict[str, float]
) -> HydraulicLine | ElectricalLine | InputError:
    try:
        return kind(**given)  # type: ignore[arg-type]
    except InputError as error:
        return error


def test_z0_and_delay_alone_are_enough() -> None:
    line = HydraulicLine(z0=2, delay=3)
    assert (line.z0, line.delay, line.wave_speed, line.density) == (2, 3, None, None)
    assert ElectricalLine(z0=1, delay=1).wave_speed is None


def test_a_line_cannot_be_changed() -> None:
    with pytest.raises(AttributeError, match="HydraulicLine is immutable, z0 cannot be set"):
        RIGID.z0 = 3.0
    with pytest.raises(AttributeError, match="immutable"):
        RIGID.new = 3.0  # type: ignore[attr-defined]
    with pytest.raises(AttributeError, match="z0 cannot be deleted"):
        del RIGID.z0


def test_equality_is_by_value() -> None:
    same = HydraulicLine(diameter=0.2, wave_speed=1500, density=980, length=300)
    assert same == RIGID
    assert hash(same) == hash(RIGID)
    assert HydraulicLine(radius=0.1, wave_speed=1500, density=980) != RIGID
    assert RIGID != CABLE
    assert RIGID != 3
    assert len({same, RIGID, CABLE}) == 2


def test_copies_and_pickles_are_equal() -> None:
    for line in (RIGID, CABLE):
        assert pickle.loads(pickle.dumps(line)) == line == copy.deepcopy(line)


def test_repr_is_what_was_given_and_tells_what_follows() -> None:
    line = HydraulicLine(radius="10 cm", fluid="water", wall="steel", wall_thickness=0.005)
    given, _, follows = repr(line).partition("  # ")
    assert given == "HydraulicLine(radius='10 cm', wall_thickness=0.005, fluid='water', wall='steel')"
    assert follows.startswith("c = 1.241 km/s, β = 15380 bar, z0 = 394.4 bar/(m^3/s), L' = ")
    assert str(line).splitlines()[1].split() == ["radius", "R", "0.1", "m", "100", "mm"]
    assert line.to_dict()["z0"] == line.z0
    assert eval(repr(line)) == line


def test_named_fluids_and_walls() -> None:
    line = HydraulicLine(radius=0.1, fluid="Water", temperature="10 degC", wall="steel", wall_thickness=0.01)
    assert (line.density, line.bulk_modulus) == water(283.15)
    assert line.youngs_modulus == WALLS["steel"]
    assert line.restraint == 1.0
    assert HydraulicLine(radius=0.1, fluid="hydraulic oil").density == HYDRAULIC_OIL.density


def test_water_has_room_temperature_unless_told() -> None:
    warm = HydraulicLine(radius=0.1, fluid="water", temperature=293.15)
    assert HydraulicLine(radius=0.1, fluid="water") == warm


def test_a_value_that_agrees_with_the_named_one_is_welcome() -> None:
    density = water().density * (1 + 5e-7)
    assert HydraulicLine(radius=0.1, fluid="water", density=density).density == density


def test_a_value_given_beside_a_named_one_counts_and_is_told() -> None:
    line = HydraulicLine(radius=0.1, fluid="water", density="1025 kg/m^3", wall="steel", youngs_modulus="200 GPa",
                         wall_thickness="6 mm")  # fmt: skip
    assert (line.density, line.bulk_modulus, line.youngs_modulus) == (1025, water().bulk_modulus, 200e9)
    assert line.remarks == (
        "density: 1025 kg/m^3 as given, instead of 998.207 kg/m^3 of the fluid",
        "youngs_modulus: 2e+11 Pa as given, instead of 2.06e+11 Pa of the wall",
    )
    assert HydraulicLine(radius=0.1, fluid="water", density=water().density).remarks == ()


@pytest.mark.parametrize(
    ("temperature", "remark"),
    [
        ("110 degC", "temperature: water of 383.15 K (110 degC) boils at 0.1 MPa; density and bulk modulus"),
        (372.77, "temperature: water of 372.77 K (99.62 degC) boils"),
        ("-5 degC", "temperature: water of 268.15 K (-5 degC) freezes at 0.1 MPa; density"),
    ],
)
def test_water_that_boils_or_freezes_is_told(temperature: str | float, remark: str) -> None:
    (told,) = HydraulicLine(radius=0.1, fluid="water", temperature=temperature).remarks
    assert told.startswith(remark)
    assert HydraulicLine(radius=0.1, fluid="water", temperature=372.76).remarks == ()


AGREEING = [  # kind, texts that agree to the digits typed, and how far they are apart
    (HydraulicLine, {"radius": "10 cm", "area": "314 cm^2", "fluid": "water"}, "radius and area", "0.0507 %"),
    (ElectricalLine, {"inductance": "252 nH/m", "capacitance": "101 pF/m", "z0": "50"}, "z0", "0.0991 %"),
    (ElectricalLine, {"z0": 50, "wave_speed": "2e8", "permittivity": "2.25"}, "wave_speed and permit", "0.138 %"),
    (HydraulicLine, {"radius": "10 cm", "diameter": "201 mm", "fluid": "water"}, "radius and diameter", "0.498 %"),
]


@pytest.mark.parametrize(("kind", "given", "names", "apart"), AGREEING)
def test_texts_that_agree_to_the_digits_typed_do_not_clash(kind: type, given: dict, names: str, apart: str) -> None:
    (remark,) = kind(**given).remarks
    assert names in remark
    assert remark.endswith(f", {apart} apart")
    assert " agree to the digits typed: " in remark


@pytest.mark.parametrize(
    "given",
    [
        {"radius": 0.1, "area": 0.0314},  # numbers are what they are
        {"radius": "10.00 cm", "area": "314.0 cm^2"},  # 314.16
        {"radius": "1 m", "diameter": "2.1 m"},  # digits typed excuse 1 % at most
    ],
)
def test_more_than_the_digits_typed_is_a_clash(given: dict) -> None:
    with pytest.raises(InputError, match=r"clash: .* apart$"):
        HydraulicLine(**given)


def test_the_wall_is_found_from_the_wave_it_slows() -> None:
    thickness = HydraulicLine(radius=0.1, fluid="water", wall="steel", wave_speed=1300).wall_thickness
    assert thickness is not None
    line = HydraulicLine(radius=0.1, fluid="water", wall="steel", wall_thickness=thickness)
    assert line.wave_speed == pytest.approx(1300, rel=ROUNDING)


def test_a_wave_slower_than_the_named_fluid_tells_of_its_wall():
    """Water at 1200 m/s: 1/β = 1/K + ψd/(Ee) gives the wall its thickness."""
    water = HydraulicLine(fluid="water", radius=0.1)
    pipe = HydraulicLine(fluid="water", wave_speed=1200, radius=0.1, youngs_modulus="200 GPa")
    assert pipe.bulk_modulus == water.bulk_modulus
    softening = 1 / (pipe.density * 1200**2) - 1 / pipe.bulk_modulus
    assert pipe.wall_thickness == pytest.approx(0.2 / (200e9 * softening), rel=1e-12)


def test_two_moduli_that_differ_mean_a_wall() -> None:
    line = HydraulicLine(radius=0.1, bulk_modulus=2e9, effective_bulk_modulus=1e9, density=1000)
    assert (line.wave_speed, line.restraint) == (1000.0, None)


def test_two_moduli_that_agree_mean_none() -> None:
    nearly = 2e9 * (1 + 1e-8)
    assert HydraulicLine(radius=1, bulk_modulus=2e9, effective_bulk_modulus=nearly, density=1).bulk_modulus == 2e9


def test_geometry_of_wires() -> None:
    pair = ElectricalLine(wire_diameter="2 mm", spacing="20 mm", permittivity=1)
    ground = ElectricalLine(wire_diameter="2 mm", height="10 mm", permittivity=1)
    # by its image a wire over ground is half a two-wire line of twice the height
    assert pair.z0 == pytest.approx(2 * ground.z0, rel=ROUNDING)
    assert (ground.wire_diameter, ground.height, ground.spacing) == (0.002, 0.01, None)


HYDRAULIC_MISTAKES = [
    ({}, "z0 and wave_speed or delay cannot be found, add for example"),
    (
        {"radius": 1, "density": 1000},
        "z0 and wave_speed or delay cannot be found, add wave_speed, bulk_modulus, z0 or compliance",
    ),
    ({"z0": 1}, "wave_speed or delay cannot be found, add wave_speed, delay, inertance or compliance"),
    (
        {"radius": 1, "fluid": "water", "wall": "steel"},
        "z0 and wave_speed or delay cannot be found, add wave_speed, effective_bulk_modulus, z0, compliance "
        "or wall_thickness",
    ),
    ({"radius": -1}, "radius: not positive, expected more than 0, got -1"),
    ({"radius": "0 m"}, "radius: not positive, expected more than 0, got '0 m'"),
    ({"radius": "nan"}, "radius: not a finite number"),
    ({"radius": math.inf}, "radius: not a finite number"),
    ({"radius": "1 kg"}, "radius: this unit measures something else, expected a length such as '1 m', got"),
    ({"wave_speed": "1500 m/sek"}, "wave_speed: unknown unit 'sek'"),
    (
        {"wave_speed": 1500, "density": 980, "bulk_modulus": 2e9, "radius": 1},
        "wave_speed, density and bulk_modulus clash: density*wave_speed^2 gives 2.205e+09 Pa but bulk_modulus "
        "is 2e+09 Pa, 10.3 % apart; if a yielding wall slows the wave, give wall_thickness and youngs_modulus",
    ),
    (
        {"wave_speed": 1600, "fluid": "water", "radius": 1},
        "wave_speed and fluid clash: density*wave_speed^2 gives 2.555e+09 Pa but bulk_modulus is 2.193e+09 Pa",
    ),
    (
        {"diameter": 0.2, "fluid": "water", "wall": "steel", "wall_thickness": 0.005, "wave_speed": 1400},
        "diameter, wave_speed, wall_thickness, fluid and wall clash: 1/(1/bulk_modulus + restraint*diameter/",
    ),
    (
        {"diameter": 0.2, "fluid": "water", "wall": "steel", "wave_speed": 1500},
        "wave_speed and fluid clash: the wave would be as fast as in a rigid wall or faster",
    ),
    ({"fluid": "beer"}, "fluid: unknown fluid, expected 'water' or 'hydraulic oil', got 'beer'"),
    ({"wall": "stel"}, "wall: unknown wall, expected 'steel' (known are 'steel', 'ductile iron',"),
    (
        {"fluid": "water", "temperature": 20},
        "temperature: no liquid water at 0.1 MPa, expected '-20 degC' to '110 degC'",
    ),
    (
        {"fluid": "water", "temperature": "120 degC"},
        "temperature: no liquid water at 0.1 MPa: it boils at 99.6 degC, expected '-20 degC' to '110 degC' (a bare "
        "number is in kelvin), got 393.15 K (120 degC)",
    ),
    ({"fluid": "water", "temperature": "20 m"}, "temperature: this unit measures something else"),
    (
        {"fluid": "hydraulic oil", "temperature": "40 degC"},
        "temperature: only water is known at other temperatures, got '40 degC'",
    ),
    ({"temperature": "20 degC"}, "temperature: counts only with a fluid, expected fluid = 'water'"),
    ({"radius": 1, "restraint": 1}, "restraint: counts only with an elastic wall"),
    ({"radius": 1e-200, "fluid": "water"}, "area follows from radius and leaves the range of numbers"),
]
ELECTRICAL_MISTAKES = [
    ({}, "z0 and wave_speed or delay cannot be found, add for example inductance with capacitance"),
    (
        {"inner_diameter": "1 mm", "outer_diameter": "3 mm"},
        "z0 and wave_speed or delay cannot be found, add capacitance, z0, wave_speed, velocity_factor or permittivity",
    ),
    (
        {"inner_diameter": 1},
        "not one complete geometry, expected inner_diameter and outer_diameter (coaxial cable), "
        "wire_diameter and spacing (two-wire line) or wire_diameter and height (wire over ground), got",
    ),
    ({"inner_diameter": 1, "spacing": 2}, "not one complete geometry"),
    ({"wire_diameter": 1, "spacing": 2, "height": 3}, "not one complete geometry"),
    (
        {"inner_diameter": "3 mm", "outer_diameter": "3 mm"},
        "outer_diameter: the conductors touch or overlap, expected more than 0.003 m, got 0.003 m",
    ),
    (
        {"wire_diameter": 1, "spacing": 0.9},
        "spacing: the conductors touch or overlap, expected more than 1 m, got 0.9 m",
    ),
    (
        {"wire_diameter": 1, "height": 0.5},
        "height: the conductors touch or overlap, expected more than 0.5 m, got 0.5 m",
    ),
    (
        {"inner_diameter": 1, "outer_diameter": 3, "permittivity": 1, "inductance": 1e-7},
        "inner_diameter, outer_diameter and inductance clash: mu0*geometry_factor/(2*pi) gives 2.197e-07 H/m but",
    ),
    (
        {"z0": 50, "wave_speed": 3.1e8},
        "wave_speed: the wave would be faster than light, expected a wave speed up to 299792 km/s, got",
    ),
    (
        {"z0": 50, "velocity_factor": 66},
        "velocity_factor: the wave would be faster than light, expected at most 1, or with a percent sign, got 66",
    ),
    ({"z0": 50, "permittivity": 0.9}, "permittivity: the wave would be faster than light"),
    ({"inductance": 1e-9, "capacitance": 1e-12}, "the wave would be faster than light"),
    ({"z0": "50 V"}, "z0: this unit measures something else, expected a resistance such as '1 ohm', got '50 V'"),
]


@pytest.mark.parametrize(
    ("kind", "given", "sentence"),
    [(HydraulicLine, *mistake) for mistake in HYDRAULIC_MISTAKES]
    + [(ElectricalLine, *mistake) for mistake in ELECTRICAL_MISTAKES],
)
def test_mistakes_are_told_in_one_sentence(kind: type, given: dict[str, object], sentence: str) -> None:
    with pytest.raises(InputError) as caught:
        kind(**given)
    assert str(caught.value).startswith(sentence)
    assert "\n" not in str(caught.value)


def test_an_unknown_argument_is_refused() -> None:
    with pytest.raises(TypeError, match="waves_peed"):
        HydraulicLine(waves_peed=1500)  # type: ignore[call-arg]


@pytest.mark.parametrize("speed", [299_792_458.0, 3e8, 299_792_458 * 1.0009])
def test_the_speed_of_light_may_be_rounded(speed: float) -> None:
    assert ElectricalLine(z0=50, wave_speed=speed).wave_speed == speed
