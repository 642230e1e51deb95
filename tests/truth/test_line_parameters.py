"""Line parameters against numbers and programs that are not ours."""

import math

import pytest
import scipy.constants
from hypothesis import given, settings, strategies as st
from iapws._iapws import _Liquid
from pint import UnitRegistry

from tline import ElectricalLine, HydraulicLine, InputError
from tline.line import electrical
from tline.line.materials import water
from tline.units import PLAIN, PREFIXABLE, PREFIXES, to_si

PINT = UnitRegistry()
BASE = {"kilogram": "kg", "meter": "m", "second": "s", "ampere": "A", "kelvin": "K", "radian": "rad"}
SYMBOLS = [
    *PREFIXABLE,
    *(symbol for symbol in PLAIN if symbol not in "1%"),
    *(p + u for u in PREFIXABLE for p in PREFIXES),
]


@pytest.mark.parametrize("symbol", SYMBOLS)
def test_units_agree_with_pint(symbol: str) -> None:
    # pint knows water columns in centimetres only, and its mil is an angle
    number, name = {"mH2O": (100, "cmH2O"), "mil": (1, "thou")}.get(symbol, (1, symbol))
    theirs = PINT.Quantity(number, name.replace("Nm", "N*m")).to_base_units()  # their Nm measures yarn
    unit = " ".join(f"{BASE[str(base)]}^{power:g}" for base, power in theirs.unit_items() if BASE[str(base)])
    # pint multiplies floats, we round once: a few units of the last place
    assert to_si(f"1 {symbol}", unit) == pytest.approx(theirs.magnitude, rel=1e-14)


COMPOUND = ["bar/(m^3/s)", "Pa*s/m^3", "km/h", "L/min", "psi/ft", "kg/m/s**2", "uF/km", "(m/s)**2/(K*mm)", "ohm/m*s"]


@pytest.mark.parametrize("text", COMPOUND)
def test_products_agree_with_pint(text: str) -> None:
    theirs = PINT.Quantity(1.7, text).to_base_units()  # in one text with the number some versions square that, too
    assert to_si(f"1.7 {text}", None) == pytest.approx(theirs.magnitude, rel=1e-14)


def test_temperatures_agree_with_pint() -> None:
    assert to_si("36.6 degC", "K") == pytest.approx(PINT.Quantity(36.6, "degC").to("K").magnitude, rel=1e-15)


def test_the_two_lines_of_the_exercise() -> None:
    """A pipe of R = 10 cm, c = 1500 m/s and 980 kg/m³; an overhead line of 300 ohm and 3e8 m/s.

    The results are the exercise's own, to the digits it gives.
    """
    pipe = HydraulicLine(radius="10 cm", wave_speed=1500, density=980)
    assert pipe.bulk_modulus == pytest.approx(2.205e9, rel=1e-15)  # an integer product
    assert pipe.z0 == pytest.approx(4.679e7, abs=0.0005e7)
    assert pipe.z0 == pytest.approx(to_si("467.9 bar/(m^3/s)", "Pa s/m^3"), abs=0.05e5)
    wire = ElectricalLine(wave_speed=3e8, z0=300)
    assert wire.inductance == pytest.approx(1.0e-6, rel=1e-15)
    assert wire.capacitance == pytest.approx(11.1e-12, abs=0.05e-12)


@settings(deadline=None)
@given(st.floats(253.16, 383.14))
def test_water_agrees_with_the_iapws_package(temperature: float) -> None:
    theirs = _Liquid(temperature)
    # the same series, summed in another order: some units of the last place
    assert water(temperature).density == pytest.approx(theirs["rho"], rel=1e-14)
    assert water(temperature).bulk_modulus == pytest.approx(theirs["rho"] * theirs["w"] ** 2, rel=1e-14)


@pytest.mark.parametrize(
    ("temperature", "density", "speed"),
    [(273.15, 999.84, 1402.4), (293.15, 998.21, 1482.3), (298.15, 997.05, 1496.7), (373.15, 958.35, 1543.2)],
)
def test_water_agrees_with_published_values(temperature: float, density: float, speed: float) -> None:
    """Density and speed of sound as in handbook tables of water; tolerances are half their last digit."""
    fluid = water(temperature)
    assert fluid.density == pytest.approx(density, abs=0.0051)
    assert math.sqrt(fluid.bulk_modulus / fluid.density) == pytest.approx(speed, abs=0.051)


@pytest.mark.parametrize("temperature", ["-20 degC", "110 degC", 253.15, 383.15])
def test_the_range_of_the_release_includes_its_ends(temperature: float | str) -> None:
    assert HydraulicLine(radius=1, fluid="water", temperature=temperature).wave_speed


