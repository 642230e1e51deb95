"""Effort lost per metre of a line as a function of the flow: odd, increasing laws for any kind of line.

A law is independent of the method that computes its line. Its parameters are numbers, or arrays for several laws.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from math import log
from typing import Self

import numpy as np
from numpy.typing import NDArray

LAMINAR = 2040.0  # Reynolds number up to which flow counts as laminar, as in fluids.friction
FASTEST = 1e9  # Reynolds number beyond which the friction factor is constant
SLOWEST = 1e-200
PER_OCTAVE = 64
STOKES, DUNLOP = 2000.0, 4000.0  # Reynolds numbers between which the flow counts as transitional in EPANET


@dataclass(frozen=True)
class FlowLaw(ABC):
    """Drop of effort per metre."""

    strength: float  # of the law itself
    square: float  # K, Pa s²/m⁷: K |y| y is added, as local losses spread over the length are

    @abstractmethod
    def _own(self, flow: NDArray) -> tuple[NDArray, NDArray]:
        """Drop of the law itself, and its slope."""

    def __call__(self, flow: NDArray) -> tuple[NDArray, NDArray]:
        """Drop and its slope at flows from 0 on."""
        drop, slope = self._own(flow)
        return drop + self.square * flow**2, slope + 2 * self.square * flow

    def scaled(self, by: float) -> Self:
        """Return the law multiplied by a factor."""
        return replace(self, strength=self.strength * by, square=self.square * by)


@dataclass(frozen=True)
class PowerLaw(FlowLaw):
    """Power law strength · |y|^(exponent - 1) · y, with an exponent above 1."""

    exponent: float

    def _own(self, flow: NDArray) -> tuple[NDArray, NDArray]:
        each = self.strength * flow ** (self.exponent - 1)
        return each * flow, self.exponent * each


def quadratic(strength: float) -> PowerLaw:
    """Create the law strength · |y| · y."""
    return PowerLaw(strength, 0.0, 2.0)


@dataclass(frozen=True)
class RoughPipe(FlowLaw):
    """Law strength · f(Re) · |y| · y, with Darcy's friction factor f of a rough pipe."""

    reynolds: float  # Reynolds number of a flow of 1 m³/s
    roughness: float  # relative to the diameter

    @classmethod
    @abstractmethod
    def factor(cls, roughness: NDArray, reynolds: NDArray) -> tuple[NDArray, NDArray]:
        """Friction factor f and d ln f/d ln Re, for Re above 0."""

    def _own(self, flow: NDArray) -> tuple[NDArray, NDArray]:
        factor, exponent = self.factor(np.asarray(self.roughness), np.maximum(self.reynolds * flow, SLOWEST))
        each = self.strength * factor * flow
        return each * flow, (2 + exponent) * each


class Tabulated(RoughPipe):
    """Hagen and Poiseuille's factor up to Re = 2040, one from a table over ln Re beyond; a subclass tells it."""

    @staticmethod
    @abstractmethod
    def turbulent(roughness: float, reynolds: float) -> float:
        """Friction factor for Re above 2040."""

    @classmethod
    @lru_cache
    def table(cls, roughness: float) -> NDArray:
        """Tabulate ln f over evenly spaced ln Re: the first, their distance, their number, and the values."""
        x = np.linspace(log(LAMINAR), log(FASTEST), int(PER_OCTAVE * log(FASTEST / LAMINAR) / log(2)))
        factors = [cls.turbulent(roughness, float(each) * (1 + 1e-12)) for each in np.exp(x)]
        return np.concatenate([[x[0], x[1] - x[0], len(x)], np.log(factors)])

    @classmethod
    def factor(cls, roughness: NDArray, reynolds: NDArray) -> tuple[NDArray, NDArray]:  # noqa: D102
        value, exponent = np.array(64 / reynolds), np.full(reynolds.shape, -1.0)
        roughness = np.broadcast_to(roughness, reynolds.shape)
        for each in np.unique(roughness):
            here = (roughness == each) & (reynolds > LAMINAR)
            (first, step, _), y = np.split(cls.table(float(each)), [3])
            at = np.clip((np.log(reynolds[here]) - first) / step, 0, len(y) - 1)
            k = np.minimum(at.astype(int), len(y) - 2)
            rise = y[k + 1] - y[k]
            value[here] = np.exp(y[k] + (at - k) * rise)
            exponent[here] = np.where(at < len(y) - 1, rise / step, 0.0)
        return value, exponent


class Colebrook(Tabulated):
    """Colebrook's factor beyond Re = 2040.

    References
    ----------
    D. Clamond, Industrial & Engineering Chemistry Research 48 (2009) 3665-3671, doi:10.1021/ie801626g: Colebrook's
    equation, which `fluids.friction.friction_factor` solves.
    """

    @staticmethod
    def turbulent(roughness: float, reynolds: float) -> float:  # noqa: D102
        from fluids.friction import friction_factor

        return friction_factor(Re=reynolds, eD=roughness)


class SwameeJain(RoughPipe):
    """Hagen and Poiseuille's factor up to Re = 2000, Swamee and Jain's from 4000 on, Dunlop's cubic between.

    The cubic meets the turbulent law with its slope, as in EPANET's code; the manual prints one term otherwise.

    References
    ----------
    EPANET 2.2 User Manual, section 3.1.
    """

    @classmethod
    def factor(cls, roughness: NDArray, reynolds: NDArray) -> tuple[NDArray, NDArray]:  # noqa: D102
        part = 5.74 / np.maximum(reynolds, DUNLOP) ** 0.9
        y2 = roughness / 3.7 + part
        y3 = -2 * np.log10(y2)
        fa = y3**-2
        r, fb = np.clip(reynolds / STOKES, 1.0, 2.0), fa * (2 - 0.00514215 / (y2 * y3))
        x1, x2, x3 = 7 * fa - fb, 0.128 - 17 * fa + 2.5 * fb, -0.128 + 13 * fa - 2 * fb
        x4 = 0.032 - 3 * fa + 0.5 * fb
        cubic = x1 + r * (x2 + r * (x3 + r * x4))
        ways = [reynolds < STOKES, reynolds <= DUNLOP]
        value = np.select(ways, [64 / reynolds, cubic], fa)
        steep = r * (x2 + r * (2 * x3 + 3 * r * x4)) / cubic
        return value, np.select(ways, [-1.0, steep], -3.6 / log(10) * part / (y2 * y3))


def side_by_side(laws: Sequence[FlowLaw | None], like: NDArray) -> list[tuple[NDArray, FlowLaw]]:
    """Merge laws of each kind into one with arrays of parameters, after the indices at which `like` names them.

    `like` are indices of laws; None is not a law.
    """
    kinds, found = {type(law) for law in laws if law is not None}, []
    for kind in sorted(kinds, key=lambda kind: kind.__name__):
        same = [k for k, law in enumerate(laws) if type(law) is kind]
        number, parameters = np.full(len(laws), -1), np.array([[*vars(laws[k]).values()] for k in same])
        number[same] = np.arange(len(same))
        places = np.flatnonzero(number[like] >= 0)
        found.append((places, kind(*parameters[number[like[places]]].T)))
    return found
