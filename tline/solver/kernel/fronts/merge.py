"""Which breakpoints a wave needs: pieces that continue each other are one."""

from tline.compiled.unit import function
from tline.solver.kernel.arithmetic import TINY, clear, copy, distance, weakest
from tline.solver.kernel.fronts.structures import DISSOLVED, DROPPED, LOST, SCALE
from tline.solver.kernel.polynomials import project


@function
def as_one(left, right, a, mid, b, gauss, whole, part):
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
