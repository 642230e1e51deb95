"""Map of the network, coloured by the rise and the fall of the effort at nodes and along lines."""

from itertools import pairwise
from math import inf, nan
from typing import Any, NamedTuple

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.transforms import Bbox, BboxBase
from numpy.typing import NDArray

from tline.errors import InputError
from tline.pictures.bounds import scale, spread
from tline.pictures.network import Places, course, has_positions, layout, refuse_too_many
from tline.scene.heights import weight_at
from tline.scene.held import held_nodes
from tline.scene.load import linked_pairs
from tline.scene.refuse import refuse_coupled
from tline.scene.scene import Scene
from tline.solver.result.dense_output import inside
from tline.solver.result.notes import VACUUM
from tline.solver.result.result import Result
from tline.style import FAINT, HALO, INK, add_bar, cells_of, short, styled, write_name

STRETCHES = 12  # of each line
SEEN = 0.01  # of the longest delay; the interior of shorter lines is too small for a map


class Surge(NamedTuple):
    """Change of the effort in one direction, relative to its value before t = 0."""

    nodes: dict[str, float]  # Pa or V, from 0
    lines: dict[str, NDArray]  # Pa or V, at places apart by equal delays along each recorded line
    beyond: dict[str, float]  # lines on which a limit is exceeded, with the share of the delay where that is worst


def lines_to_map(scene: Scene) -> list[str]:
    """Lines whose interior a map shows, for `simulate(scene, record=lines_to_map(scene), envelope=True)`.

    Raises
    ------
    InputError
        The scene has coupled conductors, or too many nodes, not all with positions.

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
    """Rise and fall of the effort at nodes and along lines.

    A limit is exceeded where the effort rises above the scene's rating, or falls below a vacuum at
    the wall; a voltage also where it falls below the negative rating.

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
    floor = VACUUM if result.medium.hydraulic else -rating
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


SCALE = ListedColormap(colormaps["viridis_r"](np.linspace(0.06, 1.0, 256)))  # large values are dark
WIDE = 1.3  # width over height above which the maps are stacked
NAMED = 60  # largest number of nodes with names
MARK = 8  # half the size of a node's mark, pixels
CORNERS = ((6, 4), (-6, 4), (6, -4), (-6, -4))  # positions of a name relative to its mark, points


@styled
def plot_map(result: Result) -> Figure:
    """Plot two maps of the network: the rise of the effort above its value before t = 0, and the fall below it.

    Squares are nodes at which a source or a reservoir holds the effort, dots are links, and a cross marks where the
    rating is exceeded or the gauge pressure falls below a vacuum. If not all nodes have positions, the
    layout makes distances proportional to delays.

    Parameters
    ----------
    result : Result
        Of ``simulate(scene, record=lines_to_map(scene), envelope=True)``; lines that were not recorded are grey.

    Returns
    -------
    matplotlib.figure.Figure
        With two axes, and a colour bar for each.

    Raises
    ------
    InputError
        The run kept no envelope, or nodes without positions are too many.

    Examples
    --------
    >>> from tline.solver.simulate import simulate
    >>> scene = Scene(
    ...     medium="electrical", t_end="40 ns", probes={"far": {"at": "far"}},
    ...     lines={"line": {"nodes": ["near", "far"], "z0": 50, "delay": "5 ns"}},
    ...     sources={"s": {"at": "near", "kind": "voltage", "value": 1, "resistance": 20}},
    ... )
    >>> maps = plot_map(simulate(scene, record=["line"], envelope=True))
    >>> [axes.get_title(loc="left") for axes in maps.axes[:2]]
    ['rise above the start', 'fall below the start']
    """
    return draw_surges(result.scene, *surges(result))


