"""The loop over slabs while fronts are in the network; one group, one slab in pieces."""

import numpy as np

from tline.compiled.unit import function, invoke, unit
from tline.solver.kernel.arithmetic import clear, copy, times
from tline.solver.kernel.blocks import node_at, rotate
from tline.solver.kernel.fronts.gather import (
    driven,
    drives_front,
    fronts_at,
    keep,
    part_before,
    regrouped,
    release,
    send,
    unfold,
    united,
)
from tline.solver.kernel.fronts.respond import rejoin_all, respond, settling
from tline.solver.kernel.fronts.structures import ANEW, DONE, FEWER, LIVE, MERGE, NOTED, SCALE, FrontRun
from tline.solver.kernel.laws.crossing import note_states


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
    m = invoke(job.run.units.arrive, (job, np.int64(g), slab, k))
    respond(job, g, slab, m)
    return invoke(job.run.units.depart, (job, np.int64(g), slab, rejoin_all(job, g, m)))


@function
def note_last(network, state, pieces):
    """Keep the last slab, in one piece, that left every end."""
    s = state.before.shape[1]
    for e in network.ends:
        line = e >> 1
        slot, side = state.slot[line] - 1, state.side[line] ^ (e & 1)
        if slot < 0:
            slot, side = slot + network.delay[line], 1 - side
        o = network.offset[line] + (side * network.delay[line] + slot) * s
        for i in range(s):
            pieces.last[e, i] = state.waves[o + i]
        pieces.width[e] = 1.0 if network.diamonds.row[line] < 0 else 0.0


