"""Pump: rise and torque are quadratic forms of speed N and flow q, piece by piece of q/|N|: affinity holds exactly.

Constants: effort beyond the element, rise at rest at N = 1, 1 with a check valve, twice the energy of the rotor at
N = 1, rise at rest at N = -1, the numbers of pieces for N >= 0 and for N < 0, the motor's torque times the rated speed
when it starts, and the present one. Then for each of these two the inner borders of q/|N|, forms (a, b, c) of rise
less rise at rest = a N² + b |N| q + c q², and forms of the torque at N = 1. The control signal of a pump is its speed
over the rated one.
"""

import numpy as np

from tline.compiled.unit import function, unit
from tline.solver.kernel.laws.crossing import sampled
from tline.solver.kernel.network import Crossing

MOTOR, NOW, TABLES = 7, 8, 9  # the last where the pieces begin


@function
def pieces_of(c, at, speed):
    """Place of the borders of the pieces for a speed, and number of pieces."""
    forward = int(c[at + 5])
    if speed >= 0.0:
        return at + TABLES, forward
    return at + TABLES + 7 * forward - 1, int(c[at + 6])


@function
def resting(c, at, speed):
    """Rise at rest."""
    return (c[at + 1] if speed >= 0.0 else c[at + 4]) * speed**2


@function
def pumped(c, at, speed, d, z):
    """Flow i and di/dd where d + rise less rise at rest = z i."""
    if c[at + 2] > 0.0 and d < 0.0:
        return 0.0, 0.0
    n = abs(speed)
    first, count = pieces_of(c, at, speed)
    forms, low, high = first + count - 1, 0, count - 1
    while low < high:
        middle = (low + high) // 2
        q, f = n * c[first + middle], forms + 3 * middle
        if d > z * q - (c[f] * n * n + c[f + 1] * n * q + c[f + 2] * q * q):
            low = middle + 1
        else:
            high = middle
    f = forms + 3 * low
    rest, steep, bend = d + c[f] * n * n, z - c[f + 1] * n, -c[f + 2]
    root = np.sqrt(max(steep * steep + 4.0 * bend * rest, 0.0))
    if root == 0.0:
        return 0.0, 0.0
    i = 2.0 * rest / (steep + root) if steep > 0.0 or bend == 0.0 else (root - steep) / (2.0 * bend)
    return i, 1.0 / root


@function
def torque(c, at, speed, i):
    """Torque at a flow i, times the rated speed."""
    n = abs(speed)
    first, count = pieces_of(c, at, speed)
    f = first + 4 * count - 1
    for k in range(count - 1):
        if i > n * c[first + k]:
            f += 3
    return c[f] * n * n + c[f + 1] * n * i + c[f + 2] * i * i


@function
def driven(c, at, control, d, z):
    """Flow i and di/dd of a pump, whose speed is not below zero."""
    speed = max(control, 0.0)
    return pumped(c, at, speed, d + resting(c, at, speed), z)


@unit
def pump(crossing: Crossing, at: int, n: int, z: float) -> int:
    """Flows of a pump at n samples, behind the efforts v and the impedance z."""
    return sampled(driven, crossing, at, n, z)
