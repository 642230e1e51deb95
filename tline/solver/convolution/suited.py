"""Which scenes are convolutions, and on which slabs these are affordable."""

import numpy as np

from tline.solver.convolution.families import MOST as MOST_FAMILIES
from tline.solver.convolution.run import Convolved
from tline.solver.description.description import Description

MOST_BESIDE_LAWS = 2e7  # weights of convolutions, numbers
MOST, FEW = 4e6, 8  # points at which the scene answers in one run, times its line ends; of more than these a cube


def suits(description: Description) -> bool:
    """Whether lines lose linearly, not all of them in diamonds, and the rest but laws and switches stays what it is."""
    losses = [line.losses for line in description.lines.values() if line.losses is not None]
    if not (description.dispersive or description.mixing) or not all(each.linear for each in losses):
        return False
    moving = any(element.governor is not None or element.kind.breaks for element in description.elements)
    lifted = description.heights and not description.steady
    return not (moving or lifted or description.active or (description.mixing and description.steady))


def affordable(scene: Convolved, s: int, h: float) -> bool:
    """Whether a scene is convolved on slabs of an order and a width within some seconds."""
    leads = np.zeros(1) if scene.layered else scene.leads(h)
    several = len(leads) > 1 and any(changes.curved and len(changes.at) > 1 for changes in scene.changes)
    points, ends = scene.description.t_end / h * s * len(leads), scene.network.size
    if scene.description.t_end / h * (len(scene.network.laws) * s) ** 2 > MOST_BESIDE_LAWS:
        return False
    return not several and len(leads) <= MOST_FAMILIES and points * ends * max(ends / FEW, 1) ** 2 <= MOST
