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
from tline.solver.description.bundle import Bundle
from tline.solver.radau import Basis, basis
from tline.solver.stability.lossy_line import carried

SLOWEST, PLACES = 1e-6, 400  # cycles per slab, and from there to a half


def gain(line: LossyLine, z0: float, order: Basis, h: float, slabs: float) -> float:
    """The largest norm of the scattering of a line, at places all round the circle |ζ| = 1.

    The line has the impedance z0 for a front; so many whole slabs of its delay, h s each, move waves as they are.
    """
    rates, late, vectors, inverse = circle(order.s)
    across, back = carried(line, z0, rates.ravel() / h, slabs * late.ravel())
    modes = ((across + sign * back).reshape(-1, 1, order.s) for sign in (1, -1))  # of equal and opposite waves
    return max(float(np.linalg.norm((vectors * mode) @ inverse, 2, axis=(1, 2)).max()) for mode in modes)


def gain_of_bundle(bundle: Bundle, order: Basis, h: float, slabs: float) -> float:
    """The same of coupled conductors whose modes mix, in power waves."""
    rates, late, vectors, inverse = circle(order.s)
    own, other = bundle.admittances(rates.ravel() / h, slabs * late.ravel())
    root, one, k, found = np.sqrt(bundle.z0), np.eye(len(bundle.z0)), len(bundle.z0), 0.0
    for sign in (1, -1):  # of equal and opposite waves
        seen = root[:, None] * (own + sign * other) * root
        back = np.linalg.solve(one + seen, one - seen).reshape(-1, order.s, k, k)
        whole = np.einsum("nij,njab,njl->nialb", vectors, back, inverse).reshape(-1, order.s * k, order.s * k)
        found = max(found, float(np.linalg.norm(whole, 2, axis=(1, 2)).max()))
    return found


@lru_cache
def circle(s: int) -> tuple[NDArray, NDArray, NDArray, NDArray]:
    """Eigenvalues of D, what a slab's delay is beyond them, and eigenvectors with their inverse, in that norm."""
    order = basis(s)
    zeta = np.exp(-2j * np.pi * np.geomspace(SLOWEST, 0.5, PLACES))
    rates, vectors, inverse = derivative(order, zeta)
    root = np.sqrt(order.A[-1])
    return rates, -np.log(zeta)[:, None] - rates, root[:, None] * vectors, inverse / root
