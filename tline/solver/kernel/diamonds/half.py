"""Half diamonds at the ends of lines, solved together with the elements at the node.

With p along the wave that leaves an end and q along the one that arrives, 0 ≤ p ≤ q ≤ 1 is a triangle; the end is p =
q. Friction is a polynomial of degree s there, the L2 projection of g(d) with d that of the flow. The node takes the
arriving wave, the triangle the one that it sends; both are found in turns. Where the two waves leave the triangle with
more energy than they bring, they are projected, and then they do not (docs/theory.md).

A delay of D + f slabs: the wave arriving in a slab of the end is the rest of the slab before, and the head of the next.
The rest of that one, past which the leaving wave goes, is a rectangle one slab wide and f high.
"""

import numpy as np

from tline.compiled.unit import address_of, function, invoke, unit
from tline.solver.kernel.arithmetic import ROUNDED, times
from tline.solver.kernel.blocks import begin, gather, load, note, scatter
from tline.solver.kernel.diamonds.full import ROUNDS, bent, flushed, lost, meet_apart
from tline.solver.kernel.laws.answers import keep_states
from tline.solver.kernel.network import Run

BALANCED = 1e-15  # of the energy, by which a half diamond may gain for rounding


@function
def part_of(matrix, values, o, out):
    """Add the product of a matrix with values from a place on."""
    for i in range(matrix.shape[0]):
        total = 0.0
        for j in range(matrix.shape[1]):
            total += matrix[i, j] * values[o + j]
        out[i] += total


@function
def begin_half(diamonds, e, coming, work, k):
    """Put aside the share of the arriving wave in the flow in the triangle."""
    n = diamonds.moments.shape[0]
    for i in range(n):
        work.seen[k, i] = 0.0
    part_of(diamonds.seen, coming[k], 0, work.seen[k])


@function
def arrive(diamonds, taken, e, work, k):
    """Find the wave that arrives at an end under the assumed friction in the triangle."""
    modes, coming, out, s = work.modes[k], work.coming[k], work.arrived[k], work.coming.shape[1]
    for i in range(modes.size):
        modes[i] = 0.0
    part_of(diamonds.moments, taken[e], 0, modes)
    for i in range(s):
        total = 0.0
        for j in range(modes.size):
            total += diamonds.gained[work.projected[k], i, j] * modes[j]
        out[i] = coming[i] + total * work.width[0]


@function
def has_ended(diamonds, change, last, turn, size):
    """Whether an iteration leaves no more than is asked, as its last two changes foretell, or rounding alone."""
    left = change * min(change / last, 1.0) if turn > 0 else change
    return left <= diamonds.exact * size or (change >= 0.5 * last and change <= ROUNDED * size)


@function
def lose_half(diamonds, row, taken, e, sent, work, k, turn, size):
    """Set friction to that of the flow due to the sent wave. Returns the largest change.

    From the second turn on it is taken from its tangent where that is exact enough, for friction is costly.
    """
    flow, modes, wide, change = work.flow, work.modes[k], work.width[0], 0.0
    base, here, slopes = work.tangent[0, k], work.tangent[1, k], work.tangent[2, k]
    reach = wide / np.sqrt(sent.size)
    for i in range(modes.size):
        flow[i] = -work.seen[k, i]
    part_of(diamonds.sent, sent, 0, flow)
    for i in range(modes.size):
        total = 0.0
        for j in range(modes.size):
            total += diamonds.inside[i, j] * modes[j]
        flow[i] -= total * wide
    for i in range(diamonds.values.shape[0]):
        d = 0.0
        for j in range(modes.size):
            d += diamonds.values[i, j] * flow[j]
        if turn == 0 or bent(slopes[i], d, base[i]) > diamonds.exact * size:
            here[i], slopes[i] = lost(diamonds, row, d)
            base[i] = d
        step = (here[i] + slopes[i] * (d - base[i]) - taken[e, i]) / (1.0 + reach * slopes[i])
        taken[e, i] += step
        change = max(change, abs(step))
    return change


