"""Bergeron's graphical method: on one line between resistive ends, states at either end hop along characteristics."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.presentation import Presentation, plain
from tline.scene.file import as_scene
from tline.scene.heights import words
from tline.scene.medium import Medium
from tline.scene.refuse import refuse_cavities, refuse_coupled, refuse_losses
from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.solver.description.nodes import Node
from tline.solver.steady.steady_state import above_level, rest
from tline.words.wording import aligned


class LoadLine(NamedTuple):
    """Characteristic of an end: all (u, y) with p u + q y = r; y counts from end 1 to end 2 at both ends."""

    p: float
    q: float
    r: float


@dataclass(frozen=True, eq=False, repr=False)
class Bergeron(Presentation):
    """The hops of a step.

    Attributes
    ----------
    z0, delay : float
        Of the line.
    ends : tuple of LoadLine
        After the sources have stepped at t = 0.
    u, y : ndarray, shape (n + 1,)
        State before t = 0, at end 1 just after it, at end 2 after one delay, at end 1 after two, and so on.
    medium : Medium
        Words and units.
    title : str
        Of the scene.
    """

    z0: float
    delay: float
    ends: tuple[LoadLine, LoadLine]
    u: NDArray
    y: NDArray
    medium: Medium
    title: str
    picture = "tline.pictures.signals:plot_load_lines"

    def text_lines(self) -> Iterator[str]:
        """The states at both ends, delay by delay."""
        said = self.medium
        effort, flow = f"{said.effort} [{said.units['effort']}]", f"{said.flow} [{said.units['flow']}]"
        rows = [[f"{max(k - 1, 0)} T", f"end {1 if k % 2 else 2}" if k else "before", f"{u:.6g}", f"{y:.6g}"]
                for k, (u, y) in enumerate(zip(self.u, self.y, strict=True))]  # fmt: skip
        yield from aligned([["time", "where", effort, flow], *rows], 2)

    def to_dict(self) -> dict[str, Any]:
        """Line, ends and states in SI units."""
        return plain({name: getattr(self, name) for name in ("z0", "delay", "ends", "u", "y")})


def bergeron(scene: Scene | str | Path, hops: int = 12) -> Bergeron:
    """Follow the step of constant sources through the plane of effort and flow.

    At end 2 arrives u + z0 y, as it left end 1; at end 1 arrives u - z0 y, as it left end 2. Each state is where such a
    characteristic meets the end's load line.

    Parameters
    ----------
    scene : Scene, or the path of a file
        One line, ends of resistors and sources that step at t = 0 and then stay: other waveforms count as a step to
        their values at the scene's end.
    hops : int
        How many states are followed, at least 1.

    Raises
    ------
    InputError
        There are several lines, or an end is not resistive.

    References
    ----------
    L. Bergeron: Du coup de bélier en hydraulique au coup de foudre en électricité, Dunod 1950.

    Examples
    --------
    >>> scene = Scene(
    ...     medium="electrical", t_end=1, probes={"p": {"at": "far"}},
    ...     lines={"line": {"nodes": ["near", "far"], "z0": 50, "delay": 1}},
    ...     sources={"s": {"at": "near", "kind": "voltage", "value": 1, "resistance": 25}},
    ...     loads={"end": {"at": "far", "kind": "resistor", "resistance": 150}},
    ... )
    >>> bergeron(scene, 3).u.round(6).tolist()  # 2/3, then half of it comes back, and a third of that is turned over
    [0.0, 0.666667, 1.0, 0.888889]
    """
    scene = as_scene(scene)
    if len(scene.lines) != 1:
        raise InputError("lines", "load lines are drawn for one line", "a scene with one line", f"{len(scene.lines)}")
    refuse_coupled(scene.lines, "a diagram of load lines")
    refuse_cavities(scene.lines, "a diagram of load lines")
    refuse_losses(scene, "no load lines")
    description = describe(scene)
    ((near, far), z0, delay, _), *_ = description.lines.values()
    nodes = description.nodes
    if near == far:
        raise InputError("lines", "both ends are at one node", "two nodes")
    ends = _load_line(scene, near, nodes[near], 1.0), _load_line(scene, far, nodes[far], -1.0)
    before = above_level(description) if description.steady else rest(description)
    u, y = [before.effort[near]], [float(before.flows[0, 0])]
    for k in range(hops):
        slope = -z0 if k % 2 == 0 else z0  # of the arriving characteristic: u - z0 y at end 1, u + z0 y at end 2
        p, q, r = ends[k % 2]
        found = np.linalg.solve([[p, q], [1.0, slope]], [r, u[-1] + slope * y[-1]])
        u.append(float(found[0]))
        y.append(float(found[1]))
    level = nodes[near].height.level
    one, two = (end._replace(r=end.r + end.p * level) for end in ends)
    return Bergeron(z0, delay, (one, two), np.array(u) + level, np.array(y), words(scene), scene.title)


def _load_line(scene: Scene, name: str, node: Node, into_line: float) -> LoadLine:
    """J - G u flows into the line, or the effort is held."""
    if node.load is not None or node.switches:
        raise InputError(next(iter(node.loads)), "no load line: the end is not resistive", "resistors and sources")
    late = np.array(float(scene.t_end))
    if node.held is not None:
        return LoadLine(1.0, 0.0, float(node.held.value(late, late)))
    J = sum(factor * float(waveform.value(late, late)) for waveform, factor in node.flows)
    return LoadLine(node.conductance, into_line, J)
