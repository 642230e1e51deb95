"""The scheme in its plainest form: slab by slab, line by line, no buffers shared, no blocks. Slow and obvious."""

import numpy as np

from tline.solver.assemble import Assembly
from tline.solver.drive import on_slabs


def efforts(assembly: Assembly, n_slabs: int) -> np.ndarray:
    """Effort of each node at the points of each slab, shape (nodes, slabs, s)."""
    net, s, h = assembly.network, assembly.resolution.s, assembly.resolution.h
    starts = np.array(list(assembly.start.values()))
    sent = [[np.full(s, starts[e // 2, e % 2])] * (int(net.delay[e // 2]) + 1) for e in range(2 * len(net.delay))]
    u = np.zeros((len(net.first) - 1, n_slabs, s))
    x, step_row = assembly.state.load.copy(), net.step_row.copy()
    for k in range(n_slabs):
        for slab, node, row in assembly.changes:
            if slab == k:
                step_row[node] = row
        arriving = {}
        for e in net.ends:
            line, history = e // 2, sent[e ^ 1]
            now, before = history[-int(net.delay[line])], history[-int(net.delay[line]) - 1]
            row = net.shift_row[line]
            arriving[e] = now if row < 0 else net.shift[row, 0] @ now + net.shift[row, 1] @ before
        for node in range(len(net.first) - 1):
            at = range(net.first[node], net.first[node + 1])
            wave = sum((net.weight[e] * arriving[net.ends[e]] for e in at), np.zeros(s))
            if net.drive_row[node] >= 0:
                for waveform, share in assembly.drives[net.drive_row[node]]:
                    breaks = waveform.breaks(1e9)
                    wave = wave + share * on_slabs(waveform, breaks, assembly.basis, h, k, 1)[0]
            if net.load_row[node] >= 0:
                both = net.step[step_row[node]] @ np.concatenate([wave, x[net.load_row[node]]])
                wave, x[net.load_row[node]] = both[:s], both[s:]
            u[node, k] = wave
            for e in at:
                sent[net.ends[e]].append(2 * wave - arriving[net.ends[e]])
    return u
