"""A scene in which lines with cavities are what they stand for: stretches between nodes that have the cavities."""

from typing import Any

from tline.errors import InputError
from tline.scene.cavities import places_of, stretches_of, with_cavities
from tline.scene.line import SceneLine
from tline.scene.probe import Probe
from tline.scene.scene import Scene
from tline.wording import place

AT_A_PLACE = 1e-9  # of a stretch


def expanded(scene: Scene) -> Scene:
    """The same scene with stretches, nodes and loads in place of lines with cavities; itself if there are none.

    Raises
    ------
    InputError
        A probe stands inside a stretch with losses.

    Examples
    --------
    >>> pipe = {"nodes": ["tank", "valve"], "z0": "20 MPa s/m^3", "delay": "0.3 s", "cavities": {"places": 2}}
    >>> probe = {"line": "pipe", "position": "50 %"}
    >>> scene = Scene(medium="hydraulic", t_end=1, lines={"pipe": pipe}, probes={"p": probe})
    >>> whole = expanded(scene)
    >>> list(whole.lines), list(whole.loads)
    (['pipe, stretch 1', 'pipe, stretch 2', 'pipe, stretch 3'], ['pipe, place 1', 'pipe, place 2'])
    >>> whole.probes["p"].line, whole.lines["pipe, stretch 2"].shortest
    ('pipe, stretch 2', 0.09999999999999999)
    """
    cut = with_cavities(scene.lines)
    if not cut:
        return scene
    table = scene.table()
    lines: dict[str, Any] = {}
    loads, nodes = dict(table.get("loads", {})), dict(table.get("nodes", {}))
    for name, given in table["lines"].items():
        if name not in cut:
            lines[name] = given
            continue
        lines |= _stretches(name, cut[name], given)
        loads |= _cavities(name, cut[name])
        nodes |= _heights(name, cut[name], scene)
    probes = {name: _seen(name, probe, cut) or table["probes"][name] for name, probe in scene.probes.items()}
    return scene.with_changes(lines=lines, loads=loads, probes=probes, nodes=nodes)


def _stretches(name: str, line: SceneLine, given: dict[str, Any]) -> dict[str, Any]:
    """Tables of the stretches of a line: as the whole, but for what grows with its length."""
    nodes = [line.nodes[0], *places_of(name, line), line.nodes[1]]
    alike = {key: value for key, value in given.items() if key not in ("cavities", "vertices")}
    alike |= {key: float(getattr(line, key)) / line.stretches for key in ("length", "delay") if key in given}
    pairs = zip(stretches_of(name, line), nodes, nodes[1:], strict=False)
    return {stretch: alike | {"nodes": [near, far]} for stretch, near, far in pairs}


def _cavities(name: str, line: Any) -> dict[str, Any]:
    """Tables of the cavities of a line."""
    return {node: line.cavities.load(node) for node in places_of(name, line)}


def _heights(name: str, line: SceneLine, scene: Scene) -> dict[str, Any]:
    """Tables of its places, where heights are known: those of both ends, or of none."""
    ends = [scene.nodes[node].elevation for node in line.nodes if node in scene.nodes]
    known = [float(height) for height in ends if height is not None]
    if not known:
        return {}
    return {node: {"elevation": z} for node, z in zip(places_of(name, line), _between(line, known), strict=True)}


def _between(line: SceneLine, ends: list[float]) -> list[float]:
    """Values at its places, on the straight line between those of its ends."""
    return [ends[0] + (ends[-1] - ends[0]) * (k + 1) / line.stretches for k in range(line.stretches - 1)]


def _seen(name: str, probe: Probe, cut: dict[str, SceneLine]) -> dict[str, Any] | None:
    """Table of a probe on a line that is cut; at a place it is on the stretch that ends there."""
    line = cut.get(probe.line or "")
    if line is None or probe.line is None:
        return None
    stretches, here = stretches_of(probe.line, line), probe.fraction(line) * line.stretches
    if probe.at is not None:
        return {"at": probe.at, "line": stretches[-1 if here else 0]}
    k = max(min(int(here - AT_A_PLACE), line.stretches - 1), 0)
    share = min(max(here - k, 0.0), 1.0)
    share = round(share) if abs(share - round(share)) < AT_A_PLACE else share
    if line.losses is not None and 0 < share < 1:
        problem = f"inside {place('lines', probe.line)}, which has losses"
        expected = f"its ends, or a place of its cavities such as '{100 / line.stretches:.6g} %'"
        raise InputError(place("probes", name, "position"), problem, expected)
    return {"line": stretches[k], "position": f"{100 * share!r} %"}
