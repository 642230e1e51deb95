"""Parameters of an electrical line."""

import math
from collections.abc import Iterable, Mapping

from tline.errors import InputError
from tline.line.parameters import LineParameters, LineQuantity, read
from tline.line.plausible import CABLES, unusual
from tline.line.relations import Relations, determine, listed
from tline.units import engineering

QUANTITIES = (
    LineQuantity("inductance", "L'", "H/m", "H/m", "inductance per length"),
    LineQuantity("capacitance", "C'", "F/m", "F/m", "capacitance per length"),
    LineQuantity("z0", "z0", "ohm", "ohm", "characteristic impedance"),
    LineQuantity("wave_speed", "c", "m/s", "cm/ns", "speed of a wave on the line"),
    LineQuantity("velocity_factor", "c/c0", "", "%", "wave speed over the speed of light"),
    LineQuantity("permittivity", "εr", "", "", "relative permittivity of the insulation"),
    LineQuantity("length", "l", "m", "m", "length"),
    LineQuantity("delay", "T", "s", "s", "time a wave takes from end to end"),
    LineQuantity("inner_diameter", "d", "m", "m", "coaxial cable: diameter of the inner conductor"),
    LineQuantity("outer_diameter", "D", "m", "m", "coaxial cable: inner diameter of the outer conductor"),
    LineQuantity("wire_diameter", "d", "m", "m", "two-wire line or wire over ground: diameter of a wire"),
    LineQuantity("spacing", "s", "m", "m", "two-wire line: distance between the wire centres"),
    LineQuantity("height", "h", "m", "m", "wire over ground: height of the wire centre"),
)

LIGHT = 299_792_458.0  # m/s, exact in SI
MU0 = 1.25663706127e-6  # H/m, CODATA 2022
LIGHT_ROUNDING = 1e-3  # relative; 3e8 m/s is a common value for the speed of light

SYSTEM = Relations(
    (
        {"z0": 2, "capacitance": 1, "inductance": -1},
        {"wave_speed": 2, "inductance": 1, "capacitance": 1},
        {"velocity_factor": 1, "c0": 1, "wave_speed": -1},
        {"permittivity": 1, "velocity_factor": 2},  # not magnetic
        {"length": 1, "wave_speed": -1, "delay": -1},
        {"inductance": 1, "2": 1, "pi": 1, "mu0": -1, "geometry_factor": -1},
    ),
    {"2": 2.0, "pi": math.pi, "c0": LIGHT, "mu0": MU0},
)
TARGETS = (("z0",), ("wave_speed", "delay"))
GEOMETRIES = {
    "coaxial cable": ("inner_diameter", "outer_diameter"),
    "two-wire line": ("wire_diameter", "spacing"),
    "wire over ground": ("wire_diameter", "height"),
}
SPEEDS = frozenset(("wave_speed", "velocity_factor", "permittivity"))
SHAPE = dict.fromkeys(name for names in GEOMETRIES.values() for name in names)


