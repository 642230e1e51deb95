"""Tank between a bottom and a rim, behind a loss for each direction. Its state is its effort.

Constants: effort beyond the element, capacities of the loss inwards and outwards, capacitance, efforts at the bottom
and at the rim. Inflow at the rim runs over: it passes the loss and nothing stores it. The rim is at zero or above, so
that the overflow takes energy.
"""

import numpy as np

from tline.compiled.unit import function, unit
from tline.solver.kernel.laws.quadratic import rooted
from tline.solver.kernel.network import DIVIDED, Store
from tline.solver.kernel.stores.fill import filled
from tline.solver.kernel.stores.tank import in_parts


@function
def stored(c, at, y):
    """X, dX/dy, effort, and dX/dt over the flow."""
    return y, 1.0, y, 1.0 / c[at + 3]


@function
def entering(c, at, y, share, d, z):
    """Flow through the loss of its direction, and dX/dt."""
    i = rooted(d, z, c[at + 1] if d > 0.0 else c[at + 2], 0.0)[0]
    return i, share * i


@function
def between(c, at, y, h, d, z):
    """Flow in a step of Euler's implicit method behind the effort d, and the effort inside after it."""
    low, high, rate = c[at + 4], c[at + 5], h / c[at + 3]
    i, _ = entering(c, at, y, 0.0, d - y, z + rate)
    if y + rate * i > high:
        return entering(c, at, high, 0.0, d - high, z)[0], high
    i = max(i, (low - y) / rate)
    return i, max(y + rate * i, low)


@function
def at_a_stop(store, at, y, z):
    """Whether the tank runs over all the slab, or is empty all the slab; and the flows that it has then."""
    c, v, flow = store.constants, store.v, store.flow
    over, dry = y >= c[at + 5], y <= c[at + 4]
    for j in range(v.size):
        d = v[j] - c[at] - y
        over, dry = over and d >= 0.0, dry and d <= 0.0
        flow[j] = entering(c, at, y, 0.0, d, z)[0] if over else 0.0
        store.y[j] = y
    return over or dry


@unit
def open_tank(store: Store, at: int, state: int, h: float, z: float) -> int:
    """Flows into the tank at the points of a slab of width h, behind the efforts v and the impedance z.

    Where it comes to its rim or its bottom, by parts of the slab: collocation would pass them.
    """
    c, states, s = store.constants, store.states, store.v.size
    start, low, high = states[state], c[at + 4], c[at + 5]
    if not at_a_stop(store, at, start, z):
        free = store.division[DIVIDED] == 0 and filled(stored, entering, store, at, state, h, z, np.inf)
        for j in range(s if free else 0):
            free = free and low <= store.y[j] <= high
        if not free:
            states[state] = in_parts(between, store, at, start, h, z)
            for j in range(s):
                store.y[j] = start + store.tools.c[j] * (states[state] - start)
    for j in range(s):
        d = store.v[j] - c[at] - store.y[j]
        store.drive[j] = max(d, 0.0) if store.y[j] <= low else d  # empty, nothing drives anything out
    return 0
