"""Whether a line by convolution quadrature can create energy.

Where a delay is what Radau makes of exp(-sT) it cannot. The scattering S of the line is analytic, and at most 1, where
Re s > 0; the numerical range of D(ζ) lies there for |ζ| < 1, in the norm of the weights of Radau's quadrature; so
‖S(D)‖ <= 1, by von Neumann's inequality. Where whole slabs of the delay are moved as they are, ζ^m stands for a part of
exp(-sT), and the norm is looked at.

References
----------
J. von Neumann, Math. Nachr. 4 (1951) 258-281, doi:10.1002/mana.3210040124.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from tline.loss import LossyLine
from tline.solver.convolution.quadrature import derivative
from tline.solver.radau import Basis, basis
from tline.solver.stability.lossy_line import carried

SLOWEST, PLACES = 1e-6, 400  # cycles per slab, and from there to a half


def gain(line: LossyLine, z0: float, order: Basis, h: float, slabs: float) -> float:
    """The largest norm of the scattering of a line, at places all round the circle |ζ| = 1.

    Parameters
    ----------
    line : LossyLine
    z0 : float
        Of a front.
    order : Basis
    h : float
        Slab, s.
    slabs : float
        Whole ones, of the delay, that move waves as they are.
    """
    rates, late, vectors, inverse = _circle(order.s)
    across, back = carried(line, z0, rates.ravel() / h, slabs * late.ravel())
    modes = ((across + sign * back).reshape(-1, 1, order.s) for sign in (1, -1))  # of equal and opposite waves
    return max(float(np.linalg.norm((vectors * mode) @ inverse, 2, axis=(1, 2)).max()) for mode in modes)


@lru_cache
def _circle(s: int) -> tuple[NDArray, NDArray, NDArray, NDArray]:
    """Eigenvalues of D, what a slab's delay is beyond them, and eigenvectors with their inverse, in that norm."""
    order = basis(s)
    zeta = np.exp(-2j * np.pi * np.geomspace(SLOWEST, 0.5, PLACES))
    rates, vectors, inverse = derivative(order, zeta)
    root = np.sqrt(order.A[-1])
    return rates, -np.log(zeta)[:, None] - rates, root[:, None] * vectors, inverse / root
