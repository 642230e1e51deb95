"""Rational interpolation of a law on the imaginary axis, which comes out passive.

(F(s) - F(0))/s - F∞ = ∫ dm(p)/(s + p) with a positive measure m. The sum of n such terms that agrees with it at n
points and their conjugates is a Gauss quadrature of that integral: its p_k lie where m does, and its weights are
positive.

References
----------
A. A. Gonchar, G. Lopez Lagomasino, Mathematics of the USSR-Sbornik 34 (1978) 449-459,
doi:10.1070/SM1978v034n04ABEH001219: multipoint Padé approximants of Markov functions. A. J. Mayo, A. C. Antoulas,
Linear Algebra and its Applications 425 (2007) 634-662, doi:10.1016/j.laa.2007.03.008: poles from the Loewner pencil.
"""

import numpy as np
from numpy.typing import NDArray

from tline.loss.arithmetic import BALLS
from tline.loss.law import Law

BITS = 320  # the pencil loses as many digits as the interpolation gains, twice


def interpolate(law: Law, w: NDArray) -> tuple[NDArray, NDArray]:
    """Strengths r_k and rates p_k of loss + s·storage + Σ r_k s/(s + p_k) = F(s) at s = ±j w.

    Parameters
    ----------
    law : Law
    w : ndarray of float, shape (n,)
        Points, rad/s, above 0, all different.

    Returns
    -------
    r, p : ndarray of float, shape (n,)
        In ascending order of p; positive but for rounding.

    Examples
    --------
    >>> from tline.loss import Foster
    >>> r, p = interpolate(Foster(1, 0, [2, 3], [10, 20]), np.array([1.0, 7.0]))
    >>> r.round(12).tolist(), p.round(12).tolist()
    ([2.0, 3.0], [10.0, 20.0])
    """
    from flint import acb, acb_mat, ctx

    n = len(w)
    with ctx.workprec(BITS):
        s = [acb(0, x) for x in w.tolist()]
        h = [(law.beyond(x, BALLS).mid() - law.loss) / x for x in s]
        both = [
            (a, b.conjugate(), f, g.conjugate()) for a, f in zip(s, h, strict=True) for b, g in zip(s, h, strict=True)
        ]
        loewner = acb_mat(n, n, [(f - g) / (a - b) for a, b, f, g in both])
        shifted = acb_mat(n, n, [(a * f - b * g) / (a - b) for a, b, f, g in both])
        poles = loewner.solve(shifted, algorithm="approx").eig(algorithm="approx")
        p = sorted((-pole.real.mid() for pole in poles), key=float)
        cauchy = acb_mat(n, n, [1 / (x + q) for x in s for q in p])
        r = cauchy.solve(acb_mat(n, 1, h), algorithm="approx")
        strengths = [float(x.real.mid()) for x in r.entries()]
        return np.array(strengths), np.array([float(q) for q in p])
