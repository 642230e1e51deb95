"""What common valves lose on their way from open to shut."""

from collections.abc import Sequence
from itertools import pairwise
from math import log10, sqrt
from typing import Literal

Kind = Literal["gate", "globe", "ball", "butterfly"]
QUARTER = 90.0  # degrees from open to shut
STEEL = 0.0018 * 0.0254  # m, roughness of the pipe to which Crane's equivalent lengths refer

# K over the share of the stroke, or of the quarter turn, less that of the open valve
ADDED: dict[str, tuple[tuple[float, float], ...]] = {
    "gate": tuple((x, k - 0.17) for x, k in ((0.25, 24.0), (0.5, 4.5), (0.75, 0.9))),
    "globe": tuple((x, k - 9.0) for x, k in ((0.25, 112.0), (0.5, 36.0), (0.75, 13.0))),
    "ball": tuple((1 - a / QUARTER, k) for a, k in ((60, 206.0), (40, 17.3), (20, 1.56), (10, 0.29), (5, 0.05))),
    "butterfly": tuple((1 - a / QUARTER, k) for a, k in ((60, 118.0), (40, 10.8), (20, 1.54), (10, 0.52), (5, 0.24))),
}
DIAMETERS = {"gate": 8.0, "globe": 340.0, "ball": 3.0}  # of pipe that lose as much as the open valve
BUTTERFLIES = ((0.229, 45.0), (0.381, 35.0), (float("inf"), 25.0))  # the same up to such a bore, m


def shares(kind: str, loss: float) -> tuple[tuple[float, float], ...]:
    """Share of its capacity that a valve has, over its opening.

    A valve that loses K open loses K plus what the table adds at an opening; between the points of the table the share
    follows straight lines.

    Parameters
    ----------
    kind : str
        "gate", "globe", "ball" (or plug) or "butterfly"
    loss : float
        K, wide open, > 0.

    Returns
    -------
    tuple of pair of float
        Openings from 0 to 1, and shares.

    References
    ----------
    R. H. Perry, D. W. Green: Perry's Chemical Engineers' Handbook, 7th edition (1997), table 6-4.

    Examples
    --------
    >>> [(x, round(y, 3)) for x, y in shares("gate", 0.17)]
    [(0.0, 0.0), (0.25, 0.084), (0.5, 0.194), (0.75, 0.435), (1.0, 1.0)]
    """
    return (0.0, 0.0), *((x, 1 / sqrt(1 + added / loss)) for x, added in ADDED[kind]), (1.0, 1.0)


def open_loss(kind: str, diameter: float) -> float:
    """K of an open valve of a bore in m.

    References
    ----------
    Crane Co.: Flow of Fluids through Valves, Fittings and Pipe, Technical Paper 410, appendix A.

    Examples
    --------
    >>> round(open_loss("gate", 0.1), 3), round(open_loss("globe", 0.1), 2)
    (0.131, 5.57)
    """
    friction = 0.25 / log10(3.7 * diameter / STEEL) ** 2
    lengths = DIAMETERS.get(kind) or next(length for most, length in BUTTERFLIES if diameter <= most)
    return lengths * friction


def opening_of(points: Sequence[tuple[float, float]], share: float) -> float:
    """The opening with that share of the capacity, 0 to 1.

    Examples
    --------
    >>> opening_of([(0.0, 0.0), (0.5, 0.2), (1.0, 1.0)], 0.6)
    0.75
    """
    for (x, y), (after, above) in pairwise(points):
        if share <= above:
            return x + (after - x) * (share - y) / (above - y)
    return 1.0
