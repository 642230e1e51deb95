"""Cables as they are sold: attenuation at some frequencies, and types known by name."""

import re
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field, PrivateAttr, model_validator

from tline.errors import InputError
from tline.scene.attenuation_fit import Laws, Sheet, fitted
from tline.scene.element import Element
from tline.scene.quantity import Frequency, Quantity, Role
from tline.words.wording import shown

DECIBEL = 20 / np.log(10)  # in a neper
UNITS = "dB/m, dB/100m, dB/km, dB/ft, dB/100ft, dB/kft or dB/mi"
PER = re.compile(r"dB\s*/\s*(\d{0,4})\s*(m|km|ft|kft|mi)", re.IGNORECASE)
METRES = {"m": 1.0, "km": 1000.0, "ft": 0.3048, "kft": 304.8, "mi": 1609.344}
Loss = Annotated[Quantity, Role("attenuation", "", above=0, at_most=1e6)]


def _pair(point: Any) -> Any:
    if not isinstance(point, list | tuple) or len(point) != 2:
        raise InputError("", "not a point", "a pair [frequency, decibels]", shown(point))
    if isinstance(point[1], str) and "dB" in point[1]:
        number, _, rest = point[1].partition("dB")
        if rest.strip():
            raise InputError("", "not decibels alone", "what they are per in unit, beside points", shown(point[1]))
        return [point[0], number.strip()]
    return point


Point = Annotated[tuple[Frequency, Loss], BeforeValidator(_pair)]


class Attenuation(Element):
    """Attenuation at some frequencies, as data sheets have it: R goes with √f, and G with f.

    A third and a fourth parameter, resistances to steady current, are there if all digits cannot be reproduced without.

    Examples
    --------
    >>> cable = Attenuation(unit="dB/100m", points=[["10 MHz", 4.6], ["100 MHz", 15.9], ["1 GHz", 61]])
    >>> cable.decibels(50.0, 1.98e8).round(1).tolist()
    [4.6, 15.9, 61.3]
    """

    unit: str = Field(default="dB/m", description=f"of the decibels: {UNITS}")
    points: list[Point] = Field(
        min_length=2, max_length=100, description="pairs [frequency, decibels], frequencies in ascending order"
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
        """In Hz."""
        return np.array([float(f) for f, _ in self.points])

    @property
    def nepers(self) -> NDArray:
        """Attenuation at the frequencies, Np/m."""
        return np.array([float(a) for _, a in self.points]) / self._metres / DECIBEL

    def decibels(self, z0: float, speed: float, resistance: float = 0.0) -> NDArray:
        """Attenuation of the line, at the frequencies, in the unit of the points; arguments as of `laws`."""
        sheet = self._sheet(z0, speed, resistance)
        return sheet.attenuation(fitted(sheet)) * DECIBEL * self._metres

    def laws(self, z0: float, speed: float, resistance: float = 0.0) -> Laws:
        """R and L, and G and C of what the line loses.

        Parameters
        ----------
        z0, speed : float
            Of a front, ohm and m/s.
        resistance : float
            To steady current, ohm/m; found from the points, if they tell it, where it is 0.

        Returns
        -------
        tuple of Law, Law
            In series, which add up, and across.
        """
        return fitted(self._sheet(z0, speed, resistance))

    def residual(self, z0: float, speed: float, resistance: float = 0.0) -> float:
        """Largest relative difference of the line from the points."""
        return float(np.abs(self.decibels(z0, speed, resistance) / [float(a) for _, a in self.points] - 1).max())

    def _sheet(self, *line: float) -> Sheet:
        halves = [10.0 ** -_decimals(a.typed) / 2 / self._metres / DECIBEL for _, a in self.points]
        return Sheet(tuple(self.frequencies.tolist()), tuple(self.nepers.tolist()), tuple(halves), *line)


def _decimals(typed: float | str) -> int:
    """Digits behind the point of a number as it was typed."""
    digits, _, power = str(typed).lower().strip().partition("e")
    power = int(power) if power.lstrip("+-").isdigit() else 0
    return len(digits.partition(".")[2]) - power
