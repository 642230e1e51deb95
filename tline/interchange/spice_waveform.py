"""Waveforms of a scene as SPICE sources say them."""

from itertools import pairwise
from math import exp, expm1

import numpy as np

from tline.errors import InputError
from tline.scene.scene import Scene
from tline.scene.waveform import Constant, DoubleExponential, Exponential, Pulses, Shape, Sine
from tline.solver.description.excitation import just_before

SAME = 1e-12  # levels that differ by less, relatively, are no jump
INSTANT = 1e-30  # s, in place of a zero, for which SPICE takes a default


def surge_factor(rise: float, decay: float) -> float:
    """k of a surge k·(e^(-t/decay) - e^(-t/rise)) whose peak is 1."""
    at_rise = DoubleExponential.model_validate({"peak": 1.0, "rise": rise, "decay": decay}).value(*2 * [np.array(rise)])
    return float(at_rise) / (-exp(-rise / decay) * expm1(rise / decay - 1))


def spice_waveform(waveform: Shape, scene: Scene, where: str, rise: float | None) -> str:
    """A waveform as a source's card says it; a jump takes the time `rise`, if there is one."""
    far, number = 2 * float(scene.t_end), lambda *values: " ".join(repr(float(value)) for value in values)
    match waveform:
        case Constant():
            return f"DC {number(waveform.level)}"
        case Sine() if waveform.until is None:
            phase = np.degrees(float(waveform.phase))
            return f"SIN({number(waveform.offset, waveform.amplitude, waveform.frequency, waveform.at, 0, phase)})"
        case Exponential():
            w, back = waveform, max(float(waveform.at), 0.0) + far
            return f"EXP({number(w.from_, w.to, w.at, w.time_constant, back, w.time_constant)})"
        case DoubleExponential():
            w, k = waveform, surge_factor(float(waveform.rise), float(waveform.decay))
            at = w.at or INSTANT
            return f"EXP({number(0, w.peak * k, at, w.rise, at, w.decay)})"
        case Pulses() if waveform.rise and waveform.fall and waveform.count is None:
            w = waveform
            period = w.period or far + abs(w.at) + w.rise + w.width + w.fall
            return f"PULSE({number(w.low, w.high, w.at, w.rise, w.fall, w.width, period)})"
    points = _corners(waveform, scene, where, rise)
    return (
        f"PWL({number(*(x for point in points for x in point))})" if len(points) > 1 else f"DC {number(points[0][1])}"
    )


def _corners(waveform: Shape, scene: Scene, where: str, rise: float | None) -> list[tuple[float, float]]:
    """Points of a waveform of straight pieces from t = 0 on; from rest, what was before does not count."""
    if np.isfinite(waveform.fastest()):
        raise InputError(f"{where}.value", "no source of SPICE does that", "a sine without its end, or points")
    end = float(scene.t_end)
    breaks = waveform.breaks(end)
    edges = [0.0, *breaks[(breaks > 0) & (breaks < end)].tolist(), end]
    points = [(0.0, just_before(waveform))] if scene.start == "steady" else []
    for start, stop in pairwise(edges):
        inside = np.array((start + stop) / 2)
        first, last = (float(waveform.value(np.array(t), inside)) for t in (start, stop))
        if not points:
            points.append((start, first))
        elif abs(first - points[-1][1]) > SAME * max(abs(first), abs(points[-1][1])):
            if rise is None or rise >= stop - start:
                problem = f"jumps at {start:.6g} s, and SPICE has no jumps"
                raise InputError(f"{where}.value", problem, f"a rise time below {stop - start:.3g} s", _time(rise))
            points.append((start + rise, float(waveform.value(np.array(start + rise), inside))))
        points.append((stop, last))
    return points if len({level for _, level in points}) > 1 else points[:1]


def _time(rise: float | None) -> str:
    return "none" if rise is None else f"{rise:g} s"