class ElectricalLine(LineParameters):
    """Lossless, non-magnetic cable or pair of conductors: the quantities given, and all that follow from them.

    Every argument is a number in SI or a text with a unit; each must be positive and finite. Any sufficient
    set is allowed. Quantities left undetermined are ``None``.

    Parameters
    ----------
    inductance, capacitance : float or str, optional
        Per length, H/m and F/m.
    z0 : float or str, optional
        Characteristic impedance sqrt(inductance/capacitance), ohm.
    wave_speed : float or str, optional
        1/sqrt(inductance*capacitance), m/s; at most that of light, with 0.1 % to spare so that 3e8 passes.
    velocity_factor : float or str, optional
        Wave speed over the speed of light, up to 1.
    permittivity : float or str, optional
        Relative permittivity of the insulation, 1/velocity_factor², from 1.
    length, delay : float or str, optional
        Length, m, and the time length/wave_speed, s.
    inner_diameter, outer_diameter : float or str, optional
        Of a coaxial cable: of the inner conductor, and inside the outer conductor, m.
    wire_diameter, spacing : float or str, optional
        Of a two-wire line: of each wire, and between the centres, m.
    height : float or str, optional
        With wire_diameter, of a wire over ground: of its centre over the conducting plane, m.

    Raises
    ------
    InputError
        A bad value, an incomplete, mixed or impossible geometry, a wave faster than light, quantities that
        contradict each other by more than a relative 1e-6 and by more than the precision of the digits typed in
        a text, or too few of them: z0 and one of wave_speed and delay must follow.

    Notes
    -----
    A geometry gives the external inductance µ0/(2π)·g, with g = ln(D/d) for the coaxial cable, 2·acosh(s/d)
    for the two-wire line and acosh(2h/d) for the wire over ground (half a two-wire line, by its image). These
    are exact for perfect conductors in one insulating material.

    References
    ----------
    D. M. Pozar, Microwave Engineering, 4th ed., Wiley 2012, table 2.1. S. Ramo, J. R. Whinnery and
    T. Van Duzer, Fields and Waves in Communication Electronics, 3rd ed., Wiley 1994, chapter 5.

    Examples
    --------
    >>> line = ElectricalLine(wave_speed=3e8, z0=300)
    >>> f"{line.inductance:.3g} H/m, {line.capacitance:.3g} F/m"
    '1e-06 H/m, 1.11e-11 F/m'
    """

    quantities = QUANTITIES
    shown = ("inductance", "capacitance", "z0", "wave_speed", "delay")
    inductance: float | None
    capacitance: float | None
    z0: float
    wave_speed: float | None
    velocity_factor: float | None
    permittivity: float | None
    length: float | None
    delay: float | None
    inner_diameter: float | None
    outer_diameter: float | None
    wire_diameter: float | None
    spacing: float | None
    height: float | None

    def __init__(
        self,
        *,
        inductance: float | str | None = None,
        capacitance: float | str | None = None,
        z0: float | str | None = None,
        wave_speed: float | str | None = None,
        velocity_factor: float | str | None = None,
        permittivity: float | str | None = None,
        length: float | str | None = None,
        delay: float | str | None = None,
        inner_diameter: float | str | None = None,
        outer_diameter: float | str | None = None,
        wire_diameter: float | str | None = None,
        spacing: float | str | None = None,
        height: float | str | None = None,
    ):
        arguments = {name: value for name, value in locals().items() if name != "self"}
        given = read(QUANTITIES, arguments)
        given.remarks += unusual(CABLES, given)
        shape = {name: given.values.pop(name) for name in SHAPE if name in given.values}
        if shape:
            # first in line, so that a contradiction names a quantity the user knows
            given.values = {"geometry_factor": _geometry_factor(shape), **given.values}
            given.sources["geometry_factor"] = tuple(shape)
        offered = [quantity.name for quantity in QUANTITIES if quantity.name not in SHAPE]
        values = determine(SYSTEM, given, TARGETS, offered) | shape
        _check_speed(values.get("wave_speed", 0.0), given.values)
        self._settle(values, arguments, given.remarks)


def in_air(given: Iterable[str]) -> dict[str, float]:
    """Velocity factor of a wire over earth in air, unless the speed of its waves is given."""
    given = set(given)
    if SPEEDS & given:
        return {}
    told = next((name for name in ("z0", "capacitance") if name in given), None)
    if told and given.issuperset(GEOMETRIES["wire over ground"]):
        problem = "follows from height and wire_diameter in air, too"
        raise InputError(told, problem, "height and wire_diameter alone, or permittivity beside them, if not of air")
    return {"velocity_factor": 1.0}


def _geometry_factor(shape: Mapping[str, float]) -> float:
    """Geometry factor g in inductance = µ0/(2π)·g."""
    kind = next((kind for kind, names in GEOMETRIES.items() if set(names) == set(shape)), None)
    if kind is None:
        choices = [f"{listed(names)} ({kind})" for kind, names in GEOMETRIES.items()]
        raise InputError("", "not one complete geometry", listed(choices, "or"), listed(shape))
    small, large = (shape[name] for name in GEOMETRIES[kind])
    ratio = 2 * large / small if kind == "wire over ground" else large / small
    if ratio <= 1:
        bound = small / 2 if kind == "wire over ground" else small
        problem = "the conductors touch or overlap"
        raise InputError(GEOMETRIES[kind][1], problem, f"more than {bound:.6g} m", f"{large:.6g} m")
    if kind == "coaxial cable":
        return math.log(ratio)
    return math.acosh(ratio) * (2 if kind == "two-wire line" else 1)


def _check_speed(speed: float, given: Mapping[str, float]) -> None:
    if speed > LIGHT * (1 + LIGHT_ROUNDING):
        blamed = next((name for name in ("wave_speed", "velocity_factor", "permittivity") if name in given), "")
        expected, got = "a wave speed up to 299792 km/s", engineering(speed, "km/s")
        if blamed == "velocity_factor":
            expected, got = "at most 1, or with a percent sign", f"{given[blamed]:.6g}"
        raise InputError(blamed, "the wave would be faster than light", expected, got)
