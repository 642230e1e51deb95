"""Parameters of a hydraulic line."""

import math
from collections.abc import Mapping

from tline.errors import InputError
from tline.line.materials import fluid as named_fluid, metastable, youngs_modulus as named_modulus
from tline.line.parameters import LineParameters, LineQuantity, read
from tline.line.plausible import PIPES, unusual
from tline.line.relations import AGREE, Given, Relation, Relations, determine

QUANTITIES = (
    LineQuantity("radius", "R", "m", "m", "inner radius"),
    LineQuantity("diameter", "d", "m", "m", "inner diameter"),
    LineQuantity("area", "A", "m^2", "cm^2", "cross-section of the flow"),
    LineQuantity("wave_speed", "c", "m/s", "", "speed of a pressure wave in the line"),
    LineQuantity("density", "ρ", "kg/m^3", "kg/L", "density of the fluid"),
    LineQuantity("bulk_modulus", "K", "Pa", "bar", "bulk modulus of the fluid itself"),
    LineQuantity("effective_bulk_modulus", "β", "Pa", "bar", "bulk modulus of fluid and wall together"),
    LineQuantity("z0", "z0", "Pa s/m^3", "bar/(m^3/s)", "characteristic impedance"),
    LineQuantity("length", "l", "m", "m", "length"),
    LineQuantity("delay", "T", "s", "s", "time a wave takes from end to end"),
    LineQuantity("inertance", "L'", "kg/m^5", "", "inertance per length"),
    LineQuantity("compliance", "C'", "m^2/Pa", "L/bar/m", "compliance per length"),
    LineQuantity("wall_thickness", "e", "m", "m", "thickness of an elastic wall"),
    LineQuantity("youngs_modulus", "E", "Pa", "Pa", "Young's modulus of an elastic wall"),
    LineQuantity("restraint", "ψ", "", "", "factor of the wall for its supports, 1 if not given"),
)

RELATIONS: tuple[Mapping[str, int], ...] = (
    {"diameter": 1, "2": -1, "radius": -1},
    {"area": 1, "pi": -1, "radius": -2},
    {"z0": 1, "area": 1, "density": -1, "wave_speed": -1},
    {"effective_bulk_modulus": 1, "density": -1, "wave_speed": -2},
    {"length": 1, "wave_speed": -1, "delay": -1},
    {"inertance": 1, "area": 1, "density": -1},
    {"compliance": 1, "effective_bulk_modulus": 1, "area": -1},
)
CONSTANTS = {"2": 2.0, "pi": math.pi}
WALL = {"wall_thickness", "youngs_modulus"}
TARGETS = (("z0",), ("wave_speed", "delay"))


def _wall_softens(name: str, known: Mapping[str, float]) -> float:
    """Compute 1/β = 1/K + w, with w = ψ·d/(E·e) (Korteweg 1878)."""
    if name == "effective_bulk_modulus":
        return 1 / (1 / known["bulk_modulus"] + known["wall_compliance"])
    if name == "bulk_modulus":
        return 1 / (1 / known["effective_bulk_modulus"] - known["wall_compliance"])
    return 1 / known["effective_bulk_modulus"] - 1 / known["bulk_modulus"]


RIGID = Relations(
    (*RELATIONS, {"effective_bulk_modulus": 1, "bulk_modulus": -1}),
    CONSTANTS,
    remedies={"bulk_modulus": "if a yielding wall slows the wave, give wall_thickness and youngs_modulus"},
)
ELASTIC = Relations(
    (
        *RELATIONS,
        {"wall_compliance": 1, "wall_thickness": 1, "youngs_modulus": 1, "restraint": -1, "diameter": -1},
    ),
    CONSTANTS,
    Relation(
        ("effective_bulk_modulus", "bulk_modulus", "wall_compliance"),
        _wall_softens,
        "1/(1/bulk_modulus + restraint*diameter/(youngs_modulus*wall_thickness))",
        "the wave would be as fast as in a rigid wall or faster, which no elastic wall allows",
    ),
)


