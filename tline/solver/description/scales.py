"""How fast the waveforms and the dynamic loads of a scene are."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import inf

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.elements import PlacedLaw
from tline.solver.description.excitation import Shape
from tline.solver.description.groups import Group
from tline.solver.description.nodes import Node


def time_scales(
    waveforms: Mapping[str, Shape], nodes: Iterable[Node], groups: Sequence[Group]
) -> dict[str, tuple[float, float]]:
    """Of each curved waveform and dynamic load the shortest time scale, and that of its oscillations, s.

    Parameters
    ----------
    waveforms : mapping of str to Shape
        By place.
    nodes : iterable of Node
    groups : sequence of Group
        Those of nodes that multiports join.
    """
    scales = {where: (waveform.fastest(), waveform.fastest()) for where, waveform in waveforms.items()}
    for where, poles in _poles(nodes, groups):
        ringing = poles[np.abs(np.imag(poles)) > np.abs(np.real(poles))]
        scales[where] = (_shortest(poles), _shortest(ringing))
    return scales


def filling_times(elements: Iterable[PlacedLaw], nodes: Mapping[str, Node]) -> list[float]:
    """Times in which vessels and tanks fill through all else at their nodes, at pressure 0, s."""
    times = []
    for element in elements:
        kind, constants = element.law.kind, element.law.constants
        if kind not in ("gas", "tank"):
            continue
        capacity = constants[2] if kind == "tank" else constants[3] / (constants[4] * constants[2])
        ends = [nodes[name] for name in element.nodes]
        times.append(capacity * sum(1 / end.total for end in ends if end.held is None))
    return times


def _poles(nodes: Iterable[Node], groups: Sequence[Group]) -> Iterator[tuple[str, NDArray]]:
    """Of each node with dynamic loads, alone or joined to others by multiports, in all states of its switches."""
    elsewhere = {id(node) for group in groups for node in group.nodes}
    for group in groups:
        yield group.ports[0].where, np.linalg.eigvals(group.system(0.0).A)
    for node in nodes:
        if node.load is not None and node.held is None and id(node) not in elsewhere:
            states = {node.switched(t) for t in (0.0, *(float(switch.time) for switch in node.switches), inf)}
            yield node.load_name, np.concatenate([np.linalg.eigvals(node.effort(g).A) for g in states])


def _shortest(poles: NDArray) -> float:
    """Time scale of the fastest pole, s; infinite if there is none."""
    fastest = float(np.abs(poles).max(initial=0.0))
    return 1 / fastest if fastest else inf
