"""Lines divided into stretches for a run: their shares, their losses, and the scene with stretches in their place."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from itertools import pairwise
from math import ceil
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.coupled import Coupled
from tline.scene.vessel import with_cavities
from tline.words.wording import place

if TYPE_CHECKING:
    from tline.scene.line import SceneLine
    from tline.scene.measure import Probe
    from tline.scene.scene import Scene


FINENESS, FEWEST, MOST_PLACES = 40, 8, 64  # places: per loss over impedance, and bounds, where no more are asked
AT_A_PLACE = Fraction(1, 10**9)  # of a line; tolerance for the position of a node


class Mixing(NamedTuple):
    """Places with losses between the stretches of coupled conductors."""

    name: str  # of the line
    line: Coupled
    places: int  # number of them; the first and the last stretch are half as long as those between

    @classmethod
    def of(cls, name: str, line: Coupled, doublings: int) -> Mixing:
        """Choose the number of places so that the loss at each is small."""
        R, G = _lost(line)
        z0 = np.linalg.inv(line.modes.admittance)
        lost = max(np.linalg.norm(R @ line.modes.admittance, 2), np.linalg.norm(G @ z0, 2))
        return cls(name, line, min(max(ceil(FINENESS * lost), FEWEST), MOST_PLACES) * 2**doublings)

    @property
    def nodes(self) -> tuple[str, ...]:
        """Nodes at all places."""
        return tuple(node for k in range(1, self.places + 1) for end in (1, 2) for node in self._at(k, end))

    def lines(self) -> dict[str, dict[str, Any]]:
        """Tables of the stretches."""
        table = self.line.table()
        alike = {key: table[key] for key in ("inductance", "capacitance")}
        near = [self.line.nodes1, *(self._at(k, 2) for k in range(1, self.places + 1))]
        far = [*(self._at(k, 1) for k in range(1, self.places + 1)), self.line.nodes2]
        lengths = [
            float(self.line.length or 0.0) / self.places / (2 if k in (0, self.places) else 1) for k in range(len(near))
        ]
        return {
            f"{self.name}, stretch {k + 1}": alike | {"length": length, "nodes1": list(one), "nodes2": list(other)}
            for k, (one, other, length) in enumerate(zip(near, far, lengths, strict=True))
        }

    def links(self) -> dict[str, dict[str, Any]]:
        """Tables of the losses at the places: half of R, all of G, half of R."""
        if self.line.skin:
            where, expected = (
                f"{place('lines', self.name)}.skin",
                "a run from rest to a tolerance of 1e-8 or more, without a ledger",
            )
            raise InputError(where, "it makes modes see each other, which other runs do not know", expected)
        R, G = (lost / self.places for lost in _lost(self.line))
        one, none = np.eye(len(R)), np.zeros_like(R)
        # u1 - R i1/2 = u2 - R i2/2 = v, i1 + i2 = G v
        M = np.block([[one, -one], [G, none]])
        N = np.block([[-R / 2, R / 2], [-one - G @ R / 2, -one]])
        z0 = float(np.median(self.line.modes.z0))
        scattering = np.linalg.solve(N / z0 - M, N / z0 + M)
        table = {"kind": "junction", "z0": z0, "scattering": scattering.tolist()}
        return {
            f"{self.name}, place {k}": table | {"nodes": [*self._at(k, 1), *self._at(k, 2)]}
            for k in range(1, self.places + 1)
        }

    def _at(self, k: int, end: int) -> tuple[str, ...]:
        return tuple(f"{self.name}, place {k}, conductor {j + 1}, end {end}" for j in range(len(self.line.nodes1)))


def mixing_lines(lines: Mapping[str, SceneLine | Coupled]) -> dict[str, Coupled]:
    """Lines whose losses mix the modes."""
    return {name: line for name, line in lines.items() if isinstance(line, Coupled) and line.mixing}


def _lost(line: Coupled) -> tuple[NDArray, NDArray]:
    """Total R and G of the line, in ohm and S."""
    k, length = len(line.nodes1), float(line.length or 0.0)
    R, G = (length * np.array(given or np.zeros((k, k)), float) for given in (line.resistance, line.conductance))
    return R, G


class Stretches(NamedTuple):
    """Line in stretches."""

    shares: tuple[Fraction, ...]  # where they begin and end, as shares of the line's delay, from 0 to 1
    places: tuple[str, ...]  # nodes between them, from end 1 on
    lines: tuple[str, ...]  # their names, from end 1 on
    cavities: tuple[str, ...] = ()  # those of the nodes that have cavities
    mixing: Mixing | None = None  # of coupled conductors: their losses at the places

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


def stretches_of(scene: Scene, doublings: int = 0) -> dict[str, Stretches]:
    """Lines with cavities, with losses and a probe inside, or with losses that mix modes, in stretches.

    Those of the last kind have twice as many of them with each doubling.
    """
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
    for name, line in mixing_lines(scene.lines).items():
        mixing = Mixing.of(name, line, doublings)
        n = mixing.places
        shares = _shares(Fraction(2 * k + 1, 2 * n) for k in range(n))
        found[name] = Stretches(shares, mixing.nodes, _lines(name, n), mixing=mixing)
    return found


def _shares(inner: Iterable[Fraction]) -> tuple[Fraction, ...]:
    return Fraction(0), *sorted(inner), Fraction(1)


def _lines(name: str, places: int) -> tuple[str, ...]:
    return tuple(f"{name}, stretch {k + 1}" for k in range(places + 1))


def expanded(scene: Scene, doublings: int = 0) -> Scene:
    """Return the scene with stretches and nodes in place of the lines that are divided.

    Conductors whose losses mix the modes have twice as many with each doubling.
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
