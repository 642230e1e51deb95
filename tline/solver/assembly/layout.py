"""Layout of a scene on slabs of one width: the arrays that do not depend on the order.

Nodes with long lines only are advanced farther at once than the others.

A wave that leaves a node arrives elsewhere after the delay of its shortest line, or half a cell of friction. All nodes
for which that is a stride or longer advance by a stride at once, the others meanwhile in short steps.
"""

from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from math import inf
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tline.solver.assembly.node_maps import GroupSystems, systems_of
from tline.solver.description.description import Description
from tline.solver.description.elements import PlacedLaw
from tline.solver.description.excitation import Waveform, just_before
from tline.solver.description.groups import Group
from tline.solver.description.laws import laws_of, started, states_of
from tline.solver.description.lines import Circuits, Columns, Line, circuits_of, columns_of, fit_of
from tline.solver.description.nodes import NONE, Node, weights_of
from tline.solver.description.resolution import Resolution, cell_in, not_lumped
from tline.solver.description.slab import WHOLE
from tline.solver.kernel.network import Blocks, Laws
from tline.solver.steady.steady_state import above_level, rest
from tline.words.progress import Progress

LONGEST = 512  # slabs; more at once save nothing
CELLS_AHEAD = 2  # times that nodes go on at once while a cell passes, at least: cells are whole multiples of that
LAYOUTS = 2  # of a scene that are kept
STAGES = 3  # lines, state before t = 0, nodes


def blocks_of(reach: NDArray, first: NDArray, ends: NDArray, group: NDArray, diamonds: ArrayLike = ()) -> Blocks:
    """Blocks of a network, from the delays of lines in slabs (`reach`); for the other arrays see `Network`."""
    degree = np.diff(first)
    of_node = np.minimum.reduceat(np.append(reach[ends >> 1], LONGEST), first[:-1])
    of_group = np.minimum.reduceat(np.where(degree > 0, of_node, LONGEST), group[:-1])
    stride = _stride(of_group, np.add.reduceat(degree, group[:-1]))
    groups, lines = of_group >= stride, reach >= stride
    cells = lines[np.asarray(diamonds, int)]
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
    """Stride, above one slab, with the fewest starts of groups, weighted by their line ends."""
    if reach.min() == reach.max():
        return min(int(reach[0]), LONGEST) if reach[0] > 1 else LONGEST
    order = np.argsort(reach)
    choices, at = np.unique(np.minimum(reach[order], LONGEST), return_index=True)
    near = np.concatenate([[0], np.cumsum(ends[order])])[at]
    begun = np.where(choices > 1, near / choices[0] + (ends.sum() - near) / choices, np.inf)
    return int(choices[np.argmin(begun)]) if choices[-1] > 1 else LONGEST


Excitation = list[tuple[Waveform, float]]  # waveforms and their shares of the Thévenin wave, or what scales an element


class Junctions(NamedTuple):
    """Where the ends of lines meet; N nodes, G groups of nodes."""

    ends: NDArray  # (2 L,) node by node
    first: NDArray  # (N + 1,) those at node k are ends[first[k]:first[k + 1]]
    group: NDArray  # (G + 1,) nodes of group g are group[g] to group[g + 1]
    blocks: Blocks


@dataclass
class SlabGrid:
    """The lines of a scene cut in slabs of one width. L lines."""

    h: float
    lines: Mapping[str, Line]  # those that are not lumped
    z0: NDArray  # (L,)
    columns: Columns
    delay: NDArray  # (L,) whole slabs
    shift_row: NDArray  # (L,) row of the fractional rest of the delay, -1 if there is none
    rests: list[float]  # those that differ, in slabs
    circuits: dict[str, Circuits]  # of lines that remember, or leak
    passed: NDArray  # (L,) share of a wave that arrives, of lines that only delay and attenuate; else 1
    diamonds: NDArray  # numbers of lines that lose all along
    cell: float  # slabs of the cells in which they do, at most; 0 for diamonds of one
    junctions: dict[Hashable, Junctions] = field(default_factory=dict)  # by the order of nodes, and nodes of a group
    spare: dict[Hashable, Any] = field(default_factory=dict)  # assemblies whose run is over

    @property
    def reach(self) -> NDArray:
        """Slabs in which nothing passes along a line from one place that takes of it to another, or an end."""
        reach = self.delay.copy()
        widest = np.minimum(self.cell, reach[self.diamonds])  # cells are no longer than their lines
        reach[self.diamonds] = np.maximum((widest / CELLS_AHEAD).astype(int), 1)
        return reach

    def joined(self, groups: list[Group], nodes: dict[str, Node]) -> Junctions:
        """Where the ends meet, with the nodes in this order."""
        key = tuple(nodes), tuple(len(group.nodes) for group in groups)
        if key not in self.junctions:
            ends = np.array([end for node in nodes.values() for end in node.ends])
            first, group = np.cumsum([0, *(len(node.ends) for node in nodes.values())]), np.cumsum([0, *key[1]])
            blocks = blocks_of(self.reach, first, ends, group, self.diamonds)
            self.junctions[key] = Junctions(ends, first, group, blocks)
        return self.junctions[key]


