"""Forces of the liquid on bends, branches, valves and dead ends: the loads of anchors and thrust blocks."""

from collections import defaultdict
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.scene.heights import weight_at
from tline.scene.held import held_nodes
from tline.scene.line import Pipe
from tline.scene.scene import Scene
from tline.solver.result.dense_output import inside
from tline.solver.result.result import Result

ROUNDED = 1e-12  # of the highest force: smaller differences are none


class Thrust(NamedTuple):
    """Size of the force at a node, N."""

    before: float
    highest: float
    at: float  # when it is highest, s


def thrusts(result: Result) -> Mapping[str, Thrust]:
    """Forces by node, at slab ends, where all pipes that end there were recorded and their directions are known.

    Each pipe pushes with p·A + density·Q²/A along its axis into the node, p the gauge pressure; the force is the sum of
    these, as vectors. Directions follow from positions, vertices, elevations and lengths; of a single pipe none is
    needed. Liquid that the fitting itself holds is not counted. Nodes at a held pressure are left out.

    References
    ----------
    E. B. Wylie, V. L. Streeter: Fluid Transients in Systems (1993); AWWA Manual M9, on thrust restraint.
    """
    scene, weight = result.scene, weight_at(result.scene)
    ends, untold = defaultdict[str, list[tuple[str, int]]](list), held_nodes(scene)
    for name, line in scene.lines.items():
        known = (
            isinstance(line, Pipe) and None not in (_of(line, "area"), _of(line, "density")) and name in result.lines
        )
        for end, node in enumerate(line.nodes):
            ends[node].append((name, end))
            untold |= set() if known else {node}
    t = np.append(-1.0, result.t)  # before the run, and at slab ends
    found = {}
    for node, here in ends.items():
        ways = [_way(scene, name, end) for name, end in here] if len(here) > 1 else [np.array([1.0, 0.0, 0.0])]
        known = [way for way in ways if way is not None]
        if node in untold or len(known) < len(here):
            continue
        pushes = [_push(result, name, end, weight.get(node, 0.0), t) for name, end in here]
        size = np.linalg.norm(np.array(pushes).T @ np.array(known), axis=1)
        k = int(np.argmax(size[1:] >= (1 - ROUNDED) * size[1:].max()))
        found[node] = Thrust(float(size[0]), float(size[1 + k]), float(result.t[k]))
    return found


def _of(line: Any, key: str) -> float | None:
    return getattr(line.parameters, key, None)


def _push(result: Result, name: str, end: int, weight: float, t: NDArray) -> NDArray:
    line = result.scene.lines[name]
    area, density = _of(line, "area") or 0.0, _of(line, "density") or 0.0
    a, b = inside(result, name).waves(t, float(end))
    flow = (a - b) / (2 * line.parameters.z0)
    return ((a + b) / 2 - weight) * area + density * flow**2 / area


def _way(scene: Scene, name: str, end: int) -> NDArray | None:
    """The direction in which a pipe leaves its node, of length one; None if it is not known."""
    line = scene.lines[name]
    sites = [scene.nodes.get(node) for node in line.nodes]
    (here, there), length = (sites[end], sites[1 - end]), _of(line, "length")
    if here is None or there is None or here.position is None or there.position is None:
        return None
    places = [*(line.vertices or ())]
    beside = (places[0] if end == 0 else places[-1]) if places else there.position
    along = np.array([float(x) - float(y) for x, y in zip(beside, here.position, strict=True)])
    rise = float(there.elevation or 0.0) - float(here.elevation or 0.0)
    slope = min(max(rise / length, -1.0), 1.0) if length else 0.0
    size = np.linalg.norm(along)
    if size == 0.0:
        return np.array([0.0, 0.0, np.sign(slope)]) if abs(slope) == 1.0 else None
    return np.append(along / size * np.sqrt(1 - slope**2), slope)