@pytest.mark.parametrize("temperature", [253.14, 383.16])
def test_outside_the_release_nothing_is_said(temperature: float) -> None:
    with pytest.raises(InputError, match="no liquid water"):
        water(temperature)


# outer diameter and wall thickness (in) from ANSI/AWWA C151; wave speed (ft/s) from table 4.1 of
# A. P. Moser, Buried Pipe Design, 2nd ed., McGraw-Hill 2001
DUCTILE_IRON = [
    (4.80, 0.26, 4409), (4.80, 0.29, 4452), (6.90, 0.25, 4206), (6.90, 0.28, 4265), (9.05, 0.27, 4085),
    (9.05, 0.30, 4148), (11.10, 0.29, 3996), (13.20, 0.31, 3919), (15.30, 0.33, 3859), (17.40, 0.34, 3783),
    (19.50, 0.35, 3716), (21.60, 0.36, 3655),
]  # fmt: skip


@pytest.mark.parametrize(("outer", "wall", "speed"), DUCTILE_IRON)
def test_ductile_iron_pipe_against_the_handbook(outer: float, wall: float, speed: float) -> None:
    line = HydraulicLine(
        diameter=f"{outer - 2 * wall} in",
        wall_thickness=f"{wall} in",
        wall="ductile iron",
        fluid="water",
        temperature="20 degC",
    )
    # the handbook does not state its water; 0.1 % covers 20 degC within 2 K
    assert line.wave_speed == pytest.approx(to_si(f"{speed} ft/s", "m/s"), rel=1e-3)


def test_constants_agree_with_codata() -> None:
    assert electrical.LIGHT - scipy.constants.c == 0
    # the last digits move with each CODATA adjustment, by less than 2e-9 since 2018
    assert abs(electrical.MU0 / scipy.constants.mu_0 - 1) < 2e-9


# precision air lines of IEEE Std 287: inner and outer diameter in mm, 50 ohm by definition
@pytest.mark.parametrize(("inner", "outer"), [(6.204, 14.2875), (3.04, 7.0), (1.52, 3.5)])
def test_precision_air_lines_are_50_ohm(inner: float, outer: float) -> None:
    line = ElectricalLine(inner_diameter=f"{inner} mm", outer_diameter=f"{outer} mm", permittivity=1.000649)
    assert line.z0 == pytest.approx(50.0, rel=3e-4)  # diameters are printed to 1e-3 mm or coarser


@pytest.mark.parametrize(
    ("inner", "outer", "ohms", "tolerance", "picofarad_per_foot"),
    [(0.023, 0.146, 75, 3, 21), (0.032, 0.116, 50, 2, 29)],
    ids=["RG-59B", "RG-58"],
)
def test_coaxial_cables_of_the_catalogue(
    inner: float, outer: float, ohms: float, tolerance: float, picofarad_per_foot: float
) -> None:
    """Solid polyethylene, velocity factor 0.66; diameters in inches, impedance with the makers' tolerance."""
    line = ElectricalLine(inner_diameter=f"{inner} in", outer_diameter=f"{outer} in", velocity_factor=0.66)
    assert line.z0 == pytest.approx(ohms, abs=tolerance)
    # the tolerance of the impedance is one of the capacitance too
    assert line.capacitance == pytest.approx(to_si(f"{picofarad_per_foot} pF/ft", "F/m"), rel=tolerance / ohms + 0.02)


@pytest.mark.parametrize("ratio", [1.05, 1.5, 3.0, 30.0])
def test_two_wires_against_their_images(ratio: float) -> None:
    """Two line charges make circles of constant potential, which is summed here, without an acosh."""
    radius, half = 0.5, ratio / 2
    charge = math.sqrt(half**2 - radius**2)  # the line charges stand here, inside each wire
    near, far = half - radius, half + radius  # where the right wire's surface cuts the axis
    potential = [math.log((x + charge) / abs(x - charge)) for x in (near, far)]
    assert potential[0] == pytest.approx(potential[1], rel=1e-12)  # the surface is an equipotential
    capacitance = 2 * math.pi * scipy.constants.epsilon_0 / (2 * potential[0])
    line = ElectricalLine(wire_diameter=1, spacing=ratio, permittivity=1)
    # CODATA digits of mu0 and epsilon_0, see above
    assert line.capacitance == pytest.approx(capacitance, rel=1e-8)


def test_an_open_wire_line_of_600_ohm() -> None:
    """The amateur's feeder: 276 log10(2s/d), good to (d/2s)² when the wires are thin."""
    line = ElectricalLine(wire_diameter="2.053 mm", spacing="6 in", permittivity=1)
    assert line.z0 == pytest.approx(276 * math.log10(2 * 152.4 / 2.053), rel=2e-3)  # 276 stands for 276.06
    assert line.z0 == pytest.approx(600, abs=1)
