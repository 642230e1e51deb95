"""Matrices of the polynomial basis, as the kernel reads them."""

from functools import lru_cache
from typing import Any

import numpy as np

from tline.compiled.structure import pack
from tline.solver.kernel.network import Tools
from tline.solver.radau import Basis, gauss


@lru_cache
def tools_of(basis: Basis) -> Any:
    """The matrices of a basis, packed: `Tools`."""
    return pack(Tools(basis.c, basis.to_points, basis.to_legendre, basis.A, np.array(gauss(basis.s))))
