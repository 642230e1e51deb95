"""A group with a map and without laws: one matrix product a slab."""

import numpy as np

from tline.compiled.unit import function
from tline.solver.kernel.arithmetic import TINY


@function
def load(run, g, n, step, at):
    """Turn the Thévenin waves of n samples at a group into the nodes' efforts, through the group's state.

    The map from (k Thévenin waves at q points, states) to (k efforts, the next states) begins at a place of `step`.
    """
    network, states, u, row, s = run.network, run.state.load, run.work.u, run.work.row, run.state.before.shape[1]
    r, x = network.step_row[g], network.load_at[g]
    k, count = network.group[g + 1] - network.group[g], network.step_states[r]
    q = s if network.step_whole[r] else np.int64(1)
    width = np.uint64(k * q + count)
    for block in range(n // q):
        for p in range(k):
            for i in range(q):
                row[np.uint64(p * q + i)] = u[np.uint64(p * n + block * q + i)]
        for i in range(count):
            row[np.uint64(k * q + i)] = states[np.uint64(x + i)]
        place = np.uint64(at)
        for p in range(k):
            for i in range(q):
                total = 0.0
                for j in range(width):
                    total += step[place + j] * row[j]
                place += width
                u[np.uint64(p * n + block * q + i)] = total
        for i in range(count):
            total = 0.0
            for j in range(width):
                total += step[place + j] * row[j]
            place += width
            states[np.uint64(x + i)] = 0.0 if abs(total) < TINY else total
