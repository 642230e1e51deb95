"""Measured networks: a model of few poles through samples of S behind delays, proved passive or changed until it is.

S(s) = exp(-s (T + T')) S'(s) between ports of delays T and T'. A delay has no rational model of low degree, so it is
taken out first. It is searched: of all T the one that leaves a rest which few poles fit best. Too small a T costs
poles, too large a one leaves a rest that answers before it is asked, which no stable poles fit. Delays in front of
several ports are searched in the ratio that the phases of all entries give. Where a port reflects before its delay is
over, as an unmatched line does, none can be taken out, and there are poles for each turn of the phase; a network that
looks alike from two sides is then split (`mirrored`). The search ends by orders and samples alone, never by time.

References
----------
B. Gustavsen, "Optimal time delay extraction for transmission line modeling", IEEE Transactions on Power Delivery 32
(2017), 45-54 (the best delay is that of the least misfit, which is searched).
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray
from threadpoolctl import threadpool_limits

from passivity.errors import ExpressionError
from passivity.floats.axis import AxisAnalysis
from passivity.rational.state_space import MAX_STATES
from passivity.sampled.check import check_samples
from passivity.sampled.enforce import enforce
from passivity.sampled.extremes import FEW_PORTS, bands_of, is_passive, seen, verdict_of, worst_of
from passivity.sampled.fit import MANY, MEETING, WHITE, Reached, fit, fits
from passivity.sampled.mirror import ALIKE, joined, mirrored, on_grid, proved_on_grid
from passivity.sampled.model import PoleResidueModel, terms
from passivity.sampled.response import Parameter, SampledResponse
from passivity.status import Status
from passivity.verdict import Verdict
from tline.errors import check_kind
from tline.units import engineering

SCOUT = 6  # poles with which the delay is looked for
MOST_SCOUTS = 8  # poles up to which it is improved for each order; beyond, each order begins with the one before
SCOUTED = 200  # samples that are enough for both
STEPS = 64  # delays that are tried, a STEP apart
STEP = 1 / 8  # of the shortest period; a shorter delay is left to the poles
FINE = 1e-9  # radians at the highest frequency, to which a delay is narrowed
MOST_STEPS = 12  # on the way
FARTHEST_STEP = 0.5  # radians at the highest frequency
SEEN = 1e-6  # of what the best seen delays change; of others nothing is known
Tried: TypeAlias = Callable[[int, float], object]  # called with order and misfit of each model tried


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
    parts : tuple of PoleResidueModel
        Models of decoupled waves whose exact sum is `model`, if it was made so; see `mirrored`.
    """

    delay: Any
    model: PoleResidueModel
    original: PoleResidueModel
    samples: SampledResponse
    parts: tuple[PoleResidueModel, ...] = ()

    @cached_property
    def verdict(self) -> Verdict:
        """Exact, of `model`, or of the first of its parts that is not proved. Passive if and only if it is `PROVED`."""
        return verdict_of(self.decisive)

    @cached_property
    def decisive(self) -> PoleResidueModel:
        """The model, or the part of it on which its verdict rests."""
        return next((part for part in self.parts if not verdict_of(part).proved), (*self.parts, self.model)[0])

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

    @property
    def misfit(self) -> float:
        """Largest |dS| of an entry at the samples before the model was made passive."""
        return float(np.abs(self.original.matrices(2 * np.pi * self.samples.f) - self.samples.values).max())

    def meets(self, tolerance: float) -> bool:
        """Return whether the model is that near to the samples, or was until made passive, as these are not."""
        if self.error <= tolerance or self.misfit > tolerance:
            return self.error <= tolerance
        try:
            check_samples(self.samples).refuse_beyond(tolerance * self.samples.ports, "")
        except ExpressionError:
            return True
        return False

    @cached_property
    def seen(self) -> AxisAnalysis:
        """Largest singular value of S' of several ports over all frequencies, and bands beyond 1, in floating point."""
        return seen(self.model)

    @property
    def cost(self) -> float:
        """Largest change of an entry at a sample by making the model passive."""
        w = 2 * np.pi * self.samples.f
        return float(np.abs(self.model.at(w) - self.original.at(w)).max())

    @property
    def nearest(self) -> "DelayedModel":
        """Copy with the nearest passive model, if one was found; unchanged where its parts were made passive."""
        return self if self.parts else replace(self, model=enforce(self.model, self.samples).model)

    @property
    def summary(self) -> str:
        """Poles, delays, verdict and distance from the samples, in one line."""
        samples, order, delays = self.samples, self.order, np.atleast_1d(self.delay)
        told = f"{order} pole{'s' * (order != 1)}"
        behind = ", ".join(engineering(float(T), "s") for T in delays) if delays.any() else ""
        if samples.ports > 1:
            told = f"{samples.ports} ports, {told}{' behind ' * bool(behind)}{behind}"
        else:
            z0 = engineering(float(samples.z0[0]), "ohm")
            told += f" behind {behind} of {z0}" if behind else f" against {z0}"
        word = "not" if self.verdict.status is Status.REFUTED else self.verdict.status.value
        cost = f", of which being passive cost {self.cost:.2g}" if self.cost else ""
        first, last = (engineering(float(f), "Hz") for f in samples.f[[0, -1]])
        error = f"|ΔS| up to {self.error:.2g}{cost} ({len(samples.f)} samples, {first} to {last})"
        return f"{told}, {word} passive, {error}"

    @property
    def distance(self) -> NDArray:
        """Largest |dS| of an entry at each sample, shape (n,)."""
        return np.abs(self.model.matrices(2 * np.pi * self.samples.f) - self.samples.values).max((1, 2))

    @property
    def why(self) -> str:
        """Why it is passive, or where it is not."""
        if self.verdict.status is not Status.REFUTED:
            return self.verdict.why
        bands, (size, f) = bands_of(self.decisive)[0], worst_of(self.decisive)
        what = "|S| > 1" if self.decisive.ports == 1 else "S has a singular value above 1"
        near = [band for band in bands if band[0] <= 2 * np.pi * f <= band[1]]
        if not near:
            return f"{what} by no more than rounding, at or near {f:.4g} Hz"
        low, high = (edge / (2 * np.pi) for edge in near[0])
        band = f"from {low:.4g} Hz to {high:.4g} Hz" if high < np.inf else f"above {low:.4g} Hz"
        where = f"at {f:.4g} Hz" if f < np.inf else "towards infinity"
        return f"{what} {band}, by up to {size - 1:.3g} {where}"


