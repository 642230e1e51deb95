"""A scene in which lines that a run parts are what they stand for: stretches, and what stands between them."""

from typing import Any

from tline.scene.coupled import Coupled
from tline.scene.measure import Probe
from tline.scene.scene import Scene
from tline.scene.stretches import Stretches, stretches_of


def expanded(scene: Scene, doublings: int = 0) -> Scene:
    """The same scene with stretches and nodes in place of the lines that are parted.

    Conductors whose losses mix the modes have twice as many with each doubling.

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
    cut = stretches_of(scene, doublings)
    if not cut:
        return scene
    table = scene.table()
    lines: dict[str, Any] = {}
    loads, links, nodes = (dict(table.get(part, {})) for part in ("loads", "links", "nodes"))
    for name, given in table["lines"].items():
        if name not in cut:
            lines[name] = given
            continue
        if mixing := cut[name].mixing:
            lines |= mixing.lines()
            links |= mixing.links()
            continue
        line: Any = scene.lines[name]
        lines |= _lines(scene, name, cut[name], given)
        loads |= {node: line.cavities.load(node) for node in cut[name].cavities}
        nodes |= _heights(scene, name, cut[name])
    probes = {name: _seen(scene, probe, cut) or table["probes"][name] for name, probe in scene.probes.items()}
    return scene.with_changes(lines=lines, loads=loads, links=links, probes=probes, nodes=nodes)


def _lines(scene: Scene, name: str, stretches: Stretches, given: dict[str, Any]) -> dict[str, Any]:
    """Tables of the stretches of a line: as the whole, but for what grows with its length."""
    line: Any = scene.lines[name]
    nodes = [line.nodes[0], *stretches.places, line.nodes[1]]
    alike = {key: value for key, value in given.items() if key not in ("cavities", "vertices")}
    friction = alike.get("friction") or {}
    whole = {key: float(getattr(line, key)) for key in ("length", "delay") if key in given}
    whole_friction = {key: float(getattr(line.friction, key)) for key in ("length", "minor_loss") if key in friction}
    found = {}
    for k, (stretch, width) in enumerate(zip(stretches.lines, stretches.widths, strict=True)):
        found[stretch] = alike | {key: value * width for key, value in whole.items()} | {"nodes": nodes[k : k + 2]}
        if whole_friction:
            found[stretch]["friction"] = friction | {key: value * width for key, value in whole_friction.items()}
    return found


def _heights(scene: Scene, name: str, stretches: Stretches) -> dict[str, Any]:
    """Tables of its places, where heights are known: on the straight line between those of its ends."""
    if not scene.heights.keys() >= {*scene.lines[name].nodes}:
        return {}
    near, far = (scene.heights[node].elevation for node in scene.lines[name].nodes)
    shares = map(float, stretches.shares[1:-1])
    elevations = [near + share * (far - near) for share in shares]
    return {node: {"elevation": z} for node, z in zip(stretches.places, elevations, strict=True)}


def _seen(scene: Scene, probe: Probe, cut: dict[str, Stretches]) -> dict[str, Any] | None:
    """Table of a probe on a line that is cut; at a place it is on the stretch that ends there."""
    if probe.line is None or probe.line not in cut:
        return None
    stretches, line = cut[probe.line], scene.lines[probe.line]
    if isinstance(line, Coupled):
        return probe.table() | {"line": stretches.lines[0 if probe.at in line.nodes1 else -1]}
    share = probe.fraction(line)
    if probe.at is not None:
        return {"at": probe.at, "line": stretches.lines[-1 if share else 0]}
    k, part = stretches.stretch_at(share)
    return {"line": stretches.lines[k], "position": f"{100 * part!r} %"}
