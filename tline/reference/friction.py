"""One pipe with quadratic friction, by the textbook's grid of characteristics, extrapolated; it says how good it is.

Along dx = ±c dt, u ± z0 y falls by K |y| y for each metre. The integral over a reach is taken by the trapezoidal rule,
with y at both ends, so that errors go with the square of the reach; Richardson takes that out. What is left comes from
where a flow turns, and |y| y has no second derivative: it falls with the third power.
"""

from fractions import Fraction
from itertools import pairwise

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.interpolate import BSpline, make_interp_spline

from tline.errors import InputError
from tline.reference.network import decimal
from tline.reference.waveforms import straight
from tline.scene.load import Reservoir, Short
from tline.scene.mistakes import place
from tline.scene.scene import Scene
from tline.scene.shape import Shape

FINEST = 4096  # reaches
DEGREE = 5  # of splines between fronts


class FrictionSolution:
    """Efforts at the far end of a pipe that runs steadily from a held pressure until its flow is changed there.

    Parameters
    ----------
    scene : Scene
        One line with Darcy's friction alone, from a reservoir or a short circuit to a source of a flow in straight
        pieces, from the steady state.
    finest : int
        Reaches of the finest of three grids, a multiple of 8.

    Attributes
    ----------
    fronts : ndarray
        Instants at which corners of the flow, or their echoes, are at the far end, s.
    error : float
        Largest difference to the same from grids of half as many reaches, Pa; errors are some eighth of it.

    Raises
    ------
    InputError
        Naming what is not so, or a corner that is on no grid.

    Examples
    --------
    >>> from tline.charts.scenes import chart_scene
    >>> solution = FrictionSolution(chart_scene("friction").scene, 256)
    >>> solution.at(np.array([0.0])) / 1e5  # bar, before anything moves
    array([-4.50787254])
    """

    def __init__(self, scene: Scene, finest: int = FINEST):
        flow, lost = _checked(scene)
        ((line),) = scene.single_lines.values()
        delay, z0 = decimal(line.parameters.delay or 0.0), line.parameters.z0
        corners = [start for start, *_ in straight(flow, decimal(scene.t_end)) or [] if start is not None]
        gaps = [(b - a) / delay * finest / 8 for a, b in pairwise([Fraction(0), *corners, 2 * delay])]
        if any(gap.denominator != 1 or 0 < gap < DEGREE for gap in gaps):
            raise InputError("finest", "corners of the flow lie between points, or few apart", "others", f"{finest}")
        transits = int(decimal(scene.t_end) / delay) + 1
        runs = [_grid(flow, z0, lost, float(delay), finest // k, transits) for k in (4, 2, 1)]
        coarse, fine = ((4 * b[::2] - a) / 3 for a, b in pairwise(runs))
        echoes = {start + 2 * k * delay for start in (*corners, Fraction(0)) for k in range(transits // 2 + 1)}
        self.fronts = np.array(sorted(echoes), float)
        tick = float(delay) / finest
        self._splines, rough = _splined(fine, 4 * tick, self.fronts), _splined(coarse, 8 * tick, self.fronts)
        self.error = float(np.abs(_read(rough, np.arange(len(fine)) * 4 * tick) - fine).max())

    def at(self, t: NDArray) -> NDArray:
        """Efforts at instants of the run, Pa."""
        return _read(self._splines, t)


def _splined(u: NDArray, dt: float, fronts: NDArray) -> list[tuple[float, BSpline]]:
    """Where each stretch between fronts begins, and a spline on it."""
    edges = np.unique([*np.round(fronts[fronts < (len(u) - 1) * dt] / dt).astype(int), len(u) - 1])
    t = np.arange(len(u)) * dt
    return [(float(t[a]), make_interp_spline(t[a : b + 1], u[a : b + 1], DEGREE)) for a, b in pairwise(edges)]


def _read(splines: list[tuple[float, BSpline]], t: NDArray) -> NDArray:
    piece = np.searchsorted([start for start, _ in splines[1:]], t)
    u = np.empty(len(t))
    for k in np.unique(piece):
        u[piece == k] = splines[k][1](t[piece == k])
    return u


def _checked(scene: Scene) -> tuple[Shape, float]:
    """The flow into the far end, and the K of a drop K |y| y over the whole line."""
    if len(scene.lines) != 1 or len(scene.sources) != 1 or len(scene.loads) != 1 or scene.links:
        raise InputError("lines", "not one line between one load and one source", "such a scene")
    ((name, line),), ((given, source),) = scene.single_lines.items(), scene.sources.items()
    ((key, load),) = scene.loads.items()
    lost = line.losses
    if lost is None or not lost.only_quadratic or scene.start != "steady":
        raise InputError(place("lines", name), "not with Darcy's friction alone, or not from the steady state")
    if source.is_effort or source.at != line.nodes[1] or straight(source.value, decimal(scene.t_end)) is None:
        raise InputError(place("sources", given), "no flow of straight pieces at end 2 of the line")
    if load.at != line.nodes[0] or not isinstance(load, Short | Reservoir):
        raise InputError(place("loads", key), "holds no pressure at end 1 of the line")
    return source.value, lost.quadratic * lost.exact.length


def _grid(flow: Shape, z0: float, lost: float, delay: float, n: int, transits: int) -> NDArray:
    """Efforts at the far end, over that of the held one, after every second step on a grid of n reaches.

    Points of a grid that an odd number of steps parts never meet; corners lie on one half of them only.
    """
    t = np.arange(transits * n + 1) * delay / n
    given = -flow.value(t, t - delay / n / 2)  # of a jump, what is before
    return _march(given, z0, lost / n, n)[::2]


@njit(cache=True, error_model="numpy")
def _march(given, z0, K, n):
    """Efforts at end 2, where the flows out of the line are given; end 1 is held at none. K is that of a reach."""
    y = np.full(n + 1, given[0])
    u = -K * abs(given[0]) * given[0] * np.arange(n + 1)
    plus, minus, seen = np.empty(n + 1), np.empty(n + 1), np.empty(len(given))
    seen[0] = u[n]
    for step in range(1, len(given)):
        for i in range(n + 1):
            half = K / 2 * abs(y[i]) * y[i]
            plus[i], minus[i] = u[i] + z0 * y[i] - half, u[i] - z0 * y[i] + half
        for i in range(1, n):
            w = plus[i - 1] - minus[i + 1]  # 2 z0 y + K |y| y
            y[i] = w / (z0 + np.sqrt(z0**2 + K * abs(w)))
            u[i] = (plus[i - 1] + minus[i + 1]) / 2
        w = -2 * minus[1]
        y[0], y[n] = w / (z0 + np.sqrt(z0**2 + K * abs(w))), given[step]
        u[n] = plus[n - 1] - z0 * y[n] - K / 2 * abs(y[n]) * y[n]
        seen[step] = u[n]
    return seen
