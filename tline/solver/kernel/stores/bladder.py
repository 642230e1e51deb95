"""Gas in a bladder, which shuts the vessel once all liquid is out. Its state is ln(V / volume at zero effort).

Constants: those of gas (`tline.solver.kernel.stores.gas`), and the state at which the bladder fills the vessel.
"""

import numpy as np

from tline.compiled.unit import function, unit
from tline.solver.kernel.network import DIVIDED, Store
from tline.solver.kernel.stores.fill import filled
from tline.solver.kernel.stores.gas import FARTHEST, entering, expanded, is_missed, squeezed, stored
from tline.solver.kernel.stores.tank import in_parts


@function
def bounded(c, at, volume, share, d, z):
    """Flow in a step of Euler's implicit method, and the volume after it, at most the vessel's: energy stays convex."""
    after = min(squeezed(c, at, volume, share, d, z)[1], np.exp(c[at + 5]))
    return (volume - after) / share, after


@unit
def bladder(store: Store, at: int, state: int, h: float, z: float) -> int:
    """Flows into the vessel at the points of a slab of width h, behind the efforts v and the impedance z.

    Where the bladder fills the vessel, by parts of the slab: collocation would pass that.
    """
    c, states, y, s = store.constants, store.states, store.y, store.v.size
    start, full = states[state], c[at + 5]
    free = start < full and store.division[DIVIDED] == 0 and filled(stored, entering, store, at, state, h, z, FARTHEST)
    free = free and not is_missed(store, at, state, start, h)
    for j in range(s if free else 0):
        free = free and y[j] <= full
    if not free:
        after = in_parts(bounded, store, at, np.exp(start), h / c[at + 3], z)
        states[state] = full if after >= np.exp(full) else np.log(after)
        for j in range(s):
            y[j] = start + store.tools.c[j] * (states[state] - start)
    for j in range(s):
        d = store.v[j] - c[at] - c[at + 2] * expanded(y[j], c[at + 4])[0]
        store.drive[j] = max(d, 0.0) if y[j] >= full else d  # full of gas, nothing drives anything out
    return 0
