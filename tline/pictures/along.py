"""Waves and effort along a route, at any places and instants, and the extremes of the effort."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.pictures.path import Leg, Route
from tline.solver.result.interior import Inside, InStretches, inside
from tline.solver.result.result import Result

STRETCHES, FEWEST = 320, 8  # on the whole route, and on each line, at whose ends extremes are known


class RouteExtremes(NamedTuple):
    """Effort along a route, Pa or V; where lines meet there are two equal places, and at a link two efforts."""

    x: NDArray  # (places,) in the route's unit
    start: NDArray  # before t = 0
    lowest: NDArray
    highest: NDArray


def waves_along(result: Result, way: Route, x: NDArray, t: NDArray) -> NDArray:
    """Waves that travel along a route and against it, at places x (in its unit) and instants t.

    Shape (2, len(t), len(x)). Half of their sum is the effort.
    """
    legs = _insides(result, way, min(len(x), STRETCHES))
    at = np.clip(np.searchsorted([leg.span[1] for leg in way.legs], x), 0, len(legs) - 1)
    both = np.empty((2, len(t), len(x)))
    for k in np.unique(at):
        leg, here = way.legs[k], at == k
        part = np.clip((x[here] - leg.span[0]) / (leg.span[1] - leg.span[0]), 0.0, 1.0)
        waves = _waves(legs[k], t, part if leg.forward else 1.0 - part)
        both[:, :, here] = waves if leg.forward else waves[::-1]
    return both


def _waves(seen: Inside | InStretches, t: NDArray, shares: NDArray) -> NDArray:
    """Waves a and b at places of one line, shape (2, len(t), len(shares))."""
    if isinstance(seen, InStretches) or seen.lost is not None:
        return np.stack([seen.waves(t, share) for share in shares.tolist()], axis=-1)
    (a, _), (_, b), late = seen.record.at_end1, seen.record.at_end2, shares * seen.record.delay
    return np.stack([a(t[:, None] - late), b(t[:, None] - (seen.record.delay - late))])


def effort_along(result: Result, way: Route, x: NDArray, t: NDArray) -> NDArray:
    """Effort at places x of a route (in its unit) and instants t, shape (len(t), len(x))."""
    return waves_along(result, way, x, t).mean(axis=0)


def extremes_along(result: Result, way: Route) -> RouteExtremes:
    """Effort before t = 0, and lowest and highest effort of the run, line after line."""
    places, efforts = [], []
    for leg, seen in zip(way.legs, _insides(result, way), strict=True):
        share, forward = seen.places, leg.forward
        places.append(leg.span[0] + (leg.span[1] - leg.span[0]) * (share if forward else 1 - share[::-1]))
        efforts.append(seen.extremes(result.t)[:, :: 1 if forward else -1])
    return RouteExtremes(np.concatenate(places), *np.concatenate(efforts, axis=1))


def start_effort(result: Result, way: Route) -> float:
    """Effort at the route's first node before t = 0."""
    leg = way.legs[0]
    record = result.lines[leg.line]
    a, b = (record.a1, record.b1) if leg.forward else (record.a2, record.b2)
    return (a.before + b.before) / 2


def _insides(result: Result, way: Route, stretches: int = STRETCHES) -> list[Inside | InStretches]:
    return [inside(result, leg.line, _cells(way, leg, stretches)) for leg in way.legs]


def _cells(way: Route, leg: Leg, stretches: int) -> int:
    return max(round(stretches * (leg.span[1] - leg.span[0]) / way.marks[-1]), FEWEST)
