"""Many runs of one scene: copies side by side in the kernel, slabs and loads' maps of their own for each copy."""

import time
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from math import ceil, inf

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tline.errors import InputError
from tline.scene.mistakes import place
from tline.scene.quantity import Role
from tline.scene.scene import Scene
from tline.solver.accuracy import ROUNDING, SILENT
from tline.solver.many.copies import Copies, copies_of
from tline.solver.many.load import Load
from tline.solver.many.period import breaks_of, driven_waves, load_maps, slab_edges
from tline.solver.many.track import Track
from tline.solver.radau import basis
from tline.solver.simulate import TOL, UnresolvedWarning

Floats = NDArray[np.float64]
ORDERS, HIGHER = (4, 6, 8, 10), 2  # and what is added for the run to compare with
MOST_POINTS = 256  # in a period: a load's map has their square
COMPARED, SPREAD = 16, 101  # copies and instants at which runs are compared
BATCH, CHUNK = 64, 1024  # copies in the kernel at once: so many fit the cache; and copies set up at once
ROOM, LARGEST = 8e6, 4e8  # samples in a chunk's record, and in what is handed back
TOLERANCE = Role("tolerance", "", at_least=1e-10, at_most=0.1)


@dataclass(frozen=True, eq=False)
class Seen:
    """What one probe saw in all copies; Pa and m³/s, or V and A.

    Attributes
    ----------
    u, y : ndarray, shape (copies, instants)
        Effort and flow at the instants asked for.
    lowest, highest : ndarray, shape (copies,)
        Smallest and largest effort from t = 0, where it is zero, to the end.
    lowest_at, highest_at : ndarray, shape (copies,)
        When they are first reached, s.
    """

    u: Floats
    y: Floats
    lowest: Floats
    lowest_at: Floats
    highest: Floats
    highest_at: Floats


@dataclass(frozen=True, eq=False)
class Many:
    """Finished runs of all copies.

    Attributes
    ----------
    t : ndarray, shape (instants,)
        The instants asked for, s.
    probes : mapping of str to Seen
        By name of the probe.
    order : int
        Points in a slab.
    slabs : int
        Slabs in a period, the common measure of a copy's delays.
    estimate : float
        Largest difference to the next higher order, at any instant and in the extremes, relative to the amplitude, in
        a sample of the copies that holds the smallest and the largest of each number that varies.
    seconds : float
        Time of the runs, those for the estimate left out.
    """

    t: Floats
    probes: Mapping[str, Seen]
    order: int
    slabs: int
    estimate: float
    seconds: float


def many(scene: Scene, vary: Mapping[str, ArrayLike], *, times: ArrayLike = (), tol: float | None = None) -> Many:
    """Run copies of a scene in which numbers vary, all in one call.

    Every copy has slabs of its own, at whose edges all fronts pass, so that answers are as accurate between slabs' ends
    as at them. Order and slabs are refined on a sample of copies until the estimated error is within the tolerance.

    Parameters
    ----------
    scene : Scene
        From rest; single lossless lines in any topology, whose delays are whole multiples of a common measure; sources;
        resistances, R, L and C in series or parallel, reservoirs, shorts, open and matched ends; probes at nodes.
    vary : mapping of str to array_like, shape (copies,)
        Numbers in SI, one for each copy, by their place in the scene: ``lines.NAME.z0`` and ``lines.NAME.delay``
        (whatever the line was given by), ``sources.NAME.resistance``, and ``resistance``, ``inductance`` and
        ``capacitance`` of ``loads.NAME``. All are above zero. The delays of a copy keep their proportions.
    times : array_like, shape (instants,)
        From 0 to the end of the run, s, at which effort and flow are wanted.
    tol : float, 1e-10 to 0.1
        Largest error relative to the amplitude, instead of the scene's ``solver.tol``; 1e-6 where there is neither.

    Returns
    -------
    Many
        What each probe saw, and how accurate it is.

    Raises
    ------
    InputError
        The scene holds something else, a number may not vary or is out of range, or an instant is not in the run.

    Warns
    -----
    UnresolvedWarning
        The tolerance is not met: a load is too fast for the slabs.

    References
    ----------
    docs/many-runs.md says how, and what it was checked against.

    Examples
    --------
    >>> scene = Scene(
    ...     medium="electrical", t_end="40 ns", probes={"far": {"at": "far"}},
    ...     lines={"line": {"nodes": ["near", "far"], "z0": 50, "delay": "5 ns"}},
    ...     sources={"s": {"at": "near", "kind": "voltage", "value": 1, "resistance": 20}},
    ... )
    >>> runs = many(scene, {"lines.line.z0": [40.0, 50.0, 60.0]})
    >>> runs.probes["far"].highest.round(9).tolist()  # 2 z0/(z0 + 20)
    [1.333333333, 1.428571429, 1.5]
    """
    copies, breaks, t = copies_of(scene, vary), breaks_of(scene), _instants(scene, times)
    tol = _tolerance(scene, tol)
    order, parts, estimate = _resolution(scene, vary, copies, breaks, tol)
    edges = slab_edges(breaks, copies.unit, parts)
    samples = len(scene.probes) * len(copies.unit) * len(t)
    if samples > LARGEST:
        raise InputError("times", f"{samples:.2g} samples are too many", f"at most {LARGEST:.0e}")
    started = time.perf_counter()
    probes = _run(scene, copies, edges, order, np.arange(len(copies.unit)), t)
    seconds = time.perf_counter() - started
    if estimate > tol:
        problem = f"estimated error {estimate:.1g} is above the tolerance of {tol:.1g}: a load is too fast for many runs"
        warnings.warn(problem, UnresolvedWarning, stacklevel=2)
    return Many(t, probes, order, len(edges) - 1, estimate, seconds)


