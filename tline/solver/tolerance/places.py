"""Lines whose losses stand at places, to a tolerance: these and slabs are halved, and runs extrapolated."""

from collections.abc import Iterator
from itertools import pairwise
from math import log

from tline.solver.assembly.loss_elements import loss_elements_in
from tline.solver.description.resolution import Resolution, resolution
from tline.solver.loop.slabs import Slabs
from tline.solver.result.accuracy import SLOWEST, Accuracy
from tline.solver.result.result import Result
from tline.solver.tolerance.compare import differences, magnified
from tline.solver.tolerance.extrapolate import alike, extrapolated
from tline.solver.tolerance.ladder import Grids, Ladder, Search, Step, rank

ORDER = 3
TABLE = ((2,), (2, 4), (2, 4, 6), (1,), (1, 2), (1, 2, 3), (1, 2, 3, 4))  # powers of h taken out, smooth and not
FIRST, CLOSER, CLOSEST = (
    0.1,
    0.5,
    1e-9,
)  # tolerance of circuits over the run's, of the next over it, and the least
FITTED = 3  # steps that tell what the next ones leave of an entry's difference
SOON = 5e7  # samples past loss elements, of one run: a tenth of a second
FEW_PASSES, MOST_PASSES = 5e8, 1e10  # the same of one run: a second; of all runs: half a minute
INSIDE_PASSES = 1e9  # the same for the sake of instants inside slabs alone: some two seconds

Powers = tuple[int, ...]
NONE: Powers = ()
Row = dict[Powers, Result]


class Places(Grids):
    """Slabs halved, with twice as many places and circuits that are closer to laws with a memory.

    Each run adds a row to a table: itself, and what Richardson makes of it and the row above. The error of an entry is
    told by its difference to the one above it; what is given out is the best entry of the last row.
    """

    def __init__(self, search: Search):
        super().__init__(search)
        self.order = search.description.scene.solver.order or ORDER
        self.fit = max(FIRST * search.tol, CLOSEST)
        self.row: Row = {}
        self.told: dict[Powers, list[tuple[float, float]]] = {}  # differences of entries, at slab ends and anywhere

    def first(self) -> Result:
        """The run on slabs that suit the scene."""
        result = self._run(resolution(self.search.description, self.order))
        self.row = {NONE: result}
        return result

    def next(self, ladder: Ladder) -> Result:
        """The run on slabs half as wide."""
        last = ladder.last.resolution
        self.fit = max(CLOSER * self.fit, CLOSEST)
        finer = resolution(self.search.description, self.order, last.h / 2)
        return self._run(finer._replace(loss_elements=2 * last.loss_elements), ladder.last.slabs)

    def _run(self, chosen: Resolution, on: Slabs | None = None) -> Result:
        slabs = None if on is None else on.number * round(on.width / chosen.h)
        return self.search.run(chosen._replace(fit=self.fit, exact=False), slabs=slabs)

    def step(self, ladder: Ladder, finer: Result) -> Step:
        """The best entry of the row that a run adds."""
        above, self.row = self.row, {NONE: finer}
        for powers in TABLE:
            coarse, fine = above.get(powers[:-1]), self.row.get(powers[:-1])
            if coarse and fine and (better := extrapolated(coarse, fine, powers[-1])):
                self.row[powers] = better
        return min(self._judged(above), key=lambda step: rank(step.told))

    def _judged(self, above: Row) -> Iterator[Step]:
        """Entries of the last row, with their errors by their differences to those above."""
        description, chosen = self.search.description, self.row[()].resolution
        by = alike(description, chosen.s, chosen.h)
        for powers in sorted(above.keys() & self.row.keys(), key=len):
            coarse, fine = above[powers], self.row[powers]
            found = Accuracy(self.search.tol, *differences(coarse, fine))
            told = self.told.setdefault(powers, [])
            told.append((found.at_slab_ends, found.worst))
            at_ends, inside = (by * self._caution(powers, k) for k in (0, 1))
            inside *= magnified(description, coarse, fine, [worst for _, worst in told])
            yield Step(fine, found.times(inside, at_ends), inside)

    def _caution(self, powers: Powers, which: int) -> float:
        """Error over the last difference of an entry, at slab ends or at any instant; at least 1.

        Where each step leaves the share r of the difference before, the finer entry still has r + r² + … = r / (1 - r)
        of the last one. Here r is the largest of the last steps, of an entry that has seen fewer also of those that it
        is extrapolated from; at most a half, for errors of places are of first order at least. A difference that is
        smaller than r allows after those before it is an accident of two runs, and counts as r allows.
        """
        left: list[float] = []
        for k in range(len(powers), -1, -1):
            told = [each[which] for each in self.told.get(powers[:k], ())]
            left += [fine / coarse for coarse, fine in pairwise(told) if coarse > 0][: -FITTED - 1 : -1]
        few = [SLOWEST] if len(left) < FITTED else []
        r = min(SLOWEST, max(left[:FITTED] + few))
        last = [each[which] for each in self.told[powers][: -FITTED - 2 : -1]]
        expected = max(difference * r**k for k, difference in enumerate(last))
        return max(expected / last[0] * r / (1 - r), 1.0) if last[0] > 0 else 1.0

    def is_enough(self, ladder: Ladder) -> bool:
        """Whether two comparisons at least have told so, and nothing oscillates unseen."""
        return ladder.compared > 1 and ladder.told.worst <= self.search.tol and not ladder.last.resolution.blind

    def limit(self, ladder: Ladder) -> str:
        """What forbids a finer run, or long ones: at this pace none that is affordable would meet the tolerance."""
        return ladder.limit() or self._too_slow(ladder)

    def _too_slow(self, ladder: Ladder) -> str:
        told, last = [attempt.estimate for attempt in ladder.attempts if attempt.estimate is not None], ladder.last
        lines, chosen = self.search.description.lines, last.resolution
        passes = last.slabs.number * chosen.s * sum(loss_elements_in(lines, chosen.h, chosen.loss_elements).values())
        inside = ladder.told.at_slab_ends <= self.search.tol
        few, most, time = (SOON, INSIDE_PASSES, "seconds") if inside else (FEW_PASSES, MOST_PASSES, "minutes")
        if told[-1] <= self.search.tol or len(told) <= FITTED or passes < few:
            return ""
        pace = max(1.0, *((told[-k] / told[-1]) ** (1 / (k - 1)) for k in (FITTED + 1, len(told))))
        reached = told[-1] / pace ** log(max(most / passes, 1.0), 4)  # each halving has twice as many slabs, and places
        if reached <= self.search.tol:
            return ""
        return f"narrower slabs would reach {reached:.1g} in some {time}, at the pace so far"
