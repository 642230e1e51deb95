"""Measured networks with several ports: common poles through samples of S, proved passive or scaled until they are."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from passivity.errors import ExpressionError
from passivity.multiport.axis_analysis import AxisAnalysis, analyse
from passivity.multiport.matrix import RationalMatrix
from passivity.multiport.positive_real import check_bounded_real_matrix
from passivity.multiport.state_space import StateSpace
from passivity.multiport.verdict import MatrixVerdict
from passivity.sampled.behind_delay import ORDERS
from passivity.sampled.check import check_samples
from passivity.sampled.matrix_model import MatrixModel, fit_matrix
from passivity.sampled.response import Parameter, SampledResponse
from passivity.status import Kind, Status


@dataclass(frozen=True, eq=False)
class MeasuredNetwork:
    """A model of samples of S, and how well it meets them.

    Parameters
    ----------
    model : MatrixModel
        S of the samples' reference resistances.
    samples : SampledResponse
        Delays taken out.
    gamma : float
        By which the fit was divided to be passive, >= 1.
    """

    model: MatrixModel
    samples: SampledResponse
    gamma: float = 1.0

    @cached_property
    def verdict(self) -> MatrixVerdict:
        """Exact, of `model`. Passive if and only if it is `PROVED`."""
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
        Divide a fit that is not passive by its largest singular value over all frequencies, if it meets the samples
        then. Otherwise the fit comes back as it is, with the verdict that refutes it, or says that it takes too long.
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
    orders = [k for k in ORDERS if k <= len(response.f) - 2]
    least, fewest = math.inf, 0
    for order in orders:
        found = MeasuredNetwork(fit_matrix(response, order), response)
        if found.error <= tolerance and nearest and found.verdict.status is Status.REFUTED:
            found = _scaled(found)
        if found.error <= tolerance:
            return found
        if found.error < least:
            least, fewest = found.error, order
    problem = f"no {'passive ' * nearest}model of up to {orders[-1]} poles is that near to the samples"
    raise ExpressionError("tolerance", problem, f"at least {least:.3g}, which {fewest} poles reach", f"{tolerance:g}")


def _scaled(found: MeasuredNetwork) -> MeasuredNetwork:
    """S/gamma, with gamma just above the largest singular value."""
    gamma = found.seen.value + found.seen.value_error
    return MeasuredNetwork(found.model.over(gamma), found.samples, gamma)