def _instants(scene: Scene, times: ArrayLike) -> Floats:
    t = np.atleast_1d(np.asarray(times, float))
    outside = t[~((t >= 0) & (t <= scene.t_end))]
    if t.ndim != 1 or len(outside):
        got = f"{outside[0]:g} s" if len(outside) else f"{t.ndim} axes"
        raise InputError("times", "not instants of the run", f"an array of 0 to {scene.t_end:g} s", got)
    return t


def _tolerance(scene: Scene, tol: float | None) -> float:
    asked = tol if tol is not None else scene.solver.tol if scene.solver.tol is not None else TOL
    try:
        return TOLERANCE.parse(asked, "")
    except InputError as error:
        raise InputError("tol", error.problem, error.expected, error.got) from None


def _resolution(
    scene: Scene, vary: Mapping[str, ArrayLike], copies: Copies, breaks: Floats, tol: float
) -> tuple[int, int, float]:
    """Order, least number of slabs in a period, and estimated error."""
    values = [np.asarray(numbers, float) for numbers in vary.values()]
    ends = [pick(numbers) for numbers in values for pick in (np.argmin, np.argmax)]
    rows = np.unique([*ends, *np.linspace(0, len(copies.unit) - 1, COMPARED).astype(int)])
    t = np.linspace(0.0, float(scene.t_end), SPREAD)
    best, parts = (ORDERS[0], 1, inf), 1
    while True:
        edges = slab_edges(breaks, copies.unit, parts)
        coarse = None
        for s in (*ORDERS, ORDERS[-1] + HIGHER):
            if (len(edges) - 1) * s > MOST_POINTS:
                return best
            fine = _run(scene, copies, edges, s, rows, t)
            if coarse is not None:
                estimate = _apart(scene, copies, rows, coarse, fine)
                best = min(best, (s - HIGHER, parts, estimate), key=lambda found: found[2])
                if estimate <= tol:
                    return s - HIGHER, parts, estimate
            coarse = fine
        parts *= 2


def _apart(
    scene: Scene, copies: Copies, rows: NDArray, coarse: Mapping[str, Seen], fine: Mapping[str, Seen]
) -> float:
    """Largest difference of two runs relative to the amplitude of each copy."""
    worst = ROUNDING
    for name, seen in fine.items():
        other, z0 = coarse[name], copies.z0[list(scene.lines).index(scene.probed_line(name)), rows]
        amplitude = np.maximum(-seen.lowest, seen.highest)
        flow = z0 * np.abs(seen.y).max(axis=1)
        pairs = [(seen.u, other.u), (seen.lowest[:, None], other.lowest[:, None])]
        pairs += [(seen.highest[:, None], other.highest[:, None])]
        efforts = np.max([np.abs(a - b).max(axis=1) for a, b in pairs], axis=0)
        flows = z0 * np.abs(seen.y - other.y).max(axis=1)
        for difference, scale in ((efforts, amplitude), (flows, flow)):
            heard = scale > SILENT * np.maximum(amplitude, flow)
            worst = max(worst, float((difference[heard] / scale[heard]).max(initial=0.0)))
    return worst


