"""Drawing of a scene: lines, elements at and between nodes, and probes."""

from collections.abc import Iterator, Mapping
from itertools import groupby
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.transforms import BboxBase
from numpy.typing import NDArray

from tline.pictures.layout import Places, conductors, course, delay_of, has_positions, layout
from tline.scene.line import SceneLine
from tline.scene.load import linked_pairs
from tline.scene.scene import Scene
from tline.style import COLOURS, FAINT, INK, figure, short, styled, write_name
from tline.units import handy

NAMED = 40  # largest number of nodes with names, and names of their elements
WIDTH, FLATTEST, TALLEST = 8.0, 2.6, 6.0  # inches
MARKS = {"source": (">", COLOURS[1]), "load": ("s", COLOURS[0]), "probe": ("o", COLOURS[2])}
LETTER = 0.16  # inches, a line of text
BEND = 0.25  # of their length, between lines with the same nodes
SHARES = np.linspace(0.0, 1.0, 101)  # of a line, its points in the drawing


@styled
def plot_network(scene: Scene) -> Figure:
    """Draw a scene: lines with their delays, links, sources, loads and probes by name.

    Nodes are at their given positions; if not all have one, distances are in proportion to delays. In a large network
    only lines and marks are drawn, and where names would overlap only the first.

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        Nodes without positions are too many.

    Examples
    --------
    >>> pipe = {"nodes": ["tank", "valve"], "length": "300 m", "wave_speed": 1200, "diameter": "1 m", "density": 1000}
    >>> scene = Scene(medium="hydraulic", t_end=1, lines={"pipe": pipe}, probes={"end": {"at": "valve"}})
    >>> [text.get_text() for text in plot_network(scene).axes[0].texts]
    ['tank', 'valve\\nend', 'pipe\\n250 ms']
    """
    places, standing = _from_left(scene, layout(scene)), dict(_standing(scene))
    wide, high = np.ptp([*places.values()], axis=0)
    height = WIDTH * high / max(wide, 1e-9) + 1.2 + LETTER * max(map(len, standing.values()), default=0)
    picture = figure(WIDTH, min(max(height, FLATTEST), TALLEST), scene.title)
    axes = picture.subplots()
    ways = _ways(scene, places)
    axes.add_collection(LineCollection([*ways.values()], colors=FAINT, linewidths=4 if len(ways) < 100 else 1.5))
    for pair in linked_pairs(scene):
        axes.plot(*np.array([places[node] for node in pair]).T, color=INK, linewidth=1.5, linestyle=":", zorder=1)
    for node, place in places.items():
        axes.plot(*place, "o", color=INK, markersize=4, zorder=3)
        for word, _ in standing.get(node, ()):
            _mark(axes, word, place)
    inner = dict(_inner_probes(scene, ways))
    for place in inner.values():
        _mark(axes, "probe", place)
    axes.set(xticks=[], yticks=[])
    axes.spines[:].set_visible(False)
    axes.margins(0.12, 0.25)
    axes.set_aspect("equal", adjustable="datalim")
    _explain(picture, scene, {word for here in standing.values() for word, _ in here} | ({"probe"} if inner else set()))
    if len(places) <= NAMED:
        below = {"\n".join(dict.fromkeys([node, *(name for _, name in standing.get(node, ()))])): place
                 for node, place in places.items()}  # fmt: skip
        above = dict(_lines_named(scene, ways)) | dict(_links_named(scene, places))
        picture.draw_without_rendering()
        taken: list[BboxBase] = []
        for names, side in ((below | inner, -9), (above, 5)):
            for name, place in names.items():
                write_name(axes, name, place, [(0, side)], taken)
    return picture


def _from_left(scene: Scene, places: Places) -> Places:
    """Mirror places of nodes if the first line would run from right to left on a drawing without positions."""
    near, far = conductors(scene, next(iter(scene.lines)))[0]
    if has_positions(scene) or places[near][0] <= places[far][0]:
        return places
    return {node: (-x, y) for node, (x, y) in places.items()}


