"""Coupled conductors: at either end a map between conductors and modes.

At an end the conductors' voltages are v = T u, and the currents into their nodes i = Y (T w - v), with the modes'
arriving waves w and the characteristic admittance matrix Y. A node's own wave and load know nothing of that: to them i
is another driven flow. Conductors and modes of an end are nodes of one group.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.line.modes import Modes
from tline.solver.description.load_step import NO_LOAD, StateSpace, side_by_side
from tline.solver.description.nodes import Node


class EndPlaces(NamedTuple):
    """An end of coupled conductors in a group: the places of its nodes there."""

    conductors: NDArray
    modal: NDArray
    modes: Modes


def scattered(nodes: Sequence[Node], ends: Sequence[EndPlaces]) -> StateSpace:
    """State space of a group with such ends: from the nodes' waves w to their efforts, v of conductors, u of modes.

    With g a node's conductance beside the coupled conductors its wave becomes w + i/g. Where there is none, the node's
    reference stands for g, and gets back its own effort: w + i/g + v.
    """
    modal = {p for end in ends for p in end.modal}
    fixed = [p in modal or node.held is not None for p, node in enumerate(nodes)]
    own = [NO_LOAD if fix else node.effort(0.0) for fix, node in zip(fixed, nodes, strict=True)]
    A, B, C, D = side_by_side(own)
    k = len(nodes)
    for p in modal:
        D[p, p] = 0.0
    # the nodes' waves are `given` times those that arrive, and `back` times the efforts
    given, back = np.eye(k), np.diag([float(not fix and node.floating) for fix, node in zip(fixed, nodes, strict=True)])
    for end in ends:
        per_node = np.array([0.0 if fixed[p] else 1 / nodes[p].total for p in end.conductors])
        admittance = per_node[:, None] * end.modes.admittance
        rows = end.conductors[:, None]
        np.add.at(back, (rows, end.conductors), -admittance)
        np.add.at(given, (rows, end.modal), admittance @ end.modes.T)
    solve = np.linalg.inv(np.eye(k) - D @ back)
    efforts, through = solve @ C, solve @ D @ given
    A, B = A + B @ back @ efforts, B @ (given + back @ through)
    for end in ends:
        to_modes = np.linalg.inv(end.modes.T)
        efforts[end.modal], through[end.modal] = to_modes @ efforts[end.conductors], to_modes @ through[end.conductors]
    return StateSpace(A, B, efforts, through)
