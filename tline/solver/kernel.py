"""The wave kernel: lines carry waves, nodes scatter them. It knows arrays and nothing else.

Symbols: w wave that arrives at an end, u effort of a node, 2u - w wave that leaves; s points per slab, x load state.
Nodes do not see each other before the shortest delay has passed, so each is advanced over a whole block of slabs at
once; where a line's slot wraps, or the scratch is full, the block is cut into tiles that are contiguous in memory.

Positions in the wave buffers are unsigned: a signed index is tested for wrapping round at every access, and the loops
do not vectorise. Helpers are inlined as source: as calls they would count references to their arrays at every tile,
which costs up to five times the arithmetic.
"""

import numpy as np
from numba import njit, uint64

TINY = 1e-150  # waves below are flushed to zero: subnormal numbers are slow, and their squares vanish anyway
SCRATCH = 512  # samples per tile
OPTIONS = {"cache": True, "error_model": "numpy", "fastmath": {"contract", "nsz"}}


@njit(inline="always", **OPTIONS)
def begin(u, n, drive, row, start):
    """Start the node's Thévenin wave with the sources' part."""
    if row < 0:
        for i in range(n):
            u[i] = 0.0
    else:
        for i in range(n):
            u[i] = drive[row, start + i]


@njit(inline="always", **OPTIONS)
def gather(u, n, waves, o, share):
    """Add an end's share of its arriving wave."""
    for i in range(n):
        u[i] += share * waves[o + uint64(i)]


@njit(inline="always", **OPTIONS)
def scatter(u, n, waves, o):
    """Send back from an end what the node's effort leaves of the arriving wave."""
    for i in range(n):
        back = 2.0 * u[i] - waves[o + uint64(i)]
        waves[o + uint64(i)] = 0.0 if abs(back) < TINY else back


@njit(inline="always", **OPTIONS)
def note(u, n, waves, o, record, row, column):
    """Keep the waves that arrive at an end and leave it."""
    for i in range(n):
        record[row, 0, column + i] = waves[o + uint64(i)]
        record[row, 1, column + i] = 2.0 * u[i] - waves[o + uint64(i)]


@njit(inline="always", **OPTIONS)
def shift(waves, o, m, before, end, shifts, r, history, row):
    """Apply the fractional rest of a delay to m arriving slabs, in place."""
    s = before.shape[1]
    for j in range(s):
        history[j, 0] = before[end, j]
        for k in range(m):
            history[j, k + 1] = waves[o + uint64(k * s + j)]
        before[end, j] = history[j, m]
    for i in range(s):
        for k in range(m):
            row[k] = 0.0
        for j in range(s):
            now, then = shifts[r, 0, i, j], shifts[r, 1, i, j]
            for k in range(m):
                row[k] += now * history[j, k + 1] + then * history[j, k]
        for k in range(m):
            waves[o + uint64(k * s + i)] = row[k]


@njit(inline="always", **OPTIONS)
def load(u, m, s, steps, r, states, x, row):
    """Turn the Thévenin wave of m slabs into the node's effort, through the load's state."""
    n = states.shape[1]
    for k in range(m):
        for i in range(s + n):
            total = 0.0
            for j in range(s):
                total += steps[r, i, j] * u[k * s + j]
            for j in range(n):
                total += steps[r, i, s + j] * states[x, j]
            row[i] = total
        for i in range(s):
            u[k * s + i] = row[i]
        for j in range(n):
            states[x, j] = 0.0 if abs(row[s + j]) < TINY else row[s + j]


