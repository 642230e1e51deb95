"""The nearest passive model of one port or of several: the least change of coefficients with which it is proved.

Poles stay. Wherever the worst value of a model has an extreme beyond its bound, a passive one must have
Re v^H Z(jw) v >= 0 with the eigenvector v, or Re u^H S(jw) v <= 1 with the singular vectors u and v: a condition that
is linear in the coefficients. All conditions, old and new, are kept, and under them the sum of |change|^2 at the
samples is minimised. The conditions are necessary, so the limit is the best possible change but for a small margin
to the bound. A grid that shows all resonances finds the extremes, and then of one port the exact test, of several the
Hamiltonian one. The exact test then proves the result, or does not.

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
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from passivity.errors import ExpressionError
from passivity.exact.certificate import verify
from passivity.sampled.check import check_samples, worst_name
from passivity.sampled.extremes import (
    MANY_POLES,
    Place,
    bands_of,
    extremes_on_grid,
    grid_of,
    inside,
    is_passive,
    is_proved,
    off_poles,
    places_of,
    verdict_of,
    worst_of,
)
from passivity.sampled.model import PoleResidueModel, terms
from passivity.sampled.response import MAX_SAMPLES, Parameter, SampledResponse
from passivity.status import Decided, Status
from passivity.verdict import Verdict
from tline.errors import check_kind

MAX_ROUNDS = 30
MAX_SPREAD = 1e16  # of the moduli and real parts of poles: more is lost in rounding
SPARE = 1e-5  # of the first violation: how far inside the bound is aimed at, so that the limit is reached
LEAST_SPARE = 2.0**-44  # of the size of the function: rounding
ROOM = (0.0, 1e-9, 1e-7, 1e-5, 1e-3)  # by which several ports end inside the bound, until a proof is found
INSIDE = 1e-5  # where a model of many poles begins
BARELY = 1e-6  # beyond the bound: then all of the model is moved inside
UNSEEN = 1e-8  # weight of a coefficient itself, for those the samples do not determine
FARTHEST = 1e6  # times the distance to the farthest half space; where there is no solution it is infinite


class Deviation(NamedTuple):
    """Root mean square and maximum of a difference at the samples, relative to those of the reference."""

    rms: float
    max: float


@dataclass(frozen=True, eq=False, repr=False)
class Enforced(Decided):
    """The nearest passive model, its proof and its distance: the outcome of `nearest` and `enforce`.

    Parameters
    ----------
    model : PoleResidueModel
        The passive model; the given one if none was found.
    original : PoleResidueModel
        As given.
    rounds : int
        How often the coefficients were changed.
    change : Deviation
        Of the model from the given one.
    misfit, misfit_before : Deviation
        Of the model and of the given one from the samples.
    samples : SampledResponse
        Samples at whose frequencies the deviations are taken.
    """

    model: PoleResidueModel
    original: PoleResidueModel
    rounds: int
    change: Deviation
    misfit: Deviation
    misfit_before: Deviation
    samples: SampledResponse

    @cached_property
    def verdict(self) -> Verdict:
        """Exact verdict of `model`. Passive if and only if it is `PROVED`."""
        return verdict_of(self.model)

    @property
    def status(self) -> Status:  # pyright: ignore[reportIncompatibleVariableOverride]
        """Whether the model is proved passive."""
        return self.verdict.status

    @property
    def why(self) -> str:
        """Why it is passive, or why it was not made so."""
        return self.verdict.why

    @cached_property
    def worst(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Largest |S| or singular value, smallest Re Z or eigenvalue, and its frequency in Hz: before and after."""
        return worst_of(self.original), worst_of(self.model)

    @property
    def response(self) -> SampledResponse:
        """The model at the samples' frequencies; `SampledResponse.touchstone` is the text of a file."""
        return replace(self.samples, values=self.model.matrices(2 * np.pi * self.samples.f), rounding=None)

    def text_lines(self) -> list[str]:
        """The verdict, the worst value before and after, and the distances."""
        (before, _), (after, f) = self.worst
        name = worst_name(self.samples.parameter, self.samples.ports)
        return [
            f"nearest passive model, {self.model.order} poles: {self.status.value}",
            f"  because {self.why}",
            f"  {name} = {before:.6g} before, {after:.6g} after, at {f:.6g} Hz",
            f"  it misses the samples by {self.misfit.rms:.3g} (rms, relative), "
            f"the best fit by {self.misfit_before.rms:.3g}; being passive cost {self.change.rms:.3g}",
        ]

    def to_dict(self) -> dict[str, Any]:
        """The models before and after, with the distance, and whether the proof was verified."""
        certificate, told = self.verdict.certificate, {}
        models = {"fitted": (self.original, self.misfit_before), "model": (self.model, self.misfit)}
        for (name, (model, misfit)), (worst, f) in zip(models.items(), self.worst, strict=True):
            told[name] = model.to_dict() | {"misfit": misfit._asdict(), "worst": worst}
            told[name]["worst_frequency"] = f if np.isfinite(f) else str(f)
        told["model"] |= {"status": self.status.value, "why": self.why, "rounds": self.rounds}
        told["model"] |= {"verified": certificate is not None and verify(certificate), "change": self.change._asdict()}
        return told

    def plot(self, ax: Any = None) -> Any:
        """The worst values of samples and models against their bound, on `ax` or in a new figure."""
        from passivity.sampled.picture import draw_samples

        return draw_samples(check_samples(self.samples), ax, self)


