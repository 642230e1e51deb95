"""Vector fitting: a rational model with stable poles through samples.

In each round the samples h are approximated by sum c_i/(s - a_i) + d + e s over sigma = sum c'_i/(s - a_i) + d', which
is linear in all c and d once multiplied by sigma; the zeros of sigma are better poles. Unstable ones are reflected.
Several responses share sigma, and so the poles: a QR of each but the last leaves only what it says about sigma.

References
----------
B. Gustavsen, A. Semlyen, "Rational approximation of frequency domain responses by vector fitting", IEEE Transactions on
Power Delivery 14 (1999), 1052-1061, DOI 10.1109/61.772353.
B. Gustavsen, "Improving the pole relocating properties of vector fitting", IEEE Transactions on Power Delivery 21
(2006), 1587-1592, DOI 10.1109/TPWRD.2005.860281 (sigma is held away from 0 by its sum over all samples).
D. Deschrijver, M. Mrozowski, T. Dhaene, D. De Zutter, "Macromodeling of multiport systems using a fast implementation
of the vector fitting method", IEEE Microwave and Wireless Components Letters 18 (2008), 383-385,
DOI 10.1109/LMWC.2008.922585 (several responses).
G. Schwarz, "Estimating the dimension of a model", Annals of Statistics 6 (1978), 461-464, DOI 10.1214/aos/1176344136.
"""

import numpy as np
from numpy.typing import NDArray

from passivity.errors import ExpressionError, shown
from passivity.sampled.enforce import deviation
from passivity.sampled.model import MAX_POLES, PoleResidueModel, terms
from passivity.sampled.response import MAX_SAMPLES, Parameter, SampledResponse

ROUNDS = 10
ORDERS = (1, 2, 4, 6, 8, 12, 16, 24, 32, 40)  # tried if none is given
LOWEST = 1e-12  # of the band; where samples lie lower, poles start here
IN_VAIN = 2  # orders in a row that do not pay, after which no higher is tried
GOOD = 1e-3  # misfit, root mean square, that is good enough
FARTHEST = 1e4  # modulus of a pole, of the highest frequency: beyond, it is like a constant
NARROWEST = 1e-9  # -Re a of a pole, of the highest frequency or of the modulus


