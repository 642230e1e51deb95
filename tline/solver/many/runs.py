"""Many runs of one scene: copies side by side in the kernel, slabs and loads' maps of their own for each copy."""

from collections.abc import Mapping
from itertools import repeat
from math import inf, isfinite
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import ive

from tline.errors import InputError
from tline.scene.quantity import Role
from tline.solver.description.description import Description
from tline.solver.many.batches import ProbeOfCopies, run
from tline.solver.many.copies import Copies, copies_of
from tline.solver.many.period import breaks_of, front_places, slab_edges
from tline.solver.tolerance.compare import SILENT, SMALLEST_ESTIMATE

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
PARTS, ORDERS = (1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 24, 32), np.arange(2, 11)
GROWTHS = (1.0, 1.5)  # of slabs after a front: for oscillations, and for decays
OVERHEAD = 20  # points of a load's map that cost as much as all else that is done with a point
WANTED = 0.5  # of the tolerance, to allow for copies outside the sample
SAFELY = 1e-4  # of the tolerance: slabs with a smaller expected error need not be finer
COMPARED, SPREAD = 16, 499  # copies, beside those with extreme numbers, and instants at which runs are compared
TOLERANCE = Role("tolerance", "", at_least=1e-9, at_most=0.1)


def resolve(
    description: Description, vary: Mapping[str, Floats], copies: Copies, tol: float
) -> tuple[Floats, int, float]:
    """Edges of slabs (slabs + 1, copies), order, and estimated error, at least cost.

    Slabs are tried whose polynomials can follow a load's modes from front to front. If the estimated error exceeds the
    expected one, later choices are expected to exceed it as much.
    """
    loads = [junction.load.A for junction in copies.junctions if junction.load is not None]
    ends = [pick(numbers) for numbers in vary.values() for pick in (np.argmin, np.argmax)]
    ends += [np.abs(A).max(axis=(1, 2)).argmax() for A in loads]
    rows = np.unique([*ends, *np.linspace(0, len(copies.unit) - 1, COMPARED).astype(int)])
    fronts, t = front_places(breaks_of(description), copies.unit), np.linspace(0.0, description.t_end, SPREAD)
    choices = _choices(fronts[:, rows], _rates(description, loads, rows) * copies.unit[rows], tol)
    best, excess = (np.empty(0), 0, inf), 1.0
    for k, (_, expected, parts, growth, s) in enumerate(choices):
        if expected * excess > WANTED * tol and k + 1 < len(choices):
            continue
        edges = slab_edges(fronts, parts, growth)
        coarse, fine = (run(description, copies, edges, order, rows, t) for order in (s, s + 1))
        pairs = [(description.probes[name].height.weight, coarse[name], fine[name]) for name in fine]
        estimate = max(_apart(*pair) for pair in pairs)
        best = min(best, (edges, s, estimate), key=lambda found: found[-1])
        if estimate <= WANTED * tol:
            break
        excess = max(excess, estimate / max(expected, SMALLEST_ESTIMATE))
    return best


def _apart(weight: float, coarse: ProbeOfCopies, fine: ProbeOfCopies) -> float:
    """Largest difference of a probe in two runs, relative to its amplitude in each copy."""
    amplitude = np.maximum(weight - fine.lowest, fine.highest - weight)
    flow = fine.z0 * np.abs(fine.y).max(axis=1)
    efforts = [(each.u, each.lowest[:, None], each.highest[:, None]) for each in (fine, coarse)]
    off = np.abs(np.hstack(efforts[0]) - np.hstack(efforts[1])).max(axis=1)
    flow_off = fine.z0 * np.abs(fine.y - coarse.y).max(axis=1)
    worst = SMALLEST_ESTIMATE
    for difference, scale in ((off, amplitude), (flow_off, flow)):
        heard = ~(scale <= SILENT * np.maximum(amplitude, flow))
        found = float((difference[heard] / scale[heard]).max(initial=0.0))
        worst = max(worst, found if isfinite(found) else inf)
    return worst


def _rates(description: Description, loads: list[Floats], rows: NDArray) -> Complexes:
    """Rates of loads' modes and of waveforms in some copies, (…, copies), 1/s; those of waveforms are imaginary."""
    rates: Complexes = np.zeros((1, len(rows)), complex)
    for waveform in description.waveforms.values():
        rates = np.vstack([rates, np.full(len(rows), 1j / waveform.fastest())])
    for A in loads:
        rates = np.vstack([rates, np.linalg.eigvals(A[rows]).T.astype(complex)])
    return rates


def _choices(fronts: Floats, rates: Complexes, tol: float) -> list[tuple[float, float, int, float, int]]:
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
    # largest difference to the next higher order, at any instant and in the extremes, relative to the amplitude, in a
    # sample of the copies that holds the smallest and the largest of each number that varies
    estimate: float

    def run(self, rows: NDArray, t: Floats) -> dict[str, ProbeOfCopies]:
        """Run the copies of some rows, sampled at instants t, s."""
        return run(self.description, self.copies, self.edges, self.order, rows, t)


def many_runs(description: Description, vary: Mapping[str, Floats], tol: float) -> ManyRuns:
    """Make a scene ready to run many times with other numbers, as finely as a tolerance takes.

    Scenes start from rest and have single lossless lines in any topology, whose delays are whole multiples of a common
    measure; sources; resistances, R, L and C in series or parallel, reservoirs, shorts, open and matched ends; probes
    at nodes. Numbers vary by their place: ``lines.NAME.z0`` and ``lines.NAME.delay`` of lines that are given by them,
    ``sources.NAME.resistance``, and ``resistance``, ``inductance`` and ``capacitance`` of ``loads.NAME``, all above
    zero; the delays of a copy keep their proportions. Errors are relative to the amplitude; where no slabs reach the
    tolerance, 1e-9 to 0.1, the estimate is the error reached.
    """
    TOLERANCE.parse(tol, "")
    copies = copies_of(description, vary)
    if not description.probes:
        raise InputError("probes", "there are none", "at least one, for many runs")
    return ManyRuns(description, copies, *resolve(description, vary, copies, tol))
