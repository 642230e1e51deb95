"""What a node does with the waves at its line ends: w arrives, u is the node's effort, 2u - w leaves.

Positions in the wave buffers are unsigned: a signed index is tested for wrapping round at every access, and the loops
do not vectorise.
"""

import numpy as np

from tline.solver.kernel.arithmetic import TINY
from tline.solver.kernel.laws.passing import pass_laws
from tline.solver.kernel.load import load
from tline.unit import function, invoke


@function
def begin(u, q, n, excitation, row, start):
    """Start the Thévenin wave of a node, at place q of u, with the sources' part."""
    if row < 0:
        for i in range(n):
            u[q + np.uint64(i)] = 0.0
    else:
        for i in range(n):
            u[q + np.uint64(i)] = excitation[row, start + i]


@function
def gather(u, q, n, waves, o, share):
    """Add an end's share of its arriving wave."""
    for i in range(n):
        u[q + np.uint64(i)] += share * waves[o + np.uint64(i)]


@function
def scatter(u, q, n, waves, o):
    """Send back from an end what the node's effort leaves of the arriving wave."""
    for i in range(n):
        back = 2.0 * u[q + np.uint64(i)] - waves[o + np.uint64(i)]
        waves[o + np.uint64(i)] = 0.0 if abs(back) < TINY else back


@function
def note(u, q, n, waves, o, record, row, column):
    """Keep the waves that arrive at an end and leave it."""
    for i in range(n):
        record[row, 0, column + i] = waves[o + np.uint64(i)]
        record[row, 1, column + i] = 2.0 * u[q + np.uint64(i)] - waves[o + np.uint64(i)]


@function
def note_effort(u, q, n, record, row, column):
    """Keep the effort of a node."""
    for i in range(n):
        record[row, 0, column + i] = u[q + np.uint64(i)]
        record[row, 1, column + i] = u[q + np.uint64(i)]


@function
def note_laws(run, g, n, column):
    """Keep the waves into laws."""
    laws, record, into = run.network.laws, run.record, run.work.into
    for e in range(laws.first[g], laws.first[g + 1]):
        row, k = laws.record_row[e], e - laws.first[g]
        for i in range(n if row >= 0 else 0):
            record[row, 0, column + i] = into[k, i]
            record[row, 1, column + i] = into[k, i]


@function
def control(run, g, start, n):
    """Gather the control signals of a group's elements at n samples."""
    laws, excitation, signal = run.network.laws, run.excitation, run.work.control
    for k in range(laws.first[g + 1] - laws.first[g]):
        e = laws.first[g] + k
        row = laws.excitation_row[e]
        for i in range(n):
            signal[k, i] = excitation[row, start + i] if row >= 0 else laws.control[e]


@function
def scatter_group(run, g, here, m, column):
    """Scatter m slabs at a group, from sample `here` of the excitation on. Returns a node that is not finite, or -1."""
    network, state, units, u, position = run.network, run.state, run.units, run.work.u, run.work.position
    ends, weight, record_row, waves, record = network.ends, network.weight, network.record_row, state.waves, run.record
    excitation, shift_row, first = run.excitation, network.shift_row, network.first
    s, one, after = state.before.shape[1], network.group[g], network.group[g + 1]
    n = m * s
    for node in range(one, after):
        q = np.uint64((node - one) * n)
        begin(u, q, n, excitation, network.excitation_row[node], here)
        for i in range(first[node], first[node + 1]):
            e = ends[i]
            if shift_row[e >> 1] >= 0:
                invoke(units.delay, (run, e, position[e], m))
            gather(u, q, n, waves, np.uint64(position[e]), weight[i])
    laws = network.laws.first[g] < network.laws.first[g + 1]
    if laws:
        control(run, g, here, n)
    if laws:
        pass_laws(run, np.int64(g), n, network.laws.step, np.int64(0))
    elif network.load_at[g] >= 0:
        load(run, g, n, network.step, network.step_at[network.step_row[g]])
    if laws:
        note_laws(run, g, n, column + here)
    for node in range(one, after):
        q = np.uint64((node - one) * n)
        for i in range(first[node], first[node + 1]):
            e = ends[i]
            o = np.uint64(position[e])
            if record_row[e] >= 0:
                note(u, q, n, waves, o, record, record_row[e], column + here)
            scatter(u, q, n, waves, o)
        if network.effort_row[node] >= 0:
            note_effort(u, q, n, record, network.effort_row[node], column + here)
        if not np.isfinite(u[q + np.uint64(n - 1)]):
            return node
    return -1
