"""Fronts that meet at a group in one slab, and arriving waves in pieces with breakpoints of their own.

Waves in pieces on their way: put on a line, recorded, given up. Pieces that continue each other are one.
"""

import numpy as np

from tline.compiled.unit import function
from tline.solver.kernel.arithmetic import TINY, clear, copy, distance, project, series, times, weakest
from tline.solver.kernel.fronts.structures import (
    CUT,
    DISSOLVED,
    DROPPED,
    LATE,
    LIVE,
    LOST,
    MERGE,
    MERGED,
    NOTED,
    PEAK,
    SAME_MAP,
    SCALE,
    WIDER,
)


@function
def as_one(left, right, a, mid, b, gauss, whole, part):
    """Project two pieces on their union; returns the changes in the wider one and in the other."""
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


@function
def front_size(fronts, left, right, a, mid, b):
    """Damage that joining two pieces would do to the wider one; of a plain jump, a quick estimate of it.

    Zero if they continue each other, so that neither would suffer.
    """
    gauss, whole, part = fronts.tools.gauss, fronts.work.whole, fronts.work.part
    least, jump, sign = fronts.same * fronts.sizes[SCALE], 0.0, 1.0
    for k in range(left.size):
        jump += sign * right[k] - left[k]
        sign = -sign
    if abs(jump) > least:
        return abs(jump) * min(mid - a, b - mid) / (b - a)
    on_wider, on_other = as_one(left, right, a, mid, b, gauss, whole, part)
    return max(on_wider, TINY) if max(on_wider, on_other) > least else 0.0


@function
def thinned(fronts, m, most):
    """Take away breakpoints that are not needed, then the weakest beyond the number allowed. Returns pieces left."""
    counts, sizes, gauss, work = fronts.counts, fronts.sizes, fronts.tools.gauss, fronts.work
    edges, coef, size, whole, part = work.own, work.coef, work.size, work.whole, work.part
    kept = 0
    for k in range(1, m):
        strength = front_size(fronts, coef[kept], coef[k], edges[kept], edges[k], edges[k + 1])
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
        most_off = max(as_one(coef[j - 1], coef[j], edges[j - 1], edges[j], edges[j + 1], gauss, whole, part))
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


@function
def release(pieces, row, counts):
    """Free a row of pieces."""
    if row >= 0:
        counts[LIVE] -= 1
        pieces.free[counts[LIVE]] = row


