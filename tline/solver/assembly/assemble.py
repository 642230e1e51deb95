"""From a scene to arrays: the one place that knows both."""

from collections.abc import Collection, Hashable
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tline.solver.assembly.diamonds import begin_steady, diamonds_of, fill_diamonds
from tline.solver.assembly.layout import Layout, layout_of
from tline.solver.assembly.node_maps import Event, maps_of
from tline.solver.description.description import Description
from tline.solver.description.groups import Group
from tline.solver.description.laws import with_basis
from tline.solver.description.resolution import Resolution, resolution
from tline.solver.kernel.network import Laws, Network, State
from tline.solver.radau import Basis, basis
from tline.solver.steady.edges import Ends

ORDERS = 4  # assemblies that a grid keeps
MOST_KEPT_SAMPLES = 1e5  # samples on the lines of one that is kept
KEPT = "basis", "network", "state", "recorded", "recorded_laws", "recorded_nodes", "kernel", "signals"
OF_LAWS = Laws._fields[: Laws._fields.index("record_row")]  # what slabs and what is recorded do not matter to


@dataclass
class Assembly(Layout):
    """Layout as arrays for slabs of one order, with the state and workspace of the time loop.

    Its arrays keep their addresses as long as runs on the same grid use it: they are packed once, and a scene
    with other values is written into them.
    """

    description: Description
    resolution: Resolution
    basis: Basis
    network: Network
    state: State
    events: list[Event]  # in order of time
    recorded: dict[str, int]  # line name -> first of its two rows in the record
    recorded_laws: dict[str, int]  # place of an element -> first of its two rows, behind those of lines
    recorded_nodes: dict[str, int]  # node without a line, or of these laws -> its row, behind those
    settle: NDArray  # (groups,) time in which a group with lumped lines settles after a front, s; 0 for others
    graded: NDArray  # (groups,) whether slabs are cut behind fronts, ever farther away
    kernel: Any = None  # of the loop, which packs the network and the state
    signals: Any = None  # of the loop

    @property
    def kept(self) -> int:
        """Rows of the record that a run keeps."""
        return 2 * (len(self.recorded) + len(self.recorded_laws)) + len(self.recorded_nodes)

    @property
    def rows(self) -> int:
        """Rows of the record, with those that observers added."""
        network = self.network
        return max(*(int(each.max(initial=-1)) + 1 for each in (network.record_row, network.effort_row)), self.kept)

    def watch(self, ends: NDArray, nodes: NDArray) -> None:
        """Record waves at some line ends, and efforts at some nodes, in rows behind those that a run keeps."""
        for row, seen in ((self.network.record_row, ends), (self.network.effort_row, nodes)):
            new = seen[row[seen] < 0]
            row[new] = self.rows + np.arange(len(new))

    @cached_property
    def follows_edges(self) -> bool:
        """Whether fronts at slabs' edges need pieces: where delays are whole and nothing is lumped they stay there."""
        fractional = (self.network.shift_row >= 0).any()
        return not self.resolution.plain and bool(fractional or self.settle.any() or self.graded.any())

    def leave(self) -> None:
        """Let the next run on the same grid have the arrays, if that is worth it."""
        if self.state.waves.size <= MOST_KEPT_SAMPLES:
            spare = self.grid.spare
            for old in list(spare)[: max(len(spare) + 1 - ORDERS, 0)]:
                spare.pop(old, None)  # which another thread may have done
            spare[_key(self.resolution, self.recorded, self.recorded_laws, self.description.probed_nodes)] = self


