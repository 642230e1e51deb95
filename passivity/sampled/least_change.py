"""The smallest change that satisfies linear inequalities."""

import numpy as np
from numpy.typing import NDArray

UNSEEN = 1e-8  # weight of a coefficient itself, for what the samples do not see
FARTHEST = 1e6  # times the distance to the farthest half space; where there is no solution it is infinite


def whitening(phi: NDArray[np.complex128]) -> NDArray:
    """R, upper triangular, with |R x| the size of phi x, and a little of x itself.

    Examples
    --------
    >>> np.abs(whitening(np.array([[3.0, 0.0], [0.0, 2.0j]]))).round(9)
    array([[3., 0.],
           [0., 2.]])
    """
    own = UNSEEN * np.diag(np.linalg.norm(phi, axis=0))
    return np.asarray(np.linalg.qr(np.vstack([phi.real, phi.imag, own]), mode="r"))


def least_change(rows: NDArray, bounds: NDArray) -> NDArray | None:
    """The shortest x for which rows x >= bounds; None if there is none.

    Lawson and Hanson's least distance programming: the residual of a least-squares problem with nonnegative unknowns
    points to x.

    Parameters
    ----------
    rows, bounds : ndarray, shape (c, k) and (c,)
        No row is zero; some bound is above zero.

    References
    ----------
    C. L. Lawson, R. J. Hanson, "Solving Least Squares Problems", 1974, chapter 23, DOI 10.1137/1.9781611971217.

    Examples
    --------
    >>> least_change(np.array([[1.0, 1.0], [1.0, 0.0]]), np.array([5.0, 4.0])).round(9)
    array([4., 1.])
    """
    from scipy.optimize import nnls

    g = rows.T
    sizes = np.linalg.norm(g, axis=0)
    farthest = float((bounds / sizes).max())
    spaces, target = np.vstack([g / sizes, bounds / sizes / farthest]), np.append(np.zeros(len(g)), 1.0)
    try:
        residual = spaces @ nnls(spaces, target)[0] - target
    except RuntimeError:  # too many iterations
        return None
    if -residual[-1] * FARTHEST**2 < 1:
        return None
    return -residual[:-1] / residual[-1] * farthest
