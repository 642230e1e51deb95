"""From a scene to arrays: the one place that knows both."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray

from tline.progress import Progress
from tline.solver.assembly.blocks import blocks_of
from tline.solver.assembly.loss_elements import lumps_of
from tline.solver.assembly.lossy_segments import InCells, cells_of, lines_in_cells
from tline.solver.assembly.node_maps import node_maps
from tline.solver.assembly.start import fill_cells, fill_lumped, tables_of
from tline.solver.description.circuits import Circuits, circuits_of, fit_of
from tline.solver.description.description import Description
from tline.solver.description.excitation import Shape, just_before
from tline.solver.description.groups import Group
from tline.solver.description.laws import laws_of, states_of, with_basis
from tline.solver.description.lines import Line
from tline.solver.description.load_step import StateSpace
from tline.solver.description.nodes import Node
from tline.solver.description.resolution import WHOLE, Resolution, resolution
from tline.solver.kernel.network import Network, State
from tline.solver.radau import Basis, basis
from tline.solver.steady.lossy_lines import Ends
from tline.solver.steady.steady_state import above_level, rest

STAGES = 4  # lines, state before t = 0, nodes, waves


@dataclass
class Assembly:
    """A scene as arrays, and what the time loop needs beside them."""

    description: Description
    resolution: Resolution
    basis: Basis
    network: Network
    state: State
    drives: list[
        list[tuple[Shape, float]]
    ]  # of each drive row: waveforms and their shares of the Thévenin wave, or what scales an element
    systems: list[StateSpace]  # of each row of the network's maps
    changes: list[tuple[float, int, int]]  # (instant in slabs, group, row of the map from then on), sorted
    nodes: dict[str, Node]  # in the order of their groups
    lines: dict[str, Line]  # those that are not lumped
    recorded: dict[str, int]  # line name -> first of its two rows in the record
    start: dict[str, NDArray]  # line name -> (a1, b1, a2, b2) before t = 0, counted from the level
    elements: list[list[str]]  # of each group, where its non-linear elements stand
    circuits: dict[str, Circuits]  # of lossy lines
    echoes: dict[str, NDArray]  # of lines in cells, what an end sends into itself (s, s)
    settle: NDArray  # (groups,) time in which a group with lumped lines settles after a front, s; 0 for others

    def level_of(self, line: str) -> float:
        """Effort of the liquid at rest, from which those of a line count; zero without heights."""
        return self.nodes[self.lines[line].nodes[0]].height.level

    @property
    def follows_edges(self) -> bool:
        """Whether fronts at slabs' edges need pieces: where delays are whole and nothing is lumped they stay there."""
        return bool((self.network.shift_row >= 0).any() or self.settle.any())


