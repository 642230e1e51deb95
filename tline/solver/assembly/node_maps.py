"""Loads, switches and lumped lines: each such group's map over a slab, and the instants from which on it is another."""

from collections.abc import Collection
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.groups import Group
from tline.solver.description.load_step import StateSpace, load_step
from tline.solver.radau import Basis


class GroupSystems(NamedTuple):
    """State spaces of all groups with states, switches or echoes, one after the other; slabs may be of any order."""

    load_at: NDArray  # (groups,) place of the group's first state, -1 for an algebraic node
    step_row: NDArray  # (groups,) row of its first map, -1 for an algebraic node
    step_states: NDArray  # (maps,) number of states of a map
    states: NDArray  # at the start
    systems: list[StateSpace]  # of each map, from the Thévenin waves to the efforts
    group: list[int]  # of each map
    changes: list[tuple[float, int, int]]  # (instant in slabs, group, row of the map), sorted


def systems_of(groups: list[Group], h: float, thevenin: NDArray | None, segmented: Collection[int]) -> GroupSystems:
    """State spaces of groups.

    Parameters
    ----------
    thevenin : ndarray, shape (nodes,), or None
        Waves under which they are steady at the start; without them the liquid stands still.
    segmented : collection of int
        Numbers of lines in segments, which linear groups answer by a map even without states.
    """
    load_at, step_row = np.full(len(groups), -1), np.full(len(groups), -1)
    systems: list[StateSpace] = []
    of_group: list[int] = []
    states = [np.empty(0)]
    changes: list[tuple[float, int, int]] = []
    first = filled = 0
    for g, group in enumerate(groups):
        last = first + len(group.nodes)
        if group.dynamic or (segmented and not group.elements and _at_segments(group, segmented)):
            load_at[g], step_row[g] = filled, len(systems)
            states.append(group.state_at_rest() if thevenin is None else group.at_rest_under(thevenin[first:last]))
            filled += len(states[-1])
            switches, switched = group.nodes[0].switches, group.nodes[0].switched
            times = sorted({float(switch.time) for switch in switches if switch.time >= 0})
            changes += [(time / h, g, len(systems) + 1 + j) for j, time in enumerate(times)]
            systems += [group.system(switched(time)) for time in (*times, np.inf)]
            of_group += [g] * (len(times) + 1)
        first = last
    step_states = np.array([len(system.A) for system in systems], int)
    return GroupSystems(load_at, step_row, step_states, np.concatenate(states), systems, of_group, sorted(changes))


def _at_segments(group: Group, segmented: Collection[int]) -> bool:
    return any(end // 2 in segmented for node in group.nodes for end in node.ends)


def maps_of(found: GroupSystems, order: Basis, h: float, echoes: list[list[NDArray | None]]) -> tuple[NDArray, NDArray]:
    """Maps over a slab from (Thévenin waves, state) to (efforts, next state), one after the other; and their places.

    `echoes` has for each node of each linear group a matrix (s, s) from its effort to what lines in segments send back
    at once, or None.
    """
    maps = [
        echoed(load_step(system, order, h), echoes[g]).ravel()
        for system, g in zip(found.systems, found.group, strict=True)
    ]
    return np.concatenate([np.empty(0), *maps]), np.cumsum([0, *map(len, maps)])[:-1]


def echoed(step: NDArray, felt: list[NDArray | None]) -> NDArray:
    """A group's map over a slab, where to the Thévenin waves w of nodes some shares P u of their efforts are added."""
    if all(echo is None for echo in felt):
        return step
    s = next(len(echo) for echo in felt if echo is not None)
    n = len(felt) * s
    P = np.zeros((n, n))
    for k, echo in enumerate(felt):
        if echo is not None:
            P[k * s : (k + 1) * s, k * s : (k + 1) * s] = echo
    u = np.linalg.solve(np.eye(n) - step[:n, :n] @ P, step[:n])
    return np.vstack([u, step[n:] + step[n:, :n] @ P @ u])
