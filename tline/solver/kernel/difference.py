"""Largest difference between two runs at a line's end, in slabs without fronts inside."""

from typing import NamedTuple

from tline.compiled.structure import Floats2, Floats3
from tline.compiled.unit import function, unit
from tline.solver.kernel.arithmetic import clear

BLOCK = 128  # slabs compared side by side


class Compared(NamedTuple):
    """Waves a and b of two runs, matrices to their values at the same P places, and a workspace."""

    coarse_a: Floats2  # (n, s)
    coarse_b: Floats2
    fine_a: Floats2  # (n m, s) m fine slabs to a coarse one
    fine_b: Floats2
    in_coarse: Floats3  # (m, P, s) from the points of a coarse slab to the places of each fine one, the last its end
    in_fine: Floats2  # (P, s)
    twice: float  # the weight of the liquid, by which an effort exceeds a gauge pressure
    theirs: Floats3  # (2, s, BLOCK) at the points of a block of slabs
    ours: Floats3
    seen: Floats2  # (4, BLOCK) at a place
    most: Floats2  # (6, BLOCK) differences at ends, differences inside, values: of twice effort, of twice z0 times flow


@function
def transpose(wave, first, step, n, out):
    """Transpose the points of every `step`-th slab: one row a point."""
    for j in range(wave.shape[1]):
        for i in range(n):
            out[j, i] = wave[first + i * step, j]


@function
def evaluate(points, weights, out):
    """Evaluate polynomials at a place."""
    clear(out)
    for j in range(len(weights)):
        weight, row = weights[j], points[j]
        for i in range(len(out)):
            out[i] += weight * row[i]


@function
def raise_to(sums, differences, one, other, less):
    """Raise the largest values to the sum and the difference of two waves."""
    for i in range(len(one)):
        u, y = abs(one[i] + other[i] - less), abs(one[i] - other[i])
        sums[i], differences[i] = u if u > sums[i] else sums[i], y if y > differences[i] else differences[i]


@unit
def find_difference(work: Compared) -> int:
    """Find the largest differences and values."""
    m, places, slabs, most = len(work.in_coarse), len(work.in_fine), len(work.coarse_a), work.most
    for first in range(0, slabs, BLOCK):
        n = min(BLOCK, slabs - first)
        a, b, apart_a, apart_b = work.seen[0, :n], work.seen[1, :n], work.seen[2, :n], work.seen[3, :n]
        transpose(work.coarse_a, first, 1, n, work.theirs[0])
        transpose(work.coarse_b, first, 1, n, work.theirs[1])
        for r in range(m):
            transpose(work.fine_a, first * m + r, m, n, work.ours[0])
            transpose(work.fine_b, first * m + r, m, n, work.ours[1])
            for p in range(places):
                evaluate(work.ours[0], work.in_fine[p], a)
                evaluate(work.ours[1], work.in_fine[p], b)
                evaluate(work.theirs[0], work.in_coarse[r, p], apart_a)
                evaluate(work.theirs[1], work.in_coarse[r, p], apart_b)
                raise_to(most[4], most[5], a, b, work.twice)
                for i in range(n):
                    apart_a[i], apart_b[i] = a[i] - apart_a[i], b[i] - apart_b[i]
                if p < places - 1:
                    raise_to(most[2], most[3], apart_a, apart_b, 0.0)
                elif r == m - 1:
                    raise_to(most[0], most[1], apart_a, apart_b, 0.0)
    return 0
