"""Simulate a scene: to a tolerance, by runs of rising order or on narrower slabs, or once as fixed by hand."""

import warnings
from collections.abc import Generator, Iterable
from dataclasses import replace

from tline.errors import ActiveError, InputError
from tline.scene.quantity import TOLERANCE
from tline.scene.scene import Scene
from tline.solver.accuracy import Accuracy, Attempt, apart, apart_inside, taken_as_errors, worst
from tline.solver.nodes import nodes_of
from tline.solver.resolution import Resolution, resolution
from tline.solver.result import Result
from tline.solver.run import run
from tline.solver.stability.growth import active_loads, growth_sentence

TOL = 1e-6  # where nothing is asked or fixed
FIRST, LAST = 2, 12  # orders
HELPS = 0.5  # a step that leaves more of the difference than this does not converge
STALE = 2  # halvings of the slab in a row that may bring nothing
MOST_SAMPLES, MOST_SECONDS = 3e9, 600  # line-end samples and stepping in all runs together


class UnresolvedWarning(UserWarning):
    """Something in the scene is faster than the slabs can follow."""


def simulate(
    scene: Scene,
    *,
    tol: float | None = None,
    record: Iterable[str] = (),
    active: bool = False,
    progress: bool = False,
) -> Result:
    """Simulate a scene from t = 0 to its end time.

    Order and slab are raised and narrowed until the estimated error of all probes is within the tolerance. The error
    of a run is its difference, at common slab ends, to the next finer one; the result is the run before the last.
    Where a higher order leaves more than half of the difference, the slab is halved instead. A scene that fixes order
    or slab by hand and asks for no tolerance is run once.

    Parameters
    ----------
    scene : Scene
        What to simulate.
    tol : float, 1e-13 to 0.1
        Largest error of effort and flow at slab ends, relative to their amplitudes at each probe, instead of the
        scene's ``solver.tol``; 1e-6 where there is neither.
    record : iterable of str
        Lines whose end waves are kept in addition to those of the probes.
    active : bool
        Run even with a load that is not positive real. What it does to the scene is then the first of the notes.
    progress : bool
        Show a progress bar on stderr if a run takes more than two seconds.

    Returns
    -------
    Result
        Probes, recorded lines, how it was computed, and how accurate it is: ``Result.accuracy``.

    Raises
    ------
    ActiveError
        A load is refuted to be positive real, and `active` is not set. Says whether the waves grow, and how fast.
    InputError
        The scene cannot be assembled, or an active load drove the waves beyond all bounds.

    Warns
    -----
    UnresolvedWarning
        A load or waveform is faster than the slabs can follow. ``Result.notes`` has these and other remarks.

    References
    ----------
    docs/theory.md has the scheme and the proof that it cannot create energy.

    Examples
    --------
    >>> scene = Scene(
    ...     medium="electrical", t_end="40 ns", probes={"far": {"at": "far"}},
    ...     lines={"line": {"nodes": ["near", "far"], "z0": 50, "delay": "5 ns"}},
    ...     sources={"s": {"at": "near", "kind": "voltage", "value": 1, "resistance": 20}},
    ...     loads={"c": {"at": "far", "kind": "parallel", "resistance": 100, "capacitance": "10 pF"}},
    ... )
    >>> result = simulate(scene, tol=1e-9)
    >>> result.accuracy.met, result.accuracy.estimates["far"].u < 1e-9
    (True, True)
    """
    warned, record = _active(scene, active), list(record)
    tol = _tolerance(scene, tol)
    if tol is None or (scene.solver.order and scene.solver.slab):
        result = run(scene, resolution(scene, nodes_of(scene)), record, progress=progress)
        result = replace(result, accuracy=tol and _by_hand(result, tol))
    else:
        result = _within(scene, tol, record, progress)
    for note in result.unresolved:
        warnings.warn(note, UnresolvedWarning, stacklevel=2)
    return replace(result, remarks=(*warned, *result.remarks))


