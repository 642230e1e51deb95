"""The nearest passive model: the least change of residues that the exact test accepts."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from passivity.errors import ExpressionError
from passivity.one_port.polynomial_sign import UndecidedError
from passivity.one_port.positive_real import check
from passivity.one_port.verdict import Verdict
from passivity.sampled.forbidden import worst_frequencies
from passivity.sampled.least_change import least_change, whitening
from passivity.sampled.model import PoleResidueModel, terms
from passivity.sampled.response import MAX_SAMPLES, Parameter, SampledResponse
from passivity.status import Status

MAX_ROUNDS = 25
MAX_SPREAD = 1e16  # of the moduli and real parts of poles: more is lost in rounding
SPARE = 1e-5  # of the first violation: how far inside the bound is aimed at, so that the limit is reached
LEAST_SPARE = 2.0**-44  # of the size of the function: rounding


class Deviation(NamedTuple):
    """Root mean square and maximum of a difference at the samples, divided by those of what it is compared with."""

    rms: float
    max: float


@dataclass(frozen=True, eq=False)
class Enforced:
    """The outcome of `enforce`.

    Parameters
    ----------
    model : PoleResidueModel
        The passive model; the given one if none was found.
    original : PoleResidueModel
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

    model: PoleResidueModel
    original: PoleResidueModel
    verdict: Verdict
    rounds: int
    change: Deviation
    misfit: Deviation
    misfit_before: Deviation


def enforce(model: PoleResidueModel, samples: SampledResponse, only_constant: bool = False) -> Enforced:
    """Change the coefficients of a model as little as possible so that it is passive, which is then proved.

    What is made small is the sum of |change|^2 at the samples, under linear conditions: Re Z(jw) >= 0, or
    Re(u* S(jw)) <= 1 with u = S/|S|, at the worst frequencies w of each forbidden band, which the exact test finds anew
    in each round. The conditions are necessary, so the limit is the best possible change but for SPARE.

    Parameters
    ----------
    model : PoleResidueModel
        All poles in Re s < 0; for Z and Y also simple ones on the imaginary axis with residues >= 0, which they keep,
        as `proportional` does (>= 0; 0 for S).
    samples : SampledResponse
        One port, of the same parameter; at most MAX_SAMPLES. What they do not see, far from their frequencies, may
        change much.
    only_constant : bool
        Only the constant may change. Then there need not be a solution.

    Raises
    ------
    ExpressionError
        If a pole lies elsewhere or MAX_SPREAD from another, a sample lies on a pole, or the samples are of something
        else.

    References
    ----------
    B. Gustavsen, A. Semlyen, "Enforcing passivity for admittance matrices approximated by rational functions", IEEE
    Transactions on Power Systems 16 (2001), 97-104, DOI 10.1109/59.910786; the exact test and the cuts at all worst
    frequencies, old and new, are ours.

    Examples
    --------
    >>> w = np.linspace(0, 10, 50)
    >>> model = PoleResidueModel([-1 + 2j], [1], -0.05, 0, "Z")
    >>> result = enforce(model, SampledResponse(w / (2 * np.pi), model.at(w), "Z"))
    >>> str(result.verdict.status), result.change.rms < 0.1
    ('proved', True)
    """
    w, data = 2 * np.pi * samples.f, samples.values[:, 0, 0]
    free = _free(model, samples, only_constant)
    changed, verdict, rounds = _nearest(model, w, free)
    before, after = model.at(w), changed.at(w)
    errors = deviation(after, before), deviation(after, data), deviation(before, data)
    return Enforced(changed, model, verdict, rounds, *errors)


