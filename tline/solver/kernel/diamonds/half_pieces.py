"""Half diamonds of a slab in pieces: one after the other, with rectangles of leaving and later arriving waves."""

import numpy as np

from tline.compiled.unit import address_of, function, invoke, unit
from tline.solver.kernel.arithmetic import copy
from tline.solver.kernel.diamonds.full import meet_apart
from tline.solver.kernel.diamonds.half import arrive, begin_half, leave
from tline.solver.kernel.diamonds.pieces import cut_tail, meet_in_pieces
from tline.solver.kernel.fronts.gather import happen_until
from tline.solver.kernel.fronts.respond import rejoin_all, respond_piece
from tline.solver.kernel.fronts.structures import BEGIN, END, FrontRun


@function
def begin_piece(job, g, piece):
    """Put aside the waves that arrive in a piece at the ends of lines with losses."""
    run, fronts = job.run, job.fronts
    network, work, s = run.network, run.work.diamonds, fronts.tools.c.size
    low = network.first[network.group[g]]
    work.width[0] = fronts.work.edges[piece + 1] - fronts.work.edges[piece]
    for i in range(low, network.first[network.group[g + 1]]):
        e, k = network.ends[i], i - low
        if network.diamonds.row[e >> 1] >= 0:
            for j in range(s):
                work.coming[k, j] = fronts.work.arrived[k, piece, j]
            begin_half(network.diamonds, e, work.coming, work, k)
            work.projected[k] = 0


@unit
def respond_in_piece(job: FrontRun, g: int, piece: int, m: int) -> int:
    """Find efforts of a group's nodes under the waves that arrive in one of m pieces."""
    run, fronts = job.run, job.fronts
    network, u, work, s = run.network, run.work.u, run.work.diamonds, fronts.tools.c.size
    one, low = network.group[g], network.first[network.group[g]]
    for node in range(one, network.group[g + 1]):
        q = (node - one) * s
        for j in range(s):
            u[q + j] = fronts.work.u[node - one, piece, j]
        for i in range(network.first[node], network.first[node + 1]):
            e, k = network.ends[i], i - low
            if network.diamonds.row[e >> 1] >= 0:
                arrive(network.diamonds, run.state.halves, e, work, k)
                for j in range(s):
                    u[q + j] += network.weight[i] * (work.arrived[k, j] - work.coming[k, j])
    respond_piece(job, g, piece, m)
    return 0


@function
def end_piece(job, g, piece):
    """Keep the waves that have arrived in a piece at the ends of lines with losses, and the nodes' efforts."""
    run, work, s = job.run, job.fronts.work, job.fronts.tools.c.size
    network, one = run.network, run.network.group[g]
    for i in range(network.first[one], network.first[network.group[g + 1]]):
        if network.diamonds.row[network.ends[i] >> 1] >= 0:
            copy(run.work.diamonds.arrived[i - network.first[one]], work.arrived[i - network.first[one], piece])
    for p in range(network.group[g + 1] - one):
        for i in range(s):
            work.u[p, piece, i] = run.work.u[p * s + i]


@function
def pass_later(job, g, piece, m):
    """Let waves that leave a piece go past those that arrive in later ones. Returns whether all friction was found."""
    run, fronts, network, diamonds = job.run, job.fronts, job.run.network, job.run.network.diamonds
    work, edges, s, done = run.work.diamonds, fronts.work.edges, fronts.tools.c.size, True
    low, zero = network.first[network.group[g]], np.int64(0)
    for node in range(network.group[g], network.group[g + 1]):
        for i in range(network.first[node], network.first[node + 1]):
            e, k = network.ends[i], i - low
            row = diamonds.row[e >> 1]
            if row < 0:
                continue
            left, wide = fronts.work.left[k, piece], edges[piece + 1] - edges[piece]
            for j in range(s):
                left[j] = 2.0 * fronts.work.u[node - network.group[g], piece, j] - fronts.work.arrived[k, piece, j]
            leave(diamonds, left, work, k)
            for after in range(piece + 1, m):
                later, high = fronts.work.arrived[k, after], edges[after + 1] - edges[after]
                mine = fronts.work.u[node - network.group[g], after]
                for j in range(s):
                    mine[j] -= network.weight[i] * later[j]
                if e & 1 == 0:
                    done &= meet_apart(run, row, left, zero, later, zero, wide, high)
                else:
                    done &= meet_apart(run, row, later, zero, left, zero, high, wide)
                for j in range(s):
                    mine[j] += network.weight[i] * later[j]
    return done


@function
def pass_tails(job, g):
    """Let waves sent by a group go past the rests of slabs that are arriving. Returns whether friction was found."""
    run, fronts, network, pieces, done = job.run, job.fronts, job.run.network, job.fronts.pieces, True
    waves, before, s = run.state.waves, run.state.before, fronts.tools.c.size
    for i in range(network.first[network.group[g]], network.first[network.group[g + 1]]):
        e = network.ends[i]
        row, f, o = network.diamonds.row[e >> 1], fronts.rest[e >> 1], run.work.position[e]
        if row < 0:
            continue
        pieces.width[e] = 0.0
        if f > 0.0:
            sent, tail, wave = pieces.of_slab[o // s], pieces.before[e], waves[o : o + s]
            if e & 1 == 0:
                done &= meet_in_pieces(job, row, sent, wave, tail, before[e], 1.0, f)
            else:
                done &= meet_in_pieces(job, row, tail, before[e], sent, wave, f, 1.0)
    return done


@unit
def scatter_half_pieces(job: FrontRun, g: int, slab: int, k: int) -> int:
    """Scatter one slab in pieces at a group with ends of lines with losses. Returns whether that was possible."""
    run, fronts, network, units = job.run, job.fronts, job.run.network, job.run.units
    edges, one = fronts.work.edges, network.group[g]
    m = invoke(units.arrive, (job, np.int64(g), slab, k))
    for i in range(network.first[one], network.first[network.group[g + 1]]):
        e = network.ends[i]
        if network.diamonds.row[e >> 1] >= 0 and fronts.rest[e >> 1] > 0.0:
            cut_tail(job, e)
    for piece in range(m):
        happen_until(network, fronts.events, fronts.counts, g, slab + edges[piece])
        begin_piece(job, g, piece)
        if invoke(units.settle, (run, units.answer_in_piece, address_of(job), g, np.int64(piece), m)) == 0:
            fronts.sizes[BEGIN], fronts.sizes[END] = edges[piece], edges[piece + 1]
            return 0
        end_piece(job, g, piece)
        if not pass_later(job, g, piece, m):
            return 0
    m = rejoin_all(job, g, m)
    if invoke(units.depart, (job, np.int64(g), slab, m)) == 0:
        return 0
    return 1 if pass_tails(job, g) else 0
