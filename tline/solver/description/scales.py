"""How fast the waveforms and the dynamic loads of a scene are."""

from collections.abc import Iterable, Mapping
from math import inf

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.elements import PlacedLaw
from tline.solver.description.excitation import Shape
from tline.solver.description.groups import Group
from tline.solver.description.nodes import Node


def time_scales(waveforms: Mapping[str, Shape], groups: Iterable[Group]) -> dict[str, tuple[float, float]]:
    """Of each curved waveform and dynamic circuit the shortest time scale, and that of its oscillations, s."""
    scales = {where: (waveform.fastest(), waveform.fastest()) for where, waveform in waveforms.items()}
    for group in groups:
        if group.poles is not None:
            poles, where = group.poles, next(b.where for b in (*group.loads, *group.branches) if len(b.ports.Q))
            ringing = poles[np.abs(np.imag(poles)) > np.abs(np.real(poles))]
            scales[where] = (_shortest(poles), _shortest(ringing))
    return scales


def filling_times(elements: Iterable[PlacedLaw], nodes: Mapping[str, Node], pressure: float) -> list[float]:
    """Times in which vessels and tanks fill through all else at their nodes, at a piezometric pressure, s."""
    times = []
    for element in elements:
        capacity = element.kind.capacity(element.constants, pressure)
        if capacity:
            ends = [nodes[name] for name in element.nodes]
            times.append(capacity * sum(1 / end.total for end in ends if end.held is None))
    return times


def _shortest(poles: NDArray) -> float:
    """Time scale of the fastest pole, s; infinite if there is none."""
    fastest = float(np.abs(poles).max(initial=0.0))
    return 1 / fastest if fastest else inf