@function
def send(fronts, e, waves, o, m, anew):
    """Send a wave of m pieces into a line."""
    pieces, tools, counts, sizes, work = fronts.pieces, fronts.tools, fronts.counts, fronts.sizes, fronts.work
    edges, coef, size, whole = work.own, work.coef, work.size, work.whole
    if anew > 0.0 and pieces.width[e] > 0.0:
        times(tools.to_legendre, pieces.last[e], 0, coef[m])
        anew = front_size(fronts, coef[m], coef[0], -pieces.width[e], 0.0, edges[1])
        counts[DISSOLVED] += anew == 0.0
    times(tools.to_points, coef[m - 1], 0, pieces.last[e])
    pieces.width[e] = 1.0 - edges[m - 1]
    most = fronts.most if counts[LIVE] < pieces.free.size else 1
    m = thinned(fronts, m, most)
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
    pieces.of_slab[o // whole.size] = row
    pieces.number[row], pieces.anew[row] = m, anew
    pieces.start[row, m] = 1.0
    for k in range(m):
        pieces.start[row, k], pieces.size[row, k] = edges[k], size[k]
        copy(coef[k], pieces.coef[row, k])
    for i in range(whole.size):
        waves[o + i] = 0.0


@function
def keep(fronts, record, row, slab, m, arrived, u):
    """Record m pieces, and their values at the points of the slab."""
    log, edges, whole, point = fronts.log, fronts.work.edges, fronts.work.whole, fronts.work.part
    s = whole.size
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


@function
def fronts_in(pieces, row, wide, offset, place, size, n):
    """Append the fronts of a slab, or of a part `wide`, that lie in the present one when moved by the offset."""
    if row < 0:
        return n
    for j in range(pieces.number[row]):
        t = wide * pieces.start[row, j] + offset
        strength = pieces.anew[row] if j == 0 else pieces.size[row, j]
        if strength > 0.0 and -MERGE / 2 <= t < 1.0 - MERGE / 2 and n < place.size:
            place[n], size[n] = t, strength
            n += 1
    return n


@function
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
        sizes[LOST] = max(sizes[LOST], 0.0 if size[j] == CUT else size[j])  # a cut is no wave
        for i in range(j, kept - 1):
            place[i], size[i] = place[i + 1], size[i + 1]
        kept -= 1
    edges[0] = 0.0
    for i in range(kept):
        edges[i + 1] = place[i]
    edges[kept + 1] = 1.0
    return kept + 1, anew


@function
def unfold(fronts, row, values, o, wide, offset, n):
    """Append the pieces of a slab, or of a part `wide`, that lie in the present one when moved by the offset."""
    pieces, span, coef = fronts.pieces, fronts.work.span, fronts.work.given
    if row < 0:
        span[n, 0], span[n, 1] = offset, offset + wide
        times(fronts.tools.to_legendre, values, o, coef[n])
        return n + 1
    for j in range(pieces.number[row]):
        a, b = wide * pieces.start[row, j] + offset, wide * pieces.start[row, j + 1] + offset
        if b > 0.0 and a < 1.0:
            span[n, 0], span[n, 1] = a, b
            copy(pieces.coef[row, j], coef[n])
            n += 1
    return n


@function
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


@function
def part_before(network, e, rest):
    """Share of the last arrived slab kept at a line end; on lines with distributed losses its part yet to come."""
    return rest if network.diamonds.row[e >> 1] >= 0 else 1.0


@function
def fronts_at(run, fronts, sources, g, slab):
    """Gather the fronts that meet at a group in one slab. Returns how many."""
    network, position, n = run.network, run.work.position, np.int64(0)
    pieces, events = fronts.pieces, fronts.events
    place, size = fronts.work.place, fronts.work.size
    for i in range(network.first[network.group[g]], network.first[network.group[g + 1]]):
        e = network.ends[i]
        rest = fronts.rest[e >> 1]
        n = fronts_in(pieces, pieces.of_slab[position[e] // fronts.tools.c.size], 1.0, rest, place, size, n)
        if rest > 0.0:
            wide = part_before(network, e, rest)
            n = fronts_in(pieces, pieces.before[e], wide, rest - wide, place, size, n)
    i = events.due[g]
    while i < events.first[g + 1] and events.at[i] - slab < 1.0 - MERGE / 2 and n < place.size:
        place[n], size[n] = max(events.at[i] - slab, 0.0), CUT if events.row[i] == SAME_MAP else np.inf
        i, n = i + 1, n + 1
    for i in range(fronts.excitations.first[g], fronts.excitations.first[g + 1]):
        if drives_front(sources, fronts.excitations.row[i], slab):  # a source, or an element's opening
            now = sources.due[fronts.excitations.row[i]]
            for j in range(sources.begin[now], sources.begin[now + 1]):
                if n < place.size and (sources.start[j] > 0.0 or sources.anew[now]):
                    place[n], size[n] = sources.start[j], np.inf
                    n += 1
    return cut_behind(fronts, g, slab, place, size, n) if fronts.graded[g] else n


@function
def cut_behind(fronts, g, slab, place, size, n):
    """Append cuts behind each of n fronts, and behind one in the slab before, each farther away by the same factor."""
    last, known = fronts.settled[g] - 1.0 - slab, n
    for i in range(-1, known):
        t, behind = (last if i < 0 else place[i]), fronts.nearest
        while -1.0 < t < 1.0 - behind:
            if t + behind > MERGE and n < place.size:
                place[n], size[n] = t + behind, behind * TINY
                n += 1
            behind *= WIDER
        fronts.settled[g] = max(fronts.settled[g], slab + t + 1.0)
    return n


@function
def drives_front(sources, r, slab):
    """Whether a source has a front in the slab."""
    return sources.due[r] < sources.first[r + 1] and sources.slab[sources.due[r]] == slab


@function
def driven(sources, excitation, r, slab, o, to_legendre, span, given):
    """The sources' part of a Thévenin wave, as pieces. Returns how many."""
    if not drives_front(sources, r, slab):
        span[0, 0], span[0, 1] = 0.0, 1.0
        times(to_legendre, excitation[r], o, given[0])
        return np.int64(1)
    first = sources.begin[sources.due[r]]
    n = sources.begin[sources.due[r] + 1] - first
    for j in range(n):
        span[j, 0], span[j, 1] = sources.start[first + j], sources.stop[first + j]
        copy(sources.coef[first + j], given[j])
    return n


@function
def happen_until(network, events, counts, g, begin):
    """Carry out all events of a group that are due where a piece begins, given in slabs; moves before it are late."""
    while events.due[g] < events.first[g + 1] and events.at[events.due[g]] <= begin + MERGE:
        i = events.due[g]
        counts[LATE] += events.row[i] != SAME_MAP and events.at[i] < begin - MERGE
        if events.row[i] != SAME_MAP:
            network.step_row[g] = events.row[i]
        events.due[g] += 1
