"""Which elements of a scene may feed waves."""

from typing import TYPE_CHECKING

from tline.scene.multiport import ControlledSource
from tline.scene.rational_load import Impedance
from tline.solver.description.given import Scene
from tline.wording import place

if TYPE_CHECKING:
    from passivity import Verdict


def active_loads(scene: Scene) -> "dict[str, Verdict]":
    """Loads whose impedance is refuted to be positive real, by name; R, L and C above zero need no test."""
    impedances = {name: load for name, load in scene.loads.items() if isinstance(load, Impedance)}
    if not impedances:
        return {}
    from passivity import Status, check_positive_real

    verdicts = {name: check_positive_real(load.rational()) for name, load in impedances.items()}
    return {name: verdict for name, verdict in verdicts.items() if verdict.status is Status.REFUTED}


def controlled_sources(scene: Scene) -> list[str]:
    """Names of the links that may feed waves."""
    return [name for name, link in scene.links.items() if isinstance(link, ControlledSource)]


def active_parts(scene: Scene) -> dict[str, str]:
    """What there is to say of each active load, and of each link that may feed waves, by its place."""
    told = {place("loads", name): f"is active: {verdict.why}" for name, verdict in active_loads(scene).items()}
    return told | {place("links", name): "may feed waves" for name in controlled_sources(scene)}
