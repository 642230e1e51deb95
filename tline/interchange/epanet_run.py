"""EPANET's own answer at an instant: a program of its own, which reads and writes in the current folder alone.

It is started by its path, and needs nothing but Python and EPANET's library, whose path is its argument. It reads
``network.inp`` and writes ``answer.json``.

References
----------
EPANET 2.2 Programmer's Toolkit, with the codes used below.
"""

import ctypes
import json
import os
import re
import sys
from pathlib import Path

NETWORK, ANSWER, REPORT = "network.inp", "answer.json", "report.txt"
NODES, LINKS = 0, 2  # counts
NODE_VALUES = {"elevation": 0, "emitter": 3, "demand": 9, "head": 10, "pressure": 11}
LINK_VALUES = {"diameter": 0, "length": 1, "roughness": 2, "minor": 3, "flow": 8, "status": 11, "setting": 12}
OPTIONS = {"exponent": 3, "law": 7, "gravity": 12, "viscosity": 13}
PUMP, PUMP_STATE, PUMP_POWER, PUMP_CURVE = 2, 16, 18, 19
TANK, TANK_VALUES = 2, {"diameter": 17, "curve": 19, "lowest": 20, "highest": 21}
DURATION, STEP, CLOCK = 0, 1, 10  # of times
CONTROLS, RULES = 5, 6  # counts
TIMER, CLOCK_TIME = 2, 3  # kinds of controls; before them those of levels, below and above
NODE, SYSTEM = 6, 8  # subjects of a premise
VARIABLES = {1: "head", 2: "head", 3: "level", 4: "pressure"}
TIME, DAYTIME = 9, 10
EQUAL, ABOVE, BELOW = 0, (3, 5, 9), (2, 4, 8)
STATES = {1: "OPEN", 2: "CLOSED"}
DAY = 86400
TRIALS, RELATIVE, ABSOLUTE = 0, 1, 6  # options: how often, and to which change of flows in the last step
ATTEMPTS = (  # the last with the defaults of EPANET
    {TRIALS: 100, RELATIVE: 1e-5, ABSOLUTE: 1e-6},  # of the file's unit of flow
    {TRIALS: 1000, ABSOLUTE: 0},
    {RELATIVE: 1e-3},
)
INITIAL_FLOWS = 10
UNBALANCED, UNSTABLE, WARNINGS = 1, 2, 6
NAME = 256  # bytes


class Toolkit:
    """A project of EPANET's."""

    def __init__(self, library: str):
        self._library = ctypes.CDLL(library)
        self._project = ctypes.c_void_p()
        self._library.EN_createproject(ctypes.byref(self._project))

    def call(self, name: str, *given: object) -> int:
        """Call a function that answers with a code alone."""
        return getattr(self._library, f"EN_{name}")(self._project, *given)

    def number(self, name: str, *given: int) -> float:
        """The number that a function gives."""
        found = ctypes.c_double()
        self.call(name, *given, ctypes.byref(found))
        return found.value

    def count(self, name: str, *given: int) -> int:
        """The integer that a function gives."""
        found = ctypes.c_int()
        self.call(name, *given, ctypes.byref(found))
        return found.value

    def pair(self, kind: type, name: str, *given: int) -> list:
        """The two numbers that a function gives."""
        one, two = kind(), kind()
        self.call(name, *given, ctypes.byref(one), ctypes.byref(two))
        return [one.value, two.value]

    def name(self, function: str, index: int) -> str:
        """Name of a node or link."""
        found = ctypes.create_string_buffer(NAME)
        self.call(function, index, found)
        return found.value.decode("utf-8", "replace")


