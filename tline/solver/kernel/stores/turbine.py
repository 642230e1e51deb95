"""Impulse turbine: its rotor turns as water and load let it, and its governor moves the gates.

With d the drop, x the opening of the gates, n the speed over the rated one and R that of the runaway, the flow is
i = C x sqrt(d), at any speed; the torque of the jets falls along a line to nothing at the runaway, as the blades
go as fast as the water. Both rates are found with the flows by iteration over the points of a slab.

Constants: effort beyond the element, capacity at the opening of the start, whether flow passes one way only, that
opening, twice the rotor's energy at rated speed over a unit of torque K i (R sqrt(d/D) - n), R, rated drop D,
proportional and integral gain of the governor, its fastest rate, and the torque before the run. States are speed and
opening; the control signal is the share of the load that is left.
"""

import numpy as np

from tline.compiled.unit import function, unit
from tline.solver.kernel.arithmetic import ACCEPTED_RESIDUAL, BEST_RESIDUAL, eliminate
from tline.solver.kernel.laws.quadratic import rooted
from tline.solver.kernel.network import Store

OPENED, INERTIA, RUNAWAY, DROP, PROPORTIONAL, INTEGRAL, FASTEST, LOAD = range(3, 11)  # places of constants
TRIES = 100


@function
def turned(store, at, h, speed):
    """Speeds at the points, and their rates, under the flows and drops there; the torque is linear in the speed."""
    c, radau, system, flow, rate = store.constants, store.tools.radau, store.system, store.flow, store.rate
    s = flow.size
    for k in range(s):
        brake = max(flow[k], 0.0) / c[at + INERTIA]
        jets = brake * c[at + RUNAWAY] * np.sqrt(max(store.rest[k], 0.0) / c[at + DROP])
        rate[k], store.slope[k] = jets - c[at + LOAD] * store.control[k] / c[at + INERTIA], brake
    for j in range(s):
        system[j, s] = speed
        for k in range(s):
            system[j, k] = (1.0 if j == k else 0.0) + h * radau[j, k] * store.slope[k]
            system[j, s] += h * radau[j, k] * rate[k]
    eliminate(system, s)
    for j in range(s):
        store.y[j] = system[j, s]
        rate[j] -= store.slope[j] * store.y[j]


@unit
def turbine(store: Store, at: int, state: int, h: float, z: float) -> int:
    """Flows through the turbine at the points of a slab of width h, behind the efforts v and the impedance z."""
    c, radau, v, opening, states = store.constants, store.tools.radau, store.v, store.first, store.states
    s, speed, begun, fastest, before = v.size, states[state], states[state + 1], c[at + FASTEST], np.inf
    for j in range(s):
        opening[j], store.drive[j] = begun, v[j] - c[at]
    for _ in range(TRIES):
        for j in range(s):
            capacity = c[at + 1] * opening[j] / c[at + OPENED]
            store.flow[j] = rooted(store.drive[j], z, capacity, c[at + 2])[0]
            store.rest[j] = store.drive[j] - z * store.flow[j]
        turned(store, at, h, speed)
        for j in range(s):
            pace = c[at + INTEGRAL] * (1.0 - store.y[j]) - c[at + PROPORTIONAL] * store.rate[j]
            store.safe[j] = min(max(pace, -fastest), fastest)
        moved = 0.0
        for j in range(s):
            x = begun
            for k in range(s):
                x += h * radau[j, k] * store.safe[k]
            x = min(max(x, 0.0), 1.0)
            moved, opening[j] = max(moved, abs(x - opening[j])), x
        if moved <= BEST_RESIDUAL or (moved <= ACCEPTED_RESIDUAL and moved >= 0.5 * before):
            states[state], states[state + 1] = store.y[s - 1], opening[s - 1]
            return 0
        before = moved
    store.flow[s - 1] = np.nan
    return 0
