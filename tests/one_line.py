"""Scenes of one line: from a source behind a resistance to a load, or from a tank to what is at the end of a pipe."""

from collections.abc import Mapping
from typing import Any

from tline import Scene

FAR = {"far": {"at": "far"}}


def one_line(
    t_end: Any, line: Mapping, value: Any, behind: Any, load: Any = None, far: str = "far", **more: Any
) -> Scene:
    """The line is `line`, the source `s`, the load `load`, a table or a resistance; probes stand at both ends."""
    if load is not None and not isinstance(load, Mapping):
        load = {"kind": "resistor", "resistance": load}
    source = {"at": "near", "kind": "pressure" if more.get("medium") == "hydraulic" else "voltage", "value": value}
    given = {
        "medium": "electrical",
        "t_end": t_end,
        "lines": {"line": {"nodes": ["near", far], **line}},
        "sources": {"s": source if behind is None else source | {"resistance": behind}},
        "loads": {} if load is None else {"load": {"at": far, **load}},
        "probes": {"near": {"at": "near"}, far: {"at": far}},
    }
    return Scene(**given | more)


def from_tank(t_end: Any, pipe: Mapping, pressure: Any, loads: Mapping, **more: Any) -> Scene:
    """A pipe from the reservoir `tank` to the node `end`, where the probe stands, from the steady state."""
    given = {
        "medium": "hydraulic",
        "t_end": t_end,
        "start": "steady",
        "lines": {"pipe": {"nodes": ["tank", "end"], **pipe}},
        "loads": {"tank": {"at": "tank", "kind": "reservoir", "pressure": pressure}, **loads},
        "probes": {"end": {"at": "end"}},
    }
    return Scene(**given | more)
