"""Friction in cells many slabs wide and high: it is as smooth as the waves that it takes from, and these change slowly.

A cell is a rectangle of the (ξ, η) plane where k slabs of a meet k of b. It advances the L2 projections of both on one
polynomial, or one on each side of a jump, as a diamond does, and attenuates the difference of the waves from them.
Projections are of a low order at any order of the waves. Cells that touch a node would bind it for k slabs, so they are
left out: the loss there is added to that of the cells beside them, to each part of a wave as much as it misses
(`weigh`).

Memory and leakage of lines in cells: circuits, each in its place along the line, from one cell there to the next.

A circuit takes one polynomial of each wave over its cell, and is advanced by Radau IIA. The difference of a wave from
its polynomial changes so fast, as fronts do, that the circuit answers at once: it is attenuated.
"""

import numpy as np

from tline.compiled.unit import function, invoke, unit, unit_of_long_loops
from tline.solver.kernel.arithmetic import TINY, copy, times
from tline.solver.kernel.blocks import FAR
from tline.solver.kernel.diamonds.full import MIDDLE, NEWTON, ROUNDS, flushed, lost, places_in_ring
from tline.solver.kernel.network import PARTS, SQUARE, Run


@function
def weigh(run, row, i, j, first, last):
    """Weigh friction in part i of a and j of b, so that it includes the places at an end without a cell.

    With p and q in [0, 1] along the k slabs of a and b, and o over k slabs that the cells leave beside half ones, at
    end 1 a misses 1 - p + o and b q + o of a cell: both are integrals of (1 - p + o)(q + o)/(1/2 + o).
    """
    diamonds, work, c = run.network.diamonds, run.work.diamonds, run.network.diamonds.tools.c
    k = diamonds.cell[row]
    over, a, b, inside = diamonds.over[row] / k, work.edges[0], work.edges[1], MIDDLE if c.size == 1 else 1.0
    for x in range(c.size):
        p = (a[i] + inside * c[x] * (a[i + 1] - a[i])) / k
        for y in range(c.size):
            q, total = (b[j] + inside * c[y] * (b[j + 1] - b[j])) / k, 1.0
            if first:
                total += (1.0 - p + over) * (q + over) / (0.5 + over)
            if last:
                total += (1.0 - q + over) * (p + over) / (0.5 + over)
            work.weight[x, y] = total


@function
def meet_in_cell(run, row, n, m, first, last):
    """Advance n parts of a past m of b. Returns whether friction was found."""
    work, done = run.work.diamonds, True
    for i in range(n):
        for j in range(m):
            weigh(run, row, i, j, first, last)
            copy(work.parts[0, i], work.a)
            copy(work.parts[1, j], work.b)
            wide, high = work.edges[0, i + 1] - work.edges[0, i], work.edges[1, j + 1] - work.edges[1, j]
            done &= invoke(run.units.rectangle, (run, row, wide, high)) == 1
            copy(work.a, work.parts[0, i])
            copy(work.b, work.parts[1, j])
    attenuate(run, row, n, m, first, last)
    return done


@function
def attenuate(run, row, n, m, first, last):
    """Put in the workspace the share that friction leaves of waves beyond their projections, n parts of a, m of b.

    It follows from the slope of friction at the mean flow: without it oscillations faster than cells would persist.
    """
    diamonds, work = run.network.diamonds, run.work.diamonds
    k, weight, d = diamonds.cell[row], 1.0, diamonds.steady[row, 2] - diamonds.steady[row, 0]
    for i in range(n):
        d += (work.edges[0, i + 1] - work.edges[0, i]) / k * work.parts[2, i, 0]
    for j in range(m):
        d -= (work.edges[1, j + 1] - work.edges[1, j]) / k * work.parts[3, j, 0]
    for at_end in (first, last):
        if at_end:
            weight += 0.5 + diamonds.over[row] / k
    _, slope = lost(diamonds, row, d)
    work.rest[0] = 1.0 / (1.0 + k * weight * slope)


