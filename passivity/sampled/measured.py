"""Measured networks: a model of few poles through samples of S behind delays, proved passive or changed until it is.

S(s) = exp(-s (T + T')) S'(s) between ports of delays T and T'. A delay has no rational model of low degree, so it is
taken out first. It is searched: of all T the one that leaves a rest which few poles fit best. Too small a T costs
poles, too large a one leaves a rest that answers before it is asked, which no stable poles fit. Delays in front of
several ports are looked for in the ratio of what the phases of all entries say. Where a port reflects before its delay
is over, as a line does that is not matched, none can be taken out, and there are poles for each turn of the phase.

References
----------
B. Gustavsen, "Optimal time delay extraction for transmission line modeling", IEEE Transactions on Power Delivery 32
(2017), 45-54 (the best delay is that of the least misfit, which is searched).
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import islice
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from passivity.errors import ExpressionError
from passivity.exact.verdict import Verdict
from passivity.floats.axis import AxisAnalysis
from passivity.rational.state_space import MAX_STATES
from passivity.sampled.check import check_samples
from passivity.sampled.enforce import enforce
from passivity.sampled.extremes import FEW, bands_of, seen, verdict_of, worst_of
from passivity.sampled.fit import MANY, MEETING, WHITE, Reached, fit, fits
from passivity.sampled.model import PoleResidueModel
from passivity.sampled.response import Parameter, SampledResponse
from passivity.status import Status

SCOUT = 6  # poles with which the delay is looked for
MOST_SCOUTS = 8  # poles up to which it is improved for each order; beyond, each order begins with the one before
SCOUTED = 200  # samples that are enough for both
STEPS = 64  # delays that are tried, a STEP apart
STEP = 1 / 8  # of the shortest period; a shorter delay is left to the poles
FINE = 1e-6  # of the width that is searched, to which it is narrowed
HOPELESS = 0.5  # misfit on a grid of quarter steps above which the delay is not searched in between
PROMISING = 1e-3  # misfit below which it is searched once more
Tried: TypeAlias = Callable[[int, float], object]  # told order and misfit of each model on the way


@dataclass(frozen=True, eq=False)
class DelayedModel:
    """A model S' of samples of S behind delays, and how well it meets them.

    Parameters
    ----------
    delay : float or ndarray, shape (p,)
        T to each port, one way, s.
    model : PoleResidueModel
        S', against the samples' reference resistances.
    original : PoleResidueModel
        The fit, if `model` is the nearest passive one to it; else the same.
    samples : SampledResponse
        Of S', the delays taken out.
    """

    delay: Any
    model: PoleResidueModel
    original: PoleResidueModel
    samples: SampledResponse

    @cached_property
    def verdict(self) -> Verdict:
        """Exact, of `model`. Passive if and only if it is `PROVED`."""
        return verdict_of(self.model)

    @property
    def order(self) -> int:
        """Number of poles, both of a pair counted."""
        return self.model.order

    @property
    def is_left_by_noise(self) -> bool:
        """Whether misfits at neighbouring frequencies have little to do with each other."""
        left = self.model.matrices(2 * np.pi * self.samples.f) - self.samples.values
        return bool(abs(np.vdot(left[1:], left[:-1])) <= WHITE * np.linalg.norm(left) ** 2)

    @property
    def error(self) -> float:
        """Largest |dS| of an entry at the samples."""
        return float(self.distance.max())

    @cached_property
    def seen(self) -> AxisAnalysis:
        """Largest singular value of S' of several ports over all frequencies, and bands beyond 1, in floating point."""
        return seen(self.model)

    @property
    def cost(self) -> float:
        """How far being passive moved an entry at a sample, at most."""
        w = 2 * np.pi * self.samples.f
        return float(np.abs(self.model.at(w) - self.original.at(w)).max())

    @property
    def nearest(self) -> "DelayedModel":
        """The same with the nearest passive model, if one was found."""
        return replace(self, model=enforce(self.model, self.samples).model)

    @property
    def distance(self) -> NDArray:
        """Largest |dS| of an entry at each sample, shape (n,)."""
        return np.abs(self.model.matrices(2 * np.pi * self.samples.f) - self.samples.values).max((1, 2))

    @property
    def why(self) -> str:
        """Why it is passive, or where it is not."""
        if self.verdict.status is not Status.REFUTED:
            return self.verdict.why
        bands, (size, f) = bands_of(self.model)[0], worst_of(self.model)
        what = "|S| > 1" if self.model.ports == 1 else "S has a singular value above 1"
        near = [band for band in bands if band[0] <= 2 * np.pi * f <= band[1]]
        if not near:
            return f"{what} by no more than rounding, at or near {f:.4g} Hz"
        low, high = (edge / (2 * np.pi) for edge in near[0])
        band = f"from {low:.4g} Hz to {high:.4g} Hz" if high < np.inf else f"above {low:.4g} Hz"
        where = f"at {f:.4g} Hz" if f < np.inf else "towards infinity"
        return f"{what} {band}, by up to {size - 1:.3g} {where}"