def _nearest(model: PoleResidueModel, w: NDArray, free: NDArray) -> tuple[PoleResidueModel, Verdict, int]:
    """The nearest passive model with its proof, or the given one as it is, and the number of rounds."""
    from scipy.linalg import solve_triangular

    x0, kind, limit = model.coefficients, model.parameter.kind, float(model.parameter is Parameter.S)
    first = verdict = check(model.rational(), kind)
    changed, rounds, rows, spare = model, 0, np.empty((0, len(x0))), 0.0
    whiten = whitening(terms(model.poles, w)[:, free])
    while verdict.status is Status.REFUTED and rounds < MAX_ROUNDS:
        try:
            new = _must_grow(changed, worst_frequencies(changed, verdict))
        except UndecidedError:
            break
        if not rounds:
            spare = max(SPARE * float(-(limit + new @ x0).min()), LEAST_SPARE * float(np.abs(model.at(w)).max()))
        rows = np.vstack([rows, new])
        step = least_change(solve_triangular(whiten, rows[:, free].T, trans=1).T, spare - limit - rows @ x0)
        if step is None:
            break
        x = x0.copy()
        x[free] += solve_triangular(whiten, step)
        changed, rounds = model.with_coefficients(x), rounds + 1
        verdict = check(changed.rational(), kind)
    return (changed, verdict, rounds) if verdict.status is Status.PROVED else (model, first, rounds)


def deviation(values: NDArray, reference: NDArray) -> Deviation:
    """Relative deviation of complex numbers from others.

    Examples
    --------
    >>> deviation(np.array([1.0, 3.0]), np.array([1.0, 2.0]))
    Deviation(rms=0.4472135954999579, max=0.5)
    """
    off, size = np.abs(values - reference), np.abs(reference)
    largest = size.max()
    if not largest:
        return Deviation(*((np.inf, np.inf) if off.any() else (0.0, 0.0)))
    return Deviation(float(np.linalg.norm(off / largest) / np.linalg.norm(size / largest)), float(off.max() / largest))


def _free(model: PoleResidueModel, samples: SampledResponse, only_constant: bool) -> NDArray:
    """Which coefficients may change, where the rest is fit for a passive model."""
    scattering, a, w = model.parameter is Parameter.S, model.poles, 2 * np.pi * samples.f
    if samples.parameter is not model.parameter or samples.ports != 1:
        got = f"{samples.parameter}, {samples.ports} ports"
        raise ExpressionError("samples", "not of what the model is of", f"{model.parameter}, one port", got)
    if len(w) > MAX_SAMPLES:
        raise ExpressionError("samples", "too many", f"at most {MAX_SAMPLES}", f"{len(w)}")
    inside = a[a.real < 0]
    if len(inside) and np.abs(inside).max() > MAX_SPREAD * -inside.real.max():
        raise ExpressionError("poles", "too far apart", f"within a ratio of {MAX_SPREAD:g}, real parts and moduli")
    for k, pole in enumerate(a):
        on_axis = pole.real == 0 and not scattering
        if pole.real > 0 or (pole.real == 0 and scattering) or (on_axis and (a == pole).sum() > 1):
            expected = "Re < 0" + ("" if scattering else ", or a simple pole on the imaginary axis")
            raise ExpressionError(f"poles[{k}]", "no passive model has it", expected, f"{pole:.6g}")
        if on_axis and (model.residues[k].imag or model.residues[k].real < 0):
            got = f"{model.residues[k]:.6g}"
            raise ExpressionError(f"residues[{k}]", "at a pole on the axis", "a real number >= 0", got)
        if on_axis and pole.imag in w:
            raise ExpressionError("samples", "a sample on a pole", "another frequency", f"{pole.imag:.6g} rad/s")
    if model.proportional < 0 or (scattering and model.proportional):
        raise ExpressionError("proportional", "no passive model has it", "0" if scattering else ">= 0")
    inner = [pole.real < 0 and not only_constant for pole in a for _ in range(1 + (pole.imag > 0))]
    return np.array([*inner, True, False])


def _must_grow(model: PoleResidueModel, w: NDArray) -> NDArray:
    """Coefficients to what must not fall below 0 or -1: Re Z, or minus S in its present direction."""
    phi = terms(model.poles, w)
    if model.parameter is Parameter.S:
        values = model.at(w)
        return -(phi * (values / np.abs(values)).conj()[:, None]).real
    return phi.real
