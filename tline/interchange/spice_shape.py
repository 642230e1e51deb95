"""Waveforms of a scene from the shapes of SPICE sources and as such shapes; gnucap's signal generator, as pulses."""

from itertools import pairwise
from math import exp, expm1
from typing import Any

import numpy as np

from tline.errors import InputError
from tline.interchange.deck import Card
from tline.interchange.findings import Findings
from tline.interchange.spice_source import Said, Transient
from tline.scene.scene import Scene
from tline.scene.waveform import Constant, DoubleExponential, Exponential, Pulses, Shape, Sine
from tline.solver.description.excitation import just_before

Waveform = float | dict[str, Any]  # as in a scene file
MOST_POINTS = 100_000


def waveforms(card: Card, said: Said, tran: Transient, factor: float) -> list[Waveform]:
    """Waveforms whose sum is the source times a factor.

    References
    ----------
    H. Vogt et al.: Ngspice User's Manual, chapter "Independent sources for voltage or current".
    """
    if not said.shape:
        return [factor * said.level]
    if said.shape == "PWL":
        return _points(card, said, tran, factor)
    make = {"PULSE": _pulse, "SIN": _sine, "EXP": _exponential, "SFFM": _frequency, "AM": _amplitude}[said.shape]
    return make(card, said.numbers, tran, factor)


def _given(numbers: list[float], k: int, default: float) -> float:
    """The k-th number; one that is left out or zero has a default."""
    return numbers[k] if k < len(numbers) and numbers[k] else default


def _pulse(card: Card, numbers: list[float], tran: Transient, factor: float) -> list[Waveform]:
    rise, fall = (_given(numbers, k, tran.step) for k in (3, 4))
    at, width, period = _given(numbers, 2, 0.0), _given(numbers, 5, tran.end), _given(numbers, 6, tran.end)
    pulse: dict[str, Any] = {"shape": "pulses", "low": factor * numbers[0], "high": factor * numbers[1], "at": at}
    pulse |= {"width": width, "rise": rise, "fall": fall}
    if at + period >= tran.end:
        return [pulse]
    count = round(_given(numbers, 7, 0.0))
    return [pulse | {"period": period} | ({"count": count} if count > 0 else {})]


def _points(card: Card, said: Said, tran: Transient, factor: float) -> list[Waveform]:
    """Straight lines, repeated from one of their points on where that is asked."""
    times, levels = said.numbers[::2], said.numbers[1::2]
    if len(times) != len(levels):
        raise card.refuse(f"PWL with {len(said.numbers)} numbers", "pairs of time and level")
    points = [[t, factor * level] for t, level in zip(times, levels, strict=True)]
    if said.repeat is not None:
        again, period = [point for point in points if point[0] >= said.repeat], times[-1] - said.repeat
        if said.repeat not in times or period <= 0 or any(b < a for a, b in pairwise(times)):
            raise card.refuse("points that are not repeated from one of them on", "R=0 or the time of a point")
        rounds = max((tran.end - said.delay - times[-1]) / period, 0.0)
        if rounds * len(again) > MOST_POINTS:
            raise card.refuse("too many repetitions", f"at most {MOST_POINTS} points", f"{rounds:.3g}")
        skipped = again[0][1] == again[-1][1]  # where no jump is, one point of the two at the seam
        points += [[t + k * period, level] for k in range(1, int(rounds) + 2) for t, level in again[skipped:]]
    points = [[t + said.delay, level] for t, level in points]
    return [points[0][1]] if len(points) == 1 else [{"shape": "piecewise linear", "points": points}]


def _sine(card: Card, numbers: list[float], tran: Transient, factor: float) -> list[Waveform]:
    frequency, at, damping = _given(numbers, 2, 1 / tran.end), _given(numbers, 3, 0.0), _given(numbers, 4, 0.0)
    sine: dict[str, Any] = {"shape": "sine", "offset": factor * numbers[0], "amplitude": factor * numbers[1]}
    sine |= {"frequency": frequency, "at": at} | ({"phase": f"{numbers[5]!r} deg"} if len(numbers) > 5 else {})
    cycles = _given(numbers, 6, 0.0)
    if damping < 0 or (damping and cycles):
        raise card.refuse("a sine that grows, or is damped and ends", "THETA at least 0, or no number of cycles")
    if damping:
        return [sine | {"shape": "modulated sine", "decay": 1 / damping}]
    return [sine | ({"until": at + cycles / frequency} if cycles > 0 else {})]


