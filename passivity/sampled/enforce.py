"""The nearest passive model of one port or of several: the least change of coefficients with which it is proved.

Poles stay. Wherever the worst value of a model has an extreme beyond its bound, a passive one must have
Re v^H Z(jw) v >= 0 with the eigenvector v, or Re u^H S(jw) v <= 1 with the singular vectors u and v: a condition that
is linear in the coefficients. All of them, old and new, are kept, and what is made small under them is the sum of
|change|^2 at the samples. The conditions are necessary, so the limit is the best possible change but for what is
spared. Of one port the exact test finds the extremes, of several a grid that shows all resonances, and then the
Hamiltonian test. What comes out is proved, or not, by the exact test.

References
----------
B. Gustavsen, A. Semlyen, "Enforcing passivity for admittance matrices approximated by rational functions", IEEE
Transactions on Power Systems 16 (2001), 97-104, DOI 10.1109/59.910786.
S. Grivet-Talocia, "Passivity enforcement via perturbation of Hamiltonian matrices", IEEE Transactions on Circuits and
Systems I 51 (2004), 1755-1769, DOI 10.1109/TCSI.2004.834527 (singular values of S).
C. L. Lawson, R. J. Hanson, "Solving Least Squares Problems", 1974, chapter 23, DOI 10.1137/1.9781611971217.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from passivity.budget import UndecidedError
from passivity.errors import ExpressionError
from passivity.exact.positive_real import by_storage, check
from passivity.exact.verdict import Verdict
from passivity.floats.axis import AxisAnalysis, analyse
from passivity.floats.system import FloatSystem
from passivity.polynomial.bands import violations
from passivity.rational.state_space import StateSpace
from passivity.sampled.check import excess, worst_values
from passivity.sampled.model import MatrixModel, PoleResidueModel, terms
from passivity.sampled.response import MAX_SAMPLES, Parameter, SampledResponse
from passivity.status import Status

FEW = 4  # ports up to which the exact test takes seconds
MAX_ROUNDS = 30
MAX_SPREAD = 1e16  # of the moduli and real parts of poles: more is lost in rounding
SPARE = 1e-5  # of the first violation: how far inside the bound is aimed at, so that the limit is reached
LEAST_SPARE = 2.0**-44  # of the size of the function: rounding
ROOM = (0.0, 1e-9, 1e-7, 1e-5, 1e-3)  # by which several ports end inside the bound, until a proof is found
BARELY = 1e-6  # beyond the bound: then all of the model is moved inside
UNSEEN = 1e-8  # weight of a coefficient itself, for what the samples do not see
FARTHEST = 1e6  # times the distance to the farthest half space; where there is no solution it is infinite
POINTS = 60  # in a forbidden band, at equal ratios
BEYOND = 1e6  # times the largest frequency: stands for infinity, its inverse for zero
AROUND = np.tan(np.linspace(-1.5, 1.5, 17))  # of the half width of a resonance: frequencies that show it
EVEN = 100  # frequencies at equal ratios
CLOSER = 3  # rounds, ten times closer each, in which a maximum is located

M = TypeVar("M", PoleResidueModel, MatrixModel)
Place: TypeAlias = tuple[float, float, NDArray, NDArray]  # frequency, how far beyond the bound, vectors u and v


class Deviation(NamedTuple):
    """Root mean square and maximum of a difference at the samples, divided by those of what it is compared with."""

    rms: float
    max: float


@dataclass(frozen=True, eq=False)
class Enforced:
    """The outcome of `enforce`.

    Parameters
    ----------
    model : PoleResidueModel or MatrixModel
        The passive model; the given one if none was found.
    original : PoleResidueModel or MatrixModel
        As given.
    verdict : Verdict
        Exact verdict of `model`. Passive if and only if it is `PROVED`.
    rounds : int
        How often the coefficients were changed.
    change : Deviation
        Of the model from the given one.
    misfit, misfit_before : Deviation
        Of the model and of the given one from the samples.
    """

    model: Any
    original: Any
    verdict: Verdict
    rounds: int
    change: Deviation
    misfit: Deviation
    misfit_before: Deviation


def enforce(model: M, samples: SampledResponse, only_constant: bool = False) -> Enforced:
    """Change the coefficients of a model as little as possible so that it is passive, which is then proved.

    Parameters
    ----------
    model : PoleResidueModel or MatrixModel
        All poles in Re s < 0; for Z and Y of one port also simple ones on the imaginary axis with residues >= 0, which
        they keep, as `proportional` does (>= 0; 0 for S).
    samples : SampledResponse
        Of the same parameter and ports; at most MAX_SAMPLES. What they do not see, far from their frequencies, may
        change much.
    only_constant : bool
        Only the constant may change. Then there need not be a solution.

    Raises
    ------
    ExpressionError
        If a pole lies elsewhere or MAX_SPREAD from another, a sample lies on a pole, or the samples are of something
        else.

    Examples
    --------
    >>> w = np.linspace(0, 10, 50)
    >>> model = PoleResidueModel([-1 + 2j], [1], -0.05, 0, "Z")
    >>> result = enforce(model, SampledResponse(w / (2 * np.pi), model.at(w), "Z"))
    >>> str(result.verdict.status), result.change.rms < 0.1
    ('proved', True)
    """
    w, data = 2 * np.pi * samples.f, samples.values
    free = _free(model, samples, only_constant)
    verdict, rounds, changed = verdict_of(model), 0, model
    if verdict.status is not Status.PROVED:
        if isinstance(model, PoleResidueModel):
            found, rounds = _least_changed(model, w, free, _exact_extremes)
            after = verdict_of(found)
        else:
            found, after, rounds = _of_several(model, w, free)
        changed, verdict = (found, after) if after.status is Status.PROVED else (model, verdict)
    here, before = changed.matrices(w), model.matrices(w)
    errors = deviation(here, before), deviation(here, data), deviation(before, data)
    return Enforced(changed, model, verdict, rounds, *errors)


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


def deviation(values: NDArray, reference: NDArray) -> Deviation:
    """Relative deviation of complex numbers from others."""
    off, size = np.abs(values - reference), np.abs(reference)
    largest = size.max()
    if not largest:
        return Deviation(*((np.inf, np.inf) if off.any() else (0.0, 0.0)))
    return Deviation(float(np.linalg.norm(off / largest) / np.linalg.norm(size / largest)), float(off.max() / largest))


def _free(model: PoleResidueModel | MatrixModel, samples: SampledResponse, only_constant: bool) -> NDArray:
    """Which coefficients may change, where the rest is fit for a passive model."""
    scattering, a, w = model.parameter is Parameter.S, model.poles, 2 * np.pi * samples.f
    ports = len(np.atleast_1d(model.constant))
    if samples.parameter is not model.parameter or samples.ports != ports:
        expected, got = f"{model.parameter}, {ports} ports", f"{samples.parameter}, {samples.ports} ports"
        raise ExpressionError("samples", "not of what the model is of", expected, got)
    if len(w) > MAX_SAMPLES:
        raise ExpressionError("samples", "too many", f"at most {MAX_SAMPLES}", f"{len(w)}")
    inside = a[a.real < 0]
    if len(inside) and np.abs(inside).max() > MAX_SPREAD * -inside.real.max():
        raise ExpressionError("poles", "too far apart", f"within a ratio of {MAX_SPREAD:g}, real parts and moduli")
    may = not scattering and ports == 1  # lie on the axis
    for k, pole in enumerate(a):
        on_axis = pole.real == 0 and may
        if pole.real > 0 or (pole.real == 0 and not may) or (on_axis and (a == pole).sum() > 1):
            expected = "Re < 0" + (", or a simple pole on the imaginary axis" if may else "")
            raise ExpressionError(f"poles[{k}]", "no passive model has it", expected, f"{pole:.6g}")
        if on_axis and (model.residues[k].imag or model.residues[k].real < 0):
            got = f"{model.residues[k]:.6g}"
            raise ExpressionError(f"residues[{k}]", "at a pole on the axis", "a real number >= 0", got)
        if on_axis and pole.imag in w:
            raise ExpressionError("samples", "a sample on a pole", "another frequency", f"{pole.imag:.6g} rad/s")
    grows = np.atleast_2d(model.proportional)
    if (scattering and grows.any()) or (grows != grows.T).any() or np.linalg.eigvalsh(grows)[0] < 0:
        raise ExpressionError("proportional", "no passive model has it", "0" if scattering else ">= 0")
    inner = [pole.real < 0 and not only_constant for pole in a for _ in range(1 + (pole.imag > 0))]
    return np.array([*inner, True, False])


def _least_changed(model: M, w: NDArray, free: NDArray, extremes: Callable[[M], list[Place]]) -> tuple[M, int]:
    """The nearest model without extremes beyond the bound, as far as rounds go, and their number."""
    from scipy.linalg import solve_triangular

    x0, limit = model.coefficients, float(model.parameter is Parameter.S)
    x0 = x0.reshape(len(x0), -1)
    whiten = whitening(terms(model.poles, w)[:, free])
    rows, bounds, spare, changed = [], [], 0.0, model
    for rounds in range(MAX_ROUNDS):
        places = extremes(changed)
        if not places:
            return changed, rounds
        if not spare:
            beyond = max(x for _, x, _, _ in places)
            spare = max(SPARE * beyond, LEAST_SPARE * float(np.abs(model.at(w)).max()))
        for at, _, u, v in places:
            row = (terms(model.poles, np.array([at])).T * np.outer(u.conj(), v).ravel()).real  # must grow by it
            row = -row if limit else row
            rows.append(solve_triangular(whiten, row[free], trans=1).ravel())
            bounds.append(spare - limit - float((row * x0).sum()))
        step = least_change(np.array(rows), np.array(bounds))
        if step is None:
            return changed, rounds
        x = x0.copy()
        x[free] += solve_triangular(whiten, step.reshape(free.sum(), -1))
        changed = model.with_coefficients(x.reshape(model.coefficients.shape))
    return changed, MAX_ROUNDS


def _places(model: PoleResidueModel | MatrixModel, w: NDArray) -> list[Place]:
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


def _exact_extremes(model: PoleResidueModel) -> list[Place]:
    """Where a function is locally worst in each of its forbidden bands, which the exact test finds."""
    verdict = verdict_of(model)
    if verdict.status is not Status.REFUTED:
        return []
    try:
        return _places(model, worst_frequencies(model, violations(verdict.negative)))
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


def _of_several(model: MatrixModel, w: NDArray, free: NDArray) -> tuple[MatrixModel, Verdict, int]:
    """The nearest passive model, moved inside the bound until that is proved; else the last that was tried."""
    marks, size = [], 0.0
    unit = 1.0 if model.parameter is Parameter.S else float(np.abs(model.at(w)).max())

    def extremes(changed: MatrixModel) -> list[Place]:
        nonlocal size
        if places := _extremes(changed, w, np.array(marks)):
            return places
        analysis = seen(changed)
        size = float(excess(np.array(analysis.value), model.parameter)) + analysis.value_error
        edges = np.array([analysis.frequency, *np.ravel(analysis.bands)])
        marks.extend(edges[np.isfinite(edges)])
        return _extremes(changed, w, np.array(marks)) if size > BARELY * unit else []

    found, rounds = _least_changed(model, w, free, extremes)
    verdict = verdict_of(found)
    for room in ROOM:
        if verdict.status is Status.PROVED or not size < math.inf:
            break
        inside = found.moved_inside(max(size, 0.0) + room * unit)
        verdict = verdict_of(inside)
        if verdict.status is Status.PROVED:
            return inside, verdict, rounds
    return found, verdict, rounds


def _extremes(model: MatrixModel, w: NDArray, also: NDArray) -> list[Place]:
    """Frequencies beyond the bound, wherever the worst value has an extreme."""
    a, top = model.poles, max(w[-1], float(np.abs(model.poles).max(initial=0.0)))
    around = np.abs(a.imag[:, None] + a.real[:, None] * AROUND).ravel()
    grid = np.unique(np.concatenate([[0.0], w, also, around, np.geomspace(top / BEYOND, top * BEYOND, EVEN)]))
    peaks = _peaks(model, grid)
    for _ in range(CLOSER):
        low, high = grid[np.maximum(peaks - 1, 0)], grid[np.minimum(peaks + 1, len(grid) - 1)]
        grid = np.unique(low[:, None] + (high - low)[:, None] * np.linspace(0, 1, 12))
        peaks = _peaks(model, grid)
    return [place for place in _places(model, grid[peaks]) if place[1] > 0]


def _peaks(model: MatrixModel, grid: NDArray) -> NDArray:
    """Where the worst value is beyond the bound and no better than at the neighbours."""
    beyond = np.pad(_beyond(model, grid), 1, constant_values=-math.inf)
    inner = beyond[1:-1]
    return np.flatnonzero((inner > 0) & (inner >= beyond[:-2]) & (inner >= beyond[2:]))


def whitening(phi: NDArray[np.complex128]) -> NDArray:
    """R, upper triangular, with |R x| the size of phi x, and a little of x itself."""
    own = UNSEEN * np.diag(np.linalg.norm(phi, axis=0))
    return np.asarray(np.linalg.qr(np.vstack([phi.real, phi.imag, own]), mode="r"))


def least_change(rows: NDArray, bounds: NDArray) -> NDArray | None:
    """The shortest x for which rows x >= bounds; None if there is none.

    Lawson and Hanson's least distance programming: the residual of a least-squares problem with nonnegative unknowns
    points to x. No row is zero; some bound is above zero.

    Examples
    --------
    >>> least_change(np.array([[1.0, 1.0], [1.0, 0.0]]), np.array([5.0, 4.0])).round(9)
    array([4., 1.])
    """
    from scipy.optimize import nnls

    g = rows.T
    sizes = np.linalg.norm(g, axis=0)
    farthest = float((bounds / sizes).max())
    spaces, target = np.vstack([g / sizes, bounds / sizes / farthest]), np.append(np.zeros(len(g)), 1.0)
    try:
        residual = spaces @ nnls(spaces, target)[0] - target
    except RuntimeError:  # too many iterations
        return None
    if -residual[-1] * FARTHEST**2 < 1:
        return None
    return -residual[:-1] / residual[-1] * farthest
