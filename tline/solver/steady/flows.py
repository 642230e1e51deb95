"""Flows through the elements of a network without a state, each behind an effort and its source impedance."""

import numpy as np
from numpy.typing import NDArray

from tline.compiled.structure import pack
from tline.solver.description.laws import units_of_laws
from tline.solver.kernel.network import Crossing, Laws
from tline.solver.kernel.units import law_addresses


class Flows:
    """Laws of elements, packed once."""

    def __init__(self, laws: Laws):
        self._v, self._flow, self._slope = np.empty((3, len(laws.kind)))
        if not len(laws.kind):
            return
        from tline.solver.kernel.laws.through import Through, through

        crossing, law = Crossing(laws.constants, *np.empty((4, 1))), law_addresses(units_of_laws(laws))
        values = law, laws.at, laws.control, self._v, laws.source_impedance, self._flow, self._slope, crossing
        self._through, self._packed = through, pack(Through(*values))

    def __call__(self, v: NDArray) -> tuple[NDArray, NDArray]:
        """Flow through each element behind the efforts v, and its slope; each shape (E,)."""
        if len(v):
            self._v[:] = v
            self._through(self._packed)
        return self._flow.copy(), self._slope.copy()
