"""Rise and torque of a pump over its flow, in pieces for its law; and in all four quadrants.

With speed n, flow q, head h and torque b over those of the rated point, h = (n² + q²)·F(φ) and b = (n² + q²)·G(φ),
where φ is the angle of (n, q) from -π to π (P. Suter, 1966).
"""

from collections.abc import Sequence
from itertools import pairwise
from math import pi, tan
from typing import NamedTuple

Form = tuple[float, float, float]  # a + b x + c x², x the flow over the speed


class PumpPieces(NamedTuple):
    """Rise at rest, inner borders of the flow at rated speed, and forms between them."""

    at_rest: float  # Pa
    borders: Sequence[float]  # m³/s
    rises: Sequence[Form]  # of the rise less that at rest, Pa
    torques: Sequence[Form]  # of the torque times the rated speed, W

    def flat(self) -> tuple[float, ...]:
        """Borders, rises and torques as one tuple."""
        return (*self.borders, *(x for form in (*self.rises, *self.torques) for x in form))


def parabola(at_rest: float, b: float, c: float, sign: float = 1.0) -> PumpPieces:
    """Pieces of rise = ±at_rest - b x - c x|x|, with all power except that lost by c x|x| exchanged with the rotor.

    The sign is that of the speed.
    """
    driven = (0.0, at_rest, -sign * b)
    return PumpPieces(sign * at_rest, [0.0], [(0.0, -b, c), (0.0, -b, -c)], [driven, driven])


def backward(forward: PumpPieces) -> PumpPieces:
    """Mirror a curve for a rotor that turns backward, with a negative rise at rest and no power."""
    return PumpPieces(
        -forward.at_rest, forward.borders, forward.rises, [(0.0, forward.at_rest, 0.0)] * len(forward.rises)
    )


def smooth(points: Sequence[tuple[float, float]], efficiency: float) -> PumpPieces:
    """Smooth curve that falls through points (flow, rise) of rising flow and falling rise.

    Two parabolas join in the middle between two points, so that the slope has no jump (L. L. Schumaker: On
    shape preserving quadratic spline interpolation, SIAM J. Numer. Anal. 20 (1983) 854-864, doi:10.1137/0720057);
    slopes at points are harmonic means of those of the adjacent intervals. Beyond the outer points the curve continues
    as a parabola with its summit at rest, and from rest backward as steeply as at the last point.
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
    """Fit parabolas to the power of the water over the efficiency, at and between borders; lines beyond them."""

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
    """Slopes at points for a spline as monotone as the points."""
    points = zip(x, y, strict=True)
    steep = [(above - below) / (high - low) for (low, below), (high, above) in pairwise(points)]
    inner = [2 * one * two / (one + two) if one * two > 0 else 0.0 for one, two in pairwise(steep)]
    ends = ((steep[0], inner[0]), (steep[-1], inner[-1]))
    first, last = (min(max(2 * one - beside, 2 * one), 0.0) if one < 0 else one for one, beside in ends)
    return [first, *inner, last]


def _around(at: float, value: float, slope: float, bend: float) -> Form:
    """Expand value + slope (x - at) + bend (x - at)² in powers of x."""
    return value - slope * at + bend * at**2, slope - 2 * bend * at, bend


def _value(form: Form, x: float) -> float:
    return form[0] + form[1] * x + form[2] * x**2


class Suter(NamedTuple):
    """Suter's curves F and G at equal steps of the angle from -π to π."""

    head: tuple[float, ...]
    torque: tuple[float, ...]


