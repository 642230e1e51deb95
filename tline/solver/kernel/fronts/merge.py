"""Which breakpoints a wave needs: pieces that continue each other are one.

Waves in pieces on their way: put on a line, recorded, given up.
"""

from tline.compiled.unit import function
from tline.solver.kernel.arithmetic import TINY, clear, copy, distance, project, series, times, weakest
from tline.solver.kernel.fronts.structures import DISSOLVED, DROPPED, LIVE, LOST, NOTED, PEAK, SCALE


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
