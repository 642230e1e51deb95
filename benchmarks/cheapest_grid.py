"""What the automatic order and slab cost beside the best ones by hand: `python -m benchmarks.cheapest_grid [NAME…]`.

Prints a page and writes it to benchmarks/pages/grid.md. By hand a scene is run once for each of many orders and slabs,
and the cheapest run counts whose true error is not larger. What is automatic includes all runs that it took, and its
estimate. Times are of whole calls, of the processor; errors are relative to the amplitude at each probe, at random
instants, against a run to a far smaller tolerance.
"""

import sys
import warnings
from statistics import median
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.cheapest_grid_scenes import scenes
from benchmarks.harness import table, timed, write
from tline.errors import InputError
from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.solver.result.result import Result
from tline.solver.simulate import UnresolvedWarning, simulate

TOLERANCES = 1e-3, 1e-6
FINEST = 1e-3, 1e-9  # of the tolerance, and the least: what is taken for the truth
ORDERS = 1, 2, 3, 4, 5, 6, 8, 10, 12
PARTS = 2.0 ** np.arange(-5, 8)  # of the automatic slab
OF_DELAY = 1, 2, 4, 8  # parts of the shortest delay
INSTANTS = 2000
NEAR = 1e-6  # of the run; jumps may lie so far from where the truth has them
EXACT = 1e-11  # an error below is rounding
MOST = 3.0
HOPELESS = 2.0  # times the cheapest so far, beyond which a run by hand is not tried at higher orders


class Run(NamedTuple):
    """A run of a scene, automatic or by hand."""

    seconds: float
    error: float
    order: int
    slab: float


class Row(NamedTuple):
    """A scene at a tolerance."""

    name: str
    tol: float
    met: bool
    automatic: Run
    by_hand: Run
    judged: float  # seconds of that with the run that tells its error

    @property
    def ratio(self) -> float:
        """Time of the automatic choice over that by hand, of both with their estimates."""
        return self.automatic.seconds / self.judged

    @property
    def bare(self) -> float:
        """The same over the time of a run by hand that tells no error."""
        return self.automatic.seconds / self.by_hand.seconds


def searched(scene: Scene, tol: float) -> Result:
    """A run to a tolerance that knows of none before."""
    describe(scene).known.clear()
    return simulate(scene, tol=tol)


def seen(result: Result, t: NDArray) -> dict[str, NDArray]:
    """Efforts, and flows times impedance, at all probes."""
    found = {name: probe.at(t) for name, probe in result.probes.items()}
    return {name: np.stack([each.u, result.probes[name].record.z0 * each.y]) for name, each in found.items()}


def instants(truth: Result) -> NDArray:
    """Random instants, none of them right at a jump."""
    t_end = truth.scene.t_end
    t = np.sort(np.random.default_rng(1).uniform(0.0, t_end * (1 - NEAR), INSTANTS))
    calm = np.ones(len(t), bool)
    before, after = seen(truth, np.maximum(t - NEAR * t_end, 0.0)), seen(truth, t + NEAR * t_end)
    for name, values in before.items():
        calm &= (np.abs(values - after[name]) < 1e-2 * np.abs(values).max(initial=1e-300)).all(axis=0)
    return t[calm]


def error(found: dict[str, NDArray], truth: dict[str, NDArray]) -> float:
    """The largest difference over the amplitude of effort or flow at its probe."""
    largest = max(float(np.abs(values).max()) for values in truth.values())
    worst = 0.0
    for name, values in truth.items():
        most = np.abs(values).max(axis=1)
        off = np.abs(found[name] - values).max(axis=1)
        worst = max(worst, *(float(o / m) for o, m in zip(off, most, strict=True) if m > 1e-9 * largest))
    return worst


def compared(name: str, scene: Scene, tol: float) -> Row:
    """The automatic choice for a scene beside the best by hand."""
    truth = simulate(scene, tol=max(FINEST[0] * tol, FINEST[1]))
    t = instants(truth)
    exact = seen(truth, t)
    simulate(scene, tol=tol)
    result, seconds = timed(lambda: searched(scene, tol))
    assert result.accuracy is not None
    at = result.accuracy.attempts[0].slab, min(line.delay for line in describe(scene).lines.values())
    automatic = Run(seconds, error(seen(result, t), exact), result.resolution.s, result.resolution.h)
    slabs = sorted({*(at[0] / PARTS), *(at[1] / np.array(OF_DELAY)), result.resolution.h}, reverse=True)
    best, given = automatic._replace(seconds=np.inf), scene
    for slab in slabs:
        for order in ORDERS:
            try:
                by_hand = scene.with_changes(solver={"order": order, "slab": float(slab)})
                one, spent = timed(lambda by_hand=by_hand: simulate(by_hand), 1)
            except InputError:
                break
            off = error(seen(one, t), exact)
            if off <= max(automatic.error, EXACT):
                _, spent = timed(lambda by_hand=by_hand: simulate(by_hand))
                if spent < best.seconds:
                    best, given = Run(spent, off, order, float(slab)), by_hand
                break
            if spent > HOPELESS * min(best.seconds, seconds):
                break
    _, judged = timed(lambda: searched(given, tol))
    return Row(name, tol, result.accuracy.met, automatic, best, judged)


def page(rows: list[Row]) -> str:
    """The sums and the table of the page."""
    ratios, bare = [row.ratio for row in rows], [row.bare for row in rows]
    beyond = sum(ratio > MOST for ratio in ratios)
    sums = (
        f"{len({row.name for row in rows})} scenes, {len(rows)} rows. Automatic over by hand, both with their errors: "
        f"median {median(ratios):.2g}, largest {max(ratios):.2g}, {beyond} beyond {MOST:g}. Over one run that tells "
        f"no error: median {median(bare):.2g}, largest {max(bare):.2g}.\n"
    )
    return sums + "\n" + table(COLUMNS, map(cells, rows))


def cells(row: Row) -> list[str]:
    """A row of the table."""
    shown = [row.name, f"{row.tol:.0e}", "yes" if row.met else "no"]
    for run in (row.automatic, row.by_hand):
        shown += [f"{run.order}, {run.slab:.3g} s", f"{run.error:.1e}", f"{1e3 * run.seconds:.3g}"]
    return [*shown, f"{1e3 * row.judged:.3g}", f"{row.ratio:.2g}", f"{row.bare:.2g}"]


COLUMNS = "<scene|asked|<met|<automatic|error|ms|<by hand|error|ms|with its error, ms|times|bare"


def main(names: list[str]) -> None:
    """Measure the scenes of these names, or all and write the page."""
    warnings.simplefilter("ignore", UnresolvedWarning)
    rows = []
    for name, scene in scenes().items():
        if not names or name in names:
            for tol in TOLERANCES:
                rows.append(compared(name, scene, tol))
                print(*cells(rows[-1]), sep=" | ", flush=True)
    if not names:
        write("benchmarks/pages/grid.md", page(rows), "measured")


if __name__ == "__main__":
    main(sys.argv[1:])
