"""The line whose attenuation is nearest to a table, in units of the table's last digits."""

from functools import lru_cache
from math import pi, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.loss import ConstantLoss, DielectricLoss, Law, SkinEffect

BAND = 1e3  # by which the loss tangent stays beyond the frequencies of the table
FINEST = 1e-4  # of a value; a difference that small is none, whatever digits are given
ROUNDS, DONE, MOST_CHANGE = 60, 1e-9, 0.75  # of linear programs, their last gain, and of a parameter in one of them
FARTHEST = 0.5  # of a value; a line that far off is none
Laws = tuple[tuple[Law, ...], Law]


class Sheet(NamedTuple):
    """A table of attenuation, and what is known of the line: hashable, for lines of one kind are fitted once."""

    frequencies: tuple[float, ...]  # Hz
    nepers: tuple[float, ...]  # per metre
    halves: tuple[float, ...]  # of the last digit, Np/m
    z0: float  # ohm
    speed: float  # m/s
    resistance: float  # to steady current, ohm/m; 0 if it is not known

    def attenuation(self, laws: Laws) -> NDArray:
        """Real part of the propagation constant, Np/m; laws hold what is beside L and C of the lossless line."""
        series, shunt = laws
        s = 2j * pi * np.array(self.frequencies)
        Z = sum((law.at(s) - s * law.storage for law in series), s * self.z0 / self.speed)
        Y = shunt.at(s) + s * (1 / (self.z0 * self.speed) - shunt.storage)
        return np.real(np.sqrt(Z * Y))

    def laws(self, p: NDArray) -> Laws:
        """Surface impedance, loss tangent, square of the resistance that becomes skin effect, resistance beside it."""
        surface, tangent, square, beside = (*p.tolist(), 0.0, 0.0)[:4]
        f, whole = self.frequencies, 1 / (self.z0 * self.speed)
        middle, band = sqrt(f[0] * f[-1]), (f[0] / BAND, f[-1] * BAND)
        try:
            share = DielectricLoss(1.0, tangent, middle, band).storage
        except InputError:
            problem = "belong to no line of that z0 and speed: it would lose too much in a wave's length"
            raise InputError(
                "attenuation.points", problem, "frequencies with their unit, and decibels per unit"
            ) from None
        series = (SkinEffect(self.resistance or sqrt(square), surface), ConstantLoss(beside))
        return series[: 2 if beside else 1], DielectricLoss(whole / share, tangent, middle, band)

    def misses(self, p: NDArray) -> NDArray:
        """Differences of a line from the table, in halves of a digit."""
        return (self.attenuation(self.laws(p)) - np.array(self.nepers)) / self._units

    @property
    def _units(self) -> NDArray:
        return np.maximum(self.halves, FINEST * np.array(self.nepers))

    @property
    def start(self) -> NDArray:
        """Parameters of a line of low losses."""
        f, a = np.array(self.frequencies), np.array(self.nepers)
        surface, tangent = np.min(a / np.sqrt(pi * f)) * self.z0, np.min(a / (pi * f)) * self.speed / 2
        return np.array([surface, tangent, surface**2 * f[0], surface * sqrt(f[0]) / 10])


@lru_cache(256)
def fitted(sheet: Sheet) -> Laws:
    """Laws of R and L, and of G and C, with as few parameters as reproduce all digits, or nearest to these.

    R goes with √f and G with f; if that is not enough, R begins at a resistance to steady current, and if that is not
    either, another one is beside it. Their largest difference is the least, by linear programs.
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
    """Parameters, above zero, whose largest miss is the least, nearly."""
    from scipy.optimize import linprog

    for _ in range(ROUNDS):
        missed = sheet.misses(p)
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
