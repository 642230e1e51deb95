"""A rational model with stable poles through the samples of one port; of one order, or of the order that pays.

References
----------
G. Schwarz, "Estimating the dimension of a model", Annals of Statistics 6 (1978), 461-464, DOI 10.1214/aos/1176344136.
The poles: see `passivity.sampled.poles`.
"""

from collections.abc import Iterable, Iterator

import numpy as np

from passivity.errors import ExpressionError, shown
from passivity.sampled.enforce import deviation
from passivity.sampled.model import MAX_POLES, PoleResidueModel
from passivity.sampled.poles import FRESH, coefficients, count, poles_of
from passivity.sampled.response import MAX_SAMPLES, Parameter, SampledResponse

ORDERS = (1, 2, 4, 6, 8, 12, 16, 24, 32, 40)  # tried if none is given
MANY = (*ORDERS, 50, 60, 80, 100, 130, 160, 200)  # on the way to an order that is given
IN_VAIN = 2  # orders in a row that do not pay, after which no higher is tried
GOOD = 1e-3  # misfit, root mean square, that is good enough


def fit(response: SampledResponse, order: int | None = None) -> PoleResidueModel:
    """A rational model with poles in Re s < 0 through samples of one port, not necessarily passive.

    Parameters
    ----------
    response : SampledResponse
        One port, at most MAX_SAMPLES. Z and Y may grow like s, S may not.
    order : int, optional
        Number of poles, both of a pair counted, from 0 to 200 and to n - 2. By default that of ORDERS which
        Schwarz's criterion prefers: a further pole must pay for itself, so noise is not fitted.

    Raises
    ------
    ExpressionError
        If there are several ports, or too few samples for the order or for any.

    Examples
    --------
    >>> f = np.linspace(1, 100, 40)
    >>> model = fit(SampledResponse(f, 5 + 1 / (0.01 + 2j * np.pi * f * 1e-3), "Z"), order=1)
    >>> model.poles.round(6), round(model.constant, 6)
    (array([-10.+0.j]), 5.0)
    """
    n = len(response.f)
    most = max(min(2 * MAX_POLES, n - 2), 0)
    if response.ports != 1:
        raise ExpressionError("response", "several ports", "one port", f"{response.ports}")
    if n > MAX_SAMPLES or not response.f[-1]:
        raise ExpressionError(
            "response", "cannot be fitted", f"at most {MAX_SAMPLES} samples, not all at f = 0", f"{n}"
        )
    if order is None and n < 3:
        raise ExpressionError("response", "too few samples for a model", "at least 3", f"{n}")
    if order is not None:
        if not isinstance(order, int) or not 0 <= order <= most:
            raise ExpressionError("order", "does not suit the samples", f"0 to {most}", shown(order, repr))
        *_, model = fits(response, up_to(order))
        return model
    best, least, in_vain = None, np.inf, 0
    for model in fits(response, [k for k in ORDERS if k <= most]):
        misfit = deviation(model.at(2 * np.pi * response.f), response.values[:, 0, 0]).rms
        score = 2 * n * np.log(max(misfit, GOOD) ** 2) + 2 * count(model.poles) * np.log(2 * n)
        if score < least:
            best, least, in_vain = model, score, 0
        elif (in_vain := in_vain + 1) == IN_VAIN:
            break
    assert best is not None
    return best


def up_to(order: int) -> tuple[int, ...]:
    """Orders on the way to one for which poles cannot begin anywhere, and that one."""
    return *(k for k in MANY if FRESH <= k < order), order


def fits(response: SampledResponse, orders: Iterable[int]) -> Iterator[PoleResidueModel]:
    """Models of rising orders, each beginning where the one before ended; in units of the highest frequency inside."""
    unit, size = 2 * np.pi * response.f[-1], np.abs(response.values).max() or 1.0
    w, h = 2 * np.pi * response.f / unit, response.values[:, 0] / size
    may_grow = response.parameter is not Parameter.S
    for poles in poles_of(w, h, orders, may_grow):
        grows = may_grow
        x = coefficients(poles, w, h, grows)[:, 0]
        if grows and x[-1] < 0:
            x, grows = coefficients(poles, w, h)[:, 0], False
        scale = np.array([unit] * count(poles) + [1.0] + [1 / unit] * grows) * size
        empty = PoleResidueModel(poles * unit, np.zeros(len(poles)), 0.0, 0.0, response.parameter)
        yield empty.with_coefficients(np.append(x * scale, np.zeros(1 - grows)))
