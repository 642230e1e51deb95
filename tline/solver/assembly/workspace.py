"""Workspaces of the kernel, and what slabs in pieces need beside them: made once, they cost no slab anything."""

from collections.abc import Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from tline.compiled.structure import allocated, empty, pack
from tline.solver.assembly.assemble import Assembly
from tline.solver.assembly.node_maps import SUBSTEPS, Event, settling_step
from tline.solver.description.excitation import Broken
from tline.solver.description.laws import MOVING, tools_of
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
    Steps,
    Systems,
    Workspace,
)  # fmt: skip
from tline.solver.kernel.network import (
    CELL_ORDER,
    PARTS,
    CircuitWork,
    Crossing,
    DiamondWork,
    GovernWork,
    Laws,
    Network,
    State,
    Store,
    Work,
)

SAMPLES = 512  # per tile
MOST_PIECES = 16  # pieces of a slab
AT_NODE, GRADED = 2 * MOST_PIECES, 8 * MOST_PIECES  # pieces of a slab on which a node works, and if cuts are graded
NEAREST = 2e-11  # slabs from a front to the next cut, at least
WORK = 4e7  # pieces computed without asking; in runs that could hold more, a slab has fewer
MEMORY = 2e8  # bytes for slabs in pieces
LOGGED = 65_536  # pieces recorded between two looks
LULL = 16  # slabs without a front that are worth a return to blocks


def largest_group(network: Network) -> tuple[int, int, int]:
    """Most nodes, states and elements of a group."""
    return (
        int(np.diff(network.group).max(initial=1)),
        int(network.step_states.max(initial=0)),
        int(np.diff(network.laws.first).max(initial=0)),
    )


