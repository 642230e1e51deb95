"""Runs of rising order, on narrower slabs and with more LC sections of lumped lines, until a tolerance is met."""

from collections.abc import Mapping
from dataclasses import replace
from math import ceil, factorial, inf, log, log10
from typing import NamedTuple

from tline.errors import InputError, NoFlowError
from tline.solver.description.description import Description
from tline.solver.description.nodes import NONE
from tline.solver.description.resolution import Resolution, cell_in, resolution, short_lines
from tline.solver.description.slab import breaks_of, cell_of, cells_in, relative_work
from tline.solver.result.accuracy import SLOWEST
from tline.solver.result.result import Result
from tline.solver.result.superconvergence import SHARED
from tline.solver.run import NO_KINKS
from tline.solver.tolerance.kinks import Cuts, united
from tline.solver.tolerance.ladder import Grids, Ladder, Search, Start, refined

FIRST, LAST, LAST_BEHIND = 2, 12, 16  # orders; the last where decays behind fronts are followed
DIGITS = 3  # of the tolerance per order of the first run, where orders are dear
JOINED, FINER = 5e-2, 0.5  # of the tolerance: mismatch up to which adjacent pieces are joined; factor in later runs
FOLLOWED = 1e-3  # of the tolerance: decays behind a front are followed down to this
MOST_FOLLOWED = 1e6  # slabs at line ends; with more, decays behind fronts are not followed: that takes seconds
CLEAR, FAR_CLEAR = 1 / 3, 1 / 30  # of the tolerance: largest error estimate accepted from two runs alone; if laws kink
LEAST_CELL = 4.0  # slabs of a cell of friction that is halved; narrower ones give way to diamonds
FITTED = 0.1, 1e-9  # tolerance of circuits over the run's, and the least
STEPS, SOON, MOST_CELLS = 3, 5e5, 1e7  # steps that show a pace; cells of one run: a second, and half a minute
HALVED = 4  # halvings of the slab, at most, to find a flow
MOST_SECTIONS = 8  # of a lumped line
AS_LINES = 5e6  # line-end samples that lines may take in place of lumped ones, for accuracy behind fronts
AHEAD, EACH_ORDER = 4, 0.06  # orders in one step, at most; share of a difference that an order leaves, or less
EACH_BENT = 0.25  # share of an error that an order leaves beside laws
ROUGH, QUARTERS = 1e-2, 4  # larger errors beside smooth laws tell nothing of an order's worth: slabs are so divided
EARLY, FEW = 2, 3e3  # halvings of slabs beside laws that do not kink, if all line ends have so few slabs
ALIKE = 10  # times the difference between runs with more sections, which err alike there

NOWHERE = Start(0, SLOWEST)


def within(search: Search) -> Result:
    """Run until the estimated error is within the tolerance, or a limit is reached.

    Short lines are lumped if that is good enough. If it is not, and it is affordable, they are lines like others;
    right behind fronts, where they settle, it has to cost little.
    """
    names, settle = short_lines(search.description, search.record)
    if not names:
        return refined(Orders(search, start=search.start or NOWHERE))
    cost, problem = _cost_of_lines(search.description)
    cheaper = search._replace(most=min(cost, search.most))
    lumped = refined(Orders(cheaper, dict.fromkeys(names, 1), settle, search.start or NOWHERE))
    assert lumped.accuracy is not None
    behind = lumped.accuracy.times(ALIKE).blurred
    inside = {name: told.or_more(behind[name]) for name, told in lumped.accuracy.inside.items()}
    whole = replace(lumped.accuracy, inside=inside)
    if whole.met or (lumped.accuracy.met and cost > AS_LINES):
        return replace(lumped, accuracy=whole) if whole.met else lumped
    if cost > search.most:
        limit = f"{lumped.accuracy.limit}; lumped lines would need to be lines, {problem}"
        return replace(lumped, accuracy=replace(lumped.accuracy, limit=limit))
    result = refined(Orders(search, start=search.start or NOWHERE))
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


def first_order(description: Description, tol: float, h: float) -> int:
    """Order of the first run on slabs of width h: of a lower one little would be within the tolerance.

    Polynomials of s points miss a decay by up to (z/2)^s / s! if slabs are z of its time scale; z is at most one, for
    what is faster has pieces of its own. They miss what a law bends by a share that falls evenly with each order. Where
    orders are dear, they begin as low as where there is neither, and any is exact. Without laws the next order is at
    most the highest whose polynomials neighbours share: beyond, differences in narrow pieces between fronts stay large.
    """
    s, bent = FIRST - 1 + max(int(-log10(tol) / DIGITS + 1e-9), 1), bool(description.elements)
    if description.dispersive or description.diamonds or (bent and not _solved_by_points(description)):
        return s
    z = min(h / min(map(min, description.time_scales.values()), default=inf), 1.0) / 2
    while (EACH_BENT**s if bent else z**s / factorial(s)) > CLEAR * tol:
        s += 1
    return min(s, LAST - 2 if bent else SHARED - 1)  # another order tells the error, and one more knows kinks