def fit_behind_delay(
    response: SampledResponse,
    tolerance: float,
    delay: float | None = None,
    nearest: bool = False,
    progress: Tried | None = None,
) -> DelayedModel:
    """The model of fewest poles that meets the samples of a reflection, behind a delay if that saves poles.

    Parameters
    ----------
    response : SampledResponse
        S of one port, at least 3 samples.
    tolerance : float
        Largest |dS| at a sample, above 0.
    delay : float, optional
        T, one way, s, >= 0, where it is known; else it is found, as below 1/(4 Δf) with samples Δf apart: one longer
        by 1/(2 Δf) has the same samples.
    nearest : bool
        Take the nearest passive model in place of a fit that is not passive. It meets the samples too, unless these
        are themselves further than the tolerance beyond what is passive. Otherwise the fit comes back as it is, with
        the verdict that refutes it.
    progress : callable, optional
        Called with order and misfit of each model that is tried.

    Raises
    ------
    ExpressionError
        These are no such samples, or no order meets them: says what was reached.

    Examples
    --------
    >>> s = 2j * np.pi * np.linspace(1e7, 3e9, 150)
    >>> cable = SampledResponse(s.imag / (2 * np.pi), np.exp(-2e-9 * s) / (2 + 1e-9 * s), "S")
    >>> found = fit_behind_delay(cable, 1e-6)
    >>> found.order, round(found.delay * 1e9, 6), str(found.verdict.status)
    (1, 1.0, 'proved')
    """
    if response.ports != 1 or response.parameter is not Parameter.S:
        got = f"{response.parameter} of {response.ports} port{'s' * (response.ports > 1)}"
        raise ExpressionError("samples", "not a reflection", "S of one port", got)
    passive = _is_passive(response, tolerance, nearest)
    otherwise = f", or the delay, if it may be over {_longest(response):.3g} s" if delay is None else ""
    candidates = (
        DelayedModel(chosen, model, model, _without(response, chosen)) for chosen, model in _candidates(response, delay)
    )
    return _first_that_meets(candidates, tolerance, nearest, passive, progress, otherwise)


def fit_scattering(
    response: SampledResponse,
    tolerance: float,
    nearest: bool = False,
    delays: ArrayLike | None = None,
    progress: Tried | None = None,
) -> DelayedModel:
    """The model of fewest poles, common to all entries, that meets samples of S.

    Parameters
    ----------
    response : SampledResponse
        S, at least 3 samples; reciprocal or not.
    tolerance : float
        Largest |dS| of an entry at a sample, above 0.
    nearest : bool
        As of `fit_behind_delay`.
    delays : float or array_like, shape (p,), optional
        Time to each port, one way, s, >= 0, taken out of the samples first; else looked for up to FEW ports, where it
        is some periods of the highest frequency.
    progress : callable, optional
        Called with order and misfit of each model that is tried.

    Raises
    ------
    ExpressionError
        These are no such samples, or no order meets them: says what was reached.

    Examples
    --------
    >>> f = np.linspace(0, 1, 50)
    >>> S = np.array([[0, 0.8], [0.6, 0]]) / (1 + 2j * np.pi * f)[:, None, None]
    >>> found = fit_scattering(SampledResponse(f, S, "S"), 1e-9)
    >>> found.order, str(found.verdict.status)
    (1, 'proved')
    """
    if response.parameter is not Parameter.S:
        raise ExpressionError("samples", "not a scattering matrix", "S", response.parameter.value)
    passive = _is_passive(response, tolerance, nearest)
    return _first_that_meets(_candidates_of_several(response, delays), tolerance, nearest, passive, progress)


def _is_passive(response: SampledResponse, tolerance: float, nearest: bool) -> bool:
    """Whether a passive model can meet these samples; refused are such that none does, unless the nearest is wanted."""
    if len(response.f) < 3:
        raise ExpressionError("samples", "too few for a model", "at least 3", f"{len(response.f)}")
    what = "one-port" if response.ports == 1 else "network"
    try:
        check_samples(response).refuse_beyond(tolerance * response.ports, what)
    except ExpressionError:
        if not nearest:
            raise
        return False
    return True


def _first_that_meets(
    candidates: Iterable[DelayedModel],
    tolerance: float,
    nearest: bool,
    passive: bool,
    progress: Tried | None,
    otherwise: str = "",
) -> DelayedModel:
    """The first of the models that meets the samples, passive if that is wanted; or the nearest passive one to it."""
    reached = Reached()
    for found in candidates:
        error, noise = found.error, found.is_left_by_noise
        if progress:
            progress(found.order, error)
        if fitted := error <= tolerance:
            found = found.nearest if nearest else found
            proved, error = not nearest or found.verdict.proved, found.error
            if proved and (error <= tolerance or not passive):
                return found
        if reached.is_enough(error, found.order, fitted and found.samples.ports > 1, noise):
            break
    raise reached.refusal(tolerance, nearest, otherwise)


