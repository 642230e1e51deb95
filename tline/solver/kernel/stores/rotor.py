"""Pump with a rotor; its state is speed over rated speed. While its control signal is one, a motor brings it to its
rated speed with a constant torque, and holds that; while it is zero, the rotor runs down.

Constants: those of a pump (`laws.pump`).
"""

import numpy as np

from tline.compiled.unit import function, unit
from tline.solver.kernel.laws.pump import MOTOR, NOW, pumped, resting, torque
from tline.solver.kernel.network import Store
from tline.solver.kernel.stores.fill import fill, filling


@function
def stored(c, at, y):
    """X, dX/dy, effort, and dX/dt over the flow, about."""
    return y, 1.0, -resting(c, at, y), -abs(c[at + 1] * y) / c[at + 3]


@function
def entering(c, at, y, share, d, z):
    """Flow through the pump, and dX/dt."""
    i = pumped(c, at, y, d, z)[0]
    return i, (c[at + NOW] - torque(c, at, y, i)) / c[at + 3]


@unit
def rotor(store: Store, at: int, state: int, h: float, z: float) -> int:
    """Flows through the pump at the points of a slab of width h, behind the efforts v and the impedance z."""
    runs, c, y = store.control[0] > 0.5, store.constants, store.states
    if runs and y[state] >= 1.0:
        for j in range(store.flow.size):
            store.drive[j] = store.v[j] - c[at] - stored(c, at, y[state])[2]
            store.flow[j] = filling(stored, entering, c, at, y[state], store.v[j], z)[0]
    else:
        c[at + NOW] = c[at + MOTOR] if runs else 0.0
        fill(stored, entering, store, at, state, h, z, np.inf)
        if runs:
            y[state] = min(y[state], 1.0)
    return 0
