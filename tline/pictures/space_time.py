"""Effort over place and time, as an image."""

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import Colormap, LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure

from tline.pictures.along import effort_along, start_effort
from tline.pictures.bounds import scale
from tline.pictures.handy import handy, spread
from tline.pictures.path import Route, axis
from tline.pictures.style import DIVERGING, figure, name_nodes, styled
from tline.solver.result.result import Result

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
    length, place = axis(path)
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
