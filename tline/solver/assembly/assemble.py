"""From a scene to arrays: the one place that knows both."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.assembly.layout import Excitation, Layout, layout_of
from tline.solver.assembly.lossy_segments import SegmentedLine, segments_of
from tline.solver.assembly.node_maps import maps_of
from tline.solver.assembly.start import fill_losses, fill_segments
from tline.solver.description.circuits import Circuits
from tline.solver.description.description import Description
from tline.solver.description.groups import Group
from tline.solver.description.laws import with_basis
from tline.solver.description.lines import Line
from tline.solver.description.load_step import StateSpace
from tline.solver.description.nodes import Node
from tline.solver.description.resolution import Resolution, resolution
from tline.solver.description.scales import BENDING, FILLING
from tline.solver.kernel.network import Network, Segments, State
from tline.solver.radau import Basis, basis
from tline.solver.steady.lossy_lines import Ends


@dataclass
class Assembly:
    """A scene as arrays, and what the time loop needs beside them."""

    description: Description
    resolution: Resolution
    basis: Basis
    network: Network
    state: State
    excitations: list[Excitation]  # of each excitation row
    systems: list[StateSpace]  # of each row of the network's maps
    changes: list[tuple[float, int, int]]  # (instant in slabs, group, row of the map from then on), sorted
    nodes: dict[str, Node]  # in the order of their groups
    lines: dict[str, Line]  # those that are not lumped
    recorded: dict[str, int]  # line name -> first of its two rows in the record
    recorded_laws: dict[str, int]  # place of an element -> its row, behind those of lines
    recorded_nodes: dict[str, int]  # node without a line -> its row, behind those
    start: dict[str, NDArray]  # line name -> (a1, b1, a2, b2) before t = 0, counted from the level
    efforts: Mapping[str, float]  # of nodes, likewise
    groups: list[Group]
    circuits: dict[str, Circuits]  # of lossy lines
    echoes: dict[str, NDArray]  # of lines in segments, what an end sends into itself (s, s)
    settle: NDArray  # (groups,) time in which a group with lumped lines settles after a front, s; 0 for others
    graded: NDArray  # (groups,) whether slabs are cut behind fronts, ever farther away

    def level_of(self, line: str) -> float:
        """Effort of the liquid at rest, from which those of a line count; zero without heights."""
        return self.nodes[self.lines[line].nodes[0]].height.level

    @property
    def kept(self) -> int:
        """Rows of the record that a run keeps."""
        return 2 * len(self.recorded) + len(self.recorded_laws) + len(self.recorded_nodes)

    @property
    def follows_edges(self) -> bool:
        """Whether fronts at slabs' edges need pieces: where delays are whole and nothing is lumped they stay there."""
        return bool((self.network.shift_row >= 0).any() or self.settle.any() or self.graded.any())


def assemble(
    description: Description,
    record: set[str],
    chosen: Resolution | None = None,
    *,
    laws: Collection[str] = (),
    progress: bool = False,
) -> Assembly:
    """Turn a description into arrays; kept are the end waves of lines, and the waves into laws, that are named."""
    chosen = chosen or resolution(description)
    layout = layout_of(description, chosen, progress=progress)
    graded = np.array([bool(chosen.layers) and _has_layers(description, group, chosen) for group in layout.groups])
    chosen = chosen if graded.any() else chosen._replace(layers=0.0)
    order, groups, segmented, delay = basis(chosen.s), layout.groups, layout.segmented, layout.delay
    s, q = order.s, layout.z0[:, None] * layout.y
    echoes = [_echoes(group, layout.z0, segmented) for group in groups]
    segments, held = segments_of(segmented)
    arriving = (layout.u + [-1, 1] * q).ravel()  # b at end 1, a at end 2
    recorded, record_row = _recorded(list(layout.lines), record)
    places = [element.where for group in groups for element in group.elements]
    recorded_laws = {where: 2 * len(recorded) + k for k, where in enumerate(w for w in places if w in laws)}
    law_row = np.array([recorded_laws.get(where, -1) for where in places], int)
    first = 2 * len(recorded) + len(recorded_laws)
    recorded_nodes = {node: k for k, node in enumerate(description.probed_nodes, first)}
    effort_row = np.array([recorded_nodes.get(node, -1) for node in layout.nodes], int)
    network = _network(layout, order, segments, Rows(record_row, law_row, effort_row), echoes)
    state = State(
        waves=np.repeat(arriving, np.repeat(delay * s, 2)),
        slot=np.zeros(len(delay), np.int64),
        side=np.zeros(len(delay), np.int64),
        before=np.repeat(arriving[:, None], s, axis=1),
        load=np.concatenate([layout.systems.states, layout.states]),
        segments=np.zeros(held),
        loss_states=np.zeros(layout.memory),
    )
    if description.steady and layout.circuits:
        ends = zip(layout.lines.values(), layout.u, layout.y, strict=True)
        flows = {k: Ends(line, u, y) for k, (line, u, y) in enumerate(ends) if line.losses is not None}
        fill_losses(network, state, flows, order)
        fill_segments(network, state, segmented, flows, order)
    return Assembly(
        description,
        chosen,
        order,
        network,
        state,
        layout.excitations,
        layout.systems.systems,
        layout.systems.changes,
        layout.nodes,
        layout.lines,
        recorded,
        recorded_laws,
        recorded_nodes,
        layout.start,
        layout.efforts,
        groups,
        layout.circuits,
        echoes={list(layout.lines)[k]: line.echo for k, line in segmented.items()},
        settle=np.array([chosen.settle if group.lumped_lines else 0.0 for group in groups]),
        graded=graded,
    )