def work_for(network: Network, state: State) -> Work:
    """Workspace of the loop over blocks, and of all units that it calls."""
    s, laws = state.before.shape[1], network.laws
    nodes, states, elements = largest_group(network)
    tile, ports = max(SAMPLES // s, 1), nodes + elements
    kept = int(laws.states.max(initial=0))
    sizes = {"s": s, "tile": tile, "nodes": nodes, "elements": elements, "kept": kept}
    sizes["all"] = states + (MOVING + kept) * elements
    sizes |= {"ends": len(network.ends), "tile_s": tile * s, "nodes_s": nodes * tile * s, "n": tile * s}
    sizes |= {"row": max(tile, ports * s + states), "map": (ports * s + states) ** 2 if elements and states else 0}
    governed = bool(laws.governed.any())  # by openings that move
    crossing, store, circuit = (
        _of_elements(laws, state, sizes) if elements else map(_unused, (Crossing, Store, CircuitWork))
    )
    govern = allocated(GovernWork, sizes | {"nodes_s": nodes * s, "M": elements * s * governed})
    losing = len(network.diamonds.line) > 0
    diamonds = _of_diamonds(network, sizes) if losing else _unused(DiamondWork)
    parts = {"crossing": crossing, "store": store, "circuit": circuit, "govern": govern, "diamonds": diamonds}
    return allocated(Work, sizes, tile=tile, **parts)


def renew(work: Work, network: Network, s: int) -> None:
    """Clear the starting values of an earlier run at laws, if these are coupled or have states."""
    laws = network.laws
    if not len(laws.kind) or not (len(network.step_states) or laws.states.any() or laws.governed.any()):
        return
    store = work.store
    for part in (*work.circuit, *work.govern, store.system, store.integral, store.constant, store.division):
        part.fill(0)
    work.circuit.waves[:], work.circuit.held[:] = np.repeat(laws.before, s), laws.effort


def _of_diamonds(network: Network, sizes: dict[str, int]) -> DiamondWork:
    """Workspace of diamonds."""
    s, ends = sizes["s"], int(np.diff(network.first[network.group]).max(initial=0))
    widest = int(network.diamonds.cell.max(initial=0))
    r = min(s, CELL_ORDER) if widest else s
    longest = int(network.delay[network.diamonds.line].max(initial=0)) if s == 1 else 0
    points, modes = network.diamonds.values.shape
    sizes = sizes | {"r": r, "k_s": widest * s, "parts": PARTS, "E": ends, "K": modes, "M": points}
    counted = {"weight": np.ones((r, r)), "cells": np.ones((4, longest)), "rest": np.ones(1), "width": np.ones(1)}
    return allocated(DiamondWork, sizes, **counted)


def _of_elements(laws: Laws, state: State, sizes: dict[str, int]) -> tuple[Crossing, Store, CircuitWork]:
    """Workspace of laws and stores."""
    s = sizes["s"]
    begun = {"waves": np.repeat(laws.before, s), "held": laws.effort.copy()}
    store = allocated(Store, sizes, constants=laws.constants, states=state.load, tools=laws.tools)
    circuit = allocated(CircuitWork, sizes | {"M": sizes["elements"] * s}, **begun)
    return allocated(Crossing, sizes, constants=laws.constants), store, circuit


@cache
def _unused(structure: Any) -> Any:
    """Packed workspace of what a network does not have; never read."""
    return pack(empty(structure))


def workspace_for(network: Network, s: int, most: int, parts: int) -> Workspace:
    """Workspace for `most` pieces of a slab at a node, and for prescribed waves in at most `parts` parts."""
    nodes, states, elements = largest_group(network)
    ends = int(np.diff(network.first[network.group]).max(initial=0))
    fronts, given = 2 * most * ends + most, max(parts, 2 * most + 2)
    columns = s * states + (s * (nodes + elements) + states if elements else 1)
    sizes = {"s": s, "m": most, "nodes": nodes, "elements": elements, "ends": ends, "fronts": fronts, "given": given}
    sizes |= {"stages": s * states, "columns": columns, "steps": SUBSTEPS + 1, "nodes_s": nodes * s}
    steps = allocated(Steps, sizes, ends=np.array([0.0, 1.0]))
    return allocated(Workspace, sizes, size=np.zeros(max(fronts, most + 1)), steps=steps)


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
    sizes = {"s": s, "ends": ends, "rows": rows, "most": most, "places": places}
    delays = assembly.grid.columns.delay
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
        allocated(
            PiecesUnderWay,
            sizes,
            np.empty,
            width=np.zeros(ends),
            of_slab=np.full(slabs, -1),
            before=np.full(ends, -1),
            free=np.arange(rows),
        ),
        workspace_for(network, s, at_node, parts),
        allocated(Log, sizes, np.empty),
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
    at, settling_at = (np.cumsum([0, *map(len, each)])[:-1] for each in (entries, maps))
    values, settling = (np.concatenate([np.empty(0), *each]) for each in (entries, maps))
    return Systems(at, values, settling_at, settling)


def sources_of(broken: list[Broken], s: int) -> Sources:
    """Slabs of all excitation rows, one after the other."""
    first = np.cumsum([0, *(len(one.slab) for one in broken)])
    begin = np.cumsum([0, *(count for one in broken for count in one.parts)])

    no, none = np.empty(0, int), np.empty(0)
    nothing = Broken(no, np.empty(0, bool), no, none, none, np.empty((0, s)))
    slab, anew, _, start, stop, coef = map(np.concatenate, zip(nothing, *broken, strict=True))
    return Sources(first, first[:-1].copy(), slab, anew, begin, start, stop, coef)


def tally(fronts: Fronts) -> Tally:
    """The counts of a run so far."""
    counts, scale, lost = fronts.counts, fronts.sizes[SCALE], fronts.sizes[LOST]
    share = float(lost) / float(scale) if scale else 0.0
    most, merged, dissolved, dropped = (int(counts[k]) for k in (PEAK, MERGED, DISSOLVED, DROPPED))
    return Tally(most, merged, dissolved, dropped, share)
