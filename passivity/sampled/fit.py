"""Vector fitting: rational models with poles in Re s < 0 that responses have in common.

In each round the samples h are approximated by sum c_i/(s - a_i) + d + e s over sigma = sum c'_i/(s - a_i) + d', which
is linear in all c and d once multiplied by sigma; the zeros of sigma are better poles. Unstable ones are reflected.
Several responses share sigma, and so the poles: a QR of each but the last keeps only its equations for sigma.

Few poles are begun anywhere. Many are not: a fit of 60 from poles spread over the band is still far off after ten
rounds. They begin with those found for a lower order, and with new ones where the misfit is.

References
----------
B. Gustavsen, A. Semlyen, "Rational approximation of frequency domain responses by vector fitting", IEEE Transactions on
Power Delivery 14 (1999), 1052-1061, DOI 10.1109/61.772353.
B. Gustavsen, "Improving the pole relocating properties of vector fitting", IEEE Transactions on Power Delivery 21
(2006), 1587-1592, DOI 10.1109/TPWRD.2005.860281 (sigma is held away from 0 by its sum over all samples).
D. Deschrijver, M. Mrozowski, T. Dhaene, D. De Zutter, "Macromodeling of multiport systems using a fast implementation
of the vector fitting method", IEEE Microwave and Wireless Components Letters 18 (2008), 383-385,
DOI 10.1109/LMWC.2008.922585 (several responses).
S. Grivet-Talocia, M. Bandinu, "Improving the convergence of vector fitting for equivalent circuit extraction from noisy
frequency responses", IEEE Transactions on Electromagnetic Compatibility 48 (2006), 104-120,
DOI 10.1109/TEMC.2006.870814 (poles are added where the misfit is).
G. Schwarz, "Estimating the dimension of a model", Annals of Statistics 6 (1978), 461-464, DOI 10.1214/aos/1176344136.
"""

import math
from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

from passivity.errors import ExpressionError, shown
from passivity.sampled.enforce import deviation
from passivity.sampled.model import PoleResidueModel, count, terms
from passivity.sampled.response import MAX_SAMPLES, Parameter, SampledResponse
from tline.errors import check_kind

ROUNDS = 10
FRESH = 8  # poles up to which each order begins anew
MORE_ROUNDS = 5  # for orders that begin with the poles of a lower one
ENOUGH = 6  # samples for each pole, and a hundred, with which the poles of high orders are looked for
HUNDRED = 100
EVENLY = 0.05  # part of the new poles that is spread evenly, wherever the misfit is
LOWEST = 1e-12  # of the band; where samples lie lower, poles start here
FARTHEST = 1e4  # modulus of a pole, of the highest frequency: beyond, it is like a constant
NARROWEST = 1e-9  # -Re a of a pole, of the highest frequency or of the modulus
ORDERS = (1, 2, 4, 6, 8, 12, 16, 24, 32, 40)  # tried if none is given
ON_THE_WAY = (*ORDERS, 50, 60, 80, 100, 130, 160, 200)  # to an order that is given
IN_VAIN = 2  # orders in a row that do not pay, after which no higher is tried
GOOD = 1e-3  # misfit, root mean square, that is good enough
MEETING = (0, 1, 2, 4, 6, 8, 10, 12, 16, 20, 24, 32, 40, 50, 60, 80, 100, 130, 160, 200)  # to meet a tolerance
MANY = 40  # poles from which on more must pay
WHITE = 0.5  # correlation of the misfits at neighbouring frequencies below which they are noise
PAYS = 0.8  # of the least error: an order with less pays
MOST_IN_VAIN = 3  # orders that do not pay, after which no higher is tried


