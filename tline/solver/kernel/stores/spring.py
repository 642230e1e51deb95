"""Liquid on a spring with a preload, between two stops. Its state is the effort of the spring.

Constants: effort beyond the element, capacitance, efforts at its two stops.
"""

import numpy as np

from tline.compiled.unit import function, unit
from tline.solver.kernel.network import DIVIDED, Store
from tline.solver.kernel.stores.fill import filled
from tline.solver.kernel.stores.tank import in_parts


@function
def stored(c, at, y):
    """X, dX/dy, effort, and dX/dt over the flow."""
    return y, 1.0, y, 1.0 / c[at + 1]


@function
def entering(c, at, y, share, d, z):
    """Flow, and dX/dt."""
    return d / z, share * d / z


@function
def stopped(c, at, volume, share, d, z):
    """Flow in a step of Euler's implicit method between stops, behind d and z, and the liquid missing after it."""
    rate = share / (z * c[at + 1])
    x = (rate * d - volume / c[at + 1]) / (1.0 + rate)
    after = -c[at + 1] * min(max(x, c[at + 2]), c[at + 3])
    return (volume - after) / share, after


@unit
def spring(store: Store, at: int, state: int, h: float, z: float) -> int:
    """Flows onto the spring at the points of a slab of width h, behind the efforts v and the impedance z.

    Where the spring meets a stop, or rests at one, by parts of the slab: collocation would add energy there.
    """
    c, states, radau, s = store.constants, store.states, store.tools.radau, store.v.size
    start, low, high = states[state], c[at + 2], c[at + 3]
    free = store.division[DIVIDED] == 0 and filled(stored, entering, store, at, state, h, z, np.inf)
    for j in range(s if free else 0):
        free = free and low <= store.y[j] <= high
    if not free:
        states[state] = -in_parts(stopped, store, at, -c[at + 1] * start, h, z) / c[at + 1]
    for j in range(s):
        x = start
        for k in range(s):
            x += h * radau[j, k] * store.flow[k] / c[at + 1]
        store.drive[j] = min(max(x, low), high)  # which has a corner where it meets a stop
    return 0
