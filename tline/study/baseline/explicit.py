"""Methods that step in time: characteristics, upwind, Lax and Wendroff, leapfrog."""

import time
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tline.scene.rational import RationalImpedance
from tline.scene.scene import Scene
from tline.scene.solver import Solver
from tline.solver.assembly.assemble import assemble
from tline.solver.description.description import describe
from tline.solver.description.excitation import EDGE, Waveform, sampled
from tline.solver.description.nodes import node_of_end
from tline.solver.loop.march import advance
from tline.solver.radau import Basis, gauss
from tline.solver.steady.steady_state import rest, steady_state
from tline.study.baseline.loops import advance_cells, advance_fdtd, advance_moc
from tline.study.baseline.method import (
    COURANT,
    HALF,
    MOST_KEPT,
    MOST_WORK,
    BaselineRun,
    Euler,
    cells_of,
    count_steps,
    delays_of,
    half_sections,
    impedances_of,
    on_capacitor,
    probed,
    scattering,
    shortest_delay,
    stepped,
    trapezoid,
    within,
)
from tline.study.reference.friction import extrapolated
from tline.study.reference.grid import joined, march
from tline.words.wording import place

Weights = Callable[[float], tuple[float, float, float, float]]


def nearest(f: float) -> tuple[float, float, float, float]:
    """Weights of the samples 1 step late, on time, 1 and 2 steps early; here f is 0."""
    return 0.0, 1.0, 0.0, 0.0


def linear(f: float) -> tuple[float, float, float, float]:
    """Interpolate the wave a fraction f of a step before the sample on time, linearly."""
    return 0.0, 1.0 - f, f, 0.0


def cubic(f: float) -> tuple[float, float, float, float]:
    """Interpolate the wave a fraction f of a step before the sample on time by Lagrange's cubic."""
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
) -> BaselineRun:
    """Method of characteristics: the arriving wave is the one sent one delay ago.

    Without interpolation the delays are rounded to whole steps: the wave speeds are adjusted. `offset` adds to n; with
    `whole` all lines are delayed by that many steps, and the rest of the delay, of any size, is the fraction.
    """
    nodes, dt = describe(scene).nodes, shortest_delay(scene) / (n + offset)
    steps, delays = count_steps(scene, dt), delays_of(scene) / dt
    late = np.maximum(np.round(delays) if weights is nearest else np.floor(delays + 1e-9), 1).astype(int)
    late = late if whole is None else np.full(len(late), whole)
    taps = np.array([weights(f) for f in (0.0 * delays if weights is nearest else delays - late)])
    within(2 * len(late) * (steps + late.max()), MOST_KEPT)
    net = scattering(scene, list(nodes.values()), dt, rule)
    loop = partial(advance_moc, net, late, taps)
    return stepped(scene, loop, dt, steps, [node.excitations for node in nodes.values()])


def moc_grid(scene: Scene, n: float) -> BaselineRun:
    """Staggered grid of characteristics, friction by the trapezoidal rule, fronts from nodes kept sharp.

    Delays are rounded to whole steps; points at whole steps alternate with points half a step later.
    """
    description, dt = describe(scene), shortest_delay(scene) / n
    steps, reaches = count_steps(scene, dt), np.maximum(np.round(delays_of(scene) / dt), 1).astype(int)
    within(2 * reaches.sum() * steps, MOST_WORK)
    losses = [line.losses for line in scene.single_lines.values()]
    each = description.nodes.values()
    at = {end: k for k, node in enumerate(each) for end in node.ends}
    pipes = joined(
        [at[end] for end in sorted(at)],
        np.array([node.held is not None for node in each]),
        np.array([node.conductance for node in each]),
        impedances_of(scene),
        np.array([x.quadratic * x.exact.length if x else 0.0 for x in losses]),
    )
    efforts, flows = steady_state(description) if description.steady else rest(description)[:2]
    start, t = np.array([efforts[node.name] for node in each]), np.arange(steps + 1) * dt
    begun = time.process_time()
    given = np.zeros((len(each), steps + 1, 2))
    for k, node in enumerate(each):
        for shape, factor in [(node.held, 1.0)] if node.held else node.flows:
            for side, near in enumerate((t - dt / 4, t + dt / 4)):
                given[k, :, side] += factor * shape.value(t, near)
    record = march(pipes, reaches, start, flows[:, 0], given, np.array(probed(scene)))[:, :, 0]
    seconds = time.process_time() - begun
    return BaselineRun(t, dict(zip(scene.probes, record, strict=True)), seconds)


def moc_extrapolated(scene: Scene, n: float) -> BaselineRun:
    """Richardson's extrapolation of two such grids, the coarser with n/2 steps."""
    coarse, fine = moc_grid(scene, n / 2), moc_grid(scene, n)
    u = {name: extrapolated([coarse.u[name][None], fine.u[name][None]])[0] for name in fine.u}
    return BaselineRun(coarse.t, u, coarse.seconds + fine.seconds)


def no_friction(scene: Scene) -> str | None:
    """Reason why a grid is of no use for a scene, or not applicable; None if it is."""
    for name, load in scene.loads.items():
        if isinstance(load, RationalImpedance):
            return f"{place('loads', name)}: has a state"
    frictionless = all(line.losses is None or line.losses.linear for line in scene.single_lines.values())
    return "without friction it is the same as without a grid" if frictionless else None


