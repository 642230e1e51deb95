"""From a scene to arrays: the one place that knows both."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tline.scene.line import SceneLine
from tline.scene.scene import Scene
from tline.scene.waveform import Shape
from tline.solver.drive import just_before
from tline.solver.load_step import StateSpace
from tline.solver.lumps import grouped
from tline.solver.network import Network, State
from tline.solver.node_maps import node_maps
from tline.solver.nodes import nodes_of
from tline.solver.radau import Basis, basis
from tline.solver.resolution import WHOLE, Resolution, resolution
from tline.solver.steady import steady_state


@dataclass
class Assembly:
    """A scene as arrays, and what the time loop needs beside them."""

    scene: Scene
    resolution: Resolution
    basis: Basis
    network: Network
    state: State
    drives: list[list[tuple[Shape, float]]]  # of each drive row: waveforms and their shares of the Thévenin wave
    systems: list[StateSpace]  # of each row of the network's maps
    changes: list[tuple[float, int, int]]  # (instant in slabs, group, row of the map from then on), sorted
    nodes: list[str]
    lines: dict[str, SceneLine]  # those that are not lumped
    recorded: dict[str, int]  # line name -> first of its two rows in the record
    start: dict[str, tuple[float, float]]  # line name -> (a, b) before t = 0
    settle: NDArray  # (groups,) time in which a group with lumped lines settles after a front, s; 0 for others

    @property
    def follows_edges(self) -> bool:
        """Whether fronts at slabs' edges need pieces: where delays are whole and nothing is lumped they stay there."""
        return bool((self.network.shift_row >= 0).any() or self.settle.any())


def assemble(scene: Scene, record: set[str], chosen: Resolution | None = None) -> Assembly:
    """Turn a scene into arrays; `record` names the lines whose end waves are kept."""
    nodes = nodes_of(scene)
    chosen = chosen or resolution(scene, nodes)
    order, h = basis(chosen.s), chosen.h
    u, y = steady_state(scene, nodes) if scene.start == "steady" else np.zeros((2, len(scene.single_lines)))
    groups, nodes = grouped(scene, chosen.cells, nodes_of(scene, chosen.cells) if chosen.cells else nodes, u, y)
    lines = {name: line for name, line in scene.single_lines.items() if name not in chosen.cells}
    z0 = np.array([line.parameters.z0 for line in lines.values()])
    kept = np.array([name in lines for name in scene.single_lines])
    arriving = np.stack([u[kept] - z0 * y[kept], u[kept] + z0 * y[kept]], axis=1).ravel()  # b at end 1, a at end 2

    delay, shift_row, shift = _delays(lines, order, h)
    drives = [node.drives for node in nodes.values()]
    ends = np.array([end for node in nodes.values() for end in node.ends])
    degree = [len(node.ends) for node in nodes.values()]
    weight = np.concatenate([node.weights(z0) for node in nodes.values()])
    thevenin = np.bincount(np.repeat(np.arange(len(nodes)), degree), weight * arriving[ends], len(nodes))
    if scene.start == "steady":
        thevenin += [sum(share * just_before(waveform) for waveform, share in parts) for parts in drives]
    driven = np.array([bool(parts) for parts in drives])
    maps = node_maps(groups, order, h, thevenin)
    recorded, record_row = _recorded(lines, record)
    network = Network(
        delay,
        offset=np.concatenate([[0], np.cumsum(2 * delay * chosen.s)[:-1]]),
        shift_row=shift_row,
        shift=shift,
        first=np.cumsum([0, *degree]),
        ends=ends,
        weight=weight,
        drive_row=np.where(driven, np.cumsum(driven) - 1, -1),
        group=np.cumsum([0, *(len(group.nodes) for group in groups)]),
        load_at=maps.load_at,
        step_row=maps.step_row,
        step_at=maps.step_at,
        step_states=maps.step_states,
        step=maps.step,
        record_row=record_row,
    )
    state = State(
        waves=np.repeat(arriving, np.repeat(delay * chosen.s, 2)),
        slot=np.zeros(len(delay), np.int64),
        side=np.zeros(len(delay), np.int64),
        before=np.repeat(arriving[:, None], chosen.s, axis=1),
        load=maps.states,
    )
    start = {name: (arriving[2 * k + 1], arriving[2 * k]) for k, name in enumerate(lines)}
    return Assembly(
        scene=scene,
        resolution=chosen,
        basis=order,
        network=network,
        state=state,
        drives=list(filter(None, drives)),
        systems=maps.systems,
        changes=maps.changes,
        nodes=list(nodes),
        lines=lines,
        recorded=recorded,
        start=start,
        settle=np.array([chosen.settle if group.lumps else 0.0 for group in groups]),
    )


def _recorded(lines: dict[str, SceneLine], names: set[str]) -> tuple[dict[str, int], NDArray]:
    """Of each recorded line the first of its two rows, and of each end its row or -1."""
    record_row = np.full(2 * len(lines), -1)
    recorded: dict[str, int] = {}
    for k, name in enumerate(lines):
        if name in names:
            recorded[name] = 2 * len(recorded)
            record_row[2 * k : 2 * k + 2] = recorded[name], recorded[name] + 1
    return recorded, record_row


def _delays(lines: dict[str, SceneLine], order: Basis, h: float) -> tuple[NDArray, NDArray, NDArray]:
    """Whole slabs of each delay, and row and matrices of the fractional rest, one pair for each different rest."""
    slabs = np.array([line.parameters.delay or 0.0 for line in lines.values()]) / h
    near = np.round(slabs)
    whole = np.abs(slabs - near) <= WHOLE * near
    delay = np.where(whole, near, np.floor(slabs)).astype(np.int64)
    rest, row = np.unique(np.where(whole, -1.0, slabs - delay), return_inverse=True)
    pairs = [order.shift(f) for f in rest if f >= 0]
    shift = np.array(pairs) if pairs else np.zeros((0, 2, order.s, order.s))
    return delay, row - int(rest[0] < 0), shift