def _run(scene: Scene, copies: Copies, edges: Floats, s: int, rows: NDArray, t: Floats) -> dict[str, Seen]:
    """Run some copies at order s, with slabs at these edges of all."""
    where = _line_ends(scene)
    recorded = sorted({*where.values()})
    most = _periods(scene, copies.unit[rows].min()) * (len(edges) - 1) * s
    B = min(BATCH, len(rows))
    chunk = B * int(np.clip(ROOM / (B * (most * 2 * len(recorded) + len(t) * s)), 1, CHUNK / B))
    found = {name: [np.empty((len(rows), *shape)) for shape in 2 * [(len(t),)] + 4 * [()]] for name in where}
    by_unit = np.argsort(copies.unit[rows], kind="stable")
    for low in range(0, len(rows), chunk):
        mine = by_unit[low : low + chunk]
        mine = np.pad(mine, (0, -len(mine) % B), mode="edge").reshape(-1, B)  # the last copy fills the last batch
        track, waves = _recorded(scene, copies, edges, s, rows[mine], recorded)
        for name, end in where.items():
            arrived, left = waves[:, recorded.index(end), 0], waves[:, recorded.index(end), 1]
            sign = 2 * (end % 2) - 1  # what arrives at end 2 is a, at end 1 it is b
            p, q = track.at(t, arrived, left)
            z0 = copies.z0[end // 2, rows[mine], None]
            seen = (p + q) / 2, sign * (p - q) / (2 * z0), *track.extremes((arrived + left) / 2)
            for array, values in zip(found[name], seen, strict=True):
                array[mine] = values
    return {name: Seen(*arrays) for name, arrays in found.items()}


def _periods(scene: Scene, unit: float) -> int:
    return max(ceil(scene.t_end / unit - 1e-9), 1)


def _line_ends(scene: Scene) -> dict[str, int]:
    """Number of the line end that each probe sees."""
    lines, ends = list(scene.lines), {}
    for name, probe in scene.probes.items():
        line = scene.probed_line(name)
        share = probe.fraction(scene.lines[line])
        if share not in (0.0, 1.0):
            raise InputError(place("probes", name), "inside a line", "a probe at a node, for many runs")
        ends[name] = 2 * lines.index(line) + int(share)
    return ends


def _recorded(
    scene: Scene, copies: Copies, edges: Floats, s: int, rows: NDArray, recorded: list[int]
) -> tuple[Track, Floats]:
    """Run copies (batches, B): what arrived and left at line ends, shape (batches, ends, 2, points, B)."""
    from tline.solver.kernel import advance_copies

    order, unit, junctions = basis(s), copies.unit[rows], copies.junctions
    n = _periods(scene, unit.min())
    edges = np.ascontiguousarray(edges[:, rows].transpose(1, 0, 2))
    track = Track(order, unit, edges, n, scene.t_end)
    widths = np.diff(edges, axis=1) * unit[:, None]
    loads = [Load(*(part[..., rows] for part in junction.load)) for junction in junctions if junction.load is not None]
    states = max((len(load.A) for load in loads), default=0)
    maps = np.zeros((len(rows), len(loads), track.slabs, s + states, s + states, rows.shape[1]))
    for k, load in enumerate(loads):
        load_maps(load, order, widths, maps[:, k])
    drives = [[(shape, share[rows]) for shape, share in junction.drives] for junction in junctions if junction.drives]
    drive = driven_waves(drives, order, unit, edges, n, scene.t_end)
    weights = np.concatenate([junction.weights[:, rows] for junction in junctions]).transpose(1, 0, 2).copy()
    record_row = np.full(2 * len(copies.delay), -1)
    record_row[recorded] = np.arange(len(recorded))
    arrays = (
        copies.delay,
        np.cumsum([0, *(len(junction.ends) for junction in junctions)]),
        np.concatenate([junction.ends for junction in junctions]),
        _rows([bool(junction.drives) for junction in junctions]),
        _rows([junction.load is not None for junction in junctions]),
        record_row,
    )
    record = np.empty((len(rows), len(recorded), 2, n * track.slabs * s, rows.shape[1]))
    for batch in range(len(rows)):
        advance_copies(*arrays, weights[batch], maps[batch], drive[batch], n, record[batch])
    return track, record


def _rows(there: list[bool]) -> NDArray:
    """Numbers of those that are there, -1 for the others."""
    return np.where(there, np.cumsum(there) - 1, -1)
