"""How a group with lumped lines settles after a front: its map over that time, in which it moves far within a slab."""

from functools import lru_cache
from itertools import pairwise

import numpy as np

from tline.solver.description.load_step import StateSpace, load_step
from tline.solver.radau import Basis, Matrix, basis

SUBSTEPS = 8  # in the time that it takes


def settling_step(system: StateSpace, order: Basis, width: float) -> Matrix:
    """A group's map over a piece of a slab, as wide as it takes to settle, in steps within; efforts are projected.

    Shape (k s + n, k s + n), as of `load_step`.
    """
    s, (n, k) = order.s, system.b.shape
    step = load_step(system, order, width / SUBSTEPS)
    within, projected = _substeps(s)
    given = np.eye(k * s + n)
    waves, efforts = given[: k * s].reshape(k, s, -1), np.zeros((k, s, k * s + n))
    for restriction, projection in zip(within, projected, strict=True):
        out = step @ np.vstack([(restriction @ waves).reshape(k * s, -1), given[k * s :]])
        efforts += projection @ out[: k * s].reshape(k, s, -1)
        given = out
    return np.vstack([efforts.reshape(k * s, -1), given[k * s :]])


@lru_cache
def _substeps(s: int) -> tuple[list[Matrix], list[Matrix]]:
    """Matrices that restrict a polynomial to each step, and project one that is known there on the whole."""
    order, edges = basis(s), np.arange(SUBSTEPS + 1) / SUBSTEPS
    spans = list(pairwise(edges))
    return [order.restriction(*span) for span in spans], [order.projection(*span) for span in spans]
