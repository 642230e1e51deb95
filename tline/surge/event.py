"""What is operated in a network, and when: words such as "VALVE-179@1s+5s" or "J73:20 L/s@2s"."""

from typing import Any, NamedTuple

from tline.errors import InputError
from tline.scene.quantity import Quantity

OPERATIONS = {
    "trip": "PUMP@TIME",
    "close": "LINK@TIME+DURATION",
    "open": "LINK@TIME+DURATION",
    "burst": "NODE:FLOW@TIME+DURATION",
    "demand": "NODE:+FLOW@TIME+DURATION",
}
FLOWING = {"burst", "demand"}


class Event(NamedTuple):
    """One operation.

    Attributes
    ----------
    kind : str
        One of OPERATIONS.
    name : str
        Of a link, a pipe or a node.
    at, duration : float
        When it begins, and how long it takes; s.
    flow : float
        Of a burst, or the change of a demand, m³/s; else 0.
    """

    kind: str
    name: str
    at: float
    duration: float = 0.0
    flow: float = 0.0

    def control(self, before: float, after: float) -> dict[str, Any]:
        """The waveform that goes from one value to another meanwhile."""
        shape: dict[str, Any] = {"shape": "ramp", "duration": self.duration} if self.duration else {"shape": "step"}
        return shape | {"from": before, "to": after, "at": self.at}


def read_event(kind: str, text: str) -> Event:
    """The event that a text says.

    Parameters
    ----------
    kind : str
        One of OPERATIONS.
    text : str
        Name, flow with a unit if it takes one, and time with a duration, which is none if it is not given.

    Raises
    ------
    InputError
        It is no such text.

    Examples
    --------
    >>> read_event("close", "VALVE-179@1s+5s")
    Event(kind='close', name='VALVE-179', at=1.0, duration=5.0, flow=0.0)
    >>> read_event("burst", "J73:20 L/s@2s").flow
    0.02
    """
    where, expected = f"--{kind}", OPERATIONS[kind]
    target, at, when = text.rpartition("@")
    name, flow = target.strip(), 0.0
    if kind in FLOWING:
        name, colon, typed = (part.strip() for part in target.rpartition(":"))
        if at and colon and name:
            flow = Quantity(typed.removeprefix("+").strip(), "m^3/s", where)
    if not at or not name or (kind in FLOWING and not flow) or (kind == "burst" and flow < 0):
        raise InputError(where, "not an operation", f"{expected}, such as {_example(kind)}", f"'{text}'")
    begin, plus, takes = when.partition("+")
    event = Event(
        kind, name, Quantity(begin.strip(), "s", where), Quantity(takes.strip(), "s", where) if plus else 0.0, flow
    )
    if event.at < 0 or event.duration < 0:
        raise InputError(where, "out of range", "times of zero and more", f"'{text}'")
    if kind == "trip" and event.duration:
        raise InputError(where, "a trip takes no time of its own", expected, f"'{text}'")
    return event


def _example(kind: str) -> str:
    return {"trip": "P1@1s", "burst": "J73:20L/s@2s", "demand": "J9:+5L/s@0s"}.get(kind, "V1@1s+5s")
