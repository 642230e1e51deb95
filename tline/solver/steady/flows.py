"""Flows through the elements of a network without a state, each behind an effort and its source impedance."""

import numpy as np
from numpy.typing import NDArray

from tline.compiled.structure import pack
from tline.solver.description.laws import units_of_laws
from tline.solver.kernel.network import Crossing, Laws
from tline.solver.kernel.units import law_addresses


def flows_through(laws: Laws, v: NDArray) -> tuple[NDArray, NDArray]:
    """Flow through each element behind the efforts v, and its slope; each shape (E,)."""
    flow, slope = np.empty_like(v), np.empty_like(v)
    if len(v):
        from tline.solver.kernel.laws.through import Through, through

        crossing = Crossing(laws.constants, *np.empty((4, 1)))
        law = law_addresses(units_of_laws(laws))
        through(pack(Through(law, laws.at, laws.control, v, laws.source_impedance, flow, slope, crossing)))
    return flow, slope