def _candidates_of_several(response: SampledResponse, delays: ArrayLike | None) -> Iterator[DelayedModel]:
    """Models of ever more poles, up to MANY also behind the best delays, unless these are known."""
    most = MAX_STATES // response.ports if response.ports > FEW else max(MEETING)
    orders = [k for k in MEETING if k <= min(most, len(response.f) - 2)]
    given = np.broadcast_to(np.asarray(0.0 if delays is None else delays, float), response.ports)
    rests = [(given, _without(response, given))]
    if delays is None and (found := _port_delays(response)).any():
        rests.append((found, _without(response, found)))
    models = [fits(rest, orders) for _, rest in rests]
    for order in orders:
        for (chosen, rest), some in list(zip(rests, models, strict=True))[: 2 if order <= MANY else 1]:
            yield DelayedModel(chosen, model := next(some), model, rest)


def _port_delays(response: SampledResponse) -> NDArray:
    """Delays in front of up to FEW ports, in the ratio of the least squares of T + T' less the phases' slopes, or 0."""
    f, p = response.f, response.ports
    turned = (response.values[1:] * response.values[:-1].conj()).reshape(-1, p * p)
    size = np.abs(turned) + np.finfo(float).tiny
    slope = -(size * np.angle(turned)).sum(0) / (2 * np.pi * np.diff(f) @ size)
    sums, weight = np.kron(np.eye(p), np.ones((p, 1))) + np.tile(np.eye(p), (p, 1)), np.sqrt(size.sum(0))
    T = np.linalg.lstsq(sums * weight[:, None], slope * weight, rcond=None)[0].clip(0)
    if p > FEW or T.max() * f[-1] < 1:
        return np.zeros(p)
    ratio = T / T.max()
    return ratio * _fine_delay(response, MOST_SCOUTS, _rough_delay(response, T.max(), ratio), ratio)


def _candidates(response: SampledResponse, delay: float | None) -> Iterator[tuple[float, Any]]:
    """Delays and models of ever more poles: without a delay and behind the best one, unless it is known."""
    orders = [k for k in MEETING if k <= len(response.f) - 2]
    turned = -np.angle(response.values[1:] * response.values[:-1].conj()).sum()
    whole = float(turned / (4 * np.pi * np.ptp(response.f)))
    T = rough = _rough_delay(response, whole) if delay is None else delay
    few, both = [k for k in orders if k <= MOST_SCOUTS], (T,)
    for order in few:
        T = _fine_delay(response, order, rough) if delay is None else delay
        both = (0.0, T) if delay is None and T else (T,)
        for chosen in both:
            yield chosen, fit(_without(response, chosen), order)
    many = [fits(_without(response, chosen), orders[len(few) - 1 :]) for chosen in both]  # begin with the last of few
    for models in islice(zip(*many, strict=True), 1, None):
        yield from zip(both, models, strict=True)


def _longest(response: SampledResponse) -> float:
    """The delay, s, from which on the phase turns by more than half a turn between two samples: others look shorter."""
    return float(1 / (4 * np.diff(response.f).max()))


def _without(response: SampledResponse, delay: ArrayLike) -> SampledResponse:
    """The samples with delays taken out."""
    turned = np.exp(2j * np.pi * response.f[:, None] * np.broadcast_to(np.asarray(delay), response.ports))
    return replace(response, values=turned[:, :, None] * response.values * turned[:, None, :], rounding=None)


def _misfit_at(response: SampledResponse, delay: ArrayLike, order: int) -> float:
    """Of so many poles, on a part of the samples."""
    rest, stride = _without(response, delay), -(-len(response.f) // SCOUTED)
    rest = SampledResponse(rest.f[::stride], rest.values[::stride], Parameter.S)
    model = fit(rest, min(order, len(rest.f) - 2))
    return DelayedModel(delay, model, model, rest).error


def _rough_delay(response: SampledResponse, whole: float, ratio: ArrayLike = 1.0) -> float:
    """The delay that a few poles like best, on a grid below what all the turning of the phase makes; 0 for a short."""
    step = STEP / response.f[-1]
    grid = whole + step * np.arange(2, 2 - STEPS, -1)
    return min(grid[grid >= step], key=lambda T: _misfit_at(response, T * np.asarray(ratio), SCOUT), default=0.0)


def _fine_delay(response: SampledResponse, order: int, around: float, ratio: ArrayLike = 1.0) -> float:
    """The delay near another that so many poles like best; 0 for a short one."""
    from scipy.optimize import minimize_scalar

    step, ratio = STEP / response.f[-1], np.asarray(ratio)
    if around < step:
        return 0.0
    grid = around + step * np.arange(-2, 2.25, 0.25)
    misfits = [_misfit_at(response, T * ratio, order) for T in grid[grid > 0]]
    around = grid[grid > 0][np.argmin(misfits)]
    if min(misfits) > HOPELESS:
        return float(around)
    for width in (step / 4, FINE * step / 2):  # twice, for rounding limits each search
        misfit = lambda x, T=around: _misfit_at(response, (T + x) * ratio, order)  # noqa: E731
        best: Any = minimize_scalar(misfit, bounds=(-width, width), method="bounded", options={"xatol": FINE * width})
        around += best.x
        if best.fun > PROMISING:
            break
    return float(around) if around >= step else 0.0