def assemble(
    description: Description, record: set[str], chosen: Resolution | None = None, *, progress: bool = False
) -> Assembly:
    """Turn a description into arrays; `record` names the lines whose end waves are kept."""
    bar = Progress(STAGES, "stage", progress, "assembling")
    chosen = chosen or resolution(description)
    order, h, steady = basis(chosen.s), chosen.h, description.steady
    lines = {name: line for name, line in description.lines.items() if name not in chosen.cells}
    delay, shift_row, shift = _delays(lines, order, h)
    fastest = min((shape.fastest() for shape in description.waveforms.values()), default=inf)
    circuits = circuits_of(lines, fit_of(description.t_end, h, chosen.fit, chosen.band, fastest))
    in_cells = lines_in_cells(lines, circuits, order, h)
    delay[list(in_cells)] = 1
    lumps, memory = lumps_of(lines, circuits, delay, order, h, chosen.lumps, in_cells)
    bar.update()
    effort, y = above_level(description, tables_of(lumps, list(lines))) if steady else rest(description)
    u = np.array([[effort[at] for at in line.nodes] for line in description.lines.values()])
    bar.update()
    begin = dict(zip(description.lines, zip(u[:, 0].tolist(), y[:, 0].tolist(), strict=True), strict=True))
    groups, nodes = description.grouped(chosen.cells, begin)
    z0 = np.array([line.z0 for line in lines.values()])
    kept = np.array([name in lines for name in description.lines])
    u, y = u[kept], y[kept]
    q = z0[:, None] * y
    arriving = (u + [-1, 1] * q).ravel()  # b at end 1, a at end 2
    drives = [node.drives for node in nodes.values()]
    ends = np.array([end for node in nodes.values() for end in node.ends])
    degree = [len(node.ends) for node in nodes.values()]
    weight = np.concatenate([node.weights(z0) for node in nodes.values()])
    thevenin = np.bincount(np.repeat(np.arange(len(nodes)), degree), weight * arriving[ends], len(nodes))
    if steady:
        thevenin += [sum(share * just_before(waveform) for waveform, share in parts) for parts in drives]
    driven = np.array([bool(parts) for parts in drives])
    echoes = [_echoes(group, z0, in_cells) for group in groups]
    cells, held = cells_of(
        in_cells, [e if group.elements else [None] * len(e) for e, group in zip(echoes, groups, strict=True)]
    )
    maps = node_maps(groups, order, h, thevenin if steady else None, echoes)
    bar.update()
    recorded, record_row = _recorded(lines, record)
    drives = list(filter(None, drives))
    elements, members = [group.elements for group in groups], _members(groups, nodes)
    laws, factors = laws_of(elements, members, nodes, len(drives), len(maps.states))
    drives += [[(factor, 1.0)] for factor in factors]
    first, group = np.cumsum([0, *degree]), np.cumsum([0, *(len(group.nodes) for group in groups)])
    network = Network(
        delay,
        offset=np.concatenate([[0], np.cumsum(2 * delay * chosen.s)[:-1]]),
        shift_row=shift_row,
        shift=shift,
        first=first,
        ends=ends,
        weight=weight,
        drive_row=np.where(driven, np.cumsum(driven) - 1, -1),
        group=group,
        load_at=maps.load_at,
        step_row=maps.step_row,
        step_at=maps.step_at,
        step_states=maps.step_states,
        step=maps.step,
        record_row=record_row,
        laws=with_basis(laws, order, h),
        cells=cells,
        lumps=lumps,
        blocks=blocks_of(delay, first, ends, group, lumps),
    )
    state = State(
        waves=np.repeat(arriving, np.repeat(delay * chosen.s, 2)),
        slot=np.zeros(len(delay), np.int64),
        side=np.zeros(len(delay), np.int64),
        before=np.repeat(arriving[:, None], chosen.s, axis=1),
        load=np.concatenate([maps.states, states_of([e for group in elements for e in group], effort)]),
        cells=np.zeros(held),
        lumps=np.zeros(memory),
    )
    if steady:
        flows = {k: Ends(line, u[k], y[k]) for k, line in enumerate(lines.values()) if line.losses is not None}
        fill_lumped(network, state, flows, order)
        fill_cells(network, state, in_cells, flows, order)
    bar.update()
    bar.close()
    start = dict(zip(lines, np.stack([u + q, u - q], axis=2).reshape(-1, 4), strict=True))
    return Assembly(
        description=description,
        resolution=chosen,
        basis=order,
        network=network,
        state=state,
        drives=drives,
        systems=maps.systems,
        changes=maps.changes,
        nodes=nodes,
        lines=lines,
        recorded=recorded,
        start=start,
        elements=[[element.where for element in group.elements] for group in groups],
        circuits=circuits,
        echoes={list(lines)[k]: line.echo for k, line in in_cells.items()},
        settle=np.array([chosen.settle if group.lumps else 0.0 for group in groups]),
    )


def _members(groups: list[Group], nodes: dict[str, Node]) -> list[list[str]]:
    """Names of the nodes of each group."""
    names = iter(nodes)
    return [[next(names) for _ in group.nodes] for group in groups]


def _echoes(group: Group, z0: NDArray, in_cells: Mapping[int, InCells]) -> list[NDArray | None]:
    """Of each node of a group at lines in cells: from its effort to what comes back of it at once."""
    if not in_cells:
        return [None] * len(group.nodes)
    echoes: list[NDArray | None] = []
    for node in group.nodes:
        felt = [
            2 * weight * in_cells[end // 2].echo
            for end, weight in zip(node.ends, node.weights(z0), strict=True)
            if end // 2 in in_cells
        ]
        echoes.append(np.sum(felt, axis=0) if felt else None)
    return echoes


def _recorded(lines: dict[str, Line], names: set[str]) -> tuple[dict[str, int], NDArray]:
    """Of each recorded line the first of its two rows, and of each end its row or -1."""
    record_row = np.full(2 * len(lines), -1)
    recorded: dict[str, int] = {}
    for k, name in enumerate(lines):
        if name in names:
            recorded[name] = 2 * len(recorded)
            record_row[2 * k : 2 * k + 2] = recorded[name], recorded[name] + 1
    return recorded, record_row


def _delays(lines: dict[str, Line], order: Basis, h: float) -> tuple[NDArray, NDArray, NDArray]:
    """Whole slabs of each delay, and row and matrices of the fractional rest, one pair for each different rest."""
    slabs = np.array([line.delay for line in lines.values()]) / h
    near = np.round(slabs)
    whole = np.abs(slabs - near) <= WHOLE * near
    delay = np.where(whole, near, np.floor(slabs)).astype(np.int64)
    rest, row = np.unique(np.where(whole, -1.0, slabs - delay), return_inverse=True)
    pairs = [order.shift(f) for f in rest if f >= 0]
    shift = np.array(pairs) if pairs else np.zeros((0, 2, order.s, order.s))
    return delay, row - int(rest[0] < 0), shift
