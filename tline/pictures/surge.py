"""How far the effort rose and fell in a network: at nodes, along lines, and where that is more than these can bear."""

from math import inf, nan
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.pictures.layout import refuse_too_many
from tline.scene.coupled import refuse_coupled
from tline.scene.heights import weight_at
from tline.scene.medium import HYDRAULIC
from tline.scene.scene import Scene
from tline.solver.result.interior import inside
from tline.solver.result.limits import VACUUM
from tline.solver.result.result import Result

STRETCHES = 12  # of each line
SEEN = 0.01  # of the longest delay; what is inside shorter lines nobody sees on a map


class Surge(NamedTuple):
    """Of the effort, in one direction from where it was before t = 0."""

    nodes: dict[str, float]  # Pa or V, from 0
    lines: dict[str, NDArray]  # the same at places apart by equal delays along each recorded line
    beyond: dict[str, float]  # of lines on which a limit is exceeded the share of the delay where it is worst


def lines_to_map(scene: Scene) -> list[str]:
    """The lines that a map shows the inside of, for `simulate(scene, record=lines_to_map(scene), envelope=True)`.

    Raises
    ------
    InputError
        The scene has coupled conductors, or too many nodes of which not all have positions.

    Examples
    --------
    >>> pipes = {name: {"nodes": [*name], "z0": 1e8, "delay": delay} for name, delay in (("ab", 1), ("bc", 1e-3))}
    >>> lines_to_map(Scene(medium="hydraulic", t_end=9, lines=pipes, probes={"p": {"at": "a"}}))
    ['ab']
    """
    refuse_coupled(scene.lines, "a map")
    refuse_too_many(scene)
    delays = {name: line.parameters.delay or 0.0 for name, line in scene.lines.items()}
    return [name for name, delay in delays.items() if delay >= SEEN * max(delays.values())]


def surges(result: Result) -> tuple[Surge, Surge]:
    """How far the effort rose, and how far it fell.

    A limit is exceeded where the effort rises above the scene's rating, or falls below what a liquid can have at a
    wall; a voltage also where it falls below the negative rating.

    Parameters
    ----------
    result : Result
        Of a run with an envelope.

    Raises
    ------
    InputError
        The run kept no envelope.
    """
    scene, envelope = result.scene, result.envelope
    if envelope is None:
        raise InputError("map", "the run kept no envelope", "simulate(scene, envelope=True)")
    rating, weight = float(scene.rating or inf), weight_at(scene)
    unknown = nan if weight else 0.0  # where some heights are known, others are not zero
    floor = VACUUM if result.medium is HYDRAULIC else -rating
    rise, fall = Surge({}, {}, {}), Surge({}, {}, {})
    for node, start, low, high in zip(envelope.nodes, envelope.start, envelope.lowest, envelope.highest, strict=True):
        rise.nodes[node], fall.nodes[node] = float(high - start), float(start - low)
    for name in result.lines:
        seen = inside(result, name, STRETCHES)
        share, (start, low, high) = seen.places, seen.extremes(result.t)
        even = np.linspace(0.0, 1.0, len(share))
        near, far = (weight.get(node, unknown) for node in scene.lines[name].nodes)
        ground = near + share * (far - near)
        over = high - ground - rating, floor - (low - ground)
        for surge, size, excess in zip((rise, fall), (high - start, start - low), over, strict=True):
            surge.lines[name] = np.interp(even, share, size)
            if (excess > 0).any():
                surge.beyond[name] = float(share[np.nanargmax(excess)])
    return rise, fall
