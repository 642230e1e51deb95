"""Lines divided into stretches for a run: their shares, their losses, and the scene with stretches in their place."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

from tline.scene.cavities import with_cavities
from tline.scene.coupled import Coupled

if TYPE_CHECKING:
    from tline.scene.measure import Probe
    from tline.scene.scene import Scene


AT_A_PLACE = Fraction(1, 10**9)  # of a line; tolerance for the position of a node


class Stretches(NamedTuple):
    """Line in stretches."""

    shares: tuple[Fraction, ...]  # where they begin and end, as shares of the line's delay, from 0 to 1
    places: tuple[str, ...]  # nodes between them, from end 1 on
    lines: tuple[str, ...]  # their names, from end 1 on
    cavities: tuple[str, ...] = ()  # those of the nodes that have cavities

    @property
    def widths(self) -> list[float]:
        """Delays of the stretches over that of the line."""
        return [float(far - near) for near, far in pairwise(self.shares)]

    def stretch_at(self, share: float) -> tuple[int, float]:
        """Stretch in which a place lies, and the share of its delay there; at a node the stretch that ends there."""
        k = next((k for k, far in enumerate(self.shares[1:]) if share <= far + AT_A_PLACE), len(self.lines) - 1)
        near, far = self.shares[k : k + 2]
        inside = share - AT_A_PLACE > near and share + AT_A_PLACE < far
        return k, float((Fraction(share) - near) / (far - near)) if inside else float(share > near + AT_A_PLACE)


def stretches_of(scene: Scene) -> dict[str, Stretches]:
    """Lines with cavities, or with losses and a probe inside, in stretches."""
    cavities = {
        name: {Fraction(k, line.stretches): f"{name}, place {k}" for k in range(1, line.stretches)}
        for name, line in with_cavities(scene.lines).items()
    }
    places = {name: dict(nodes) for name, nodes in cavities.items()}
    for name, probe in scene.probes.items():
        line = scene.lines.get(probe.line or "")
        if probe.line is None or probe.at is not None or line is None or line.losses is None:
            continue
        share, known = Fraction(probe.fraction(line)), places.setdefault(probe.line, {})
        if all(abs(share - other) > AT_A_PLACE for other in (0, 1, *known)):
            known[share] = f"{probe.line}, probe {name}"
    found: dict[str, Stretches] = {}
    for name, nodes in places.items():
        if nodes:
            ordered = tuple(nodes[x] for x in sorted(nodes))
            lines, boiling = _lines(name, len(nodes)), tuple(cavities.get(name, {}).values())
            found[name] = Stretches(_shares(nodes), ordered, lines, boiling)
    return found


def _shares(inner: Iterable[Fraction]) -> tuple[Fraction, ...]:
    return Fraction(0), *sorted(inner), Fraction(1)


def _lines(name: str, places: int) -> tuple[str, ...]:
    return tuple(f"{name}, stretch {k + 1}" for k in range(places + 1))


def expanded(scene: Scene) -> Scene:
    """Return the scene with stretches and nodes in place of the lines that are divided."""
    cut = stretches_of(scene)
    if not cut:
        return scene
    table = scene.table()
    lines: dict[str, Any] = {}
    loads, links, nodes = (dict(table.get(part, {})) for part in ("loads", "links", "nodes"))
    for name, given in table["lines"].items():
        if name not in cut:
            lines[name] = given
            continue
        line: Any = scene.lines[name]
        lines |= _tables_of(scene, name, cut[name], given)
        loads |= {node: line.cavities.load(node) for node in cut[name].cavities}
        nodes |= _heights(scene, name, cut[name])
    probes = {name: _seen(scene, probe, cut) or table["probes"][name] for name, probe in scene.probes.items()}
    return scene.with_changes(lines=lines, loads=loads, links=links, probes=probes, nodes=nodes)


def _tables_of(scene: Scene, name: str, stretches: Stretches, given: dict[str, Any]) -> dict[str, Any]:
    """Tables of the stretches of a line: as the whole, but for quantities proportional to its length."""
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
    """Tables of the nodes between stretches, where heights are known: interpolated linearly between the ends."""
    if not scene.heights.keys() >= {*scene.lines[name].nodes}:
        return {}
    near, far = (scene.heights[node].elevation for node in scene.lines[name].nodes)
    shares = map(float, stretches.shares[1:-1])
    elevations = [near + share * (far - near) for share in shares]
    return {node: {"elevation": z} for node, z in zip(stretches.places, elevations, strict=True)}


def _seen(scene: Scene, probe: Probe, cut: dict[str, Stretches]) -> dict[str, Any] | None:
    """Table of a probe on a divided line; at a place the probe is on the stretch that ends there."""
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
