"""Conversion of texts with units to SI: ``"10 cm"`` becomes 0.1.

The parser is our own because full-size unit libraries import numpy and take longer than all of `tline line`.
The tests hold its table against such a library, for every unit with every prefix.

Grammar: a number, then units joined by ``*``, ``·``, ``×``, ``/`` or a space, each with an integer power
(``m^3``, ``m**3``, ``m³``), and parentheses. Products and quotients are read strictly from left to right and
a space multiplies, so ``1 m / s m`` is (m/s)·m; the other one is ``1 m/(s m)``. A number without a unit is
SI. Values stay exact fractions until the end, so the result is the float nearest to the text.

Angles and cycles are plain numbers in SI, so rad/s and Hz have one dimension and yet differ by 2π. A unit therefore
counts its angles and cycles in addition to its dimension; if one is given and the other expected it is converted:
``"1 rad/s"`` is 0.159 Hz, ``"1 Hz"`` is 6.28 rad/s. ``1/s`` is neither and counts as the one expected.
"""

import math
import numbers
import re
from fractions import Fraction
from functools import lru_cache

from tline.errors import InputError

Dimension = tuple[int, ...]  # exponents of kg, m, s, A, K, angle, cycle
Factor = tuple[Fraction, Dimension]
NONE = (0, 0, 0, 0, 0)
ANGLES, CYCLES = {"rad", "deg", "°"}, {"Hz", "rpm"}
TURN = 2 * Fraction(math.pi)
LONGEST, LARGEST_POWER, LARGEST_BITS = 200, 12, 4000  # a text beyond these is no quantity
CELSIUS, FAHRENHEIT = (Fraction(1), Fraction("273.15")), (Fraction(5, 9), Fraction("459.67") * 5 / 9)
# size and zero in kelvin
DEGREES = {"degC": CELSIUS, "°C": CELSIUS, "℃": CELSIUS, "degF": FAHRENHEIT, "°F": FAHRENHEIT, "℉": FAHRENHEIT}
PREFIXES = {"f": -15, "p": -12, "n": -9, "u": -6, "µ": -6, "m": -3, "c": -2, "d": -1}
PREFIXES |= {"k": 3, "M": 6, "G": 9, "T": 12}
POUND, STANDARD_GRAVITY = Fraction("0.45359237"), Fraction("9.80665")

