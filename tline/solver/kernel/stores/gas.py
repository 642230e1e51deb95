"""Gas in a vessel: p Vⁿ is constant, behind an orifice. Its state is ln(V / volume at zero effort).

Constants: effort beyond the element, capacity of the orifice, pressure outside, volume at zero effort, exponent n.
"""

import numpy as np

from tline.compiled.unit import function, unit
from tline.solver.kernel.arithmetic import STEPS, ULPS
from tline.solver.kernel.laws.quadratic import rooted
from tline.solver.kernel.network import DIVIDED, MISSES, Store
from tline.solver.kernel.stores.fill import fill
from tline.solver.kernel.stores.tank import PARTS, entering, in_parts

MISSED = 1e-3  # share of a gas's volume that a step may lose
FARTHEST = 2.0  # change of ln V in a step of Newton's method


@function
def expanded(low, n):
    """Effort, X with X²/2 the stored energy, and effort/X of gas with p V^n = 1 in air of pressure 1, from ln V."""
    d = np.expm1(low)
    if abs(d) < 0.4:
        term, effort, energy, k = -n, n, n / 2.0, 1
        while abs(term) > 1e-17 * abs(effort) and k < 60:
            k += 1
            term *= d * (-n - k + 1.0) / k
            effort -= term
            energy -= term / (k + 1.0)
        return -d * effort, -d * np.sqrt(2.0 * energy), effort / np.sqrt(2.0 * energy)
    work = -low if n == 1.0 else -np.expm1((1.0 - n) * low) / (1.0 - n)
    x = np.sqrt(2.0 * (work + d))
    x = -x if d > 0.0 else x
    effort = np.expm1(-n * low)
    return effort, x, effort / x


@function
def stored(c, at, y):
    """X, dX/dy, effort, and dX/dt over the flow."""
    effort, x, ratio = expanded(y, c[at + 4])
    return x, -ratio * np.exp(y), c[at + 2] * effort, ratio / c[at + 3]


@function
def squeezed(c, at, volume, share, d, z):
    """Flow in a step of Euler's implicit method behind the effort d and the impedance z, and the volume after it.

    That lies between the volume before and that at rest, if there is one: Newton, bisection where that fails. `share`
    is the step's time.
    """
    outside, n = c[at + 2], c[at + 4]
    if n == 1.0 and c[at + 1] == np.inf:
        weight = share * outside / z
        left = volume - weight * (d / outside + 1.0)
        root = np.sqrt(left * left + 4.0 * weight)
        after = 0.5 * (left + root) if left > 0.0 else 2.0 * weight / (root - left)
        return (volume - after) / share, after
    y = np.log(volume)
    i, slope = rooted(d - outside * expanded(y, n)[0], z, c[at + 1], 0.0)
    rest = -np.log1p(d / outside) / n if d > -outside else np.inf
    low, high = (rest, y) if i > 0.0 else (y, min(rest, np.log(volume - share * i)))
    for _ in range(STEPS):
        effort = outside * expanded(y, n)[0]
        i, slope = rooted(d - effort, z, c[at + 1], 0.0)
        off = np.exp(y) - volume + share * i
        low, high = (low, min(y, high)) if off > 0.0 else (max(y, low), high)
        after = y - off / (np.exp(y) + share * slope * n * (effort + outside))
        if not low <= after <= high:
            after = 0.5 * (low + high)
        close, y = abs(after - y) <= ULPS * max(abs(y), 1.0), after
        if close:
            break
    return (volume - np.exp(y)) / share, np.exp(y)


@function
def is_missed(store, at, state, start, h):
    """Whether the volume of isothermal gas does not match its inflow: too stiff for the step."""
    c, radau, flow, spent = store.constants, store.tools.radau, store.flow, 0.0
    if c[at + 1] < np.inf or c[at + 4] != 1.0:
        return False
    for j in range(flow.size):
        spent += radau[flow.size - 1, j] * flow[j]
    before, volume = np.exp(start), np.exp(store.states[state])
    return not abs(volume - before + h * spent / c[at + 3]) <= MISSED * max(volume, before)


@unit
def gas(store: Store, at: int, state: int, h: float, z: float) -> int:
    """Flows into the gas at the points of a slab of width h, behind the efforts v and the impedance z.

    With order 1 the volume follows from the flow, and the step is found at once.
    """
    start, c, flow = store.states[state], store.constants, store.flow
    if store.division[DIVIDED] or flow.size == 1:
        parts = PARTS if store.division[DIVIDED] else 1
        store.states[state] = np.log(in_parts(squeezed, store, at, np.exp(start), h / c[at + 3], z, parts))
        for j in range(flow.size):
            store.drive[j] = z * flow[j] + flow[j] * abs(flow[j]) / c[at + 1] ** 2
        return 0
    fill(stored, entering, store, at, state, h, z, FARTHEST)
    if is_missed(store, at, state, start, h):
        store.division[MISSES] = 1
    return 0