def fit_scattering(
    response: SampledResponse,
    tolerance: float,
    nearest: bool = False,
    delays: ArrayLike | None = None,
    progress: Tried | None = None,
) -> DelayedModel:
    """The model of fewest poles, common to all entries, that meets samples of S, behind delays if these save poles.

    Parameters
    ----------
    response : SampledResponse
        S, at least 3 samples; reciprocal or not.
    tolerance : float
        Largest |dS| of an entry at a sample, above 0.
    nearest : bool
        Take the nearest passive model in place of a fit that is not passive, and the nearest to the best of all fits
        where none `meets` the tolerance. Otherwise the fit comes back as it is, with the verdict that refutes it.
    delays : float or array_like, shape (p,), optional
        Time to each port, one way, s, >= 0, taken out of the samples first; else looked for: of one port below
        1/(4 Δf) with samples Δf apart, for one longer by 1/(2 Δf) has the same samples; of up to FEW_PORTS ports where
        it is some periods of the highest frequency.
    progress : callable, optional
        Called with order and misfit of each model that is tried.

    Raises
    ------
    ExpressionError
        Not such samples, or no order meets them and the nearest is not wanted; the message gives the error reached.

    Examples
    --------
    >>> s = 2j * np.pi * np.linspace(1e7, 3e9, 150)
    >>> cable = SampledResponse(s.imag / (2 * np.pi), np.exp(-2e-9 * s) / (2 + 1e-9 * s), "S")
    >>> found = fit_scattering(cable, 1e-6)
    >>> found.order, round(found.delay * 1e9, 5), str(found.verdict.status)
    (1, 1.0, 'proved')
    """
    check_kind("response", response, SampledResponse)
    if response.parameter is not Parameter.S:
        raise ExpressionError("samples", "not a scattering matrix", "S", response.parameter.value)
    if len(response.f) < 3:
        raise ExpressionError("samples", "too few for a model", "at least 3", f"{len(response.f)}")
    if not nearest:
        what = "one-port" if response.ports == 1 else "network"
        check_samples(response).refuse_beyond(tolerance * response.ports, what)
    with threadpool_limits(1, "blas"):  # threads wait for each other longer than such matrices take
        return _searched(response, tolerance, nearest, delays, progress)


