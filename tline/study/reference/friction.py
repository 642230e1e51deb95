"""Pipes with quadratic friction, by a staggered grid of characteristics, extrapolated, with an error estimate.

Along dx = ±c dt, u ± z0 y falls by K |y| y for each metre. The integral over half a reach is taken by the trapezoidal
rule, so that errors go with the square of the reach; Richardson extrapolation removes that term. The rest comes from
flow reversals, where |y| y has no second derivative, and falls with the third power.
"""

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline, make_interp_spline

from tline.errors import InputError
from tline.scene.load import Load, Reservoir, Short
from tline.scene.refuse import refuse_floating, refuse_heights
from tline.scene.scene import Scene
from tline.scene.shape import Shape
from tline.study.reference.grid import Pipes, joined, march, steady
from tline.study.reference.network import decimal, straight
from tline.words.wording import place

MOST_WORK = 500_000_000  # reaches times steps of the finest grid
DEGREE = 5  # of splines between fronts


class FrictionSolution:
    """Efforts at the probes of pipes in steady flow, with prescribed pressures, after changes of the flows into nodes.

    Lines have Darcy's friction alone, and flows straight pieces, between which they may jump. Of three grids the finest
    has `finest` half reaches, a multiple of 8, in the shortest line.

    Attributes
    ----------
    fronts : dict of str to ndarray
        By probe: instants at which corners of the flows, or their echoes, are there, s.
    error : float
        Largest difference to solutions from grids of half as many reaches, Pa; errors are some eighth of it.

    Examples
    --------
    >>> from tline.study.charts.scenes import chart_scene
    >>> solution = FrictionSolution(chart_scene("friction").scene, 256)
    >>> before = solution.at("far", np.array([0.0]))  # Pa, before anything moves
    >>> print(f"{before[0] / 1e5:.8f} bar")
    -4.50787254 bar
    """

    def __init__(self, scene: Scene, finest: int | None = None):
        pipes, nodes, pressures = _pipes(scene)
        flows = [(nodes.index(source.terminals[0]), source.value) for source in scene.sources.values()]
        delays = [decimal(line.parameters.delay or 0.0) for line in scene.lines.values()]
        shortest = min(delays)
        end = (int(decimal(scene.t_end) / shortest) + 1) * shortest
        most = 2 ** int(np.log2(float(MOST_WORK * shortest**2 / sum(delays) / end)) / 2)
        tick = shortest / (finest or most)
        echoes = _echoes(pipes, delays, flows, end)
        gaps = [b - a for at in echoes for a, b in pairwise([Fraction(0), *at, end]) if a < b]
        if any((span / tick / 8).denominator != 1 for span in gaps + delays) or min(gaps) / tick / 8 < DEGREE:
            problem = "delays or corners of flows lie between points, or few apart"
            raise InputError("finest", problem, "others", f"{shortest / tick}")
        for name, probe in scene.probes.items():
            if probe.at not in nodes:
                raise InputError(place("probes", name), "not at the end of a line")
        seen = {name: nodes.index(str(probe.at)) for name, probe in scene.probes.items()}
        reaches = np.array([int(delay / tick) for delay in delays])
        runs = [
            _grid(pipes, pressures, flows, 2 * float(tick) * k, reaches // (2 * k), int(end / tick) // (2 * k), seen)
            for k in (4, 2, 1)
        ]
        coarse, fine = extrapolated(runs[:2]), extrapolated(runs[1:])
        self.fronts = {name: np.array(echoes[k], float) for name, k in seen.items()}
        self._splines, self.error = {}, 0.0
        for (name, fronts), rough, u in zip(self.fronts.items(), coarse, fine, strict=True):
            self._splines[name] = _splined(u, 4 * float(tick), fronts)
            between = _read(_splined(rough, 8 * float(tick), fronts), np.arange(len(u)) * 4 * float(tick))
            self.error = max(self.error, float(np.abs(between - u[:, 0]).max()))

    def at(self, probe: str, t: NDArray) -> NDArray:
        """Efforts at a probe at instants of the run, Pa."""
        return _read(self._splines[probe], t)


def extrapolated(runs: Sequence[NDArray]) -> NDArray:
    """Richardson's extrapolation of two runs of second order, the second with half the step of the first."""
    coarse, fine = runs
    return (4 * fine[:, ::2][:, : coarse.shape[1]] - coarse) / 3


def _splined(u: NDArray, dt: float, fronts: NDArray) -> list[tuple[float, BSpline]]:
    """Start of each stretch between fronts, and a spline on it, from behind one front to before the next."""
    edges = np.unique([0, *np.round(fronts / dt).astype(int), len(u) - 1])
    t, stretches = np.arange(len(u)) * dt, [(a, b, np.append(u[a:b, 1], u[b, 0])) for a, b in pairwise(edges)]
    return [(float(t[a]), make_interp_spline(t[a : b + 1], values, DEGREE)) for a, b, values in stretches]


def _read(splines: list[tuple[float, BSpline]], t: NDArray) -> NDArray:
    piece = np.searchsorted([start for start, _ in splines[1:]], t)
    u = np.empty(len(t))
    for k in np.unique(piece):
        u[piece == k] = splines[k][1](t[piece == k])
    return u


def _pipes(scene: Scene) -> tuple[Pipes, list[str], NDArray]:
    """Pipes of a scene as arrays, the names of the nodes, and the pressures that are prescribed, 0 elsewhere."""
    refuse_heights(scene, "exact solutions")
    if scene.links or scene.start != "steady":
        raise InputError("scene", "has links, or does not start from the steady state")
    for name, line in scene.single_lines.items():
        if line.losses is None or not line.losses.only_quadratic:
            raise InputError(place("lines", name), "not with Darcy's friction alone")
    refuse_floating(scene.sources, "exact solutions")
    for name, source in scene.sources.items():
        if source.is_effort or straight(source.value, decimal(scene.t_end)) is None:
            raise InputError(place("sources", name), "no flow of straight pieces")
    lines = scene.single_lines.values()
    ends = [node for line in lines for node in line.nodes]
    nodes = list(dict.fromkeys(ends))
    held, pressures = np.zeros(len(nodes), bool), np.zeros(len(nodes))
    for name, load in scene.loads.items():
        k = nodes.index(load.at)
        held[k], pressures[k] = True, _pressure(name, load)
    z0 = np.array([line.parameters.z0 for line in lines])
    lost = np.array([line.losses.quadratic * line.losses.exact.length for line in lines if line.losses])
    return joined([nodes.index(node) for node in ends], held, np.zeros(len(nodes)), z0, lost), nodes, pressures


def _pressure(name: str, load: Load) -> float:
    match load:
        case Short():
            return 0.0
        case Reservoir():
            return load.pressure
    raise InputError(place("loads", name), "holds no pressure")


def _echoes(
    pipes: Pipes, delays: list[Fraction], flows: list[tuple[int, Shape]], end: Fraction
) -> list[list[Fraction]]:
    """Instants by node of corners of the flows, and of their echoes through the lines."""
    node = {e: k for k, (a, b) in enumerate(pairwise(pipes.first)) for e in pipes.ends[a:b]}
    corners = {(t, k) for k, flow in flows for t, *_ in straight(flow, end) or [] if t is not None and t < end}
    waiting, known = list(corners), set(corners)
    while waiting:
        t, k = waiting.pop()
        for e in pipes.ends[pipes.first[k] : pipes.first[k + 1]]:
            later = (t + delays[e // 2], node[e ^ 1])
            if later[0] < end and later not in known:
                known.add(later)
                waiting.append(later)
    return [sorted(t for t, at in known if at == k) for k in range(len(pipes.held))]


def _grid(
    pipes: Pipes,
    pressures: NDArray,
    flows: list[tuple[int, Shape]],
    dt: float,
    reaches: NDArray,
    steps: int,
    seen: dict[str, int],
) -> NDArray:
    """Efforts at some nodes, before and behind fronts, (rows, steps + 1, 2)."""
    t = np.arange(steps + 1) * dt
    given = np.broadcast_to(pressures[:, None, None], (len(pressures), steps + 1, 2)).copy()
    for k, flow in flows:
        for side, near in enumerate((t - dt / 2, t + dt / 2)):
            given[k, :, side] += flow.value(t, near)
    return march(pipes, reaches, *steady(pipes, given[:, 0, 0]), given, np.array([*seen.values()]))