def main(library: str, seconds: int) -> dict:
    """All data of the network at an instant, in the units of the file; or the mistake that EPANET found."""
    toolkit = Toolkit(library)
    code = toolkit.call("open", NETWORK.encode(), REPORT.encode(), b"")
    if code > WARNINGS:
        toolkit.call("close")
        return {"mistake": _reported() or f"error {code}"}
    toolkit.call("settimeparam", DURATION, ctypes.c_long(seconds))
    code = toolkit.call("openH")
    if code > WARNINGS:
        return {"unsolved": f"error {code}"}
    for options in ATTEMPTS:
        for option, value in options.items():
            toolkit.call("setoption", option, ctypes.c_double(value))
        toolkit.call("initH", INITIAL_FLOWS)
        code = _run_until(toolkit, seconds)
        if code not in (UNBALANCED, UNSTABLE):
            break
    if code == UNBALANCED or code > WARNINGS:
        return {"unsolved": "trials without end" if code == UNBALANCED else f"error {code}"}
    return _found(toolkit, seconds) | {"warning": code}


def _run_until(toolkit: Toolkit, seconds: int) -> int:
    """Solve from the start to that instant, as patterns and controls have it; the code of the last solution."""
    now, step, longest = ctypes.c_long(), ctypes.c_long(), ctypes.c_long()
    toolkit.call("gettimeparam", STEP, ctypes.byref(longest))
    while True:
        code = toolkit.call("runH", ctypes.byref(now))
        if code > WARNINGS or now.value >= seconds:
            return code
        toolkit.call("settimeparam", STEP, ctypes.c_long(min(longest.value, seconds - now.value)))
        code = toolkit.call("nextH", ctypes.byref(step))
        if code > WARNINGS or step.value <= 0:
            return code


def _found(toolkit: Toolkit, seconds: int) -> dict:
    nodes, links = [], []
    for k in range(1, toolkit.count("getcount", NODES) + 1):
        values = {key: toolkit.number("getnodevalue", k, code) for key, code in NODE_VALUES.items()}
        values |= {key: typed(values[key]) for key in ("elevation", "emitter")}
        kind = toolkit.count("getnodetype", k)
        if kind == TANK:
            values |= {key: typed(toolkit.number("getnodevalue", k, code)) for key, code in TANK_VALUES.items()}
        nodes.append({"name": toolkit.name("getnodeid", k), "type": kind} | values)
    for k in range(1, toolkit.count("getcount", LINKS) + 1):
        values = {key: toolkit.number("getlinkvalue", k, code) for key, code in LINK_VALUES.items()}
        values |= {key: typed(values[key]) for key in ("diameter", "length", "roughness", "minor", "setting")}
        kind, ends = toolkit.count("getlinktype", k), toolkit.pair(ctypes.c_int, "getlinknodes", k)
        values |= {"ends": [nodes[end - 1]["name"] for end in ends], "type": kind}
        if kind == PUMP:
            more = {"power": PUMP_POWER, "state": PUMP_STATE}
            values |= {key: toolkit.number("getlinkvalue", k, code) for key, code in more.items()}
            values |= {"curve": _curve(toolkit, k)}
        links.append({"name": toolkit.name("getlinkid", k)} | values)
    options = {key: toolkit.number("getoption", code) for key, code in OPTIONS.items()}
    names = [node["name"] for node in nodes], [link["name"] for link in links]
    acting = {"controls": _controls(toolkit, *names, seconds), "rules": _rules(toolkit, *names, seconds)}
    return {"nodes": nodes, "links": links, "units": toolkit.count("getflowunits")} | options | acting


def _controls(toolkit: Toolkit, nodes: list, links: list, seconds: int) -> list:
    """Link of each control in the order of the file, and when it acts after that instant."""
    found = []
    for k in range(1, toolkit.count("getcount", CONTROLS) + 1):
        kind, link, node = ctypes.c_int(), ctypes.c_int(), ctypes.c_int()
        setting, level = ctypes.c_double(), ctypes.c_double()
        toolkit.call("getcontrol", k, *map(ctypes.byref, (kind, link, setting, node, level)))
        if kind.value in (TIMER, CLOCK_TIME):
            when = {"after": _wait(toolkit, level.value, kind.value == CLOCK_TIME, seconds)}
        else:
            when = {"node": nodes[node.value - 1], "above": kind.value == 1, "value": typed(level.value)}
        found.append({"link": links[link.value - 1] if link.value else None, "what": ""} | when)
    return found


