"""A pair of orders on slabs that suit a scene: two runs with other values in place of a search.

For scenes that a `Plan` is not for: with laws, from a steady state, with fronts inside slabs. Both runs are compared as
the polynomials they are; the finer one is the result, and the difference bounds its errors.
"""

from dataclasses import replace

from tline.errors import InputError
from tline.solver.description.description import Description
from tline.solver.description.resolution import resolution
from tline.solver.description.short_lines import short_lines
from tline.solver.description.slab import breaks_of, common_parts, relative_work
from tline.solver.result.accuracy import Attempt
from tline.solver.result.result import Result
from tline.solver.run import run, with_ledger
from tline.solver.tolerance.compare import as_computed, compare

LOWEST, HIGHEST = 5, 10  # order of the coarser run: below, what they differ by falls slowly
HALVINGS = 5  # of slabs as wide as the shortest delay, or as what divides all delays
MOST_PARTS = 1000  # of the shortest delay
MOST_WORK = 3e5  # line-end samples without fronts that take as long as a run: some hundredths of a second
SPARE = 0.1  # of the tolerance: what a pair is to tell of the scene as it was given


class Pair:
    """Two orders of scenes on slabs of one width.

    Parameters
    ----------
    tol : float
    order : int
        Of the coarser run.
    h : float
        Width of slabs, s.
    """

    def __init__(self, tol: float, order: int, h: float):
        self.tol, self.order, self.h = tol, order, h

    def run(self, description: Description) -> Result | None:
        """The result of a described scene; None if it is not as accurate as asked, or not resolved."""
        grids = [resolution(description, s, self.h) for s in (self.order, self.order + 1)]
        if description.active or any(chosen.notes or chosen.blind for chosen in grids):
            return None
        try:
            coarse, fine = (as_computed(run(description, chosen)) for chosen in grids)
        except InputError:
            return None  # which a search tells, or finds a way round
        told = compare(description, coarse, fine, self.tol, ()).errors
        if not told.met or fine.unresolved:
            return None
        accuracy = replace(told, attempts=(Attempt.of(coarse, told.worst), Attempt.of(fine)))
        return with_ledger(replace(fine, accuracy=accuracy), None)


def paired(description: Description, tol: float) -> Pair | None:
    """A pair for a scene and a tolerance, on the widest slabs on which there is one, with room for other values."""
    by_hand = description.scene.solver.order or description.scene.solver.slab
    moves = any(element.governor is not None for element in description.elements)
    if by_hand or moves or description.lossy or description.collapses or description.stretches or description.own:
        return None
    if short_lines(description, ())[0]:  # which a search may lump
        return None
    for h in _widths(description):
        if _suits(Pair(SPARE * tol, HIGHEST, h), description):
            orders = (Pair(tol, s, h) for s in range(LOWEST, HIGHEST + 1))
            return next(pair for pair in orders if _suits(Pair(SPARE * tol, pair.order, h), description))
    return None


def _widths(description: Description) -> list[float]:
    """Widths of slabs, s: wide ones first, which divide all delays, and breaks of waveforms, if any do."""
    delays = [line.delay for line in description.lines.values()]
    shortest, breaks = min(delays), breaks_of(description).tolist()
    times = (*delays, *breaks), (*delays,)
    parts = next(filter(None, (common_parts(each, shortest, MOST_PARTS) for each in times)), 1)
    samples = 2 * len(delays) * description.t_end * HIGHEST
    widths = (shortest / (parts * 2**k) for k in range(HALVINGS))
    return [h for h in widths if samples / h * relative_work(h, delays, breaks) <= MOST_WORK]


def _suits(pair: Pair, description: Description) -> bool:
    return pair.run(description) is not None
