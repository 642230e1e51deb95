"""How far a tank may fill and empty."""

from math import inf
from typing import NamedTuple

from tline.scene.vessel import SurgeTank
from tline.solver.description.given import Scene
from tline.words.wording import place


class Levels(NamedTuple):
    """Levels above its node at which a tank is empty, and overflows, m; and the pressure of a metre, Pa/m."""

    node: str
    weight: float
    lowest: float
    highest: float


def levels_of(scene: Scene) -> dict[str, Levels]:
    """Of tanks, by place."""
    return {
        place("loads", name): Levels(
            load.at,
            load.weight,
            -inf if load.lowest_level is None else float(load.lowest_level),
            inf if load.highest_level is None else float(load.highest_level),
        )
        for name, load in scene.loads.items()
        if isinstance(load, SurgeTank)
    }
