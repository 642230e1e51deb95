"""Accuracy of a run, estimated from differences between runs of rising order or on narrower slabs."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import inf
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tline.solver.result.result import Result

SLOWEST = 0.5  # largest ratio of successive differences that counts as convergence
EXACT = 1e-12  # smaller error estimates are rounding


@dataclass(frozen=True)
class Estimate:
    """Estimated largest errors at one probe, each relative to its own amplitude."""

    u: float  # of the effort, of gauge pressure if efforts are pressures; 0 where there is none
    y: float  # of the flow; 0 where there is none

    @property
    def worst(self) -> float:
        """The larger of the two."""
        return max(self.u, self.y)

    def or_more(self, other: "Estimate") -> "Estimate":
        """Return the larger of two estimates for each quantity."""
        return Estimate(max(self.u, other.u), max(self.y, other.y))


@dataclass(frozen=True)
class Attempt:
    """One run on the way to a tolerance."""

    order: int
    slab: float  # width of a slab, s
    # worst estimate of all probes, at any instant, or at slab ends alone where that exceeds the tolerance; None where
    # there is no earlier run to compare with
    estimate: float | None
    samples: int  # line-end samples computed
    seconds: float  # time spent stepping
    sections: int = 0  # LC sections of each lumped line; 0 if no line was lumped

    @classmethod
    def of(cls, result: "Result", estimate: float | None = None) -> "Attempt":
        """The run that gave a result."""
        s, h, sections = result.resolution.s, result.resolution.h, max(result.resolution.sections.values(), default=0)
        return cls(s, h, estimate, result.samples, result.seconds, sections)


@dataclass(frozen=True)
class Accuracy:
    """Error estimates of a result, and the runs that gave them."""

    tol: float | None  # what was asked; None for a run fixed by hand
    estimates: Mapping[str, Estimate] = field(default_factory=dict)  # by probe, at slab ends
    # by probe, at any instant of the run. Laws and fronts may bend waves between slab ends: this is never smaller than
    # at slab ends, and it is what the tolerance is about
    inside: Mapping[str, Estimate] = field(default_factory=dict)
    # the same with the time in which lumped lines settle after a front, and that beside a jump into lines that
    # remember; what they do there is not resolved, and no tolerance is asked of it
    blurred: Mapping[str, Estimate] = field(default_factory=dict)
    # all runs. Of two that are compared the finer is the result; the estimate of the coarser is its bound
    attempts: tuple[Attempt, ...] = ()
    limit: str = ""  # what kept the tolerance from being met; empty if nothing did

    @property
    def worst(self) -> float:
        """The largest estimate at any instant of any probe; infinite if there is none."""
        return max((estimate.worst for estimate in self.inside.values()), default=inf)

    @property
    def at_slab_ends(self) -> float:
        """The largest estimate at slab ends; infinite if there is none."""
        return max((estimate.worst for estimate in self.estimates.values()), default=inf)

    @property
    def behind_fronts(self) -> float:
        """The largest estimate where lumped lines settle, and anywhere else."""
        return max((estimate.worst for estimate in self.blurred.values()), default=0.0)

    def times(self, by: float, at_ends: float = 1.0) -> "Accuracy":
        """Scale the errors inside slabs by a factor, and those at slab ends by another."""
        estimates, inside, blurred = (
            {name: Estimate(factor * told.u, factor * told.y) for name, told in each.items()}
            for each, factor in ((self.estimates, at_ends), (self.inside, by), (self.blurred, by))
        )
        return replace(self, estimates=estimates, inside=inside, blurred=blurred)

    def at_least(self, error: float) -> "Accuracy":
        """Raise smaller errors at any instant to `error`, except those of exact quantities."""

        def raised(e: float) -> float:
            return max(e, error) if e > EXACT else e

        inside, blurred = (
            {name: Estimate(raised(told.u), raised(told.y)) for name, told in each.items()}
            for each in (self.inside, self.blurred)
        )
        return replace(self, inside=inside, blurred=blurred)

    @property
    def met(self) -> bool:
        """Whether the tolerance is met, by the estimates."""
        return self.tol is None or (self.worst <= self.tol and not self.limit)
