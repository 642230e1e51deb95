"""Controls of a network's file as operations: what opens or shuts within a run, and what cannot be told so."""

from collections import defaultdict
from collections.abc import Collection, Iterable

from tline.interchange.water_controls import WaterControl
from tline.interchange.water_network import listed
from tline.scene.held import held_nodes
from tline.scene.pump import Pump
from tline.scene.scene import Scene
from tline.scene.valve import Orifice
from tline.solver.description.excitation import just_before
from tline.surge.control import Control
from tline.surge.event import Event


def acting(
    scene: Scene, controls: Iterable[WaterControl], taken: Collection[str], t_end: float
) -> tuple[list[Event], list[Control], list[str]]:
    """Operations at instants within a run, those that wait for a pressure, and notes.

    A link is operated once: by the first of its controls that changes its state. A pump is tripped or started, for a
    file says nothing of how its speed changes, and everything else is moved at once.

    Parameters
    ----------
    scene : Scene
        In the state in which the controls begin to count.
    controls : iterable of WaterControl
    taken : collection of str
        Elements that are operated otherwise.
    t_end : float
        s
    """
    held, done = held_nodes(scene), {*taken}
    events, waiting, left = list[Event](), list[Control](), defaultdict[str, set[str]](set)
    notes = list[str]()
    for one in controls:
        if one.after is not None and one.after >= t_end:
            continue
        if why := "for their links are operated once" if one.link in done else _refused(scene, one, held):
            left[why].add(one.text)
        elif kind := _kind(scene, one):
            done.add(one.link)
            event = Event(kind, one.link, one.after or 0.0)
            if one.after is None:
                waiting.append(Control(one.node, one.pressure, one.above, event, one.text))
            else:
                events.append(event)
                notes.append(f"'{one.text}': {kind} after {one.after:.6g} s")
    notes += [f"controls and rules that are left out, {why}: {listed(texts)}" for why, texts in left.items()]
    return events, waiting, notes


def _refused(scene: Scene, one: WaterControl, held: Collection[str]) -> str:
    """Why a control cannot act; nothing if it can."""
    if one.opens is None:
        return "for they do more than open or shut at an instant or a pressure"
    if one.link not in scene.lines and one.link not in scene.links:
        return "for their links are not in the scene"
    if one.node in held:
        return "for they wait at tanks that hold their level"
    return ""


def _kind(scene: Scene, one: WaterControl) -> str:
    """What a control does to its link; nothing if that is so already."""
    if one.link in scene.lines:
        return "" if one.opens else "close"
    link = scene.links[one.link]
    if isinstance(link, Pump):
        runs = just_before(link.speed) > 0
        return "" if runs == one.opens else "start" if one.opens else "trip"
    opening = just_before(link.opening) if isinstance(link, Orifice) else None
    return "" if opening == float(bool(one.opens)) else "open" if one.opens else "close"
