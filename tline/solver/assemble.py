"""From a scene to arrays: the one place that knows both."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.scene import Scene
from tline.scene.waveform import Shape
from tline.solver.drive import EDGE, just_before
from tline.solver.load_step import NO_LOAD, LoadStep, StateSpace, effort, reflection, stepwise
from tline.solver.network import Network, State
from tline.solver.nodes import Node, nodes_of
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
    switchings: list[tuple[int, int, int]]  # (slab from which on, node, step row), sorted
    nodes: list[str]
    recorded: dict[str, int]  # line name -> first of its two rows in the record
    start: dict[str, tuple[float, float]]  # line name -> (a, b) before t = 0


def assemble(scene: Scene, record: set[str]) -> Assembly:
    """Turn a scene into arrays; `record` names the lines whose end waves are kept."""
    nodes = nodes_of(scene)
    chosen = resolution(scene, nodes)
    order, h = basis(chosen.s), chosen.h
    lines = [line.parameters for line in scene.lines.values()]
    delay, shift_row, shift = _delays(np.array([line.delay or 0.0 for line in lines]) / h, order)
    z0 = np.array([line.z0 for line in lines])
    u, y = steady_state(scene, nodes) if scene.start == "steady" else (np.zeros(len(lines)), np.zeros(len(lines)))
    right, left = u + z0 * y, u - z0 * y

    ends = np.array([end for node in nodes.values() for end in node.ends])
    first = np.cumsum([0, *(len(node.ends) for node in nodes.values())])
    weight = np.concatenate([_weights(node, z0) for node in nodes.values()])
    drive_row, drives = _drives(nodes)
    arriving = np.stack([left, right], axis=1).ravel()  # at end 1 the wave to the left, at end 2 the one to the right
    before = np.array([w @ arriving[e] for w, e in _split(weight, ends, first)]) + [
        _drive_before(node) for node in nodes.values()
    ]
    load_row, steps, states, switchings = _loads(nodes, order, h, before if scene.start == "steady" else 0.0 * before)

    record_row = np.full(2 * len(lines), -1)
    recorded = {name: 2 * row for row, name in enumerate(name for name in scene.lines if name in record)}
    for k, name in enumerate(scene.lines):
        if name in recorded:
            record_row[2 * k : 2 * k + 2] = recorded[name], recorded[name] + 1
    offset = np.concatenate([[0], np.cumsum(2 * delay * chosen.s)[:-1]])
    step_row = np.where(load_row >= 0, 0, -1)
    network = Network(
        delay, offset, shift_row, shift, first, ends, weight, drive_row, load_row, step_row, steps, record_row
    )
    state = State(
        waves=np.repeat(np.stack([left, right], axis=1).ravel(), np.repeat(delay * chosen.s, 2)),
        slot=np.zeros(len(lines), np.int64),
        side=np.zeros(len(lines), np.int64),
        before=np.repeat(arriving[:, None], chosen.s, axis=1),
        load=states,
    )
    start = {name: (float(right[k]), float(left[k])) for k, name in enumerate(scene.lines)}
    return Assembly(scene, chosen, order, network, state, drives, switchings, list(nodes), recorded, start)


def _split(weight: NDArray, ends: NDArray, first: NDArray):
    return zip(np.split(weight, first[1:-1]), np.split(ends, first[1:-1]), strict=True)


def _delays(slabs: NDArray, order: Basis) -> tuple[NDArray, NDArray, NDArray]:
    """Whole slabs of each delay, and row and matrices of the fractional rest, one pair for each different rest."""
    near = np.round(slabs)
    whole = np.abs(slabs - near) <= WHOLE * near
    delay = np.where(whole, near, np.floor(slabs)).astype(np.int64)
    rest, row = np.unique(np.where(whole, -1.0, slabs - delay), return_inverse=True)
    pairs = [order.shift(f) for f in rest if f >= 0]
    shift = np.array(pairs) if pairs else np.zeros((0, 2, order.s, order.s))
    return delay, row - int(rest[0] < 0), shift


def _weights(node: Node, z0: NDArray) -> NDArray:
    """Share of each end's arriving wave in the node's Thévenin wave; none reach an effort that is held."""
    own = 1 / z0[np.array(node.ends) // 2]
    return 0.0 * own if node.held is not None else own / (own.sum() + node.conductance)


def _drives(nodes: dict[str, Node]) -> tuple[NDArray, list[list[tuple[Shape, float]]]]:
    rows, drives = np.full(len(nodes), -1), []
    for k, node in enumerate(nodes.values()):
        parts = (
            [(node.held, 1.0)]
            if node.held is not None
            else [(wave, factor / node.total) for wave, factor in node.flows]
        )
        if parts:
            rows[k] = len(drives)
            drives.append(parts)
    return rows, drives


def _drive_before(node: Node) -> float:
    return just_before(node.held) if node.held is not None else node.flow_before() / node.total


def _loads(
    nodes: dict[str, Node], order: Basis, h: float, thevenin: NDArray
) -> tuple[NDArray, NDArray, NDArray, list[tuple[int, int, int]]]:
    """Row of each node's load, all maps over a slab (padded to one size), initial states, and the switchings."""
    rows = np.full(len(nodes), -1)
    maps: list[LoadStep] = []
    states: list[NDArray] = []
    switchings: list[tuple[int, int, int]] = []
    for k, (name, node) in enumerate(nodes.items()):
        if node.held is not None or (node.load is None and not node.switches):
            continue
        rows[k] = len(states)
        wave = reflection(node.load, 1 / node.total, node.load_name) if node.load is not None else NO_LOAD
        started = _effort(wave, node, node.switched(0.0), name)
        states.append(started.at_rest_under(thevenin[k]) if thevenin[k] else np.zeros(len(wave.A)))
        for slab, pieces in _slabs_of(node, h):
            switchings.append((slab, k, len(maps)))
            maps.append(stepwise([(p, q, _effort(wave, node, g, name)) for p, q, g in pieces], order, h))
    n = max((len(state) for state in states), default=0)
    steps = np.zeros((len(maps), order.s + n, order.s + n))
    for row, step in enumerate(maps):
        m = step.x_x.shape[0]
        steps[row, : order.s, : order.s + m] = np.hstack([step.u_w, step.u_x])
        steps[row, order.s : order.s + m, : order.s + m] = np.hstack([step.x_w, step.x_x])
    padded = np.array([np.pad(state, (0, n - len(state))) for state in states]).reshape(len(states), n)
    return rows, steps, padded, sorted(switchings)


