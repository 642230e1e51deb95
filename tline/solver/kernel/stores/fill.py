"""One Radau IIA step of an element whose state y is one number.

The step is one of X(y), the root of twice the energy stored, so that it cannot add energy (Hairer, Wanner: Solving
Ordinary Differential Equations II, 1996, theorem IV.12.9). A store gives of y: X, dX/dy, its effort, and r where dX/dt
= r i, of a rotor about; and behind an effort and an impedance the flow i, and dX/dt.
"""

import numpy as np

from tline.compiled.unit import function
from tline.solver.kernel.arithmetic import (
    ACCEPTED_RESIDUAL,
    BEST_RESIDUAL,
    TRIES,
    clear,
    copy,
    eliminate,
    left_of,
    project,
    times,
)
from tline.solver.kernel.network import DIVIDED, MISSES, SPENT

MOST_PARTS, STRIDES = 256, 64  # of a slab, and of a first residual, that are tried


@function
def filling(stored, entering, c, at, y, v, z):
    """Flow i into an element with a state y, X, dX/dy, dX/dt, and r."""
    x, slope, effort, share = stored(c, at, y)
    i, rate = entering(c, at, y, share, v - c[at] - effort, z)
    return i, x, slope, rate, share


@function
def unfilled(stored, entering, store, at, h, z, start):
    """Residuals of the stages, the largest, and a scale."""
    c, radau, v, y, flow, rest = store.constants, store.tools.radau, store.v, store.y, store.flow, store.rest
    s = radau.shape[0]
    x_start = stored(c, at, start)[0]
    worst, scale = 0.0, abs(x_start)
    for j in range(s):
        rest[j] = -x_start
    for j in range(s):
        flow[j], x, store.slope[j], rate, share = filling(stored, entering, c, at, y[j], v[j], z)
        store.rate[j] = rate
        rest[j] += x
        scale = max(scale, abs(x), h * abs(share * v[j]) / z)  # a stiff step magnifies the rounding of v
        for k in range(s):
            rest[k] -= h * radau[k, j] * rate
    for j in range(s):
        worst = max(worst, abs(rest[j]))
    return worst, scale


@function
def stepped(stored, entering, store, at, h, z, share, most):
    """One Newton step of a share; no y changes by more than most/reach of its change."""
    c, radau, v, y, rest, system = (
        store.constants, store.tools.radau, store.v, store.y, store.rest, store.system,
    )  # fmt: skip
    s, reach = radau.shape[0], 1e-300
    for k in range(s):
        delta = 1e-7 * max(abs(y[k]), 1.0)
        _, _, _, more, _ = filling(stored, entering, c, at, y[k] + delta, v[k], z)
        for j in range(s):
            system[j, k] = (store.slope[j] if j == k else 0.0) - h * radau[j, k] * (more - store.rate[k]) / delta
        system[k, s] = rest[k]
    eliminate(system, s)
    for j in range(s):
        reach = max(reach, abs(system[j, s]))
    step = min(share, most / reach)
    for j in range(s):
        y[j] -= step * system[j, s]


@function
def filled(stored, entering, store, at, state, h, z, most):
    """One step of width h. Returns whether it was found; its flows are kept, and the state moves, if so.

    Where Newton's full steps fail, the first residual is led to zero in smaller parts.
    """
    y, safe, first, rest, s = store.y, store.safe, store.first, store.rest, store.tools.radau.shape[0]
    start = store.states[state]
    for j in range(s):
        y[j], safe[j] = start, start
    unfilled(stored, entering, store, at, h, z, start)
    copy(rest, first)
    done, stride = 0.0, 1.0
    for _ in range(STRIDES):
        aim, before, sound, share = min(done + stride, 1.0), np.inf, False, 1.0
        for _ in range(TRIES):
            _, scale = unfilled(stored, entering, store, at, h, z, start)
            now = left_of(rest, first, aim, s)
            sound = now <= BEST_RESIDUAL * scale or (now <= ACCEPTED_RESIDUAL * scale and now >= 0.5 * before)
            if sound or not np.isfinite(now):
                break
            share = min(1.0, 2.0 * share) if now < before else 0.5 * share
            before = now
            stepped(stored, entering, store, at, h, z, share, most)
        if sound:
            copy(y, safe)
            done, stride = aim, 2.0 * stride
            if done == 1.0:
                break
        else:
            copy(safe, y)
            stride *= 0.25
    if done == 1.0:
        store.states[state] = y[s - 1]
        for j in range(s):
            store.drive[j] = store.v[j] - store.constants[at] - stored(store.constants, at, y[j])[2]
    return done == 1.0


@function
def fill(stored, entering, store, at, state, h, z, most):
    """Flows at the points of a slab of width h, under the efforts v there; nan at the last if none were found.

    A slab that is far too long for the element is divided, if it may be: not wave by wave, for flows that jump where
    waves change a little may fit none. The flow in its parts is projected on the slab, which keeps the integral and
    adds no energy.
    """
    if not store.division[DIVIDED]:
        if not filled(stored, entering, store, at, state, h, z, most):
            store.division[MISSES] = 1
            store.flow[store.flow.size - 1] = np.nan
        return
    tools, coef, kept, whole, piece = store.tools, store.coef, store.kept, store.whole, store.piece
    clear(whole)
    times(tools.to_legendre, store.v, 0, coef)
    since, width, tried = 0.0, 0.5, 0
    while since < 1.0 and tried < MOST_PARTS:
        tried += 1
        until = min(since + width, 1.0)
        clear(piece)
        project(coef, 0.0, 1.0, since, until, tools.gauss, piece)
        times(tools.to_points, piece, 0, store.v)
        if filled(stored, entering, store, at, state, h * (until - since), z, most):
            times(tools.to_legendre, store.flow, 0, kept)
            project(kept, since, until, 0.0, 1.0, tools.gauss, whole)
            since, width = until, 2.0 * width
        else:
            width *= 0.5
    store.division[SPENT] += tried
    times(tools.to_points, coef, 0, store.v)
    times(tools.to_points, whole, 0, store.flow)
    if since < 1.0:
        store.flow[store.flow.size - 1] = np.nan
