"""Runs of scenes with losses to a tolerance; with loss elements, these and slabs are halved."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from math import log

from tline.errors import InputError
from tline.solver.assembly.loss_elements import loss_elements_in
from tline.solver.assembly.lossy_segments import fits
from tline.solver.description.nodes import NONE
from tline.solver.description.resolution import resolution
from tline.solver.result.accuracy import SLOWEST, Accuracy, Attempt
from tline.solver.result.notes import smeared
from tline.solver.result.result import Result
from tline.solver.tolerance.compare import added, caution, differences, magnified, with_errors
from tline.solver.tolerance.extrapolate import alike, extrapolated, seen_at_ends
from tline.solver.tolerance.ladder import better, gained, inside_limit, inside_slabs, limit_of, rank
from tline.solver.tolerance.search import Search, refined

ORDER, ORDER_IN_SEGMENTS = 3, 6
TABLE = ((2,), (2, 4), (2, 4, 6), (1,), (1, 2), (1, 2, 3), (1, 2, 3, 4))  # powers of h taken out, smooth and not
CLOSER, CLOSEST = 0.1, 1e-9  # tolerance of circuits over that of the run or of circuits before, and the least
CALM = 0.02  # cycles per slab, the band of circuits in segments
IN_SEGMENTS = 1e-5  # the first of these in segments, where terms cost little
FITTED = 3  # steps that tell what the next ones leave of an entry's difference
SOON = 5e7  # samples past loss elements, of one run: a tenth of a second
FEW_PASSES, MOST_PASSES = 5e8, 1e10  # the same of one run: a second; of all runs: half a minute
INSIDE_PASSES = 1e9  # the same for the sake of instants inside slabs alone: some two seconds

Powers = tuple[int, ...]
Row = dict[Powers, Result]
Steps = dict[Powers, list[tuple[float, float]]]  # differences of each entry, at slab ends and at any instant


def with_losses(search: Search) -> Result:
    """Run a scene with losses until the estimated error is within the tolerance, or a limit is reached.

    Where all lossy lines can be cut into segments, order and slab are refined as without losses. Else slabs are halved.
    Segments keep fronts at one place of their slabs alone where laws stand; if others are missed for that, lines have
    loss elements, between which all fronts travel.
    """
    segmented = fits(search.description.lines, resolution(search.description).h)
    best, attempts = None, ()
    for in_segments in (True, False)[not segmented :]:
        result = _with_close_circuits(search, in_segments)
        accuracy = result.accuracy
        assert accuracy is not None
        attempts += accuracy.attempts
        if best is None or better(accuracy, best[1]):
            best = result, accuracy
        if accuracy.met or (segmented and accuracy.at_slab_ends > search.tol):
            break
    assert best is not None
    return replace(best[0], accuracy=replace(best[1], attempts=attempts))


def _with_close_circuits(search: Search, segmented: bool) -> Result:
    """Run in segments, or else with loss elements.

    Circuits stand for exact laws: what closer ones change is error.
    """
    fit, attempts = max((IN_SEGMENTS if segmented else CLOSER) * search.tol, CLOSEST), ()
    while True:
        search = search._replace(fit=fit)
        result, last = _refined(search) if segmented else _halved(search)
        accuracy = result.accuracy
        assert accuracy is not None
        closer = max(CLOSER * fit, CLOSEST)
        attempts += accuracy.attempts
        if not result.circuits_error or accuracy.at_slab_ends > search.tol or closer == fit:
            return replace(result, accuracy=replace(accuracy, attempts=attempts))
        again = search.run(last.resolution._replace(fit=closer), last.slabs)
        attempts += (Attempt.of(again),)
        before, more = (accuracy.estimates, accuracy.inside, accuracy.blurred), differences(last, again)
        told = Accuracy(search.tol, *map(added, before, more), attempts=attempts)
        if told.at_slab_ends <= search.tol:
            return replace(result, accuracy=replace(told, limit=inside_slabs(told) or accuracy.limit))
        fit = closer


def _refined(search: Search) -> tuple[Result, Result]:
    """A result in segments, and the last run.

    Right behind a front, lines with a memory answer faster than a slab can follow; some slabs later all is right. So
    with a memory slabs are halved, and samples are given at the ends of the first run's slabs. Between these the result
    is what the finest run but one is on its own slabs. Their circuits have a narrow band: those of a wide one are
    steeper than polynomials can be, and what these lose is missing ever after, while what a circuit without fast rates
    has wrong decays with the rates it has.
    """
    start = resolution(search.description, search.description.scene.solver.order or ORDER_IN_SEGMENTS)
    first = search.run(start._replace(fit=search.fit, band=CALM))
    if not any(len(line.series.rates) + len(line.shunt.rates) for line in first.circuits.values()):
        result = refined(search, NONE)
        return result, result
    result = seen = last = first
    attempts, limit, stale, accuracy, steps = [Attempt.of(first)], "", 0, Accuracy(search.tol), []
    while not limit:
        last = search.run(last.resolution._replace(h=last.resolution.h / 2), first.slabs)
        finer = seen_at_ends(first, last)
        found = Accuracy(search.tol, *differences(seen, finer))
        steps.append(found.worst)
        by = caution(found) * magnified(search.description, seen, finer, steps)
        found = found.times(by)
        attempts[-1] = replace(attempts[-1], estimate=found.worst)
        attempts.append(Attempt.of(last))
        stale = stale + 1 if gained(accuracy, found) >= 1.0 else 0
        if better(found, accuracy):
            result, accuracy = with_errors(finer, seen, by), found
        if found.met and len(attempts) > 2:
            break
        limit = search.budget.limit(attempts, search.tol) or inside_limit(attempts, found)
        limit = limit or limit_of(attempts, stale, search.description.collapses, search.most)
        seen = finer
    limit = limit and (inside_slabs(accuracy) or limit)
    return replace(result, accuracy=replace(accuracy, attempts=tuple(attempts), limit=limit)), last


def _halved(search: Search) -> tuple[Result, Result]:
    """Halve slabs; the best result, and the last run.

    Each run adds a row to a table: itself, and what Richardson makes of it and the row above. The error of an entry is
    told by its difference to the one above it; the result is the best entry of the last row.
    """
    description, order = search.description, search.description.scene.solver.order or ORDER
    chosen = resolution(description, order)._replace(fit=search.fit, segments=False)
    best = last = search.run(chosen)
    row: Row = {(): last}
    attempts, limit, stale, accuracy = [Attempt.of(last)], "", 0, Accuracy(search.tol)
    steps: Steps = {}
    while not limit:
        try:
            finer = resolution(description, order, chosen.h / 2)
            chosen = finer._replace(fit=search.fit, segments=False, loss_elements=2 * chosen.loss_elements)
            last = search.run(chosen, last.slabs)
        except InputError as error:
            limit = f"{error.where}: {error.problem}"
            break
        above, row = row, _row(row, last)
        entries = _judged(search, above, row, steps)
        result, found, by = min(entries, key=lambda entry: rank(entry[1]))
        attempts.append(Attempt.of(last, found.worst))
        stale = stale + 1 if gained(accuracy, found) >= 1.0 else 0
        if better(found, accuracy):
            best, accuracy = with_errors(result, above[()], by), found
        if found.worst <= search.tol and len(attempts) > 2 and not chosen.blind:
            break
        limit = search.budget.limit(attempts, search.tol) or inside_limit(attempts, found)
        limit = limit or limit_of(attempts, stale, search.description.collapses, search.most)
        limit = limit or _too_slow(search, attempts, last, found)
    limit = limit and (inside_slabs(accuracy) or limit)
    damped = () if limit else (*best.resolution.notes, *smeared(best.fronts))  # which the error counts
    unresolved = tuple(note for note in best.unresolved if note not in damped)
    accuracy = replace(accuracy, attempts=tuple(attempts), limit=limit)
    return replace(best, unresolved=unresolved, accuracy=accuracy), last


def _row(above: Row, finer: Result) -> Row:
    """A run, and what it and the row above extrapolate to."""
    row: Row = {(): finer}
    for powers in TABLE:
        coarse, fine = above.get(powers[:-1]), row.get(powers[:-1])
        if coarse and fine and (better := extrapolated(coarse, fine, powers[-1])):
            row[powers] = better
    return row


def _judged(search: Search, above: Row, row: Row, steps: Steps) -> Iterator[tuple[Result, Accuracy, float]]:
    """Entries of a row, their errors by their differences to those above, and what these were multiplied by."""
    chosen = row[()].resolution
    by = alike(search.description, chosen.s, chosen.h)
    for powers in sorted(above.keys() & row.keys(), key=len):
        coarse, fine = above[powers], row[powers]
        found = Accuracy(search.tol, *differences(coarse, fine))
        told = steps.setdefault(powers, [])
        told.append((found.at_slab_ends, found.worst))
        at_ends, inside = (by * _caution(steps, powers, k) for k in (0, 1))
        inside *= magnified(search.description, coarse, fine, [worst for _, worst in told])
        yield fine, found.times(inside, at_ends), inside


def _caution(steps: Steps, powers: Powers, which: int) -> float:
    """Error over the last difference of an entry, at slab ends or at any instant; at least 1.

    Where each step leaves the share r of the difference before, the finer entry still has r + r² + … = r / (1 - r) of
    the last one. Here r is the largest of the last steps, of an entry that has seen fewer also of those that it is
    extrapolated from; at most a half, for errors of loss elements are of first order at least. A difference that is
    smaller than r allows after those before it is an accident of two runs, and counts as r allows.
    """
    left: list[float] = []
    for k in range(len(powers), -1, -1):
        told = [differences[which] for differences in steps.get(powers[:k], ())]
        left += [fine / coarse for coarse, fine in pairwise(told) if coarse > 0][: -FITTED - 1 : -1]
    few = [SLOWEST] if len(left) < FITTED else []
    r = min(SLOWEST, max(left[:FITTED] + few))
    last = [differences[which] for differences in steps[powers][: -FITTED - 2 : -1]]
    expected = max(difference * r**k for k, difference in enumerate(last))
    return max(expected / last[0] * r / (1 - r), 1.0) if last[0] > 0 else 1.0


def _too_slow(search: Search, attempts: Sequence[Attempt], last: Result, found: Accuracy) -> str:
    """What forbids long runs: that at the pace so far none that is affordable meets the tolerance."""
    told = [attempt.estimate for attempt in attempts if attempt.estimate is not None]
    loss_elements = sum(
        loss_elements_in(search.description.lines, last.resolution.h, last.resolution.loss_elements).values()
    )
    passes = last.slabs.number * last.resolution.s * loss_elements
    inside = found.at_slab_ends <= search.tol
    few, most, time = (SOON, INSIDE_PASSES, "seconds") if inside else (FEW_PASSES, MOST_PASSES, "minutes")
    if told[-1] <= search.tol or len(told) <= FITTED or passes < few:
        return ""
    pace = max(1.0, *((told[-k] / told[-1]) ** (1 / (k - 1)) for k in (FITTED + 1, len(told))))
    halvings = log(max(most / passes, 1.0), 4)  # each has twice as many slabs, and loss elements
    reached = told[-1] / pace**halvings
    if reached <= search.tol:
        return ""
    return f"narrower slabs would reach {reached:.1g} in some {time}, at the pace so far"
