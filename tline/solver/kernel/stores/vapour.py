"""Vapour cavity: opens where the pressure would fall below that of the vapour. Its state is its volume.

Constants: effort at which the liquid boils.
"""

from tline.compiled.unit import function, unit
from tline.solver.kernel.arithmetic import after, clear, fallen, integrated, project, series, times
from tline.solver.kernel.network import DIVIDED, Store
from tline.solver.kernel.stores.tank import in_parts


@function
def freed(c, at, volume, share, d, z):
    """Flow in a step of Euler's implicit method behind the effort d and the impedance z, and the volume after it."""
    after = max(volume - share * d / z, 0.0)
    return (volume - after) / share, after


@unit
def vapour(store: Store, at: int, state: int, h: float, z: float) -> int:
    """Flows into a vapour cavity at the points of a slab of width h, under the efforts v there.

    The cavity opens at a root of v less its pressure, and shuts where the integral has filled its volume again. The
    flow in between is projected on the slab: that keeps the volume, and adds no energy.
    """
    states, tools, flow, v, gauss, s = store.states, store.tools, store.flow, store.v, store.tools.gauss, store.v.size
    above, opened, piece, whole = store.coef, store.integral, store.piece, store.whole
    if store.division[DIVIDED]:
        states[state] = in_parts(freed, store, at, states[state], h, z)
        return 0
    clear(whole)
    for j in range(s):
        flow[j] = v[j] - store.constants[at]
    times(tools.to_legendre, flow, 0, above)
    integrated(above, -h / z, opened)
    since, volume = 0.0, states[state]
    while since < 1.0:
        if volume == 0.0:
            since = fallen(above, 0.0, since)
        floor = series(opened, 2.0 * since - 1.0) - volume
        until = fallen(opened, floor, since)
        clear(piece)
        project(above, 0.0, 1.0, since, until, gauss, piece)
        project(piece, since, until, 0.0, 1.0, gauss, whole)
        volume = max(series(opened, 1.0) - floor, 0.0) if until == 1.0 else 0.0
        since = after(until, s)
    states[state] = volume
    times(tools.to_points, whole, 0, flow)
    for j in range(s):
        flow[j] /= z
    return 0
