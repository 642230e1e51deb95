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
from tline.solver.result.accuracy import SLOWEST
from tline.solver.result.result import Result
from tline.solver.run import NO_KINKS, Kinks, run
from tline.solver.tolerance.budget import Budget
from tline.solver.tolerance.kinks import Cuts
from tline.solver.tolerance.ladder import MOST_SAMPLES, Ladder

FIRST, LAST, LAST_BEHIND = 2, 12, 16  # orders; the last where what decays behind fronts is followed
DIGITS = 3  # of the tolerance beyond three, for which the first order is one higher
JOINED, FINER = 5e-2, 0.5  # of the tolerance: how well pieces in diamonds continue each other that are one; and later
FOLLOWED = 1e-3  # of the tolerance: what is left of what decays behind a front, where it is no longer followed
MOST_FOLLOWED = 1e6  # slabs at line ends; of more, what decays behind fronts is not followed: that takes seconds
CLEAR, FAR_CLEAR = 1 / 3, 1 / 30  # of the tolerance: an error told by two runs alone is to be below; if laws kink
HALVED = 4  # times that a slab is halved at most to find a flow
MOST_SECTIONS = 8  # of a lumped line
AS_LINES = 5e6  # line-end samples that lines may take in place of lumped ones for the sake of what is behind fronts
ALIKE = 10  # times the difference of runs with more sections there: they err alike

Grids = Generator[Resolution, tuple[bool, bool, bool, bool]]


class Start(NamedTuple):
    """Where to begin, by a search with other values."""

    order: int
    left: float  # of a difference, by a step of the order
    halved: int = 0  # how often the slab is, that suits the scene
    told: float = inf  # by a search, of its error on this grid


class Search(NamedTuple):
    """What is looked for."""

    description: Description
    tol: float
    record: list[str]
    progress: bool
    budget: Budget
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
    on the first slabs, the search begins with narrower ones.
    """
    grids, cuts, missed, limit = _finer(search, sections), Cuts(search.description), 0, ""
    search = search._replace(laws=cuts.places)
    try:
        first = search.run(next(grids))
    except NoFlowError:
        if search.halved >= HALVED or search.description.scene.solver.slab is not None or sections:
            raise
        return refined(search._replace(halved=search.halved + 2), sections)
    ladder = Ladder(search.description, first, search.tol, search.start.left if search.start else SLOWEST)
    while not limit:
        try:
            ladder.climb(_next(search, grids, ladder, cuts))
        except StopIteration:
            limit = "order and slab are as fine as they may be"
        except NoFlowError as error:
            missed, ladder.helps = missed + 1, False
            limit = f"{error.where}: {error.problem}" if missed > HALVED else ""
        except InputError as error:
            limit = f"{error.where}: {error.problem}"
        else:
            doubled = not sections or ladder.last.resolution.sections != sections
            if doubled and _is_enough(search, ladder, bool(cuts.kinked)):
                break
            limit = ladder.limit(search.most, search.budget)
    return ladder.result(limit)


def _next(search: Search, grids: Grids, ladder: Ladder, cuts: Cuts) -> Result:
    """The run on the next finer grid."""
    last = ladder.last
    layered = last.resolution.layers > 0  # the pieces behind fronts do not become more on narrower slabs
    follow = cuts.kinked or last.samples <= MOST_FOLLOWED * last.resolution.s
    parts = cuts.halved(last)
    helped, differ = (ladder.helps or layered) and not cuts.governed, parts.differ or cuts.governed
    chosen = grids.send((helped, layered, ladder.told.met, differ))
    return search.run(
        chosen._replace(layers=FOLLOWED * search.tol if follow else 0.0), kinks=cuts.ahead(last, parts, chosen)
    )


def _is_enough(search: Search, ladder: Ladder, kinks: bool) -> bool:
    """Whether the tolerance is met, as far as is known how fast runs converge.

    Two comparisons tell that; one is enough if it leaves some room, or that is known of the scene with other values.
    Where laws kink that takes much room.
    """
    room = FAR_CLEAR if kinks else 1.0 if search.start else CLEAR
    sure = ladder.told.worst <= room * search.tol
    return (ladder.compared > 1 or sure) and ladder.told.met and not ladder.last.resolution.blind


def first_order(tol: float) -> int:
    """Order of the first run: of a lower one little would be within the tolerance."""
    return FIRST + max(int(-log10(tol) / DIGITS + 1e-9) - 1, 0)


def _finer(search: Search, sections: Mapping[str, int]) -> Grids:
    """Ever finer orders and slabs; what is sent in tells whether the last step helped, follows fronts, and met all.

    It also tells whether pieces may stay as wide as they are when slabs are halved: then the order rises, too. Beside
    lumped lines slabs are not narrowed: fronts are blurred there for a time of its own.
    """
    description, given = search.description, search.description.scene.solver
    s = given.order or (search.start.order if search.start else first_order(search.tol))
    chosen = resolution(description, s, sections=sections, settle=search.settle)
    halved = search.halved + (search.start.halved if search.start else 0)
    if halved and given.slab is None and not sections:
        chosen = resolution(description, s, chosen.h / 2**halved, sections, search.settle)
    h, fixed, enough = chosen.h, given.slab is not None or bool(sections), False
    same = JOINED * search.tol if description.diamonds else 0.0  # there each piece meets each of those across
    while True:
        helped, layered, met, stay = yield chosen._replace(fit=search.fit, same=same)
        same *= FINER  # so that the difference of two runs tells what was joined in the first
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
