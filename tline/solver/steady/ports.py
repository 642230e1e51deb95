"""Multiports and coupled conductors as linear equations beside the balances of nodes, with lossless lines among them.

All unknowns are of the size of efforts: flows count times an impedance. Where the equations at s = 0 leave something
open, those of the first order in s tell it.

References
----------
C.-W. Ho, A. E. Ruehli, P. A. Brennan: The modified nodal approach to network analysis (1975).
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tline.errors import InputError
from tline.solver.description.branches import PlacedBranch, conductors
from tline.solver.description.description import Description
from tline.solver.description.links import capacitive
from tline.solver.steady.at_nodes import AtNodes, Joins
from tline.solver.steady.balance import Linear
from tline.solver.steady.slow_limit import Limit, Sparse
from tline.words.wording import place

NAMED = 4  # elements in a message


class Ported(NamedTuple):
    """Equations, what each of them and each unknown belongs to, and places of the joins' flows among the others."""

    linear: Linear
    names: list[str]
    flows: slice


class _Entries:
    """Entries of A and B, collected."""

    def __init__(self) -> None:
        self._all: list[tuple[NDArray, ...]] = []

    def add(self, rows: ArrayLike, columns: ArrayLike, now: ArrayLike = 0.0, slow: ArrayLike = 0.0) -> None:
        """Add entries of A, and of B, at rows and columns that are broadcast."""
        self._all.append(tuple(part.ravel() for part in np.broadcast_arrays(rows, columns, now, slow)))

    def matrices(self, held: NDArray) -> tuple[Sparse, Sparse]:
        """A and B without the balances of what is held."""
        rows, columns, now, slow = (np.concatenate(part) for part in zip(*self._all, strict=True))
        kept = ~np.isin(rows, held)
        rows, columns = rows[kept].astype(int), columns[kept].astype(int)
        return Sparse(rows, columns, now[kept]), Sparse(rows, columns, slow[kept])


def branches_with_ports(description: Description) -> list[PlacedBranch]:
    """Multiports, and ends of coupled conductors."""
    multiports = {place("links", name) for name in description.multiports}
    found = [branch for branch in description.branches if branch.where in multiports]
    ends = [PlacedBranch("", (*end.conductors, *end.modal), conductors(end.modes)) for end in description.ends]
    return [*found, *ends]


def ported(
    description: Description,
    number: Mapping[str, int],
    at: AtNodes,
    joins: Joins,
    edges: list[str],
    falls: NDArray,
    unit: float,
) -> Ported:
    """The equations; of the edges, which come first, with the inertia of the falling lines among them.

    Parameters
    ----------
    edges : list of str
        Places.
    falls : ndarray
        Delays of the falling lines, the first edges.
    unit : float
        Impedance by which flows are multiplied.
    """
    rate = 1 / float(np.mean([line.delay for line in description.lines.values()]))
    first, n = len(edges), len(number)
    entries, of_ports, names = _Entries(), [np.zeros(0)], [*edges, *(f"node '{name}'" for name in number)]
    above = np.array([node.above_level for node in description.nodes.values()])

    def store(from_node: int | NDArray, to_node: int | None, capacity: float | NDArray) -> None:
        for row, sign in ((from_node, 1.0), (to_node, -1.0)):
            for column, other in ((from_node, 1.0), (to_node, -1.0)):
                if row is not None and column is not None:
                    entries.add(first + row, first + column, slow=sign * other * capacity * unit * rate)

    entries.add(np.arange(len(falls)), np.arange(len(falls)), slow=falls * rate)
    store(np.arange(n), None, at.capacity)
    for (one, other), capacity in capacitive(description.scene):
        store(number[one], number[other], capacity)
    for branch in branches_with_ports(description):
        M, N, E, Q, P, R = branch.ports
        here = np.array([number[node] for node in branch.nodes])
        level = above[here] if branch.to_air else np.zeros(len(here))
        flows = len(names) + np.arange(len(here))
        states = len(names) + len(here) + np.arange(len(Q))
        names += [branch.where] * (len(here) + len(Q))
        size = np.maximum(np.abs(M).max(axis=1), np.abs(N).max(axis=1) / unit)[:, None]
        pace = np.hstack([np.abs(Q), np.abs(P), np.abs(R) / unit]).max(axis=1, initial=0.0)[:, None]
        pace[pace == 0.0] = 1.0
        for rows, scale, parts in ((flows, size, (M, N, -E)), (states, pace, (P, R, Q))):
            for columns, part, of in zip((first + here, flows, states), parts, (1.0, unit, 1.0), strict=True):
                entries.add(rows[:, None], columns, part / scale / of)
            of_ports.append(parts[0] @ level / scale[:, 0])
        entries.add(states, states, slow=-rate / pace[:, 0])
        entries.add(first + here, flows, 1.0)
    inert = np.flatnonzero((at.tie > 0) & (at.tie < np.inf))
    flows = len(names) + np.arange(len(joins.inertia))
    tied = len(names) + len(flows) + np.arange(len(inert))
    for end, sign in zip(joins.ends.T, (1.0, -1.0), strict=True):
        entries.add(flows, first + end, sign)
        entries.add(first + end, flows, sign)
    entries.add(flows, flows, slow=-joins.inertia * rate / unit)
    entries.add(tied, first + inert, 1.0)
    entries.add(first + inert, tied, 1.0)
    entries.add(tied, tied, slow=-rate / at.tie[inert] / unit)
    names += [place("lines", name) for name in joins.names] + [""] * (len(flows) - len(joins.names))
    names += (list(description.nodes.values())[k].load_name for k in inert)
    given = at.given.copy()
    given[inert] = np.nan
    A, B = entries.matrices(first + np.flatnonzero(~np.isnan(given)))
    known = np.concatenate([*of_ports, np.zeros(len(flows)), at.given[inert]])
    linear = Linear(given, at.conductance, at.driven, unit, A, B, known)
    return Ported(linear, names, slice(len(known) - len(tied) - len(flows), len(known) - len(tied)))


def check_limit(limit: Limit | None, names: list[str], joins: Joins, number: Mapping[str, int]) -> None:
    """Refuse equations that contradict each other, or leave something open, naming elements.

    Raises
    ------
    InputError
    """
    for at, problem in (
        (limit.rows if limit else [], "nothing takes the flow, or efforts contradict each other"),
        (limit.columns if limit else [], "nothing determines its effort or flow"),
    ):
        if not len(at):
            continue
        found = {names[k] for k in at} - {""}
        between = [name.removeprefix("node '").removesuffix("'") for name in found if name.startswith("node '")]
        nodes = {number[name] for name in between}
        found |= {
            place("lines", name)
            for name, pair in zip(joins.names, joins.ends.tolist(), strict=False)
            if nodes >= {*pair}
        }
        known = sorted(found - {""}, key=lambda name: (name.startswith("node "), names.index(name)))
        more = f" and {len(known) - NAMED} more" if len(known) > NAMED else ""
        where = ", ".join(known[:NAMED]) + more or "start"
        raise InputError(where, f"no steady state: {problem}", "a resistance in between, or start = 'rest'")
