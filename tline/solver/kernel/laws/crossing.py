"""Efforts at a group's nodes with laws, from their Thévenin waves, by the unit that the group needs.

One element is connected to a Thévenin source: effort v behind the impedance z of its nodes. Its law, or store, is a
unit of its own, called once for all samples. A law with its flow as a function of the effort is solved as a root
between two efforts.
"""

from typing import NamedTuple

import numpy as np

from tline.compiled.structure import Floats, Integers
from tline.compiled.unit import function, invoke, unit, unit_of_long_loops
from tline.solver.kernel.arithmetic import STEPS, ULPS
from tline.solver.kernel.network import DIVIDED, MISSES, Crossing, Run


@unit_of_long_loops
def crossing(run: Run, g: int, n: int, h: float) -> int:
    """Turn the Thévenin waves of n samples at a group into efforts, slab by slab of width h if its element stores."""
    laws, u, control, s = run.network.laws, run.work.u, run.work.control, run.state.before.shape[1]
    e, low, sample, store = laws.first[g], run.network.group[g], run.work.crossing, run.work.store
    from_node, to_node, at, law = laws.from_node[e], laws.to_node[e], laws.at[e], run.units.law[e]
    z_from = laws.impedance[low + from_node] if from_node >= 0 else 0.0
    z_to = laws.impedance[low + to_node] if to_node >= 0 else 0.0
    here, there = max(from_node, 0) * n, max(to_node, 0) * n
    into = run.work.into
    sign_here, sign_there = (1.0 if from_node >= 0 else 0.0), (1.0 if to_node >= 0 else 0.0)
    if laws.state_at[e] < 0:
        v, signal, flow = sample.v, sample.control, sample.flow
        for i in range(n):
            v[i] = sign_here * u[here + i] - sign_there * u[there + i]
            signal[i], into[0, i] = control[0, i], v[i]
        invoke(law, (sample, at, n, z_from + z_to))
        for i in range(n):
            u[here + i] -= z_from * flow[i]
            u[there + i] += z_to * flow[i]
        return 0
    v, signal, flow = store.v, store.control, store.flow
    for slab in range(n // s):
        for j in range(s):
            i = slab * s + j
            v[j] = sign_here * u[here + i] - sign_there * u[there + i]
            signal[j] = control[0, i]
        state = laws.state_at[e]
        start, store.division[DIVIDED], store.division[MISSES] = store.states[state], 0, 0
        invoke(law, (store, at, state, h, z_from + z_to))
        if store.division[MISSES]:
            store.states[state], store.division[DIVIDED] = start, 1
            invoke(law, (store, at, state, h, z_from + z_to))
        for j in range(s):
            into[0, slab * s + j] = store.drive[j]
            u[here + slab * s + j] -= z_from * flow[j]
            u[there + slab * s + j] += z_to * flow[j]
    return 0


@function
def bracketed(conducted, c, at, control, d, z, low, high):
    """Flow i and di/dd where d = u + z i(u), and u lies between low and high: Newton, bisection where that fails."""
    u = high
    for _ in range(STEPS):
        i, slope = conducted(c, at, control, u)
        rest = u + z * i - d
        if rest > 0.0:
            high = u
        else:
            low = u
        step = rest / (1.0 + z * slope)
        after = u - step
        if not low * (1.0 - ULPS) <= after <= high * (1.0 + ULPS):
            after = 0.5 * (low + high)
        close = abs(after - u) <= ULPS * u
        u = after
        if close:
            break
    i, slope = conducted(c, at, control, u)
    if z * slope > 1.0:  # then u is known better than what it conducts
        i = (d - u) / z
    return i, slope / (1.0 + z * slope)


@function
def sampled(law, crossing, at, n, z):
    """Evaluate flows and slopes at n samples by a law of constants, a control signal, an effort and an impedance.

    While nothing changes, such as behind an edge or before a valve moves, it is not asked again.
    """
    c, v, control, flow, slope = crossing.constants, crossing.v, crossing.control, crossing.flow, crossing.slope
    for i in range(n):
        if i > 0 and v[i] == v[i - 1] and control[i] == control[i - 1]:
            flow[i], slope[i] = flow[i - 1], slope[i - 1]
            continue
        flow[i], slope[i] = law(c, at, control[i], v[i] - c[at], z)
    return 0


@function
def pass_laws(run, g, n, h, own):
    """Turn the waves of n samples into efforts; slabs, or pieces, are h wide, with an `own` map or not."""
    if run.network.laws.governed[g]:
        invoke(run.units.govern, (run, g, n, h, own))
    elif run.network.load_at[g] >= 0:
        invoke(run.units.circuit, (run, g, n, h, own))
    else:
        invoke(run.units.crossing, (run, g, n, h))


@function
def note_states(run, e, column):
    """Keep the first state of an element, or its opening that moves by itself, and its last one; zeros without."""
    laws, states, row = run.network.laws, run.state.load, run.network.laws.record_row[e]
    at = laws.state_at[e] if laws.state_at[e] >= 0 else laws.governor_state[e]
    run.record[row, 1, column] = states[at] if at >= 0 else 0.0
    run.record[row + 1, 1, column] = states[at + max(laws.states[e], 1) - 1] if at >= 0 else 0.0


@function
def is_watched(laws, g):
    """Whether the record keeps a state of a group, so that it is to be advanced slab by slab."""
    for e in range(laws.first[g], laws.first[g + 1]):
        if laws.record_row[e] >= 0 and max(laws.state_at[e], laws.governor_state[e]) >= 0:
            return True
    return False


@unit_of_long_loops
def pass_block(run: Run, g: int, here: int, n: int, column: int) -> int:
    """Turn the Thévenin waves of n samples of slabs into efforts, from sample `here` of the excitation on.

    Waves into laws are recorded, and beside them the states in which these leave them.
    """
    laws, excitation, record, into, signal = (
        run.network.laws, run.excitation, run.record, run.work.into, run.work.control,
    )  # fmt: skip
    first, last = laws.first[g], laws.first[g + 1]
    for e in range(first, last):
        row = laws.excitation_row[e]
        for i in range(n):
            signal[e - first, i] = excitation[row, here + i] if row >= 0 else laws.control[e]
    pass_laws(run, g, n, laws.step, np.int64(0))
    for e in range(first, last):
        row = laws.record_row[e]
        for i in range(n if row >= 0 else 0):
            record[row, 0, column + here + i] = into[e - first, i]
            note_states(run, e, column + here + i)
    return 0


class Through(NamedTuple):
    """E elements, each behind an effort v and an impedance z; flow and slope are the results."""

    law: Integers  # (E,) addresses of their units
    at: Integers  # (E,) places of their constants
    control: Floats  # (E,)
    v: Floats
    z: Floats
    flow: Floats
    slope: Floats
    crossing: Crossing


@unit
def through(elements: Through) -> int:
    """Flow through each element without a state, and its slope."""
    crossing, law, at, z = elements.crossing, elements.law, elements.at, elements.z
    for e in range(law.size):
        crossing.v[0], crossing.control[0] = elements.v[e], elements.control[e]
        invoke(law[e], (crossing, at[e], np.int64(1), z[e]))
        elements.flow[e], elements.slope[e] = crossing.flow[0], crossing.slope[0]
    return 0