@function
def fetch(run, row, o, at, ring, side):
    """Copy the slabs of a cell from a line's ring, from a place on. Returns the number of parts between jumps."""
    diamonds, waves, work, s = run.network.diamonds, run.state.waves, run.work.diamonds, run.state.before.shape[1]
    slabs, edges, k, begin = work.slabs[side], work.edges[side], diamonds.cell[row], o + at * s
    whole, size, n = min(k, ring - at) * s, 0.0, 1
    for i in range(whole):
        slabs[i] = waves[begin + i]
    for i in range(k * s - whole):
        slabs[whole + i] = waves[o + i]
    for i in range(s - 1, k * s, s):
        size = max(size, abs(slabs[i]))
    for i in range(1, k):
        jump = -slabs[i * s - 1]
        for j in range(s):
            jump += diamonds.begin[j] * slabs[i * s + j]
        if abs(jump) > diamonds.jump * size and n < PARTS:
            edges[n] = i
            n += 1
    edges[0], edges[n] = 0.0, k
    return n


@function
def shape(run, length):
    """Put Legendre polynomials over a number of slabs, at the points of these, in the workspace, unless kept there."""
    work, c = run.work.diamonds, run.network.laws.tools.c
    if work.shaped[0] == length:
        return
    work.shaped[0] = length
    for i in range(length):
        for j in range(c.size):
            x = i * c.size + j
            y = 2.0 * (i + c[j]) / length - 1.0
            work.shape[0, x], last, here = 1.0, 1.0, y
            for k in range(1, work.a.size):
                work.shape[k, x] = here
                last, here = here, ((2 * k + 1) * y * here - k * last) / (k + 1)


@function
def take_up(run, side, n):
    """Project the slabs of a cell on one polynomial in each of n parts."""
    work, diamonds, s = run.work.diamonds, run.network.diamonds, run.state.before.shape[1]
    for part in range(n):
        low, high = int(work.edges[side, part]), int(work.edges[side, part + 1])
        shape(run, high - low)
        for k in range(work.a.size):
            row, total = work.shape[k], 0.0
            for j in range(s):
                each = 0.0
                for i in range(high - low):
                    each += row[i * s + j] * work.slabs[side, (low + i) * s + j]
                total += diamonds.weight[j] * each
            work.parts[side + 2, part, k] = (2 * k + 1) * total / (high - low)
        times(diamonds.tools.to_points, work.parts[side + 2, part], 0, work.parts[side, part])


@function
def find_change(run, side, part):
    """Put the coefficients of a part's new values, less the remaining share of the old ones, in the workspace."""
    work = run.work.diamonds
    times(run.network.diamonds.tools.to_legendre, work.parts[side, part], 0, work.a)
    for k in range(work.a.size):
        work.a[k] -= work.rest[0] * work.parts[side + 2, part, k]


@function
def put_back(run, row, o, at, ring, side, n):
    """Write the slabs of a cell back with the changes."""
    waves, work, s = run.state.waves, run.work.diamonds, run.state.before.shape[1]
    slabs, size, begin = work.slabs[side], run.network.diamonds.cell[row] * s, o + at * s
    for part in range(n):
        find_change(run, side, part)
        low, high = int(work.edges[side, part]), int(work.edges[side, part + 1])
        shape(run, high - low)
        for i in range(low * s, high * s):
            slabs[i] *= work.rest[0]
        for k in range(work.a.size):
            polynomial, factor = work.shape[k], work.a[k]
            for i in range((high - low) * s):
                slabs[low * s + i] += factor * polynomial[i]
    whole = min(size, (ring - at) * s)
    for i in range(whole):
        waves[begin + i] = flushed(slabs[i])
    for i in range(size - whole):
        waves[o + i] = flushed(slabs[whole + i])


@function
def due(run, row, count):
    """Place in its line's ring of the last k slabs that have left end 1, if their cells are now due, or else -2 k."""
    network, state = run.network, run.state
    k, line = network.diamonds.cell[row], network.diamonds.line[row]
    state.since[row] += count
    if state.since[row] < k:
        return -2 * k
    state.since[row] = 0
    return state.side[line] * network.delay[line] + state.slot[line] - k


