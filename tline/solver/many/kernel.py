"""Copies of a network advanced abreast: lines carry waves, nodes scatter them, as in the kernel of single runs.

Copies are the last axis of all arrays, so that loops over them vectorise; those over the few points of a slab would
not. Slabs of a period differ, periods are alike.
"""

from typing import NamedTuple

import numpy as np

from tline.compiled.structure import (
    Floats,
    Floats2,
    Floats3,
    Floats4,
    Floats5,
    Integers,
    Integers2,
)
from tline.compiled.unit import function, invoke, unit_of_long_loops
from tline.solver.kernel.arithmetic import TINY
from tline.solver.kernel.finished import fill, powers
from tline.solver.kernel.network import Crossing

AT_SLAB_END = 1e-9  # of a period; an instant this near to a slab's end is its end
NARROWEST = 1e-18  # of a period: slabs of no width count as so wide


class LawsOfCopies(NamedTuple):
    """Elements whose flow is no linear function of the effort across them, in B copies; one at a node at most."""

    row: Integers  # (N,) that at a node, or -1
    unit: Integers  # (rows,) addresses
    sign: Floats  # (rows,) 1 if its flow counts out of the node, else -1
    control_row: Integers  # (rows,) row of the drive that is its control signal
    beyond_row: Integers  # (rows,) and the effort at its other end, or -1
    at: Integers2  # (rows, B) place of its first constant
    impedance: Floats2  # (rows, B) of its node
    crossing: Crossing  # with room for the s points of a slab


class CopiesRun(NamedTuple):
    """B copies of a network with L lines and N nodes, in periods of K slabs of s points."""

    delay: Integers  # (L,) in periods
    first: Integers  # (N + 1,) the ends at node k are ends[first[k]:first[k + 1]]
    ends: Integers  # (2 L,)
    drive_row: Integers  # (N,) row of the source's part of a Thévenin wave, or -1
    load_row: Integers  # (N,) row of the map of a load with states, or -1
    record_row: Integers  # (2 L,) row in the record of an end, or -1
    weight: Floats2  # (2 L, B) share of an arriving wave in the Thévenin wave
    maps: Floats5  # (rows, K, s + n, s + n, B) by columns
    drive: Floats5  # (rows, periods, K, s, B), the last goes on: of nodes, then control signals, then efforts beyond
    record: Floats5  # (rows, 2, n K, s, B) efforts and arriving waves of n periods
    offset: Integers  # (L + 1,) first period of a line's two buffers
    waves: Floats4  # (periods, K, s, B) all buffers
    states: Floats3  # (rows, n, B)
    arriving: Floats2  # (2 L, B) waves before t = 0
    laws: LawsOfCopies
    u: Floats2  # (s + n, B) Thévenin waves and states of a slab, then efforts
    out: Floats2  # (s + n, B)


@unit_of_long_loops
def advance_copies(run: CopiesRun, n_periods: int) -> int:
    """Advance all copies by n periods, and record them."""
    first, ends, u, record, s = run.first, run.ends, run.u, run.record, run.waves.shape[2]
    for end in range(ends.size):
        for slot in range(run.delay[end >> 1]):
            waves = run.waves[due(end, run.delay, run.offset, slot)]
            for slab in range(waves.shape[0]):
                for j in range(s):
                    for c in range(waves.shape[2]):
                        waves[slab, j, c] = run.arriving[end, c]
    for period in range(n_periods):
        driven = min(period, run.drive.shape[1] - 1)
        for node in range(first.size - 1):
            r = run.load_row[node]
            for slab in range(run.waves.shape[1]):
                if run.drive_row[node] >= 0:
                    keep(run.drive[run.drive_row[node], driven, slab], u, s)
                else:
                    clear(u, s)
                for i in range(first[node], first[node + 1]):
                    gather_abreast(u, run.waves[due(ends[i], run.delay, run.offset, period), slab], run.weight[i])
                if r >= 0:
                    respond_abreast(run.maps[r, slab], run.states[r], u, run.out)
                if run.laws.row[node] >= 0:
                    pass_abreast(run.laws, run.laws.row[node], run.drive[:, driven, slab], u, s)
                for i in range(first[node], first[node + 1]):
                    arrived = run.waves[due(ends[i], run.delay, run.offset, period), slab]
                    row = run.record_row[ends[i]]
                    if row >= 0:
                        keep(u, record[row, 0, period * run.waves.shape[1] + slab], s)
                        keep(arrived, record[row, 1, period * run.waves.shape[1] + slab], s)
                    scatter_abreast(u, arrived)
    return 0


@function
def clear(values, rows):
    """Set the first rows to zero, for all copies."""
    for j in range(rows):
        for c in range(values.shape[1]):
            values[j, c] = 0.0


@function
def pass_abreast(laws, row, drive, u, s):
    """Turn the Thévenin waves of one slab into efforts through an element, for all copies."""
    crossing, sign, beyond, signal = laws.crossing, laws.sign[row], laws.beyond_row[row], drive[laws.control_row[row]]
    for c in range(u.shape[1]):
        z = laws.impedance[row, c]
        for j in range(s):
            other = drive[beyond, j, c] if beyond >= 0 else 0.0
            crossing.v[j], crossing.control[j] = sign * (u[j, c] - other), signal[j, c]
        invoke(laws.unit[row], (crossing, laws.at[row, c], s, z))
        for j in range(s):
            u[j, c] -= sign * z * crossing.flow[j]


