"""Where a model is not passive: the extremes of its worst value beyond the bound, and the exact verdict."""

import math
from functools import lru_cache
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from passivity.budget import UndecidedError
from passivity.exact.positive_real import by_floats, check, refuted_or_undecided
from passivity.floats.axis import AxisAnalysis, analyse
from passivity.floats.system import FloatSystem
from passivity.polynomial.roots import violations
from passivity.rational.state_space import StateSpace
from passivity.sampled.check import excess, worst_first, worst_values
from passivity.sampled.model import PoleResidueModel
from passivity.sampled.response import Parameter
from passivity.status import Kind, Status
from passivity.verdict import Verdict

FEW_PORTS, MANY_POLES = 4, 40  # ports and poles up to which the exact test takes seconds
NEARLY_INFINITE = 1e6  # times the largest frequency: replaces infinity, its inverse zero
AROUND = np.tan(np.linspace(-1.5, 1.5, 17))  # of the half width of a resonance: frequencies that show it
EVEN = 100  # frequencies at equal ratios
MOST_EXTREMES = 40  # extremes that are followed
SURELY = 1e-9  # beyond the bound, of the size of the model: more than rounding
CLOSER = 3  # rounds, ten times closer each, in which a maximum is located
Place: TypeAlias = tuple[float, float, NDArray, NDArray]  # frequency, how far beyond the bound, vectors u and v


@lru_cache(maxsize=8)
def verdict_of(model: PoleResidueModel) -> Verdict:
    """Exact: of the function, of the matrix up to FEW_PORTS ports and MANY_POLES poles, else of a state space."""
    if (found := _decided(model)) is not None:
        return found
    return refuted_or_undecided(Kind.BR, _state_space(model), "no storage function was found")


@lru_cache(maxsize=8)
def _decided(model: PoleResidueModel) -> Verdict | None:
    """The verdict; on S of many poles by a storage function, or at a point that floats suggest: None without either."""
    if model.ports == 1 or np.any(model.proportional) or (model.ports <= FEW_PORTS and model.order <= MANY_POLES):
        return check(model.rational(), model.parameter.kind)
    system, kind = _state_space(model), model.parameter.kind
    return by_floats(kind, system) if kind is Kind.BR else check(system, kind)


def _state_space(model: PoleResidueModel) -> StateSpace:
    return StateSpace.from_entries(*(x.tolist() for x in model.realised()))


def is_proved(model: PoleResidueModel) -> bool:
    """Whether a model is proved passive, without looking for the reason if S of many poles is not."""
    return (found := _decided(model)) is not None and found.proved


def is_passive(model: PoleResidueModel, w: NDArray) -> bool:
    """Whether a model is proved passive, which takes long for many poles where a grid does not show that it is not."""
    unit = 1.0 if model.parameter is Parameter.S else float(np.abs(model.at(w)).max())
    beyond = (x for _, x, _, _ in extremes_on_grid(model, w, np.zeros(0)))
    return max(beyond, default=0.0) <= SURELY * unit and is_proved(model)


def seen(model: PoleResidueModel) -> AxisAnalysis:
    """The worst value over all frequencies, and bands where it is beyond the bound, in floating point."""
    A, B, C, D = model.realised()
    if not len(A):  # a state that does nothing
        A, B, C = -np.eye(1), np.zeros((1, len(D))), np.zeros((len(D), 1))
    return analyse(FloatSystem.of(model.parameter.kind, StateSpace.from_entries(*(x.tolist() for x in (A, B, C, D)))))


def places_of(model: PoleResidueModel, w: NDArray) -> list[Place]:
    """Return the worst value at each frequency, and all others beyond the bound."""
    beyond, left, right = worst_first(model.matrices(w), model.parameter)
    chosen = [(i, j) for i, j in np.ndindex(beyond.shape) if j == 0 or beyond[i, j] > 0]
    return [(float(w[i]), float(beyond[i, j]), left[i, :, j], right[i, :, j]) for i, j in chosen]


def bands_of(model: PoleResidueModel) -> tuple[list[tuple[float, float]], float]:
    """Bands beyond the bound, rad/s, and by how much: exact of one port, infinite if at all; else in floating point."""
    if model.ports > 1:
        analysis = seen(model)
        return list(analysis.bands), float(excess(np.array(analysis.value), model.parameter)) + analysis.value_error
    verdict = verdict_of(model)
    try:
        bands = violations(verdict.negative) if verdict.status is Status.REFUTED else []
    except UndecidedError:
        bands = []
    return bands, math.inf if bands else -math.inf


def worst_of(model: PoleResidueModel) -> tuple[float, float]:
    """The worst value over all frequencies, exact of one port, and its frequency in Hz."""
    if model.ports == 1:
        margins = verdict_of(model).margins
        margin = margins.reflection if model.parameter is Parameter.S else margins.input
        return (margin.value, margin.frequency / (2 * np.pi)) if margin else (math.nan, math.nan)
    analysis = seen(model)
    return analysis.value, analysis.frequency / (2 * np.pi)


def inside(low: float, high: float) -> list[float]:
    """Frequencies in a band that may begin at zero or go on for ever."""
    if high == math.inf:
        return [2 * low, NEARLY_INFINITE * low] if low else [1.0]
    return [low, math.sqrt(low * high) or high / 2, (low + high) / 2, high]


def extremes_on_grid(model: PoleResidueModel, w: NDArray, also: NDArray) -> list[Place]:
    """Frequencies beyond the bound, wherever the worst value has an extreme."""
    grid = grid_of(model, np.concatenate([w, also]))
    peaks = _peaks(model, grid)
    for _ in range(CLOSER):
        low, high = grid[np.maximum(peaks - 1, 0)], grid[np.minimum(peaks + 1, len(grid) - 1)]
        grid = off_poles(model, low[:, None] + (high - low)[:, None] * np.linspace(0, 1, 12))
        peaks = _peaks(model, grid)
    return [place for place in places_of(model, grid[peaks]) if place[1] > 0]


def grid_of(model: PoleResidueModel, also: NDArray) -> NDArray:
    """Frequencies that show all resonances, and others, in rising order."""
    a = model.poles
    top = max(float(also.max(initial=0.0)), float(np.abs(a).max(initial=0.0))) or 1.0
    around = np.abs(a.imag[:, None] + a.real[:, None] * AROUND).ravel()
    return off_poles(
        model, np.concatenate([[0.0], also, around, np.geomspace(top / NEARLY_INFINITE, top * NEARLY_INFINITE, EVEN)])
    )


def off_poles(model: PoleResidueModel, w: NDArray) -> NDArray:
    """The frequencies in rising order, without those of poles on the axis."""
    return np.setdiff1d(w, model.poles.imag[model.poles.real == 0])


def _peaks(model: PoleResidueModel, grid: NDArray) -> NDArray:
    """Where the worst value is beyond the bound and no better than at the neighbours."""
    beyond = excess(worst_values(model.matrices(grid), model.parameter), model.parameter)
    beyond = np.pad(beyond, 1, constant_values=-math.inf)
    inner = beyond[1:-1]
    peaks = np.flatnonzero((inner > 0) & (inner >= beyond[:-2]) & (inner > beyond[2:]))
    return np.sort(
        peaks[np.argsort(-inner[peaks])[:MOST_EXTREMES]]
    )  # where a value is nearly constant, rounding makes many