@function
def front_free_slabs(run, fronts, sources, slab, most):
    """Number of slabs ahead, at most `most`, in which no group meets a front."""
    network, state, events, due = run.network, run.state, fronts.events, sources.due
    delay, pieces, s = network.delay, fronts.pieces, state.before.shape[1]
    for g in range(events.due.size):
        if fronts.settled[g] > slab + MERGE:
            return 0
        if events.due[g] < events.first[g + 1]:
            most = min(most, int(np.floor(events.at[events.due[g]] - slab + MERGE / 2)))
    for r in range(due.size):
        if due[r] < sources.first[r + 1]:
            most = min(most, sources.slab[due[r]] - slab)
    if fronts.counts[LIVE] == 0:
        return most
    for e in range(2 * delay.size):
        if pieces.before[e] >= 0:
            return 0
    for line in range(delay.size):
        for end in range(2):
            slot, side = state.slot[line], state.side[line] ^ end
            for ahead in range(min(most, delay[line])):
                if slot == delay[line]:
                    slot, side = 0, 1 - side
                if pieces.of_slab[network.offset[line] // s + side * delay[line] + slot] >= 0:
                    most = ahead
                    break
                slot += 1
    return most


@function
def scatter_whole(run, fronts, g, slab, k):
    """Scatter one slab without fronts at a group. Returns a node that is not finite, or -1."""
    network, waves, pieces, s = run.network, run.state.waves, fronts.pieces, run.state.before.shape[1]
    node = invoke(run.units.scatter, (run, g, k, np.int64(0), np.int64(1), slab - k))
    for i in range(network.first[network.group[g]], network.first[network.group[g + 1]]):
        e = network.ends[i]
        for j in range(s):
            pieces.last[e, j] = waves[run.work.position[e] + j]
        pieces.width[e] = 1.0 if network.diamonds.row[e >> 1] < 0 else 0.0
    return node


@function
def meets_front(run, fronts, sources, g, slab):
    """Whether a group meets a front in a slab; finds the places where its ends work."""
    network, state, pieces, events, s = run.network, run.state, fronts.pieces, fronts.events, run.state.before.shape[1]
    i, delay = events.due[g], network.delay
    met = i < events.first[g + 1] and events.at[i] - slab < 1.0 - MERGE / 2
    met |= fronts.settled[g] > slab + MERGE
    for i in range(fronts.excitations.first[g], fronts.excitations.first[g + 1]):
        met |= drives_front(sources, fronts.excitations.row[i], slab)
    for i in range(network.first[network.group[g]], network.first[network.group[g + 1]]):
        e = network.ends[i]
        line = e >> 1
        o = network.offset[line] + ((state.side[line] ^ (e & 1)) * delay[line] + state.slot[line]) * s
        run.work.position[e] = o
        met |= pieces.of_slab[o // s] >= 0 or pieces.before[e] >= 0
    return met


@function
def scatter_all(job, slab, k):
    """Scatter one slab at all groups. Returns -1, or a node whose group has an effort that is not finite."""
    run, fronts, sources, network, units = job.run, job.fronts, job.sources, job.run.network, job.run.units
    for g in range(network.group.size - 1):
        met = meets_front(run, fronts, sources, g, slab)
        if met:
            halves = units.diamonds != 0 and network.diamonds.at_group[g]
            if invoke(units.halves_in_pieces if halves else units.pieces, (job, np.int64(g), slab, k)) == 0:
                return network.group[g]
        elif scatter_whole(run, fronts, g, slab, k) >= 0:
            return network.group[g]
    return -1


@function
def advance_past(job, k, n_slabs, column):
    """Advance by slabs in which no group meets a front. Returns as `advance_fronts` does.

    While fronts are live, cells of friction contain them: cells that are due are left to the unit that knows pieces.
    """
    run, since, cell, done = job.run, job.run.state.since, job.run.network.diamonds.cell, np.int64(0)
    if run.units.diamonds == 0 or job.fronts.counts[LIVE] == 0:
        return invoke(run.units.advance, (run, k, n_slabs, column))
    while done < n_slabs:
        count = n_slabs - done
        for r in range(since.size):
            count = min(count, cell[r] - since[r])
        for r in range(since.size):
            since[r] -= count
        node = invoke(run.units.advance, (run, k + done, count, column))
        if node >= 0:
            return node
        line = invoke(run.units.diamonds_in_pieces, (job, count))
        if line >= 0:
            return node_at(run.network, 2 * line)
        done += count
    return -1


@unit
def advance_fronts(job: FrontRun, first_slab: int, n_slabs: int) -> int:
    """Advance all nodes slab by slab with fronts as breakpoints, until none is left or the log is full.

    Returns -1, or the number of a node whose effort, or that of another in its group, is no longer finite; the number
    of slabs done is the last of the counts.
    """
    run, fronts, sources = job.run, job.fronts, job.sources
    network, state, counts, due, units = run.network, run.state, fronts.counts, sources.due, run.units
    k, places = np.int64(0), 2 * run.record.shape[0] * fronts.at_node
    while k < n_slabs:
        counts[DONE], slab = k, first_slab + k
        log_is_full = counts[NOTED] + places > fronts.log.where.shape[0]
        if log_is_full or (counts[LIVE] == 0 and k >= fronts.lull):
            return -1
        for r in range(due.size):
            while due[r] < sources.first[r + 1] and sources.slab[due[r]] < slab:
                due[r] += 1
        if units.halves == 0 or counts[LIVE] == 0:
            free = front_free_slabs(run, fronts, sources, slab, n_slabs - k)
            if free > 1:
                node = advance_past(job, k, free, first_slab)
                if node >= 0:
                    return node
                note_last(network, state, fronts.pieces)
                k += free
                continue
        node = scatter_all(job, slab, k)
        if node >= 0:
            return node
        rotate(network, state, network.blocks.far_lines, 1)
        rotate(network, state, network.blocks.near_lines, 1)
        line = invoke(units.diamonds_in_pieces, (job, np.int64(1))) if units.diamonds != 0 else -1
        if line >= 0:
            return node_at(network, 2 * line)
        k += 1
    counts[DONE] = n_slabs
    return -1