# a radial pump of a specific speed of some 25 (turns a minute, m³/s, m), with the figures that ThermoSysPro's library
# of models has (CentrifugalPump, EDF)
RADIAL = Suter(
    (
        0.634, 0.643, 0.646, 0.640, 0.629, 0.613, 0.595, 0.575, 0.552, 0.533, 0.516, 0.505, 0.504, 0.510, 0.512,
        0.522, 0.539, 0.559, 0.580, 0.601, 0.630, 0.662, 0.692, 0.722, 0.753, 0.782, 0.808, 0.832, 0.857, 0.879,
        0.904, 0.930, 0.959, 0.996, 1.027, 1.060, 1.090, 1.124, 1.165, 1.204, 1.238, 1.258, 1.271, 1.282, 1.288,
        1.281, 1.260, 1.225, 1.172, 1.107, 1.031, 0.942, 0.842, 0.733, 0.617, 0.500, 0.368, 0.240, 0.125, 0.011,
        -0.102, -0.168, -0.255, -0.342, -0.423, -0.494, -0.556, -0.620, -0.655, -0.670, -0.670, -0.660, -0.655,
        -0.640, -0.600, -0.570, -0.520, -0.470, -0.430, -0.360, -0.275, -0.160, -0.040, 0.130, 0.295, 0.430,
        0.550, 0.620, 0.634,
    ),
    (
        -0.684, -0.547, -0.414, -0.292, -0.187, -0.105, -0.053, -0.012, 0.042, 0.097, 0.156, 0.227, 0.300, 0.371,
        0.444, 0.522, 0.596, 0.672, 0.738, 0.763, 0.797, 0.837, 0.865, 0.883, 0.886, 0.877, 0.859, 0.838, 0.804,
        0.758, 0.703, 0.645, 0.583, 0.520, 0.454, 0.408, 0.370, 0.343, 0.331, 0.329, 0.338, 0.354, 0.372, 0.405,
        0.450, 0.486, 0.520, 0.552, 0.579, 0.603, 0.616, 0.617, 0.606, 0.582, 0.546, 0.500, 0.432, 0.360, 0.288,
        0.214, 0.123, 0.037, -0.053, -0.161, -0.248, -0.314, -0.372, -0.580, -0.740, -0.880, -1.000, -1.120,
        -1.250, -1.370, -1.490, -1.590, -1.660, -1.690, -1.770, -1.650, -1.590, -1.520, -1.420, -1.320, -1.230,
        -1.100, -0.980, -0.820, -0.684,
    ),
)  # fmt: skip
# the pump of the LOFT facility, 61, as MOOSE has its homologous curves (Idaho National Laboratory)
MIXED_61 = Suter(
    (
        0.251, 0.260, 0.267, 0.282, 0.289, 0.295, 0.279, 0.333, 0.377, 0.428, 0.465, 0.509, 0.512, 0.542, 0.592,
        0.648, 0.699, 0.749, 0.802, 0.846, 0.881, 0.912, 0.936, 0.983, 1.037, 1.073, 1.102, 1.099, 1.096, 1.112,
        1.120, 1.163, 1.190, 1.214, 1.244, 1.266, 1.325, 1.350, 1.381, 1.398, 1.419, 1.416, 1.420, 1.420, 1.411,
        1.375, 1.344, 1.292, 1.235, 1.159, 1.070, 0.962, 0.860, 0.741, 0.620, 0.500, 0.369, 0.192, 0.063, -0.040,
        -0.150, -0.255, -0.353, -0.454, -0.529, -0.604, -0.668, -0.697, -0.730, -0.747, -0.754, -0.749, -0.733,
        -0.704, -0.662, -0.614, -0.559, -0.496, -0.412, -0.326, -0.235, -0.158, -0.081, -0.010, 0.054, 0.119, 0.174,
        0.227, 0.251,
    ),
    (
        -0.457, -0.405, -0.359, -0.311, -0.268, -0.221, -0.066, 0.034, 0.088, 0.128, 0.158, 0.177, 0.266, 0.376,
        0.492, 0.607, 0.725, 0.838, 0.931, 1.026, 1.109, 1.183, 1.269, 1.294, 1.332, 1.343, 1.329, 1.323, 1.287,
        1.243, 1.195, 1.131, 1.067, 0.980, 0.884, 0.826, 0.778, 0.738, 0.710, 0.682, 0.656, 0.641, 0.621, 0.613,
        0.614, 0.611, 0.617, 0.626, 0.639, 0.651, 0.648, 0.641, 0.622, 0.590, 0.550, 0.500, 0.457, 0.377, 0.287,
        0.183, 0.018, -0.233, -0.322, -0.400, -0.485, -0.579, -0.664, -0.749, -0.808, -0.822, -0.817, -0.793, -0.761,
        -0.709, -0.666, -0.615, -0.556, -0.496, -0.557, -0.614, -0.669, -0.711, -0.762, -0.794, -0.778, -0.664,
        -0.544, -0.484, -0.457,
    ),
)  # fmt: skip
# a pump of Bingham's, 81, as RELAP5 and MOOSE's virtual test bed have its homologous curves
MIXED_81 = Suter(
    (
        0.000, 0.023, 0.047, 0.094, 0.143, 0.185, 0.207, 0.229, 0.254, 0.293, 0.350, 0.500, 0.532, 0.564, 0.658,
        0.752, 0.843, 0.930, 1.015, 1.086, 1.158, 1.229, 1.300, 1.333, 1.366, 1.367, 1.364, 1.362, 1.353, 1.337,
        1.423, 1.351, 1.279, 1.250, 1.279, 1.351, 1.423, 1.337, 1.353, 1.362, 1.364, 1.367, 1.370, 1.375, 1.380,
        1.356, 1.333, 1.309, 1.256, 1.172, 1.065, 0.958, 0.851, 0.727, 0.610, 0.500, 0.366, 0.176, 0.026, -0.124,
        -0.277, -0.434, -0.562, -0.688, -0.815, -0.928, -1.020, -1.117, -1.200, -1.254, -1.307, -1.360, -1.414,
        -1.400, -1.321, -1.243, -1.122, -1.000, -1.010, -1.020, -0.997, -0.917, -0.838, -0.629, -0.410, -0.249,
        -0.205, -0.109, 0.000,
    ),
    (
        -0.920, -0.829, -0.739, -0.648, -0.558, -0.421, -0.200, 0.000, 0.080, 0.159, 0.222, 0.285, 0.416, 0.535,
        0.641, 0.747, 0.847, 0.941, 1.041, 1.149, 1.297, 1.401, 1.440, 1.459, 1.475, 1.476, 1.477, 1.526, 1.535,
        1.524, 1.512, 1.429, 1.339, 1.250, 1.230, 1.183, 1.101, 1.023, 0.948, 0.908, 0.868, 0.831, 0.794, 0.793,
        0.800, 0.787, 0.775, 0.762, 0.768, 0.770, 0.753, 0.723, 0.673, 0.612, 0.555, 0.500, 0.417, 0.324, 0.231,
        0.136, -0.100, -0.399, -0.559, -0.663, -0.767, -0.882, -1.000, -1.350, -1.519, -1.641, -1.642, -1.550,
        -1.459, -1.367, -1.275, -1.183, -1.092, -1.000, -1.054, -1.109, -1.163, -1.217, -1.272, -1.326, -1.373,
        -1.329, -1.206, -0.999, -0.920,
    ),
)  # fmt: skip
TABLES = {"radial": RADIAL, "mixed 61": MIXED_61, "mixed 81": MIXED_81}