@function
def leave(diamonds, sent, work, k):
    """Replace the wave that the node has sent by the one that leaves the triangle."""
    modes, wide = work.modes[k], work.width[0]
    for i in range(sent.size):
        total = 0.0
        for j in range(modes.size):
            total += diamonds.left[work.projected[k], i, j] * modes[j]
        sent[i] -= total * wide


@function
def makes_energy(run, k):
    """Whether the half diamond at the k-th end of a group would give more energy than it gets."""
    diamonds, work, gain, size = run.network.diamonds, run.work.diamonds, 0.0, 0.0
    sent, modes = work.sent, work.modes[k]
    for i in range(sent.size):
        total, wave, coming = 0.0, work.arrived[k, i], work.coming[k, i]
        for j in range(modes.size):
            total += diamonds.left[0, i, j] * modes[j]
        out, weight = sent[i] - work.width[0] * total, diamonds.weight[i]
        gain += weight * (wave * wave - coming * coming + out * out - sent[i] * sent[i])
        size += weight * (wave * wave + sent[i] * sent[i])
    return gain > BALANCED * size


@function
def prepare(run, g):
    """Put aside the waves about to arrive at the ends of a group: at those with friction, the head of a slab."""
    network, waves, before, diamonds, work = (
        run.network,
        run.state.waves,
        run.state.before,
        run.network.diamonds,
        run.work.diamonds,
    )
    low, s, position = network.first[network.group[g]], run.state.before.shape[1], run.work.position
    for i in range(low, network.first[network.group[g + 1]]):
        e, k = network.ends[i], i - low
        o, rest = position[e], network.shift_row[e >> 1]
        if diamonds.row[e >> 1] < 0:
            if rest >= 0:
                invoke(run.units.delay, (run, e, o, np.int64(1)))
            continue
        if rest < 0:
            for j in range(s):
                work.coming[k, j] = waves[o + j]
        else:
            times(network.shift[rest, 0], waves, o, work.coming[k])
            part_of(diamonds.ends[rest, 0], before[e], 0, work.coming[k])
            times(diamonds.ends[rest, 1], waves, o, work.tail[k])
        begin_half(diamonds, e, work.coming, work, k)
        work.projected[k] = 0


@unit
def respond(run: Run, g: int, here: int, column: int) -> int:
    """Find efforts of a group's nodes under the arriving waves."""
    network, u, waves, work = run.network, run.work.u, run.state.waves, run.work.diamonds
    low, n = network.first[network.group[g]], run.state.before.shape[1]
    for node in range(network.group[g], network.group[g + 1]):
        q = np.uint64((node - network.group[g]) * n)
        begin(u, q, n, run.excitation, network.excitation_row[node], here)
        for i in range(network.first[node], network.first[node + 1]):
            e, k = network.ends[i], i - low
            if network.diamonds.row[e >> 1] >= 0:
                arrive(network.diamonds, run.state.halves, e, work, k)
                gather(u, q, n, work.arrived[k], np.uint64(0), network.weight[i])
            else:
                gather(u, q, n, waves, np.uint64(run.work.position[e]), network.weight[i])
    if network.laws.first[g] < network.laws.first[g + 1]:
        invoke(run.units.laws, (run, g, here, n, column))
    elif network.load_at[g] >= 0:
        load(run, g, n, network.step, network.step_at[network.step_row[g]])
    return 0


