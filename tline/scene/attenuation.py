"""Cables by the attenuation of a data sheet, and the line nearest to such a table."""

import re
from functools import lru_cache
from math import pi, sqrt
from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, PrivateAttr, model_validator

from tline.errors import InputError
from tline.loss import ConstantLoss, DielectricLoss, Law, SkinEffect
from tline.scene.element import Element, optional, pair, required
from tline.scene.quantity import Frequency, Quantity, Role
from tline.words.wording import nearest, shown

BAND = 1e3  # factor by which the band of the loss tangent exceeds the table's frequencies at both ends
FINEST = 1e-4  # relative; smaller differences count as none, whatever the number of digits given
ROUNDS, DONE, MOST_CHANGE = 60, 1e-9, 0.75  # of linear programs, their last gain, and of a parameter in one of them
FARTHEST = 0.5  # relative; a line farther from the table is refused
Laws = tuple[tuple[Law, ...], Law]
TIA = "limits of ANSI/TIA-568-C.2 for horizontal cable at 20 degC"


class Sheet(NamedTuple):
    """Table of attenuation and the known quantities of the line; hashable, so that lines of a kind are fitted once."""

    frequencies: tuple[float, ...]  # Hz
    nepers: tuple[float, ...]  # per metre
    halves: tuple[float, ...]  # of the last digit, Np/m
    z0: float  # ohm
    speed: float  # m/s
    resistance: float  # for steady current, ohm/m; 0 if it is not known

    def attenuation(self, laws: Laws) -> NDArray:
        """Real part of the propagation constant, Np/m; the laws exclude L and C of the lossless line."""
        series, shunt = laws
        s = 2j * pi * np.array(self.frequencies)
        Z = sum((law.at(s) - s * law.storage for law in series), s * self.z0 / self.speed)
        Y = shunt.at(s) + s * (1 / (self.z0 * self.speed) - shunt.storage)
        return np.real(np.sqrt(Z * Y))

    def laws(self, p: NDArray) -> Laws:
        """Laws of parameters p: surface resistance, loss tangent, square of R at low frequency, series resistance."""
        surface, tangent, square, beside = (*p.tolist(), 0.0, 0.0)[:4]
        f, whole = self.frequencies, 1 / (self.z0 * self.speed)
        middle, band = sqrt(f[0] * f[-1]), (f[0] / BAND, f[-1] * BAND)
        try:
            shunt = DielectricLoss.before_front(whole, tangent, middle, band)
        except InputError:
            problem = "belong to no line of that z0 and speed: it would lose too much in a wave's length"
            raise InputError(
                "attenuation.points", problem, "frequencies with their unit, and decibels per unit"
            ) from None
        series = (SkinEffect(self.resistance or sqrt(square), surface), ConstantLoss(beside))
        return series[: 2 if beside else 1], shunt

    def misses(self, p: NDArray) -> NDArray:
        """Differences between line and table, in halves of the last digit."""
        return (self.attenuation(self.laws(p)) - np.array(self.nepers)) / self._units

    @property
    def _units(self) -> NDArray:
        return np.maximum(self.halves, FINEST * np.array(self.nepers))

    @property
    def start(self) -> NDArray:
        """Initial parameters: those of a line with low losses."""
        f, a = np.array(self.frequencies), np.array(self.nepers)
        surface, tangent = np.min(a / np.sqrt(pi * f)) * self.z0, np.min(a / (pi * f)) * self.speed / 2
        return np.array([surface, tangent, surface**2 * f[0], surface * sqrt(f[0]) / 10])


@lru_cache(256)
def fitted(sheet: Sheet) -> Laws:
    """Fit the laws of R, L and of G, C with the fewest parameters that reproduce all digits, or else the nearest ones.

    R rises with √f and G with f; if that is not enough, R begins at a resistance to steady current, and if that is not
    either, a constant resistance is added to it. Linear programs minimise the largest difference from the table.
    """
    most = 2 if sheet.resistance else min(4, len(sheet.nepers))
    found = []
    for count in range(2, most + 1):
        p = _nearest(sheet, sheet.start[:count])
        found.append((float(np.abs(sheet.misses(p)).max()), p))
        if found[-1][0] <= 1:
            break
    laws = sheet.laws(min(found, key=lambda each: each[0])[1])
    if (np.abs(sheet.attenuation(laws) / np.array(sheet.nepers) - 1) > FARTHEST).any():
        raise InputError(
            "attenuation.points", "belong to no line with that resistance", "attenuation that rises between √f and f"
        )
    return laws


