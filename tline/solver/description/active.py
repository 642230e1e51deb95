"""Elements of a scene that are active, or may be."""

from typing import TYPE_CHECKING

from tline.scene.multiport import ControlledSource
from tline.scene.rational import Impedance
from tline.solver.description.given import Scene
from tline.words.wording import place

if TYPE_CHECKING:
    from passivity import Verdict


def impedances(scene: Scene) -> dict[str, Impedance]:
    """Loads and links that may be active, by place; R, L and C above zero are not."""
    return {place(*at): x for at, x in scene.placed if isinstance(x, Impedance)}


def active_impedances(scene: Scene) -> "dict[str, Verdict]":
    """Loads and links whose impedance is refuted to be positive real, by place."""
    given = impedances(scene)
    if not given:
        return {}
    from passivity import Status, check_positive_real

    verdicts = {where: check_positive_real(element.rational()) for where, element in given.items()}
    return {where: verdict for where, verdict in verdicts.items() if verdict.status is Status.REFUTED}


def controlled_sources(scene: Scene) -> list[str]:
    """Names of the links that may feed waves."""
    return [name for name, link in scene.links.items() if isinstance(link, ControlledSource)]


def laws_not_through_the_origin(scene: Scene) -> dict[str, str]:
    """Sentence on each law that is not passive by its kind, by place.

    A monotone law is passive if its flow is zero without effort; otherwise it contains a source.
    """
    told = {place(*at): law.of_kind.source(law.constants) for at, law in scene.laws.items()}
    return {where: sentence for where, sentence in told.items() if sentence}


def active_parts(scene: Scene) -> dict[str, str]:
    """Sentence on each active load, and on each link that may be active, by place."""
    told = {where: f"is active: {verdict.why}" for where, verdict in active_impedances(scene).items()}
    return told | {place("links", name): "may feed waves" for name in controlled_sources(scene)}
