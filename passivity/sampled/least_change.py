"""The smallest vector that satisfies linear inequalities."""

import numpy as np
from numpy.typing import NDArray

FARTHEST = 1e6  # times the distance to the farthest half space; where there is no solution it is infinite


def least_change(measure: NDArray, rows: NDArray, bounds: NDArray) -> NDArray | None:
    """The x with the smallest ||measure x|| for which rows x >= bounds; None if there is none.

    Lawson and Hanson's least distance programming: with y = R x, the residual of a least-squares problem with
    nonnegative unknowns points to y.

    Parameters
    ----------
    measure : ndarray, shape (n, k)
        Of rank k.
    rows, bounds : ndarray, shape (c, k) and (c,)
        No row is zero; some bound is above zero.

    References
    ----------
    C. L. Lawson, R. J. Hanson, "Solving Least Squares Problems", 1974, chapter 23, DOI 10.1137/1.9781611971217.

    Examples
    --------
    >>> least_change(np.diag([1.0, 2.0]), np.array([[1.0, 1.0], [1.0, 0.0]]), np.array([5.0, -1.0])).round(9)
    array([4., 1.])
    """
    from scipy.linalg import solve_triangular
    from scipy.optimize import nnls

    r = np.linalg.qr(measure, mode="r")
    g = solve_triangular(r, rows.T, trans=1)  # of y, one column for each row
    sizes = np.linalg.norm(g, axis=0)
    farthest = float((bounds / sizes).max())
    spaces, target = np.vstack([g / sizes, bounds / sizes / farthest]), np.append(np.zeros(len(g)), 1.0)
    try:
        residual = spaces @ nnls(spaces, target)[0] - target
    except RuntimeError:  # too many iterations
        return None
    if -residual[-1] * FARTHEST**2 < 1:
        return None
    return solve_triangular(r, -residual[:-1] / residual[-1] * farthest)