def nearest(what: SampledResponse | str | Path | Any, order: int | None = None) -> Enforced:
    """The nearest passive model of samples, or to a model that is not passive, with its proof and its distance.

    Parameters
    ----------
    what : SampledResponse, str, Path, PoleResidueModel
        Z, Y or S of one port or several: samples or a Touchstone file, to which a model is fitted first, or a model,
        whose change is then measured at frequencies that show all its resonances.
    order : int, optional
        Number of poles of the fit, see `fit`.

    Raises
    ------
    ExpressionError
        Where `read_touchstone`, `fit` or `enforce` raises it.

    Examples
    --------
    >>> f = np.linspace(0, 1, 50)
    >>> S = np.array([[0.1, 1.0], [0.9, 0]]) / (1 + 2j * np.pi * f)[:, None, None]
    >>> found = nearest(SampledResponse(f, S, "S"), order=1)
    >>> before, after = (round(value, 3) for value, _ in found.worst)
    >>> str(found.status), before, after, found.change.rms < 0.05
    ('proved', 1.022, 1.0, True)
    """
    from passivity.sampled.fit import fit
    from passivity.sampled.read import read_touchstone

    if isinstance(what, str | Path):
        what = read_touchstone(what)
    if isinstance(what, SampledResponse):
        return enforce(fit(what, order), what)
    if not isinstance(what, PoleResidueModel):
        expected = "samples, a Touchstone file, or a PoleResidueModel"
        raise ExpressionError("what", "no model can be made of it", expected, type(what).__name__)
    w = grid_of(what, np.zeros(0))
    return enforce(what, SampledResponse(w / (2 * np.pi), what.matrices(w), what.parameter))


def enforce(model: Any, samples: SampledResponse, only_constant: bool = False) -> Enforced:
    """Change the coefficients of a model as little as possible so that it is passive, which is then proved.

    Parameters
    ----------
    model : PoleResidueModel
        All poles in Re s < 0; for Z and Y of one port also simple ones on the imaginary axis with residues >= 0, which
        they keep, as `proportional` does (>= 0; 0 for S).
    samples : SampledResponse
        Samples of the same parameter and ports, at most MAX_SAMPLES. Far from their frequencies the model may change
        much.
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
    check_kind("samples", samples, SampledResponse)
    w, data = 2 * np.pi * samples.f, samples.values
    free = _free(model, samples, only_constant)
    changed, rounds = model, 0
    if not is_passive(model, w):
        found, rounds = _nearest(model, w, free)
        changed = found or model
    here, before = changed.matrices(w), model.matrices(w)
    errors = deviation(here, before), deviation(here, data), deviation(before, data)
    return Enforced(changed, model, rounds, *errors, samples)


def deviation(values: NDArray, reference: NDArray) -> Deviation:
    """Relative deviation of complex numbers from others."""
    off, size = np.abs(values - reference), np.abs(reference)
    largest = size.max()
    if not largest:
        return Deviation(*((np.inf, np.inf) if off.any() else (0.0, 0.0)))
    return Deviation(float(np.linalg.norm(off / largest) / np.linalg.norm(size / largest)), float(off.max() / largest))


def _free(model: PoleResidueModel, samples: SampledResponse, only_constant: bool) -> NDArray:
    """Which coefficients may change, where the rest is fit for a passive model."""
    scattering, a, w = model.parameter is Parameter.S, model.poles, 2 * np.pi * samples.f
    ports = model.ports
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


def _least_changed(
    model: PoleResidueModel, w: NDArray, free: NDArray, extremes: Callable[[PoleResidueModel], list[Place]]
) -> tuple[PoleResidueModel, int]:
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


def _nearest(model: PoleResidueModel, w: NDArray, free: NDArray) -> tuple[PoleResidueModel | None, int]:
    """The nearest passive model, of several ports moved inside until that is proved; None if it is not."""
    marks, size = [], 0.0
    unit = 1.0 if model.parameter is Parameter.S else float(np.abs(model.at(w)).max())
    many = model.ports > 1 and model.order > MANY_POLES

    def extremes(changed: PoleResidueModel) -> list[Place]:
        nonlocal size
        places = extremes_on_grid(changed, w, np.array(marks))
        if places or many:  # of that many, what the grid misses is less than the room that is given
            return places
        bands, size = bands_of(changed)
        if size <= BARELY * unit:
            return []
        inner = off_poles(changed, np.concatenate([[], *(inside(*band) for band in bands)]))
        marks.extend(inner)
        places = extremes_on_grid(changed, w, np.array(marks))
        return places or (places_of(changed, inner) if size == math.inf else [])  # seen in exact numbers alone

    found, rounds = _least_changed(model, w, free, extremes)
    if many and rounds:  # it touches the bound, where floats suggest no proof
        beyond = max((x for _, x, _, _ in extremes(found)), default=0.0)
        if beyond > ROOM[-1] * unit:  # no proof, which would take long to fail
            return None, rounds
        found = found.moved_inside(beyond + INSIDE * unit)
    if is_proved(found):
        return found, rounds
    rooms = [x for x in ROOM if not many or x > INSIDE] if size < math.inf else []
    tried = (found.moved_inside(max(size, 0.0) + room * unit) for room in rooms)
    return next((moved for moved in tried if is_proved(moved)), None), rounds


def whitening(phi: NDArray[np.complex128]) -> NDArray:
    """R, upper triangular, with |R x| the size of phi x, and a little of x itself."""
    own = UNSEEN * np.diag(np.linalg.norm(phi, axis=0))
    return np.asarray(np.linalg.qr(np.vstack([phi.real, phi.imag, own]), mode="r"))


def least_change(rows: NDArray, bounds: NDArray) -> NDArray | None:
    """Return the shortest x for which rows x >= bounds; None if none of acceptable length is found.

    Lawson and Hanson's least distance programming: the residual of a least-squares problem with nonnegative unknowns
    points to x. No row is zero; some bound is above zero.
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