def _nearest(sheet: Sheet, p: NDArray) -> NDArray:
    """Minimise the largest difference from the table, approximately, over parameters above zero."""
    from scipy.optimize import linprog

    for _ in range(ROUNDS):
        missed: NDArray = sheet.misses(p)
        size = float(np.abs(missed).max())
        if size < DONE:
            break
        slopes = np.stack([(sheet.misses(p * (1 + 1e-6 * own)) - missed) / 1e-6 for own in np.eye(len(p))], axis=1)
        reach = size / np.abs(slopes).max(axis=0, initial=size)  # relative changes that make up for the largest miss
        rows = np.hstack([slopes * reach / size, -np.ones((len(missed), 1))])
        signed = np.vstack([rows, np.hstack([-rows[:, :-1], rows[:, -1:]])])
        bounds = [(-MOST_CHANGE / each, 1 / each) for each in reach]
        cost = [*np.zeros(len(p)), 1.0]
        step = linprog(cost, signed, np.concatenate([-missed, missed]) / size, bounds=[*bounds, (0, None)]).x
        new = p * (1 + step[:-1] * reach)
        gain = size - float(np.abs(sheet.misses(new)).max())
        p = new if gain > 0 else p
        if gain < DONE * size:
            break
    return p


DECIBEL = 20 / np.log(10)  # per neper
UNITS = "dB/m, dB/100m, dB/km, dB/ft, dB/100ft, dB/kft or dB/mi"
PER = re.compile(r"dB\s*/\s*(\d{0,4})\s*(m|km|ft|kft|mi)", re.IGNORECASE)
METRES = {"m": 1.0, "km": 1000.0, "ft": 0.3048, "kft": 304.8, "mi": 1609.344}
Loss = Annotated[Quantity, Role("attenuation", "", above=0, at_most=1e6)]


def _in_decibels(point: Any) -> Any:
    if isinstance(point[1], str) and "dB" in point[1]:
        number, _, rest = point[1].partition("dB")
        if rest.strip():
            raise InputError("", "not decibels alone", "what they are per in unit, beside points", shown(point[1]))
        return [point[0], number.strip()]
    return point


Point = Annotated[tuple[Frequency, Loss], BeforeValidator(_in_decibels), pair("frequency, decibels")]


class Attenuation(Element):
    """Attenuation at some frequencies, as on a data sheet: R rises with √f, and G with f.

    A third and a fourth parameter, resistances to steady current, are added if needed to reproduce all digits.

    Examples
    --------
    >>> cable = Attenuation(unit="dB/100m", points=[["10 MHz", 4.6], ["100 MHz", 15.9], ["1 GHz", 61]])
    >>> cable.decibels(50.0, 1.98e8).round(1).tolist()
    [4.6, 15.9, 61.3]
    """

    unit: str = optional(f"of the decibels: {UNITS}", "dB/m")
    points: list[Point] = required(
        "pairs [frequency, decibels], frequencies in ascending order", min_length=2, max_length=100
    )

    _metres: float = PrivateAttr()

    @model_validator(mode="after")
    def _ascends(self):
        found = PER.fullmatch(self.unit.strip())
        if not found or found[1].strip("0") == "" != found[1]:
            raise InputError("unit", "not known here", UNITS, shown(self.unit))
        self._metres = int(found[1] or 1) * METRES[found[2].lower()]
        for k, ((f, _), (g, _)) in enumerate(zip(self.points, self.points[1:], strict=False), 1):
            if g <= f:
                raise InputError(f"points[{k}]", "frequencies do not ascend", f"more than {f:g} Hz", f"{g:g} Hz")
        return self

    @property
    def frequencies(self) -> NDArray:
        """Frequencies, Hz."""
        return np.array([float(f) for f, _ in self.points])

    @property
    def nepers(self) -> NDArray:
        """Attenuation at the frequencies, Np/m."""
        return np.array([float(a) for _, a in self.points]) / self._metres / DECIBEL

    def decibels(self, z0: float, speed: float, resistance: float = 0.0) -> NDArray:
        """Attenuation of the line at the frequencies, in the unit of the points; arguments as in `laws`."""
        sheet = self._sheet(z0, speed, resistance)
        return sheet.attenuation(fitted(sheet)) * DECIBEL * self._metres

    def laws(self, z0: float, speed: float, resistance: float = 0.0) -> Laws:
        """Loss laws of the line: of R and L, and of G and C."""
        return fitted(self._sheet(z0, speed, resistance))

    def residual(self, z0: float, speed: float, resistance: float = 0.0) -> float:
        """Largest relative difference between the line and the points."""
        return float(np.abs(self.decibels(z0, speed, resistance) / [float(a) for _, a in self.points] - 1).max())

    def _sheet(self, *line: float) -> Sheet:
        halves = [10.0 ** -_decimals(a.typed) / 2 / self._metres / DECIBEL for _, a in self.points]
        return Sheet(tuple(self.frequencies.tolist()), tuple(self.nepers.tolist()), tuple(halves), *line)


