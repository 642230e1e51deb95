"""Simulate a scene: to a tolerance, by runs of rising order or on narrower slabs, or once as fixed by hand."""

import warnings
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from tline.errors import ActiveError, InputError
from tline.gc_paused import gc_paused
from tline.scene.file import as_scene
from tline.scene.quantity import SECONDS, TOLERANCE
from tline.scene.user_defined import user_elements, user_mistakes
from tline.solver.convolution.suited import is_slow, suits
from tline.solver.description.description import Description, describe
from tline.solver.description.given import Scene
from tline.solver.description.resolution import Resolution, resolution
from tline.solver.result.accuracy import Accuracy, Attempt
from tline.solver.result.merged import merged, recorded
from tline.solver.result.result import Result
from tline.solver.run import Again, refuse_mixing, run, with_ledger
from tline.solver.tolerance.compare import caution, differences, magnified
from tline.solver.tolerance.grids import Rounded, compared
from tline.solver.tolerance.ladder import Budget, Search, inside_slabs, refined
from tline.solver.tolerance.search import Orders, within
from tline.solver.witness.witness import Witness

TOL = 1e-6  # default, if nothing is asked or fixed
FOLLOWED = 1e-5, 1e-10  # of the largest wave: decays behind a front are followed down to this, where a run is judged
CLEAR = 10  # times that: larger differences have another cause


class UnresolvedWarning(UserWarning):
    """Something in the scene is faster than the slabs can follow."""


def simulate(
    scene: Scene | str | Path | Mapping[str, Any],
    *,
    tol: float | None = None,
    record: Iterable[str] = (),
    envelope: bool = False,
    ledger: bool | None = None,
    active: bool = False,
    progress: bool = False,
    seconds: float | str | None = None,
) -> Result:
    """Simulate a scene from t = 0 to its end time.

    Order and slab are raised and narrowed until the estimated error of all probes, at any instant, is within the
    tolerance. The error of a run is its difference to the next finer one, which is the result: it is better by far, and
    the difference is a bound. Where a higher order leaves more than half of the difference, the slab is halved instead;
    where laws kink, slabs are cut in pieces. Lines far shorter than a slab are lumped, each in as many LC sections as
    the tolerance needs: the next finer run has twice as many. A scene that fixes order or slab by hand and asks for no
    tolerance is run once.

    Losses of lines that depend on the present flow, such as a resistance or turbulent friction, act all along. Where
    all losses are linear and lines remember or leak, as by a skin effect, scenes are convolutions
    (`tline.solver.convolution`). Else friction, and circuits for the memory of lines, are in cells of many slabs
    (`tline.solver.kernel.diamonds`), of second order in their width, which is halved with each run.

    Parameters
    ----------
    scene : Scene, path or dict
        A scene, the path of a file that `read` reads, or its tables.
    tol : float, 1e-13 to 0.1
        Largest error of effort and flow at any instant, relative to their amplitudes at each probe, instead of the
        scene's ``solver.tol``; 1e-6 where there is neither.
    record : iterable of str
        Lines whose end waves are kept in addition to those of the probes.
    envelope : bool
        Keep the lowest and the highest effort at every node, and when: ``Result.envelope``.
    ledger : bool, optional
        Account for energies that every line and element gave, took and stored: ``Result.ledger``. If not given that is
        done when the ledger or the notes are first read, unless it takes more than about half a second, and never with
        coupled conductors. Always done where there are user-defined elements, so that one which makes energy is
        reported.
    active : bool
        Run even with a load that is not positive real. Its effect on the scene is then the first of the notes.
    progress : bool
        Show a progress bar on stderr if assembling the scene, or a run, takes more than two seconds, and print the time
        that all runs are expected to take.
    seconds : float or str, optional
        Computing time for all runs, above 0; ten minutes if not given. When a further run is expected to end later, the
        best so far is the result, with its estimated error; at least two are made, for an estimate takes two.

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
    >>> bool(abs(result.probes["far"].at(12.34e-9).u) <= 2), result.accuracy.worst <= 1e-9  # at any instant
    (True, True)
    """
    budget = Budget(None if seconds is None else as_seconds(seconds), progress)
    with gc_paused():
        description = describe(as_scene(scene))
        each = description, asked(description.scene, tol) or 0.0, [*record], progress, budget
        return simulated(Search(*each, envelope=envelope, ledger=ledger, active=active))


def simulated(search: Search) -> Result:
    """Simulate a described scene as `simulate` does."""
    with user_mistakes(search.description.scene):
        result = _of_parts(search) if search.description.stretches else _searched(search)
    for note in result.unresolved:
        warnings.warn(note, UnresolvedWarning, stacklevel=3)
    return result


def as_seconds(given: float | str) -> float:
    """Return the time for runs that a user gives, s."""
    try:
        return float(SECONDS.parse(given, "s"))
    except InputError as error:
        raise InputError("seconds", error.problem, error.expected, error.got) from None