@dataclass
class Layout:
    """Scene on a grid: its groups of nodes, and the state before t = 0."""

    grid: SlabGrid
    junctions: Junctions
    groups: list[Group]
    nodes: dict[str, Node]  # group by group
    u: NDArray  # (L, 2) efforts before t = 0 at the ends of lines, counted from the level
    y: NDArray  # (L, 2) flows
    efforts: Mapping[str, float]  # of nodes before t = 0, counted from the level
    weight: NDArray  # (2 L,) share of an arriving wave in the node's Thévenin wave
    excitations: list[Excitation]
    excitation_row: NDArray  # (N,)
    systems: GroupSystems
    laws: Laws  # without matrices of an order
    loads_before: NDArray  # states of loads and laws before t = 0

    @property
    def lines(self) -> Mapping[str, Line]:
        """Lines that are not lumped."""
        return self.grid.lines

    @property
    def elements(self) -> list[PlacedLaw]:
        """Elements with a law, group by group."""
        return [element for group in self.groups for element in group.elements]

    @cached_property
    def arriving(self) -> NDArray:
        """Waves before t = 0 that arrive at line ends, b at end 1 and a at end 2, shape (2 L,)."""
        return (self.u + [-1, 1] * (self.grid.z0[:, None] * self.y)).ravel()

    @cached_property
    def sent(self) -> NDArray:
        """Waves before t = 0 as sent, a from end 1 and b from end 2, shape (L, 2)."""
        q = self.grid.z0[:, None] * self.y
        return self.u + [1, -1] * q

    @cached_property
    def moved(self) -> NDArray:
        """Change of waves on their way through cells before t = 0, shape (2 L,)."""
        found, here = np.zeros((len(self.u), 2)), self.grid.diamonds
        if self.grid.cell:
            found[here] = (self.arriving.reshape(-1, 2) - self.sent[:, ::-1])[here]
        return found.ravel()

    @cached_property
    def start(self) -> dict[str, NDArray]:
        """Line name -> (a1, b1, a2, b2) before t = 0, counted from the level."""
        q = self.grid.z0[:, None] * self.y
        return dict(zip(self.grid.lines, np.stack([self.u + q, self.u - q], axis=2).reshape(-1, 4), strict=True))


def layout_of(
    description: Description, chosen: Resolution, known: SlabGrid | None = None, *, progress: bool = False
) -> Layout:
    """The layout of a described scene for some slabs; the last ones are kept as long as the description is.

    `known` are its lines in those slabs.
    """
    key = chosen.h, chosen.rounded, tuple(chosen.sections.items()), _losses(description, chosen)

    def laid_out() -> Layout:
        with Progress(STAGES, "stage", progress, "assembling") as bar:
            grid = known or of_last(description.grids, key, lambda: _grid(description, chosen), LAYOUTS + 1)
            bar.update()
            return _laid_out(description, chosen, grid, bar)

    return of_last(description.known.setdefault(Layout, {}), key, laid_out)


def _losses(description: Description, chosen: Resolution) -> tuple[Any, ...]:
    """Part of a resolution on which lossy lines depend: fit of their circuits, and cells."""
    if not description.lossy:
        return ()
    fastest = min((shape.fastest() for shape in description.waveforms.values()), default=inf)
    fit = fit_of(description.t_end, chosen.h, chosen.fit, fastest)
    return fit, cell_in(description, chosen)


