"""Effort along a route: before the run, the lowest, the highest, and what bounds it."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tline.pictures.along import extremes_along
from tline.pictures.bounds import Bound, bounds, scale
from tline.pictures.handy import spread
from tline.pictures.path import Route, axis
from tline.pictures.style import COLOURS, DASHES, INK, figure, name_nodes, styled
from tline.solver.result.result import Result

WIDTH, HEIGHT = 8.0, 5.0  # inches
MARGIN = 0.06  # of the range, above and below
GROUND = "#7A6A53"
LOOKS: dict[str, Any] = {
    "ground": {"color": GROUND, "linewidth": 1.4},
    "rating": {"color": COLOURS[3], "linestyle": DASHES[3], "linewidth": 1.4},
    "vacuum": {"color": COLOURS[2], "linestyle": DASHES[2], "linewidth": 1.4},
}


@styled
def plot_profile(result: Result, path: Route) -> Figure:
    """Envelope of the effort along a route with the state before t = 0, ground, rating and vacuum.

    Parameters
    ----------
    result : Result
        A finished run in which the route's lines were recorded.
    path : Route
        From `route(scene)`.

    Returns
    -------
    matplotlib.figure.Figure
        Over metres, or over delays where a length is not known; heads in metres where heights are known.

    Raises
    ------
    InputError
        A line of the route was not recorded.

    Examples
    --------
    >>> from tline.pictures.path import route
    >>> from tline.scene.scene import Scene
    >>> from tline.solver.simulate import simulate
    >>> scene = Scene(
    ...     medium="electrical", t_end="40 ns", probes={"far": {"at": "far"}},
    ...     lines={"line": {"nodes": ["near", "far"], "z0": 50, "delay": "5 ns"}},
    ...     sources={"s": {"at": "near", "kind": "voltage", "value": 1, "resistance": 20}},
    ... )
    >>> way = route(scene)
    >>> plot_profile(simulate(scene, record=way.lines), way).axes[0].get_ylabel()
    'voltage [V]'
    """
    seen = extremes_along(result, path)
    limits = bounds(result.scene, path, seen.x, seen.lowest)
    every = np.concatenate([*seen[1:], *(bound.effort for bound in limits)])
    word, size, unit = scale(result.scene, path.lines, np.nanmax(np.abs(every)))
    metre, place = axis(path)
    picture = figure(WIDTH, HEIGHT, result.scene.title)
    axes = picture.subplots()
    x, before = seen.x / metre, "steady" if result.scene.start == "steady" else "before the run"
    axes.fill_between(x, seen.lowest / size, seen.highest / size, color=COLOURS[0], alpha=0.1, linewidth=0)
    axes.plot(x, seen.highest / size, color=COLOURS[1], label="highest")
    axes.plot(x, seen.start / size, color=INK, linestyle=DASHES[1], label=before)
    axes.plot(x, seen.lowest / size, color=COLOURS[0], label="lowest")
    low, high = spread(np.nanmin(every) / size, np.nanmax(every) / size)
    low, high = low - MARGIN * (high - low), high + MARGIN * (high - low)
    axes.set(xlim=(0.0, path.marks[-1] / metre), ylim=(low, high), xlabel=place, ylabel=f"{word} [{unit}]")
    draw_bounds(axes, [bound.in_units(metre, size) for bound in limits])
    axes.grid(True, axis="y")
    name_nodes(axes, {mark / metre: name for mark, name in path.labels.items()})
    picture.legend(loc="outside lower center", ncols=3)
    return picture


def draw_bounds(axes: Axes, limits: list[Bound]) -> None:
    """Ground, rating and vacuum, within the limits that the axes have."""
    for bound in limits:
        axes.plot(bound.x, bound.effort, label=bound.name, **LOOKS[bound.kind])
        if bound.kind == "ground":
            axes.fill_between(bound.x, bound.effort, axes.get_ylim()[0], color=GROUND, alpha=0.15, linewidth=0)