@function
def meet_by_squares(r, k, steady, ahead, n, a, b, weight, turned):
    """Let n constants of a meet those of b from `ahead` on: friction r d + k |d| d counts as often as a weight says.

    It lowers the flow d to x. The first loop has no branches, so that several cells are taken at once.
    """
    before, begun, turns = steady[3], steady[2] - steady[0], np.int64(0)
    for i in range(n):
        j, e = np.uint64(i), np.uint64(i + ahead)
        w, d = weight[j], a[j] - b[e] + begun
        size = abs(d)
        much = w * (r * d + k * size * d - before)  # by the flow as it arrives; zero while that is steady
        rise, bend = 1.0 + w * (r + 2.0 * k * size), w * (k if d > 0.0 else -k)
        inside = rise * rise - 4.0 * bend * much
        taken = 2.0 * much / (rise + np.sqrt(inside if inside > 0.0 else 0.0))
        keeps = (inside >= 0.0) & ((d - taken) * d >= 0.0)
        taken, turned[j] = taken if keeps else 0.0, 0.0 if keeps else 1.0
        turns += np.int64(not keeps)
        a[j], b[e] = flushed(a[j] - taken), flushed(b[e] + taken)
    for i in range(n if turns > 0 else 0):
        if turned[i] != 0.0:
            w, d = weight[i], a[i] - b[i + ahead] + begun
            rest, rise = d + w * before, 1.0 + w * r
            taken = d - 2.0 * rest / (rise + np.sqrt(rise * rise + 4.0 * w * k * abs(rest)))
            a[i], b[i + ahead] = flushed(a[i] - taken), flushed(b[i + ahead] + taken)


@function
def meet_by_steps(diamonds, row, ahead, n, a, b, weight):
    """Let constants meet as `meet_by_squares`, under any law. Returns whether friction was found."""
    steady = diamonds.steady[row]
    for i in range(n):
        here, there = a[i], b[i + ahead]
        d, size = here - there + steady[2] - steady[0], max(abs(here), abs(there))
        taken, done = taken_from(diamonds, row, steady[3], weight[i], d, size)
        if not done:
            return False
        a[i], b[i + ahead] = flushed(here - taken), flushed(there + taken)
    return True


@function
def taken_from(diamonds, row, before, weight, d, size):
    """Find the loss for any friction by Newton's method, to a tolerance over the waves' size; and whether it ended."""
    taken = 0.0
    for turn in range(ROUNDS):
        value, slope = lost(diamonds, row, d - taken)
        step = ((value - before) * weight - taken) / (1.0 + weight * slope)
        taken += step if turn < NEWTON else 0.5 * step
        if abs(step) <= diamonds.exact * size:
            return taken, True
    return taken, False


@unit_of_long_loops
def pass_constants(run: Run, row: int, count: int) -> int:
    """Advance a line as `pass_line`, for constants in cells of one slab without memory: waves are their projections.

    Returns whether friction was found.
    """
    diamonds, waves, cells = run.network.diamonds, run.state.waves, run.work.diamonds.cells
    line, begin = diamonds.line[row], due(run, row, count)
    if begin < -1:
        return 1
    D = run.network.delay[line]
    o, a, b, weight, end = np.uint64(run.network.offset[line]), cells[0], cells[1], cells[2], 0.5 + diamonds.over[row]
    first_a, first_b = places_in_ring(begin, 0, D - 1, D)
    from_start, to_end = min(first_a + 1, D), min(2 * D - first_b, D)
    for i in range(D):
        j = np.uint64(i)
        a[j] = waves[o + np.uint64(first_a - i + (0 if i < from_start else 2 * D))]
        b[j] = waves[o + np.uint64(first_b + i - (0 if i < to_end else 2 * D))]
    weight[0] += end
    weight[D - 1] += end
    for later in range(2):
        if diamonds.kind[row] == SQUARE:
            r, k = diamonds.constants[row, 0], diamonds.constants[row, 1]
            meet_by_squares(r, k, diamonds.steady[row], later, D - later, a, b, weight, cells[3])
        elif not meet_by_steps(diamonds, row, later, D - later, a, b, weight):
            return 0
        weight[0], weight[D - 1] = 1.0, 1.0
    for i in range(D):
        j = np.uint64(i)
        waves[o + np.uint64(first_a - i + (0 if i < from_start else 2 * D))] = a[j]
        waves[o + np.uint64(first_b + i - (0 if i < to_end else 2 * D))] = b[j]
    return 1


@function
def as_one(run, row, side):
    """Take a wave in a cell for one part. Returns their number."""
    edges = run.work.diamonds.edges[side]
    edges[0], edges[1] = 0.0, run.network.diamonds.cell[row]
    return np.int64(1)


@function
def take_wave(run, row, o, at, ring, side, whole):
    """Divide and project a wave in a cell. Returns that none of its slabs is in pieces, and the number of parts."""
    n = fetch(run, row, o, at, ring, side)
    if whole:
        n = as_one(run, row, side)
    take_up(run, side, n)
    return False, n


