"""Growth rate of the waves of a scene with active parts."""

from dataclasses import dataclass

import numpy as np

from tline.errors import InputError
from tline.solver.description.description import Description
from tline.solver.stability.zeros import Box, Characteristic, UncountableError, zeros

NEGLIGIBLE = 1e-3  # relative growth within a run that is ignored
PERIODS = 4  # resonances of the shortest line that the searched band includes at least
OVER_CORNER = 4.0  # highest searched frequency over the highest corner frequency of the loads
ALIKE = 1e-6  # relative difference of growth rates that count as equal
SAMPLES = 4.0  # on the boundary, per radian of phase of all delays together
MOST_WORK = 3e9  # floating-point operations of all determinants, beyond which no search is made


@dataclass(frozen=True)
class Growth:
    """Fastest growing wave of a scene."""

    # of the waves exp(st) that grow fastest, the exponent, in 1/s; None if none grows by more than 0.1 % in the run
    s: complex | None
    highest: float  # highest angular frequency searched, rad/s


def growth(description: Description) -> Growth | None:
    """Fastest growing wave of a scene after its last switch has moved, None if it is too large to be searched.

    Zeros of the characteristic function are counted by the argument principle, on samples of the boundary: reliable,
    not certified. Beyond the searched frequencies waves may grow too, but with loads that have settled to constants
    there the same growth rates come again and again.

    Examples
    --------
    >>> from tline.scene.scene import Scene
    >>> from tline.solver.description.description import describe
    >>> scene = Scene(
    ...     medium="electrical", t_end=9,
    ...     lines={"line": {"nodes": ["near", "far"], "z0": 1, "delay": 1}},
    ...     sources={"s": {"at": "near", "kind": "voltage", "value": 1, "resistance": 3}},
    ...     loads={"amplifier": {"at": "far", "kind": "impedance", "expression": "-5"}},
    ...     probes={"far": {"at": "far"}},
    ... )
    >>> growth(describe(scene))  # one round trip takes 2 s and multiplies by 1/2 and 3/2: decays
    Growth(s=None, highest=25.132741228718345)
    """
    D = Characteristic(description)
    high = max(OVER_CORNER * D.corner, 2 * np.pi * PERIODS)
    step = 1 / (SAMPLES * 2 * D.delays.sum())
    if high / step * (2 * len(D.z0)) ** 3 > MOST_WORK:
        return None
    least = NEGLIGIBLE * D.second / description.t_end
    try:
        box = Box(least, right_of_all(D, high, least), -1.37e-4 * high, high)
        s, found = None, zeros(D.log, box, step, rightmost=True)
        while found:  # of waves that grow alike, the slowest to turn
            (s,) = found
            found = zeros(D.log, _below(s, box), step, rightmost=True)
    except UncountableError:
        return None
    return Growth(None if s is None else complex(s.real, abs(s.imag)) / D.second, high / D.second)


def _below(s: complex, box: Box) -> Box:
    return box._replace(left=s.real * (1 - ALIKE), high=max(s.imag - ALIKE * box.high, box.low + ALIKE * box.high))


def right_of_all(D: Characteristic, high: float, least: float) -> float:
    """Real part to the right of all zeros: the round-trip gain is below 1 there at all frequencies."""
    right = max(D.corner, least, 1.0)
    while True:
        s = right + 1j * np.linspace(0.0, high, 257)
        if np.abs(D.returned(s)).sum(axis=2).max() < 1:
            return right
        right *= 1.5


def growth_sentence(description: Description) -> str:
    """Describe each active part of a scene, and the growth of waves that they cause, in one sentence each."""
    parts = "; ".join(f"{where} {told}" for where, told in description.active.items())
    why = "the scene is too large to search, or its waves lie too close together"
    try:
        found = growth(description)
    except InputError as error:
        found, why = None, f"{error.where} {error.problem}"
    if found is None:
        return f"{parts}; whether the waves grow was not found out: {why}"
    if found.s is None:
        return f"{parts}; yet no wave grows by more than 0.1 % within the run"
    s = complex(found.s)
    turning = f", turning with {abs(s.imag):.4g} rad/s" if abs(s.imag) > 1e-9 * abs(s) else ""
    return f"{parts}; waves grow by a factor e every {1 / s.real:.4g} s{turning}"