def upwind(scene: Scene, n: float, courant: float = COURANT) -> BaselineRun:
    """Upwind method: linear interpolation along the line, equivalent to MOC at Courant < 1."""
    return _cells(scene, n, courant, lambda C: C / 2)


def lax_wendroff(scene: Scene, n: float, courant: float = COURANT) -> BaselineRun:
    """Lax-Wendroff method: a parabola through the cell and both its neighbours; upwind in the last cell of a line."""
    return _cells(scene, n, courant, lambda C: C**2 / 2)


def _cells(scene: Scene, n: float, courant: float, diffusion: Callable[[NDArray], NDArray]) -> BaselineRun:
    nodes, dt = describe(scene).nodes, shortest_delay(scene) / n
    steps, cells = count_steps(scene, dt), cells_of(scene, dt, courant)
    within(2 * cells.sum() * steps, MOST_WORK)
    C = cells * dt / delays_of(scene)
    net = scattering(scene, list(nodes.values()), dt, trapezoid)
    loop = partial(advance_cells, net, cells, C, diffusion(C))
    return stepped(scene, loop, dt, steps, [node.excitations for node in nodes.values()])


def fdtd(scene: Scene, n: float, courant: float = COURANT) -> BaselineRun:
    """Leapfrog: effort at cell edges and whole steps, flow between; half a cell of every line belongs to its node."""
    nodes, dt = describe(scene).nodes, shortest_delay(scene) / n
    steps, cells = count_steps(scene, dt), cells_of(scene, dt, courant)
    within(2 * cells.sum() * steps, MOST_WORK)
    systems = [on_capacitor(node, half, dt) for node, half in half_sections(scene, nodes, cells)]
    m = max(len(system.A) for system in systems)
    maps = [trapezoid(system.A, system.B[:, 0]) for system in systems]
    x_x = np.array([np.pad(x, (0, m - len(x))) for x, _, _ in maps])
    x_i = np.array([np.pad(2 * half, (0, m - len(half))) for _, half, _ in maps])
    held = np.array([node.held is not None for node in nodes.values()])
    parts = [[(node.held, 1.0)] if node.held else node.flows for node in nodes.values()]
    C = cells * dt / delays_of(scene)
    loop = partial(advance_fdtd, cells, C, impedances_of(scene), node_of_end(nodes.values()), held, x_x, x_i)
    return stepped(scene, loop, dt, steps, parts)


def pointwise(basis: Any, f: float) -> tuple[NDArray, NDArray]:
    """Interpolate the delayed wave at the points, in place of `Basis.shift`."""
    late = (basis.c < f)[:, None]
    return np.where(late, 0.0, basis.evaluation(basis.c - f)), np.where(late, basis.evaluation(basis.c - f + 1), 0.0)


def projected(waveform: Waveform, breaks: NDArray, basis: Basis, h: float, first: int, n: int) -> NDArray:
    """Project a waveform to the Radau points of n slabs from number `first` on, shape (n, s).

    Without travelling breakpoints a slab with a jump is L2-projected: that keeps the moments across it, so that the
    wave after the jump is right again at the slab's end.
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


def slabs_pointwise(scene: Scene, n: float, order: int = 4, offset: float = HALF) -> BaselineRun:
    """Slabs of the production method, with interpolation in place of the projection; n slabs per delay."""

    h = shortest_delay(scene) / (n + offset)
    steps = count_steps(scene, h)
    probed = {name: _a_line_at(scene, probe.at) for name, probe in scene.probes.items()}
    within(4 * len(probed) * steps * order, MOST_KEPT)
    cut = scene.model_copy(update={"solver": Solver.model_validate({"order": order, "slab": h})})
    assembly = assemble(describe(cut), {line for line, _ in probed.values()})
    rests = delays_of(scene) / h - assembly.network.delay
    shift = np.array([pointwise(assembly.basis, f) for f in rests])
    rows = np.where(assembly.network.shift_row < 0, -1, np.arange(len(rests)))
    network = assembly.network._replace(shift=shift, shift_row=rows)
    record = np.full((2 * len(assembly.recorded), 2, steps * order), np.inf)  # entries left infinite: unbounded growth
    advance(network, assembly.state, 0, np.zeros((len(assembly.excitations), 0)), record, 0)
    begun = time.process_time()
    excitation = np.zeros((len(assembly.excitations), steps, order))
    for row, parts in zip(excitation, assembly.excitations, strict=True):
        for waveform, share in parts:
            row += share * projected(waveform, waveform.breaks(steps * h), assembly.basis, h, 0, steps)
    advance(network, assembly.state, steps, excitation.reshape(len(excitation), -1), record, 0)
    seconds = time.process_time() - begun
    at_ends = record[:, :, order - 1 :: order] / 2
    u = {
        name: np.append(0.0, at_ends[assembly.recorded[line] + side].sum(axis=0))
        for name, (line, side) in probed.items()
    }
    return BaselineRun(np.arange(steps + 1) * h, u, seconds)


def _a_line_at(scene: Scene, node: str | None) -> tuple[str, int]:
    return next((name, side) for name, line in scene.lines.items() for side in (0, 1) if line.nodes[side] == node)
