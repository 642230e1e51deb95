"""Which elements of a scene may feed waves."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tline.scene.multiport import ControlledSource
from tline.scene.rational import AnyImpedance
from tline.solver.description.given import ElementLaw, Scene
from tline.words.wording import place

if TYPE_CHECKING:
    from passivity import Verdict


def active_impedances(scene: Scene) -> "dict[str, Verdict]":
    """Loads and links whose impedance is refuted to be positive real, by place; R, L and C above zero need no test."""
    given = {place(*at): x for at, x in scene.placed if isinstance(x, AnyImpedance)}
    if not given:
        return {}
    from passivity import Status, check_positive_real

    verdicts = {where: check_positive_real(element.rational()) for where, element in given.items()}
    return {where: verdict for where, verdict in verdicts.items() if verdict.status is Status.REFUTED}


def controlled_sources(scene: Scene) -> list[str]:
    """Names of the links that may feed waves."""
    return [name for name, link in scene.links.items() if isinstance(link, ControlledSource)]


def laws_not_through_the_origin(scene: Scene) -> dict[str, str]:
    """What there is to say of each law that is not passive by its kind, by its place.

    A law that never falls takes energy if no flow passes it without an effort; where one does, there is a source in it.
    """
    told = {place(*at): _origin(law) for at, law in scene.laws.items()}
    return {where: sentence for where, sentence in told.items() if sentence}


def _origin(law: ElementLaw) -> str:
    beginning, *rest = law.constants
    match law.kind:
        case "pump" | "rotor":
            return "a pump, which holds a source"
        case "user_defined":
            return "user-defined; passive if effort times flow is never negative"
        case "table" if not _through_origin(*np.array(rest[1:]).reshape(2, -1)):
            return "a table that misses the origin, so that it holds a source"
        case "quadratic" if beginning < 0 or (beginning > 0 and not rest[1]):
            return "has a pressure behind it, which is a source"
        case "relief" if beginning + rest[1] < 0:
            return "has a pressure behind it, which is a source"
    return ""


def _through_origin(efforts: NDArray, flows: NDArray) -> bool:
    """Whether straight lines between points, the outer ones continued, meet the origin; neither effort nor flow falls.

    Examples
    --------
    >>> _through_origin(np.array([1.0, 2.0]), np.array([2.0, 4.0])), _through_origin(np.ones(2), np.arange(2.0))
    (True, False)
    """
    begin = (np.arange(len(efforts) - 1) == 0) | ((efforts[:-1] <= 0) & (flows[:-1] <= 0))
    end = (np.arange(len(efforts) - 1) == len(efforts) - 2) | ((efforts[1:] >= 0) & (flows[1:] >= 0))
    return bool((begin & end & (efforts[:-1] * flows[1:] == efforts[1:] * flows[:-1])).any())


def active_parts(scene: Scene) -> dict[str, str]:
    """What there is to say of each active load, and of each link that may feed waves, by its place."""
    told = {where: f"is active: {verdict.why}" for where, verdict in active_impedances(scene).items()}
    return told | {place("links", name): "may feed waves" for name in controlled_sources(scene)}
