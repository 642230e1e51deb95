"""Loads, switches and lumped lines: each such group's map over a slab, and the instants from which on it is another."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.groups import Group
from tline.solver.description.load_step import StateSpace, load_step
from tline.solver.radau import Basis


class NodeMaps(NamedTuple):
    """All maps of a scene, one after the other."""

    load_at: NDArray  # (groups,) place of the group's first state, -1 for an algebraic node
    step_row: NDArray  # (groups,) row of its first map, -1 for an algebraic node
    step_at: NDArray  # (maps,) place of a map in step
    step_states: NDArray  # (maps,) its number of states
    step: NDArray  # maps from (Thévenin waves, state) to (efforts, next state)
    states: NDArray  # at the start
    systems: list[StateSpace]  # of each map, from the Thévenin waves to the efforts
    changes: list[tuple[float, int, int]]  # (instant in slabs, group, row of the map), sorted


def node_maps(
    groups: list[Group], order: Basis, h: float, thevenin: NDArray | None, echoes: list[list[NDArray | None]]
) -> NodeMaps:
    """Maps of all groups with states, switches or echoes.

    Parameters
    ----------
    thevenin : ndarray, shape (nodes,), or None
        Waves under which they are steady at the start; without them the liquid stands still.
    echoes : list of lists of ndarray, shape (s, s), or None
        Of each node of each group: from its effort to what lines in cells send back at once.
    """
    load_at, step_row = np.full(len(groups), -1), np.full(len(groups), -1)
    systems: list[StateSpace] = []
    maps: list[NDArray] = []
    states = [np.empty(0)]
    changes: list[tuple[float, int, int]] = []
    first = filled = 0
    for g, group in enumerate(groups):
        last = first + len(group.nodes)
        felt = [] if group.elements else echoes[g]
        if group.dynamic or any(echo is not None for echo in felt):
            load_at[g], step_row[g] = filled, len(systems)
            states.append(group.standing() if thevenin is None else group.at_rest_under(thevenin[first:last]))
            filled += len(states[-1])
            switches, switched = group.nodes[0].switches, group.nodes[0].switched
            times = sorted({float(switch.time) for switch in switches if switch.time >= 0})
            changes += [(time / h, g, len(systems) + 1 + j) for j, time in enumerate(times)]
            systems += (own := [group.system(switched(time)) for time in (*times, np.inf)])
            maps += [echoed(load_step(system, order, h), felt).ravel() for system in own]
        first = last
    step_at = np.cumsum([0, *map(len, maps)])[:-1]
    step_states = np.array([len(system.A) for system in systems], int)
    step = np.concatenate([np.empty(0), *maps])
    return NodeMaps(load_at, step_row, step_at, step_states, step, np.concatenate(states), systems, sorted(changes))


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
