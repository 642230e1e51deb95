"""Lines that a run parts in stretches: at cavities, at probes inside lines with losses, and where losses mix modes."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

from tline.scene.cavities import with_cavities
from tline.scene.mixing import Mixing, mixing_lines

if TYPE_CHECKING:
    from tline.scene.scene import Scene

AT_A_PLACE = Fraction(1, 10**9)  # of a line


class Stretches(NamedTuple):
    """A line in stretches."""

    shares: tuple[Fraction, ...]  # where they begin and end, as shares of the line's delay, from 0 to 1
    places: tuple[str, ...]  # nodes between them, from end 1 on
    lines: tuple[str, ...]  # their names, from end 1 on
    cavities: tuple[str, ...] = ()  # those of the nodes that have cavities
    mixing: Mixing | None = None  # of coupled conductors: their losses at the places

    @property
    def widths(self) -> list[float]:
        """Their delays over that of the line."""
        return [float(far - near) for near, far in pairwise(self.shares)]

    def stretch_at(self, share: float) -> tuple[int, float]:
        """The stretch in which a place lies, and the share of its delay there; at a node that which ends there."""
        k = next((k for k, far in enumerate(self.shares[1:]) if share <= far + AT_A_PLACE), len(self.lines) - 1)
        near, far = self.shares[k : k + 2]
        inside = share - AT_A_PLACE > near and share + AT_A_PLACE < far
        return k, float((Fraction(share) - near) / (far - near)) if inside else float(share > near + AT_A_PLACE)


def stretches_of(scene: Scene, doublings: int = 0) -> dict[str, Stretches]:
    """Lines with cavities, with losses and a probe inside, or with losses that mix modes, in stretches.

    Those of the last kind have twice as many of them with each doubling.

    Examples
    --------
    >>> from tline.scene.scene import Scene
    >>> cable = {"nodes": ["a", "b"], "z0": 50, "delay": "5 ns", "length": 1, "resistance": 2}
    >>> probes = {"near": {"at": "a"}, "inner": {"line": "cable", "position": "25 %"}}
    >>> scene = Scene(medium="electrical", t_end="20 ns", lines={"cable": cable}, probes=probes)
    >>> found = stretches_of(scene)["cable"]
    >>> found.lines, found.places, found.widths
    (('cable, stretch 1', 'cable, stretch 2'), ('cable, probe inner',), [0.25, 0.75])
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