@function
def settle(run, answer, job, g, here, column):
    """Find friction in the half diamonds at a group, with the waves that it sends. Returns whether that ended.

    Friction begins as in the last slab, or piece.
    """
    network, diamonds, u, n = run.network, run.network.diamonds, run.work.u, run.state.before.shape[1]
    work, last, one = run.work.diamonds, 1e300, run.network.group[g]
    for turn in range(ROUNDS):
        keep_states(run, g, work.kept, turn > 0)
        invoke(answer, (job, g, here, column))
        change, size = 0.0, 0.0
        for node in range(one, network.group[g + 1]):
            q = (node - one) * n
            for i in range(network.first[node], network.first[node + 1]):
                e, k = network.ends[i], i - network.first[one]
                row = diamonds.row[e >> 1]
                if row >= 0:
                    for j in range(n):
                        work.sent[j] = 2.0 * u[q + j] - work.arrived[k, j]
                        size = max(size, abs(work.sent[j]), abs(work.arrived[k, j]))
                    change = max(change, lose_half(diamonds, row, run.state.halves, e, work.sent, work, k, turn, size))
        if not np.isfinite(size):
            return False
        if has_ended(diamonds, change, last, turn, size):
            return True
        last = change
    return False


@unit
def settle_without_gain(run: Run, answer: int, job: int, g: int, here: int, column: int) -> int:
    """Settle, and again with projections where the leaving waves would make energy. Returns whether that ended.

    The unit at the address `answer` finds the efforts, from arriving waves under the assumed friction; `job` is the
    address of its structure.
    """
    network, diamonds, u, made = run.network, run.network.diamonds, run.work.u, False
    work, one, n = run.work.diamonds, run.network.group[g], run.state.before.shape[1]
    for _ in range(2):
        if not settle(run, answer, job, g, here, column):
            return 0
        if made:
            return 1
        for node in range(one, network.group[g + 1]):
            q = (node - one) * n
            for i in range(network.first[node], network.first[node + 1]):
                e, k = network.ends[i], i - network.first[one]
                if diamonds.row[e >> 1] >= 0 and work.projected[k] == 0:
                    for j in range(n):
                        work.sent[j] = 2.0 * u[q + j] - work.arrived[k, j]
                    if makes_energy(run, k):
                        work.projected[k], made = 1, True
        if not made:
            return 1
        keep_states(run, g, work.kept, True)
    return 1


@unit
def pass_halves(run: Run, g: int, here: int, column: int) -> int:
    """Scatter a slab at a group with ends of lines with losses, from sample `here` of the excitation on.

    Returns a node that is not finite, or at which friction was too strong to be found, or -1.
    """
    network, waves, before, diamonds = run.network, run.state.waves, run.state.before, run.network.diamonds
    work, u, position, record = run.work.diamonds, run.work.u, run.work.position, run.record
    one, after, n = network.group[g], network.group[g + 1], before.shape[1]
    low = network.first[one]
    work.width[0] = 1.0
    prepare(run, g)
    units = run.units
    found = invoke(units.settle, (run, units.answer, address_of(run), g, here, column)) == 1
    for node in range(one, after):
        q = np.uint64((node - one) * n)
        for i in range(network.first[node], network.first[node + 1]):
            e, k = network.ends[i], i - low
            o, row = position[e], diamonds.row[e >> 1]
            for j in range(n if row >= 0 else 0):
                waves[o + j] = work.arrived[k, j]
            if network.record_row[e] >= 0:
                note(u, q, n, waves, np.uint64(o), record, network.record_row[e], column + here)
            scatter(u, q, n, waves, np.uint64(o))
            if row < 0:
                continue
            leave(diamonds, waves[o : o + n], work, k)
            if network.shift_row[e >> 1] >= 0:
                f = diamonds.rest[row]
                if e & 1 == 0:
                    found &= meet_apart(run, row, waves, o, work.tail[k], np.int64(0), 1.0, f)
                else:
                    found &= meet_apart(run, row, work.tail[k], np.int64(0), waves, o, f, 1.0)
                for j in range(n):
                    before[e, j] = work.tail[k, j]
            else:
                for j in range(n):
                    waves[o + j] = flushed(waves[o + j])
        if network.effort_row[node] >= 0:
            note(u, q, n, u, q, record, network.effort_row[node], column + here)
        if not np.isfinite(u[q + np.uint64(n - 1)]):
            return node
    return -1 if found else one
