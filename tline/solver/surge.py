"""Rises of pressure beyond what the stop of the flow in one pipe explains."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from tline.scene.limits import first_of
from tline.scene.load import Switch
from tline.scene.medium import HYDRAULIC, MEDIA
from tline.scene.mistakes import place
from tline.scene.scene import Scene
from tline.scene.shape import Constant
from tline.scene.vessel import Boiling
from tline.units import engineering

LISTED = 3  # elements
MARGIN = 1.01


def surges(scene: Scene, start: Mapping[str, NDArray], rises: Mapping[str, tuple[float, float]]) -> list[str]:
    """What rises above Joukowsky and line packing, and what was operated; one sentence, or none.

    In a single pipe that was steady a valve can add z0 |y| (Joukowsky) to the pressure there, and what friction had
    taken on the way from the highest pressure (line packing). More comes where waves meet: at dead ends, beyond
    junctions, where columns collapse.

    Parameters
    ----------
    scene : Scene
    start : mapping of str to ndarray
        By line the waves (a1, b1, a2, b2) before t = 0.
    rises : mapping of str to pair of float
        By place the effort before t = 0 and the highest, Pa.

    References
    ----------
    E. B. Wylie, V. L. Streeter, Fluid Transients in Systems, Prentice Hall, 1993.
    """
    if MEDIA[scene.medium] is not HYDRAULIC or scene.start != "steady" or not start:
        return []
    a1, b1, a2, b2 = np.stack(list(start.values()), axis=1)
    joukowsky, highest = float(np.abs(a1 - b1).max()) / 2, float(np.maximum(a1 + b1, a2 + b2).max()) / 2
    beyond = {
        where: top - before
        for where, (before, top) in rises.items()
        if top - before > MARGIN * (joukowsky + max(highest - before, 0.0))
    }
    if not joukowsky or not beyond:
        return []
    worst = max(beyond, key=beyond.__getitem__)
    unit = HYDRAULIC.shown["effort"]
    packing = max(highest - rises[worst][0], 0.0)
    moved = [place(part, name) for (part, name, _), shape in scene.waveforms.items() if not isinstance(shape, Constant)]
    moved += [place(part, name) for (part, name), one in scene.placed if isinstance(one, Switch)]
    causes = moved[:LISTED] + ["more"] * (len(moved) > LISTED)
    causes += ["cavities that collapse"] * any(isinstance(one, Boiling) for _, one in scene.placed)
    by = " and ".join(causes) or "what runs down or shuts by itself"
    return [
        f"{first_of(sorted(beyond, key=beyond.__getitem__, reverse=True))}: the pressure rises by "
        f"{engineering(beyond[worst], unit)}, above Joukowsky's {engineering(joukowsky, unit)} and the line packing of "
        f"{engineering(packing, unit)} that the flow in one pipe explains; waves of {by} add up"
    ]
