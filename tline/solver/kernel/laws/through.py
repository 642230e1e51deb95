"""Flows through many elements at once, each alone behind an effort and an impedance."""

from typing import NamedTuple

import numpy as np

from tline.compiled.structure import Floats, Integers
from tline.compiled.unit import invoke, unit
from tline.solver.kernel.network import Crossing


class Through(NamedTuple):
    """E elements, each behind an effort v and an impedance z; flow and slope are the results."""

    law: Integers  # (E,) addresses of their units
    at: Integers  # (E,) places of their constants
    control: Floats  # (E,)
    v: Floats
    z: Floats
    flow: Floats
    slope: Floats
    crossing: Crossing


@unit
def through(elements: Through) -> int:
    """Flow through each element without a state, and its slope."""
    crossing, law, at, z = elements.crossing, elements.law, elements.at, elements.z
    for e in range(law.size):
        crossing.v[0], crossing.control[0] = elements.v[e], elements.control[e]
        invoke(law[e], (crossing, at[e], np.int64(1), z[e]))
        elements.flow[e], elements.slope[e] = crossing.flow[0], crossing.slope[0]
    return 0
