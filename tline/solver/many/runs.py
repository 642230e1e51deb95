"""Many runs of one scene: copies side by side in the kernel, slabs and loads' maps of their own for each copy."""

import time
import warnings
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tline.errors import InputError
from tline.scene.quantity import Role
from tline.solver.description.description import describe
from tline.solver.description.given import Height, Scene
from tline.solver.many.batches import ProbeOfCopies, run
from tline.solver.many.copies import copies_of
from tline.solver.many.period import breaks_of
from tline.solver.many.resolve import resolve
from tline.solver.simulate import TOL, UnresolvedWarning
from tline.wording import shown

Floats = NDArray[np.float64]
LARGEST = 4e8  # samples handed back
TOLERANCE = Role("tolerance", "", at_least=1e-9, at_most=0.1)


@dataclass(frozen=True, eq=False)
class Many:
    """Finished runs of all copies.

    Attributes
    ----------
    t : ndarray, shape (instants,)
        The instants asked for, s.
    probes : mapping of str to ProbeOfCopies
        By name of the probe.
    order : int
        Points in a slab.
    slabs : int
        Slabs in a period, the common measure of a copy's delays.
    estimate : float
        Largest difference to the next higher order, at any instant and in the extremes, relative to the amplitude, in
        a sample of the copies that holds the smallest and the largest of each number that varies.
    seconds, processor : float
        Time of the runs, and of all cores for them; those for the estimate left out.
    heights : mapping of str to Height
        By name of the probe: a gauge pressure is the effort less its weight.
    """

    t: Floats
    probes: Mapping[str, ProbeOfCopies]
    order: int
    slabs: int
    estimate: float
    seconds: float
    processor: float
    heights: Mapping[str, Height]


def many(scene: Scene, vary: Mapping[str, ArrayLike], *, times: ArrayLike = (), tol: float | str | None = None) -> Many:
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
    tol : float or str, 1e-9 to 0.1
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
    description = describe(scene)
    copies, breaks, t = copies_of(description, vary), breaks_of(description), _instants(scene, times)
    tol = _tolerance(scene, tol)
    edges, order, estimate = resolve(description, vary, copies, breaks, tol)
    samples = len(scene.probes) * len(copies.unit) * len(t)
    if samples > LARGEST:
        raise InputError("times", f"{samples:.2g} samples are too many", f"at most {LARGEST:.0e}")
    started, begun = time.perf_counter(), time.process_time()
    probes = run(description, copies, edges, order, np.arange(len(copies.unit)), t)
    seconds, processor = time.perf_counter() - started, time.process_time() - begun
    if estimate > tol:
        problem = f"the estimated error of {estimate:.1g} is above the tolerance of {tol:.1g}"
        warnings.warn(f"{problem}: a load is too fast for many runs", UnresolvedWarning, stacklevel=2)
    heights = {name: probe.height for name, probe in description.probes.items()}
    return Many(t, probes, order, len(edges) - 1, estimate, seconds, processor, heights)


def _instants(scene: Scene, times: ArrayLike) -> Floats:
    try:
        t = np.atleast_1d(np.asarray(times, float))
    except (TypeError, ValueError):
        raise InputError("times", "not numbers", "an array of instants in s", shown(times)) from None
    outside = t[~((t >= 0) & (t <= scene.t_end))]
    if t.ndim != 1 or len(outside):
        got = f"{outside[0]:g} s" if len(outside) else f"{t.ndim} axes"
        raise InputError("times", "not instants of the run", f"an array of 0 to {scene.t_end:g} s", got)
    return t


def _tolerance(scene: Scene, tol: float | str | None) -> float:
    asked = tol if tol is not None else scene.solver.tol if scene.solver.tol is not None else TOL
    try:
        return TOLERANCE.parse(asked, "")
    except InputError as error:
        raise InputError("tol", error.problem, error.expected, error.got) from None
