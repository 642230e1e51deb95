"""Runs of rising order, on narrower slabs and with more LC sections of lumped lines, until a tolerance is met."""

from collections.abc import Generator, Mapping, Sequence
from dataclasses import replace
from math import inf, log10
from typing import NamedTuple

from tline.errors import InputError, NoFlowError
from tline.solver.description.description import Description
from tline.solver.description.nodes import NONE
from tline.solver.description.resolution import FIT, Resolution, resolution
from tline.solver.description.short_lines import short_lines
from tline.solver.loop.slabs import Slabs
from tline.solver.result.accuracy import SLOWEST, Accuracy, Attempt
from tline.solver.result.result import Result
from tline.solver.run import NO_KINKS, Kinks, run
from tline.solver.tolerance.compare import compare, with_errors
from tline.solver.tolerance.kinks import halved, kinking, kinks_of, together
from tline.solver.tolerance.limits import MOST_SAMPLES, foretells, inside_limit, inside_slabs, limit_of

FIRST, LAST, LAST_BEHIND = 2, 12, 16  # orders; the last where what decays behind fronts is followed
DIGITS = 3  # of the tolerance beyond three, for which the first order is one higher
FOLLOWED = 1e-3  # of the tolerance: what is left of what decays behind a front, where it is no longer followed
MOST_FOLLOWED = 1e6  # slabs at line ends; of more, what decays behind fronts is not followed: that takes seconds
CLEAR = 1 / 3  # of the tolerance: an error told by the first two runs alone is to be below
HELPS = 0.5  # a step that leaves more of the difference than this does not converge
HALVED = 4  # times that a slab is halved at most to find a flow
MOST_SECTIONS = 8  # of a lumped line
AS_LINES = 5e6  # line-end samples that lines may take in place of lumped ones for the sake of what is behind fronts
ALIKE = 10  # times the difference of runs with more sections there: they err alike


class Start(NamedTuple):
    """Where to begin, by a search with other values."""

    order: int
    left: float  # of a difference, by a step of the order


class Search(NamedTuple):
    """What is looked for."""

    description: Description
    tol: float
    record: list[str]
    progress: bool
    most: float = MOST_SAMPLES  # line-end samples that it may take
    settle: float = 0.0  # time in which lumped lines settle after a front, s
    fit: float = FIT  # tolerance of the circuits of lossy lines
    envelope: bool = False
    start: Start | None = None
    laws: Sequence[str] = ()  # elements whose waves are recorded
    halved: int = 0  # how often the first slab is, beside what suits the scene
    whole: Description | None = None  # of the scene whose lines are in stretches here, if they are

    def run(self, chosen: Resolution, on: Slabs | None = None, kinks: Kinks = NO_KINKS) -> Result:
        """One run to the scene's end time, on slabs of its own or on parts of others."""
        slabs = None if on is None else on.number * round(on.width / chosen.h)
        return run(
            self.description,
            chosen,
            self.record,
            laws=self.laws,
            envelope=self.envelope,
            progress=self.progress,
            slabs=slabs,
            kinks=kinks,
        )


def within(search: Search) -> Result:
    """Run until the estimated error is within the tolerance, or a limit is reached.

    Short lines are lumped if that is good enough. If it is not, and it is affordable, they are lines like others;
    right behind fronts, where they settle, it has to cost little.
    """
    names, settle = short_lines(search.description, search.record)
    if not names:
        return refined(search, NONE)
    cost, problem = _cost_of_lines(search.description)
    lumped = refined(search._replace(most=min(cost, search.most), settle=settle), dict.fromkeys(names, 1))
    assert lumped.accuracy is not None
    behind = lumped.accuracy.times(ALIKE).blurred
    inside = {name: told.or_more(behind[name]) for name, told in lumped.accuracy.inside.items()}
    whole = replace(lumped.accuracy, inside=inside)
    if whole.met or (lumped.accuracy.met and cost > AS_LINES):
        return replace(lumped, accuracy=whole) if whole.met else lumped
    if cost > search.most:
        limit = f"{lumped.accuracy.limit}; lumped lines would need to be lines, {problem}"
        return replace(lumped, accuracy=replace(lumped.accuracy, limit=limit))
    result = refined(search, NONE)
    assert result.accuracy is not None
    attempts = (*lumped.accuracy.attempts, *result.accuracy.attempts)
    return replace(result, accuracy=replace(result.accuracy, attempts=attempts))


def _cost_of_lines(description: Description) -> tuple[float, str]:
    """Line-end samples of the first runs if no line is lumped, and why that may be too much."""
    try:
        h = resolution(description, FIRST).h
    except InputError as error:
        return inf, f"and {error.problem}"
    cost = 3 * FIRST * 2 * len(description.scene.lines) * description.t_end / h
    return cost, f"which takes {cost:.0e} line-end samples"


