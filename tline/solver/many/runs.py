"""Many runs of one scene: copies side by side in the kernel, slabs and loads' maps of their own for each copy."""

from collections.abc import Callable, Iterable, Mapping
from itertools import repeat
from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import ive

from tline.distinct import distinct
from tline.errors import InputError
from tline.scene.quantity import Role
from tline.solver.description.description import Description
from tline.solver.description.given import Shape
from tline.solver.many.batches import ProbeOfCopies, run
from tline.solver.many.copies import Copies, breaks_of, copies_of, front_places, slab_edges
from tline.solver.result.accuracy import SLOWEST
from tline.solver.tolerance.compare import BETWEEN, SMALLEST_ESTIMATE

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
PARTS, ORDERS = (1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 24, 32), np.arange(2, 11)
GROWTHS = (1.0, 1.5)  # of slabs after a front: for oscillations, and for decays
OVERHEAD = 20  # points of a load's map that cost as much as all else that is done with a point
WANTED = 0.5  # of the tolerance, to allow for copies outside the sample
SAFELY = 1e-4  # of the tolerance: slabs with a smaller expected error need not be finer
COMPARED = 16  # copies whose errors are estimated, beside those with extreme numbers
BY_HALVES = (5, 8)  # orders where slabs are halved
TOLERANCE_SHARE = 0.1  # of the tolerance: largest error that halved slabs leave in the sample
MOST_SLABS, HALVINGS = 400, 20  # of a period, and of one of them
NOTHING = np.empty(0)
CAUTION = BETWEEN / (1 - SLOWEST)  # ratio of errors of the finer run at any instant to differences at points
Found = tuple[Floats, int, float]
Choice = tuple[float, float, int, float, int]  # cost, expected error, parts, growth and order
Apart = Callable[[Floats, int], Floats]
TOLERANCE = Role("tolerance", "", at_least=1e-9, at_most=0.1)


def resolve(
    description: Description, vary: Mapping[str, Floats], copies: Copies, breaks: Floats, tol: float
) -> tuple[Floats, int, float]:
    """Edges of slabs (slabs + 1, copies), order, and estimated error of some copies, at least cost."""
    loads = [junction.load.A for junction in copies.junctions if junction.load is not None]
    valid = np.flatnonzero(copies.valid)
    if not len(valid):
        raise InputError("", "no values that copies take")
    ends = [pick(numbers[valid]) for numbers in vary.values() for pick in (np.argmin, np.argmax)]
    ends += [np.abs(A[valid]).max(axis=(1, 2)).argmax() for A in loads]
    rows = valid[distinct([*ends, *np.linspace(0, len(valid) - 1, COMPARED).astype(int)])]
    fronts = front_places(breaks, copies.unit)

    def apart(edges: Floats, s: int) -> Floats:
        """The largest difference to the next order, in each slab of a period."""
        found = run(description, copies, edges, s, rows, NOTHING, judged=True).values()
        return np.nan_to_num(np.max([seen.apart.max(axis=0) for seen in found], axis=0), nan=inf)

    unit = copies.unit[rows]
    if any(junction.law is not None for junction in copies.junctions):
        choices = _choices(fronts[:, rows], _rates([], loads, rows) * unit, tol)
        halved = (_halved(apart, fronts, choices, s, tol) for s in BY_HALVES)
        return min(halved, key=lambda found: (found[2] > tol, len(found[0]) * found[1]))
    rates = _rates(description.waveforms.values(), loads, rows) * unit
    return _foreseen(apart, fronts, rates, rows, tol / CAUTION if copies.judged else tol)


def _foreseen(apart: Apart, fronts: Floats, rates: Complexes, rows: NDArray, tol: float) -> Found:
    """Choose slabs whose polynomials can follow a load's modes from front to front.

    If the estimated error exceeds the expected one, later choices are expected to exceed it as much.
    """
    choices = _choices(fronts[:, rows], rates, tol)
    best, excess = (np.empty(0), 0, inf), 1.0
    for k, (_, expected, parts, growth, s) in enumerate(choices):
        if expected * excess > WANTED * tol and k + 1 < len(choices):
            continue
        edges = slab_edges(fronts, parts, growth)
        estimate = float(apart(edges, s).max())
        best = min(best, (edges, s, estimate), key=lambda found: found[-1])
        if estimate <= WANTED * tol:
            break
        excess = max(excess, estimate / max(expected, SMALLEST_ESTIMATE))
    return best


