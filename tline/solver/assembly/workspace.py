"""Room in which slabs in pieces are worked on, one group after the other: made once, it costs no slab anything."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.assembly.network import Floats, Integers, Network
from tline.solver.assembly.settling import SUBSTEPS


class Steps(NamedTuple):
    """A piece in which a group settles, in several steps."""

    edges: Floats  # (steps + 1,)
    ends: Floats  # (2,) of the piece
    values: Floats  # (nodes, steps, s)
    wave: Floats  # (nodes * s,) of one step
    out: Floats  # (1, s)


class Room(NamedTuple):
    """For a group: at most so many pieces m, nodes, line ends and elements."""

    position: Integers  # (2 L,) first sample of the slab that works at each line end
    place: Floats  # of the fronts that meet
    size: Floats  # of each
    edges: Floats  # (m + 1,) of the pieces
    own: Floats  # (m + 1,) of the pieces of one wave
    outer: Floats  # (m + 1,) without those that only settling needs
    unsettled: NDArray[np.bool_]  # (m,)
    span: Floats  # (pieces, 2) of a wave that is given
    given: Floats  # (pieces, s)
    arrived: Floats  # (ends, m, s)
    u: Floats  # (nodes, m, s)
    factor: Floats  # (elements, m, s) what scales the elements
    opening: Floats  # (elements, s) in one piece
    coef: Floats  # (m + 1, s)
    whole: Floats  # (s,)
    part: Floats  # (s,)
    wave: Floats  # (nodes * s,) of one piece
    row: Floats  # (nodes * s + states,)
    stages: Floats  # (states * s, states * s + 1)
    history: Floats  # (s, 2)
    steps: Steps


def room_for(network: Network, s: int, most: int, parts: int) -> Room:
    """Room for `most` pieces of a slab at a node, and for waves given in at most so many parts."""
    nodes = int(np.diff(network.group).max(initial=1))
    ends = int(np.diff(network.first[network.group]).max(initial=0))
    states = int(network.step_states.max(initial=0))
    elements = int(np.diff(network.laws.first).max(initial=0))
    fronts, given = 2 * most * ends + most, max(parts, 2 * most + 2)
    return Room(
        position=np.zeros(len(network.ends), int),
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
        factor=np.zeros((elements, most, s)),
        opening=np.zeros((elements, s)),
        coef=np.zeros((most + 1, s)),
        whole=np.zeros(s),
        part=np.zeros(s),
        wave=np.zeros(nodes * s),
        row=np.zeros(nodes * s + states),
        stages=np.zeros((s * states, s * states + 1)),
        history=np.zeros((s, 2)),
        steps=Steps(
            np.zeros(SUBSTEPS + 2),
            np.array([0.0, 1.0]),
            np.zeros((nodes, SUBSTEPS + 1, s)),
            np.zeros(nodes * s),
            np.zeros((1, s)),
        ),
    )
