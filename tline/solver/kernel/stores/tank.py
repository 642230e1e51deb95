"""Tank with an area, or a capacitance, behind an orifice; its state is its effort.

Constants: effort beyond the element, capacity of the orifice, capacitance.

Elements with a volume, by steps of Euler's implicit method: slabs of order 1, and any that are far too long.
"""

import numpy as np

from tline.compiled.unit import function, unit
from tline.solver.kernel.arithmetic import clear, integrated, project, series, times
from tline.solver.kernel.laws.quadratic import rooted
from tline.solver.kernel.network import Store
from tline.solver.kernel.stores.fill import fill

PARTS = 64


@function
def stored(c, at, y):
    """X, dX/dy, effort, and dX/dt over the flow."""
    return y, 1.0, y, 1.0 / c[at + 2]


@function
def entering(c, at, y, share, d, z):
    """Flow through the orifice, and dX/dt."""
    i = rooted(d, z, c[at + 1], 0.0)[0]
    return i, share * i


@unit
def tank(store: Store, at: int, state: int, h: float, z: float) -> int:
    """Flows into the tank at the points of a slab of width h, behind the efforts v and the impedance z."""
    fill(stored, entering, store, at, state, h, z, np.inf)
    return 0


@function
def in_parts(step, store, at, state, share, z, parts=PARTS):
    """Flows at the points of a slab, under the efforts v there; share is the slab's time over the unit of the state.

    Each part is a step, from a state behind an effort and an impedance to the flow and the next state. Where the energy
    is convex in the state a step adds none. Nor does the projection of these flows on the slab, which keeps their
    integral. Returns the state at the end.
    """
    tools, flow, coef, sent = store.tools, store.flow, store.coef, store.integral
    constant, whole, c, width, last = store.constant, store.whole, store.constants, 1.0 / parts, 0.0
    clear(whole)
    times(tools.to_legendre, store.v, 0, coef)
    integrated(coef, 1.0, sent)
    for k in range(parts):
        here = series(sent, 2.0 * (k + 1) * width - 1.0)
        constant[0], state = step(c, at, state, share * width, (here - last) / width - c[at], z)
        project(constant, k * width, (k + 1) * width, 0.0, 1.0, tools.gauss, whole)
        last = here
    times(tools.to_points, whole, 0, flow)
    return state
