"""A passive model behind a delay: what a reflection measured at the end of a cable is made of.

S(s) = exp(-2 s T) S'(s). A delay has no rational model of low degree, so it is taken out first: of all T the one that
leaves a rest which few poles fit best. Too small a T costs poles, too large a one leaves a rest that answers before it
is asked, which no stable poles fit.

References
----------
B. Gustavsen, "Optimal time delay extraction for transmission line modeling", IEEE Transactions on Power Delivery 32
(2017), 45-54 (the best delay is that of the least misfit, which is searched).
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from typing import Any

import numpy as np

from passivity.errors import ExpressionError
from passivity.one_port.positive_real import check
from passivity.one_port.verdict import Verdict
from passivity.sampled.check import check_samples
from passivity.sampled.enforce import enforce
from passivity.sampled.fit import fit, fits
from passivity.sampled.forbidden import forbidden_bands, worst_frequencies
from passivity.sampled.model import PoleResidueModel
from passivity.sampled.orders import ORDERS, Reached
from passivity.sampled.poles import count
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


@dataclass(frozen=True, eq=False)
class DelayedModel:
    """exp(-2 s T) S'(s), and how well it meets samples.

    Parameters
    ----------
    delay : float
        T, one way, s.
    model : PoleResidueModel
        S', against the samples' reference resistance.
    original : PoleResidueModel
        The fit, if `model` is the nearest passive one to it; else the same.
    samples : SampledResponse
        Of S', the delay taken out.
    """

    delay: float
    model: PoleResidueModel
    original: PoleResidueModel
    samples: SampledResponse

    @property
    def verdict(self) -> Verdict:
        """Exact, of `model`. Passive if and only if it is `PROVED`."""
        return check(self.model.rational(), Parameter.S.kind)

    @property
    def order(self) -> int:
        """Number of poles, both of a pair counted."""
        return count(self.model.poles)

    @property
    def error(self) -> float:
        """Largest |dS| at the samples."""
        return _misfit(self.model, self.samples)

    @property
    def cost(self) -> float:
        """How far being passive moved the model at a sample, at most."""
        w = 2 * np.pi * self.samples.f
        return float(np.abs(self.model.at(w) - self.original.at(w)).max())

    @property
    def why(self) -> str:
        """Why it is passive, or where it is not."""
        verdict = self.verdict
        if verdict.status is not Status.REFUTED:
            return verdict.why
        w = worst_frequencies(self.model, verdict)
        sizes = np.abs(self.model.at(w))
        worst, k = float(sizes.max()), int(sizes.argmax())
        low, high = (edge / (2 * np.pi) for edge in next(b for b in forbidden_bands(verdict) if w[k] <= b[1]))
        band = f"from {low:.4g} Hz to {high:.4g} Hz" if high < np.inf else f"above {low:.4g} Hz"
        return f"|S| > 1 {band}, by up to {worst - 1:.3g} at {w[k] / (2 * np.pi):.4g} Hz"


def fit_behind_delay(
    response: SampledResponse, tolerance: float, delay: float | None = None, nearest: bool = False
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
        Take the nearest passive model in place of a fit that is not passive, if it meets the samples too. Otherwise
        the fit comes back as it is, with the verdict that refutes it.

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
    if len(response.f) < 3:
        raise ExpressionError("samples", "too few for a model", "at least 3", f"{len(response.f)}")
    check_samples(response).refuse_beyond(tolerance, "one-port")
    reached = Reached()
    for chosen, model in _candidates(response, delay):
        rest = _without(response, chosen)
        error = _misfit(model, rest)
        if error <= tolerance:
            found = DelayedModel(chosen, enforce(model, rest).model if nearest else model, model, rest)
            if not nearest or (found.error <= tolerance and found.verdict.status is Status.PROVED):
                return found
            error = found.error
        if reached.is_enough(error, count(model.poles)):
            break
    otherwise = f", or the delay, if it may be over {_longest(response):.3g} s" if delay is None else ""
    raise reached.refusal(tolerance, nearest, otherwise)


def _candidates(response: SampledResponse, delay: float | None) -> Iterator[tuple[float, PoleResidueModel]]:
    """Delays and models of ever more poles: without a delay and behind the best one, unless it is known."""
    orders = [k for k in ORDERS if k <= len(response.f) - 2]
    T = rough = _rough_delay(response) if delay is None else delay
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


def _without(response: SampledResponse, delay: float) -> SampledResponse:
    """The samples with a delay taken out."""
    values = response.values[:, 0, 0] * np.exp(4j * np.pi * response.f * delay)
    return SampledResponse(response.f, values, Parameter.S, response.z0)


def _misfit(model: PoleResidueModel, samples: SampledResponse) -> float:
    return float(np.abs(model.at(2 * np.pi * samples.f) - samples.values[:, 0, 0]).max())


def _misfit_at(response: SampledResponse, delay: float, order: int) -> float:
    """Of so many poles, on a part of the samples."""
    rest, stride = _without(response, delay), -(-len(response.f) // SCOUTED)
    rest = SampledResponse(rest.f[::stride], rest.values[::stride], Parameter.S)
    return _misfit(fit(rest, min(order, len(rest.f) - 2)), rest)


def _rough_delay(response: SampledResponse) -> float:
    """The delay that a few poles like best, on a grid below what all the turning of the phase makes; 0 for a short."""
    f, values, step = response.f, response.values[:, 0, 0], STEP / response.f[-1]
    turned = -np.angle(values[1:] * values[:-1].conj()).sum()
    grid = turned / (4 * np.pi * (f[-1] - f[0])) + step * np.arange(2, 2 - STEPS, -1)
    return min(grid[grid >= step], key=lambda T: _misfit_at(response, T, SCOUT), default=0.0)


def _fine_delay(response: SampledResponse, order: int, around: float) -> float:
    """The delay near another that so many poles like best; 0 for a short one."""
    from scipy.optimize import minimize_scalar

    step = STEP / response.f[-1]
    if around < step:
        return 0.0
    grid = around + step * np.arange(-2, 2.25, 0.25)
    misfits = [_misfit_at(response, T, order) for T in grid[grid > 0]]
    around = grid[grid > 0][np.argmin(misfits)]
    if min(misfits) > HOPELESS:
        return float(around)
    for width in (step / 4, FINE * step / 2):  # twice, for rounding limits each search
        misfit = lambda x, T=around: _misfit_at(response, T + x, order)  # noqa: E731
        best: Any = minimize_scalar(misfit, bounds=(-width, width), method="bounded", options={"xatol": FINE * width})
        around += best.x
        if best.fun > PROMISING:
            break
    return float(around) if around >= step else 0.0
