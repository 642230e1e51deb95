"""Workspaces of the kernel: made once, they cost no slab anything."""

from functools import cache
from typing import Any

import numpy as np

from tline.compiled.structure import pack
from tline.solver.assembly.node_maps import SUBSTEPS
from tline.solver.kernel.diamonds.cells import CELL_ORDER, PARTS
from tline.solver.kernel.fronts.structures import Steps, Workspace
from tline.solver.kernel.network import (
    CircuitWork,
    Crossing,
    DiamondWork,
    GovernWork,
    Laws,
    Network,
    State,
    Store,
    Tools,
    Work,
)

SAMPLES = 512  # per tile
GOVERNED = 3  # states of an opening that moves
AT_LAWS = "given", "aimed", "start", "safe", "trial", "sent", "flow", "other", "slope", "rest", "drive"  # of a circuit
AT_POINTS = (
    "v",
    "control",
    "flow",
    "drive",
    "y",
    "slope",
    "rate",
    "first",
    "safe",
    "rest",
    "coef",
    "piece",
    "kept",
    "whole",
)  # of a store


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
    crossing, store, circuit = _of_elements(laws, state, nodes, elements, tile) if elements else _without_elements()
    return Work(
        tile=tile,
        position=np.zeros(len(network.ends), np.int64),
        u=np.empty(nodes * tile * s),
        history=np.empty((s, tile + 1)),
        row=np.empty(max(tile, ports * s + states)),
        control=np.empty((elements, tile * s)),
        into=np.empty((elements, tile * s)),
        crossing=crossing,
        store=store,
        circuit=circuit,
        govern=_of_governors(laws, elements * s if laws.governed.any() else 0, nodes * s, states, elements),
        map=np.empty((ports * s + states) ** 2 if elements and states else 0),
        diamonds=_of_diamonds(network, s, states, elements),
    )


def renew(work: Work, network: Network, s: int) -> None:
    """Clear the starting values of an earlier run at laws, if these are coupled or have states."""
    laws = network.laws
    if not len(laws.kind) or not (len(network.step_states) or laws.states.any() or laws.governed.any()):
        return
    store = work.store
    for part in (*work.circuit, *work.govern, store.system, store.integral, store.constant, store.division):
        part.fill(0)
    work.circuit.waves[:], work.circuit.held[:] = np.repeat(laws.before, s), laws.effort


def _of_diamonds(network: Network, s: int, states: int, elements: int) -> DiamondWork:
    """Workspace of diamonds at groups of at most `states` states and `elements` elements."""
    ends = int(np.diff(network.first[network.group]).max(initial=0)) if len(network.diamonds.line) else 0
    widest = int(network.diamonds.cell.max(initial=0))
    r = min(s, CELL_ORDER) if widest else s
    modes, kept = (
        len(network.diamonds.moments),
        states + (GOVERNED + int(network.laws.states.max(initial=0))) * elements,
    )
    return DiamondWork(
        taken=np.empty((r, r)),
        along=np.empty((r, r)),
        base=np.empty((r, r)),
        value=np.empty((r, r)),
        slope=np.empty((r, r)),
        weight=np.ones((r, r)),
        edges=np.empty((2, PARTS + 1)),
        parts=np.empty((4, PARTS, r)),
        slabs=np.empty((2, widest * s)),
        rest=np.ones(1),
        shape=np.empty((r, widest * s)),
        shaped=np.zeros(1, np.int64),
        tangent=np.empty((3, ends, len(network.diamonds.values))),
        a=np.empty(r),
        b=np.empty(r),
        coming=np.empty((ends, s)),
        tail=np.empty((ends, s)),
        seen=np.empty((ends, modes)),
        modes=np.empty((ends, modes)),
        flow=np.empty(modes),
        sent=np.empty(s),
        kept=np.empty(kept),
        width=np.ones(1),
        projected=np.zeros(ends, np.int64),
    )