# symbol -> value in SI, dimension
PREFIXABLE: dict[str, Factor] = {
    "m": (Fraction(1), (0, 1, 0, 0, 0)),
    "g": (Fraction(1, 1000), (1, 0, 0, 0, 0)),
    "s": (Fraction(1), (0, 0, 1, 0, 0)),
    "A": (Fraction(1), (0, 0, 0, 1, 0)),
    "K": (Fraction(1), (0, 0, 0, 0, 1)),
    "Hz": (Fraction(1), (0, 0, -1, 0, 0)),
    "rad": (Fraction(1), NONE),
    "N": (Fraction(1), (1, 1, -2, 0, 0)),
    "Nm": (Fraction(1), (1, 2, -2, 0, 0)),  # a torque as everyone writes it
    "Pa": (Fraction(1), (1, -1, -2, 0, 0)),
    "bar": (Fraction(100_000), (1, -1, -2, 0, 0)),
    "J": (Fraction(1), (1, 2, -2, 0, 0)),
    "W": (Fraction(1), (1, 2, -3, 0, 0)),
    "C": (Fraction(1), (0, 0, 1, 1, 0)),
    "V": (Fraction(1), (1, 2, -3, -1, 0)),
    "F": (Fraction(1), (-1, -2, 4, 2, 0)),
    "H": (Fraction(1), (1, 2, -2, -2, 0)),
    "ohm": (Fraction(1), (1, 2, -3, -2, 0)),
    "Ω": (Fraction(1), (1, 2, -3, -2, 0)),
    "S": (Fraction(1), (-1, -2, 3, 2, 0)),
    "L": (Fraction(1, 1000), (0, 3, 0, 0, 0)),
    "l": (Fraction(1, 1000), (0, 3, 0, 0, 0)),
}
PLAIN: dict[str, Factor] = {
    "in": (Fraction("0.0254"), (0, 1, 0, 0, 0)),
    "ft": (Fraction("0.3048"), (0, 1, 0, 0, 0)),
    "mil": (Fraction("0.0000254"), (0, 1, 0, 0, 0)),
    "yd": (Fraction("0.9144"), (0, 1, 0, 0, 0)),
    "mi": (Fraction("1609.344"), (0, 1, 0, 0, 0)),
    "min": (Fraction(60), (0, 0, 1, 0, 0)),
    "h": (Fraction(3600), (0, 0, 1, 0, 0)),
    "d": (Fraction(86_400), (0, 0, 1, 0, 0)),
    "atm": (Fraction(101_325), (1, -1, -2, 0, 0)),
    "hPa": (Fraction(100), (1, -1, -2, 0, 0)),  # the prefix h alone would make hbar, which is another thing
    "psi": (POUND * STANDARD_GRAVITY / Fraction("0.0254") ** 2, (1, -1, -2, 0, 0)),
    "mH2O": (Fraction("9806.65"), (1, -1, -2, 0, 0)),
    "gal": (231 * Fraction("0.0254") ** 3, (0, 3, 0, 0, 0)),
    "lb": (POUND, (1, 0, 0, 0, 0)),
    "lbf": (POUND * STANDARD_GRAVITY, (1, 1, -2, 0, 0)),
    "fps": (Fraction("0.3048"), (0, 1, -1, 0, 0)),
    "mph": (Fraction("0.44704"), (0, 1, -1, 0, 0)),
    "hp": (550 * Fraction("0.3048") * POUND * STANDARD_GRAVITY, (1, 2, -3, 0, 0)),
    "rpm": (Fraction(1, 60), (0, 0, -1, 0, 0)),
    "cP": (Fraction(1, 1000), (1, -1, -1, 0, 0)),
    "cSt": (Fraction(1, 1_000_000), (0, 2, -1, 0, 0)),
    "deg": (Fraction(math.pi) / 180, NONE),
    "°": (Fraction(math.pi) / 180, NONE),
    "%": (Fraction(1, 100), NONE),
    "1": (Fraction(1), NONE),
}
# other spellings, in any case: flows as EPANET names them, and words, which may have a prefix and a plural
SPELLED = {
    "gpm": "gal/min", "mgd": "1e6 gal/d", "imgd": "4546090 L/d", "afd": "43560 ft^3/d", "cfs": "ft^3/s", "lps": "L/s",
    "lpm": "L/min", "mld": "ML/d", "cms": "m^3/s", "cmh": "m^3/h", "cmd": "m^3/d", "psig": "psi", "psf": "lbf/ft^2",
    "lbm": "lb", "sec": "s", "hr": "h", "foot": "ft", "feet": "ft", "inch": "in", "inche": "in", "yard": "yd",
    "mile": "mi", "gallon": "gal", "pound": "lb", "metre": "m", "meter": "m", "gram": "g", "second": "s",
    "minute": "min", "hour": "h", "day": "d", "litre": "L", "liter": "L", "pascal": "Pa", "bar": "bar", "newton": "N",
    "watt": "W", "joule": "J", "hertz": "Hz", "volt": "V", "amp": "A", "ampere": "A", "farad": "F", "henry": "H",
    "ohm": "ohm", "kelvin": "K", "percent": "%", "degree": "deg", "radian": "rad", "horsepower": "hp",
}  # fmt: skip
PREFIX_WORDS = {"pico": "p", "nano": "n", "micro": "u", "milli": "m", "centi": "c", "deci": "d", "kilo": "k"}
PREFIX_WORDS |= {"mega": "M", "giga": "G"}