def refined(search: Search, sections: Mapping[str, int]) -> Result:
    """Raise the order and narrow the slab until the next finer run, which is the result, differs by no more than asked.

    From where that is so on, lumped lines have twice as many in each finer run: the last must have. Slab ends come
    first; what is left inside slabs is worked on while that promises to be enough. Where laws kink, slabs are cut in
    pieces where they did in the run before; openings that move by themselves begin and end to do so inside slabs, which
    runs of another order on the same slabs have wrong alike, so slabs are halved with each step. Where no flow is found
    on the first slabs, the search begins with narrower ones. Two comparisons tell how fast runs converge; one is enough
    if it leaves some room, or that is known of the scene with other values, and no law kinks.
    """
    steps, limit, stale, helps = _finer(search, sections), "", 0, True
    kinked, missed, cuts = kinking(search.description), 0, NO_KINKS
    governed = any(element.governor is not None for element in search.description.elements)
    search = search._replace(laws=[element.where for element in search.description.elements])
    try:
        result = best = search.run(next(steps))
    except NoFlowError:
        if search.halved >= HALVED or search.description.scene.solver.slab is not None or sections:
            raise
        return refined(search._replace(halved=search.halved + 2), sections)
    attempts, accuracy, judged = [Attempt.of(result)], Accuracy(search.tol), None
    told, found, left = accuracy, [accuracy], search.start.left if search.start else SLOWEST
    while not limit:
        try:
            layered = result.resolution.layers > 0  # the pieces behind fronts do not become more on narrower slabs
            layers = FOLLOWED * search.tol if kinked or result.samples <= MOST_FOLLOWED * result.resolution.s else 0.0
            parts = halved(result, search.description.elements, cuts)
            helped = (helps or layered) and not governed
            chosen = steps.send((helped, layered, told.met, parts.differ or governed))._replace(layers=layers)
            if chosen.h < result.resolution.h:
                cuts = parts.steep if chosen.s > result.resolution.s else parts.every
            finer = search.run(chosen, kinks=together(kinks_of(result, kinked), cuts))
        except StopIteration:
            limit = "order and slab are as fine as they may be"
            break
        except NoFlowError as error:
            missed, helps = missed + 1, False
            limit = f"{error.where}: {error.problem}" if missed > HALVED else ""
            continue
        except InputError as error:
            limit = f"{error.where}: {error.problem}"
            break
        pair = search.description, result, finer, search.tol, found[1:], left
        comparison = compare(*pair)
        told, by, found = comparison.errors, comparison.by, [*found, comparison.differences]
        attempts[-1] = replace(attempts[-1], estimate=told.worst)
        attempts.append(Attempt.of(finer))
        if better(told, accuracy):
            best, accuracy, judged = with_errors(finer, result, by), told, pair
        blind = finer.resolution.blind
        doubled = finer.resolution.sections != result.resolution.sections or not sections
        first = CLEAR if search.start is None else 1.0
        sure = len(found) > 2 or (told.worst <= first * search.tol and not kinked)
        if sure and told.met and doubled and not blind:
            break
        narrowed = finer.resolution.h < result.resolution.h
        helps = not blind and gained(*found[-2:]) <= HELPS
        stale = stale + 1 if narrowed and not blind and gained(*found[-2:]) >= 1.0 else 0
        foretell = foretells(attempts, search.description)
        limit = limit_of(attempts, foretell * stale, search.description.collapses, search.most)
        limit = limit or (not blind and inside_limit(attempts, told, foretell))
        result = finer
    if judged and accuracy.at_slab_ends > search.tol:
        accuracy = compare(*judged, whole=True).errors
    damped = () if limit else best.resolution.notes  # that does not matter where the tolerance is met
    unresolved = tuple(note for note in best.unresolved if note not in damped)
    limit = limit and (inside_slabs(accuracy) or limit)
    accuracy = replace(accuracy, attempts=tuple(attempts), limit=limit)
    return replace(best, elements={}, unresolved=unresolved, accuracy=accuracy)


def first_order(tol: float) -> int:
    """Order of the first run: of a lower one little would be within the tolerance."""
    return FIRST + max(int(-log10(tol) / DIGITS + 1e-9) - 1, 0)


def rank(found: Accuracy) -> tuple[float, float]:
    """What orders runs by their accuracy: slab ends first, as long as these are not as asked; then any instant."""
    assert found.tol is not None
    return max(found.at_slab_ends, found.tol), found.worst


def better(found: Accuracy, best: Accuracy) -> bool:
    """Whether a run is at least as accurate as another."""
    return rank(found) <= rank(best)


def gained(before: Accuracy, found: Accuracy) -> float:
    """What a step left of the difference: at slab ends as long as these are not as asked, and then inside."""
    assert found.tol is not None
    here, there = (
        (accuracy.at_slab_ends if found.at_slab_ends > found.tol else accuracy.worst) for accuracy in (found, before)
    )
    return here / there if there > 0 else inf


def _finer(search: Search, sections: Mapping[str, int]) -> Generator[Resolution, tuple[bool, bool, bool, bool]]:
    """Ever finer orders and slabs; what is sent in tells whether the last step helped, follows fronts, and met all.

    It also tells whether pieces may stay as wide as they are when slabs are halved: then the order rises, too. Beside
    lumped lines slabs are not narrowed: fronts are blurred there for a time of its own.
    """
    description, given = search.description, search.description.scene.solver
    s = given.order or (search.start.order if search.start else first_order(search.tol))
    chosen = resolution(description, s, sections=sections, settle=search.settle)
    if search.halved:
        chosen = resolution(description, s, chosen.h / 2**search.halved, sections, search.settle)
    h, fixed, enough = chosen.h, given.slab is not None or bool(sections), False
    while True:
        helped, layered, met, stay = yield chosen._replace(fit=search.fit)
        enough |= met
        if enough:
            sections = {name: 2 * n for name, n in sections.items()}
            if max(sections.values(), default=0) > MOST_SECTIONS:
                raise InputError("lumped lines", f"more than {MOST_SECTIONS} LC sections would be needed")
        last = LAST_BEHIND if layered else LAST
        if given.order is None and s < last and (helped or fixed):
            s += 1
        elif not fixed:
            h /= 2
            s += stay and given.order is None and s < last
        else:
            return
        chosen = resolution(description, s, h, sections, search.settle)
