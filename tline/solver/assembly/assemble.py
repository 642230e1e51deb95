"""From a scene to arrays: the one place that knows both."""

from collections.abc import Collection, Hashable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.assembly.diamonds import diamonds_of
from tline.solver.assembly.events import Event
from tline.solver.assembly.layout import Excitation, Layout, layout_of, of_last
from tline.solver.assembly.node_maps import maps_of
from tline.solver.assembly.start import fill_diamonds, fill_losses
from tline.solver.description.circuits import Circuits
from tline.solver.description.description import Description
from tline.solver.description.groups import Group
from tline.solver.description.laws import with_basis
from tline.solver.description.lines import Line
from tline.solver.description.load_step import StateSpace
from tline.solver.description.nodes import Node
from tline.solver.description.resolution import Resolution, resolution
from tline.solver.kernel.network import Network, State
from tline.solver.radau import Basis, basis
from tline.solver.steady.lossy_lines import Ends

ORDERS = 4  # whose rows and matrices a grid keeps


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
    events: list[Event]  # in order of time
    nodes: dict[str, Node]  # in the order of their groups
    lines: dict[str, Line]  # those that are not lumped
    recorded: dict[str, int]  # line name -> first of its two rows in the record
    recorded_laws: dict[str, int]  # place of an element -> its row, behind those of lines
    recorded_nodes: dict[str, int]  # node without a line -> its row, behind those
    start: dict[str, NDArray]  # line name -> (a1, b1, a2, b2) before t = 0, counted from the level
    efforts: Mapping[str, float]  # of nodes, likewise
    groups: list[Group]
    circuits: dict[str, Circuits]  # of lossy lines
    settle: NDArray  # (groups,) time in which a group with lumped lines settles after a front, s; 0 for others
    spare: dict[Hashable, Any]  # what runs on the same grid leave to the next
    graded: NDArray  # (groups,) whether slabs are cut behind fronts, ever farther away
    loads_before: NDArray  # states of loads and laws before t = 0

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
        fractional = (self.network.shift_row >= 0).any()
        return not self.resolution.plain and bool(fractional or self.settle.any() or self.graded.any())


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
    follows = bool(chosen.layers) and not layout.grid.diamonds  # there slabs are halved: cuts would meet
    graded = np.array([follows and _has_layers(description, group, chosen) for group in layout.groups])
    chosen = chosen if graded.any() else chosen._replace(layers=0.0)
    grid, order, groups = layout.grid, basis(chosen.s), layout.groups
    rows = _rows_of(layout, order, record, laws, description.probed_nodes)
    network, s = _network(layout, order, rows, chosen), order.s
    state = State(
        waves=np.repeat(layout.arriving, np.repeat(grid.delay * s, 2)),
        slot=np.zeros(len(grid.delay), np.int64),
        side=np.zeros(len(grid.delay), np.int64),
        before=np.repeat(layout.arriving[:, None], s, axis=1),
        load=np.concatenate([layout.systems.states, layout.states]),
        loss_states=np.zeros(grid.memory),
        halves=np.zeros((len(network.ends) if network.diamonds.at_group.any() else 0, len(network.diamonds.values))),
        since=np.zeros(len(network.diamonds.line), np.int64),
    )
    if description.steady and grid.circuits:
        ends = zip(grid.lines.values(), layout.u, layout.y, strict=True)
        flows = {k: Ends(line, u, y) for k, (line, u, y) in enumerate(ends) if line.losses is not None}
        fill_losses(network, state, flows, order)
        fill_diamonds(network, state, flows, order)
    return Assembly(
        description,
        chosen,
        order,
        network,
        state,
        layout.excitations,
        layout.systems.systems,
        layout.systems.events,
        layout.nodes,
        grid.lines,
        rows.recorded,
        rows.recorded_laws,
        rows.recorded_nodes,
        layout.start,
        layout.efforts,
        groups,
        grid.circuits,
        settle=np.array([chosen.settle if group.lumped_lines else 0.0 for group in groups]),
        spare=grid.spare,
        graded=graded,
        loads_before=state.load.copy(),
    )