@njit(**OPTIONS)
def advance(network, state, n_slabs, drive, record, column):
    """Advance all nodes by n_slabs, writing the record from the given column (in slabs) on.

    Returns -1, or the number of a node whose effort is no longer finite; the number after the last node's if a wave
    under way is not.
    """
    (delay, offset, shift_row, shifts, first, ends, weight, drive_row, load_row, step_row, steps, record_row) = network
    waves, slots, sides, before, states = state
    s = before.shape[1]
    tile = max(SCRATCH // s, 1)
    u, scratch, history = np.empty(tile * s), np.empty(max(tile, steps.shape[1])), np.empty((s, tile + 1))
    position = np.empty(ends.size, np.uint64)
    shortest, done = n_slabs, 0
    for line in range(delay.size):
        shortest = min(shortest, delay[line])
    while done < n_slabs:
        block = min(shortest, n_slabs - done)
        for node in range(first.size - 1):
            low, high, ahead = first[node], first[node + 1], 0
            while ahead < block:
                m = min(block - ahead, tile)
                for e in range(low, high):
                    line = ends[e] >> 1
                    slot, side = slots[line] + ahead, sides[line] ^ (ends[e] & 1)
                    if slot >= delay[line]:
                        slot, side = slot - delay[line], 1 - side
                    m = min(m, delay[line] - slot)
                    position[e] = offset[line] + (side * delay[line] + slot) * s
                here = (done + ahead) * s
                begin(u, m * s, drive, drive_row[node], here)
                for e in range(low, high):
                    row = shift_row[ends[e] >> 1]
                    if row >= 0:
                        shift(waves, position[e], m, before, ends[e], shifts, row, history, scratch)
                    gather(u, m * s, waves, position[e], weight[e])
                if load_row[node] >= 0:
                    load(u, m, s, steps, step_row[node], states, load_row[node], scratch)
                for e in range(low, high):
                    if record_row[ends[e]] >= 0:
                        note(u, m * s, waves, position[e], record, record_row[ends[e]], column * s + here)
                    scatter(u, m * s, waves, position[e])
                if not np.isfinite(u[m * s - 1]):
                    return node
                ahead += m
        for line in range(delay.size):
            slots[line] += block
            if slots[line] >= delay[line]:
                slots[line] -= delay[line]
                sides[line] = 1 - sides[line]
        done += block
    for w in waves:
        if not np.isfinite(w):
            return first.size - 1
    return -1


# Slabs with fronts inside. They are few, so plain calls do; a polynomial is held by its Legendre coefficients here.

MERGE = 1e-11  # slabs; fronts nearer than this to each other are one
SAME = 1e-13  # of the largest wave; pieces that continue each other so well need no breakpoint
LULL = 16  # slabs without a front after which to go back to blocks
LIVE, PEAK, MERGED, DISSOLVED, DROPPED, NOTED = range(6)
SCALE, LOST = range(2)


@njit(**OPTIONS)
def series(coef, y):
    """Sum of a Legendre series at y, -1 to 1."""
    total, last, here = coef[0], 1.0, y
    for k in range(1, coef.size):
        total += coef[k] * here
        last, here = here, ((2 * k + 1) * y * here - k * last) / (k + 1)
    return total


@njit(**OPTIONS)
def project(coef, a, b, p, q, gauss, out):
    """Add to the projection on [p, q] what a polynomial on [a, b] has there; a restriction is exact."""
    low, high = max(a, p), min(b, q)
    if high <= low:
        return
    for i in range(gauss.shape[1]):
        t = low + (high - low) * gauss[0, i]
        value = gauss[1, i] * (high - low) / (q - p) * series(coef, 2.0 * (t - a) / (b - a) - 1.0)
        y = 2.0 * (t - p) / (q - p) - 1.0
        out[0] += value
        last, here = 1.0, y
        for k in range(1, out.size):
            out[k] += (2 * k + 1) * value * here
            last, here = here, ((2 * k + 1) * y * here - k * last) / (k + 1)


@njit(**OPTIONS)
def clear(out):
    """Set to zero; loops like this one compile many times faster than array expressions."""
    for i in range(out.size):
        out[i] = 0.0


@njit(**OPTIONS)
def copy(values, out):
    """Copy as many values as there is room for."""
    for i in range(out.size):
        out[i] = values[i]


@njit(**OPTIONS)
def distance(one, other):
    """Sum of the absolute differences."""
    total = 0.0
    for i in range(one.size):
        total += abs(one[i] - other[i])
    return total


@njit(**OPTIONS)
def weakest(size, low, high):
    """Index of the least of some values."""
    best = low
    for i in range(low, high):
        if size[i] < size[best]:
            best = i
    return best


@njit(**OPTIONS)
def times(matrix, values, o, out):
    """Product of a matrix with a part of an array."""
    for i in range(out.size):
        total = 0.0
        for j in range(out.size):
            total += matrix[i, j] * values[o + j]
        out[i] = total


@njit(**OPTIONS)
def joined(left, right, a, mid, b, gauss, whole, part):
    """Project two pieces on their union; returns what that changes in the wider one, and in the other."""
    clear(whole)
    project(left, a, mid, a, b, gauss, whole)
    project(right, mid, b, a, b, gauss, whole)
    clear(part)
    project(whole, a, b, a, mid, gauss, part)
    on_left = distance(part, left)
    clear(part)
    project(whole, a, b, mid, b, gauss, part)
    on_right = distance(part, right)
    return (on_left, on_right) if mid - a >= b - mid else (on_right, on_left)


@njit(**OPTIONS)
def front_size(left, right, a, mid, b, least, gauss, whole, part):
    """Damage that joining two pieces would do to the wider one; of a plain jump, a quick estimate of it.

    Zero if they continue each other, so that neither would suffer.
    """
    jump, sign = 0.0, 1.0
    for k in range(left.size):
        jump += sign * right[k] - left[k]
        sign = -sign
    if abs(jump) > least:
        return abs(jump) * min(mid - a, b - mid) / (b - a)
    on_wider, on_other = joined(left, right, a, mid, b, gauss, whole, part)
    return max(on_wider, TINY) if max(on_wider, on_other) > least else 0.0


@njit(**OPTIONS)
def fronts_in(pieces, row, offset, place, size, n):
    """Append those fronts of a slab that lie in the present one when moved by the offset."""
    if row < 0:
        return n
    for j in range(pieces.number[row]):
        t = pieces.start[row, j] + offset
        strength = pieces.anew[row] if j == 0 else pieces.size[row, j]
        if strength > 0.0 and -MERGE / 2 <= t < 1.0 - MERGE / 2 and n < place.size:
            place[n], size[n] = t, strength
            n += 1
    return n


@njit(**OPTIONS)
def united(place, size, n, edges, most, counts, sizes):
    """Edges of the pieces between n fronts. Returns how many pieces, and the size of a front at the start."""
    for i in range(1, n):
        t, strength, j = place[i], size[i], i
        while j > 0 and place[j - 1] > t:
            place[j], size[j] = place[j - 1], size[j - 1]
            j -= 1
        place[j], size[j] = t, strength
    anew, kept = 0.0, 0
    for i in range(n):
        if place[i] < MERGE:
            counts[MERGED] += anew > 0.0
            anew = max(anew, size[i])
        elif kept > 0 and place[i] - place[kept - 1] < MERGE:
            counts[MERGED] += 1
            size[kept - 1] = max(size[kept - 1], size[i])
        else:
            place[kept], size[kept] = place[i], size[i]
            kept += 1
    while kept >= most:
        j = weakest(size, 0, kept)
        counts[DROPPED] += 1
        sizes[LOST] = max(sizes[LOST], size[j])
        for i in range(j, kept - 1):
            place[i], size[i] = place[i + 1], size[i + 1]
        kept -= 1
    edges[0] = 0.0
    for i in range(kept):
        edges[i + 1] = place[i]
    edges[kept + 1] = 1.0
    return kept + 1, anew


@njit(**OPTIONS)
def unfold(pieces, row, values, o, to_legendre, offset, span, coef, n):
    """Append the pieces of a slab that lie in the present one when moved by the offset."""
    if row < 0:
        span[n, 0], span[n, 1] = offset, offset + 1.0
        times(to_legendre, values, o, coef[n])
        return n + 1
    for j in range(pieces.number[row]):
        a, b = pieces.start[row, j] + offset, pieces.start[row, j + 1] + offset
        if b > 0.0 and a < 1.0:
            span[n, 0], span[n, 1] = a, b
            copy(pieces.coef[row, j], coef[n])
            n += 1
    return n


@njit(**OPTIONS)
def regrouped(span, coef, n, edges, m, tools, whole, out):
    """Values at the points of m pieces of a wave that is given in n others: restricted, or projected."""
    i = 0
    for k in range(m):
        while i < n - 1 and span[i, 1] <= edges[k]:
            i += 1
        clear(whole)
        j = i
        while j < n and span[j, 0] < edges[k + 1]:
            project(coef[j], span[j, 0], span[j, 1], edges[k], edges[k + 1], tools.gauss, whole)
            j += 1
        times(tools.to_points, whole, 0, out[k])


@njit(**OPTIONS)
def collocate(A, b, c, d, n, h, radau, w, x, stages):
    """One Radau IIA step of width h of dx/dt = A x + b w; w becomes u = c x + d w, x the state at the end."""
    s = w.size
    size = s * n
    for i in range(s):
        for p in range(n):
            k = i * n + p
            stages[k, size] = x[p]
            for j in range(s):
                stages[k, size] += h * radau[i, j] * b[p] * w[j]
                for q in range(n):
                    stages[k, j * n + q] = (i == j and p == q) - h * radau[i, j] * A[p, q]
    for k in range(size):
        best = k
        for i in range(k + 1, size):
            if abs(stages[i, k]) > abs(stages[best, k]):
                best = i
        for j in range(k, size + 1):
            stages[k, j], stages[best, j] = stages[best, j], stages[k, j]
        for i in range(k + 1, size):
            ratio = stages[i, k] / stages[k, k]
            for j in range(k + 1, size + 1):
                stages[i, j] -= ratio * stages[k, j]
    for k in range(size - 1, -1, -1):
        for j in range(k + 1, size):
            stages[k, size] -= stages[k, j] * stages[j, size]
        stages[k, size] /= stages[k, k]
    for i in range(s):
        w[i] *= d
        for p in range(n):
            w[i] += c[p] * stages[i * n + p, size]
    for p in range(n):
        x[p] = stages[(s - 1) * n + p, size]


@njit(**OPTIONS)
def respond(network, state, fronts, node, slab, edges, m, u, stages, row):
    """Turn the Thévenin wave of m pieces into the node's effort; switches move where pieces begin."""
    systems, moves, s = fronts.systems, fronts.moves, u.shape[1]
    x = network.load_row[node]
    for k in range(m):
        while moves.due[node] < moves.first[node + 1] and moves.at[moves.due[node]] - slab <= edges[k] + MERGE:
            network.step_row[node] = moves.row[moves.due[node]]
            moves.due[node] += 1
        r = network.step_row[node]
        if x < 0:
            continue
        if m == 1:
            load(u[0], 1, s, network.step, r, state.load, x, row)
        else:
            h = fronts.step * (edges[k + 1] - edges[k])
            A, b, c, d, n = systems.A[r], systems.b[r], systems.c[r], systems.d[r], systems.n[r]
            collocate(A, b, c, d, n, h, fronts.tools.radau, u[k], state.load[x], stages)


@njit(**OPTIONS)
def release(pieces, row, counts):
    """Give a row back."""
    if row >= 0:
        counts[LIVE] -= 1
        pieces.free[counts[LIVE]] = row


@njit(**OPTIONS)
def thinned(edges, coef, size, m, most, fronts, whole, part):
    """Take away breakpoints that are not needed, then the weakest beyond the number allowed. Returns pieces left."""
    counts, sizes, gauss = fronts.counts, fronts.sizes, fronts.tools.gauss
    least, kept = SAME * sizes[SCALE], 0
    for k in range(1, m):
        strength = front_size(coef[kept], coef[k], edges[kept], edges[k], edges[k + 1], least, gauss, whole, part)
        if strength == 0.0:
            copy(whole, coef[kept])
            counts[DISSOLVED] += 1
        else:
            kept += 1
            copy(coef[k], coef[kept])
            edges[kept], size[kept] = edges[k], strength
        edges[kept + 1] = edges[k + 1]
    m = kept + 1
    while m > most:
        j = weakest(size, 1, m)
        most_off = max(joined(coef[j - 1], coef[j], edges[j - 1], edges[j], edges[j + 1], gauss, whole, part))
        copy(whole, coef[j - 1])
        counts[DROPPED] += 1
        sizes[LOST] = max(sizes[LOST], most_off)
        for k in range(j, m - 1):
            size[k] = size[k + 1]
            copy(coef[k + 1], coef[k])
        for k in range(j, m):
            edges[k] = edges[k + 1]
        m -= 1
    return m


@njit(**OPTIONS)
def send(fronts, e, slab, waves, o, edges, coef, size, m, anew, whole, part):
    """Put a wave of m pieces on a line."""
    pieces, tools, counts, sizes = fronts.pieces, fronts.tools, fronts.counts, fronts.sizes
    if anew > 0.0 and pieces.width[e] > 0.0:
        least = SAME * sizes[SCALE]
        times(tools.to_legendre, pieces.last[e], 0, coef[m])
        anew = front_size(coef[m], coef[0], -pieces.width[e], 0.0, edges[1], least, tools.gauss, whole, part)
        counts[DISSOLVED] += anew == 0.0
    times(tools.to_points, coef[m - 1], 0, pieces.last[e])
    pieces.width[e] = 1.0 - edges[m - 1]
    most = fronts.most if counts[LIVE] < pieces.free.size else 1
    m = thinned(edges, coef, size, m, most, fronts, whole, part)
    if anew > 0.0 and most == 1:
        counts[DROPPED] += 1
        sizes[LOST] = max(sizes[LOST], anew)
        anew = 0.0
    if m == 1 and anew == 0.0:
        times(tools.to_points, coef[0], 0, whole)
        for i in range(whole.size):
            waves[o + i] = 0.0 if abs(whole[i]) < TINY else whole[i]
        return
    row = pieces.free[counts[LIVE]]
    counts[LIVE] += 1
    counts[PEAK] = max(counts[PEAK], counts[LIVE])
    pieces.of_slab[slab] = row
    pieces.number[row], pieces.anew[row] = m, anew
    pieces.start[row, m] = 1.0
    for k in range(m):
        pieces.start[row, k], pieces.size[row, k] = edges[k], size[k]
        copy(coef[k], pieces.coef[row, k])
    for i in range(whole.size):
        waves[o + i] = 0.0


@njit(**OPTIONS)
def keep(fronts, record, row, slab, edges, m, arrived, u, whole, point):
    """Record m pieces, and their values at the points of the slab."""
    log, s = fronts.log, whole.size
    for side in range(2):
        k = 0
        for i in range(s):
            while k < m - 1 and edges[k + 1] < fronts.tools.c[i]:
                k += 1
            for j in range(s):
                point[j] = arrived[k, j] if side == 0 else 2.0 * u[k, j] - arrived[k, j]
            times(fronts.tools.to_legendre, point, 0, whole)
            y = 2.0 * (fronts.tools.c[i] - edges[k]) / (edges[k + 1] - edges[k]) - 1.0
            record[row, side, slab * s + i] = series(whole, y)
    for k in range(m if m > 1 else 0):
        at = fronts.counts[NOTED]
        log.where[at, 0], log.where[at, 1] = row, slab
        log.span[at, 0], log.span[at, 1] = edges[k], edges[k + 1]
        for j in range(s):
            log.values[at, 0, j] = arrived[k, j]
            log.values[at, 1, j] = 2.0 * u[k, j] - arrived[k, j]
        fronts.counts[NOTED] += 1


@njit(**OPTIONS)
def scatter_pieces(network, state, fronts, sources, drive, node, slab, k, position, due, record, work):
    """One node, one slab, in pieces."""
    waves, before, pieces, tools = state.waves, state.before, fronts.pieces, fronts.tools
    place, size, edges, own, span, given, arrived, u, coef, whole, part, stages, row = work
    s, low, high, r = before.shape[1], network.first[node], network.first[node + 1], network.drive_row[node]
    n = 0
    for i in range(low, high):
        e = network.ends[i]
        rest = fronts.rest[e >> 1]
        n = fronts_in(pieces, pieces.of_slab[position[e] // s], rest, place, size, n)
        if rest > 0.0:
            n = fronts_in(pieces, pieces.before[e], rest - 1.0, place, size, n)
    i = fronts.moves.due[node]
    while i < fronts.moves.first[node + 1] and fronts.moves.at[i] - slab < 1.0 - MERGE / 2 and n < place.size:
        place[n], size[n] = max(fronts.moves.at[i] - slab, 0.0), np.inf
        i, n = i + 1, n + 1
    driven = r >= 0 and due[r] < sources.first[r + 1] and sources.slab[due[r]] == slab
    if driven:
        for j in range(sources.begin[due[r]], sources.begin[due[r] + 1]):
            if n < place.size and (sources.start[j] > 0.0 or sources.anew[due[r]]):
                place[n], size[n] = sources.start[j], np.inf
                n += 1
    m, anew = united(place, size, n, edges, fronts.at_node, fronts.counts, fronts.sizes)
    if not fronts.fractional:
        anew = 0.0
    # arriving waves and the sources' part on these pieces
    if driven:
        n = sources.begin[due[r]]
        n = sources.begin[due[r] + 1] - n
        for j in range(n):
            at = sources.begin[due[r]] + j
            span[j, 0], span[j, 1] = sources.start[at], sources.stop[at]
            copy(sources.coef[at], given[j])
        regrouped(span, given, n, edges, m, tools, whole, u)
    elif r >= 0:
        span[0, 0], span[0, 1] = 0.0, 1.0
        times(tools.to_legendre, drive[r], k * s, given[0])
        regrouped(span, given, 1, edges, m, tools, whole, u)
    else:
        for j in range(m):
            clear(u[j])
    for i in range(low, high):
        e = network.ends[i]
        rest, now = fronts.rest[e >> 1], pieces.of_slab[position[e] // s]
        n = 0
        if rest > 0.0:
            n = unfold(pieces, pieces.before[e], before[e], 0, tools.to_legendre, rest - 1.0, span, given, n)
        n = unfold(pieces, now, waves, position[e], tools.to_legendre, rest, span, given, n)
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
                u[j, p] += network.weight[i] * arrived[i - low, j, p]
    respond(network, state, fronts, node, slab, edges, m, u, stages, row)
    for i in range(low, high):
        e = network.ends[i]
        if network.record_row[e] >= 0:
            keep(fronts, record, network.record_row[e], slab, edges, m, arrived[i - low], u, whole, part)
        for j in range(m):
            for p in range(s):
                part[p] = 2.0 * u[j, p] - arrived[i - low, j, p]
                fronts.sizes[SCALE] = max(fronts.sizes[SCALE], abs(part[p]))
            times(tools.to_legendre, part, 0, coef[j])
        copy(edges, own)
        send(fronts, e, position[e] // s, waves, position[e], own, coef, size, m, anew, whole, part)
    return u[m - 1, s - 1]


@njit(**OPTIONS)
def advance_fronts(network, state, fronts, sources, drive, first_slab, n_slabs, record):
    """Advance all nodes slab by slab with fronts as breakpoints, until none is left or the log is full.

    Returns -1, or the number of a node whose effort is no longer finite; and the number of slabs done.
    """
    (delay, offset, shift_row, shifts, first, ends, weight, drive_row, load_row, step_row, steps, record_row) = network
    waves, slots, sides, before, states = state
    pieces, counts = fronts.pieces, fronts.counts
    s, most = before.shape[1], fronts.at_node
    degree = 0
    for node in range(first.size - 1):
        degree = max(degree, first[node + 1] - first[node])
    broken = 0
    for j in range(sources.slab.size):
        broken = max(broken, sources.begin[j + 1] - sources.begin[j])
    room = 2 * most * degree + most
    n_states = steps.shape[1] - s
    work = (
        np.empty(room), np.empty(max(room, most + 1)), np.empty(most + 1), np.empty(most + 1),
        np.empty((max(broken, 2 * most + 2), 2)), np.empty((max(broken, 2 * most + 2), s)),
        np.empty((degree, most, s)), np.empty((most, s)), np.empty((most + 1, s)), np.empty(s), np.empty(s),
        np.empty((s * n_states, s * n_states + 1)), np.empty(s + n_states),
    )  # fmt: skip
    u, history, row = np.empty(s), np.empty((s, 2)), np.empty(max(1, s + n_states))
    position, due = np.empty(ends.size, np.int64), sources.first[:-1].copy()
    for k in range(n_slabs):
        slab = first_slab + k
        if counts[NOTED] + 2 * record.shape[0] * most > fronts.log.where.shape[0] or (counts[LIVE] == 0 and k >= LULL):
            return -1, k
        for r in range(due.size):
            while due[r] < sources.first[r + 1] and sources.slab[due[r]] < slab:
                due[r] += 1
        for node in range(first.size - 1):
            r, i = drive_row[node], fronts.moves.due[node]
            broken_here = r >= 0 and due[r] < sources.first[r + 1] and sources.slab[due[r]] == slab
            broken_here |= i < fronts.moves.first[node + 1] and fronts.moves.at[i] - slab < 1.0 - MERGE / 2
            for i in range(first[node], first[node + 1]):
                e = ends[i]
                line = e >> 1
                position[e] = offset[line] + ((sides[line] ^ (e & 1)) * delay[line] + slots[line]) * s
                broken_here |= pieces.of_slab[position[e] // s] >= 0 or pieces.before[e] >= 0
            if broken_here:
                at_end = scatter_pieces(
                    network, state, fronts, sources, drive, node, slab, k, position, due, record, work
                )
                if not np.isfinite(at_end):
                    return node, k
                continue
            begin(u, s, drive, drive_row[node], k * s)
            for i in range(first[node], first[node + 1]):
                e = ends[i]
                if shift_row[e >> 1] >= 0:
                    shift(waves, np.uint64(position[e]), 1, before, e, shifts, shift_row[e >> 1], history, row)
                gather(u, s, waves, np.uint64(position[e]), weight[i])
            if load_row[node] >= 0:
                load(u, 1, s, steps, step_row[node], states, load_row[node], row)
            for j in range(first[node], first[node + 1]):
                e = ends[j]
                if record_row[e] >= 0:
                    note(u, s, waves, np.uint64(position[e]), record, record_row[e], slab * s)
                scatter(u, s, waves, np.uint64(position[e]))
                for i in range(s):
                    pieces.last[e, i] = waves[position[e] + i]
                pieces.width[e] = 1.0
            if not np.isfinite(u[s - 1]):
                return node, k
        for line in range(delay.size):
            slots[line] += 1
            if slots[line] == delay[line]:
                slots[line], sides[line] = 0, 1 - sides[line]
    return -1, n_slabs
