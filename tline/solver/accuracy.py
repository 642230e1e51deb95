"""How accurate a run is: what runs of rising order, or on narrower slabs, leave of their differences."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import inf

import numpy as np

from tline.solver.result import Result

ROUNDING = 2e-15  # relative to the amplitude; no estimate is smaller
PLACES = np.array([0.01, 0.25, 0.5, 0.75])  # in a slab
LOOKED_INTO = 2000  # slabs
SILENT = 1e-9  # of the larger of u and z0·y; an amplitude below it is not weighed


@dataclass(frozen=True)
class Estimate:
    """Estimated largest errors at one probe, at slab ends, each relative to its own amplitude.

    Parameters
    ----------
    u, y : float
        Of the effort and the flow; 0 where there is none. Relative to the amplitude of the gauge pressure, if efforts
        are pressures.
    """

    u: float
    y: float

    @property
    def worst(self) -> float:
        """The larger of the two."""
        return max(self.u, self.y)


@dataclass(frozen=True)
class Attempt:
    """One run on the way to a tolerance.

    Parameters
    ----------
    order : int
    slab : float
        Width of a slab, s.
    estimate : float or None
        The worst of all probes; None where there is nothing to compare with yet.
    samples : int
        Line-end samples computed.
    seconds : float
        Time spent stepping.
    cells : int
        Cells of L and C of each lumped line; 0 if no line was lumped.
    """

    order: int
    slab: float
    estimate: float | None
    samples: int
    seconds: float
    cells: int = 0

    @classmethod
    def of(cls, result: Result, estimate: float | None = None) -> "Attempt":
        """The run that gave a result."""
        s, h, cells = result.resolution.s, result.resolution.h, max(result.resolution.cells.values(), default=0)
        return cls(s, h, estimate, result.samples, result.seconds, cells)


@dataclass(frozen=True)
class Accuracy:
    """How accurate a result is, and what that took.

    Parameters
    ----------
    tol : float or None
        What was asked; None for a run fixed by hand.
    estimates : dict of str to Estimate
        By probe.
    attempts : tuple of Attempt
        All runs; that of the result is the one before the finest that it was compared with.
    inside : dict of str to float
        Between slab ends the order is lower and fronts may pass: largest difference there to the next finer run,
        relative to the amplitude of u, by probe.
    limit : str
        What kept the tolerance from being met; empty if nothing did.
    """

    tol: float | None
    estimates: Mapping[str, Estimate]
    attempts: tuple[Attempt, ...]
    inside: Mapping[str, float] = field(default_factory=dict)
    limit: str = ""

    @property
    def worst(self) -> float:
        """The largest estimate; infinite if there is none."""
        return max((estimate.worst for estimate in self.estimates.values()), default=inf)

    @property
    def met(self) -> bool:
        """Whether the tolerance is met, as far as can be told."""
        return self.tol is None or (self.worst <= self.tol and not self.limit)


def apart(coarse: Result, fine: Result) -> dict[str, Estimate]:
    """Errors of a run by its largest differences, at common slab ends, to a finer one."""
    every = round(coarse.resolution.h / fine.resolution.h)
    found = {}
    for name, probe in fine.probes.items():
        ours, theirs = (np.stack([p.gauge_pressure, p.record.z0 * p.y]) for p in (probe, coarse.probes[name]))
        ours = ours[:, ::every]
        n = min(ours.shape[1], theirs.shape[1])
        amplitude = np.abs(ours).max(axis=1)
        difference = np.abs(ours[:, :n] - theirs[:, :n]).max(axis=1)
        heard = amplitude > SILENT * amplitude.max()
        relative = np.where(heard, difference / np.where(heard, amplitude, 1.0), 0.0)
        found[name] = Estimate(*(max(float(e), ROUNDING) if e > 0 else 0.0 for e in relative))
    return found


def apart_inside(coarse: Result, fine: Result) -> dict[str, float]:
    """Largest difference of u at some places inside the fine slabs, by probe, relative to its amplitude."""
    slabs = fine.t[:-1]
    slabs = slabs[:: len(slabs) // LOOKED_INTO + 1]
    t = (slabs[:, None] + fine.resolution.h * PLACES).ravel()
    t = t[t < min(coarse.t[-1], fine.t[-1])]
    found = {}
    for name, probe in fine.probes.items():
        u = probe.at(t).u
        amplitude = float(np.abs(probe.gauge_pressure).max()) or 1.0
        found[name] = float(np.abs(u - coarse.probes[name].at(t).u).max()) / amplitude
    return found


def added(one: Mapping[str, Estimate], other: Mapping[str, Estimate]) -> dict[str, Estimate]:
    """Sums by probe."""
    return {name: Estimate(e.u + other[name].u, e.y + other[name].y) for name, e in one.items()}