def fit(response: SampledResponse, order: int | None = None) -> PoleResidueModel:
    """A rational model with poles in Re s < 0 through samples of one port, not necessarily passive.

    Parameters
    ----------
    response : SampledResponse
        One port, at most MAX_SAMPLES. Z and Y may grow like s, S may not.
    order : int, optional
        Number of poles, both of a pair counted, from 0 to MAX_POLES and to n - 2. By default that of ORDERS which
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
    most = max(min(MAX_POLES, n - 2), 0)
    if response.ports != 1:
        raise ExpressionError("response", "several ports", "one port", f"{response.ports}")
    if n > MAX_SAMPLES or not response.f[-1]:
        raise ExpressionError(
            "response", "cannot be fitted", f"at most {MAX_SAMPLES} samples, not all at f = 0", f"{n}"
        )
    if order is None and n < 3:
        raise ExpressionError("response", "too few samples for a model", "at least 3", f"{n}")
    orders = [k for k in (ORDERS if order is None else (order,)) if isinstance(k, int) and 0 <= k <= most]
    if not orders:
        raise ExpressionError("order", "does not suit the samples", f"0 to {most}", shown(order, repr))
    best, least, in_vain = None, np.inf, 0
    for k in orders:
        model = _fit(response, k)
        misfit = deviation(model.at(2 * np.pi * response.f), response.values[:, 0, 0]).rms
        score = 2 * n * np.log(max(misfit, GOOD) ** 2) + 2 * k * np.log(2 * n)
        if score < least:
            best, least, in_vain = model, score, 0
        elif (in_vain := in_vain + 1) == IN_VAIN:
            break
    assert best is not None
    return best


def _fit(response: SampledResponse, order: int) -> PoleResidueModel:
    """The fit, in units of the highest frequency and of the largest value."""
    unit, size = 2 * np.pi * response.f[-1], np.abs(response.values).max() or 1.0
    w, h = 2 * np.pi * response.f / unit, response.values[:, 0] / size
    grows = response.parameter is not Parameter.S
    poles = poles_of(w, h, order, grows)
    x = solve(terms(poles, w)[:, : order + 1 + grows], h)[:, 0]
    if grows and x[-1] < 0:
        x, grows = solve(terms(poles, w)[:, : order + 1], h)[:, 0], False
    scale = np.array([unit] * order + [1.0] + [1 / unit] * grows) * size
    empty = PoleResidueModel(poles * unit, np.zeros(len(poles)), 0.0, 0.0, response.parameter)
    return empty.with_coefficients(np.append(x * scale, np.zeros(1 - grows)))


def poles_of(w: NDArray, h: NDArray[np.complex128], order: int, grows: bool = False) -> NDArray:
    """Poles in Re s < 0 that responses have in common, one of each pair.

    Parameters
    ----------
    w : ndarray, shape (n,)
        Angular frequencies, in units of the highest.
    h : ndarray, shape (n, k)
        Samples of k responses, of the size of 1.
    order : int
        Number of poles, both of a pair counted, at most n - 2.
    grows : bool
        Whether responses may grow like s.
    """
    poles = _first_poles(w, order)
    for _ in range(ROUNDS if order else 0):
        poles = _relocated(w, h, poles, grows)
    return poles


def _first_poles(w: NDArray, order: int) -> NDArray:
    """Narrow pairs over the whole band, and a real pole if the order is odd."""
    low = max(float(w[w > 0].min()), LOWEST)
    spread = np.geomspace if low < 1e-2 else np.linspace
    im = spread(low, 1.0, order // 2)
    return np.append(-im / 100 + 1j * im, [-1.0] * (order % 2))


def _relocated(w: NDArray, h: NDArray, poles: NDArray, grows: bool) -> NDArray:
    """The zeros of sigma, reflected into the left half plane."""
    phi = terms(poles, w)
    order = phi.shape[1] - 2
    above, below = phi[:, : order + 1 + grows], phi[:, : order + 1]
    own, weight = above.shape[1], float(np.linalg.norm(h)) / len(h)
    *others, last = (np.hstack([above, -values[:, None] * below]) for values in h.T)
    rows = [np.linalg.qr(_real(each), mode="r")[own:] for each in others]  # without what is their own
    held = np.concatenate([np.zeros(own), below.real.sum(0)]) * weight
    target = np.append(np.zeros(len(h), complex), weight * len(h))
    target = np.append(target, np.zeros(sum(map(len, rows))))
    x = solve(np.vstack([last, held, *rows]).astype(complex), target[:, None])[:, 0]
    c, d = x[-order - 1 : -1], x[-1]
    matrix, column, k = np.zeros((order, order)), np.zeros(order), 0
    for a in poles:
        width = 1 + (a.imag > 0)
        matrix[k : k + width, k : k + width] = [[a.real, a.imag], [-a.imag, a.real]] if width == 2 else a.real
        column[k] = width
        k += width
    zeros = np.linalg.eigvals(matrix - np.outer(column, c) / (d if abs(d) > 1e-8 else 1e-8))
    zeros = zeros[zeros.imag >= 0]
    zeros /= np.maximum(np.abs(zeros) / FARTHEST, 1)
    return -np.maximum(np.abs(zeros.real), NARROWEST * np.maximum(np.abs(zeros), 1)) + 1j * zeros.imag


def solve(matrix: NDArray[np.complex128], target: NDArray[np.complex128]) -> NDArray:
    """Real least-squares solutions of complex equations, one for each column of the target; columns of one size."""
    a, b, n = _real(matrix), _real(target), matrix.shape[1]
    sizes = np.linalg.norm(a, axis=0)
    sizes[sizes == 0] = 1.0
    r = np.asarray(np.linalg.qr(np.column_stack([a / sizes, b]), mode="r"))  # all that matters of many rows
    return np.linalg.lstsq(r[:, :n], r[:, n:], rcond=None)[0] / sizes[:, None]


def _real(matrix: NDArray[np.complex128]) -> NDArray:
    return np.vstack([matrix.real, matrix.imag])