def _of_parts(search: Search) -> Result:
    """Run the parts in place of lines in stretches."""
    whole = search.description
    parts = search._replace(description=whole.parted(), record=recorded(whole, search.record), start=None)
    return merged(_searched(parts), whole)


def _searched(search: Search) -> Result:
    description, scene, tol = search.description, search.description.scene, search.tol
    if search.ledger:
        description.refuse_coupled("a ledger")
    warned = _active(description, search.active)
    ledger = True if user_elements(scene) else search.ledger
    if not tol or (scene.solver.slab and (scene.solver.order or scene.solver.rounded or description.dispersive)):
        asked_for = description, resolution(description), search.record
        result = run(*asked_for, envelope=search.envelope, ledger=bool(ledger), progress=search.progress)
        if tol:
            found = replace(judged(result), tol=tol)
            limit = inside_slabs(found) or ("" if found.worst <= tol else "order and slab are fixed by hand")
            result = replace(result, accuracy=replace(found, limit=limit))
    elif scene.solver.rounded:
        result = refined(Rounded(search))
    else:
        key, anew = (tol, frozenset(search.record)), search.envelope or search.start
        known = None if anew else description.known.get(key)
        if known:  # to the last bit
            again, told = known
            result = replace(again.result(description, search.record, search.progress), **told)
        else:
            result = _found(search)
            stopped = search.budget.asked and not (result.accuracy and result.accuracy.met)
            once = stopped or anew or description.dispersive or result.resolution.convolved
            if isinstance(result.accounts, Again) and not (once or user_elements(scene)):
                told = {"accuracy": result.accuracy, "unresolved": result.unresolved}
                description.known[key] = result.accounts, told
    result = with_ledger(result, ledger)
    return replace(result, warned=tuple(warned)) if warned else result


def _found(search: Search) -> Result:
    """Return the result of a search for order and slab, after a second look by other means."""
    witness = None if search.start else Witness(search.description, search.record)
    wider = search._replace(record=[*search.record, *(witness.lines if witness else ())])
    result = _convolved(wider)
    if result is None:
        refuse_mixing(search.description)
        result = refined(Orders(wider)) if search.description.dispersive else within(wider)
    if witness is None:
        return result
    kept = {*search.record, *search.description.probed}
    lines = {name: line for name, line in result.lines.items() if name in kept}
    return replace(witness.heard(result), lines=lines)


def _convolved(search: Search) -> Result | None:
    if not (suits(search.description) or is_slow(search.description)):
        return None
    from tline.solver.tolerance.convolved import convolved

    return convolved(search)


def judged(result: Result) -> Accuracy:
    """How accurate a run fixed by hand is: its difference to one of the next order, or on half the slab with losses.

    Where a load may be too fast for both, a further step shows whether their difference is due to that.
    """
    description = describe(result.scene).parted()
    if result.resolution.rounded:
        both = [run(description, resolution(description, h=result.resolution.h / k), envelope=True) for k in (1, 2)]
        found = compared(None, *both)
        return replace(found, attempts=(Attempt.of(both[0], found.worst), Attempt.of(both[1])))

    def step(coarse: Result, followed: float = FOLLOWED[0]) -> tuple[Result, Accuracy]:
        s, h = coarse.resolution.s, coarse.resolution.h
        narrower = description.dispersive or description.mixed
        cell = coarse.resolution.cell / 2
        chosen = Resolution(s, h / 2, cell=cell) if narrower else Resolution(s + 1, h, layers=followed, cell=cell)
        with user_mistakes(result.scene):
            fine = run(description, chosen)
        found = Accuracy(None, *differences(coarse, fine))
        if not fine.resolution.layers or followed == FOLLOWED[-1] or found.worst >= CLEAR * followed:
            return fine, found
        return step(coarse, FOLLOWED[-1])

    finer, found = step(result)
    runs, by = [finer], magnified(description, result, finer, [found.worst])
    if by > 1.0:
        finest, left = step(finer)
        runs.append(finest)
        if magnified(description, finer, finest, [found.worst, left.worst]) == 1.0:
            by = 1.0
    found = found.times(caution(found) * by)
    return replace(found, attempts=(Attempt.of(result, found.worst), *map(Attempt.of, runs)))


def asked(scene: Scene, tol: float | None) -> float | None:
    """The tolerance that is asked; None if order or slab are fixed by hand and none is."""
    by_hand = scene.solver.order is not None or scene.solver.slab is not None
    found = scene.solver.tol
    if tol is not None:
        try:
            found = TOLERANCE.parse(tol, "")
        except InputError as error:
            raise InputError("tol", error.problem, error.expected, error.got) from None
    return found if found is not None or by_hand else TOL


def _active(description: Description, allowed: bool) -> list[str]:
    if not description.active:
        return []
    from tline.solver.stability.growth import growth_sentence

    problem = growth_sentence(description)
    if not allowed:
        raise ActiveError("", problem, "passive elements, or active=True to run it all the same")
    return [problem]