def poles_of(w: NDArray, h: NDArray[np.complex128], orders: Iterable[int], grows: bool = False) -> Iterator[NDArray]:
    """For each order in turn, poles in Re s < 0 that responses have in common, one of each pair.

    Frequencies w (n,) are in units of the highest, samples h (n, k) of k responses of the size of 1; they may grow like
    s or not. Orders are numbers of poles, both of a pair counted, rising, at most n - 2.
    """
    poles: NDArray[np.complex128] = np.zeros(0, complex)
    for order in orders:
        more = order - count(poles)
        if order <= FRESH:
            poles = _first_poles(w, order)
            for _ in range(ROUNDS if order else 0):
                poles = _relocated(w, h, poles, grows)
        elif more > 0:
            poles = _grown(poles, w, misfit(poles, w, h, grows), more)
            stride = max(len(w) // (ENOUGH * order + HUNDRED), 1)
            poles = _settled(w[::stride], h[::stride], poles, grows)
        yield poles


def coefficients(poles: NDArray[np.complex128], w: NDArray, h: NDArray[np.complex128], grows: bool = False) -> NDArray:
    """Solve for residues and constant, and for the factor of s if the responses grow, one column for each response."""
    return solve(terms(poles, w)[:, : count(poles) + 1 + grows], h)


def misfit(poles: NDArray[np.complex128], w: NDArray, h: NDArray[np.complex128], grows: bool = False) -> NDArray:
    """Largest distance of a response from the best sum of these fractions, at each frequency."""
    x = coefficients(poles, w, h, grows)
    return np.abs(terms(poles, w)[:, : len(x)] @ x - h).max(1)


def _first_poles(w: NDArray, order: int) -> NDArray:
    """Narrow pairs over the whole band, and a real pole if the order is odd."""
    low = max(float(w[w > 0].min()), LOWEST)
    spread = np.geomspace if low < 1e-2 else np.linspace
    im = spread(low, 1.0, order // 2)
    return np.append(-im / 100 + 1j * im, [-1.0] * (order % 2))


def _grown(poles: NDArray, w: NDArray, misfit: NDArray, more: int) -> NDArray:
    """Add `more` poles: narrow pairs at equal shares of the squared misfit, and a real pole if the number is odd."""
    power = misfit**2 + EVENLY * (misfit**2).mean() + np.finfo(float).tiny
    share = np.cumsum(power / power.sum())
    im = np.interp((np.arange(more // 2) + 0.5) / max(more // 2, 1), share, np.maximum(w, LOWEST))
    return np.concatenate([poles, -im / 100 + 1j * im, [-1.0] * (more % 2)])


def _settled(w: NDArray, h: NDArray, poles: NDArray, grows: bool) -> NDArray:
    """Return the best poles of some rounds."""
    least, best = np.inf, poles
    for _ in range(MORE_ROUNDS):
        poles = _relocated(w, h, poles, grows)
        if (off := misfit(poles, w, h, grows).max()) < least:
            least, best = off, poles
    return best


def _relocated(w: NDArray, h: NDArray, poles: NDArray, grows: bool) -> NDArray:
    """The zeros of sigma, reflected into the left half plane."""
    phi = terms(poles, w)
    order = phi.shape[1] - 2
    above, below = phi[:, : order + 1 + grows], phi[:, : order + 1]
    own, weight = above.shape[1], float(np.linalg.norm(h)) / len(h)
    *others, last = (np.hstack([above, -values[:, None] * below]) for values in h.T)
    rows = [np.linalg.qr(_real(each), mode="r")[own:] for each in others]  # own unknowns eliminated
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


def fit(response: SampledResponse, order: int | None = None) -> PoleResidueModel:
    """A rational model with poles in Re s < 0 through samples, common to all entries, not necessarily passive.

    Parameters
    ----------
    response : SampledResponse
        At most MAX_SAMPLES; of one port it becomes a function, of several a matrix. Z and Y may grow like s, S may not.
    order : int, optional
        Number of poles, both of a pair counted, from 0 to 200 and to n - 2. By default that of ORDERS which
        Schwarz's criterion prefers: a further pole must pay for itself, so noise is not fitted.

    Raises
    ------
    ExpressionError
        If there are too few samples for the order or for any.

    Examples
    --------
    >>> f = np.linspace(1, 100, 40)
    >>> model = fit(SampledResponse(f, 5 + 1 / (0.01 + 2j * np.pi * f * 1e-3), "Z"), order=1)
    >>> model.poles.round(6), round(model.constant, 6)
    (array([-10.+0.j]), 5.0)
    """
    check_kind("response", response, SampledResponse)
    n, size = len(response.f), response.ports**2
    most = max(min(MEETING[-1], n - 2), 0)
    if n > MAX_SAMPLES or not response.f[-1]:
        expected = f"at most {MAX_SAMPLES} samples, not all at f = 0"
        raise ExpressionError("response", "cannot be fitted", expected, f"{n}")
    if order is None and n < 3:
        raise ExpressionError("response", "too few samples for a model", "at least 3", f"{n}")
    if order is not None:
        if not isinstance(order, int) or not 0 <= order <= most:
            raise ExpressionError("order", "does not suit the samples", f"0 to {most}", shown(order, repr))
        *_, model = fits(response, (*(k for k in ON_THE_WAY if FRESH <= k < order), order))
        return model
    best, least, in_vain = None, np.inf, 0
    for model in fits(response, [k for k in ORDERS if k <= most]):
        misfit = deviation(model.matrices(2 * np.pi * response.f), response.values).rms
        score = 2 * n * size * np.log(max(misfit, GOOD) ** 2) + (1 + size) * model.order * np.log(2 * n * size)
        if score < least:
            best, least, in_vain = model, score, 0
        elif (in_vain := in_vain + 1) == IN_VAIN:
            break
    assert best is not None
    return best


def fits(response: SampledResponse, orders: Iterable[int]) -> Iterator[PoleResidueModel]:
    """Models of rising orders, each beginning where the one before ended; in units of the highest frequency inside."""
    n, p, may_grow = len(response.f), response.ports, response.parameter is not Parameter.S
    unit, size = 2 * np.pi * response.f[-1], float(np.abs(response.values).max()) or 1.0
    w, h = 2 * np.pi * response.f / unit, response.values.reshape(n, -1) / size
    reciprocal = (response.values == response.values.swapaxes(1, 2)).all()
    distinct = np.flatnonzero(np.triu(np.ones((p, p)))) if reciprocal else slice(None)
    for poles in poles_of(w, h[:, distinct], orders, may_grow):
        x = coefficients(poles, w, h, may_grow)
        if may_grow and not (reciprocal and np.linalg.eigvalsh(x[-1].reshape(p, p))[0] >= 0):
            x = np.vstack([coefficients(poles, w, h), np.zeros(p * p)])
        elif not may_grow:
            x = np.vstack([x, np.zeros(p * p)])
        x = x * np.array([unit] * count(poles) + [1.0, 1 / unit])[:, None] * size
        shape = (p, p) if p > 1 else ()
        empty = PoleResidueModel(poles * unit, np.zeros((len(poles), *shape)), np.zeros(shape), 0, response.parameter)
        yield empty.with_coefficients(x.reshape(-1, *shape))


class Reached:
    """The least error so far, and whether more poles still pay."""

    def __init__(self):
        self.error, self.fewest, self.most, self.in_vain = math.inf, 0, 0, 0

    def is_enough(self, error: float, order: int, fits: bool = False, noise: bool = True) -> bool:
        """Take note of a model, or of the passive one near one that fits; whether no more poles are worth trying.

        The rest of a delay stays as it is for many orders, until there are poles for all its turns: it is not noise.
        """
        pays = error < PAYS * self.error
        self.most = max(self.most, order)
        if error < self.error:
            self.error, self.fewest = error, order
        self.in_vain = 0 if pays else self.in_vain + (fits or (order >= MANY and noise))
        return self.in_vain == MOST_IN_VAIN

    def refusal(self, tolerance: float, passive: bool, otherwise: str = "") -> ExpressionError:
        """Return the error that no model is near enough, with the least error reached."""
        problem = f"no {'passive ' * passive}model of up to {self.most} poles is that near to the samples"
        expected = f"at least {self.error:.3g}, which {self.fewest} poles reach{otherwise}"
        return ExpressionError("tolerance", problem, expected, f"{tolerance:g}")