def _ways(scene: Scene, places: Places) -> dict[tuple[str, int], NDArray]:
    """Course of each conductor by line and number; bent where several lines have the same nodes."""
    found: dict[tuple[str, int], NDArray] = {}
    pairs = [(tuple(sorted(pair)), name, k) for name in scene.lines for k, pair in enumerate(conductors(scene, name))]
    for ends, group in groupby(sorted(pairs), key=lambda each: each[0]):
        alike = [*group]
        for number, (_, name, k) in enumerate(alike):
            one, other = conductors(scene, name)[k]
            single = len(conductors(scene, name)) == 1
            way = (
                course(scene, name, places, SHARES) if single else np.linspace(places[one], places[other], len(SHARES))
            )
            if len(alike) > 1 and not has_positions(scene):
                across = np.subtract(places[ends[1]], places[ends[0]])[::-1] * (-1, 1)
                bend = BEND * (number - (len(alike) - 1) / 2)
                way = way + 4 * bend * (SHARES * (1 - SHARES))[:, None] * across
            found[name, k] = way
    return found


def _standing(scene: Scene) -> Iterator[tuple[str, list[tuple[str, str]]]]:
    """Kind and name of the elements and probes at each node."""
    found = [(source.terminals[0], "source", name) for name, source in scene.sources.items()]
    found += [(load.at, "load", name) for name, load in scene.loads.items()]
    found += [(probe.at, "probe", name) for name, probe in scene.probes.items() if probe.at]
    for node, here in groupby(sorted(found, key=lambda each: each[0]), key=lambda each: each[0]):
        yield node, [(word, short(name)) for _, word, name in here]


def _inner_probes(scene: Scene, ways: Mapping[tuple[str, int], NDArray]) -> Iterator[tuple[str, tuple[float, float]]]:
    for name, probe in scene.probes.items():
        line = scene.lines.get(probe.line or "")
        if probe.line and probe.position is not None and isinstance(line, SceneLine):
            x, y = (np.interp(probe.fraction(line), SHARES, column) for column in ways[probe.line, 0].T)
            yield short(name), (float(x), float(y))


def _lines_named(scene: Scene, ways: Mapping[tuple[str, int], NDArray]) -> Iterator[tuple[str, tuple[float, float]]]:
    """Name and delay of each line, with the middle of its course; delay lines of measured elements are left out."""
    for name, line in scene.lines.items():
        size, unit = handy(delay_of(line), "s")
        x, y = ways[name, 0][len(SHARES) // 2]
        if name not in scene.delay_lines:
            yield f"{short(name)}\n{delay_of(line) / size:.3g} {unit}", (x, y)


def _links_named(scene: Scene, places: Places) -> Iterator[tuple[str, tuple[float, float]]]:
    for name, link in scene.links.items():
        x, y = np.mean([places[node] for node in dict.fromkeys(link.nodes)], axis=0)
        yield short(name), (x, y)


def _mark(axes: Axes, word: str, place: tuple[float, float]) -> None:
    marker, colour = MARKS[word]
    look: dict[str, Any] = {"markersize": 9, "zorder": 4}
    if word == "probe":
        look = {"markersize": 13, "zorder": 5, "markerfacecolor": "none", "markeredgewidth": 1.8}
    axes.plot(*place, marker=marker, color=colour, **look)


def _explain(picture: Figure, scene: Scene, there: set[str]) -> None:
    handles = [
        Line2D([], [], marker=marker, color=colour, linestyle="", label=word,
               markerfacecolor="none" if word == "probe" else colour)
        for word, (marker, colour) in MARKS.items() if word in there
    ]  # fmt: skip
    if scene.links:
        handles.append(Line2D([], [], color=INK, linestyle=":", label="link"))
    title = "" if has_positions(scene) or len(scene.lines) == 1 else "laid out by delays"
    picture.legend(handles=handles, title=title, loc="outside lower center", ncols=4, fontsize=9, title_fontsize=9)
