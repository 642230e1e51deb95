"""Drawing of a scene: a layout of its nodes, lines, elements at and between nodes, and probes."""

from collections.abc import Iterator, Mapping
from itertools import groupby, pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.transforms import BboxBase
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.coupled import Coupled
from tline.scene.line import SceneLine
from tline.scene.load import linked_pairs
from tline.scene.scene import Scene
from tline.style import COLOURS, FAINT, INK, figure, short, styled, write_name
from tline.units import handy

Places = Mapping[str, tuple[float, float]]  # of nodes, in any unit

MOST_PLACED = 1500  # nodes without positions; the layout takes memory in proportion to their square
ROUNDS = 100  # of the search; later ones would change nothing visible
SHORTEST, LONGEST = 0.2, 5.0  # of an edge, in medians
APART = 1.2  # distance between unconnected parts, relative to the largest within one


def has_positions(scene: Scene) -> bool:
    """Whether the scene gives positions for all its nodes."""
    return all(node in scene.nodes and scene.nodes[node].position for node in _nodes(scene))


def refuse_too_many(scene: Scene) -> None:
    """Raise an error for a scene with too many nodes if not all have positions."""
    nodes = _nodes(scene)
    missing = [node for node in nodes if node not in scene.nodes or not scene.nodes[node].position]
    if missing and len(nodes) > MOST_PLACED:
        problem = f"'{missing[0]}' has no position, and a map of {len(nodes)} nodes is not laid out"
        raise InputError("nodes", problem, f"positions of all nodes, or at most {MOST_PLACED} nodes")


def layout(scene: Scene) -> Places:
    """Places of all nodes; if not all are given, those of least stress between distances and delays.

    References
    ----------
    T. Kamada, S. Kawai: An algorithm for drawing general undirected graphs. Information Processing Letters 31 (1989)
    7-15, doi:10.1016/0020-0190(89)90102-6.

    Examples
    --------
    >>> lines = {name: {"nodes": [*name], "z0": 50, "delay": 1} for name in ("ab", "bc")}
    >>> chain = Scene(medium="electrical", t_end=9, lines=lines, probes={"p": {"at": "a"}})
    >>> places = layout(chain)
    >>> print(round(np.hypot(*np.subtract(places["a"], places["c"])), 3))
    2.0
    """
    nodes = _nodes(scene)
    if has_positions(scene):
        return {node: scene.nodes[node].position or (0.0, 0.0) for node in nodes}
    refuse_too_many(scene)
    places = _least_stress(_distances(scene, nodes)) if len(nodes) > 1 else [(0.0, 0.0)]
    return {node: (float(x), float(y)) for node, (x, y) in zip(nodes, places, strict=True)}


def course(scene: Scene, line: str, places: Places, shares: NDArray) -> NDArray:
    """Places (n, 2) on the map at shares of a line, through its vertices if positions are given."""
    near, far = scene.lines[line].nodes
    between = scene.lines[line].vertices or () if has_positions(scene) else ()
    points = np.array([places[near], *between, places[far]], float)
    along = np.cumsum([0.0, *(np.hypot(*(two - one)) for one, two in pairwise(points))])
    return np.stack([np.interp(shares * along[-1], along, column) for column in points.T], axis=1)


def conductors(scene: Scene, line: str) -> list[tuple[str, str]]:
    """Both nodes of each conductor of a line."""
    found = scene.lines[line]
    if isinstance(found, Coupled):
        return [*zip(found.nodes1, found.nodes2, strict=True)]
    return [(found.nodes[0], found.nodes[1])]


def delay_of(line: SceneLine | Coupled) -> float:
    """Delay of a line, or of the fastest mode of coupled conductors, s."""
    return line.shortest if isinstance(line, Coupled) else line.parameters.delay or 0.0


def _nodes(scene: Scene) -> list[str]:
    pairs = [*(line.nodes for line in scene.lines.values()), *(nodes for _, nodes in scene.between)]
    return list(dict.fromkeys(node for pair in pairs for node in pair))


def _distances(scene: Scene, nodes: list[str]) -> NDArray:
    """Delays of the shortest paths, in median delays of a line."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import shortest_path

    number = {node: k for k, node in enumerate(nodes)}
    lines: dict[tuple[str, str], float] = {}
    for name, line in scene.lines.items():
        for pair in conductors(scene, name):
            lines[pair] = min(lines.get(pair, np.inf), delay_of(line))
    median = float(np.median([*lines.values()]))
    edges = {pair: min(max(delay / median, SHORTEST), LONGEST) for pair, delay in lines.items()}
    coupled = [line for line in scene.lines.values() if isinstance(line, Coupled)]
    beside = [pair for line in coupled for end in (line.nodes1, line.nodes2) for pair in pairwise(end)]
    edges = dict.fromkeys([*linked_pairs(scene), *beside], SHORTEST) | edges
    at = [[number[node] for node in pair] for pair in edges if pair[0] != pair[1]]
    size = [edge for pair, edge in edges.items() if pair[0] != pair[1]]
    graph = coo_array((size, tuple(zip(*at, strict=True)) or ([], [])), shape=(len(nodes), len(nodes)))
    far = shortest_path(graph.tocsr(), directed=False)
    known = np.isfinite(far)
    return np.where(known, far, APART * (far[known].max() or 1.0))


def _least_stress(distance: NDArray) -> NDArray:
    """Minimise the stress Σ (|x_i - x_j|/d_ij - 1)² of places (n, 2), from those of classical scaling on."""
    from scipy.optimize import minimize
    from scipy.spatial.distance import cdist

    n = len(distance)
    centre = np.eye(n) - 1 / n
    size, modes = np.linalg.eigh(-centre @ distance**2 @ centre / 2)
    start = modes[:, -2:] * np.sqrt(np.maximum(size[-2:], 0.0)) if n > 2 else np.arange(2.0 * n).reshape(n, 2)
    start = start + 1e-3 * distance.max() * np.stack([np.cos(np.arange(n)), np.sin(np.arange(n))], axis=1)  # apart
    weight = 1 / (distance + np.eye(n))

    def stress(flat: NDArray) -> tuple[float, NDArray]:
        x = flat.reshape(n, 2)
        size = cdist(x, x)
        np.fill_diagonal(size, 1.0)
        off = size * weight - 1
        np.fill_diagonal(off, 0.0)
        pull = off * weight / size
        return float((off**2).sum()), 4 * (pull.sum(axis=1)[:, None] * x - pull @ x).ravel()

    found = minimize(stress, start.ravel(), jac=True, method="L-BFGS-B", options={"maxiter": ROUNDS}).x.reshape(n, 2)
    return found @ np.linalg.svd(found - found.mean(axis=0), full_matrices=False)[2].T  # widest from left to right


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
