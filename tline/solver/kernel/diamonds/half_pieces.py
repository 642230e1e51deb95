"""Half diamonds of a slab in pieces: one after the other, with rectangles of leaving and later arriving waves."""

import numpy as np

from tline.compiled.unit import function, invoke, unit
from tline.solver.kernel.diamonds.full import ROUNDS, meet_apart
from tline.solver.kernel.diamonds.half import arrive, begin_half, has_ended, keep_states, leave, lose_half, makes_energy
from tline.solver.kernel.diamonds.pieces import cut_tail, meet_in_pieces
from tline.solver.kernel.fronts.advance import happen_until
from tline.solver.kernel.fronts.respond import respond_piece
from tline.solver.kernel.fronts.settle import rejoin
from tline.solver.kernel.fronts.structures import BEGIN, END, FEWER, FrontRun


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


@function
def settle_piece(job, g, piece, m):
    """Find friction in the half diamonds of a piece, with the waves of the group. Returns whether that ended."""
    run, fronts = job.run, job.fronts
    network, diamonds, u, work = run.network, run.network.diamonds, run.work.u, run.work.diamonds
    s, one, last, halves = fronts.tools.c.size, network.group[g], 1e300, run.state.halves
    arrived, low, zero = fronts.work.arrived, network.first[network.group[g]], np.int64(0)
    for turn in range(ROUNDS):
        keep_states(run, g, work.kept, turn > 0)
        for node in range(one, network.group[g + 1]):
            q = (node - one) * s
            for j in range(s):
                u[q + j] = fronts.work.u[node - one, piece, j]
            for i in range(network.first[node], network.first[node + 1]):
                e, k = network.ends[i], i - low
                if diamonds.row[e >> 1] >= 0:
                    arrive(diamonds, halves, e, work.coming, work, k, arrived[k, piece], zero)
                    for j in range(s):
                        u[q + j] += network.weight[i] * (arrived[k, piece, j] - work.coming[k, j])
        respond_piece(job, g, piece, m)
        change, size = 0.0, 0.0
        for node in range(one, network.group[g + 1]):
            q = (node - one) * s
            for i in range(network.first[node], network.first[node + 1]):
                e, k = network.ends[i], i - low
                row = diamonds.row[e >> 1]
                if row >= 0:
                    for j in range(s):
                        work.sent[j] = 2.0 * u[q + j] - arrived[k, piece, j]
                        fronts.work.left[k, piece, j] = work.sent[j]
                        size = max(size, abs(work.sent[j]), abs(arrived[k, piece, j]))
                    change = max(change, lose_half(diamonds, row, halves, e, work.sent, work, k, turn, size))
        if not np.isfinite(size):
            return False
        if has_ended(diamonds, change, last, turn, size):
            return True
        last = change
    return False


@function
def check_piece(job, g, piece):
    """Mark half diamonds for projection where the leaving waves make energy. Returns whether there is any."""
    run, network, work, found = job.run, job.run.network, job.run.work.diamonds, False
    arrived, left, low = job.fronts.work.arrived, job.fronts.work.left, network.first[network.group[g]]
    for i in range(low, network.first[network.group[g + 1]]):
        k = i - low
        if network.diamonds.row[network.ends[i] >> 1] >= 0 and work.projected[k] == 0:
            given = work.coming[k], arrived[k, piece], left[k, piece]
            if makes_energy(run.network.diamonds, given[0], given[1], given[2], work, k):
                work.projected[k], found = 1, True
    return found


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
    run, fronts, network, work = job.run, job.fronts, job.run.network, job.fronts.work
    edges, one, s = work.edges, network.group[g], fronts.tools.c.size
    m = invoke(run.units.arrive, (job, np.int64(g), slab, k))
    fewer = fronts.counts[FEWER]
    low, high = network.first[one], network.first[network.group[g + 1]]
    for i in range(low, high):
        e = network.ends[i]
        if network.diamonds.row[e >> 1] >= 0 and fronts.rest[e >> 1] > 0.0:
            cut_tail(job, e)
    for piece in range(m):
        happen_until(network, fronts.events, fronts.counts, g, slab + edges[piece])
        begin_piece(job, g, piece)
        found = settle_piece(job, g, piece, m)
        if found and check_piece(job, g, piece):
            keep_states(run, g, run.work.diamonds.kept, True)
            found = settle_piece(job, g, piece, m)
        if not found:
            fronts.sizes[BEGIN], fronts.sizes[END] = edges[piece], edges[piece + 1]
            return 0
        for p in range(network.group[g + 1] - one):
            for i in range(s):
                work.u[p, piece, i] = run.work.u[p * s + i]
        if not pass_later(job, g, piece, m):
            return 0
    if 0 < fewer < m:
        for p in range(network.group[g + 1] - one):
            rejoin(fronts, work.u[p], m, fewer)
        for i in range(low, high):
            rejoin(fronts, work.arrived[i - low], m, fewer)
            rejoin(fronts, work.left[i - low], m, fewer)
        m = fewer
        for i in range(edges.size):
            edges[i] = work.outer[i]
    if invoke(run.units.depart, (job, np.int64(g), slab, m)) == 0:
        return 0
    return 1 if pass_tails(job, g) else 0