def _halved(apart: Apart, fronts: Floats, choices: list[Choice], s: int, tol: float) -> Found:
    """Halve slabs that follow the modes of loads, where they leave more than a share of the tolerance.

    Waves arrive at a node and leave it at one place in the period: each slab answers for itself, and for its effect on
    the states of loads.
    """
    own = [choice for choice in choices if choice[-1] == s]
    enough = (choice for choice in own if choice[1] <= TOLERANCE_SHARE * tol)
    _, expected, parts, growth, _ = next(enough, min(own, key=lambda choice: choice[1]))
    edges = slab_edges(fronts, parts, growth)
    told = CAUTION * apart(edges, s)
    for _ in range(HALVINGS):
        if told.max() <= TOLERANCE_SHARE * tol or len(told) > MOST_SLABS:
            break
        beyond = np.flatnonzero(told > TOLERANCE_SHARE * tol)
        edges = np.insert(edges, beyond + 1, (edges[beyond] + edges[beyond + 1]) / 2, axis=0)
        told = CAUTION * apart(edges, s)
    return edges, s, max(expected, float(told.max()))


def _rates(waveforms: Iterable[Shape], loads: list[Floats], rows: NDArray) -> Complexes:
    """Rates of loads' modes and of waveforms in some copies, (…, copies), 1/s; those of waveforms are imaginary."""
    rates: Complexes = np.zeros((1, len(rows)), complex)
    for waveform in waveforms:
        rates = np.vstack([rates, np.full(len(rows), 1j / waveform.fastest())])
    for A in loads:
        rates = np.vstack([rates, np.linalg.eigvals(A[rows]).T.astype(complex)])
    return rates


def _choices(fronts: Floats, rates: Complexes, tol: float) -> list[Choice]:
    """List cost, expected error, parts, growth and order of all choices, by rising cost.

    The error is the first term left out of the Chebyshev series of exp(λ t) in any slab, t being the time since a
    front and λ the rates (…, copies): 2 I_s(λ w/2) exp(λ t) in the middle of a slab of width w.

    Source: Abramowitz, Stegun: Handbook of Mathematical Functions (1964), 9.6.34.
    """
    found = []
    for parts in PARTS:
        for growth in GROWTHS[:parts]:
            edges = slab_edges(fronts, parts, growth)
            begin, width = edges[:-1], np.diff(edges, axis=0)
            since = begin - np.where(fronts[:, None] <= begin, fronts[:, None], 0.0).max(axis=0)
            begun = np.exp(rates.real[:, None] * since)
            terms = 2 * begun * np.abs(ive(ORDERS[:, None, None, None], rates[:, None] * width / 2))
            left_out = terms.max(axis=(1, 2, 3), initial=0.0)
            costs = len(width) * ORDERS * (ORDERS + OVERHEAD)
            found += zip(costs, left_out, repeat(parts), repeat(growth), ORDERS.tolist())
        if min(expected for _, expected, *_ in found) < SAFELY * tol:
            break
    return sorted(found)


class ManyRuns(NamedTuple):
    """A scene in copies, ready to run."""

    description: Description
    copies: Copies
    # (slabs + 1, copies) edges of the slabs in a period, the common measure of a copy's delays, as shares of it
    edges: Floats
    order: int  # points in a slab
    # largest error at any instant, by the difference to the next higher order, relative to the amplitude, in a sample
    # of the copies that holds the smallest and the largest of each number that varies
    estimate: float

    def run(self, rows: NDArray, t: Floats) -> tuple[dict[str, ProbeOfCopies], Floats]:
        """Run the copies of some rows, sampled at instants t, s; return also the estimated error of each.

        Copies with laws, or waveforms of their own, are judged one by one, as single runs are.
        """
        judged = self.copies.judged
        seen = run(self.description, self.copies, self.edges, self.order, rows, t, judged=judged)
        if not judged:
            return seen, np.full(len(rows), self.estimate)
        worst = np.max([CAUTION * probe.apart.max(axis=1) for probe in seen.values()], axis=0)
        return seen, np.where(self.copies.valid[rows], worst, inf)


def many_runs(description: Description, vary: Mapping[str, Floats], tol: float) -> ManyRuns:
    """Make a scene ready to run many times with other numbers, as finely as a tolerance takes.

    Scenes have single lossless lines in any topology, whose delays are whole multiples of a common measure; sources;
    resistances, R, L and C in series or parallel, reservoirs, shorts, open and matched ends; valves, diodes and other
    elements with a law and no state, one at a node, to the reference or a held effort; probes at nodes. Numbers vary by
    their place: ``lines.NAME.z0`` and ``lines.NAME.delay`` of lines that are given by them,
    ``sources.NAME.resistance``, and ``resistance``, ``inductance`` and ``capacitance`` of ``loads.NAME``, all above
    zero; the delays of a copy keep their proportions. So do those within elements with a law, and within waveforms of
    sources. Errors are relative to the amplitude; where no slabs reach the tolerance, 1e-9 to 0.1, the estimate is the
    error reached.
    """
    TOLERANCE.parse(tol, "")
    copies = copies_of(description, vary)
    if not description.probes:
        raise InputError("probes", "there are none", "at least one, for many runs")
    return ManyRuns(description, copies, *resolve(description, vary, copies, breaks_of(description, copies), tol))