def of_last(kept: dict[Hashable, Any], key: Hashable, make: Callable[[], Any], most: int = LAYOUTS) -> Any:
    """One of the last ones made, or a new one."""
    found = kept.get(key)
    if found is None:
        found = make()
        for old in list(kept)[: max(len(kept) + 1 - most, 0)]:
            kept.pop(old, None)  # which another thread may have done
        kept[key] = found
    return found


def _grid(description: Description, chosen: Resolution) -> SlabGrid:
    h, lines, columns = chosen.h, description.lines, description.columns
    if chosen.sections:
        lines = {name: line for name, line in lines.items() if name not in chosen.sections}
    if chosen.rounded:
        lines = {name: line._replace(delay=max(round(line.delay / h), 1) * h) for name, line in lines.items()}
    columns = columns if lines is description.lines else columns_of(lines)
    delay, shift_row, rests = _delays(columns.delay / h)
    losses = _losses(description, chosen)
    lasting = [] if columns.instant.all() else [name for name, each in lines.items() if not each.instant]
    circuits = circuits_of({name: lines[name] for name in lasting}, losses[0]) if losses else {}
    diamonds, cell = np.flatnonzero(columns.dispersive), losses[1] / h if losses else 0.0
    return SlabGrid(h, lines, columns.z0, columns, delay, shift_row, rests, circuits, columns.passed, diamonds, cell)


def _laid_out(description: Description, chosen: Resolution, grid: SlabGrid, bar: Progress) -> Layout:
    z0 = grid.z0
    effort, y, through, openings, _ = above_level(description) if description.steady else rest(description)
    columns = description.columns
    u = np.array([effort[name] for name in columns.nodes])[columns.ends]
    bar.update()
    begin = dict(zip(description.lines, y[:, 0].tolist(), strict=True)) if chosen.sections else NONE
    groups, nodes = description.grouped(chosen.sections, begin)
    if chosen.sections:
        kept = not_lumped(description, chosen.sections)
        u, y = u[kept], y[kept]
    junctions = grid.joined(groups, nodes)
    weight = weights_of(nodes.values(), z0)
    excitations: list[Excitation] = [[*node.excitations] for node in nodes.values()]
    before = None
    if description.steady:
        arriving = (u + [-1, 1] * (z0[:, None] * y)).ravel()[junctions.ends]
        at = np.repeat(np.arange(len(nodes)), np.diff(junctions.first))
        from_sources = [sum(share * just_before(waveform) for waveform, share in parts) for parts in excitations]
        waves = np.bincount(at, weight * arriving, len(nodes)) + from_sources  # Thévenin's just before t = 0
        before = dict(zip(nodes, waves.tolist(), strict=True)), effort, through
    systems = systems_of(groups, grid.h, before)
    driven = np.array([bool(parts) for parts in excitations])
    excitations = list(filter(None, excitations))
    laws, controls = laws_of(groups, systems.impedances, len(excitations), len(systems.states))
    elements = [element for group in groups for element in group.elements]
    bar.update()
    return Layout(
        grid,
        junctions,
        groups,
        nodes,
        u,
        y,
        effort,
        weight,
        excitations + [[(factor, 1.0)] for factor in controls],
        excitation_row=np.where(driven, np.cumsum(driven) - 1, -1),
        systems=systems,
        laws=started(laws, elements, effort, through, openings)._replace(
            effort=np.array([effort.get(name, 0.0) for name in nodes])
        ),
        loads_before=np.concatenate([systems.states, states_of(elements, effort, openings)]),
    )


def _delays(slabs: NDArray) -> tuple[NDArray, NDArray, list[float]]:
    """Whole slabs of each delay, and row of the fractional rest among those that differ."""
    near = np.round(slabs)
    whole = np.abs(slabs - near) <= WHOLE * near
    delay = np.where(whole, near, np.floor(slabs)).astype(np.int64)
    if whole.all():
        return delay, np.full(len(delay), -1), []
    rest, row = np.unique(np.where(whole, -1.0, slabs - delay), return_inverse=True)
    return delay, row - int(rest[0] < 0), rest[rest >= 0].tolist()
