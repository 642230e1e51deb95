"""Efforts of a group in the pieces of one slab: Radau IIA steps of any width.

Groups with lumped lines settle after fronts.
"""

import numpy as np

from tline.compiled.unit import function, invoke, unit
from tline.solver.kernel.arithmetic import copy, eliminate, eliminate_all, times
from tline.solver.kernel.blocks import load
from tline.solver.kernel.fronts.gather import happen_until, regrouped
from tline.solver.kernel.fronts.structures import BEGIN, DROPPED, END, FEWER, MERGE, FrontRun
from tline.solver.kernel.laws.crossing import pass_laws


@function
def collocate(fronts, at, k, h, w, x, row):
    """One Radau IIA step of width h of dx/dt = A x + B w, for k inputs; w becomes C x + D w, x the state at the end.

    The matrix [A B; C D] begins at a place of the systems' entries.
    """
    entries, radau, stages = fronts.systems.entries, fronts.tools.radau, fronts.work.stages
    s, n = radau.shape[0], x.size
    size, width = s * n, n + k
    for i in range(s):
        for p in range(n):
            stage, line = i * n + p, at + p * width
            stages[stage, size] = x[p]
            for j in range(s):
                for q in range(k):
                    stages[stage, size] += h * radau[i, j] * entries[line + n + q] * w[q * s + j]
                for q in range(n):
                    stages[stage, j * n + q] = (i == j and p == q) - h * radau[i, j] * entries[line + q]
    eliminate(stages, size)
    for i in range(s):
        for p in range(k):
            row[p] = 0.0
            for q in range(n):
                row[p] += entries[at + (n + p) * width + q] * stages[i * n + q, size]
            for q in range(k):
                row[p] += entries[at + (n + p) * width + n + q] * w[q * s + i]
        for p in range(k):
            w[p * s + i] = row[p]
    for p in range(n):
        x[p] = stages[(s - 1) * n + p, size]


