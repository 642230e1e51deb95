"""Crosstalk of coupled conductors: signals from a driven one into the others, and modes of pairs."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tline.atomic import write_columns
from tline.errors import InputError
from tline.presentation import Presentation, plain
from tline.scene.coupled import Coupled
from tline.scene.file import as_scene
from tline.scene.scene import Scene
from tline.solver.result.dense_output import curve
from tline.solver.simulate import simulate
from tline.words.wording import nearest, place, shown


@dataclass(frozen=True, eq=False, repr=False)
class Crosstalk(Presentation):
    """Voltages at both ends of coupled conductors."""

    line: str  # line, driven: the conductors' line, and the node at which one of them is driven
    driven: str
    t: NDArray  # (n,) instants, s
    voltages: dict[str, NDArray]  # of each node of the conductors, V
    swing: float  # largest less smallest voltage of the driven end, from rest on: a jump at t = 0 is part of it
    # near, far: largest voltage of each quiet conductor at the driven side and at the other one, over the swing
    near: dict[str, float]
    far: dict[str, float]
    pairs: tuple[tuple[str, str], ...]  # any two nodes at one end
    title: str = ""  # of the scene
    picture = "tline.pictures.signals:plot_crosstalk"

    def text_lines(self) -> Iterator[str]:
        """Swing, voltages of the quiet conductors, and modes of pairs."""
        yield f"'{self.driven}' of '{self.line}' swings by {self.swing:.6g} V"
        for word, shares in (("near end", self.near), ("far end", self.far)):
            for node, share in shares.items():
                yield f"{word} '{node}' {share * self.swing:.6g} V, {100 * share:.4g} %"
        for pair, each in self._modes().items():
            yield f"{pair}: differential up to {each['differential']:.6g} V, common up to {each['common']:.6g} V"

    def to_dict(self) -> dict[str, Any]:
        """Crosstalk in SI units."""
        told = {name: getattr(self, name) for name in ("line", "driven", "swing", "near", "far")}
        return plain(told | {"modes": self._modes()})

    def _modes(self) -> dict[str, dict[str, float]]:
        return {
            ", ".join(pair): {"differential": float(abs(u).max()), "common": float(abs(self.common[pair]).max())}
            for pair, u in self.differential.items()
        }

    def save(self, path: str | Path) -> None:
        """Write time in s, voltages of all nodes, differences and means of pairs as CSV."""
        columns = {"time [s]": self.t} | {f"{node} [V]": u for node, u in self.voltages.items()}
        columns |= {f"{a} - {b} [V]": u for (a, b), u in self.differential.items()}
        columns |= {f"mean of {a} and {b} [V]": u for (a, b), u in self.common.items()}
        write_columns(path, columns)

    @property
    def differential(self) -> dict[tuple[str, str], NDArray]:
        """Voltage of the first less that of the second node, of each two at one end."""
        return {(a, b): self.voltages[a] - self.voltages[b] for a, b in self.pairs}

    @property
    def common(self) -> dict[tuple[str, str], NDArray]:
        """Mean voltage of both nodes, of each two at one end."""
        return {(a, b): (self.voltages[a] + self.voltages[b]) / 2 for a, b in self.pairs}


def crosstalk(
    scene: Scene | str | Path, line: str | None = None, *, tol: float | None = None, progress: bool = False
) -> Crosstalk:
    """Run a scene and compare the voltages of coupled conductors at both ends.

    Parameters
    ----------
    scene : Scene, or the path of a file
    line : str, optional
        Name of the coupled conductors; not needed if there are no others.
    tol : float, optional
        Largest error, relative to the amplitude, instead of the scene's.
    progress : bool
        Show a progress bar on stderr if the run takes more than two seconds.

    Raises
    ------
    InputError
        There is no such line, or no source or driver at one of its nodes, or it does not move.

    Examples
    --------
    >>> from tline.shipped import examples
    >>> found = crosstalk(examples["skin_pair"])
    >>> print({node: f"{100 * share:.1f} %" for node, share in found.near.items()})
    {'near': '5.7 %'}
    """
    scene = as_scene(scene)
    name = _line(scene, line)
    ends: tuple[tuple[str, ...], tuple[str, ...]] = scene.lines[name].nodes1, scene.lines[name].nodes2  # pyright: ignore[reportAttributeAccessIssue]
    nodes = (*ends[0], *ends[1])
    table = scene.table() | {"probes": {node: {"at": node, "line": name} for node in nodes}, "measures": {}}
    probes = {
        node: curve(each)
        for node, each in simulate(scene.with_changes(**table), tol=tol, progress=progress).probes.items()
    }
    t = np.unique(np.concatenate([each.t for each in probes.values()]))
    voltages = {node: np.interp(t, each.t, each.u) for node, each in probes.items()}
    driven = _driven(scene, name, nodes)
    near, far = ends if driven in ends[0] else ends[::-1]
    swing = max(float(voltages[driven].max()), 0.0) - min(float(voltages[driven].min()), 0.0)  # from rest
    if swing == 0:
        raise InputError("sources", f"'{driven}' stays at 0 V", "a source that moves it")
    at = near.index(driven)
    heard = [
        {node: float(np.abs(voltages[node]).max()) / swing for k, node in enumerate(end) if k != at}
        for end in (near, far)
    ]
    pairs = tuple(pair for end in (near, far) for pair in combinations(end, 2))
    return Crosstalk(name, driven, t, voltages, swing, heard[0], heard[1], pairs, scene.title)


def _line(scene: Scene, name: str | None) -> str:
    coupled = [own for own, line in scene.lines.items() if isinstance(line, Coupled)]
    if name is None and len(coupled) == 1:
        return coupled[0]
    if not coupled:
        raise InputError("line", "there are no coupled conductors", "a line with nodes1 and nodes2")
    if name is None:
        raise InputError("line", "is missing", " or ".join(map(repr, coupled)))
    if name not in coupled:
        raise InputError("line", "not one of the coupled conductors", nearest(name, coupled), shown(name))
    return name


def _driven(scene: Scene, name: str, nodes: tuple[str, ...]) -> str:
    """The node that a source or a driver is at, or reaches by a link."""
    at = [node for source in scene.sources.values() for node in source.terminals if node is not None]
    at += [element.near for element in scene.composed.values() if isinstance(element.near, str)]
    reached = {*at, *(node for link in scene.links.values() for node in link.nodes if {*link.nodes} & {*at})}
    found = [node for node in nodes if node in at] or [node for node in nodes if node in reached]
    if len(found) != 1:
        got = "none" if not found else " and ".join(map(repr, found))
        raise InputError(place("lines", name), "not one of its nodes is driven", "a source at exactly one of them", got)
    return found[0]