@function
def due(end, delay, offset, period):
    """The period of a line's buffers that an end works on."""
    line = end >> 1
    turn, slot = divmod(period, delay[line])
    return offset[line] + ((turn ^ end) & 1) * delay[line] + slot


@function
def gather_abreast(u, waves, share):
    """Add an end's share of its arriving waves, for all copies."""
    for j in range(waves.shape[0]):
        for c in range(waves.shape[1]):
            u[j, c] += share[c] * waves[j, c]


@function
def respond_abreast(step, states, u, out):
    """Turn the Thévenin waves of one slab into efforts through loads' states, for all copies."""
    size, copies = step.shape[0], step.shape[2]
    s = size - states.shape[0]
    for i in range(s, size):
        for c in range(copies):
            u[i, c] = states[i - s, c]
    for i in range(size):
        for c in range(copies):
            out[i, c] = step[0, i, c] * u[0, c]
    j = 1
    while j + 4 <= size:  # four at a time: sums are fetched and put back less often
        for i in range(size):
            for c in range(copies):
                one = step[j, i, c] * u[j, c] + step[j + 1, i, c] * u[j + 1, c]
                out[i, c] += one + step[j + 2, i, c] * u[j + 2, c] + step[j + 3, i, c] * u[j + 3, c]
        j += 4
    while j < size:
        for i in range(size):
            for c in range(copies):
                out[i, c] += step[j, i, c] * u[j, c]
        j += 1
    for i in range(s):
        for c in range(copies):
            u[i, c] = out[i, c]
    for i in range(s, size):
        for c in range(copies):
            states[i - s, c] = 0.0 if abs(out[i, c]) < TINY else out[i, c]


@function
def scatter_abreast(u, waves):
    """Replace the arriving waves of an end by those sent back under the efforts, for all copies."""
    for j in range(waves.shape[0]):
        for c in range(waves.shape[1]):
            back = 2.0 * u[j, c] - waves[j, c]
            waves[j, c] = 0.0 if abs(back) < TINY else back


@function
def keep(values, into, rows):
    """Copy the first rows, for all copies."""
    for j in range(rows):
        for c in range(values.shape[1]):
            into[j, c] = values[j, c]


class Values(NamedTuple):
    """Waves in B copies, in periods of K slabs of s points, and instants."""

    waves: Floats4  # (rows, n K, s, B)
    period: Floats  # (B,) in s
    edges: Floats2  # (K + 1, B) of the slabs, as shares of a period
    t: Floats  # (instants,)
    to_powers: Floats2  # (s, s) from values at points to coefficients of powers of 2 x - 1
    found: Floats3  # (rows, B, instants)
    coef: Floats  # (s,)


@unit_of_long_loops
def find_values(sought: Values) -> int:
    """Find the waves at the instants; at a jump the value before it, at t = 0 zero."""
    waves, edges, t = sought.waves, sought.edges, sought.t
    rows, slabs, _, copies = waves.shape
    parts = edges.shape[0] - 1
    for c in range(copies):
        for i in range(t.size):
            place = t[i] / sought.period[c]
            period = min(max(int(np.ceil(place - AT_SLAB_END)) - 1, 0), slabs // parts - 1)
            k = 0
            while k < parts - 1 and edges[k + 1, c] < place - period - AT_SLAB_END:
                k += 1
            width = max(edges[k + 1, c] - edges[k, c], NARROWEST)
            x = min(max((place - period - edges[k, c]) / width, 0.0), 1.0)
            for row in range(rows):
                fill(waves[row, period * parts + k], c, 1.0, sought.to_powers, sought.coef)
                sought.found[row, c, i] = powers(sought.coef, 2.0 * x - 1.0)[0] if t[i] > 0.0 else 0.0
    return 0


class Apart(NamedTuple):
    """Records of two orders on the same slabs, in B copies and periods of K slabs."""

    coarse: Floats5  # (ends, 2, n K, s, B) efforts and arriving waves
    fine: Floats5
    to_fine: Floats2  # (points of the finer, points of the coarser)
    slabs: Integers  # (B,) those that begin before the end
    most: Floats4  # (ends, 3, K, B) differences of efforts, and of flows times z0, and these
    work: Floats2  # (2, B)


@unit_of_long_loops
def find_apart(runs: Apart) -> int:
    """Find the largest differences at the points of the finer order."""
    coarse, fine, most = runs.coarse, runs.fine, runs.most
    ends, _, slabs, points, copies = fine.shape
    u, w = runs.work[0], runs.work[1]
    for row in range(ends):
        for kind in range(most.shape[1]):
            clear(most[row, kind], most.shape[2])
        for slab in range(slabs):
            place = slab % most.shape[2]
            for j in range(points):
                for c in range(copies):
                    u[c], w[c] = -fine[row, 0, slab, j, c], -fine[row, 1, slab, j, c]
                for k in range(coarse.shape[3]):
                    share = runs.to_fine[j, k]
                    for c in range(copies):
                        u[c] += share * coarse[row, 0, slab, k, c]
                        w[c] += share * coarse[row, 1, slab, k, c]
                for c in range(copies):
                    if slab < runs.slabs[c]:
                        flow = abs(fine[row, 1, slab, j, c] - fine[row, 0, slab, j, c])
                        raise_one(most[row, 0, place], c, abs(u[c]))
                        raise_one(most[row, 1, place], c, abs(w[c] - u[c]))
                        raise_one(most[row, 2, place], c, flow)
    return 0


@function
def raise_one(most, c, value):
    """Raise the largest value of a copy to another; NaN persists."""
    if value > most[c] or value != value:
        most[c] = value
