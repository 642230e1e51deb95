"""Cables as they are sold: attenuation at some frequencies, and types known by name."""

from functools import lru_cache
from math import pi, sqrt
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field, model_validator

from tline.errors import InputError
from tline.loss import ConstantLoss, DielectricLoss, Law, SkinEffect
from tline.scene.element import Element
from tline.scene.quantity import Frequency, Quantity, Role
from tline.wording import shown

DECIBEL = 20 / np.log(10)  # in a neper
PER = {"dB/m": 1.0, "dB/100m": 100.0, "dB/km": 1000.0, "dB/ft": 0.3048, "dB/100ft": 30.48}  # m
BAND = 1e3  # by which the loss tangent stays beyond the frequencies of the table
ROUNDS, DONE = 20, 1e-12  # of Newton's method, and its last step

Loss = Annotated[Quantity, Role("attenuation", "", above=0, at_most=1e6)]


def _pair(point: Any) -> Any:
    if not isinstance(point, list | tuple) or len(point) != 2:
        raise InputError("", "not a point", "a pair [frequency, decibels]", shown(point))
    return point


Point = Annotated[tuple[Frequency, Loss], BeforeValidator(_pair)]


class Attenuation(Element):
    """Attenuation at some frequencies, as data sheets have it: R goes with √f, and G with f.

    R and G are those whose attenuation is nearest to the points, relatively, by least squares.

    Examples
    --------
    >>> cable = Attenuation(unit="dB/100m", points=[["10 MHz", 4.6], ["100 MHz", 16.1], ["1 GHz", 61]])
    >>> series, shunt = cable.laws(50.0, 1.98e8, 0.0)
    >>> cable.decibels(series, shunt, 50.0, 1.98e8).round(1).tolist()
    [4.6, 15.9, 61.2]
    """

    unit: str = Field(default="dB/m", description=f"of the decibels: {', '.join(PER)}")
    points: list[Point] = Field(
        min_length=2, max_length=100, description="pairs [frequency, decibels], frequencies in ascending order"
    )

    @model_validator(mode="after")
    def _ascends(self):
        if self.unit not in PER:
            raise InputError("unit", "not known here", ", ".join(PER), shown(self.unit))
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
        return np.array([float(a) for _, a in self.points]) / PER[self.unit] / DECIBEL

    def decibels(self, series: Law, shunt: Law, z0: float, speed: float) -> NDArray:
        """Attenuation of a line with these laws beside z0 and speed, at the frequencies, in the unit of the points."""
        return _attenuation(series, shunt, self.frequencies, z0, speed) * DECIBEL * PER[self.unit]

    def laws(self, z0: float, speed: float, resistance: float) -> tuple[Law, Law]:
        """R and L, and G and C of what the line loses.

        Parameters
        ----------
        z0, speed : float
            Of a front, ohm and m/s.
        resistance : float
            To steady current, ohm/m.

        Raises
        ------
        InputError
            The points are those of no line: they rise more slowly than √f, or faster than f.
        """
        return _fitted(tuple(self.frequencies), tuple(self.nepers), z0, speed, resistance)

    def residual(self, z0: float, speed: float, resistance: float) -> float:
        """Largest relative difference of the line from the points."""
        series, shunt = self.laws(z0, speed, resistance)
        return float(np.abs(_attenuation(series, shunt, self.frequencies, z0, speed) / self.nepers - 1).max())


def _attenuation(series: Law, shunt: Law, f: NDArray, z0: float, speed: float) -> NDArray:
    """Real part of the propagation constant, Np/m; laws hold what is beside L and C of the lossless line."""
    s = 2j * pi * f
    Z = series.at(s) + s * (z0 / speed - series.storage)
    Y = shunt.at(s) + s * (1 / (z0 * speed) - shunt.storage)
    return np.real(np.sqrt(Z * Y))


def _made(surface: float, tangent: float, f: NDArray, cable: tuple[float, float, float]) -> tuple[Law, Law]:
    """Laws by the surface impedance and the loss tangent, either of which may be zero."""
    z0, speed, resistance = cable
    series = SkinEffect(resistance, surface) if surface > 0 else ConstantLoss(resistance)
    if tangent <= 0:
        return series, ConstantLoss(0.0)
    middle, band = sqrt(f[0] * f[-1]), (f[0] / BAND, f[-1] * BAND)
    share = DielectricLoss(1.0, tangent, middle, band).storage
    return series, DielectricLoss(1 / (z0 * speed) / share, tangent, middle, band)


@lru_cache(256)
def _fitted(f: tuple[float, ...], nepers: tuple[float, ...], *cable: float) -> tuple[Law, Law]:
    """Newton's method on surface impedance and loss tangent, begun at low losses."""
    at, wanted = np.array(f), np.array(nepers)
    z0, speed, resistance = cable
    basis = np.stack([np.sqrt(pi * at) / (2 * z0), pi * at / speed], axis=1) / wanted[:, None]
    for free in ([0, 1], [0], [1]):  # both, or one alone where the other would be negative
        found, left = np.zeros(2), np.ones(len(at))
        for _ in range(ROUNDS):
            step = np.linalg.lstsq(basis[:, free], left)[0]
            found[free] += step
            if (found < 0).any():
                break
            series, shunt = _made(float(found[0]), float(found[1]), at, (z0, speed, resistance))
            left = 1 - _attenuation(series, shunt, at, z0, speed) / wanted
            if (np.abs(step) <= DONE * found[free]).all():
                return series, shunt
    raise InputError("points", "belong to no line with that resistance", "attenuation that rises between √f and f")