def _effort(wave: StateSpace, node: Node, switched: float, name: str) -> StateSpace:
    try:
        return effort(wave, switched / node.total)
    except ZeroDivisionError:
        raise InputError(
            f"node '{name}'",
            f"a switch shorts {node.load_name}, which holds its effort",
            "a resistance above zero",
        ) from None


def _slabs_of(node: Node, h: float) -> list[tuple[int, list[tuple[float, float, float]]]]:
    """Where the node's map changes: (slab, pieces (start, end, switched conductance) in slab time)."""
    times = sorted({float(switch.time) for switch in node.switches if switch.time > 0})
    changes: dict[int, list[tuple[float, float, float]]] = {
        0: [(0.0, 1.0, node.switched(times[0] if times else np.inf))]
    }
    if any(switch.time == 0 for switch in node.switches):
        changes[0] = [(0.0, 1.0, node.switched(np.nextafter(0.0, 1.0)))]
    for k, time in enumerate(times):
        after = node.switched(times[k + 1] if k + 1 < len(times) else np.inf)
        slab, place = int(time / h), time / h - int(time / h)
        if place > 1 - EDGE:
            slab, place = slab + 1, 0.0
        if place < EDGE:
            changes[slab] = [(0.0, 1.0, after)]
            continue
        pieces = changes.get(slab) or [(0.0, 1.0, node.switched(time))]
        start, _, g = pieces[-1]
        changes[slab] = [*pieces[:-1], (start, place, g), (place, 1.0, after)]
        changes[slab + 1] = [(0.0, 1.0, after)]
    return sorted(changes.items())
