"""Linear motion over any stretch of time, by doubling: a short step from the power series, then twice as far each time.

Of z' = F z the motion is z(t + h) = z(t) + D(h) z(t), and D(2h) = 2 D(h) + D(h)^2. The integral of a quadratic form
z'Q z over the stretch is z'G z with G(2h) = G(h) + M'G(h) M, M = 1 + D(h). All in floats: rounding grows with the
number of doublings, and how far is seen by doing the same with one more.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

TERMS, NODES, SHORT = 16, 6, 0.25  # of the power series, of Gauss's quadrature; first step over the shortest time
MOST_DOUBLINGS = 60
SHARE, WEIGHT = np.polynomial.legendre.leggauss(NODES)


class Motion(NamedTuple):
    """Over some lengths of time.

    Attributes
    ----------
    change : numpy.ndarray
        D of each length, shape (lengths, n, n).
    integrals : numpy.ndarray
        G of each form and length, shape (forms, lengths, n, n).
    """

    change: NDArray[np.float64]
    integrals: NDArray[np.float64]


def motion(f: NDArray, forms: Sequence[NDArray], lengths: Sequence[float], more: int = 0) -> Motion | None:
    """The motion of z' = f z, by some doublings more than it takes; None where that would be too many.

    Examples
    --------
    >>> decay = motion(np.array([[-2.0]]), [np.array([[4.0]])], [50.0])
    >>> float(decay.change[0, 0, 0]), round(float(decay.integrals[0, 0, 0, 0]), 12)
    (-1.0, 1.0)
    """
    spans = np.abs(np.linalg.eigvals(f)).max() * max(lengths) / SHORT
    if not spans < 2.0**MOST_DOUBLINGS:
        return None
    doublings = more + int(np.ceil(np.log2(max(spans, 1.0))))
    short = np.array(lengths) / 2.0**doublings
    at = np.append((1 + SHARE) / 2, 1.0)[:, None] * short
    step, unit = f * at[..., None, None], np.eye(len(f))
    change = step / TERMS
    for k in range(TERMS - 1, 0, -1):
        change = step @ (unit + change) / k
    moved = unit + change[:-1]
    inside = np.swapaxes(moved, -1, -2) @ np.array(forms)[:, None, None] @ moved
    integrals, d = np.einsum("flnij,f->lnij", np.swapaxes(inside, 0, 1), WEIGHT / 2) * short[:, None, None], change[-1]
    for _ in range(doublings):
        moved = unit + d
        integrals, d = integrals + np.swapaxes(moved, -1, -2) @ integrals @ moved, 2 * d + d @ d
    return Motion(d, integrals)
