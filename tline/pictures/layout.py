"""Layout of nodes on a map: at their given positions, or with distances in proportion to delays."""

from collections.abc import Mapping
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.coupled import Coupled
from tline.scene.line import SceneLine
from tline.scene.load import linked_pairs
from tline.scene.scene import Scene

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