def _key(chosen: Resolution, record: Collection[str], laws: Collection[str], nodes: Collection[str]) -> Hashable:
    """Key of an assembly: scenes with the same key on one grid can share it."""
    return chosen.s, chosen.same, chosen.plain, frozenset(record), frozenset(laws), tuple(nodes)


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
    grid, order = layout.grid, basis(chosen.s)
    assembly: Assembly | None = grid.spare.pop(_key(chosen, record, laws, description.probed_nodes), None)
    if assembly is None or not rewritten(assembly, description, chosen, layout):
        maps, recorded = maps_of(layout.systems, order, grid.h), _recorded(layout, record, laws, description)
        network = _network(layout, order, recorded, maps, chosen.same)
        assembly = Assembly(
            **{each.name: getattr(layout, each.name) for each in fields(layout)},
            **_now(description, chosen, layout),
            basis=order,
            network=network,
            state=_state(network, layout, order),
            recorded=recorded[0],
            recorded_laws=recorded[1],
            recorded_nodes=recorded[2],
        )
        _begin(assembly)
    return assembly


def rewritten(assembly: Assembly, description: Description, chosen: Resolution, layout: Layout) -> bool:
    """Put a scene in place of another on the same grid, if it has as many of everything; whether that could be done."""
    if not _written(assembly, layout, maps_of(layout.systems, assembly.basis, layout.grid.h)):
        return False
    kept = {key: vars(assembly)[key] for key in KEPT}
    vars(assembly).clear()  # of what was found of the scene before, too
    vars(assembly).update(kept | vars(layout) | _now(description, chosen, layout))
    _begin(assembly)
    return True


def _now(description: Description, chosen: Resolution, layout: Layout) -> dict[str, Any]:
    follows = bool(chosen.layers) and not layout.grid.diamonds.size  # there slabs are halved: cuts would meet
    graded = np.array([follows and _has_layers(description, group, chosen) for group in layout.groups])
    return {
        "description": description,
        "resolution": chosen if graded.any() else chosen._replace(layers=0.0),
        "events": layout.systems.events,
        "settle": np.array([chosen.settle if group.lumped_lines else 0.0 for group in layout.groups]),
        "graded": graded,
    }


def _state(network: Network, layout: Layout, order: Basis) -> State:
    grid, s, lines = layout.grid, order.s, len(layout.grid.delay)
    return State(
        waves=np.empty(2 * int(grid.delay.sum()) * s),
        slot=np.empty(lines, np.int64),
        side=np.empty(lines, np.int64),
        before=np.empty((2 * lines, s)),
        load=np.empty(len(layout.loads_before)),
        memory=np.empty(network.diamonds.memory.states),
        halves=np.empty((len(network.ends) if network.diamonds.at_group.any() else 0, len(network.diamonds.values))),
        since=np.empty(len(network.diamonds.line), np.int64),
    )


def _begin(assembly: Assembly) -> None:
    """Write the state before t = 0."""
    state, network, grid, order = assembly.state, assembly.network, assembly.grid, assembly.basis
    for part in (state.slot, state.side, state.memory, state.halves, state.since):
        part.fill(0)
    sent = (assembly.arriving - assembly.moved) / np.repeat(grid.passed, 2)
    state.waves[:] = np.repeat(sent, np.repeat(grid.delay * order.s, 2))
    state.before[:] = sent[:, None]
    state.load[:] = assembly.loads_before
    if assembly.description.steady and grid.diamonds.size and not grid.cell:
        ends = zip(grid.lines.values(), assembly.u, assembly.y, strict=True)
        flows = {k: Ends(line, u, y) for k, (line, u, y) in enumerate(ends) if line.losses is not None}
        fill_diamonds(network, state, flows, order)