def _frequency(card: Card, numbers: list[float], tran: Transient, factor: float) -> list[Waveform]:
    sine: dict[str, Any] = {"shape": "modulated sine", "offset": factor * numbers[0], "amplitude": factor * numbers[1]}
    sine |= {"frequency": _given(numbers, 2, 1 / tran.end)}
    index = _given(numbers, 3, 0.0)
    return [sine | ({"index": index, "modulation": _given(numbers, 4, 1 / tran.end)} if index else {})]


def _amplitude(card: Card, numbers: list[float], tran: Transient, factor: float) -> list[Waveform]:
    """A modulated amplitude as its carrier and two side bands; all begin together, where the bands cancel."""
    if len(numbers) < 4:
        raise card.refuse(f"AM with {len(numbers)} numbers", "at least its amplitude, offset, signal and carrier")
    amplitude, offset, signal, carrier = numbers[:4]
    if not 0 < signal < carrier:
        raise card.refuse("a signal not below its carrier", "AM(SCALE OFFSET SIGNAL CARRIER)", f"{signal:g} Hz")
    at, half = _given(numbers, 4, 0.0), factor * amplitude / 2
    parts = [(2 * half * offset, carrier, 0.0), (half, carrier - signal, 90.0), (-half, carrier + signal, 90.0)]
    return [
        {"shape": "sine", "amplitude": size, "frequency": frequency, "at": at, "phase": f"{phase} deg"}
        for size, frequency, phase in parts
        if size
    ]


def _exponential(card: Card, numbers: list[float], tran: Transient, factor: float) -> list[Waveform]:
    """A rise, and a fall back that is added to it where it begins within the run."""
    low, high = factor * numbers[0], factor * numbers[1]
    begin, rise = _given(numbers, 2, 0.0), _given(numbers, 3, tran.step)
    back, fall = _given(numbers, 4, begin + tran.step), _given(numbers, 5, tran.step)
    if rise <= 0 or fall <= 0 or back < begin:
        raise card.refuse("EXP with times that make no pulse", "TAU1, TAU2 above zero and TD2 not before TD1")
    up = {"shape": "exponential", "from": low, "to": high, "at": begin, "time_constant": rise}
    down = {"shape": "exponential", "from": 0.0, "to": low - high, "at": back, "time_constant": fall}
    if low == 0 and back == begin and rise < fall:
        peak = high / surge_factor(rise, fall)
        return [{"shape": "double exponential", "peak": peak, "rise": rise, "decay": fall, "at": begin}]
    return [up] if back >= tran.end else [up, down]


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


COMMANDS = (".gen", ".generator")
SETTINGS = {  # its defaults, s and V
    "frequency": 0.0, "amplitude": 1.0, "phase": 0.0, "max": 1.0, "min": 0.0, "offset": 0.0, "initial": 0.0,
    "rise": 1e-12, "fall": 1e-12, "delay": 0.0, "width": 0.0, "period": 0.0,
}  # fmt: skip


def with_generator(cards: list[Card], found: Findings) -> list[Card]:
    """The cards, with a PULSE in place of each ``generator(SCALE)``."""
    settings = dict(SETTINGS)
    for card in cards:
        if card.name.lower() in COMMANDS:
            with found.gathered():
                settings |= _settings(card)
    plain = [card for card in cards if card.name.lower() not in COMMANDS]
    return [_pulsed(card, settings, found) for card in plain]


def _settings(card: Card) -> dict[str, float]:
    """What a command sets; words may be cut short."""
    given = {}
    for word, values in card.assigned(0)[1].items():
        names = [name for name in SETTINGS if name.startswith(word)]
        if not names or len(values) != 1:
            raise card.refuse("not a setting of the generator", ", ".join(SETTINGS), f"'{word:.40}'")
        given[names[0]] = card.value(values[0])
    return given


def _pulsed(card: Card, settings: dict[str, float], found: Findings) -> Card:
    words = card.words
    if card.kind not in "VI" or len(words) < 3 or words[2].lower() not in ("gen", "generator"):
        return card
    with found.gathered():
        low, high = (settings["amplitude"] * settings[key] + settings["offset"] for key in ("min", "max"))
        if settings["frequency"] or settings["initial"] != low or len(words) > 4:
            raise card.refuse("a generator of other than pulses from its initial value", "frequency 0, initial = min")
        scale = card.value(words[3]) if len(words) > 3 else 1.0
        times = [settings[key] for key in ("delay", "rise", "fall", "width", "period")]
        return card._replace(words=[*words[:2], "PULSE", *map(repr, (scale * low, scale * high, *times))])
    return card._replace(words=[*words[:2], "0"])