class HydraulicLine(LineParameters):
    """Lossless pipe or hose: the quantities given, and all that follow from them.

    Every argument is a number in SI or a text with a unit; each must be positive and finite. Any sufficient
    set is allowed. Quantities left undetermined are ``None``.

    Parameters
    ----------
    radius, diameter : float or str, optional
        Inner radius and diameter, m.
    area : float or str, optional
        Cross-section of the flow, m².
    wave_speed : float or str, optional
        Speed c of a pressure wave in the line, m/s.
    density : float or str, optional
        Density ρ of the fluid, kg/m³.
    bulk_modulus : float or str, optional
        Bulk modulus K of the fluid itself, Pa.
    effective_bulk_modulus : float or str, optional
        Bulk modulus β = ρc² of fluid and wall together, Pa; equal to K if the wall is rigid.
    z0 : float or str, optional
        Characteristic impedance ρc/A, Pa s/m³.
    length, delay : float or str, optional
        Length, m, and the time length/c, s.
    inertance, compliance : float or str, optional
        Per length: ρ/A, kg/m⁵, and A/(ρc²), m²/Pa.
    wall_thickness, youngs_modulus, restraint : float or str, optional
        Thickness e, m, Young's modulus E, Pa, and support factor ψ of a thin elastic wall:
        1/β = 1/K + ψd/(Ee). With Poisson's ratio ν, ψ is 1 with expansion joints (default), 1-ν² anchored
        all along, 1-ν/2 held at one end only. The wall is rigid if neither e nor E is given.
    fluid : str, optional
        ``"water"`` or ``"hydraulic oil"``: gives density and bulk modulus, unless these are given. A
        wave speed given too may be lower than the fluid's own: the wall then yields accordingly.
    temperature : float or str, optional
        Of water: K, or ``"20 degC"``, which is the default.
    wall : str, optional
        ``"steel"``, ``"ductile iron"``, ``"cast iron"``, ``"copper"``, ``"aluminium"``, ``"concrete"``,
        ``"pvc"`` or ``"hdpe"``: gives Young's modulus, unless it is given.

    Raises
    ------
    InputError
        A bad value, an unknown name, quantities that contradict each other by more than a relative 1e-6 and more than
        the precision of the digits typed in a text, or too few: z0 and one of wave_speed and delay must follow.

    References
    ----------
    E. B. Wylie and V. L. Streeter, Fluid Transients in Systems, Prentice Hall 1993, chapter 1: wave speed in
    a thin-walled pipe (ψ is its c1). D. J. Korteweg, Annalen der Physik 241 (1878) 525-542,
    doi:10.1002/andp.18782411206.

    Examples
    --------
    >>> line = HydraulicLine(radius="10 cm", wave_speed=1500, density=980)
    >>> f"{line.z0:.4g} Pa s/m^3, {line.bulk_modulus:.4g} Pa"
    '4.679e+07 Pa s/m^3, 2.205e+09 Pa'
    """

    quantities = QUANTITIES
    shown = ("wave_speed", "effective_bulk_modulus", "z0", "delay", "inertance", "compliance")
    radius: float | None
    diameter: float | None
    area: float | None
    wave_speed: float | None
    density: float | None
    bulk_modulus: float | None
    effective_bulk_modulus: float | None
    z0: float
    length: float | None
    delay: float | None
    inertance: float | None
    compliance: float | None
    wall_thickness: float | None
    youngs_modulus: float | None
    restraint: float | None

    def __init__(
        self,
        *,
        radius: float | str | None = None,
        diameter: float | str | None = None,
        area: float | str | None = None,
        wave_speed: float | str | None = None,
        density: float | str | None = None,
        bulk_modulus: float | str | None = None,
        effective_bulk_modulus: float | str | None = None,
        z0: float | str | None = None,
        length: float | str | None = None,
        delay: float | str | None = None,
        inertance: float | str | None = None,
        compliance: float | str | None = None,
        wall_thickness: float | str | None = None,
        youngs_modulus: float | str | None = None,
        restraint: float | str | None = None,
        fluid: str | None = None,
        temperature: float | str | None = None,
        wall: str | None = None,
    ):
        arguments = {name: value for name, value in locals().items() if name != "self"}
        given = read(QUANTITIES, arguments)
        given.remarks += unusual(PIPES, given)
        if fluid is not None:
            given.include("fluid", named_fluid(fluid, temperature)._asdict())
            given.remarks += metastable(temperature)
            _slow(given)
        elif temperature is not None:
            raise InputError("temperature", "counts only with a fluid", "fluid = 'water'")
        if wall is not None:
            given.include("wall", {"youngs_modulus": named_modulus(wall)})
        values = determine(_system(given), given, TARGETS, _offered(given.values))
        self._settle(values, arguments, given.remarks)


def _slow(given: Given) -> None:
    """Set the effective bulk modulus from a wave speed below that of the fluid itself: the wall yields."""
    values = given.values
    effective = values["density"] * values.get("wave_speed", math.inf) ** 2
    if effective < values["bulk_modulus"] * (1 - AGREE) and "effective_bulk_modulus" not in values:
        values["effective_bulk_modulus"] = effective
        given.sources["effective_bulk_modulus"] = ("wave_speed", "fluid")


def _is_elastic(given: Mapping[str, float]) -> bool:
    moduli = given.keys() & {"bulk_modulus", "effective_bulk_modulus"}
    differ = len(moduli) == 2 and abs(given["effective_bulk_modulus"] / given["bulk_modulus"] - 1) > AGREE
    return differ or not WALL.isdisjoint(given)


def _system(given: Given) -> Relations:
    """Relations for a rigid or an elastic wall; the latter gets its restraint, 1 unless given."""
    values = given.values
    if _is_elastic(values):
        if "restraint" not in values and not WALL.isdisjoint(values):
            values["restraint"], given.sources["restraint"] = 1.0, ()
        return ELASTIC
    if "restraint" in values:
        raise InputError("restraint", "counts only with an elastic wall", "wall_thickness and youngs_modulus")
    return RIGID


def _offered(given: Mapping[str, float]) -> list[str]:
    useless = {"restraint"} if _is_elastic(given) else {"restraint", "effective_bulk_modulus", *WALL}
    return [quantity.name for quantity in QUANTITIES if quantity.name not in useless]