class Rows(NamedTuple):
    """Rows in the record, or -1: of line ends, laws and nodes."""

    ends: NDArray
    laws: NDArray
    nodes: NDArray


def _network(layout: Layout, order: Basis, segments: Segments, rows: Rows, echoes: list) -> Network:
    """The constant arrays of a layout at an order; `echoes` are of the nodes of groups."""
    s, delay = order.s, layout.delay
    pairs = [order.shift(f) for f in layout.rests]
    step, step_at = maps_of(layout.systems, order, layout.h, echoes)
    return Network(
        delay,
        offset=np.concatenate([[0], np.cumsum(2 * delay * s)[:-1]]),
        shift_row=layout.shift_row,
        shift=np.array(pairs) if pairs else np.zeros((0, 2, s, s)),
        first=layout.first,
        ends=layout.ends,
        weight=layout.weight,
        excitation_row=layout.excitation_row,
        group=layout.group,
        load_at=layout.systems.load_at,
        step_row=layout.systems.step_row.copy(),  # which switches rewrite
        step_at=step_at,
        step_states=layout.systems.step_states,
        step_whole=np.array(layout.systems.whole, bool),
        step=step,
        record_row=rows.ends,
        effort_row=rows.nodes,
        laws=with_basis(layout.laws, order, layout.h, rows.laws),
        segments=segments,
        losses=layout.losses,
        blocks=layout.blocks,
    )


def _has_layers(description: Description, group: Group, chosen: Resolution) -> bool:
    """Whether efforts and flows may change behind a front faster than slabs resolve, as far as is known beforehand."""
    states = [branch.where for branch in (*group.loads, *group.branches) if len(branch.ports.Q)]
    fills = any(element.law.kind in (*FILLING, *BENDING) for element in group.elements)
    scales = description.time_scales
    fast = any(where in scales and scales[where][0] < chosen.resolved for where in states)
    return not group.lumped_lines and (fills or fast or bool(states and group.elements))


def _echoes(group: Group, z0: NDArray, segmented: Mapping[int, SegmentedLine]) -> list[NDArray | None]:
    """Of each node of a group at lines in segments: from its effort to what comes back of it at once."""
    if not segmented:
        return _none(group)
    echoes: list[NDArray | None] = []
    for node in group.nodes:
        felt = [
            2 * weight * segmented[end // 2].echo
            for end, weight in zip(node.ends, node.weights(z0), strict=True)
            if end // 2 in segmented
        ]
        echoes.append(np.sum(felt, axis=0) if felt else None)
    return echoes


def _none(group: Group) -> list[NDArray | None]:
    return [None] * len(group.nodes)


def _recorded(lines: list[str], names: set[str]) -> tuple[dict[str, int], NDArray]:
    """Of each recorded line the first of its two rows, and of each end its row or -1."""
    record_row = np.full(2 * len(lines), -1)
    recorded: dict[str, int] = {}
    for k, name in enumerate(lines):
        if name in names:
            recorded[name] = 2 * len(recorded)
            record_row[2 * k : 2 * k + 2] = recorded[name], recorded[name] + 1
    return recorded, record_row
