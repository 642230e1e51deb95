"""How finely copies are computed: tried on a sample of them against the next order."""

from collections.abc import Mapping
from math import exp, factorial, inf, isfinite

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tline.scene.scene import Scene
from tline.solver.accuracy import ROUNDING, SILENT
from tline.solver.many.batches import Seen, run
from tline.solver.many.copies import Copies
from tline.solver.many.period import slab_edges

Floats = NDArray[np.floating]
CHOICES = [(1, 4), (1, 6), (1, 8), (2, 8), *((parts, 10) for parts in (2, 3, 4, 5, 6, 8, 12, 16, 32))]
# least number of slabs in a period, and order, by rising cost
COMPARED, SPREAD = 16, 101  # copies, beside those with extreme numbers, and instants at which runs are compared


def resolve(
    scene: Scene, vary: Mapping[str, ArrayLike], copies: Copies, breaks: Floats, tol: float
) -> tuple[int, int, float]:
    """Least number of slabs in a period, order, and estimated error.

    Choices are tried whose polynomials may follow exp(-t/τ), τ being the shortest time scale: the bound is the size
    of the Chebyshev series' first term left out, 2 exp(-x/2) I_s(x/2) with x the slab's width over τ.
    """
    values = [np.asarray(numbers, float) for numbers in vary.values()]
    ends = [pick(numbers) for numbers in values for pick in (np.argmin, np.argmax)]
    rows = np.unique([*ends, *np.linspace(0, len(copies.unit) - 1, COMPARED).astype(int)])
    t = np.linspace(0.0, float(scene.t_end), SPREAD)
    fastest = _fastest(scene, copies)
    best = (*CHOICES[0], inf)
    for parts, s in CHOICES:
        edges = slab_edges(breaks, copies.unit, parts)
        change = float((np.diff(edges, axis=0) * copies.unit * fastest).max())
        if 2 * (change / 4) ** s / factorial(s) * exp(-change / 2) > tol and (parts, s) != CHOICES[-1]:
            continue
        estimate = _apart(scene, copies, rows, *(run(scene, copies, edges, order, rows, t) for order in (s, s + 1)))
        best = min(best, (parts, s, estimate), key=lambda found: found[-1])
        if estimate <= tol:
            break
    return best


def _fastest(scene: Scene, copies: Copies) -> Floats:
    """Largest rate of a load or waveform in each copy, 1/s."""
    rates = [np.full(len(copies.unit), 1 / source.value.fastest()) for source in scene.sources.values()]
    for junction in copies.junctions:
        if junction.load is not None:
            A = np.moveaxis(junction.load.A, -1, 0)
            trace, product = np.trace(A, axis1=1, axis2=2), np.linalg.det(A)
            rates.append(np.maximum(np.abs(trace), np.abs(product) ** (1 / A.shape[-1])))
    return np.max([np.zeros(len(copies.unit)), *rates], axis=0)


def _apart(scene: Scene, copies: Copies, rows: NDArray, coarse: Mapping[str, Seen], fine: Mapping[str, Seen]) -> float:
    """Largest difference of two runs relative to the amplitude of each copy."""
    worst = ROUNDING
    for name, seen in fine.items():
        other, z0 = coarse[name], copies.z0[list(scene.lines).index(scene.probed_line(name)), rows]
        amplitude = np.maximum(-seen.lowest, seen.highest)
        flow = z0 * np.abs(seen.y).max(axis=1)
        pairs = [(seen.u, other.u), (seen.lowest[:, None], other.lowest[:, None])]
        pairs += [(seen.highest[:, None], other.highest[:, None])]
        efforts = np.max([np.abs(a - b).max(axis=1) for a, b in pairs], axis=0)
        flows = z0 * np.abs(seen.y - other.y).max(axis=1)
        for difference, scale in ((efforts, amplitude), (flows, flow)):
            heard = ~(scale <= SILENT * np.maximum(amplitude, flow))
            found = float((difference[heard] / scale[heard]).max(initial=0.0))
            worst = max(worst, found if isfinite(found) else inf)
    return worst
