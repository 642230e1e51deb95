"""Fronts of waveforms in families: those that lie at one place of their slabs.

A waveform is what it is before t = 0 and, from each of its fronts on, what changes there. So it is a sum of waveforms
with a family of fronts each; and on a clock that began earlier these lie on the edges of slabs.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.excitation import EDGE, Waveform, just_before

MOST = 128  # families that are worth a run each
NEAR = EDGE / 2  # slabs; fronts whose places are nearer than this are of one family
ROUNDING = 1e-14  # of a waveform; by so little it neither jumps nor bends
SEEN = np.array([[0.0], [0.1382], [0.4142], [0.7321], [1.0]])  # of a piece: where it is compared with what was before


class Changes(NamedTuple):
    """A waveform by its fronts.

    Attributes
    ----------
    before : float
        Value before t = 0.
    at : ndarray, shape (fronts,)
        Instants, s.
    jump, bend : ndarray, shape (fronts,)
        Changes of value and slope, where the waveform is straight.
    curved : bool
    """

    waveform: Waveform
    before: float
    at: NDArray
    jump: NDArray
    bend: NDArray
    curved: bool

    def part(self, chosen: NDArray, ahead: float, first: bool) -> Waveform:
        """The part due to chosen fronts, of one that is curved all; on a clock so far ahead of the scene's, s.

        Only the first part has the value before t = 0, others begin at zero.
        """
        at, before = self.at[chosen], self.before if first else 0.0
        if self.curved:
            late = Late(self.waveform, at + ahead, ahead, self.before, self.before - before)
            return late if len(at) else Straight.constant(before)
        slope = np.cumsum(self.bend[chosen])
        level = before + np.cumsum(self.jump[chosen])
        level[1:] += np.cumsum(slope[:-1] * np.diff(at))
        return Straight(at + ahead, np.append(before, level), np.append(0.0, slope))


def changes_of(waveform: Waveform, steady: bool, t_end: float) -> Changes:
    """The fronts of a waveform from t = 0 to the end of a run.

    Parameters
    ----------
    waveform : Waveform
    steady : bool
        Whether it has the value before t = 0 that it has immediately before; else it is zero till then.
    t_end : float
        End of the run, s.
    """
    before = just_before(waveform) if steady else 0.0
    breaks = waveform.breaks(t_end)
    knots = np.unique(np.concatenate([[0.0], breaks[(breaks > 0) & (breaks < t_end)], [t_end]]))
    width = np.diff(knots)
    pieces = waveform.value(knots[:-1] + width * SEEN, (knots[:-1] + knots[1:]) / 2)  # (places, pieces)
    slope = (pieces[-1] - pieces[0]) / width
    jump, bend = pieces[0] - np.append(before, pieces[-1, :-1]), np.diff(slope, prepend=0.0)
    least = ROUNDING * max(float(np.abs(pieces).max()), abs(before))
    jump[np.abs(jump) <= least] = 0.0
    curved = bool(np.isfinite(waveform.fastest()))
    real = (np.abs(jump) > least) | (np.abs(bend) * width > least) | curved
    real[0] &= bool((np.abs(pieces[:, 0] - before) > least).any())
    return Changes(waveform, before, knots[:-1][real], jump[real], bend[real], curved)


def leads(instants: NDArray) -> NDArray:
    """By how many slabs slabs have to begin earlier for some instant each, in slabs, to be at the edge of one."""
    found: list[float] = []
    for ahead in np.unique(-instants % 1.0).tolist():
        if not found or ahead - found[-1] > NEAR:
            found.append(ahead)
    if found and found[-1] > 1.0 - NEAR:
        found[-1] -= 1.0
    return np.unique([ahead if ahead > NEAR else 0.0 for ahead in found])


def family_of(instants: NDArray, ahead: NDArray) -> NDArray:
    """Of each instant, in slabs, the number of the lead that puts it at an edge."""
    apart = np.abs(-instants[:, None] % 1.0 - ahead)
    return np.minimum(apart, 1.0 - apart).argmin(axis=1)


class Straight(NamedTuple):
    """Straight pieces between fronts."""

    at: NDArray  # (fronts,) s
    level: NDArray  # (fronts + 1,) before the first front, and behind each
    slope: NDArray  # (fronts + 1,) 1/s

    @classmethod
    def constant(cls, level: float) -> "Straight":
        """Without a front."""
        return cls(np.empty(0), np.array([level]), np.zeros(1))

    def breaks(self, t_end: float) -> NDArray:
        """Instants of the fronts, s."""
        return self.at[self.at < t_end]

    def value(self, t: NDArray, inside: NDArray) -> NDArray:
        """Value at t of the piece that contains `inside`, continued."""
        piece = np.searchsorted(self.at, inside)
        return self.level[piece] + self.slope[piece] * (t - np.append(0.0, self.at)[piece])

    def fastest(self) -> float:
        """No time scale."""
        return np.inf


class Late(NamedTuple):
    """A waveform on a clock that is ahead of the scene's, less a constant."""

    waveform: Waveform
    at: NDArray  # (fronts,) s
    ahead: float  # s
    before: float  # value before t = 0
    less: float

    def breaks(self, t_end: float) -> NDArray:
        """Instants of the fronts, s."""
        return self.at[self.at < t_end]

    def value(self, t: NDArray, inside: NDArray) -> NDArray:
        """Value at t of the smooth piece that contains `inside`, continued."""
        seen = self.waveform.value(t - self.ahead, inside - self.ahead)
        return np.where(inside < self.ahead, self.before, seen) - self.less

    def fastest(self) -> float:
        """Shortest time scale, s."""
        return self.waveform.fastest()
