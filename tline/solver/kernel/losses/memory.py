"""Loss elements with a memory: a circuit for each element, exact over a slab.

A row's circuits share their maps: e = D w + C x, and x' = B w + decay x from slab to slab.
"""

import numpy as np

from tline.compiled.unit import unit
from tline.solver.kernel.arithmetic import TINY
from tline.solver.kernel.losses.passing import ABREAST, passing
from tline.solver.kernel.network import Run


@unit
def memory(run: Run, r: int, m: int) -> int:
    """Advance the circuits of a row by m slabs, some elements at a time, and let them take what they dissipate."""
    network, side, losses, waves = run.network, run.state.side, run.network.losses, run.state.waves
    memory, w, out, s = run.state.loss_states, run.work.pair, run.work.out, run.state.before.shape[1]
    line = losses.line[r]
    o, ring = network.offset[line], 2 * network.delay[line]
    t = side[line] * network.delay[line] + run.state.slot[line]
    low, high, modes, sign = losses.first[r], losses.first[r + 1], losses.modes[r], losses.sign[r]
    direct = losses.at[r]
    read, write, decay = direct + s * s, direct + s * s + s * modes, direct + s * s + 2 * s * modes
    entries, count = losses.entries, high - low
    while low < high:
        n = min(high - low, ABREAST)
        state = losses.memory[r] + low - losses.first[r]
        for slab in range(t, t + m):
            for j in range(n):
                a, b = passing(slab, losses.place[low + j], ring)
                a, b = o + a * s, o + b * s
                for i in range(s):
                    w[i * ABREAST + j] = waves[a + i] + sign * waves[b + i]
            for i in range(s):
                for j in range(n):
                    out[i * ABREAST + j] = 0.0
                for q in range(s):
                    share = entries[direct + i * s + q]
                    for j in range(n):
                        out[i * ABREAST + j] += share * w[q * ABREAST + j]
            for k in range(modes):
                x = np.uint64(state + k * count)
                for i in range(s):
                    share = entries[read + i * modes + k]
                    for j in range(np.uint64(n)):
                        out[i * ABREAST + j] += share * memory[x + j]
                share = entries[decay + k]
                for j in range(np.uint64(n)):
                    memory[x + j] *= share
                for i in range(s):
                    share = entries[write + k * s + i]
                    for j in range(np.uint64(n)):
                        memory[x + j] += share * w[i * ABREAST + j]
                for j in range(np.uint64(n)):
                    memory[x + j] = 0.0 if abs(memory[x + j]) < TINY else memory[x + j]
            for j in range(n):
                a, b = passing(slab, losses.place[low + j], ring)
                a, b = o + a * s, o + b * s
                for i in range(s):
                    waves[a + i] -= out[i * ABREAST + j]
                    waves[b + i] -= sign * out[i * ABREAST + j]
        low += n
    return 0
