"""A group of nodes with a state: one matrix product a slab."""

import numpy as np

from tline.solver.kernel.arithmetic import TINY
from tline.unit import function


@function
def load(run, g, m, step, at):
    """Turn the Thévenin waves of m slabs at a group into the nodes' efforts, through the group's state.

    The map from (k Thévenin waves, n states) to (k efforts, the next states) begins at a place of `step`.
    """
    network, states, u, row, s = run.network, run.state.load, run.work.u, run.work.row, run.state.before.shape[1]
    k, n, x = network.group[g + 1] - network.group[g], network.step_states[network.step_row[g]], network.load_at[g]
    width = np.uint64(k * s + n)
    for slab in range(m):
        for p in range(k):
            for i in range(s):
                row[np.uint64(p * s + i)] = u[np.uint64((p * m + slab) * s + i)]
        for i in range(n):
            row[np.uint64(k * s + i)] = states[np.uint64(x + i)]
        place = np.uint64(at)
        for p in range(k):
            for i in range(s):
                total = 0.0
                for j in range(width):
                    total += step[place + j] * row[j]
                place += width
                u[np.uint64((p * m + slab) * s + i)] = total
        for i in range(n):
            total = 0.0
            for j in range(width):
                total += step[place + j] * row[j]
            place += width
            states[np.uint64(x + i)] = 0.0 if abs(total) < TINY else total