def _solved_by_points(description: Description) -> bool:
    """Whether all laws are solved at one point of a slab after the other, so that an order costs little."""
    groups = (group for group in description.grouped()[0] if group.elements)
    return all(
        group.simple and group.elements[0].governor is None and not group.elements[0].kind.fills for group in groups
    )


class Orders(Grids):
    """Higher orders, and narrower slabs where an order leaves more than half of a difference.

    From where the tolerance is met on, lumped lines have twice as many sections in each finer run: the last must have.
    Slab ends come first; errors inside slabs are reduced while that promises to suffice. Where laws kink, slabs are cut
    in pieces where they did in the run before; openings that move by themselves start and stop inside slabs, which runs
    of another order on the same slabs have wrong alike, so slabs are halved with each step.
    Where no flow is found on the first slabs, the search begins with narrower ones. `settle` is the time in which
    lumped lines settle after a front, s.
    """

    def __init__(self, search: Search, sections: Mapping[str, int] = NONE, settle: float = 0.0, start: Start = NOWHERE):
        super().__init__(search)
        self.sections, self.settle, self.start, self.unknown = sections, settle, start, start.left
        self.cuts = Cuts(search.description)
        self.fixed = search.description.scene.solver.slab is not None or bool(sections)  # width of slabs

    def first(self) -> Result:
        """The run on the first grid on which flows are found."""
        for halved in range(0, HALVED + 1, 2):
            self.grid = self._coarsest(self.start.halved + halved)
            try:
                return self.search.run(self.grid, laws=self.cuts.places)
            except NoFlowError:
                if self.fixed or halved == HALVED:
                    raise
        raise AssertionError

    def next(self, ladder: Ladder) -> Result:
        """The run on the next finer grid."""
        last, shown = ladder.last, Shown.by(ladder, self.cuts)
        self.grid = self._finer(ladder, shown)
        follow = self.cuts.kinked or last.samples <= MOST_FOLLOWED * last.resolution.s
        turns = self.cuts.turns(last) if ladder.compared else NO_KINKS
        kinks = united(self.cuts.after(last, self.grid, shown.stuck), turns)
        chosen = self.grid._replace(layers=FOLLOWED * self.search.tol if follow else 0.0)
        return self.search.run(chosen, kinks, self.cuts.places)

    def _ahead(self, ladder: Ladder) -> int:
        """Orders from the last run to the next, whose error should be within the tolerance, at the pace so far.

        Beside laws nothing is foretold from the first comparison, and beside cells nothing at all.
        """
        told, wanted = ladder.told.worst, self.search.tol
        cells, least = self.search.description.dispersive, 1 + bool(self.cuts.elements)
        if cells or ladder.compared < least or not wanted < told < inf:
            return 1
        left = min(ladder.left, EACH_ORDER) if ladder.compared > 1 else EACH_ORDER
        last, before = ladder.attempts[-1], ladder.attempts[-2]
        gained = last.order - before.order + log(last.slab / before.slab) / log(EACH_ORDER) * before.order
        return min(max(ceil(log(wanted / told) / log(left) - gained), 1), AHEAD)

    def is_enough(self, ladder: Ladder) -> bool:
        """Whether the tolerance is met, as far as is known how fast runs converge.

        Two comparisons tell that; one is enough if it leaves some room, or that is known of the scene with other
        values. Where laws kink that takes much room.
        """
        if self.sections and ladder.last.resolution.sections == self.sections:
            return False
        room = FAR_CLEAR if self.cuts.kinked else 1.0 if self.start.order else CLEAR
        sure = ladder.told.worst <= room * self.search.tol
        return (ladder.compared > 1 or sure) and ladder.told.met and not ladder.last.resolution.blind

    def limit(self, ladder: Ladder) -> str:
        """Reason against a finer run: where lines remember, also that no affordable one would do; empty if none."""
        return ladder.limit() or self._too_slow(ladder)

    def _too_slow(self, ladder: Ladder) -> str:
        description, last = self.search.description, ladder.last.resolution
        told = [attempt.estimate for attempt in ladder.attempts if attempt.estimate is not None]
        cells = cells_in(description, cell_in(description, last)) if description.dispersive else 0.0
        if told[-1] <= self.search.tol or len(told) <= STEPS or cells < SOON:
            return ""
        pace = max(1.0, *((told[-k] / told[-1]) ** (1 / (k - 1)) for k in (STEPS + 1, len(told))))
        reached = told[-1] / pace ** log(max(MOST_CELLS / cells, 1.0), 4)  # each halving has four times as many
        if reached <= self.search.tol:
            return ""
        return f"narrower slabs would reach {reached:.1g} in some minutes, at the pace so far"

    def _coarsest(self, halved: int) -> Resolution:
        """The first grid, with slabs halved `halved` times."""
        description, tol = self.search.description, self.search.tol
        given, crowded = description.scene.solver, description.diamonds or description.elements
        early = bool(self.cuts.elements) and not self.cuts.kinked and self._is_cheap()
        h = resolution(description, None, None, self.sections, self.settle).h
        h /= 1 if self.fixed else 2 ** (halved + EARLY * early)
        s = given.order or self.start.order or first_order(description, tol, h)
        chosen = resolution(description, s, None if self.fixed else h, self.sections, self.settle)
        return chosen._replace(
            same=JOINED * tol if crowded else 0.0,  # pieces meet all of those across; laws make new ones
            cell=0.0 if given.order or given.slab else cell_of(description, s, chosen.h),
            fit=max(FITTED[0] * tol, FITTED[1]),
            exact=not description.dispersive,
        )

    def _is_cheap(self) -> bool:
        """Whether runs cost so little that the first may be on narrower slabs at once."""
        description, h = self.search.description, resolution(self.search.description, sections=self.sections).h
        delays = description.columns.delay.tolist()
        work = relative_work(h, delays, breaks_of(description))  # more with fronts inside slabs
        return 2 * len(delays) * description.t_end / h * work <= FEW

    def _finer(self, ladder: Ladder, shown: "Shown") -> Resolution:
        """A higher order if that helps, else narrower slabs: beside pieces, which stay as wide, both."""
        description, now, sections = self.search.description, self.grid, self.grid.sections
        if ladder.told.met or sections != self.sections:
            sections = {name: 2 * n for name, n in sections.items()}
        if max(sections.values(), default=0) > MOST_SECTIONS:
            raise InputError("lumped lines", f"more than {MOST_SECTIONS} LC sections would be needed")
        last, s, h = LAST_BEHIND if shown.layered else LAST, now.s, now.h
        free = description.scene.solver.order is None and s < last
        free &= not description.dispersive or now.cell > 0  # no order makes up for cells
        if free and (self.fixed or (shown.order_helps and not self.cuts.governed)):
            s = min(s + self._ahead(ladder), last)
        elif not self.fixed:
            h /= QUARTERS if shown.rough else 2
            s += free and (shown.pieces or self.cuts.governed)
        else:
            raise StopIteration
        same = now.same * FINER  # so that the difference of two runs shows errors by joining in the first
        cell = now.cell / 2 if now.cell >= LEAST_CELL * now.h else 0.0
        chosen = resolution(description, s, h, sections, self.settle)
        return chosen._replace(same=same, cell=cell, fit=now.fit, exact=now.exact)