def in_four_quadrants(table: Suter, flow: float, rise: float, efficiency: float) -> tuple[PumpPieces, PumpPieces]:
    """Pieces of a pump for a rotor that turns forward, and backward, by its rated point in m³/s and Pa.

    Between two angles of the table F and G are straight lines over the angle, met at both and in the middle.

    References
    ----------
    B. Donsky: Complete pump characteristics and the effects of specific speeds on hydraulic transients, J. Basic Eng.
    83 (1961) 685-696, doi:10.1115/1.3662296; E. B. Wylie, V. L. Streeter: Fluid Transients in Systems (1993), ch. 7.

    Examples
    --------
    >>> forward, backward = in_four_quadrants(RADIAL, 0.02, 5e5, 0.8)
    >>> round(forward.at_rest), round(backward.at_rest)  # Pa, by a closed valve
    (644000, 317000)
    """
    steps = len(table.head) - 1
    quarter = steps // 4
    turning = range(quarter, 3 * quarter + 1), [*range(quarter, 0, -1), *range(steps, 3 * quarter - 1, -1)]
    found = []
    for places in turning:
        half = pi / steps
        ratios = [tan(k * half - pi / 2) for k in range(2, steps - 1)]  # of flow to speed, at places and between them
        rises, torques = (_forms([values[k] for k in places], ratios) for values in table)
        at_rest = table.head[places[quarter]]
        rises = [(a - at_rest, b, c) for a, b, c in rises]
        borders = [ratio * flow for ratio in ratios[::2]]
        scaled = _scaled(rises, rise, flow), _scaled(torques, rise * flow / efficiency, flow)
        found.append(PumpPieces(rise * at_rest, borders, *scaled))
    return found[0], found[1]


def _forms(values: list[float], ratios: list[float]) -> list[Form]:
    """Forms of (1 + x²)·F(arctan x) between the angles of a half turn, and beyond the outer ones."""
    between = [value for pair in pairwise(values[1:-1]) for value in (pair[0], (pair[0] + pair[1]) / 2)] + [values[-2]]
    there = [(1 + x**2) * value for x, value in zip(ratios, between, strict=True)]
    first, last = (
        (0.0, (y - value * x**2) / x, value)
        for x, y, value in ((ratios[0], there[0], values[0]), (ratios[-1], there[-1], values[-1]))
    )
    inner = [_through(ratios[k : k + 3], there[k : k + 3]) for k in range(0, len(ratios) - 2, 2)]
    return [first, *inner, last]


def _through(x: list[float], y: list[float]) -> Form:
    """Parabola through three points, by divided differences."""
    (x0, x1, x2), (y0, y1, y2) = x, y
    slope = (y1 - y0) / (x1 - x0)
    bend = ((y2 - y1) / (x2 - x1) - slope) / (x2 - x0)
    return y0 - slope * x0 + bend * x0 * x1, slope - bend * (x0 + x1), bend


def _scaled(forms: list[Form], size: float, flow: float) -> list[Form]:
    return [(size * a, size * b / flow, size * c / flow**2) for a, b, c in forms]
