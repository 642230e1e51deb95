"""Where the effort at ends of lines is highest and lowest, over all slabs of a record."""

from typing import NamedTuple

import numpy as np

from tline.compiled.structure import Floats2, Floats3, Integers, Integers2, Integers3
from tline.compiled.unit import function, unit

ROUNDING = 1e-12  # what tops an extreme by less, relatively, is the same one again
CANDIDATES = 4  # slabs with the highest places that are told of each row, beside the first one as high as any


class Seen(NamedTuple):
    """A record, and what is to be known of rows of it; of the negative effort, and of the effort."""

    record: Floats3  # (recorded ends, 2, points)
    rows: Integers  # (R,) of the record
    places: Floats2  # (P, s) from the points of a slab to places of it
    left_out: Integers2  # (L, 2) row of the R and slab, in which nothing is looked for
    heights: Floats3  # (2, R, N) the highest of each slab
    best: Integers3  # (2, R, CANDIDATES + 1) slabs, the first as high as any, and then the highest ones


@function
def look(a, b, places, n, low, high):
    """The highest negative and positive efforts of n slabs."""
    s = places.shape[1]
    for i in range(n):
        least, most = np.inf, -np.inf
        for p in range(len(places)):
            u = 0.0
            for j in range(s):
                u += places[p, j] * (a[i * s + j] + b[i * s + j])
            least, most = u if u < least else least, u if u > most else most
        low[i], high[i] = -0.5 * least, 0.5 * most


@function
def choose(heights, n, best):
    """The first of n slabs as high as any, and the highest ones, lower ones last."""
    for k in range(CANDIDATES + 1):
        best[k] = 0
    for i in range(n):
        k = CANDIDATES
        while k > 0 and (i < k or heights[i] > heights[best[k]]):
            if k < CANDIDATES:
                best[k + 1] = best[k]
            best[k] = i
            k -= 1
    highest = heights[best[1]]
    for i in range(n):
        if heights[i] >= highest - ROUNDING * abs(highest):
            best[0] = i
            return


@unit
def find_extremes(work: Seen, n: int) -> int:
    """Look for the extremes of n slabs from the record's first column on."""
    for r in range(len(work.rows)):
        a, b = work.record[work.rows[r], 0], work.record[work.rows[r], 1]
        look(a, b, work.places, n, work.heights[0, r], work.heights[1, r])
    for k in range(len(work.left_out)):
        for sign in range(2):
            work.heights[sign, work.left_out[k, 0], work.left_out[k, 1]] = -np.inf
    for sign in range(2):
        for r in range(len(work.rows)):
            choose(work.heights[sign, r], n, work.best[sign, r])
    return 0