@styled
def draw_surges(scene: Scene, *both: Surge, ax: Axes | None = None) -> Any:
    """Draw the two maps of rise and fall of the effort; on `ax` the first alone."""
    places = layout(scene)
    wide, high = np.ptp([*places.values()], axis=0)
    rows = 2 if wide > WIDE * high else 1
    drawn, panels = cells_of(ax, *((8.0, 8.0) if rows == 2 else (9.0, 5.2)), rows, 3 - rows, scene.title)
    before = "the steady state" if scene.start == "steady" else "the start"
    for axes, surge, word in zip(panels, both, ("rise above", "fall below"), strict=False):
        largest = max([*surge.nodes.values(), *(float(size.max()) for size in surge.lines.values())])
        effort, size, unit = scale(scene, scene.lines, largest)
        colours = ScalarMappable(Normalize(0.0, spread(0.0, largest / size)[1]), SCALE)
        _draw(axes, scene, places, surge, colours, size)
        axes.set_title(f"{word} {before}", loc="left")
        add_bar(colours, axes, f"{word.split()[0]} of {effort} [{unit}]", fraction=0.05)
    if ax is None:
        _explain(drawn, scene, bool(held_nodes(scene)), any(surge.beyond for surge in both))
    panels[0].figure.canvas.figure.draw_without_rendering()
    for axes in panels:
        taken: list[BboxBase] = [
            Bbox.from_extents(*at - MARK, *at + MARK) for at in axes.transData.transform([*places.values()])
        ]
        for node, place in places.items() if len(places) <= NAMED else ():
            write_name(axes, short(node), place, CORNERS, taken)
    return drawn


def _draw(axes: Axes, scene: Scene, places: Places, surge: Surge, colours: ScalarMappable, size: float) -> None:
    ways = {name: course(scene, name, places, np.linspace(0.0, 1.0, 2)) for name in scene.lines}
    ways |= {name: course(scene, name, places, np.linspace(0, 1, len(v))) for name, v in surge.lines.items()}
    axes.add_collection(LineCollection([*ways.values()], colors=FAINT, linewidths=5, zorder=1, capstyle="round"))
    for name, values in surge.lines.items():
        steps = LineCollection([*pairwise(ways[name])], cmap=colours.cmap, norm=colours.norm, linewidths=3.4, zorder=2)
        steps.set_array(np.maximum(values[1:], values[:-1]) / size)
        axes.add_collection(steps)
    for pair in linked_pairs(scene):
        x, y = np.array([places[node] for node in pair]).T
        axes.plot(x, y, color=INK, linewidth=1.5, linestyle=":", zorder=1)
    held = held_nodes(scene)
    for node, place in places.items():
        known = np.array([surge.nodes[node] / size]) if node in surge.nodes else None
        colour = "white" if known is None else colours.to_rgba(known)[0]
        marker = "s" if node in held else "o"
        axes.plot(*place, marker, color=colour, markeredgecolor=INK, markersize=8, zorder=3)
    for name, share in surge.beyond.items():
        where = course(scene, name, places, np.array([share]))[0]
        axes.plot(*where, "x", color=INK, markersize=9, markeredgewidth=2.2, zorder=4, path_effects=HALO)
    axes.set(xticks=[], yticks=[])
    axes.spines[:].set_visible(False)
    axes.margins(0.1)
    axes.set_aspect("equal", adjustable="datalim")


def _explain(picture: Figure, scene: Scene, held: bool, beyond: bool) -> None:
    """Add a legend of the marks present."""
    square = Line2D([], [], color="white", markeredgecolor=INK, marker="s", label="held by a source or reservoir")
    dots = Line2D([], [], color=INK, linestyle=":", label="link")
    cross = Line2D([], [], color="white", markeredgecolor=INK, marker="x", label="worst place beyond rating or vacuum")
    handles = [mark for mark, there in ((square, held), (dots, scene.links), (cross, beyond)) if there]
    title = "" if has_positions(scene) else "not a map: laid out by delays, for not all nodes have positions"
    if handles or title:
        picture.legend(handles=handles, title=title, loc="outside lower center", ncols=3, fontsize=9, title_fontsize=9)
