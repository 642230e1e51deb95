"""From the Thévenin waves at a group's nodes to their efforts, through the elements that stand there.

A single element sees a Thévenin source: the effort v behind the impedance z of its nodes. Its law, or its store, is a
unit of its own, asked once for all samples.
"""

import numpy as np

from tline.solver.kernel.arithmetic import add_product
from tline.solver.kernel.network import AIR, Run
from tline.solver.kernel.newton import CLOSE, SPARE, STEPS
from tline.unit import function, invoke, unit


@function
def pass_one(run, g, n, h):
    """Pass n samples through the only element of a group, slab by slab of width h if it stores."""
    laws, u, control, s = run.network.laws, run.work.u, run.work.control, run.state.before.shape[1]
    e, low, crossing, store = laws.first[g], run.network.group[g], run.work.crossing, run.work.store
    from_node, to_node, at, law = laws.from_node[e], laws.to_node[e], laws.at[e], run.units.law[e]
    z_from = laws.impedance[low + from_node] if from_node >= 0 else 0.0
    z_to = laws.impedance[low + to_node] if to_node >= 0 else 0.0
    here, there = max(from_node, 0) * n, max(to_node, 0) * n
    sign_here, sign_there = (1.0 if from_node >= 0 else 0.0), (1.0 if to_node >= 0 else 0.0)
    if laws.state_at[e] < 0:
        v, signal, flow = crossing.v, crossing.control, crossing.flow
        for i in range(n):
            v[i] = sign_here * u[here + i] - sign_there * u[there + i]
            signal[i] = control[0, i]
        invoke(law, (crossing, at, n, z_from + z_to))
        for i in range(n):
            u[here + i] -= z_from * flow[i]
            u[there + i] += z_to * flow[i]
        return
    v, signal, flow = store.v, store.control, store.flow
    for slab in range(n // s):
        for j in range(s):
            i = slab * s + j
            v[j] = sign_here * u[here + i] - sign_there * u[there + i]
            signal[j] = control[0, i]
        invoke(law, (store, at, laws.state_at[e], h, z_from + z_to))
        for j in range(s):
            u[here + slab * s + j] -= z_from * flow[j]
            u[there + slab * s + j] += z_to * flow[j]


@function
def pass_all(run, g, n, h):
    """Pass n samples through the elements of a group, slab by slab of width h if they store."""
    laws, dead = run.network.laws, False
    for node in range(run.network.group[g], run.network.group[g + 1]):
        dead |= laws.impedance[node] < 0.0
    if dead or laws.first[g + 1] - laws.first[g] > 1:
        invoke(run.units.group, (run, g, n, n))
    else:
        pass_one(run, g, n, h)


@function
def exchange_states(run, g, give):
    """Put the states of a group's elements aside, or give them back."""
    laws, states, own = run.network.laws, run.state.load, run.work.newton.own
    for k in range(laws.first[g + 1] - laws.first[g]):
        e = laws.first[g] + k
        at, count = laws.state_at[e], 2 if laws.kind[e] == AIR else 1
        for i in range(count if at >= 0 else 0):
            if give:
                states[at + i] = own[k, i]
            else:
                own[k, i] = states[at + i]


@function
def pass_at_segments(run, g, h):
    """The same for one slab of a group at lossy segments, which feel its efforts at once: until these stay.

    What they add is small, and the smaller the slab.
    """
    low, s, segments, u = run.network.group[g], run.state.before.shape[1], run.network.segments, run.work.u
    wave, last, size = run.work.newton.wave, run.work.newton.last, (run.network.group[g + 1] - low) * s
    change, scale = np.inf, 0.0
    for i in range(size):
        wave[i], last[i] = u[i], u[i]
    exchange_states(run, g, False)
    for _ in range(STEPS):
        exchange_states(run, g, True)
        for p in range(size // s):
            for i in range(s):
                u[p * s + i] = wave[p * s + i]
            if segments.echo_at[low + p] >= 0:
                add_product(segments.echo, segments.echo_at[low + p], s, s, last, p * s, u, p * s)
        pass_all(run, g, s, h)
        change, scale = 0.0, 0.0
        for i in range(size):
            change, scale = max(change, abs(u[i] - last[i])), max(scale, abs(u[i]))
            last[i] = u[i]
        if not change > SPARE * scale:
            return
    if change > CLOSE * scale:
        u[size - 1] = np.nan


@unit
def crossing(run: Run, g: int, n: int, h: float, echoes: int) -> int:
    """Turn the Thévenin waves of n samples at a group with elements into efforts; h is the width of a slab.

    With `echoes`, a group at lossy segments is led through its one slab until these feel its efforts.
    """
    if echoes != 0 and run.network.segments.beside.size > 0 and run.network.segments.beside[g]:
        pass_at_segments(run, g, h)
    else:
        pass_all(run, g, n, h)
    return 0