def _of_elements(laws: Laws, state: State, nodes: int, elements: int, tile: int) -> tuple[Crossing, Store, CircuitWork]:
    """Workspace of laws and stores in groups of at most `nodes` nodes and `elements` elements."""
    s = state.before.shape[1]
    at_points = {name: np.empty(s) for name in AT_POINTS}
    system, integral = np.zeros((s, s + 1)), np.empty(s + 1)
    store = Store(
        laws.constants,
        state.load,
        laws.tools,
        system=system,
        integral=integral,
        constant=np.empty(1),
        division=np.zeros(3, np.int64),
        **at_points,
    )
    circuit = CircuitWork(
        **{name: np.zeros(elements * s) for name in AT_LAWS},
        answer=np.zeros((elements * s, s)),
        system=np.zeros((elements * s, elements * s + 1)),
        control=np.zeros((elements, s)),
        kept=np.zeros((elements, int(laws.states.max(initial=0)))),
        waves=np.repeat(laws.before, s),
        held=laws.effort.copy(),
        part=np.zeros(nodes, np.int64),
        width=np.zeros(1, np.int64),
        largest=np.zeros(1),
    )
    return Crossing(laws.constants, *np.empty((4, tile * s))), store, circuit


def _of_governors(laws: Laws, points: int, samples: int, states: int, elements: int) -> GovernWork:
    """Workspace of openings at `points` points, in a group of these samples, states and elements."""
    each = {name: np.zeros(points) for name in ("rate", "rest", "last", "step", "turned")}
    kept = np.zeros((elements, int(laws.states.max(initial=0))))
    return GovernWork(np.empty(samples), np.empty(states), kept, **each, inverse=np.zeros((points, points)))


@cache
def _without_elements() -> Any:
    """Packed workspace of a network without elements; never read."""
    nothing = np.empty(0)
    matrix = np.empty((0, 0))
    tools = Tools(nothing, matrix, matrix, matrix, matrix)
    others = dict.fromkeys((*AT_POINTS, "integral", "constant"), nothing)
    store = Store(nothing, nothing, tools, **others, system=matrix, division=np.empty(0, np.int64))
    two = dict.fromkeys(("answer", "system", "control", "kept"), matrix)
    one = dict.fromkeys((*AT_LAWS, "waves", "held", "largest"), nothing)
    circuit = CircuitWork(**one, **two, **dict.fromkeys(("part", "width"), np.zeros(0, np.int64)))
    return pack(Crossing(*[nothing] * len(Crossing._fields))), pack(store), pack(circuit)


def workspace_for(network: Network, s: int, most: int, parts: int) -> Workspace:
    """Workspace for `most` pieces of a slab at a node, and for prescribed waves in at most `parts` parts."""
    nodes, states, elements = largest_group(network)
    ends = int(np.diff(network.first[network.group]).max(initial=0))
    fronts, given = 2 * most * ends + most, max(parts, 2 * most + 2)
    return Workspace(
        place=np.zeros(fronts),
        size=np.zeros(max(fronts, most + 1)),
        edges=np.zeros(most + 1),
        own=np.zeros(most + 1),
        outer=np.zeros(most + 1),
        unsettled=np.zeros(most, bool),
        span=np.zeros((given, 2)),
        given=np.zeros((given, s)),
        arrived=np.zeros((ends, most, s)),
        u=np.zeros((nodes, most, s)),
        control=np.zeros((elements, most, s)),
        into=np.zeros((elements, most, s)),
        coef=np.zeros((most + 1, s)),
        whole=np.zeros(s),
        part=np.zeros(s),
        stages=np.zeros((s * states, s * states + (s * (nodes + elements) + states if elements else 1))),
        steps=Steps(
            np.zeros(SUBSTEPS + 2),
            np.array([0.0, 1.0]),
            np.zeros((nodes, SUBSTEPS + 1, s)),
            np.zeros(nodes * s),
            np.zeros((1, s)),
        ),
        left=np.zeros((ends, most, s)),
        pair_edges=np.zeros((2, given + 1)),
        pair=np.zeros((2, given, s)),
    )