def _searched(
    response: SampledResponse, tolerance: float, nearest: bool, delays: ArrayLike | None, progress: Tried | None
) -> DelayedModel:
    """Search orders upwards, and refuse samples that none meets."""
    reached, tried = Reached(), []
    halves = mirrored(response, tolerance) if not np.any(delays) else None
    for found in _candidates(response, delays):
        if halves and found.order > MANY:
            found = _joined(response, *halves, tolerance * (1 - ALIKE), nearest, progress)
        fitted, noise = found.misfit <= tolerance, found.is_left_by_noise
        found = found.nearest if fitted and nearest else found
        if progress:
            progress(found.order, found.error)
        if found.meets(tolerance) and (not nearest or found.verdict.proved):
            return found
        tried.append(found)
        several = fitted and found.samples.ports > 1
        if reached.is_enough(found.error, found.order, several, noise) or found.parts:
            break
    if nearest and (passive := _nearest_of(tried)):
        return passive
    longest = 1 / (4 * np.diff(response.f).max())  # beyond, the phase turns by over half a turn between two samples
    of_delay = delays is None and response.ports == 1
    otherwise = f", or the delay, if it may be over {longest:.3g} s" if of_delay else ""
    raise reached.refusal(tolerance, nearest, otherwise)


def _joined(response: SampledResponse, swap: NDArray, halves: list[SampledResponse], *asked: Any) -> DelayedModel:
    """The sum of the models of two halves, without delays."""
    tolerance, nearest, progress = asked
    found = [fit_scattering(half, tolerance, nearest, 0.0, progress) for half in halves]
    models = [each.model if each.parts else proved_on_grid(each.model) for each in found]
    parts = tuple(part for each, own in zip(found, models, strict=True) for part in each.parts or (own,))
    whole, fitted = joined(swap, models), joined(swap, [each.original for each in found])
    return DelayedModel(np.zeros(len(swap)), whole, fitted, replace(response, rounding=None), parts)


def _nearest_of(tried: list[DelayedModel]) -> DelayedModel | None:
    """The nearest passive model to the best fit that has one."""
    fewest = math.inf
    for found in sorted(tried, key=lambda each: each.error):
        if found.order < fewest and is_passive((passive := found.nearest).decisive, 2 * np.pi * passive.samples.f):
            return passive
        fewest = min(fewest, found.order)  # what has more poles is no easier
    return None


