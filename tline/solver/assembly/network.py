"""A scene as arrays: what assembly writes and the kernel reads. No names, no units.

A line end is numbered 2 * line (end 1) or 2 * line + 1 (end 2). Each line owns two buffers of ``delay`` slabs; a slab
is s samples. An end reads the wave that arrives and writes the one it sends back into the same place, in one buffer;
each time a line's slot wraps, its ends change buffers. So every buffer slot is consumed and refilled exactly once per
delay, and nothing is ever copied along a line.

Nodes that see each other without delay, through a state space of their own, form a group. A node alone is one too.

The two buffers of a line are one ring of twice its delay D: in slab t end 1 works at place t, end 2 at t + D. What
passes p slabs from end 1 in slab t is found at t - p (from end 1) and t + p (from end 2). Losses act there, in place,
also half-way between: what is at t - p and t + p + 1 meets half a slab later and farther.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.radau import Basis, gauss

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


CONSTANT, SQUARED, TABLED, REMEMBERED = range(4)  # kinds of lumps


class Tools(NamedTuple):
    """Matrices of the basis."""

    c: Floats  # (s,)
    to_points: Floats  # (s, s)
    to_legendre: Floats  # (s, s)
    radau: Floats  # (s, s)
    gauss: Floats  # (2, s) nodes and weights on [0, 1]


def tools_of(basis: Basis) -> Tools:
    """The matrices of a basis."""
    return Tools(basis.c, basis.to_points, basis.to_legendre, basis.A, np.array(gauss(basis.s)))


class Laws(NamedTuple):
    """Elements whose flow is no linear function of the effort across them; E elements, by group."""

    first: Integers  # (G + 1,) those of group g are first[g] to first[g + 1]
    kind: Integers  # (E,)
    one: Integers  # (E,) node of the group from which its flow counts, -1 for the reference
    other: Integers  # (E,) node to which it counts
    drive_row: Integers  # (E,) row of what scales it over time, -1 for none
    factor: Floats  # (E,) what scales it where there is none
    at: Integers  # (E,) place of its first constant
    constants: Floats
    state_at: Integers  # (E,) place of its state, -1 for none
    seen: Floats  # (E,) impedance that it sees, > 0
    impedance: Floats  # (N,) Thévenin impedance of each node, 0 if its effort is held, -1 if nothing conducts there
    tools: Tools
    step: float  # slab width, s


class Cells(NamedTuple):
    """Lossy lines in cells one slab long, advanced slab by slab; to the nodes such a line has a delay of one slab.

    A node sees what would arrive if nothing left it, ŷ, with its own share of what comes back at once left to the
    node's map; so a buffer holds ŷ and then 2u - ŷ.
    """

    line: Integers  # (rows,)
    number: Integers  # (rows,) cells of the line
    held: Integers  # (rows,) values that a cell holds, m
    at: Integers  # (rows,) place of the row's maps
    maps: Floats  # by columns: to a cell's next values and what leaves it then, of those before, (m + 2 s, m), and of
    # what enters, (m + 2 s, 2 s); X, Y, R, Q of `pass_cells`, (s, s)
    state: Integers  # (rows,) place of the row's state: of each cell m values and 2 s that leave it next; 2 s of ends
    beside: NDArray[np.bool_]  # (G,) whether a group with elements has such lines
    echo_at: Integers  # (N,) place of what such a node's effort adds to its Thévenin wave, by columns (s, s); or -1
    echo: Floats


class Lumps(NamedTuple):
    """Losses, lumped at places inside lines, row by row: lumps of one line and one kind.

    A lump sees w = a + sign b: a - b drives the flow through a series impedance, a + b the effort over a shunt
    admittance. It takes away e(w): a becomes a - e, b becomes b - sign e.
    """

    gap: Integers  # (L,) slabs, at most the delay, in which nothing passes two lumps or a lump and an end; (0,) if none
    line: Integers  # (rows,)
    kind: Integers  # (rows,)
    sign: Floats  # (rows,) -1 in series, 1 across
    first: Integers  # (rows + 1,) the lumps of row r are first[r] to first[r + 1]
    place: Integers  # half slabs from end 1
    strength: Floats  # constant: e/w; quadratic: c, e = c|w| w/(1 + sqrt(1 + c|w|))²; else without meaning
    at: Integers  # (rows,) place of the row's entries: of a table, or of its maps
    modes: Integers  # (rows,) of a circuit
    entries: Floats  # table: log2 of the first |w|, points per octave, number of points n, then e/w at n points;
    # circuit: D (s, s), C (s, modes), B (modes, s), decay (modes,) of e = D w + C x, x' = B w + decay x
    memory: Integers  # (rows,) place of the row's states, shape (modes, lumps)


class Blocks(NamedTuple):
    """How many slabs groups, lines and rows of lumps are advanced at once."""

    stride: int  # of those that are far from short lines
    step: int  # of the others, meanwhile
    far_groups: Integers
    near_groups: Integers
    far_lines: Integers  # in which nothing arrives within a stride
    near_lines: Integers
    far_rows: Integers
    near_rows: Integers
    waits: NDArray[np.bool_]  # (L,) whether a line is far


class Network(NamedTuple):
    """The constant arrays of a scene; L lines, N nodes, s points per slab."""

    delay: Integers  # (L,) whole slabs of a line's delay, >= 1
    offset: Integers  # (L,) first sample of a line's two buffers
    shift_row: Integers  # (L,) row in shift for the fractional rest of the delay, -1 if there is none
    shift: Floats  # (rows, 2, s, s) matrices that act on the slab arriving now and on the one before it
    first: Integers  # (N + 1,) the ends at node k are ends[first[k]:first[k + 1]]; a group's nodes need not have any
    ends: Integers  # (2 L,)
    weight: Floats  # (2 L,) share of an arriving wave in the node's Thévenin wave
    drive_row: Integers  # (N,) row of the source's part of that wave, -1 for none
    group: Integers  # (G + 1,) nodes group[g] to group[g + 1] are advanced together; most groups have one
    load_at: Integers  # (G,) place of the group's first state, -1 for an algebraic node
    step_row: Integers  # (G,) row of the group's map over a slab; switches that move rewrite it
    step_at: Integers  # (rows,) place of a map in step
    step_states: Integers  # (rows,) its number of states n
    step: Floats  # maps (k s + n)² from (k Thévenin waves, state) to (k efforts, next state), one after the other
    record_row: Integers  # (2 L,) row in the record of an end, -1 if it is not recorded
    laws: Laws
    cells: Cells
    lumps: Lumps
    blocks: Blocks


class State(NamedTuple):
    """What changes: waves under way, and the states of loads."""

    waves: Floats  # (samples,) all buffers
    slot: Integers  # (L,) slab of the buffers that is due
    side: Integers  # (L,) 0: end 1 uses the first buffer and end 2 the second; 1: the other way round
    before: Floats  # (2 L, s) the slab that arrived last, as sent; used where delays have a fractional rest
    load: Floats  # of all groups, one after the other
    cells: Floats  # of all lossy lines in cells
    lumps: Floats  # of all circuits in lumps


_NONE, _EMPTY = np.zeros(0, int), np.zeros(0)
NO_LUMPS = Lumps(
    gap=_NONE,
    line=_NONE,
    kind=_NONE,
    sign=_EMPTY,
    first=np.zeros(1, int),
    place=_NONE,
    strength=_EMPTY,
    at=_NONE,
    modes=_NONE,
    entries=_EMPTY,
    memory=_NONE,
)
