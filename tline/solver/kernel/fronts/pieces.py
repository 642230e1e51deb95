"""One group, one slab in pieces."""

import numpy as np

from tline.compiled.unit import function, invoke, unit
from tline.solver.kernel.arithmetic import clear, copy, times
from tline.solver.kernel.fronts.gather import driven, fronts_at, part_before, regrouped, unfold, united
from tline.solver.kernel.fronts.merge import keep, release, send
from tline.solver.kernel.fronts.respond import respond
from tline.solver.kernel.fronts.settle import rejoin, settling
from tline.solver.kernel.fronts.structures import ANEW, FEWER, SCALE, FrontRun
from tline.solver.kernel.laws.passing import note_states


@function
def arrive_in_pieces(job, g, slab, k, m):
    """Gather the waves that arrive at a group, and their Thévenin waves, in m pieces; earlier pieces are released."""
    run, fronts, sources = job.run, job.fronts, job.sources
    network, waves, before, position = run.network, run.state.waves, run.state.before, run.work.position
    pieces, tools, work, s = fronts.pieces, fronts.tools, fronts.work, run.state.before.shape[1]
    edges, arrived, span, given, whole = work.edges, work.arrived, work.span, work.given, work.whole
    low = network.first[network.group[g]]
    for node in range(network.group[g], network.group[g + 1]):
        mine, r = work.u[node - network.group[g]], network.excitation_row[node]
        if r >= 0:
            n = driven(sources, run.excitation, r, slab, k * s, tools.to_legendre, span, given)
            regrouped(span, given, n, edges, m, tools, whole, mine)
        else:
            for j in range(m):
                clear(mine[j])
        for i in range(network.first[node], network.first[node + 1]):
            e = network.ends[i]
            rest, now = fronts.rest[e >> 1], pieces.of_slab[position[e] // s]
            n = np.int64(0)
            if rest > 0.0:
                wide = part_before(network, e, rest)
                n = unfold(fronts, pieces.before[e], before[e], 0, wide, rest - wide, n)
            n = unfold(fronts, now, waves, position[e], 1.0, rest, n)
            regrouped(span, given, n, edges, m, tools, whole, arrived[i - low])
            pieces.of_slab[position[e] // s] = -1
            if rest > 0.0:
                release(pieces, pieces.before[e], fronts.counts)
                pieces.before[e] = now
                for j in range(s):
                    before[e, j] = waves[position[e] + j]
            else:
                release(pieces, now, fronts.counts)
            for j in range(m):
                for p in range(s):
                    arrived[i - low, j, p] = network.passed[e >> 1] * arrived[i - low, j, p] + network.moved[e]
                    mine[j, p] += network.weight[i] * arrived[i - low, j, p]


@function
def control_pieces(job, g, slab, k, m):
    """Control signals of a group's elements, in m pieces."""
    run, fronts, laws, work = job.run, job.fronts, job.run.network.laws, job.fronts.work
    tools, s = fronts.tools, fronts.tools.c.size
    for i in range(laws.first[g], laws.first[g + 1]):
        mine, r = work.control[i - laws.first[g]], laws.excitation_row[i]
        if r >= 0:
            n = driven(job.sources, run.excitation, r, slab, k * s, tools.to_legendre, work.span, work.given)
            regrouped(work.span, work.given, n, work.edges, m, tools, work.whole, mine)
        else:
            for j in range(m):
                for p in range(s):
                    mine[j, p] = laws.control[i]


@unit
def arrive(job: FrontRun, g: int, slab: int, k: int) -> int:
    """Gather in pieces the waves that arrive at a group in a slab, and its control signals. Returns their number."""
    fronts, work, fewer = job.fronts, job.fronts.work, np.int64(0)
    n = fronts_at(job.run, fronts, job.sources, g, slab)
    m, anew = united(work.place, work.size, n, work.edges, fronts.at_node, fronts.counts, fronts.sizes)
    if fronts.settle[g] > 0.0:
        m, fewer = settling(fronts, g, slab, m, anew)
    fronts.counts[FEWER], fronts.sizes[ANEW] = fewer, anew if fronts.fractional != 0 else 0.0
    arrive_in_pieces(job, g, slab, k, m)
    control_pieces(job, g, slab, k, m)
    return m


@unit
def depart(job: FrontRun, g: int, slab: int, m: int) -> int:
    """Record m pieces at a group, and send its waves. Returns whether the efforts at the pieces' ends are finite."""
    run, fronts, network, work = job.run, job.fronts, job.run.network, job.fronts.work
    part, coef, edges, arrived, s, total = work.part, work.coef, work.edges, work.arrived, fronts.tools.c.size, 0.0
    low, anew = network.first[network.group[g]], fronts.sizes[ANEW]
    for node in range(network.group[g], network.group[g + 1]):
        mine = work.u[node - network.group[g]]
        for i in range(network.first[node], network.first[node + 1]):
            e = network.ends[i]
            if network.record_row[e] >= 0:
                keep(fronts, run.record, network.record_row[e], slab, m, arrived[i - low], mine)
            for j in range(m):
                for p in range(s):
                    part[p] = 2.0 * mine[j, p] - arrived[i - low, j, p]
                    if network.diamonds.row[e >> 1] >= 0:
                        part[p] = work.left[i - low, j, p]
                    fronts.sizes[SCALE] = max(fronts.sizes[SCALE], abs(part[p]))
                times(fronts.tools.to_legendre, part, 0, coef[j])
            copy(edges, work.own)
            send(fronts, e, run.state.waves, run.work.position[e], m, anew)
        if network.effort_row[node] >= 0:
            keep(fronts, run.record, network.effort_row[node], slab, m, mine, mine)
        for j in range(m):
            total += mine[j, s - 1]
    for e in range(network.laws.first[g], network.laws.first[g + 1]):
        into = work.into[e - network.laws.first[g]]
        if network.laws.record_row[e] >= 0:
            keep(fronts, run.record, network.laws.record_row[e], slab, m, into, into)
            for p in range(s):
                note_states(run, e, slab * s + p)
    return 1 if np.isfinite(total) else 0


@unit
def scatter_pieces(job: FrontRun, g: int, slab: int, k: int) -> int:
    """Scatter one slab in pieces at a group. Returns whether the efforts at the end of each piece are finite."""
    run, fronts, network, work = job.run, job.fronts, job.run.network, job.fronts.work
    m = invoke(run.units.arrive, (job, np.int64(g), slab, k))
    respond(job, g, slab, m)
    fewer = fronts.counts[FEWER]
    if 0 < fewer < m:
        low = network.first[network.group[g]]
        for node in range(network.group[g], network.group[g + 1]):
            mine = work.u[node - network.group[g]]
            rejoin(fronts, mine, m, fewer)
            for i in range(network.first[node], network.first[node + 1]):
                rejoin(fronts, work.arrived[i - low], m, fewer)
        m = fewer
        copy(work.outer, work.edges)
    return invoke(run.units.depart, (job, np.int64(g), slab, m))