def _wait(toolkit: Toolkit, instant: float, daily: bool, seconds: int) -> float:
    """Time from that instant to another one since the start, or to one of the day, s; negative once it is past."""
    if not daily:
        return instant - seconds
    start = ctypes.c_long()
    toolkit.call("gettimeparam", CLOCK, ctypes.byref(start))
    return (instant - start.value - seconds) % DAY or DAY


def _rules(toolkit: Toolkit, nodes: list, links: list, seconds: int) -> list:
    """Name of each rule; with its actions if its one premise is a pressure or a time, and it has no alternative."""
    found = []
    for k in range(1, toolkit.count("getcount", RULES) + 1):
        premises, actions, others, priority = ctypes.c_int(), ctypes.c_int(), ctypes.c_int(), ctypes.c_double()
        toolkit.call("getrule", k, *map(ctypes.byref, (premises, actions, others, priority)))
        when = _premise(toolkit, k, nodes, seconds) if premises.value == 1 and not others.value else None
        each = [_action(toolkit, k, n, links) for n in range(1, actions.value + 1)] if when else []
        found.append({"name": toolkit.name("getruleID", k), "when": when, "actions": each})
    return found


def _premise(toolkit: Toolkit, rule: int, nodes: list, seconds: int) -> dict | None:
    _, thing, index, variable, relation, _ = codes = [ctypes.c_int() for _ in range(6)]
    value = ctypes.c_double()
    toolkit.call("getpremise", rule, 1, *map(ctypes.byref, codes), ctypes.byref(value))
    above = relation.value in ABOVE
    if thing.value == SYSTEM and variable.value in (TIME, DAYTIME) and (above or relation.value == EQUAL):
        return {"after": _wait(toolkit, value.value, variable.value == DAYTIME, seconds)}
    if thing.value == NODE and variable.value in VARIABLES and (above or relation.value in BELOW):
        what = VARIABLES[variable.value]
        return {"node": nodes[index.value - 1], "above": above, "value": typed(value.value), "what": what}
    return None


def _action(toolkit: Toolkit, rule: int, action: int, links: list) -> list:
    link, status, setting = ctypes.c_int(), ctypes.c_int(), ctypes.c_double()
    toolkit.call("getthenaction", rule, action, *map(ctypes.byref, (link, status, setting)))
    return [links[link.value - 1], STATES.get(status.value, "")]


def typed(value: float) -> float:
    """A number as it stood in the file, before EPANET turned it into feet and back."""
    return float(f"{value:.13g}")


def _curve(toolkit: Toolkit, pump: int) -> list:
    curve = int(toolkit.number("getlinkvalue", pump, PUMP_CURVE))
    points = range(1, toolkit.count("getcurvelen", curve) + 1) if curve else ()
    return [[*map(typed, toolkit.pair(ctypes.c_double, "getcurvevalue", curve, point))] for point in points]


def _reported() -> str:
    """The first mistake in EPANET's report, with the line of the file."""
    lines = Path(REPORT).read_text(encoding="utf-8", errors="replace").splitlines()
    first = next((k for k, line in enumerate(lines) if line.strip().startswith("Error ")), None)
    if first is None:
        return ""
    message, after = lines[first].strip(), lines[first + 1].strip() if first + 1 < len(lines) else ""
    whole = f"{message} {after}" if message.endswith(":") else message
    return re.sub(r"^(Error \d+:)\s+\1\s*", r"\1 ", whole)  # EPANET names some of its errors twice


def limit(seconds: float, memory: int, written: int) -> None:
    """Limit the resources of this process, where the system can."""
    try:
        import resource
    except ImportError:
        return
    for kind, most in (
        (resource.RLIMIT_CPU, int(seconds) + 1),
        (resource.RLIMIT_AS, memory),
        (resource.RLIMIT_FSIZE, written),
        (resource.RLIMIT_CORE, 0),
    ):
        hard = resource.getrlimit(kind)[1]
        try:
            resource.setrlimit(kind, (most if hard < 0 else min(most, hard), hard))
        except (ValueError, OSError):
            continue


if __name__ == "__main__":
    limit(float(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4]))
    Path(ANSWER).write_text(json.dumps(main(sys.argv[1], int(sys.argv[5]))), encoding="utf-8")
    os._exit(0)  # in spite of anything that the library left behind