def judged(result: Result) -> Accuracy:
    """How accurate a run fixed by hand is: its difference to one of the next order.

    Parameters
    ----------
    result : Result
        Of a run without a tolerance.
    """
    s, h = result.resolution.s, result.resolution.h
    better = run(result.scene, Resolution(s + 1, h, ()))
    estimates = taken_as_errors(apart(result, better))
    worst_of_all = Accuracy(None, estimates, ()).worst
    attempts = (_attempt(result, worst_of_all), _attempt(better))
    return Accuracy(None, estimates, attempts, apart_inside(result, better))


def _by_hand(result: Result, tol: float) -> Accuracy:
    found = judged(result)
    return replace(found, tol=tol, limit="" if found.worst <= tol else "order and slab are fixed by hand")


def _tolerance(scene: Scene, tol: float | None) -> float | None:
    """What is asked; None if order or slab are fixed by hand and nothing is."""
    by_hand = scene.solver.order is not None or scene.solver.slab is not None
    asked = scene.solver.tol
    if tol is not None:
        try:
            asked = TOLERANCE.parse(tol, "")
        except InputError as error:
            raise InputError("tol", error.problem, error.expected, error.got) from None
    return asked if asked is not None or by_hand else TOL


def _within(scene: Scene, tol: float, record: list[str], progress: bool) -> Result:
    """Run until the difference to the next finer run is within the tolerance, or a limit is reached."""
    steps, limit, stale, helps = _finer(scene), "", 0, True
    result, d = run(scene, next(steps), record, progress=progress), {}
    attempts, best, accuracy = [_attempt(result)], result, Accuracy(tol, {}, ())
    while not limit:
        try:
            finer = run(scene, steps.send(helps), record, progress=progress)
        except StopIteration:
            limit = "order and slab are as fine as they may be"
            break
        except InputError as error:
            limit = f"{error.where}: {error.problem}"
            break
        before, d = d, apart(result, finer)
        found = Accuracy(tol, taken_as_errors(d), (), apart_inside(result, finer))
        attempts[-1] = replace(attempts[-1], estimate=found.worst)
        attempts.append(_attempt(finer))
        if found.worst <= accuracy.worst:
            best, accuracy = result, found
        blind = finer.resolution.blind
        if before and found.met and not blind:
            break
        helps = not blind and (not before or worst(d) <= HELPS * worst(before))
        narrowed = finer.resolution.h < result.resolution.h
        stale = stale + 1 if narrowed and not blind and worst(d) >= worst(before) else 0
        limit = _limit(attempts, stale)
        result = finer
    damped = () if limit else best.resolution.notes  # that does not matter where the tolerance is met
    unresolved = tuple(note for note in best.unresolved if note not in damped)
    return replace(best, unresolved=unresolved, accuracy=replace(accuracy, attempts=tuple(attempts), limit=limit))


def _limit(attempts: list[Attempt], stale: int) -> str:
    """What forbids a finer run; empty if nothing does."""
    if sum(a.samples for a in attempts) + 2 * attempts[-1].samples > MOST_SAMPLES:
        return f"a finer run would take the total beyond {MOST_SAMPLES:.0e} line-end samples"
    if sum(a.seconds for a in attempts) + 2 * attempts[-1].seconds > MOST_SECONDS:
        return f"a finer run would take the total beyond {MOST_SECONDS} s"
    return "narrower slabs do not help" if stale == STALE else ""


def _finer(scene: Scene) -> Generator[Resolution, bool]:
    """Ever finer orders and slabs; what is sent in tells whether the last step helped."""
    nodes, solver = nodes_of(scene), scene.solver
    s = solver.order or FIRST
    chosen = resolution(scene, nodes, s)
    h = chosen.h
    while True:
        helped = yield chosen
        if solver.order is None and s < LAST and (helped or solver.slab is not None):
            s += 1
        elif solver.slab is None:
            h /= 2
        else:
            return
        chosen = resolution(scene, nodes, s, h)


def _attempt(result: Result, estimate: float | None = None) -> Attempt:
    return Attempt(result.resolution.s, result.resolution.h, estimate, result.samples, result.seconds)


def _active(scene: Scene, allowed: bool) -> list[str]:
    """What there is to say of active loads, if they are allowed."""
    loads = active_loads(scene)
    if not loads:
        return []
    problem = growth_sentence(scene, loads)
    if not allowed:
        raise ActiveError("", problem, "passive loads, or active=True to run it all the same")
    return [problem]
