"""Effort along a route: its extremes with what bounds them, and an image over place and time."""

from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import Colormap, LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure

from tline.pictures.along import effort_along, extremes_along, start_effort
from tline.pictures.bounds import Bound, bounds, scale
from tline.pictures.path import Route, axis
from tline.pictures.spread import spread
from tline.pictures.style import COLOURS, DASHES, DIVERGING, INK, figure, name_nodes, styled
from tline.solver.result.result import Result
from tline.units import handy

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
    metre, place = axis(path, result.scene)
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


PIXELS = 700, 900  # places, instants
ONE_SIDED = 0.1  # of the range; less than this below or above the start is no reason for two colours


@styled
def plot_space_time(result: Result, path: Route) -> Figure:
    """Effort along a route, time running down; white is the state before t = 0 if the effort goes both ways.

    Parameters
    ----------
    result : Result
        A finished run in which the route's lines were recorded.
    path : Route
        From `route(scene)`.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        A line of the route was not recorded.
    """
    across, down = PIXELS
    end, t_end = path.marks[-1], float(result.t[-1])
    x = (np.arange(across) + 0.5) / across * end
    t = (np.arange(down) + 0.5) / down * t_end
    effort = effort_along(result, path, x, t)
    word, size, unit = scale(result.scene, path.lines, float(abs(effort).max()))
    effort = effort / size
    low, high = spread(effort.min(), effort.max())
    colours, norm = _colours(low, high, start_effort(result, path) / size)
    second, time_unit = handy(t_end, "s")
    length, place = axis(path, result.scene)
    picture = figure(8.0, 5.4, result.scene.title)
    axes = picture.subplots()
    image = axes.imshow(
        effort,
        cmap=colours,
        norm=norm,
        extent=(0.0, end / length, t_end / second, 0.0),
        aspect="auto",
        interpolation="antialiased",
    )
    name_nodes(axes, {mark / length: name for mark, name in path.labels.items()})
    axes.set_xlabel(place)
    axes.set_ylabel(f"time [{time_unit}]")
    bar = picture.colorbar(image, ax=axes, pad=0.02, fraction=0.06)
    bar.set_label(f"{word} [{unit}]")
    bar.outline.set_visible(False)
    bar.ax.set_ylim(low, high)
    return picture


def _colours(low: float, high: float, start: float) -> tuple[Colormap, Normalize]:
    """Two colours that part at the state before t = 0, if there is enough on either side of it; else one scale."""
    if min(high - start, start - low) > ONE_SIDED * (high - low):
        reach = max(high - start, start - low)
        return LinearSegmentedColormap.from_list("", DIVERGING, N=512), Normalize(start - reach, start + reach)
    return colormaps["viridis"], Normalize(low, high)
