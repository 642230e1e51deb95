"""Loss elements without memory: constant, quadratic, or by a table.

An element between the waves a and b that meet there takes e(w) of w = a + sign b: a becomes a - e, b becomes
b - sign e. Constant e = c w; quadratic e = c |w| w/(1 + sqrt(1 + c |w|))²; tabled log2 of e/w over
log2 of c |w|.
"""

import numpy as np

from tline.compiled.unit import function, unit
from tline.solver.kernel.arithmetic import TINY
from tline.solver.kernel.losses.passing import ABREAST, passing
from tline.solver.kernel.network import CONSTANT, TABLED, Run

FEW = 24  # samples that are not worth gathering


@function
def looked_up(entries, at, size):
    """Share e/w of a wave of some size, from a table of logarithms, of which the first line goes on below it."""
    n = int(entries[at + 2])
    x = (np.log2(max(size, TINY)) - entries[at]) * entries[at + 1]
    x = min(x, n - 1.0)
    k = min(max(int(x), 0), n - 2)
    part = x - k
    return np.exp2((1.0 - part) * entries[at + 3 + k] + part * entries[at + 4 + k])


@function
def taken(kind, c, w):
    """Share e(w) that an element without a table takes of a wave."""
    if kind == CONSTANT:
        return c * w
    v = c * abs(w)
    root = 1.0 + np.sqrt(1.0 + v)
    return w * v / (root * root)


@function
def dissipate(run, r, t, m):
    """Take away what a row dissipates of m slabs from slab t of its line on, element by element."""
    losses, waves, s = run.network.losses, run.state.waves, run.state.before.shape[1]
    line, kind, sign, at, entries = losses.line[r], losses.kind[r], losses.sign[r], losses.at[r], losses.entries
    o, ring = run.network.offset[line], 2 * run.network.delay[line]
    for k in range(losses.first[r], losses.first[r + 1]):
        done, c = 0, losses.strength[k]
        while done < m:
            a, b = passing(t + done, losses.place[k], ring)
            n = min(m - done, ring - a, ring - b)
            done += n
            a, b, n = np.uint64(o + a * s), np.uint64(o + b * s), np.uint64(n * s)
            for i in range(n):
                w = waves[a + i] + sign * waves[b + i]
                loss = taken(kind, c, w) if kind < TABLED else w * looked_up(entries, at, c * abs(w))
                waves[a + i] -= loss
                waves[b + i] -= sign * loss


@function
def dissipate_abreast(run, r, first, n, a, b):
    """The same at n neighbouring elements in one slab: of s samples, at places a, a - s, ... and b, b + s, ..."""
    losses, waves, pair, each = run.network.losses, run.state.waves, run.work.pair, run.work.out
    kind, sign, strength = losses.kind[r], losses.sign[r], losses.strength
    n, s, first = np.uint64(n), np.uint64(run.state.before.shape[1]), np.uint64(first)
    if n * s < FEW:
        for k in range(n):
            for i in range(s):
                p, q = a + i - k * s, b + i + k * s
                loss = taken(kind, strength[first + k], waves[p] + sign * waves[q])
                waves[p] -= loss
                waves[q] -= sign * loss
        return
    for i in range(s):
        for k in range(n):
            pair[k * s + i], each[k * s + i] = waves[a + i - k * s], strength[first + k]
    for i in range(n * s):
        pair[i] = taken(kind, each[i], pair[i] + sign * waves[b + i])
        waves[b + i] -= sign * pair[i]
    for i in range(s):
        for k in range(n):
            waves[a + i - k * s] -= pair[k * s + i]


@unit
def dissipation(run: Run, r: int, m: int) -> int:
    """Let a row of loss elements take what it dissipates of m slabs, no more than the gaps between them."""
    network, state, losses, s = run.network, run.state, run.network.losses, run.state.before.shape[1]
    line, low, high, place = losses.line[r], losses.first[r], losses.first[r + 1], losses.place
    o, ring = network.offset[line], 2 * network.delay[line]
    t = state.side[line] * network.delay[line] + state.slot[line]
    if m == 1 and losses.kind[r] != TABLED and place[high - 1] - place[low] == 2 * (high - 1 - low):
        while low < high:
            a, b = passing(t, place[low], ring)
            n = min(high - low, a + 1, ring - b, ABREAST)
            dissipate_abreast(run, r, low, n, np.uint64(o + a * s), np.uint64(o + b * s))
            low += n
    else:
        dissipate(run, r, t, m)
    return 0
