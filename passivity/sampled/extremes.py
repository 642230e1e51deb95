"""Where a model is not passive: the extremes of its worst value beyond the bound, and the exact verdict."""

import math
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from passivity.budget import UndecidedError
from passivity.exact.positive_real import by_storage, check
from passivity.exact.verdict import Verdict
from passivity.floats.axis import AxisAnalysis, analyse
from passivity.floats.system import FloatSystem
from passivity.polynomial.bands import violations
from passivity.rational.state_space import StateSpace
from passivity.sampled.check import excess, worst_values
from passivity.sampled.model import MatrixModel, PartialFractions, PoleResidueModel
from passivity.sampled.response import Parameter
from passivity.status import Status

FEW = 4  # ports up to which the exact test takes seconds
POINTS = 60  # in a forbidden band, at equal ratios
BEYOND = 1e6  # times the largest frequency: stands for infinity, its inverse for zero
AROUND = np.tan(np.linspace(-1.5, 1.5, 17))  # of the half width of a resonance: frequencies that show it
EVEN = 100  # frequencies at equal ratios
MOST = 40  # extremes that are followed
CLOSER = 3  # rounds, ten times closer each, in which a maximum is located
Place: TypeAlias = tuple[float, float, NDArray, NDArray]  # frequency, how far beyond the bound, vectors u and v


def verdict_of(model: PoleResidueModel | MatrixModel) -> Verdict:
    """Exact: of the function, of the matrix up to FEW ports, else of a state space."""
    if isinstance(model, PoleResidueModel) or len(model.constant) <= FEW or model.proportional.any():
        return check(model.rational(), model.parameter.kind)
    system = StateSpace.from_entries(*(x.tolist() for x in model.realised()))
    return by_storage(system) if model.parameter is Parameter.S else check(system, model.parameter.kind)


def seen(model: MatrixModel) -> AxisAnalysis:
    """The worst value over all frequencies, and bands where it is beyond the bound, in floating point."""
    A, B, C, D = model.realised()
    if not len(A):  # a state that does nothing
        A, B, C = -np.eye(1), np.zeros((1, len(D))), np.zeros((len(D), 1))
    system = StateSpace.from_entries(*(x.tolist() for x in (A, B, C, D)))
    return analyse(FloatSystem.of(model.parameter.kind, system))


def places_of(model: PoleResidueModel | MatrixModel, w: NDArray) -> list[Place]:
    """The worst value at each frequency, and others beyond the bound."""
    values = model.matrices(w)
    if model.parameter is Parameter.S:
        left, sizes, right = np.linalg.svd(values)
        beyond, right = sizes - 1, right.conj().swapaxes(1, 2)
    else:
        sizes, left = np.linalg.eigh((values + values.conj().swapaxes(1, 2)) / 2)
        beyond, right = -sizes, left
    chosen = [(i, j) for i, j in np.ndindex(beyond.shape) if j == 0 or beyond[i, j] > 0]
    return [(float(w[i]), float(beyond[i, j]), left[i, :, j], right[i, :, j]) for i, j in chosen]


def exact_extremes(model: PoleResidueModel) -> list[Place]:
    """Where a function is locally worst in each of its forbidden bands, which the exact test finds."""
    verdict = verdict_of(model)
    if verdict.status is not Status.REFUTED:
        return []
    try:
        return places_of(model, worst_frequencies(model, violations(verdict.negative)))
    except UndecidedError:
        return []


def worst_frequencies(model: PoleResidueModel, bands: list[tuple[float, float]]) -> NDArray:
    """In each forbidden band all frequencies where the model is locally worst, rad/s."""
    marks = np.array([*np.abs(model.poles), *(edge for band in bands for edge in band)])
    marks = marks[(marks > 0) & (marks < math.inf)]
    least, most = (marks.min() / BEYOND, marks.max() * BEYOND) if len(marks) else (1.0, 1.0)
    found = []
    for low, high in bands:
        low, high = max(low, least), min(high, most)
        near = [np.abs(a.imag + a.real * AROUND) for a in model.poles if a.real]
        inner = np.concatenate([np.geomspace(low, high, POINTS), *near])
        w = np.unique(inner[(inner >= low) & (inner <= high)])
        beyond = _beyond(model, w)
        padded = np.pad(beyond, 1, constant_values=-math.inf)
        peaks = np.flatnonzero((beyond >= padded[:-2]) & (beyond > padded[2:]) & (beyond > 0))
        peaks = peaks if len(peaks) else np.array([np.argmax(beyond)])
        found += [_summit(model, w, int(k)) for k in peaks]
    return np.array(found)


def _beyond(model: PoleResidueModel | MatrixModel, w: NDArray) -> NDArray:
    return excess(worst_values(model.matrices(w), model.parameter), model.parameter)


def _summit(model: PoleResidueModel, w: NDArray, k: int) -> float:
    """The top between the neighbours of a point that is higher than they."""
    from scipy.optimize import minimize_scalar

    low, high = math.log(w[max(k - 1, 0)]), math.log(w[min(k + 1, len(w) - 1)])
    if low == high:
        return float(w[k])
    top: Any = minimize_scalar(lambda x: -_beyond(model, np.exp([x]))[0], bounds=(low, high), method="bounded")
    found = np.array([w[k], math.exp(top.x)])
    return float(found[np.argmax(_beyond(model, found))])


def extremes_on_grid(model: MatrixModel, w: NDArray, also: NDArray) -> list[Place]:
    """Frequencies beyond the bound, wherever the worst value has an extreme."""
    grid = grid_of(model, np.concatenate([w, also]))
    peaks = _peaks(model, grid)
    for _ in range(CLOSER):
        low, high = grid[np.maximum(peaks - 1, 0)], grid[np.minimum(peaks + 1, len(grid) - 1)]
        grid = np.unique(low[:, None] + (high - low)[:, None] * np.linspace(0, 1, 12))
        peaks = _peaks(model, grid)
    return [place for place in places_of(model, grid[peaks]) if place[1] > 0]


def grid_of(model: PartialFractions, also: NDArray) -> NDArray:
    """Frequencies that show all resonances, and others, in rising order."""
    a = model.poles
    top = max(float(also.max(initial=0.0)), float(np.abs(a).max(initial=0.0))) or 1.0
    around = np.abs(a.imag[:, None] + a.real[:, None] * AROUND).ravel()
    return np.unique(np.concatenate([[0.0], also, around, np.geomspace(top / BEYOND, top * BEYOND, EVEN)]))


def _peaks(model: MatrixModel, grid: NDArray) -> NDArray:
    """Where the worst value is beyond the bound and no better than at the neighbours."""
    beyond = np.pad(_beyond(model, grid), 1, constant_values=-math.inf)
    inner = beyond[1:-1]
    peaks = np.flatnonzero((inner > 0) & (inner >= beyond[:-2]) & (inner > beyond[2:]))
    return np.sort(peaks[np.argsort(-inner[peaks])[:MOST]])  # where a value is nearly constant, rounding makes many