class Shown(NamedTuple):
    """Signs of a run by which the next grid is chosen."""

    layered: bool  # decays behind fronts are followed, in pieces that do not become more on narrower slabs
    pieces: bool  # slabs are in pieces at laws, which do not become narrower with them
    # no pieces or kinks beside laws, and an error too large to tell an order's worth: slabs cost less; or fronts that
    # were too many for a slab, which no order makes up for
    rough: bool
    order_helps: bool
    stuck: bool  # neither a higher order nor narrower slabs without kinks are known to help

    @classmethod
    def by(cls, ladder: Ladder, cuts: Cuts) -> "Shown":
        """Signs of the last run of a ladder."""
        last, pieces = ladder.last, cuts.in_pieces(ladder.last)
        layered = last.resolution.layers > 0
        narrowed = ladder.compared > 0 and last.resolution.h < ladder.attempts[-2].slab
        smooth, helps = bool(cuts.elements) and not (cuts.kinked or layered or pieces), ladder.helps or layered
        rough = smooth and ladder.compared > 0 and not narrowed and ladder.told.worst > ROUGH
        rough |= CLEAR * ladder.search.tol < last.fronts.lost < inf
        return cls(layered, pieces, rough, not rough and (helps or (smooth and narrowed)), not (helps or smooth))