class Rows(NamedTuple):
    """Rows of the record, by name and in arrays of line ends, laws and nodes, or -1; and arrays of an order."""

    recorded: dict[str, int]
    recorded_laws: dict[str, int]
    recorded_nodes: dict[str, int]
    ends: NDArray
    laws: NDArray
    nodes: NDArray
    offset: NDArray
    shift: NDArray


def _rows_of(layout: Layout, order: Basis, record: set[str], laws: Collection[str], probed: Collection[str]) -> Rows:
    """Rows of a run, kept for others of the same order that record the same."""
    grid, s = layout.grid, order.s
    places = tuple(element.where for group in layout.groups for element in group.elements)

    def made() -> Rows:
        recorded, ends = _recorded(list(grid.lines), record)
        of_laws = {where: 2 * len(recorded) + k for k, where in enumerate(w for w in places if w in laws)}
        of_nodes = {node: k for k, node in enumerate(probed, 2 * len(recorded) + len(of_laws))}
        pairs = [order.shift(f) for f in grid.rests]
        return Rows(
            recorded,
            of_laws,
            of_nodes,
            ends,
            np.array([of_laws.get(where, -1) for where in places], int),
            np.array([of_nodes.get(node, -1) for node in layout.nodes], int),
            np.concatenate([[0], np.cumsum(2 * grid.delay * s)[:-1]]),
            np.array(pairs) if pairs else np.zeros((0, 2, s, s)),
        )

    return of_last(layout.junctions.rows, (s, frozenset(record), tuple(laws), tuple(probed), places), made, ORDERS)


def _network(layout: Layout, order: Basis, rows: Rows, chosen: Resolution) -> Network:
    """The constant arrays of a layout at an order."""
    grid, systems = layout.grid, layout.systems
    step, step_at = maps_of(systems, order, grid.h)
    return Network(
        grid.delay,
        offset=rows.offset,
        shift_row=grid.shift_row,
        shift=rows.shift,
        first=layout.junctions.first,
        ends=layout.junctions.ends,
        weight=layout.weight,
        excitation_row=layout.excitation_row,
        group=layout.junctions.group,
        load_at=systems.load_at,
        step_row=systems.step_row.copy(),  # which switches rewrite
        step_at=step_at,
        step_states=systems.step_states,
        step_whole=np.array(systems.whole, bool),
        step=step,
        record_row=rows.ends.copy(),  # which ledgers and envelopes add to
        effort_row=rows.nodes,
        laws=with_basis(layout.laws, order, grid.h, rows.laws),
        losses=grid.losses,
        diamonds=diamonds_of(grid, order, layout.junctions, chosen.same),
        blocks=layout.junctions.blocks,
    )


def _has_layers(description: Description, group: Group, chosen: Resolution) -> bool:
    """Whether efforts and flows may change behind a front faster than slabs resolve, as far as is known beforehand."""
    states = [branch.where for branch in (*group.loads, *group.branches) if len(branch.ports.Q)]
    fills = any(element.kind.steep for element in group.elements)
    scales = description.time_scales
    fast = any(where in scales and scales[where][0] < chosen.resolved for where in states)
    return not group.lumped_lines and (fills or fast or bool(states and group.elements))


def _recorded(lines: list[str], names: set[str]) -> tuple[dict[str, int], NDArray]:
    """Of each recorded line the first of its two rows, and of each end its row or -1."""
    record_row = np.full(2 * len(lines), -1)
    recorded: dict[str, int] = {}
    for k, name in enumerate(lines):
        if name in names:
            recorded[name] = 2 * len(recorded)
            record_row[2 * k : 2 * k + 2] = recorded[name], recorded[name] + 1
    return recorded, record_row