_NUMBER = re.compile(r"[+-]?(?:(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:e[+-]?[0-9]+)?|inf\b|nan\b)", re.IGNORECASE)
_GROUP = re.compile(r"\(([^()]*)\)")
_FACTOR = re.compile(
    r"\s*(?P<sign>[*·⋅×/]?)\s*(?P<name>[A-Za-zµΩ°℃#][A-Za-z0-9Ω]*|%|1(?![0-9.]))"
    r"\s*(?:(?:\^|\*\*)\s*(?P<power>[+-]?[0-9]{1,2})(?![0-9.])|(?P<raised>[⁺⁻]?[⁰¹²³⁴-⁹]{1,2}))?\s*"
)
_ALIKE = str.maketrans({"\u2212": "-", "\u2126": "Ω", "\u03bc": "µ"})  # minus, ohm sign, Greek mu
_SUPERSCRIPTS = str.maketrans("⁺⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "+-0123456789")
_TAKES_PREFIX = re.compile(r"(?:m|s|A|V|W|J|N|Pa|Hz|F|H|S|ohm|Ω)(?![A-Za-z0-9^*²³])")
_PRINTED = {-15: "f", -12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T"}


def to_si(value: float | str, unit: str | None, where: str = "", *, allow_infinite: bool = False) -> float:
    """Convert a quantity to SI.

    Parameters
    ----------
    value : float or str
        A number is SI; a text is a number and a unit such as ``"467.9 bar/(m^3/s)"`` (grammar above);
        ``"20 degC"`` is an absolute temperature and becomes kelvin.
    unit : str or None
        The SI unit expected, whose dimension counts; ``""`` for a plain number, None for any dimension.
    where : str
        Place named by the error message.
    allow_infinite : bool
        Let ``inf`` pass.

    Raises
    ------
    InputError
        No number, not finite, an unknown unit, or another dimension than `unit`.

    Examples
    --------
    >>> to_si("10 cm", "m"), to_si("20 degC", "K"), to_si(1500, "m/s"), to_si("90 deg/s", "Hz")
    (0.1, 293.15, 1500.0, 0.25)
    """
    if isinstance(value, str):
        try:
            number = _text_to_si(value, unit)
        except InputError as error:
            raise InputError(where, error.problem, error.expected, error.got) from None
    elif isinstance(value, numbers.Real) and not isinstance(value, bool):
        number = _nearest_float(value)
    else:
        raise InputError(where, "not a number", _expected(unit), _shown(value))
    if math.isnan(number) or (math.isinf(number) and not allow_infinite):
        given = value if isinstance(value, str) else number
        raise InputError(where, "not a finite number", _expected(unit), _shown(given))
    return number


def engineering(value: float, unit: str) -> str:
    """Format an SI value: four digits, in `unit`, with a prefix if `unit` begins with a bare SI unit.

    Examples
    --------
    >>> engineering(11.1e-12, "F/m"), engineering(4.679e7, "bar/(m^3/s)"), engineering(2.205e9, "bar")
    ('11.1 pF/m', '467.9 bar/(m^3/s)', '22050 bar')
    """
    scaled, prefix = value / float(_parse(unit)[0]), ""
    if _TAKES_PREFIX.match(unit) and scaled and math.isfinite(scaled):
        mantissa, _, exponent = f"{scaled:.3e}".partition("e")
        power = min(max(int(exponent) // 3 * 3, -15), 12)
        scaled, prefix = float(f"{mantissa}e{int(exponent) - power}"), _PRINTED[power]
    rounded = float(f"{scaled:.3e}")
    digits = f"{rounded:.10g}" if rounded == 0 or 1e-3 <= abs(rounded) < 1e6 else f"{rounded:.4g}"
    return f"{digits} {prefix}{unit}".rstrip()


def handy(largest: float, unit: str) -> tuple[float, str]:
    """Choose the unit for values up to `largest`: its size in SI and name, `unit` with a prefix where it takes one.

    Times of a second and more stay in seconds, heights in metres.

    Examples
    --------
    >>> handy(0.0042, "A"), handy(7e5, "bar"), handy(3600.0, "s")
    ((0.001, 'mA'), (100000.0, 'bar'), (1.0, 's'))
    """
    if unit == "m" or (unit == "s" and largest >= 1):
        return 1.0, unit
    name = engineering(largest, unit).partition(" ")[2]
    return to_si(f"1 {name}", None), name


def half_digit(text: str) -> float:
    """Half a unit in the last digit typed of a quantity above zero, relative to it.

    Examples
    --------
    >>> half_digit("50 ohm"), half_digit("50.0 ohm"), half_digit("2.5e-1 m")
    (0.01, 0.001, 0.02)
    """
    number = _NUMBER.match(text.strip().translate(_ALIKE))
    mantissa = number[0].lower().partition("e")[0] if number else "0"
    return 0.5 / float(re.sub("[^0-9]", "", mantissa))


def _nearest_float(exact: numbers.Real) -> float:
    try:
        return float(exact)
    except OverflowError:
        return math.inf


@lru_cache(4096)  # networks say the same again and again
def _text_to_si(text: str, unit: str | None) -> float:
    if len(text) > LONGEST:
        raise InputError("", f"a text of {len(text)} characters is no quantity", _expected(unit))
    clean = text.strip().translate(_ALIKE)
    number = _NUMBER.match(clean)
    if not number:
        raise InputError("", "there is no number in front", _expected(unit), _shown(text))
    units = clean[number.end() :].strip()
    degree, zero = DEGREES.get(units, (1, 0))
    try:
        scale, (*dimension, angles, cycles) = _parse("K" if zero else units)
    except UnknownUnit as error:
        raise InputError("", error.problem, _suggestion(error.name, units, unit), error.got) from None
    *wanted, per_angle, per_cycle = _parse(unit or "")[1]
    if units and unit is not None and dimension != wanted:
        raise InputError("", _mistaken(units, unit), _expected(unit), _shown(text))
    rough = float(number[0])
    if not math.isfinite(rough):
        return rough
    exact = Fraction(number[0]) if rough else Fraction(0)
    turns = -angles if per_cycle and not cycles else cycles if per_angle and not angles else 0
    if abs(turns) > LARGEST_POWER:
        raise _too_large(units)
    return _nearest_float(exact * scale * degree * TURN**turns + zero)


@lru_cache(256)
def _parse(text: str) -> Factor:
    """Parse a unit to its value and dimension; parentheses are folded from the innermost outwards."""
    groups: dict[str, Factor] = {}
    folded = text.translate(_ALIKE).replace("#", "?")  # '#0', '#1' ... stand for the groups already folded
    while group := _GROUP.search(folded):
        name = f"#{len(groups)}"
        groups[name] = _product(group[1], groups, text)
        folded = f"{folded[: group.start()]} {name} {folded[group.end() :]}"
    return _product(folded, groups, text)


def _product(text: str, groups: dict[str, Factor], whole: str) -> Factor:
    total, dimension, at = Fraction(1), (*NONE, 0, 0), 0
    while at < len(text):
        factor = _FACTOR.match(text, at)
        if not factor or (at == 0 and factor["sign"] not in ("", "/")):
            expected = "a decimal point" if text[at] == "," else "a unit such as 'Pa s/m^3'"
            raise InputError("", "cannot read the unit", expected, _shown(whole))
        value, exponents = groups.get(factor["name"]) or _unit(factor["name"])
        power = int((factor["power"] or factor["raised"] or "1").translate(_SUPERSCRIPTS))
        bits = value.numerator.bit_length() + value.denominator.bit_length()
        if abs(power) > LARGEST_POWER or bits > LARGEST_BITS:
            raise _too_large(whole)
        power = -power if factor["sign"] == "/" else power
        total *= value**power
        dimension = tuple(d + power * e for d, e in zip(dimension, exponents, strict=True))
        at = factor.end()
    return total, dimension


def _too_large(unit: str) -> InputError:
    return InputError("", "a power in the unit is too large", f"at most {LARGEST_POWER}", _shown(unit))


class UnknownUnit(InputError):
    """Name that is not a unit; the caller, who knows the expected dimension, adds a suggestion."""

    def __init__(self, name: str):
        super().__init__("", f"unknown unit {_shown(name)}", got=_shown(name))
        self.name = name


def _unit(name: str) -> Factor:
    if found := PREFIXABLE.get(name) or PLAIN.get(name):
        return found[0], (*found[1], int(name in ANGLES), int(name in CYCLES))
    if name[0] in PREFIXES and name[1:] in PREFIXABLE:
        value, dimension = _unit(name[1:])
        return value * Fraction(10) ** PREFIXES[name[0]], dimension
    if meant := _spelled_out(name):
        count = _NUMBER.match(meant)
        value, dimension = _parse(meant[count.end() :] if count else meant)
        return value * Fraction(count[0] if count else 1), dimension
    raise UnknownUnit(name)


def _spelled_out(name: str) -> str:
    """Symbol of another spelling, such as a word or "m3" for "m^3"; empty if it is none."""
    letters, lower = name.rstrip("234"), name.lower()
    if len(name) == len(letters) + 1 and letters not in DEGREES:
        return f"{letters}^{name[-1]}"
    lower = lower if lower in SPELLED else lower.removesuffix("s")
    if lower in SPELLED:
        return SPELLED[lower]
    prefix = next((word for word in PREFIX_WORDS if lower.startswith(word)), "")
    symbol = SPELLED.get(lower.removeprefix(prefix), "") if prefix else ""
    return PREFIX_WORDS[prefix] + symbol if symbol in PREFIXABLE else ""


# quantities of units, in messages
KINDS = {
    "m": "a length", "m^2": "an area", "m^3": "a volume", "s": "a time", "Hz": "a frequency",
    "m/s": "a speed", "kg": "a mass", "kg/m^3": "a density", "Pa": "a pressure", "m^3/s": "a volume flow",
    "kg/s": "a mass flow", "Pa s": "a viscosity", "m^2/s": "a kinematic viscosity",
    "Pa s/m^3": "a hydraulic impedance", "N m": "a torque",
    "V": "a voltage", "A": "a current", "ohm": "a resistance", "F": "a capacitance", "H": "an inductance",
    "F/m": "a capacitance per length", "H/m": "an inductance per length", "K": "a temperature",
}  # fmt: skip


def _suggestion(name: str, units: str, wanted: str | None) -> str:
    """Suggest units for an unknown one: kelvin, another case, or the nearest symbols, of the right dimension."""
    from difflib import get_close_matches

    known = [*PREFIXABLE, *PLAIN, *(prefix + unit for unit in PREFIXABLE for prefix in PREFIXES), *SPELLED]
    if name in DEGREES:
        return "'K' inside a product ('degC' and 'degF' are absolute temperatures)"
    near = [unit for unit in known if unit.lower() == name.lower()] or get_close_matches(name, known, n=9)
    fits = [unit for unit in dict.fromkeys(near) if wanted is None or _fits(units.replace(name, unit), wanted)]
    return " or ".join(f"'{unit}'" for unit in fits[:2]) or _expected(wanted)


def _fits(units: str, wanted: str) -> bool:
    """Whether a unit has the dimension wanted."""
    try:
        return _parse(units)[1][:5] == _parse(wanted)[1][:5]
    except InputError:
        return False


def _mistaken(given: str, expected: str) -> str:
    """Explain why a unit has the wrong dimension; for a temperature, that it is a unit with the same letter."""
    letter = {"C": "coulomb", "F": "farad"}.get(given) if expected == "K" else None
    return f"{given} is the {letter}" if letter else "this unit measures something else"


def _expected(unit: str | None) -> str:
    """Describe the form of a quantity of this unit."""
    if unit is None:
        return "a number with a unit"
    dimension = _parse(unit)[1][:5]
    if dimension == NONE:
        return "a plain number such as '0.5'"
    if unit == "K":
        return "a temperature such as '20 degC' or '300 K'"
    kind = next((kind for key, kind in KINDS.items() if _parse(key)[1][:5] == dimension), "a quantity")
    return f"{kind} such as '1 {unit}'"


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:50] + "…"
