"""Measured networks with several ports: common poles through samples of S, proved passive or changed until they are."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from passivity.errors import ExpressionError
from passivity.multiport.axis_analysis import AxisAnalysis, analyse
from passivity.multiport.matrix import RationalMatrix
from passivity.multiport.positive_real import check_bounded_real_matrix
from passivity.multiport.refutation import refuted_or_undecided
from passivity.multiport.state_space import MAX_STATES, StateSpace
from passivity.multiport.strict_storage import strict_storage
from passivity.multiport.verdict import MatrixVerdict, StrictCertificate
from passivity.sampled.check import check_samples
from passivity.sampled.enforce_matrix import nearest_passive
from passivity.sampled.matrix_model import MatrixModel, matrix_fits
from passivity.sampled.orders import ORDERS, Reached
from passivity.sampled.response import Parameter, SampledResponse
from passivity.status import Kind, Status

FEW = 4  # ports up to which the exact test takes seconds
SPARE = 0.1  # of the tolerance, for a storage function
LOOKS = 4  # at a model for where it is not passive
BARELY = 1 + 1e-6  # a singular value up to which the whole of S is made smaller


@dataclass(frozen=True, eq=False)
class MeasuredNetwork:
    """A model of samples of S, and how well it meets them.

    Parameters
    ----------
    model : MatrixModel
        S of the samples' reference resistances.
    samples : SampledResponse
        Delays taken out.
    original : MatrixModel
        The fit, if `model` is a passive one near it; else the same.
    """

    model: MatrixModel
    samples: SampledResponse
    original: MatrixModel

    @cached_property
    def verdict(self) -> MatrixVerdict:
        """Exact, of `model`. Passive if and only if it is `PROVED`."""
        if self.samples.ports > FEW:
            return _by_storage(StateSpace.from_entries(*(x.tolist() for x in self.model.realised())))
        ports = range(self.samples.ports)
        return check_bounded_real_matrix(
            RationalMatrix(tuple(tuple(self.model.entry(i, k).rational() for k in ports) for i in ports))
        )

    @cached_property
    def seen(self) -> AxisAnalysis:
        """Largest singular value of S over all frequencies, and bands where it is above 1, in floating point."""
        from passivity.multiport.float_system import FloatSystem

        A, B, C, D = self.model.realised()
        if not len(A):  # a state that does nothing
            A, B, C = -np.eye(1), np.zeros((1, len(D))), np.zeros((len(D), 1))
        return analyse(FloatSystem.of(Kind.BR, StateSpace.from_entries(*(x.tolist() for x in (A, B, C, D)))))

    @property
    def error(self) -> float:
        """Largest |dS| of an entry at the samples."""
        return float(np.abs(self.model.at(2 * np.pi * self.samples.f) - self.samples.values).max())

    @property
    def cost(self) -> float:
        """How far being passive moved an entry at a sample, at most."""
        w = 2 * np.pi * self.samples.f
        return float(np.abs(self.model.at(w) - self.original.at(w)).max())

    @property
    def why(self) -> str:
        """Why it is passive, or where it is not."""
        if self.verdict.status is not Status.REFUTED:
            return self.verdict.why
        beyond, w = self.seen.value - 1, self.seen.frequency
        near = [band for band in self.seen.bands if band[0] <= w <= band[1]]
        if not near:
            return f"S has a singular value above 1 by no more than rounding, at or near {w / (2 * np.pi):.4g} Hz"
        low, high = (edge / (2 * np.pi) for edge in near[0])
        band = f"from {low:.4g} Hz to {high:.4g} Hz" if high < np.inf else f"above {low:.4g} Hz"
        where = f"at {w / (2 * np.pi):.4g} Hz" if w < np.inf else "towards infinity"
        return f"S has a singular value above 1 {band}, by up to {beyond:.3g} {where}"


def fit_scattering(
    response: SampledResponse, tolerance: float, nearest: bool = False, delays: ArrayLike = 0.0
) -> MeasuredNetwork:
    """The model of fewest poles, common to all entries, that meets samples of S.

    Parameters
    ----------
    response : SampledResponse
        S, at least 3 samples; reciprocal or not.
    tolerance : float
        Largest |dS| of an entry at a sample, above 0.
    nearest : bool
        Take the nearest passive model in place of a fit that is not passive, if it meets the samples too. Otherwise
        the fit comes back as it is, with the verdict that refutes it.
    delays : float or array_like, shape (p,)
        Time to each port, one way, s, >= 0, taken out of the samples first.

    Raises
    ------
    ExpressionError
        These are no such samples, or no order meets them: says what was reached.

    Examples
    --------
    >>> f = np.linspace(0, 1, 50)
    >>> S = np.array([[0, 0.8], [0.6, 0]]) / (1 + 2j * np.pi * f)[:, None, None]
    >>> found = fit_scattering(SampledResponse(f, S, "S"), 1e-9)
    >>> found.model.order, str(found.verdict.status)
    (1, 'proved')
    """
    if response.parameter is not Parameter.S:
        raise ExpressionError("samples", "not a scattering matrix", "S", response.parameter.value)
    if len(response.f) < 3:
        raise ExpressionError("samples", "too few for a model", "at least 3", f"{len(response.f)}")
    check_samples(response).refuse_beyond(tolerance * response.ports, "network")
    turned = np.exp(2j * np.pi * response.f[:, None] * np.broadcast_to(delays, response.ports))
    values = turned[:, :, None] * response.values * turned[:, None, :]
    response = SampledResponse(response.f, values, Parameter.S, response.z0)
    most = MAX_STATES // response.ports if response.ports > FEW else max(ORDERS)
    orders = [k for k in ORDERS if k <= min(most, len(response.f) - 2)]
    reached = Reached()
    for model in matrix_fits(response, orders):
        found = MeasuredNetwork(model, response, model)
        error = found.error
        if error <= tolerance and nearest and found.verdict.status is not Status.PROVED:
            found = _nearest(found, tolerance)
        if found.error <= tolerance and (not nearest or found.verdict.status is Status.PROVED):
            return found
        if reached.is_enough(found.error, model.order, fits=error <= tolerance):
            break
    raise reached.refusal(tolerance, nearest)


def _by_storage(system: StateSpace) -> MatrixVerdict:
    """The verdict of a storage function, or of a point where there can be none."""
    if storage := strict_storage(system):
        return MatrixVerdict(Kind.BR, system, Status.PROVED, StrictCertificate(system, storage))
    return refuted_or_undecided(Kind.BR, system, "no storage function was found")


def _nearest(found: MeasuredNetwork, tolerance: float) -> MeasuredNetwork:
    """The nearest passive model; where S is hardly beyond its bound, a little less of it all.

    The exact test needs nothing to spare, a storage function does.
    """
    w, seen, near = 2 * np.pi * found.samples.f, np.zeros(0), found
    spare = SPARE * tolerance if found.samples.ports > FEW else 0.0
    for _ in range(LOOKS):
        analysis = near.seen
        size = analysis.value + analysis.value_error
        if size < max(BARELY, 1 + spare):
            return MeasuredNetwork(near.model.over(max(size, 1.0) + spare), found.samples, found.original)
        edges = np.array([analysis.frequency, *np.ravel(analysis.bands)])
        seen = np.concatenate([seen, edges[np.isfinite(edges)]])
        near = MeasuredNetwork(nearest_passive(found.model, w, seen), found.samples, found.original)
        if near.verdict.status is Status.PROVED:
            break
    return near
