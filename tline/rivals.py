"""Rival methods, small and honest: what others do with a scene, for charts and for teaching. Not the production path.

All see the scene as `nodes_of` does. Those that step in time are compiled loops (`advance_*`); lumped chains and Padé
sections are sparse linear systems, vectorised, integrated by scipy's `solve_ivp`. One file: the point is to compare.

| family | what it does with a wave |
|---|---|
| characteristics (MOC) | reads it a whole number of steps late, the wave speed adjusted to that, or interpolates |
| the same on a grid | carries it from reach to reach, where friction takes its share |
| upwind, Lax-Wendroff | carries it from cell to cell |
| FDTD | leapfrogs effort and flow on staggered grids |
| lumped, Padé | replaces the line by an ordinary differential equation |
| slabs, pointwise | as the production method, but interpolates where that projects |

References
----------
E. B. Wylie, V. L. Streeter: Fluid Transients in Systems (1993), chapters 3 and 8: MOC, friction, interpolation,
wave-speed adjustment. H. W. Dommel, IEEE Trans. PAS-88 (1969) 388, doi:10.1109/TPAS.1969.292459: lines by their
history, loads by the trapezoid. K. S. Yee, IEEE Trans. AP-14 (1966) 302, doi:10.1109/TAP.1966.1138693: leapfrog.
P. Lax, B. Wendroff, Comm. Pure Appl. Math. 13 (1960) 217, doi:10.1002/cpa.3160130205.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from math import ceil
from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from tline.errors import InputError
from tline.scene.cavities import with_cavities
from tline.scene.losses import Losses
from tline.scene.mistakes import place
from tline.scene.rational_load import Rational
from tline.scene.scene import Scene
from tline.scene.waveform import Shape
from tline.solver.drive import EDGE, sampled
from tline.solver.nodes import Node, node_of_end, nodes_of
from tline.solver.radau import Basis, gauss
from tline.solver.steady import rest, steady_state

MOST_WORK = 2e9  # cells times steps
MOST_KEPT = 1e8  # samples
MOST_EVALUATIONS = 3_000_000  # of a differential equation
STIFF = 30  # times the rate of a section: beyond, implicitly
TINY = 1e-150  # waves below are flushed to zero, as in the production kernel
HALF = 0.5  # of a step, by which methods that interpolate miss the shortest delay: the worst case
COURANT = 0.9  # of methods that would be exact, or could not run, at 1
Weights = Callable[[float], tuple[float, float, float, float]]
Euler = tuple[NDArray, NDArray, NDArray]  # x_next = first x + second w_now + third w_next


class Trace(NamedTuple):
    """What a rival computed: instants, effort of each probe at these, and the seconds that time stepping took."""

    t: NDArray
    u: dict[str, NDArray]
    seconds: float


@dataclass(frozen=True)
class Rival:
    """A method beside which the production method stands.

    Attributes
    ----------
    label : str
        For charts.
    order : int
        Of the error in 1/n, for smooth waves between resistances.
    load_order : int
        The same for dynamic loads; the lower of both holds.
    solve : callable
        From a scene and n to a trace.
    unfit : callable
        From a scene to why this method cannot do it, or None.
    knows : str
        What lines may lose by: "nothing", "resistance", or "friction", then also from a steady start.

    Examples
    --------
    >>> scene = Scene(
    ...     medium="electrical", t_end=3, probes={"far": {"at": "far"}},
    ...     lines={"line": {"nodes": ["near", "far"], "z0": 1, "delay": 1}},
    ...     sources={"s": {"at": "near", "kind": "voltage", "resistance": 1, "value": {"shape": "ramp", "to": 1,
    ...         "duration": 1}}},
    ... )
    >>> RIVALS["moc_trapezoid"].run(scene, 2).u["far"].tolist()
    [0.0, 0.0, 0.0, 0.5, 1.0, 1.0, 1.0]
    """

    label: str
    order: int
    load_order: int
    solve: Callable[[Scene, float], Trace]
    unfit: Callable[[Scene], str | None] = lambda scene: None
    knows: str = "nothing"

    def misfit(self, scene: Scene) -> str | None:
        """Why this method cannot do a scene; None if it can."""
        for part, name in scene.laws:
            return f"{place(part, name)}: rivals know linear elements only"
        for name in with_cavities(scene.lines):
            return f"{place('lines', name, 'cavities')}: rivals know linear elements only"
        for name, load in scene.loads.items():
            if load.kind in ("switch", "valve"):
                return f"{place('loads', name)}: rivals have no switches"
        for name, probe in scene.probes.items():
            if probe.at is None:
                return f"{place('probes', name)}: rivals are recorded at nodes only"
        for name, line in scene.lines.items():
            if line.losses and not _takes(line.losses, self.knows):
                return f"{place('lines', name)}: loses what this method does not know"
        if scene.start != "rest" and self.knows != "friction":
            return "start: rivals start at rest only"
        return self.unfit(scene)

    def run(self, scene: Scene, n: float) -> Trace:
        """Run a scene with n steps per shortest delay.

        Raises
        ------
        InputError
            The method cannot do the scene (`misfit` says why), or n is too small or too large for it.
        """
        if why := self.misfit(scene):
            raise InputError("", f"{self.label}: {why}")
        if not n >= 2:
            raise InputError("n", "too few steps per shortest delay", "at least 2", f"{n}")
        return self.solve(scene, n)


def _takes(losses: Losses, known: str) -> bool:
    """Whether a method that knows that much can do a line."""
    if known == "friction":
        return losses.only_quadratic
    return known == "resistance" and losses.constant is not None and not losses.constant[1]


# ---------------------------------------------------------------------------------------------------- loads


def forward_euler(A: NDArray, b: NDArray) -> Euler:
    """x' = A x + b w by its value at the step's start; A and b count time in steps."""
    return np.eye(len(A)) + A, b, 0 * b


def backward_euler(A: NDArray, b: NDArray) -> Euler:
    """The same by its value at the step's end."""
    inverse = np.linalg.inv(np.eye(len(A)) - A)
    return inverse, 0 * b, inverse @ b


