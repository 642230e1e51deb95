"""Ranges of the quantities of real pipes and cables: remarks on values that are valid and yet implausible.

For each quantity two ranges, in SI: that of existing lines, for every value, and the usual one, by which a number
without a unit is judged more strictly, as it may have been typed in another unit than SI. Where the number would be
usual in another unit, the remark proposes it.

Largest pipes: headrace tunnels have diameters up to some 15 m; smallest: capillaries of a tenth of a millimetre. Waves
run at 5 m/s in arteries and at 1500 m/s in steel pipes, on cables from a hundredth of the speed of light.
"""

import math
import re
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from tline.line.relations import Given
from tline.units import engineering, to_si

GAS, SOUND = 50.0, (100.0, 600.0)  # kg/m^3 and m/s: a gas, and not a liquid in other units
SHORTEST = 0.1  # length over radius
_NUMBER = re.compile(r"[+-]?[0-9.]+(?:e[+-]?[0-9]+)?", re.IGNORECASE)


class Range(NamedTuple):
    """Existing range, usual range and typical value, in SI, and other common units."""

    least: float
    most: float
    usual_least: float
    usual_most: float
    typical: float
    units: tuple[str, ...]


LENGTHS = ("cm", "mm", "um")
PIPES: Mapping[str, Range] = {
    "radius": Range(5e-5, 8, 1e-4, 2, 0.1, LENGTHS),
    "diameter": Range(1e-4, 16, 2e-4, 4, 0.2, LENGTHS),
    "area": Range(5e-9, 200, 2e-8, 12, 0.03, ("cm^2", "mm^2")),
    "wave_speed": Range(1, 3000, 10, 2500, 1200, ("km/s", "cm/s", "mm/s")),
    "density": Range(0.05, 25_000, 300, 25_000, 1000, ("kg/L", "g/m^3")),
    "bulk_modulus": Range(1e3, 1e12, 1e5, 1e12, 2e9, ("GPa", "bar", "MPa")),
    "effective_bulk_modulus": Range(1e3, 1e12, 1e5, 1e12, 2e9, ("GPa", "bar", "MPa")),
    "z0": Range(1e3, 1e15, 1e4, 1e14, 5e7, ("bar/(m^3/s)", "MPa s/m^3")),
    "length": Range(1e-4, 1e7, 1e-3, 1e7, 100, LENGTHS),
    "wall_thickness": Range(1e-5, 3, 1e-4, 0.5, 0.005, ("mm", "cm")),
    "youngs_modulus": Range(1e4, 2e12, 1e6, 2e12, 1e11, ("GPa", "MPa")),
}
CABLES: Mapping[str, Range] = {
    "inductance": Range(1e-10, 1e-3, 1e-9, 1e-4, 2.5e-7, ("nH/m", "uH/m", "mH/km", "pH/m")),
    "capacitance": Range(1e-13, 1e-6, 1e-12, 1e-7, 1e-10, ("pF/m", "nF/m", "nF/km")),
    "z0": Range(0.05, 5000, 0.1, 3000, 50, ("kohm",)),
    "wave_speed": Range(1e6, 3.1e8, 3e6, 3.1e8, 2e8, ("m/us", "cm/ns", "m/ns", "km/s")),
    "velocity_factor": Range(3e-3, 1.01, 0.01, 1.01, 0.66, ("%",)),
    "length": Range(1e-6, 3e7, 1e-5, 3e7, 10, LENGTHS),
    "inner_diameter": Range(1e-7, 2, 1e-6, 0.3, 1e-3, LENGTHS),
    "outer_diameter": Range(1e-7, 5, 1e-6, 0.5, 5e-3, LENGTHS),
    "wire_diameter": Range(1e-7, 0.3, 1e-6, 0.1, 1e-3, LENGTHS),
    "spacing": Range(1e-7, 100, 1e-6, 50, 0.01, LENGTHS),
    "height": Range(1e-7, 500, 1e-6, 200, 1, LENGTHS),
}


def unusual(ranges: Mapping[str, Range], given: Given) -> Iterator[str]:
    """Remark on implausible quantities as given, before any is derived.

    Examples
    --------
    >>> list(unusual(PIPES, Given({"radius": 10.0}, typed={"radius": 10}, units={"radius": "m"})))
    ['radius: 10 m is outside what is built, 50 µm to 8 m: meant 10 cm?']
    """
    for name, typed in given.typed.items():
        if name in ranges:
            value, known, unit = given.values[name], ranges[name], given.units[name]
            size, what, low, high = f"{value:g} {unit}".rstrip(), "built", known.least, known.most
            bare = not isinstance(typed, str) or _NUMBER.fullmatch(typed.strip()) is not None
            if low <= value <= high and bare and not _gas(name, given.values):
                size, what, low, high = f"{typed}, read as {size},", "usual", known.usual_least, known.usual_most
            if not low <= value <= high:
                bounds = " to ".join(f"{x:g} {unit}" if unit == "m/s" else engineering(x, unit) for x in (low, high))
                yield f"{name}: {size} is outside what is {what}, {bounds}{_meant(typed, known, unit)}"
    yield from _out_of_proportion(given.values)


def _meant(typed: object, known: Range, unit: str) -> str:
    """Suggest the number in the unit that makes it the most usual, as a question."""
    number = _NUMBER.match(str(typed).strip())
    sizes = {other: to_si(f"{number[0]} {other}", unit) for other in known.units} if number else {}
    likely = {other: size for other, size in sizes.items() if known.usual_least <= size <= known.usual_most}
    best = min(likely, key=lambda other: abs(math.log(likely[other] / known.typical)), default=None)
    return f": meant {number[0]} {best}?" if number and best else ""


def _gas(name: str, values: Mapping[str, float]) -> bool:
    slow, fast = SOUND
    return name == "density" and values["density"] < GAS and slow < values.get("wave_speed", math.inf) < fast


def _out_of_proportion(values: Mapping[str, float]) -> Iterator[str]:
    radius = values.get("radius", values.get("diameter", math.nan) / 2)
    if values.get("length", math.inf) < SHORTEST * radius:
        yield f"length: {values['length']:g} m is short beside a radius of {radius:g} m"
    if values.get("wall_thickness", 0.0) > radius:
        thick = f"{values['wall_thickness']:g} m is thick beside a radius of {radius:g} m"
        yield f"wall_thickness: {thick}; the wave speed is that of a thin wall"