def _written(assembly: Assembly, layout: Layout, maps: tuple[NDArray, NDArray]) -> bool:
    """Put a layout in place of the one before, if it has as many of everything; whether that could be done in full."""
    network, laws, systems = assembly.network, assembly.network.laws, layout.systems
    pairs: list[tuple[Any, Any]] = [
        (network.weight, layout.weight),
        (network.excitation_row, layout.excitation_row),
        (network.load_at, systems.load_at),
        (network.step_row, systems.step_row),
        (network.step_states, systems.step_states),
        (network.step_whole, systems.whole),
        (network.step, maps[0]),
        (network.step_at, maps[1]),
        (network.moved, layout.moved),
        (assembly.state.load, layout.loads_before),
        *(zip(laws, layout.laws[: len(OF_LAWS)], strict=False) if len(laws.kind) else ()),
    ]
    if network.first is not layout.junctions.first:
        return False
    if not (np.array_equal(laws.kind, layout.laws.kind) and np.array_equal(laws.states, layout.laws.states)):
        return False  # whose units and workspace are others
    for old, new in pairs:
        if old.shape != new.shape:
            return False
        old[...] = new
    if layout.grid.cell:
        begin_steady(network.diamonds, layout.sent, layout.y, layout.grid.z0)
    return True


def _network(
    layout: Layout, order: Basis, recorded: tuple[dict[str, int], ...], maps: tuple[NDArray, NDArray], same: float
) -> Network:
    """The constant arrays of a layout at an order, which nothing else writes."""
    grid, systems, s = layout.grid, layout.systems, order.s
    record_row, of_laws = np.full(2 * len(grid.lines), -1), recorded[1]
    for k, name in enumerate(grid.lines):
        if name in recorded[0]:
            record_row[2 * k : 2 * k + 2] = recorded[0][name], recorded[0][name] + 1
    places = [element.where for element in layout.elements]
    pairs = [order.shift(f) for f in grid.rests]
    laws = layout.laws._replace(**{name: getattr(layout.laws, name).copy() for name in OF_LAWS})
    return Network(
        grid.delay,
        offset=np.concatenate([[0], np.cumsum(2 * grid.delay * s)[:-1]]),
        shift_row=grid.shift_row,
        shift=np.array(pairs) if pairs else np.zeros((0, 2, s, s)),
        first=layout.junctions.first,
        ends=layout.junctions.ends,
        weight=layout.weight.copy(),
        excitation_row=layout.excitation_row.copy(),
        group=layout.junctions.group,
        load_at=systems.load_at.copy(),
        step_row=systems.step_row.copy(),
        step_at=maps[1],
        step_states=systems.step_states.copy(),
        step_whole=systems.whole.copy(),
        step=maps[0],
        record_row=record_row,
        effort_row=np.array([recorded[2].get(node, -1) for node in layout.nodes], int),
        laws=with_basis(laws, order, grid.h, np.array([of_laws.get(where, -1) for where in places], int)),
        passed=grid.passed,
        moved=layout.moved.copy(),
        diamonds=diamonds_of(grid, order, layout.junctions, same, layout.sent, layout.y),
        blocks=layout.junctions.blocks,
    )


def _recorded(
    layout: Layout, record: set[str], laws: Collection[str], description: Description
) -> tuple[dict[str, int], dict[str, int], dict[str, int]]:
    """Rows of the record: the first of two of each line by name, and of laws by place, and of nodes by name.

    Nodes of these laws are among the nodes.
    """
    lines = {name: 2 * k for k, name in enumerate(name for name in layout.grid.lines if name in record)}
    elements = [element for element in layout.elements if element.where in laws]
    of_laws = {element.where: 2 * k for k, element in enumerate(elements, len(lines))}
    nodes = dict.fromkeys([*description.probed_nodes, *(node for element in elements for node in element.nodes)])
    return lines, of_laws, {node: k for k, node in enumerate(nodes, 2 * (len(lines) + len(of_laws)))}


def _has_layers(description: Description, group: Group, chosen: Resolution) -> bool:
    """Whether efforts and flows may change behind a front faster than slabs resolve, as far as is known beforehand."""
    states = [branch.where for branch in (*group.loads, *group.branches) if len(branch.ports.Q)]
    fills = any(element.kind.steep for element in group.elements)
    scales = description.time_scales
    fast = any(where in scales and scales[where][0] < chosen.resolved for where in states)
    return not group.lumped_lines and (fills or fast or bool(states and group.elements))