def _decimals(typed: float | str) -> int:
    """Number of digits after the decimal point, as typed."""
    digits, _, power = str(typed).lower().strip().partition("e")
    power = int(power) if power.lstrip("+-").isdigit() else 0
    return len(digits.partition(".")[2]) - power


class CableType(NamedTuple):
    """Cable as described by its data sheet or standard."""

    z0: str  # characteristic impedance
    velocity_factor: str  # of a front
    unit: str  # of the attenuation
    points: tuple[tuple[str, float], ...]  # frequencies with their attenuation
    source: str  # of these numbers
    resistance: float = 0.0  # to steady current, of both conductors together, ohm/m; 0 where none is published


TYPES = {
    "RG-58": CableType(
        "50 ohm", "66 %", "dB/100ft",
        (("1 MHz", 0.44), ("10 MHz", 1.4), ("50 MHz", 3.3), ("100 MHz", 4.9), ("200 MHz", 7.4)),
        "RG-58C/U in the usual table of RG/U cables",
    ),
    "RG-213": CableType(
        "50 ohm", "66 %", "dB/100ft",
        (("1 MHz", 0.17), ("10 MHz", 0.55), ("50 MHz", 1.3), ("100 MHz", 1.9), ("200 MHz", 2.7)),
        "RG-213/U in the usual table of RG/U cables, as Belden 8267",
    ),
    "LMR-400": CableType(
        "50 ohm", "85 %", "dB/100ft",
        (("30 MHz", 0.68), ("50 MHz", 0.88), ("150 MHz", 1.54), ("450 MHz", 2.71), ("900 MHz", 3.9)),
        "Times Microwave: 0.12229 sqrt(f/MHz) + 0.00026 f/MHz; 1.39 and 1.65 ohm/1000ft",
        resistance=(1.39 + 1.65) / 304.8,
    ),
    "Cat 5e": CableType(
        "100 ohm", "62.46 %", "dB/100m",
        (("1 MHz", 2.04), ("4 MHz", 4.05), ("10 MHz", 6.47), ("16 MHz", 8.25), ("31.25 MHz", 11.72),
         ("62.5 MHz", 16.99), ("100 MHz", 21.98)),
        f"{TIA}: 1.967 sqrt(f/MHz) + 0.023 f/MHz + 0.05/sqrt(f/MHz), 534 ns per 100 m",
    ),
    "Cat 6": CableType(
        "100 ohm", "62.46 %", "dB/100m",
        (("4 MHz", 3.78), ("10 MHz", 5.95), ("16 MHz", 7.55), ("31.25 MHz", 10.67), ("62.5 MHz", 15.38),
         ("100 MHz", 19.8), ("200 MHz", 28.98), ("250 MHz", 32.85)),
        f"{TIA}: 1.808 sqrt(f/MHz) + 0.017 f/MHz + 0.2/sqrt(f/MHz), 534 ns per 100 m",
    ),
}  # fmt: skip


def cable_type(name: str) -> CableType:
    """Look up a cable by its name."""
    if name not in TYPES:
        raise InputError("cable", "not known here", nearest(name, list(TYPES)), shown(name))
    return TYPES[name]
