"""Rise and torque of a pump over its flow, piece by piece, as its law wants them."""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

Form = tuple[float, float, float]  # a + b x + c x², x the flow over the speed


class PumpPieces(NamedTuple):
    """Rise at rest, inner borders of the flow at rated speed, and forms between them."""

    at_rest: float  # Pa
    borders: Sequence[float]  # m³/s
    rises: Sequence[Form]  # of the rise less that at rest, Pa
    torques: Sequence[Form]  # of the torque times the rated speed, W

    def flat(self) -> tuple[float, ...]:
        """Borders, rises and torques, one after the other."""
        return (*self.borders, *(x for form in (*self.rises, *self.torques) for x in form))


def parabola(at_rest: float, b: float, c: float, sign: float = 1.0) -> PumpPieces:
    """rise = ±at_rest - b x - c x|x|; all that is not lost by c x|x| comes from the rotor, or goes to it.

    The sign is that of the speed.
    """
    driven = (0.0, at_rest, -sign * b)
    return PumpPieces(sign * at_rest, [0.0], [(0.0, -b, c), (0.0, -b, -c)], [driven, driven])


def backward(forward: PumpPieces) -> PumpPieces:
    """The same curve of a rotor that turns the other way, by a rise at rest that is as negative; no power."""
    return PumpPieces(
        -forward.at_rest, forward.borders, forward.rises, [(0.0, forward.at_rest, 0.0)] * len(forward.rises)
    )


def smooth(points: Sequence[tuple[float, float]], efficiency: float) -> PumpPieces:
    """A smooth curve that falls through points (flow, rise) of rising flow and falling rise.

    Parabolas of which two join in the middle between two points, so that the slope has no jump (L. L. Schumaker: On
    shape preserving quadratic spline interpolation, SIAM J. Numer. Anal. 20 (1983) 854-864, doi:10.1137/0720057);
    slopes at points are harmonic means of those beside them. Beyond the outer points the curve goes on as a parabola
    with its summit at rest, and from rest backward as steeply as at the last point.
    """
    x, h = zip(*points, strict=True)
    slopes = _slopes(x, h)
    first = slopes[0] / (2 * x[0]) if x[0] > 0 else 0.0
    at_rest = h[0] - first * x[0] ** 2
    last = slopes[-1] / (2 * x[-1])
    start = 0.0 if x[0] > 0 else slopes[0]
    rises, borders = [(0.0, start, -last)], [0.0]
    if x[0] > 0:
        rises.append((0.0, 0.0, first))  # a summit at rest
        borders.append(x[0])
    between, forms = _spline(x, [rise - at_rest for rise in h], slopes)
    borders += between
    rises += [*forms, _around(x[-1], h[-1] - at_rest, slopes[-1], last)]
    return PumpPieces(at_rest, borders, rises, _torques(borders, at_rest, rises, efficiency))


def _torques(borders: Sequence[float], at_rest: float, rises: Sequence[Form], efficiency: float) -> list[Form]:
    """Parabolas through the power of the water over the efficiency, at borders and between; lines beyond them."""

    def power(x: float, rise: Form) -> float:
        return x * max(at_rest + _value(rise, x), 0.0) / efficiency

    forms = []
    for (low, high), rise in zip(pairwise(borders), rises[1:], strict=False):
        middle, half = (low + high) / 2, (high - low) / 2
        below, here, above = (power(x, rise) for x in (low, middle, high))
        forms.append(_around(middle, here, (above - below) / (2 * half), (above - 2 * here + below) / (2 * half**2)))
    last = power(borders[-1], rises[-1]) / borders[-1]
    return [(0.0, at_rest, 0.0), *forms, (0.0, last, 0.0)]


def _spline(x: Sequence[float], y: Sequence[float], slopes: Sequence[float]) -> tuple[list[float], list[Form]]:
    """Borders after the first, and parabolas between: two from each point to the next."""
    borders, forms = [], []
    for k, ((low, high), (below, above)) in enumerate(zip(pairwise(x), pairwise(y), strict=True)):
        width, (s0, s1) = high - low, slopes[k : k + 2]
        between = 2 * (above - below) / width - (s0 + s1) / 2
        forms += [_around(low, below, s0, (between - s0) / width), _around(high, above, s1, (s1 - between) / width)]
        borders += [(low + high) / 2, high]
    return borders, forms


def _slopes(x: Sequence[float], y: Sequence[float]) -> list[float]:
    """Slopes at points that keep a spline between them as monotone as they are."""
    points = zip(x, y, strict=True)
    steep = [(above - below) / (high - low) for (low, below), (high, above) in pairwise(points)]
    inner = [2 * one * two / (one + two) if one * two > 0 else 0.0 for one, two in pairwise(steep)]
    ends = ((steep[0], inner[0]), (steep[-1], inner[-1]))
    first, last = (min(max(2 * one - beside, 2 * one), 0.0) if one < 0 else one for one, beside in ends)
    return [first, *inner, last]


def _around(at: float, value: float, slope: float, bend: float) -> Form:
    """value + slope (x - at) + bend (x - at)²."""
    return value - slope * at + bend * at**2, slope - 2 * bend * at, bend


def _value(form: Form, x: float) -> float:
    return form[0] + form[1] * x + form[2] * x**2
