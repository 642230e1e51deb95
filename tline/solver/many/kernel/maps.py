"""Steps of loads with one or two states, in all copies at once."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.compiled.structure import Complexes, Complexes2, Complexes3, Floats, Floats2, Floats3, Floats4
from tline.compiled.unit import function, unit


class LoadMaps(NamedTuple):
    """Loads dx/dt = A x + b w, u = c x + d w in B copies, and their steps over K slabs.

    The maps go, by columns, from (Thévenin wave at the points, state) to (effort at the points, next state); there may
    be more room for states than the load has.
    """

    A: Floats3  # (n, n, B), n up to 2
    b: Floats2  # (n, B)
    c: Floats2  # (n, B)
    d: Floats  # (B,)
    widths: Floats2  # (K, B) in s
    rate: Complexes  # (modes,) of the Radau matrix
    projector: Complexes3  # (modes, s, s)
    maps: Floats4  # (K, size, size, B)
    parts: Floats4  # (modes, 2, 1 + n (n + 2), B) real and imaginary parts of what modes take part with
    found: Complexes  # (1 + n (n + 2),) those of one mode and copy
    whole: Complexes2  # (modes, s) sums of the projectors' rows
    last: Complexes2  # (modes, s) their last rows


def load_maps(
    load: Iterable[NDArray], widths: Floats2, rate: Complexes, projector: Complexes3, maps: Floats4
) -> LoadMaps:
    """A load whose steps are to be found, with the workspace."""
    A, b, c, d = load
    n, modes, s = len(b), len(rate), projector.shape[1]
    terms = 1 + n * (n + 2)
    parts, found = np.empty((modes, 2, terms, len(d))), np.empty(terms, complex)
    whole, last = np.empty((modes, s), complex), np.empty((modes, s), complex)
    return LoadMaps(A, b, c, d, widths, rate, projector, maps, parts, found, whole, last)


@unit
def fill_maps(load: LoadMaps) -> int:
    """Find the Radau IIA steps of a load."""
    projector, parts, whole, last, maps = load.projector, load.parts, load.whole, load.last, load.maps
    n, slabs, modes, s = load.b.shape[0], load.widths.shape[0], load.rate.size, projector.shape[1]
    for m in range(modes):
        for i in range(s):
            whole[m, i], last[m, i] = 0.0, projector[m, s - 1, i]
            for j in range(s):
                whole[m, i] += projector[m, i, j]
    for slab in range(slabs):
        for m in range(modes):
            solve_abreast(load.A, load.b, load.c, load.widths[slab], load.rate[m], load.found, parts[m])
        for j in range(s):
            for i in range(s):
                add_modes(parts, 0, projector[:, i, j], maps[slab, j, i])
            for k in range(n):
                add_modes(parts, 1 + k, last[:, j], maps[slab, j, s + k])
                add_modes(parts, 1 + n + k, whole[:, j], maps[slab, s + k, j])
            for copy in range(load.d.size):
                maps[slab, j, j, copy] += load.d[copy]
        for k in range(n):
            for i in range(n):
                add_modes(parts, 1 + 2 * n + i * n + k, whole[:, s - 1], maps[slab, s + k, s + i])
    return 0


@function
def solve_abreast(A, b, c, width, rate, found, parts):
    """What a mode takes part in a load's step with, in all copies.

    With S = (1 - r h A)^-1: r h c S b, the n of r h S b, the n of c S, and the n n of S.
    """
    n, copies = b.shape
    for copy in range(copies):
        scaled = rate * width[copy]
        if n == 1:
            solved = 1.0 / (1.0 - scaled * A[0, 0, copy])
            found[3] = solved
            found[1] = scaled * solved * b[0, copy]
            found[2] = solved * c[0, copy]
            found[0] = found[1] * c[0, copy]
        else:
            p, q = 1.0 - scaled * A[0, 0, copy], -scaled * A[0, 1, copy]
            r, t = -scaled * A[1, 0, copy], 1.0 - scaled * A[1, 1, copy]
            over = 1.0 / (p * t - q * r)
            p, q, r, t = t * over, -q * over, -r * over, p * over
            found[5], found[6], found[7], found[8] = p, q, r, t
            found[1] = scaled * (p * b[0, copy] + q * b[1, copy])
            found[2] = scaled * (r * b[0, copy] + t * b[1, copy])
            found[3] = c[0, copy] * p + c[1, copy] * r
            found[4] = c[0, copy] * q + c[1, copy] * t
            found[0] = c[0, copy] * found[1] + c[1, copy] * found[2]
        for i in range(found.size):
            parts[0, i, copy], parts[1, i, copy] = found[i].real, found[i].imag


@function
def add_modes(parts, term, weight, out):
    """Real part of a sum over modes, for all copies."""
    for c in range(out.size):
        out[c] = 0.0
    for m in range(weight.size):
        real, imag = weight[m].real, weight[m].imag
        for c in range(out.size):
            out[c] += real * parts[m, 0, term, c] - imag * parts[m, 1, term, c]
