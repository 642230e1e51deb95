"""Values of waves at given instants."""

from typing import NamedTuple

import numpy as np

from tline.compiled.structure import Floats, Floats2, Floats3, Floats4
from tline.compiled.unit import unit
from tline.solver.kernel.peaks import fill, powers

NEAR = 1e-9  # of a period; an instant this near to a slab's end is its end
NARROWEST = 1e-18  # of a period: slabs of no width count as so wide


class Values(NamedTuple):
    """Waves in B copies, in periods of K slabs of s points, and instants."""

    waves: Floats4  # (rows, n K, s, B)
    period: Floats  # (B,) in s
    edges: Floats2  # (K + 1, B) of the slabs, as shares of a period
    t: Floats  # (instants,)
    to_powers: Floats2  # (s, s) from values at points to coefficients of powers of 2 x - 1
    found: Floats3  # (rows, B, instants)
    coef: Floats  # (s,)


@unit
def find_values(sought: Values) -> int:
    """Find the waves at the instants; at a jump the value before it, at t = 0 zero."""
    waves, edges, t = sought.waves, sought.edges, sought.t
    rows, slabs, _, copies = waves.shape
    parts = edges.shape[0] - 1
    for c in range(copies):
        for i in range(t.size):
            place = t[i] / sought.period[c]
            period = min(max(int(np.ceil(place - NEAR)) - 1, 0), slabs // parts - 1)
            k = 0
            while k < parts - 1 and edges[k + 1, c] < place - period - NEAR:
                k += 1
            width = max(edges[k + 1, c] - edges[k, c], NARROWEST)
            x = min(max((place - period - edges[k, c]) / width, 0.0), 1.0)
            for row in range(rows):
                fill(waves[row, period * parts + k], c, 1.0, sought.to_powers, sought.coef)
                sought.found[row, c, i] = powers(sought.coef, 2.0 * x - 1.0)[0] if t[i] > 0.0 else 0.0
    return 0
