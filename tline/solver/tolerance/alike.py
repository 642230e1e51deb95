"""How alike runs on slabs and on their halves err, where corners fall inside slabs and are not followed.

Each then holds the best polynomial across the corner. Halved slabs begin and end where slabs do: a corner right before
such an edge stays as far from it, and bends both polynomials alike.
"""

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.description import Description
from tline.solver.description.excitation import EDGE

SEEN = 64  # places of each half of a slab
PLACES = 1000  # of corners in a slab that are told apart


def alike(description: Description, s: int, h: float) -> float:
    """Error of a run of order s on slabs of width h over its difference from that on slabs twice as wide; at least 1.

    It is that of corners of one size at all instants at which waveforms jump or bend.

    Examples
    --------
    >>> from tline.solver.tolerance.alike import ratio
    >>> import numpy as np
    >>> ratio(3, np.array([0.6])) < 3 < ratio(3, np.array([0.97]))
    True
    """
    instants = [waveform.breaks(description.t_end) for waveform in description.waveforms.values()]
    places = np.concatenate([[0.0], *instants]) / (2 * h) % 1.0
    inside = np.unique((PLACES * places[(places > EDGE) & (places < 1 - EDGE)]).round()) / PLACES
    return max(ratio(s, inside), 1.0) if inside.size else 1.0


def ratio(s: int, places: NDArray) -> float:
    """Largest error of the best polynomials on the halves of a slab, over their largest distance from that of all."""
    u, weights = np.polynomial.legendre.leggauss(SEEN)
    points = np.concatenate([(u - 1) / 2, (u + 1) / 2])  # of both halves, -1 to 1
    corner = np.maximum(points - (2 * places[:, None] - 1), 0.0)
    whole = _projected(corner, points, np.tile(weights, 2), s)
    halves = np.hstack([_projected(half, u, weights, s) for half in np.split(corner, 2, axis=1)])
    return float(np.abs(halves - corner).max() / np.abs(halves - whole).max())


def _projected(values: NDArray, points: NDArray, weights: NDArray, s: int) -> NDArray:
    """Best polynomials of degree s - 1, at the points, row by row."""
    basis = np.polynomial.legendre.legvander(points, s - 1)
    size = (weights[:, None] * basis**2).sum(axis=0)
    return (values * weights @ basis / size) @ basis.T
