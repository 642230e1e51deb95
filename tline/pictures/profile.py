"""Effort along a route: extremes with their bounds, and images of effort and waves over place and time."""

from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import Colormap, LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from numpy.typing import NDArray

from tline.errors import InputError
from tline.pictures.bounds import Bound, bounds, scale, spread
from tline.pictures.path import Leg, Route, axis, effort_along, extremes_along, start_effort, waves_along
from tline.solver.result.result import Result
from tline.style import COLOURS, DASHES, DIVERGING, INK, Picture, add_bar, figure, name_nodes, styled
from tline.units import handy
from tline.words.wording import nearest, shown

WIDTH, HEIGHT = 8.0, 5.0  # inches
MARGIN = 0.06  # of the range, above and below
GROUND = "#7A6A53"
LOOKS: dict[str, Any] = {
    "ground": {"color": GROUND, "linewidth": 1.4},
    "rating": {"color": COLOURS[3], "linestyle": DASHES[3], "linewidth": 1.4},
    "vacuum": {"color": COLOURS[2], "linestyle": DASHES[2], "linewidth": 1.4},
}
PIXELS, WAVE_PIXELS = (700, 900), (300, 600)  # places, instants


@styled
def plot_profile(result: Result, path: Route) -> Figure:
    """Plot the envelope of the effort along a route with the state before t = 0, ground, rating and vacuum.

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
    """Draw ground, rating and vacuum, within the limits that the axes have."""
    for bound in limits:
        axes.plot(bound.x, bound.effort, label=bound.name, **LOOKS[bound.kind])
        if bound.kind == "ground":
            axes.fill_between(bound.x, bound.effort, axes.get_ylim()[0], color=GROUND, alpha=0.15, linewidth=0)


ONE_SIDED = 0.1  # of the range; below this on either side of the start one colour scale is enough


@styled
def plot_space_time(result: Result, path: Route) -> Figure:
    """Plot the effort along a route, time running down; white is the state before t = 0 if the effort goes both ways.

    Parameters
    ----------
    result : Result
        A finished run in which the route's lines were recorded.
    path : Route
        From `route(scene)`.

    Raises
    ------
    InputError
        A line of the route was not recorded.
    """
    effort = effort_along(result, path, *_grid(result, path, *PIXELS))
    word, size, unit = scale(result.scene, path.lines, float(abs(effort).max()))
    effort = effort / size
    low, high = spread(effort.min(), effort.max())
    picture = figure(8.0, 5.4, result.scene.title)
    axes = picture.subplots()
    image = _draw_image(axes, effort, result, path, *_colours(low, high, start_effort(result, path) / size))
    add_bar(image, axes, f"{word} [{unit}]").ax.set_ylim(low, high)
    return picture


def _colours(low: float, high: float, start: float) -> tuple[Colormap, Normalize]:
    """Choose two colours that meet at the state before t = 0, if both sides are wide enough; else one scale."""
    if min(high - start, start - low) > ONE_SIDED * (high - low):
        reach = max(high - start, start - low)
        return LinearSegmentedColormap.from_list("", DIVERGING, N=512), Normalize(start - reach, start + reach)
    return colormaps["viridis"], Normalize(low, high)


def plot_line_waves(result: Result, line: str) -> Picture:
    """Plot both waves on a line over place and time, which runs down: a leans one way, b the other.

    Parameters
    ----------
    result : Result
        A finished run in which the line was recorded.
    line : str
        Name of a line.

    Raises
    ------
    InputError
        There is no such line, or it was not recorded.
    """
    if line not in result.scene.lines:
        raise InputError("line", "no such line", nearest(str(line), [*result.scene.lines]), shown(line))
    parameters, nodes = result.scene.single_lines[line].parameters, result.scene.single_lines[line].nodes
    end, unit = (parameters.length, "m") if parameters.length else (parameters.delay or 0.0, "s")
    return plot_path_waves(result, Route((nodes[0], nodes[1]), (Leg(line, True, 0.0, (0.0, end)),), (0.0, end), unit))


@styled
def plot_path_waves(result: Result, way: Route) -> Picture:
    """Plot both waves along a route over place and time, which runs down.

    Parameters
    ----------
    result : Result
        A finished run in which the route's lines were recorded.
    way : Route
        From `route(scene)`.
    """
    both = waves_along(result, way, *_grid(result, way, *WAVE_PIXELS))
    size, unit = handy(float(abs(both).max()), result.medium.shown["effort"])
    norm = Normalize(*spread(float(both.min() / size), float(both.max() / size)))
    picture = figure(9.0, 4.8, result.scene.title)
    panels = picture.subplots(1, 2, sharey=True, gridspec_kw={"wspace": 0.06})  # so that names of nodes stay apart
    labels = (f"a = u + z0·y, toward {way.nodes[-1]}", f"b = u - z0·y, toward {way.nodes[0]}")
    for axes, values, label in zip(panels, both, labels, strict=True):
        _draw_image(axes, values / size, result, way, colormaps["viridis"], norm)
        axes.set_title(label, loc="left", fontsize=10, pad=22)
    panels[1].set_ylabel("")
    add_bar(panels[0].images[0], panels, f"wave [{unit}]")
    return picture


def _grid(result: Result, way: Route, across: int, down: int) -> tuple[NDArray, NDArray]:
    """Centres of pixels: places and instants."""
    return (np.arange(across) + 0.5) / across * way.marks[-1], (np.arange(down) + 0.5) / down * float(result.t[-1])


def _draw_image(
    axes: Axes, values: NDArray, result: Result, way: Route, colours: Colormap, norm: Normalize
) -> AxesImage:
    """Draw values over place and time, which runs down, with the names of nodes above."""
    t_end = float(result.t[-1])
    (second, time_unit), (length, place) = handy(t_end, "s"), axis(way, result.scene)
    look: Any = {"aspect": "auto", "interpolation": "antialiased", "cmap": colours, "norm": norm}
    image = axes.imshow(values, extent=(0.0, way.marks[-1] / length, t_end / second, 0.0), **look)
    name_nodes(axes, {mark / length: name for mark, name in way.labels.items()})
    axes.set(xlabel=place, ylabel=f"time [{time_unit}]")
    return image
