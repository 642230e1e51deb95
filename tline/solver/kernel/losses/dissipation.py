"""Loss elements without memory: constant, quadratic, or by a table.

An element between the waves a and b that meet there takes e(w) of w = a + sign b: a becomes a - e, b becomes
b - sign e. Constant e = c w; quadratic e = c |w| w/(1 + sqrt(1 + c |w|))²; tabled e/w over log2 |w|.
"""

import numpy as np

from tline.solver.kernel.arithmetic import TINY
from tline.solver.kernel.losses.passing import ABREAST, passing
from tline.solver.kernel.network import CONSTANT, TABLED, Run
from tline.unit import function, unit

FEW = 24  # samples that are not worth gathering


@function
def looked_up(entries, at, size):
    """Share e/w of a wave of some size, from a table over its logarithm."""
    n = int(entries[at + 2])
    x = (np.log2(max(size, TINY)) - entries[at]) * entries[at + 1]
    x = min(max(x, 0.0), n - 1.0)
    k = min(int(x), n - 2)
    part = x - k
    return (1.0 - part) * entries[at + 3 + k] + part * entries[at + 4 + k]


@function
def taken(kind, c, w):
    """What a loss element without a table takes of a wave."""
    if kind == CONSTANT:
        return c * w
    v = c * abs(w)
    root = 1.0 + np.sqrt(1.0 + v)
    return w * v / (root * root)


@function
def dissipate(waves, o, s, ring, t, m, place, strength, entries, at, sign, kind):
    """Take away what loss elements without memory dissipate of m slabs, one by one."""
    for k in range(place.size):
        done = 0
        while done < m:
            a, b = passing(t + done, place[k], ring)
            n = min(m - done, ring - a, ring - b)
            done += n
            a, b, n, c = np.uint64(o + a * s), np.uint64(o + b * s), np.uint64(n * s), strength[k]
            for i in range(n):
                w = waves[a + i] + sign * waves[b + i]
                loss = taken(kind, c, w) if kind < TABLED else w * looked_up(entries, at, abs(w))
                waves[a + i] -= loss
                waves[b + i] -= sign * loss


@function
def dissipate_abreast(waves, a, b, n, s, strength, first, sign, kind, pair, each):
    """The same at n neighbouring loss elements in one slab: of s samples, at places a, a - s, ... and b, b + s, ..."""
    n, s, first = np.uint64(n), np.uint64(s), np.uint64(first)
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
    network, state, losses, waves = run.network, run.state, run.network.losses, run.state.waves
    place, strength, entries, s = losses.place, losses.strength, losses.entries, state.before.shape[1]
    line, low, high, kind, sign, at = (
        losses.line[r], losses.first[r], losses.first[r + 1], losses.kind[r], losses.sign[r], losses.at[r],
    )  # fmt: skip
    o, ring = network.offset[line], 2 * network.delay[line]
    t = state.side[line] * network.delay[line] + state.slot[line]
    if m == 1 and kind != TABLED and place[high - 1] - place[low] == 2 * (high - 1 - low):
        while low < high:
            a, b = passing(t, place[low], ring)
            n = min(high - low, a + 1, ring - b, ABREAST)
            a, b = np.uint64(o + a * s), np.uint64(o + b * s)
            dissipate_abreast(waves, a, b, n, s, strength, low, sign, kind, run.work.pair, run.work.out)
            low += n
    else:
        dissipate(waves, o, s, ring, t, m, place[low:high], strength[low:high], entries, at, sign, kind)
    return 0
