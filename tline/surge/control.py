"""Operations once a pressure is reached: words such as "tower>5.2 bar: close V1+5s", and controls of files."""

import re
from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from tline.errors import InputError
from tline.interchange.water_controls import WaterControl
from tline.interchange.water_network import listed
from tline.scene.heights import GRAVITY
from tline.scene.held import held_nodes
from tline.scene.pump import Pump
from tline.scene.rating import WATER
from tline.scene.scene import Scene
from tline.scene.valve import Orifice
from tline.solver.description.excitation import just_before
from tline.solver.result.result import ProbeResult, Result
from tline.surge.event import TURNED, Event, read_event, with_unit
from tline.words.wording import nearest

FORM = re.compile(r"(?P<node>[^<>]+)(?P<sign>[<>])(?P<value>[^:]+):\s*(?P<kind>\w+)\s+(?P<what>.+)")
EXPECTED = (
    "NODE<PRESSURE:KIND LINK+DURATION, such as 'tower>5.2 bar: close V1+5s', with close, open, trip, start or stop"
)
ROTORS = {"trip", "start", "stop"}
BETWEEN = 8  # looks within a slab
HALVINGS = 60


class Control(NamedTuple):
    """An operation that waits for a pressure."""

    node: str
    pressure: float  # gauge pressure there, Pa
    above: bool  # whether it is to exceed that, or to fall below it
    event: Event  # the operation; its instant counts from there
    text: str  # as it was said


def read_control(text: str) -> Control:
    """The control that a text says; a pressure in metres is a level of water above the node.

    Examples
    --------
    >>> control = read_control("tower > 5.2 bar: close V1+5s")
    >>> control.node, control.above, control.pressure, control.event.name, control.event.duration
    ('tower', True, 520000.0, 'V1', 5.0)
    """
    found = FORM.fullmatch(text.strip())
    if found is None or found["kind"] not in {*TURNED, *ROTORS}:
        raise InputError("when", "not a control", EXPECTED, f"'{text}'")
    name, mark, rest = found["what"].rpartition(":") if found["what"].endswith(".csv") else found["what"].partition("+")
    event = read_event(found["kind"], f"{name.strip()}@0s{mark}{rest.strip()}")
    value = found["value"].strip()
    level = re.fullmatch(r".*\d\s*m", value) is not None
    pressure = with_unit(value, "m", "when") * WATER * GRAVITY if level else with_unit(value, "Pa", "when")
    return Control(found["node"].strip(), pressure, found["sign"] == ">", event, text)


def triggered(
    controls: Sequence[Control],
    events: Sequence[Event],
    build: Callable[[tuple[Event, ...], tuple[str, ...]], Scene],
    run: Callable[[Scene], Result],
) -> tuple[list[Event], list[Control], list[str]]:
    """Return all events, with those triggered by controls at their instants, controls that wait still, and notes.

    `build` makes a scene of events, with probes at some nodes. Nothing before an instant depends on later events: the
    run is made again with each event that was found, and the next is sought behind it. An instant is found to rounding
    on the curves of its run.
    """
    waiting, done, notes, since = list(controls), list(events), list[str](), 0.0
    nodes = _nodes(build((*events, *(control.event for control in controls)), ()))
    for control in controls:
        if control.node not in nodes:
            raise InputError("when", "no such node", nearest(control.node, sorted(nodes)), f"'{control.node}'")
    while waiting:
        result = run(build(tuple(done), tuple(control.node for control in waiting)))
        instants = [_instant(control, result.probes[control.node], since) for control in waiting]
        first = int(np.argmin(instants))
        if instants[first] == np.inf:
            break
        control, since = waiting.pop(first), instants[first]
        done.append(control.event._replace(at=since))
        notes.append(f"'{control.text}': after {since:.6g} s")
    return done, waiting, [*notes, *(f"'{control.text}': not before the end" for control in waiting)]


def _instant(control: Control, probe: ProbeResult, since: float) -> float:
    """Instant at which the pressure of a control is reached, not before `since`, s; infinite if never."""
    sign = 1.0 if control.above else -1.0

    def beyond(t: np.ndarray) -> np.ndarray:
        return sign * (probe.at(t).gauge_pressure - control.pressure)

    edges = np.unique(np.append(probe.t[probe.t >= since], since))
    t = np.unique(np.concatenate([np.linspace(a, b, BETWEEN) for a, b in pairwise(edges)]))
    over = beyond(t) > 0
    if not over.any():
        return np.inf
    k = int(np.argmax(over))
    low, high = (t[k - 1], t[k]) if k else (t[0], t[0])
    for _ in range(HALVINGS if k else 0):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if beyond(np.array([middle]))[0] > 0 else (middle, high)
    return float(high)


def acting(
    scene: Scene, controls: Iterable[WaterControl], taken: Collection[str], t_end: float
) -> tuple[list[Event], list[Control], list[str]]:
    """Operations at instants within a run, those that wait for a pressure, and notes.

    A link is operated once: by the first of its controls that changes its state. A pump is tripped or started, for a
    file says nothing of how its speed changes, and everything else is moved at once.
    """
    held, nodes, done = held_nodes(scene), _nodes(scene), {*taken}
    events, waiting, left = list[Event](), list[Control](), defaultdict[str, set[str]](set)
    notes = list[str]()
    for one in controls:
        if one.after is not None and one.after >= t_end:
            continue
        if why := "for their links are operated once" if one.link in done else _refused(scene, one, held, nodes):
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


def _nodes(scene: Scene) -> set[str]:
    """Nodes that pipes or links end at."""
    return {node for part in (scene.lines, scene.links) for one in part.values() for node in one.nodes}


def _refused(scene: Scene, one: WaterControl, held: Collection[str], nodes: Collection[str]) -> str:
    """Reason why a control cannot act; empty if it can."""
    if one.opens is None:
        return "for they do more than open or shut at an instant or a pressure"
    if one.link not in scene.lines and one.link not in scene.links:
        return "for their links are not in the scene"
    if one.after is None and one.node not in nodes:
        return "for what they wait at is not in the scene"
    if one.node in held:
        return "for they wait at tanks that hold their level"
    return ""


def _kind(scene: Scene, one: WaterControl) -> str:
    """Operation of a control on its link; empty if the link is in that state already."""
    if one.link in scene.lines:
        return "" if one.opens else "close"
    link = scene.links[one.link]
    if isinstance(link, Pump):
        runs = just_before(link.speed) > 0
        return "" if runs == one.opens else "start" if one.opens else "trip"
    opening = just_before(link.opening) if isinstance(link, Orifice) else None
    return "" if opening == float(bool(one.opens)) else "open" if one.opens else "close"
