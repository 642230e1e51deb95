"""Fronts that meet at a group in one slab, and arriving waves in pieces with breakpoints of their own."""

import numpy as np

from tline.compiled.unit import function
from tline.solver.kernel.arithmetic import TINY, clear, copy, project, times, weakest
from tline.solver.kernel.fronts.structures import CUT, DROPPED, LOST, MERGE, MERGED, SAME_MAP, WIDER


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
        sizes[LOST] = max(sizes[LOST], size[j])
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
        n = fronts_of_source(sources, fronts.excitations.row[i], slab, place, size, n)
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
def fronts_of_source(sources, r, slab, place, size, n):
    """Append the fronts of a source, or of an element's opening."""
    if drives_front(sources, r, slab):
        now = sources.due[r]
        for j in range(sources.begin[now], sources.begin[now + 1]):
            if n < place.size and (sources.start[j] > 0.0 or sources.anew[now]):
                place[n], size[n] = sources.start[j], np.inf
                n += 1
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
