"""Fronts as travelling breakpoints: data of slabs in several pieces, in addition to a network and its state.

A jump or corner of a source, or a switch that moves, is a front. A slab with fronts inside is held as pieces, each a
polynomial of degree s - 1 in Legendre coefficients; places are in slab time, 0 to 1. A slab that begins with a front is
marked as a new start: on a line with a fractional rest its start becomes a breakpoint too.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.assembly.assemble import Assembly
from tline.solver.assembly.node_maps import Event, settling_step
from tline.solver.assembly.workspace import workspace_for
from tline.solver.description.excitation import Broken
from tline.solver.description.laws import tools_of
from tline.solver.kernel.fronts.structures import (
    CONTINUED,
    DISSOLVED,
    DROPPED,
    LOST,
    MERGED,
    PEAK,
    SCALE,
    Events,
    ExcitationRows,
    Fronts,
    Log,
    PiecesUnderWay,
    Sources,
    Systems,
)  # fmt: skip
from tline.solver.kernel.network import Network

MOST_PIECES = 16  # pieces of a slab
AT_NODE, GRADED = 2 * MOST_PIECES, 8 * MOST_PIECES  # pieces of a slab on which a node works, and if cuts are graded
NEAREST = 2e-11  # slabs from a front to the next cut, at least
WORK = 4e7  # pieces computed without asking; in runs that could hold more, a slab has fewer
MEMORY = 2e8  # bytes for slabs in pieces
LOGGED = 65_536  # pieces recorded between two looks
LULL = 16  # slabs without a front that are worth a return to blocks


class Tally(NamedTuple):
    """Counts of the fronts of a run, and the largest one dropped."""

    most: int = 0  # slabs in several pieces under way at once, at most
    merged: int = 0  # fronts that reached a node together with another one
    dissolved: int = 0  # breakpoints taken away because the pieces beside them continue each other
    dropped: int = 0  # breakpoints taken away because a slab had too many
    lost: float = 0.0  # the largest of those, as a share of the largest wave


def fronts_of(assembly: Assembly, n: int, events: Sequence[Event], parts: int) -> Fronts:
    """Data of the fronts of a run of n slabs with events inside slabs, in order of time.

    A slab of a source has at most `parts` parts.
    """
    network, state, basis, h = assembly.network, assembly.state, assembly.basis, assembly.resolution.h
    s, ends, slabs = basis.s, len(network.ends), state.waves.size // basis.s
    most = 1 if assembly.description.crowded else int(min(max(WORK / (ends * n), 1), MOST_PIECES))
    rows = int(min(slabs + ends, MEMORY / (8 * most * (s + 2))))
    group = np.array([event.group for event in events], int)
    order = np.argsort(group, kind="stable")
    first = np.searchsorted(group[order], np.arange(len(network.group)))
    at_node = GRADED if assembly.graded.any() else AT_NODE
    places = max(LOGGED, 2 * assembly.rows * at_node)
    delays = np.array([line.delay for line in assembly.lines.values()])
    return Fronts(
        LULL,
        most,
        at_node,
        h,
        int(assembly.follows_edges),
        assembly.settle / h,
        np.full(len(assembly.settle), -np.inf),
        assembly.graded,
        NEAREST,  # between those of slabs twice as wide, whose errors are others
        max(CONTINUED, assembly.resolution.layers, assembly.resolution.same),
        np.where(network.shift_row >= 0, delays / h - network.delay, 0.0),
        tools_of(basis),
        _packed(assembly),
        Events(
            first,
            np.array([event.at for event in events])[order],
            np.array([event.row for event in events], int)[order],
            first[:-1].copy(),
        ),
        _excitation_rows(network),
        PiecesUnderWay(
            np.full(slabs, -1),
            np.full(ends, -1),
            np.empty((ends, s)),
            np.zeros(ends),
            np.empty(rows, int),
            np.empty(rows),
            np.empty((rows, most + 1)),
            np.empty((rows, most)),
            np.empty((rows, most, s)),
            np.arange(rows),
        ),
        workspace_for(network, s, at_node, parts),
        Log(np.empty((places, 2), int), np.empty((places, 2)), np.empty((places, 2, s))),
        np.zeros(9, int),
        np.zeros(5),
    )


def _excitation_rows(network: Network) -> ExcitationRows:
    laws, groups = network.laws, np.arange(len(network.group) - 1)
    row = np.concatenate([network.excitation_row, laws.excitation_row])
    group = np.concatenate([np.repeat(groups, np.diff(at)) for at in (network.group, laws.first)])[row >= 0]
    order = np.argsort(group, kind="stable")
    return ExcitationRows(np.searchsorted(group[order], np.arange(len(network.group))), row[row >= 0][order])


def _packed(assembly: Assembly) -> Systems:
    entries = [np.block([[system.A, system.b], [system.c, system.d]]).ravel() for system in assembly.systems.spaces]
    maps = [np.empty(0)] * len(entries)
    for r, time in zip(assembly.network.step_row, assembly.settle, strict=True):
        if time > 0:
            maps[r] = settling_step(assembly.systems.spaces[r], assembly.basis, time).ravel()
    return Systems(*_joined(entries), *_joined(maps))


def _joined(parts: list[NDArray]) -> tuple[NDArray, NDArray]:
    return np.cumsum([0, *map(len, parts)])[:-1], np.concatenate([np.empty(0), *parts])


def sources_of(broken: list[Broken], s: int) -> Sources:
    """Slabs of all excitation rows, one after the other."""
    first = np.cumsum([0, *(len(one.slab) for one in broken)])
    begin = np.cumsum([0, *(count for one in broken for count in one.parts)])

    def concatenated(parts: list[NDArray], empty: NDArray) -> NDArray:
        return np.concatenate([empty, *parts])

    return Sources(
        first,
        first[:-1].copy(),
        concatenated([one.slab for one in broken], np.empty(0, int)),
        concatenated([one.anew for one in broken], np.empty(0, bool)),
        begin,
        concatenated([one.start for one in broken], np.empty(0)),
        concatenated([one.stop for one in broken], np.empty(0)),
        concatenated([one.coef for one in broken], np.empty((0, s))),
    )


def tally(fronts: Fronts) -> Tally:
    """The counts of a run so far."""
    counts, scale, lost = fronts.counts, fronts.sizes[SCALE], fronts.sizes[LOST]
    share = float(lost) / float(scale) if scale else 0.0
    most, merged, dissolved, dropped = (int(counts[k]) for k in (PEAK, MERGED, DISSOLVED, DROPPED))
    return Tally(most, merged, dissolved, dropped, share)