@function
def put_wave(run, row, o, at, ring, side, in_pieces, n):
    """Write a wave in a cell back with the changes."""
    put_back(run, row, o, at, ring, side, n)


@function
def recall(job, run, row, o, a, b, ring, column, take, put):
    """Attenuate the slabs of a cell by the circuits of a column."""
    memory = run.network.diamonds.memory
    if memory.first[row] == memory.first[row + 1]:
        return
    of_a, n = take(job, row, o, a, ring, 0, True)
    of_b, m = take(job, row, o, b, ring, 1, True)
    invoke(run.units.remember, (run, row, column))
    put(job, row, o, a, ring, 0, of_a, n)
    put(job, row, o, b, ring, 1, of_b, m)


@function
def pass_line(job, run, row, count, take, put):
    """Advance a line by the cells completed with `count` more slabs. Returns whether friction was found.

    Cells half of whose time has passed come first, then those half a cell later, with memory and friction in reverse
    order. Waves are taken from the line for a cell, and put back.
    """
    network, line, k = run.network, run.network.diamonds.line[row], run.network.diamonds.cell[row]
    begin = due(run, row, count)
    if begin < -k:
        return True
    o, D = network.offset[line], network.delay[line]
    ring, number = 2 * D, D // k
    for later in range(2):
        for i in range(number - later):
            rest = number - 1 - later - i
            a, b = places_in_ring(begin, i * k, rest * k, D)
            column = 2 * i + later
            if later == 1:
                recall(job, run, row, o, a, b, ring, column, take, put)
            of_a, n = take(job, row, o, a, ring, 0, False)
            of_b, m = take(job, row, o, b, ring, 1, False)
            if not meet_in_cell(run, row, n, m, later + i == 0, later + rest == 0):
                return False
            put(job, row, o, a, ring, 0, of_a, n)
            put(job, row, o, b, ring, 1, of_b, m)
            if later == 0:
                recall(job, run, row, o, a, b, ring, column, take, put)
    return True


@unit
def pass_cells(run: Run, chosen: int, count: int) -> int:
    """Advance the FAR or NEAR lines with losses by the cells completed with `count` more slabs.

    Returns as `pass_diamonds` does.
    """
    diamonds, constant = run.network.diamonds, run.state.before.shape[1] == 1
    rows = run.network.blocks.far_cells if chosen == FAR else run.network.blocks.near_cells
    for index in range(rows.size):
        row = int(rows[index])
        if constant and diamonds.cell[row] == 1 and diamonds.memory.first[row] == diamonds.memory.first[row + 1]:
            done = invoke(run.units.constants, (run, np.int64(row), count)) == 1
        else:
            done = pass_line(run, run, row, count, take_wave, put_wave)
        if not done:
            return diamonds.line[row]
    return -1


@unit
def remember(run: Run, row: int, column: int) -> int:
    """Advance the circuits of a column of cells, and take their share of the two waves in the workspace.

    Puts the remaining share of waves beyond their polynomials in the workspace.
    """
    diamonds, work, states = run.network.diamonds, run.work.diamonds, run.state.memory
    memory, a, b, w, out = diamonds.memory, work.parts[0, 0], work.parts[1, 0], work.a, work.b
    last, r = 2 * (run.network.delay[diamonds.line[row]] // diamonds.cell[row]) - 2, w.size
    place = 1 if column == 0 or column == last else 0
    work.rest[0] = memory.rest[row, place]
    for c in range(memory.first[row], memory.first[row + 1]):
        sign, n, across = memory.sign[c], memory.modes[c], 1 if memory.sign[c] > 0 else 0
        direct = memory.at[c, place]
        read, write, decay = direct + r * r, direct + r * r + r * n, direct + r * r + 2 * r * n
        state = memory.state_at[c] + column * n
        for i in range(r):
            w[i] = a[i] + sign * b[i] - diamonds.steady[row, across]
        for i in range(r):
            out[i] = 0.0
            for j in range(r):
                out[i] += memory.maps[direct + i * r + j] * w[j]
            for k in range(n):
                out[i] += memory.maps[read + i * n + k] * states[state + k]
        for k in range(n):
            x = memory.maps[decay + k] * states[state + k]
            for j in range(r):
                x += memory.maps[write + k * r + j] * w[j]
            states[state + k] = 0.0 if abs(x) < TINY else x
        for i in range(r):
            a[i] -= out[i]
            b[i] -= sign * out[i]
    return 0