def _candidates(response: SampledResponse, delays: ArrayLike | None) -> Iterator[DelayedModel]:
    """Models of ever more poles, also behind the best delays, of several ports up to MANY, unless these are known."""
    p = response.ports
    orders = [k for k in MEETING if k <= min(MAX_STATES // p, len(response.f) - 2)]
    given = np.broadcast_to(np.asarray(0.0 if delays is None else delays, float), p)
    rough = _port_delays(response) if delays is None else np.zeros(1)
    few, both = [k for k in orders if k <= MOST_SCOUTS], [given]
    for order in few:
        both = [given, T] if rough.any() and (T := _fine_delays(response, order, rough)).any() else [given]
        for chosen in both:
            yield _behind(chosen, fit(rest := _without(response, chosen), order), rest)
    rests = [_without(response, chosen) for chosen in both]
    models = [fits(rest, orders[len(few) - 1 :]) for rest in rests]  # begin with the last of few
    for order in orders[len(few) - 1 :]:
        for chosen, rest, some in list(zip(both, rests, models, strict=True))[: 2 if order <= MANY or p == 1 else 1]:
            model = next(some)
            if order > MOST_SCOUTS:
                yield _behind(chosen, model, rest)


def _behind(delays: NDArray, model: PoleResidueModel, rest: SampledResponse) -> DelayedModel:
    model = on_grid(model)
    return DelayedModel(delays if rest.ports > 1 else float(delays[0]), model, model, rest)


def _port_delays(response: SampledResponse) -> NDArray:
    """Rough delays in front of up to FEW_PORTS ports: T + T' fitted to the slopes of phases."""
    f, p = response.f, response.ports
    turned = (response.values[1:] * response.values[:-1].conj()).reshape(-1, p * p)
    size = np.abs(turned) + np.finfo(float).tiny if p > 1 else np.ones(turned.shape)
    slope = -(size * np.angle(turned)).sum(0) / (2 * np.pi * np.diff(f) @ size)
    if p == 1:
        return np.array([_rough_delay(response, float(slope[0]) / 2)])
    sums, weight = np.kron(np.eye(p), np.ones((p, 1))) + np.tile(np.eye(p), (p, 1)), np.sqrt(size.sum(0))
    T = np.linalg.lstsq(sums * weight[:, None], slope * weight, rcond=None)[0].clip(0)
    if p > FEW_PORTS or T.max() * f[-1] < 1:
        return np.zeros(p)
    return T / T.max() * _rough_delay(response, T.max(), T / T.max())


def _without(response: SampledResponse, delay: ArrayLike) -> SampledResponse:
    """The samples with delays taken out."""
    turned = np.exp(2j * np.pi * response.f[:, None] * np.broadcast_to(np.asarray(delay), response.ports))
    return replace(response, values=turned[:, :, None] * response.values * turned[:, None, :], rounding=None)


def _misfit_at(response: SampledResponse, delay: ArrayLike, order: int) -> float:
    """Return the error of a fit with `order` poles on a part of the samples, the delay taken out."""
    rest, stride = _without(response, delay), -(-len(response.f) // SCOUTED)
    rest = SampledResponse(rest.f[::stride], rest.values[::stride], Parameter.S)
    model = fit(rest, min(order, len(rest.f) - 2))
    return DelayedModel(delay, model, model, rest).error


def _rough_delay(response: SampledResponse, whole: float, ratio: ArrayLike = 1.0) -> float:
    """Find the delay that a few poles fit best, on a grid down from that of the whole phase; 0 for a short one."""
    step = STEP / response.f[-1]
    grid = whole + step * np.arange(2, 2 - STEPS, -1)
    return min(grid[grid >= step], key=lambda T: _misfit_at(response, T * np.asarray(ratio), SCOUT), default=0.0)


def _fine_delays(response: SampledResponse, order: int, around: ArrayLike) -> NDArray:
    """Find delays to all ports, near given ones, that `order` poles fit best; 0 for short ones.

    Gauss-Newton method: the misfit that neither residues nor moves of these poles explain determines the delays.
    """
    f, ports = response.f[:: -(-len(response.f) // SCOUTED)], response.ports
    w, T = f / f[-1], np.broadcast_to(np.asarray(around, float), ports)
    sparse = replace(response, f=f, values=response.values[:: -(-len(response.f) // SCOUTED)], rounding=None)
    least, best, own = np.inf, T, np.eye(ports)
    for _ in range(MOST_STEPS):
        rest = _without(sparse, T)
        model = fit(rest, min(order, len(f) - 2))
        if (error := DelayedModel(T, model, model, rest).error) < least:
            least, best = error, T
        a = model.poles / (2 * np.pi * f[-1])
        moves = 1 / (1j * w[:, None] - np.concatenate([a, a.conj()])) ** 2
        basis = np.hstack([terms(a, w)[:, :-1], moves[:, : len(a)] + moves[:, len(a) :],
                           1j * (moves[:, : len(a)] - moves[:, len(a) :])])  # fmt: skip
        u, sizes, _ = np.linalg.svd(np.vstack([basis.real, basis.imag]), full_matrices=False)
        u = u[:, sizes > np.finfo(float).eps * len(w) * sizes[0]]
        h = rest.values.reshape(len(w), -1)
        left, turned = (x - u @ (u.T @ x) for x in (np.vstack([y.real, y.imag]) for y in (h, 1j * w[:, None] * h)))
        columns = [(turned * (own[k][:, None] + own[k]).ravel()).ravel() for k in range(ports)]
        step = np.linalg.lstsq(np.stack(columns, 1), -left.ravel(), rcond=SEEN)[0].clip(-FARTHEST_STEP, FARTHEST_STEP)
        T = (T + step / (2 * np.pi * f[-1])).clip(0)
        if np.abs(step).max() < FINE:
            break
    return np.where(best * response.f[-1] < STEP, 0.0, best)