def trapezoid(A: NDArray, b: NDArray) -> Euler:
    """The same by the mean of both."""
    inverse = np.linalg.inv(np.eye(len(A)) - A / 2)
    return inverse @ (np.eye(len(A)) + A / 2), inverse @ b / 2, inverse @ b / 2


class Scattering(NamedTuple):
    """Nodes as arrays: from the waves that arrive at their ends to those sent back; m states a load."""

    first: NDArray  # (nodes + 1,) the ends at node k are ends[first[k]:first[k + 1]]
    ends: NDArray
    weight: NDArray  # (ends,) share in the Thévenin wave w
    row: NDArray  # (nodes,) of its load, -1 for none
    x_x: NDArray  # (loads, m, m)
    x_before: NDArray  # (loads, m)
    x_now: NDArray  # (loads, m)
    u_x: NDArray  # (loads, m)
    u_w: NDArray  # (loads,)


def scattering(scene: Scene, nodes: list[Node], dt: float, rule: Callable[[NDArray, NDArray], Euler]) -> Scattering:
    """The nodes of a scene, their loads integrated by a rule."""
    z0 = np.array([line.parameters.z0 for line in scene.lines.values()])
    own = [1 / z0[np.array(node.ends) // 2] / (np.inf if node.held else node.total) for node in nodes]
    dynamic = [node.load is not None and node.held is None for node in nodes]
    systems = [node.effort(0.0) for node, moves in zip(nodes, dynamic, strict=True) if moves]
    m = max((len(system.A) for system in systems), default=0)
    maps = [(*rule(dt * system.A, dt * system.b[:, 0]), system.c[0]) for system in systems]
    x_x, x_before, x_now, u_x = (
        np.array([np.pad(each[k], (0, m - len(each[3]))) for each in maps]).reshape(len(maps), *(m,) * (2 - (k > 0)))
        for k in range(4)
    )
    ends, first = np.array([end for node in nodes for end in node.ends]), np.cumsum([0, *(len(n.ends) for n in nodes)])
    row, u_w = np.where(dynamic, np.cumsum(dynamic) - 1, -1), np.array([system.d[0, 0] for system in systems])
    return Scattering(first, ends, np.concatenate(own), row, x_x, x_before, x_now, u_x, u_w)


@njit(cache=True, error_model="numpy")
def scatter(net, drive, arriving, w, x, new, u, sent):
    """All nodes at one instant: w, x and u are brought up to it, and sent is what leaves the ends."""
    for k in range(len(net.row)):
        wave, r = drive[k], net.row[k]
        for j in range(net.first[k], net.first[k + 1]):
            wave += net.weight[j] * arriving[net.ends[j]]
        effort = wave
        if r >= 0:
            effort *= net.u_w[r]
            for i in range(len(new)):
                new[i] = net.x_before[r, i] * w[k] + net.x_now[r, i] * wave
                for j in range(len(new)):
                    new[i] += net.x_x[r, i, j] * x[r, j]
                effort += net.u_x[r, i] * new[i]
            x[r] = new
        w[k], u[k] = wave, effort
        for j in range(net.first[k], net.first[k + 1]):
            back = 2.0 * effort - arriving[net.ends[j]]
            sent[net.ends[j]] = 0.0 if abs(back) < TINY else back


# ----------------------------------------------------------------------------- method of characteristics


def nearest(f: float) -> tuple[float, float, float, float]:
    """Weights of the samples 1 step late, on time, 1 and 2 steps early; here f is 0."""
    return 0.0, 1.0, 0.0, 0.0


def linear(f: float) -> tuple[float, float, float, float]:
    """The wave a fraction f of a step before the sample on time, on a straight line."""
    return 0.0, 1.0 - f, f, 0.0


def cubic(f: float) -> tuple[float, float, float, float]:
    """The same on Lagrange's cubic."""
    return (
        -f * (1 - f) * (2 - f) / 6,
        (1 + f) * (1 - f) * (2 - f) / 2,
        (1 + f) * f * (2 - f) / 2,
        -(1 + f) * f * (1 - f) / 6,
    )


def moc(
    scene: Scene,
    n: float,
    rule: Callable[[NDArray, NDArray], Euler] = trapezoid,
    weights: Weights = nearest,
    offset: float = 0.0,
    whole: int | None = None,
) -> Trace:
    """Characteristics: what arrives is what was sent one delay ago.

    Without interpolation the delays are rounded to whole steps: the wave speeds are adjusted. `offset` adds to n; with
    `whole` all lines count as that many steps late, and the rest of the delay, whatever it is, is the fraction.
    """
    nodes, dt = nodes_of(scene), _shortest(scene) / (n + offset)
    steps, delays = _steps(scene, dt), _delays(scene) / dt
    late = np.maximum(np.round(delays) if weights is nearest else np.floor(delays + 1e-9), 1).astype(int)
    late = late if whole is None else np.full(len(late), whole)
    taps = np.array([weights(f) for f in (0.0 * delays if weights is nearest else delays - late)])
    _within(2 * len(late) * (steps + late.max()), MOST_KEPT)
    net = scattering(scene, list(nodes.values()), dt, rule)
    loop = partial(advance_moc, net, late, taps)
    return _stepped(scene, loop, dt, steps, [node.drives for node in nodes.values()])


@njit(cache=True, error_model="numpy")
def advance_moc(net, late, taps, drive, seen, steps, record):
    """Lines by their histories: all that was sent from an end, after as many zeros as the longest delay takes."""
    ends, m, pad = 2 * len(late), net.x_x.shape[1], np.max(late) + 2
    history = np.zeros((ends, steps + 1 + pad))
    w, u, x, new = np.zeros(len(net.row)), np.zeros(len(net.row)), np.zeros((len(net.x_x), m)), np.zeros(m)
    arriving, sent = np.zeros(ends), np.zeros(ends)
    for k in range(steps + 1):
        for e in range(ends):
            at = k + pad - late[e // 2]
            arriving[e] = 0.0
            for j in range(4):
                if taps[e // 2, j] != 0.0:
                    arriving[e] += taps[e // 2, j] * history[e ^ 1, at + 1 - j]
        scatter(net, drive[:, k], arriving, w, x, new, u, sent)
        history[:, k + pad] = sent
        record[:, k] = u[seen]


# --------------------------------------------------------------------- characteristics on a grid, with friction


class Grid(NamedTuple):
    """Lines in reaches and nodes that hold an effort or conduct, as arrays."""

    first: NDArray  # (nodes + 1,) the ends at node k are ends[first[k]:first[k + 1]]
    ends: NDArray
    held: NDArray  # (nodes,)
    conductance: NDArray  # (nodes,)
    reaches: NDArray  # (lines,)
    z0: NDArray  # (lines,)
    friction: NDArray  # (lines,) K of a drop K |y| y over a reach


def moc_grid(scene: Scene, n: float) -> Trace:
    """Characteristics from point to point; friction over a reach counts as K |y before| y after: second order.

    Delays are rounded to whole steps.
    """
    nodes, dt = nodes_of(scene), _shortest(scene) / n
    steps, reaches = _steps(scene, dt), np.maximum(np.round(_delays(scene) / dt), 1).astype(int)
    _within(reaches.sum() * steps, MOST_WORK)
    losses = [line.losses for line in scene.single_lines.values()]
    friction = np.array([x.quadratic * x.exact.length if x else 0.0 for x in losses])
    each = nodes.values()
    net = Grid(
        np.cumsum([0, *(len(node.ends) for node in each)]),
        np.array([end for node in each for end in node.ends]),
        np.array([node.held is not None for node in each]),
        np.array([node.conductance for node in each]),
        reaches,
        _z0(scene),
        friction / reaches,
    )
    efforts, flows = (steady_state if scene.start == "steady" else rest)(scene, nodes)
    ends = np.array([[efforts[node] for node in line.nodes] for line in scene.lines.values()])
    parts = [[(node.held, 1.0)] if node.held else node.flows for node in each]
    return _stepped(scene, partial(advance_grid, net, ends, flows[:, 0]), dt, steps, parts)


@njit(cache=True, error_model="numpy")
def advance_grid(net, ends, flows, drive, seen, steps, record):
    """Effort u and flow y on all points of all lines, begun on straight lines between the ends."""
    lines = len(net.reaches)
    most, effort = np.max(net.reaches) + 1, np.zeros(len(net.held))
    u, y, new_u, new_y = (
        np.zeros((lines, most)),
        np.zeros((lines, most)),
        np.zeros((lines, most)),
        np.zeros((lines, most)),
    )
    for j in range(lines):
        last = net.reaches[j]
        u[j, : last + 1] = ends[j, 0] + (ends[j, 1] - ends[j, 0]) / last * np.arange(last + 1)
        y[j, : last + 1] = flows[j]
    for k in range(len(net.held)):
        end = net.ends[net.first[k]]
        effort[k] = ends[end // 2, end % 2]
    record[:, 0] = effort[seen]
    for step in range(1, steps + 1):
        for j in range(lines):
            inside(u[j], y[j], new_u[j], new_y[j], net.reaches[j], net.z0[j], net.friction[j])
        for k in range(len(net.held)):
            flow, conductance = drive[k, step], net.conductance[k]
            for end in net.ends[net.first[k] : net.first[k + 1]]:
                w, z = arriving(net, end, u, y)
                flow, conductance = flow + w / z, conductance + 1 / z
            effort[k] = drive[k, step] if net.held[k] else flow / conductance
            for end in net.ends[net.first[k] : net.first[k + 1]]:
                w, z = arriving(net, end, u, y)
                j, place, sign = end // 2, net.reaches[end // 2] * (end % 2), 2.0 * (end % 2) - 1.0
                new_u[j, place], new_y[j, place] = effort[k], sign * (w - effort[k]) / z
        u, y, new_u, new_y = new_u, new_y, u, y
        record[:, step] = effort[seen]


@njit(cache=True, error_model="numpy")
def arriving(net, end, u, y):
    """What comes to an end of a line: an effort behind an impedance."""
    j, place, sign = end // 2, (net.reaches[end // 2] - 1) * (end % 2) + 1 - end % 2, 2.0 * (end % 2) - 1.0
    before = y[j, place]
    return u[j, place] + sign * net.z0[j] * before, net.z0[j] + net.friction[j] * abs(before)


@njit(cache=True, error_model="numpy")
def inside(u, y, new_u, new_y, reaches, z0, friction):
    """The points of a line between its ends."""
    for i in range(1, reaches):
        before, after = y[i - 1], y[i + 1]
        z_plus, z_minus = z0 + friction * abs(before), z0 + friction * abs(after)
        plus, minus = u[i - 1] + z0 * before, u[i + 1] - z0 * after
        flow = (plus - minus) / (z_plus + z_minus)
        new_y[i], new_u[i] = flow, plus - z_plus * flow


def _no_friction(scene: Scene) -> str | None:
    for name, load in scene.loads.items():
        if isinstance(load, Rational):
            return f"{place('loads', name)}: has a state"
    frictionless = all(line.losses is None or line.losses.linear for line in scene.single_lines.values())
    return "without friction it is the same as without a grid" if frictionless else None


# --------------------------------------------------------------------------------- waves from cell to cell


def upwind(scene: Scene, n: float, courant: float = COURANT) -> Trace:
    """Each cell takes from the one behind it: linear interpolation along the line, what MOC does at Courant < 1."""
    return _cells(scene, n, courant, lambda C: C / 2)


def lax_wendroff(scene: Scene, n: float, courant: float = COURANT) -> Trace:
    """A parabola through the cell and both its neighbours; upwind in the last cell of a line."""
    return _cells(scene, n, courant, lambda C: C**2 / 2)


def _cells(scene: Scene, n: float, courant: float, diffusion: Callable[[NDArray], NDArray]) -> Trace:
    nodes, dt = nodes_of(scene), _shortest(scene) / n
    steps, cells = _steps(scene, dt), _grid(scene, dt, courant)
    _within(2 * cells.sum() * steps, MOST_WORK)
    C = cells * dt / _delays(scene)
    net = scattering(scene, list(nodes.values()), dt, trapezoid)
    loop = partial(advance_cells, net, cells, C, diffusion(C))
    return _stepped(scene, loop, dt, steps, [node.drives for node in nodes.values()])


@njit(cache=True, error_model="numpy")
def advance_cells(net, cells, courant, diffusion, drive, seen, steps, record):
    """The wave sent from each end on a grid of its own, whose last point arrives at the other end."""
    ends, m = 2 * len(cells), net.x_x.shape[1]
    a = np.zeros((ends, np.max(cells) + 1))
    w, u, x, new = np.zeros(len(net.row)), np.zeros(len(net.row)), np.zeros((len(net.x_x), m)), np.zeros(m)
    arriving, sent = np.zeros(ends), np.zeros(ends)
    for k in range(steps + 1):
        for e in range(ends if k else 0):
            last, C, d = cells[e // 2], courant[e // 2], diffusion[e // 2]
            before, arriving[e ^ 1] = a[e, 0], a[e, last] - C * (a[e, last] - a[e, last - 1])
            for i in range(1, last):
                now, after = a[e, i], a[e, i + 1]
                a[e, i] = now - C / 2 * (after - before) + d * (after - 2 * now + before)
                before = now
            a[e, last] = arriving[e ^ 1]
        scatter(net, drive[:, k], arriving, w, x, new, u, sent)
        a[:, 0] = sent
        record[:, k] = u[seen]


# ---------------------------------------------------------------------------------------------- leapfrog


def fdtd(scene: Scene, n: float, courant: float = COURANT) -> Trace:
    """Effort at cell edges and whole steps, flow between them; half a cell of every line belongs to its node."""
    nodes, dt = nodes_of(scene), _shortest(scene) / n
    steps, cells = _steps(scene, dt), _grid(scene, dt, courant)
    _within(2 * cells.sum() * steps, MOST_WORK)
    systems = [_on_capacitor(node, half, dt) for node, half in _half_cells(scene, nodes, cells)]
    m = max(len(system.A) for system in systems)
    maps = [trapezoid(system.A, system.B[:, 0]) for system in systems]
    x_x = np.array([np.pad(x, (0, m - len(x))) for x, _, _ in maps])
    x_i = np.array([np.pad(2 * half, (0, m - len(half))) for _, half, _ in maps])
    held = np.array([node.held is not None for node in nodes.values()])
    parts = [[(node.held, 1.0)] if node.held else node.flows for node in nodes.values()]
    C = cells * dt / _delays(scene)
    loop = partial(advance_fdtd, cells, C, _z0(scene), node_of_end(nodes.values()), held, x_x, x_i)
    return _stepped(scene, loop, dt, steps, parts)


@njit(cache=True, error_model="numpy")
def advance_fdtd(cells, courant, z0, at, held, x_x, x_i, drive, seen, steps, record):
    """Efforts u of each line at cell edges, flows y (times z0) between; x are the states of the nodes."""
    lines, nodes, m = len(cells), len(held), x_x.shape[1]
    u, y = np.zeros((lines, np.max(cells) + 1)), np.zeros((lines, np.max(cells)))
    x, new, effort, flow = np.zeros((nodes, m)), np.zeros(m), np.zeros(nodes), np.zeros(nodes)
    for k in range(steps + 1):
        flow[:] = (drive[:, k] + drive[:, max(k - 1, 0)]) / 2
        for j in range(lines if k else 0):
            n = cells[j]
            for i in range(n):
                y[j, i] -= courant[j] * (u[j, i + 1] - u[j, i])
            for i in range(1, n):
                u[j, i] -= courant[j] * (y[j, i] - y[j, i - 1])
            flow[at[2 * j]] -= y[j, 0] / z0[j]
            flow[at[2 * j + 1]] += y[j, n - 1] / z0[j]
        for node in range(nodes):
            if k:
                new[:] = x_i[node] * flow[node]
                for i in range(m):
                    for j in range(m):
                        new[i] += x_x[node, i, j] * x[node, j]
                x[node] = new
            effort[node] = drive[node, k] if held[node] else x[node, 0]
        for j in range(lines):
            u[j, 0], u[j, cells[j]] = effort[at[2 * j]], effort[at[2 * j + 1]]
        record[:, k] = effort[seen]


# ------------------------------------------------------------------------ ordinary differential equations


class System(NamedTuple):
    """A node: x' = A x + B v, effort = C x + D v, v what the lines and what the sources drive; k states."""

    A: NDArray  # (k, k)
    B: NDArray  # (k, 2)
    C: NDArray  # (1, k)
    D: NDArray  # (1, 2)


class Chain(NamedTuple):
    """A line: x' = A x + b (efforts at its ends); c x is what drives the nodes there; k states."""

    A: Any  # (k, k)
    b: Any  # (k, 2)
    c: Any  # (2, k)


HELD = System(np.zeros((0, 0)), np.zeros((0, 2)), np.zeros((1, 0)), np.array([[0.0, 1.0]]))


def lumped_pi(scene: Scene, n: float) -> Trace:
    """Each line a chain of sections, half of their capacitance before and half behind their inductance."""
    nodes, unit, cells = nodes_of(scene), _shortest(scene), _sections(scene, n)
    chains = []
    for N, width, z0, decay in zip(cells, _delays(scene) / cells / unit, _z0(scene), _decays(scene), strict=True):
        D = _differences(N)  # states: z0 times the flows, then the efforts between
        ends = np.vstack([D[:, [0, N]], np.zeros((N - 1, 2))])
        A = _skew(D[:, 1:N]) / width
        A[range(N), range(N)] -= decay * unit
        chains.append(Chain(A, ends / width, -ends.T / z0))
    systems = [_on_capacitor(node, half, unit) for node, half in _half_cells(scene, nodes, cells)]
    return _integrated(scene, n, chains, systems, order=2)


def lumped_t(scene: Scene, n: float) -> Trace:
    """Each line a chain of sections, half of their inductance before and half behind their capacitance."""
    nodes, unit, cells = nodes_of(scene), _shortest(scene), _sections(scene, n)
    widths = _delays(scene) / cells / unit
    half = np.repeat(widths * _z0(scene) / 2, 2)  # inductance at each end
    behind = [1 / (1 / half[node.ends]).sum() for node in nodes.values()]
    share = np.array([behind[k] for k in node_of_end(nodes.values())]) / half
    chains = []
    for j, (N, width) in enumerate(zip(cells, widths, strict=True)):
        A, ends, first_last = _skew(_differences(N)), np.zeros((2 * N + 1, 2)), np.zeros((2, 2 * N + 1))
        ends[N, 0], ends[2 * N, 1] = 1.0, -1.0  # states: the efforts, then z0 times the flows
        A[[N, 2 * N]] *= 2.0
        first_last[0, 0], first_last[1, N - 1] = share[2 * j : 2 * j + 2]
        chains.append(Chain(A / width, 2 * ends / width, first_last))
    systems = [_behind_inductor(node, series, unit) for node, series in zip(nodes.values(), behind, strict=True)]
    return _integrated(scene, n, chains, systems, order=2)


def pade(scene: Scene, n: float) -> Trace:
    """Each delay a chain of sections (6 - 2s)/(6 + 4s + s²), the Padé approximant [1/2] of exp(-s)."""
    from scipy import sparse

    nodes, unit, cells = nodes_of(scene), _shortest(scene), _sections(scene, n)
    share = np.empty(2 * len(cells))
    for node in nodes.values():
        share[node.ends] = 1 / _z0(scene)[np.array(node.ends) // 2] / (np.inf if node.held else node.total)
    A, b, c, chains = np.array([[-4.0, 1.0], [-6.0, 0.0]]), np.array([[-2.0], [6.0]]), np.array([[1.0, 0.0]]), []
    for j, (N, width) in enumerate(zip(cells, _delays(scene) / cells / unit, strict=True)):
        one_way = sparse.kron(sparse.eye(N), A) + sparse.kron(sparse.eye(N, k=-1), b @ c)
        enter, leave = np.vstack([b, np.zeros((2 * N - 2, 1))]), np.hstack([np.zeros((1, 2 * N - 2)), c])
        back, none = -enter @ sparse.csr_array(leave), np.zeros((1, 2 * N))  # sent is 2 u less what arrives
        both = sparse.block_array([[one_way, back], [back, one_way]]) / width
        sides = np.block([[none, share[2 * j] * leave], [share[2 * j + 1] * leave, none]])
        chains.append(Chain(both, 2 / width * np.kron(np.eye(2), enter), sides))
    systems = []
    for node in nodes.values():
        A, b, c, d = node.effort(0.0)
        both = np.repeat(unit * b, 2, axis=1)
        systems.append(HELD if node.held else System(unit * A, both, c, np.repeat(d, 2, axis=1)))
    return _integrated(scene, n, chains, systems, order=3, thevenin=True)


def _differences(N: int) -> Any:
    """Each of N + 1 values less the next, shape (N, N + 1)."""
    return np.eye(N, N + 1) - np.eye(N, N + 1, k=1)


def _skew(D: NDArray) -> NDArray:
    """[[0, D], [-D', 0]]."""
    n, m = D.shape
    return np.block([[np.zeros((n, n)), D], [-D.T, np.zeros((m, m))]])


def _companion(tops: list[NDArray], bottom: NDArray) -> System:
    """Transfer functions of one denominator; coefficients with the highest power first. The effort is x[0] + D v."""
    bottom = np.trim_zeros(bottom, "f")
    k, a = len(bottom) - 1, bottom / bottom[0]
    b = np.array([np.pad(top, (k + 1 - len(top), 0)) for top in tops]).T / bottom[0]
    A = np.eye(k, k=1)
    A[:, :1] -= a[1:, None]
    return System(A, b[1:] - np.outer(a[1:], b[0]), np.eye(1, k), b[:1])


def _admittance(node: Node, unit: float) -> tuple[NDArray, NDArray]:
    """Numerator and denominator of what stands at a node, lines apart; s counts in 1/unit."""
    if node.load is None:
        return np.array([node.conductance]), np.ones(1)
    p, q = (
        np.array([float(a) / unit**k for k, a in zip(range(len(side) - 1, -1, -1), side, strict=True)])
        for side in (node.load.numerator, node.load.denominator)
    )
    scale = max(np.abs(p).max(), np.abs(q).max())
    return np.polyadd(node.conductance * p, q) / scale, p / scale


def _half_cells(scene: Scene, nodes: dict[str, Node], cells: NDArray) -> list[tuple[Node, float]]:
    """Nodes and the capacitance of the half cells there."""
    half = np.repeat(_delays(scene) / cells / _z0(scene) / 2, 2)
    return [(node, float(half[node.ends].sum())) for node in nodes.values()]


def _on_capacitor(node: Node, capacitance: float, unit: float) -> System:
    """From the flows into a node with a capacitance to its effort."""
    if node.held:
        return HELD
    over, under = _admittance(node, unit)
    return _companion([under, under], np.polyadd(np.append(capacitance / unit * under, 0.0), over))


def _behind_inductor(node: Node, inductance: float, unit: float) -> System:
    """From the effort behind an inductance, in units of time times z0, and the flow of the sources to the effort."""
    if node.held:
        return HELD
    over, under = _admittance(node, unit)
    source = np.append(inductance * under, 0.0) if node.flows else np.zeros(1)
    return _companion([under, source], np.polyadd(under, np.append(inductance * over, 0.0)))


def _pushes_inductors(scene: Scene) -> str | None:
    for source in scene.sources.values():
        node = nodes_of(scene)[source.at]
        if node.held is None and node.conductance == 0.0:
            return f"node '{source.at}': an ideal flow would have to jump in the inductances there"
    return None


def _integrated(
    scene: Scene, n: float, chains: list[Chain], systems: list[System], order: int, thevenin: bool = False
) -> Trace:
    """Join lines and nodes, and integrate to a hundredth of the error that the sections leave."""
    from scipy import sparse
    from scipy.linalg import block_diag

    nodes, unit = nodes_of(scene), _shortest(scene)
    at = node_of_end(nodes.values())
    select = sparse.csr_array((np.ones(len(at)), (range(len(at)), at)), (len(at), len(nodes)))
    lines = sparse.block_diag([chain.A for chain in chains], "csr")
    b = sparse.block_diag([chain.b for chain in chains], "csr") @ select
    c = select.T @ sparse.block_diag([chain.c for chain in chains], "csr")
    own, out = (sparse.csr_array(block_diag(*(s[k] for s in systems))) for k in (0, 2))
    by_lines, by_sources = (sparse.csr_array(block_diag(*(s.B[:, k : k + 1] for s in systems))) for k in (0, 1))
    through, directly = (sparse.diags_array([s.D[0, k] for s in systems]) for k in (0, 1))
    A = sparse.block_array([[lines + b @ through @ c, b @ out], [by_lines @ c, own]], format="csr")
    B = sparse.vstack([b @ directly, by_sources], format="csr")
    efforts = sparse.hstack([through @ c, out], format="csr")
    parts = [node.drives if thevenin or node.held else node.flows for node in nodes.values()]
    return _solved(scene, A, B, efforts, directly, parts, unit / n, 0.01 * n**-order)


def _solved(scene: Scene, A, B, efforts, directly, parts: list, dt: float, rtol: float) -> Trace:
    """x' = A x + B v from rest with time in shortest delays; efforts x + directly v at every step.

    Explicitly (DOP853), or implicitly (Radau) where a load is far faster than the sections.
    """
    from scipy.integrate import solve_ivp

    steps, unit = _steps(scene, dt), _shortest(scene)
    _within(max(steps * len(parts), A.nnz), MOST_KEPT)
    t, evaluations = np.arange(steps + 1) * dt, 0
    breaks = np.unique(np.round(np.concatenate([[], *(w.breaks(t[-1]) for row in parts for w, _ in row)]) / dt, 9))
    edges = [0.0, *breaks[(breaks > 0) & (breaks < steps)] * dt, t[-1]]
    begun = time.perf_counter()
    v = np.array([_sampled(row, t, dt) for row in parts])
    x, u = np.zeros(A.shape[0]), directly @ v
    sizes = [np.abs(_sampled(node.drives, t, dt)).max() for node in nodes_of(scene).values()]
    atol = rtol * max(*sizes, TINY)  # states are efforts, or flows times z0
    stiff = abs(A).sum(axis=1).max() > STIFF * unit / dt
    method, jacobian = ("Radau", {"jac": A}) if stiff else ("DOP853", {})
    driven = [k for k, row in enumerate(parts) if row]
    pushes = B.tocsc()[:, driven].tocsr()

    def rate(now: float, x: NDArray) -> NDArray:
        nonlocal evaluations
        evaluations += 1
        if evaluations > MOST_EVALUATIONS:
            problem = f"{MOST_EVALUATIONS:,} evaluations do not reach the end: too many sections, or too stiff a load"
            raise InputError("n", problem)
        at = np.array(now * unit)
        v = [sum(factor * float(w.value(at, inside)) for w, factor in parts[k]) for k in driven]
        return A @ x + pushes @ np.array(v)

    for start, stop in pairwise(edges):
        inside = np.array((start + stop) / 2)
        here = np.flatnonzero((t > start + 1e-9 * dt) & (t <= stop + 1e-9 * dt))
        wanted = np.unique(np.append(np.minimum(t[here], stop), stop) / unit)
        with np.errstate(over="ignore", invalid="ignore"):
            run = solve_ivp(rate, (start / unit, stop / unit), x, method, wanted, rtol=rtol, atol=atol, **jacobian)
        if not run.success:  # the waves grew beyond all bounds
            u[:, t > start] = np.inf
            break
        u[:, here] += efforts @ run.y[:, : len(here)]
        x = run.y[:, -1]
    seconds = time.perf_counter() - begun
    return Trace(t, dict(zip(scene.probes, u[_probed(scene)], strict=True)), seconds)


# ---------------------------------------------------------------------------------------------------- slabs


def pointwise(basis: Any, f: float) -> tuple[NDArray, NDArray]:
    """In place of `Basis.shift`: the delayed wave read off at the points."""
    late = (basis.c < f)[:, None]
    return np.where(late, 0.0, basis.evaluation(basis.c - f)), np.where(late, basis.evaluation(basis.c - f + 1), 0.0)


def projected(waveform: Shape, breaks: NDArray, basis: Basis, h: float, first: int, n: int) -> NDArray:
    """A waveform at the Radau points of n slabs from number `first` on, shape (n, s).

    Without breakpoints that travel a slab with a jump is L2-projected: that keeps the moments across it, so that what
    passes it is right again at the slab's end.
    """
    start = (first + np.arange(n)) * h
    values = sampled(waveform, basis, h, first, n)
    place = breaks[(breaks > start[0]) & (breaks < start[-1] + h)] / h - first
    near = place - np.floor(place)
    place = place[(near > EDGE) & (near < 1 - EDGE)]
    if not place.size:
        return values
    cut = np.unique(np.floor(place))
    edges = np.unique(np.concatenate([cut, place, cut + 1]))
    slab = np.floor((edges[:-1] + edges[1:]) / 2)
    of_cut = np.isin(slab, cut)  # the others lie between cut slabs
    slab, p, width = slab[of_cut].astype(int), edges[:-1][of_cut], np.diff(edges)[of_cut]
    x, weights = gauss(basis.s + 4)
    t = (p - slab)[:, None] + width[:, None] * x  # in slab time, shape (pieces, nodes)
    seen = waveform.value(start[slab][:, None] + h * t, start[slab][:, None] + h * (p - slab + width / 2)[:, None])
    moments = basis.moments(t.ravel(), (width[:, None] * weights).ravel())
    values[cut.astype(int)] = 0.0
    np.add.at(values, slab, (moments * seen.ravel()).reshape(basis.s, *t.shape).sum(axis=2).T)
    return values


def slabs_pointwise(scene: Scene, n: float, order: int = 4, offset: float = HALF) -> Trace:
    """The slabs of the production method, with interpolation in place of the projection; n slabs per delay."""
    from tline.scene.scene import Solver
    from tline.solver.assemble import assemble
    from tline.solver.kernel import advance

    h = _shortest(scene) / (n + offset)
    steps = _steps(scene, h)
    probed = {name: _a_line_at(scene, probe.at) for name, probe in scene.probes.items()}
    _within(4 * len(probed) * steps * order, MOST_KEPT)
    cut = scene.model_copy(update={"solver": Solver.model_validate({"order": order, "slab": h})})
    assembly = assemble(cut, {line for line, _ in probed.values()})
    rests = _delays(scene) / h - assembly.network.delay
    shift = np.array([pointwise(assembly.basis, f) for f in rests])
    rows = np.where(assembly.network.shift_row < 0, -1, np.arange(len(rests)))
    network = assembly.network._replace(shift=shift, shift_row=rows)
    record = np.full((2 * len(assembly.recorded), 2, steps * order), np.inf)  # what stays so grew beyond all bounds
    advance(network, assembly.state, 0, np.zeros((len(assembly.drives), 0)), record, 0)
    begun = time.perf_counter()
    drive = np.zeros((len(assembly.drives), steps, order))
    for row, parts in zip(drive, assembly.drives, strict=True):
        for waveform, share in parts:
            row += share * projected(waveform, waveform.breaks(steps * h), assembly.basis, h, 0, steps)
    advance(network, assembly.state, steps, drive.reshape(len(drive), -1), record, 0)
    seconds = time.perf_counter() - begun
    at_ends = record[:, :, order - 1 :: order] / 2
    u = {
        name: np.append(0.0, at_ends[assembly.recorded[line] + side].sum(axis=0))
        for name, (line, side) in probed.items()
    }
    return Trace(np.arange(steps + 1) * h, u, seconds)


def _a_line_at(scene: Scene, node: str | None) -> tuple[str, int]:
    return next((name, side) for name, line in scene.lines.items() for side in (0, 1) if line.nodes[side] == node)


# ------------------------------------------------------------------------------------------- what all share


def _delays(scene: Scene) -> NDArray:
    return np.array([line.parameters.delay or 0.0 for line in scene.lines.values()])


def _z0(scene: Scene) -> NDArray:
    return np.array([line.parameters.z0 for line in scene.lines.values()])


def _decays(scene: Scene) -> NDArray:
    """Resistance over inductance of each line."""
    series = [line.losses.exact.series if line.losses else None for line in scene.lines.values()]
    return np.array([law.loss / law.storage if law else 0.0 for law in series])


def _shortest(scene: Scene) -> float:
    return float(_delays(scene).min())


def _steps(scene: Scene, dt: float) -> int:
    return ceil(scene.t_end / dt - 1e-9)


def _grid(scene: Scene, dt: float, courant: float) -> NDArray:
    """Cells of each line, as many as the Courant number allows."""
    return np.maximum(np.floor(courant * _delays(scene) / dt + 1e-9), 1).astype(int)


def _sections(scene: Scene, n: float) -> NDArray:
    """Sections of each line, n on the shortest."""
    sections = np.ceil(n * _delays(scene) / _shortest(scene) - 1e-9).astype(int)
    _within(float(sections.max()) ** 2, MOST_KEPT)
    return sections


def _within(work: float, most: float) -> None:
    if work > most:
        problem = f"takes {work:.2g} numbers, for the delays are far apart or the run is long"
        raise InputError("n", problem, f"at most {most:.0e}")


def _probed(scene: Scene) -> list[int]:
    """Numbers of the nodes that the probes see."""
    names = list(dict.fromkeys(name for line in scene.lines.values() for name in line.nodes))
    return [names.index(str(probe.at)) for probe in scene.probes.values()]


def _sampled(parts: list, t: NDArray, dt: float) -> NDArray:
    """Sum of waveforms; at a jump the value before it."""
    return sum((factor * waveform.value(t, t - 1e-9 * dt) for waveform, factor in parts), np.zeros(len(t)))


def _stepped(scene: Scene, loop: Callable[..., None], dt: float, steps: int, parts: list) -> Trace:
    """Sample the sources and run a compiled loop, which is compiled before the clock starts."""
    seen, t = np.array(_probed(scene)), np.arange(steps + 1) * dt
    _within((steps + 1) * (len(parts) + len(seen)), MOST_KEPT)
    record = np.zeros((len(seen), steps + 1))
    loop(np.zeros((len(parts), 1)), seen, 0, record)
    begun = time.perf_counter()
    loop(np.array([_sampled(row, t, dt) for row in parts]), seen, steps, record)
    seconds = time.perf_counter() - begun
    return Trace(t, dict(zip(scene.probes, record, strict=True)), seconds)


RIVALS: dict[str, Rival] = {
    "moc_trapezoid": Rival("MOC, Courant 1", 1, 2, moc),
    "moc_forward_euler": Rival("MOC, loads by forward Euler", 1, 1, partial(moc, rule=forward_euler)),
    "moc_backward_euler": Rival("MOC, loads by backward Euler", 1, 1, partial(moc, rule=backward_euler)),
    "moc_linear": Rival("MOC, linear interpolation", 2, 2, partial(moc, weights=linear, offset=HALF)),
    "moc_cubic": Rival("MOC, cubic interpolation", 4, 2, partial(moc, weights=cubic, offset=HALF)),
    "moc_grid": Rival("MOC on a grid, Courant 1", 2, 2, moc_grid, _no_friction, "friction"),
    "upwind": Rival("upwind", 1, 1, upwind),
    "lax_wendroff": Rival("Lax-Wendroff", 2, 2, lax_wendroff),
    "fdtd": Rival("FDTD leapfrog", 2, 2, fdtd),
    "lumped_t": Rival("T sections", 2, 2, lumped_t, _pushes_inductors),
    "lumped_pi": Rival("π sections", 2, 2, lumped_pi, knows="resistance"),
    "pade": Rival("Padé sections", 3, 3, pade),
    "slabs_pointwise": Rival("slabs, pointwise, s = 4", 4, 4, slabs_pointwise),
}
