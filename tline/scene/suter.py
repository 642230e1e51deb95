"""Pumps in all four quadrants: head and torque over the angle between speed and flow.

With speed n, flow q, head h and torque b over those of the rated point, h = (n² + q²)·F(φ) and b = (n² + q²)·G(φ),
where φ is the angle of (n, q) from -π to π (P. Suter, 1966).
"""

from itertools import pairwise
from math import pi, tan
from typing import NamedTuple

from tline.scene.pump_pieces import Form, PumpPieces


class Suter(NamedTuple):
    """F and G at equal steps of the angle from -π to π."""

    head: tuple[float, ...]
    torque: tuple[float, ...]


# a radial pump, with the figures that ThermoSysPro's library of models has (CentrifugalPump, EDF)
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
TABLES = {"radial": RADIAL}


def in_four_quadrants(kind: str, flow: float, rise: float, efficiency: float) -> tuple[PumpPieces, PumpPieces]:
    """Pieces of a pump for a rotor that turns forward, and backward.

    Between two angles of the table F and G are straight lines over the angle, met at both and in the middle.

    Parameters
    ----------
    kind : str
        Of TABLES.
    flow, rise, efficiency : float
        Of the rated point: m³/s, Pa, 0 to 1.

    References
    ----------
    B. Donsky: Complete pump characteristics and the effects of specific speeds on hydraulic transients, J. Basic Eng.
    83 (1961) 685-696, doi:10.1115/1.3662296; E. B. Wylie, V. L. Streeter: Fluid Transients in Systems (1993), ch. 7.

    Examples
    --------
    >>> forward, backward = in_four_quadrants("radial", 0.02, 5e5, 0.8)
    >>> round(forward.at_rest), round(backward.at_rest)  # Pa, by a closed valve
    (644000, 317000)
    """
    table = TABLES[kind]
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
    """Forms of (1 + x²)·F(arctan x) between the angles of a half turn, and beyond the outer ones of these."""
    between = [value for pair in pairwise(values[1:-1]) for value in (pair[0], (pair[0] + pair[1]) / 2)] + [values[-2]]
    there = [(1 + x**2) * value for x, value in zip(ratios, between, strict=True)]
    first, last = (
        (0.0, (y - value * x**2) / x, value)
        for x, y, value in ((ratios[0], there[0], values[0]), (ratios[-1], there[-1], values[-1]))
    )
    inner = [_through(ratios[k : k + 3], there[k : k + 3]) for k in range(0, len(ratios) - 2, 2)]
    return [first, *inner, last]


def _through(x: list[float], y: list[float]) -> Form:
    """The parabola through three points, by divided differences."""
    (x0, x1, x2), (y0, y1, y2) = x, y
    slope = (y1 - y0) / (x1 - x0)
    bend = ((y2 - y1) / (x2 - x1) - slope) / (x2 - x0)
    return y0 - slope * x0 + bend * x0 * x1, slope - bend * (x0 + x1), bend


def _scaled(forms: list[Form], size: float, flow: float) -> list[Form]:
    return [(size * a, size * b / flow, size * c / flow**2) for a, b, c in forms]
