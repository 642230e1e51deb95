"""Circuits at the nodes: each group's map over a slab, and the instants from which on it is another.

Settling of a group with lumped lines after a front: its map over that time, in which it moves far within a slab.
"""

from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.solver.description.circuit import StateSpace, load_step
from tline.solver.description.groups import Group
from tline.solver.kernel.fronts.structures import SAME_MAP
from tline.solver.radau import Basis, Matrix, basis

SUBSTEPS = 8  # in the time that it takes


class Event(NamedTuple):
    """Something that happens at a group: a switch moves, or a piece of a slab begins.

    Events are put in order by their instants. None takes the place of another, be it at the same instant.
    """

    at: float  # slabs
    group: int
    row: int = SAME_MAP  # of the group's map from then on

    @property
    def moves(self) -> bool:
        """Whether it changes the group's map."""
        return self.row != SAME_MAP


class GroupSystems(NamedTuple):
    """State spaces of all groups that need a map, one after the other; slabs may be of any order."""

    load_at: NDArray  # (groups,) place of the group's first state, -1 without a map
    step_row: NDArray  # (groups,) row of its first map, -1 without one
    step_states: NDArray  # (maps,) number of states of a map
    states: NDArray  # at the start
    spaces: list[StateSpace]  # of each map, from waves of nodes and laws to efforts there
    whole: NDArray  # of each map, whether it takes the points of a slab at once, be it without states
    events: list[Event]  # in order of time
    impedances: list[float]  # behind which all elements are seen


def systems_of(groups: list[Group], h: float, before: tuple[dict[str, float], ...] | None) -> GroupSystems:
    """State spaces of groups.

    `before` has Thévenin waves and efforts by node, and flows by element, in the steady state at the start; without it
    the liquid is at rest.
    """
    load_at, step_row = np.full(len(groups), -1), np.full(len(groups), -1)
    states, spaces, whole = [np.empty(0)], list[StateSpace](), list[bool]()
    events, impedances, filled = list[Event](), list[float](), 0
    for g, group in enumerate(groups):
        seen = group.matched(1 / h)
        impedances += seen
        if not (group.dynamic or (group.elements and not group.simple)):
            continue
        load_at[g], step_row[g] = filled, len(spaces)
        states.append(group.at_rest() if before is None else group.at_rest_under(*before))
        filled += len(states[-1])
        systems = [circuit.system for circuit in group.circuits(seen)]
        if len({len(system.A) for system in systems}) > 1:
            where, problem = next(b.where for b in (*group.loads, *group.branches)), "holds efforts or flows"
            raise InputError(where, f"a switch shorts what {problem}", "a switch with a resistance above zero")
        events += [Event(time / h, g, len(spaces) + 1 + j) for j, time in enumerate(group.instants)]
        spaces += systems
        coupled = len(systems[0].A) > 0 or any(element.kind.states for element in group.elements)
        whole += [coupled] * len(systems)
    step_states = np.array([len(system.A) for system in spaces], int)
    both = np.concatenate(states), spaces
    return GroupSystems(load_at, step_row, step_states, *both, np.array(whole, bool), sorted(events), impedances)


def maps_of(found: GroupSystems, order: Basis, h: float) -> tuple[NDArray, NDArray]:
    """Maps over a slab from (waves, state) to (efforts, next state), one after the other; and their places.

    Waves and efforts are those of nodes, then of laws, each at the points of the slab, or at any one instant if these
    are not coupled.
    """
    maps = [
        load_step(system, order, h).ravel() if whole else system.d.ravel()
        for system, whole in zip(found.spaces, found.whole, strict=True)
    ]
    return np.concatenate([np.empty(0), *maps]), np.cumsum([0, *map(len, maps)])[:-1]


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
