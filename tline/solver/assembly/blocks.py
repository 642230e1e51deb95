"""How far the nodes of a network are advanced at once: those that meet only long lines farther than the others.

What leaves a node is not seen elsewhere before the shortest of its lines has passed, or half a cell of friction. All
nodes for which that takes a stride or longer go a stride at once, the others meanwhile in short steps.
"""

from collections.abc import Collection

import numpy as np
from numpy.typing import NDArray

from tline.solver.kernel.network import Blocks

LONGEST = 512  # slabs; more at once save nothing


def blocks_of(reach: NDArray, first: NDArray, ends: NDArray, group: NDArray, diamonds: Collection[int] = ()) -> Blocks:
    """The blocks of a network whose lines each reach so many slabs; for the other arrays see `Network`."""
    degree = np.diff(first)
    of_node = np.minimum.reduceat(np.append(reach[ends >> 1], LONGEST), first[:-1])
    of_group = np.minimum.reduceat(np.where(degree > 0, of_node, LONGEST), group[:-1])
    stride = _stride(of_group, np.add.reduceat(degree, group[:-1]))
    groups, lines = of_group >= stride, reach >= stride
    cells = lines[list(diamonds)]
    return Blocks(
        stride,
        step=int(reach[~lines].min(initial=stride)),
        far_groups=np.flatnonzero(groups),
        near_groups=np.flatnonzero(~groups),
        far_lines=np.flatnonzero(lines),
        near_lines=np.flatnonzero(~lines),
        far_cells=np.flatnonzero(cells),
        near_cells=np.flatnonzero(~cells),
        waits=lines,
    )


def _stride(reach: NDArray, ends: NDArray) -> int:
    """That for which groups with that reach, and so many ends each, are begun with least often; never a single slab."""
    if reach.min() == reach.max():
        return min(int(reach[0]), LONGEST) if reach[0] > 1 else LONGEST
    order = np.argsort(reach)
    choices, at = np.unique(np.minimum(reach[order], LONGEST), return_index=True)
    near = np.concatenate([[0], np.cumsum(ends[order])])[at]
    begun = np.where(choices > 1, near / choices[0] + (ends.sum() - near) / choices, np.inf)
    return int(choices[np.argmin(begun)]) if choices[-1] > 1 else LONGEST