@function
def map_of(fronts, at, k, n, h, out):
    """The map over a piece of width h of dx/dt = A x + B w, from k waves w at the points and n states, row by row."""
    entries, radau, stages = fronts.systems.entries, fronts.tools.radau, fronts.work.stages
    s, size, width, columns = radau.shape[0], radau.shape[0] * n, n + k, k * radau.shape[0] + n
    for i in range(s):
        for p in range(n):
            stage, line = i * n + p, at + p * width
            for j in range(s):
                for q in range(k):
                    stages[stage, size + q * s + j] = h * radau[i, j] * entries[line + n + q]
                for q in range(n):
                    stages[stage, j * n + q] = (i == j and p == q) - h * radau[i, j] * entries[line + q]
            for q in range(n):
                stages[stage, size + k * s + q] = p == q
    eliminate_all(stages, size, columns)
    for p in range(k):
        for i in range(s):
            place, line = (p * s + i) * columns, at + (n + p) * width
            for c in range(columns):
                total = entries[line + n + c // s] if c < k * s and c % s == i else 0.0
                for q in range(n):
                    total += entries[line + q] * stages[i * n + q, size + c]
                out[place + c] = total
    for p in range(n):
        for c in range(columns):
            out[(k * s + p) * columns + c] = stages[(s - 1) * n + p, size + c]


@function
def settling(fronts, g, slab, m, anew):
    """Add breakpoints where the group has settled after fronts; in `outer` leave out those that arrive before that.

    Marks the settling pieces. Returns the number of pieces with all breakpoints, and without those left out.
    """
    edges, outer, unsettled, given = fronts.work.edges, fronts.work.outer, fronts.work.unsettled, fronts.work.size
    until, n, kept, outer[0] = fronts.settled[g] - slab, 0, 0, 0.0
    for i in range(1, m + 1):
        given[i] = edges[i]
    if anew > 0.0:
        until = fronts.settle[g]
    for i in range(1, m + 1):
        at = given[i]
        unsettled[n] = until > edges[n] + MERGE
        if MERGE < until < at - MERGE and n + 2 < fronts.at_node:
            n, kept = n + 1, kept + 1
            edges[n], outer[kept], unsettled[n] = until, until, False
        if i < m and n + 2 < fronts.at_node:
            n += 1
            edges[n] = at
            if at > until + MERGE:
                kept += 1
                outer[kept] = at
            until = at + fronts.settle[g]
        elif i < m:
            fronts.counts[DROPPED] += 1
    edges[n + 1], outer[kept + 1] = 1.0, 1.0
    fronts.settled[g] = slab + until
    return n + 1, kept + 1


@function
def rejoin(fronts, values, n, m):
    """Project n pieces between the edges on m wider ones between the outer edges."""
    work, tools = fronts.work, fronts.tools
    edges, outer, span, coef, whole = work.edges, work.outer, work.span, work.given, work.whole
    for j in range(n):
        span[j, 0], span[j, 1] = edges[j], edges[j + 1]
        times(tools.to_legendre, values[j], 0, coef[j])
    regrouped(span, coef, n, outer, m, tools, whole, values)


@function
def rejoin_all(job, g, m):
    """Leave out breakpoints that only settling needs, in all waves of a group. Returns the number of pieces left."""
    fronts, network, work, fewer = job.fronts, job.run.network, job.fronts.work, job.fronts.counts[FEWER]
    if not 0 < fewer < m:
        return m
    low = network.first[network.group[g]]
    for p in range(network.group[g + 1] - network.group[g]):
        rejoin(fronts, work.u[p], m, fewer)
    for i in range(low, network.first[network.group[g + 1]]):
        rejoin(fronts, work.arrived[i - low], m, fewer)
        if network.diamonds.row[network.ends[i] >> 1] >= 0:
            rejoin(fronts, work.left[i - low], m, fewer)
    copy(work.outer, work.edges)
    return fewer


@function
def collocate_finely(run, fronts, at, k, width, settle, x):
    """Collocate in steps of the settling time of a group, and a last one, in slabs; the effort is projected."""
    tools, s, w, row = fronts.tools, fronts.tools.c.size, run.work.u, run.work.row
    span, coef, whole, steps = fronts.work.span, fronts.work.given, fronts.work.whole, fronts.work.steps
    edges, values, flat, out = steps.edges, steps.values, steps.wave, steps.out
    most, m = edges.size - 2, 1
    while m <= most and m * settle < most * (width - MERGE):
        edges[m] = m * settle / (most * width)
        m += 1
    edges[0], edges[m] = 0.0, 1.0
    for p in range(k):
        span[0, 0], span[0, 1] = 0.0, 1.0
        times(tools.to_legendre, w, p * s, coef[0])
        regrouped(span, coef, np.int64(1), edges, m, tools, whole, values[p])
    for j in range(m):
        for p in range(k):
            for i in range(s):
                flat[p * s + i] = values[p, j, i]
        h = fronts.step * width * (edges[j + 1] - edges[j])
        collocate(fronts, at, k, h, flat, x, row)
        for p in range(k):
            for i in range(s):
                values[p, j, i] = flat[p * s + i]
    for p in range(k):
        for j in range(m):
            span[j, 0], span[j, 1] = edges[j], edges[j + 1]
            times(tools.to_legendre, values[p, j], 0, coef[j])
        regrouped(span, coef, m, steps.ends, np.int64(1), tools, whole, out)
        for i in range(s):
            w[p * s + i] = out[0, i]


@unit
def respond_by_map(job: FrontRun, g: int, piece: int, m: int) -> int:
    """Turn the Thévenin waves of a piece at a group with a map into efforts; the piece is the slab if m is 1."""
    run, fronts = job.run, job.fronts
    network, systems, wave, s = run.network, fronts.systems, run.work.u, fronts.tools.c.size
    edges, x, k, r = fronts.work.edges, network.load_at[g], network.group[g + 1] - network.group[g], network.step_row[g]
    n, width = network.step_states[r], edges[piece + 1] - edges[piece]
    states = run.state.load[x : x + n]
    if m == 1 or n == 0:
        load(run, g, s, network.step, network.step_at[r])
    elif not fronts.work.unsettled[piece]:
        collocate(fronts, systems.at[r], k, fronts.step * width, wave, states, run.work.row)
    elif abs(width - fronts.settle[g]) < MERGE:
        load(run, g, s, systems.settling, systems.settling_at[r])
    else:
        collocate_finely(run, fronts, systems.at[r], k, width, fronts.settle[g], states)
    return 0


@unit
def respond_with_laws(job: FrontRun, g: int, piece: int, m: int) -> int:
    """Respond at a group with a map and laws."""
    run, fronts = job.run, job.fronts
    network, edges, r = run.network, fronts.work.edges, run.network.step_row[g]
    n, h = network.step_states[r], fronts.step * (edges[piece + 1] - edges[piece])
    ports = network.group[g + 1] - network.group[g] + network.laws.first[g + 1] - network.laws.first[g]
    own = n > 0 and m > 1
    if own:
        map_of(fronts, fronts.systems.at[r], ports, n, h, run.work.map)
    pass_laws(run, g, fronts.tools.c.size, h, np.int64(own))
    return 0


@function
def respond_piece(job, g, piece, m):
    """Turn the Thévenin waves of one of m pieces at a group, in the workspace of slabs, into the nodes' efforts."""
    run, fronts = job.run, job.fronts
    network, edges, s = run.network, fronts.work.edges, fronts.tools.c.size
    count = network.laws.first[g + 1] - network.laws.first[g]
    for e in range(count):
        for i in range(s):
            run.work.control[e, i] = fronts.work.control[e, piece, i]
    if network.load_at[g] < 0 and count > 0:
        width = fronts.step * (edges[piece + 1] - edges[piece])
        pass_laws(run, np.int64(g), s, width, np.int64(0))
    elif count > 0:
        invoke(run.units.respond_with_laws, (job, np.int64(g), np.int64(piece), m))
    elif network.load_at[g] >= 0:
        invoke(run.units.respond, (job, np.int64(g), np.int64(piece), m))
    for e in range(count):
        for i in range(s):
            fronts.work.into[e, piece, i] = run.work.into[e, i]


@function
def respond(job, g, slab, m):
    """Turn the Thévenin waves of m pieces at a group into the nodes' efforts; switches move where pieces begin.

    A piece for which no flow is found ends it, and is kept in mind.
    """
    run, fronts = job.run, job.fronts
    network, s, wave = run.network, fronts.tools.c.size, run.work.u
    edges, u, k = fronts.work.edges, fronts.work.u, network.group[g + 1] - network.group[g]
    for piece in range(m):
        happen_until(network, fronts.events, fronts.counts, g, slab + edges[piece])
        for p in range(k):
            for i in range(s):
                wave[p * s + i] = u[p, piece, i]
        respond_piece(job, g, piece, m)
        for p in range(k):
            for i in range(s):
                u[p, piece, i] = wave[p * s + i]
        if not np.isfinite(wave[s - 1]):
            fronts.sizes[BEGIN], fronts.sizes[END] = edges[piece], edges[piece + 1]
            return
