"""Matrices of the polynomial basis, as the kernel reads them."""

import numpy as np

from tline.solver.kernel.network import Tools
from tline.solver.radau import Basis, gauss


def tools_of(basis: Basis) -> Tools:
    """The matrices of a basis."""
    return Tools(basis.c, basis.to_points, basis.to_legendre, basis.A, np.array(gauss(basis.s)))
