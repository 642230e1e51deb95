"""Waveforms of a scene from the shapes of SPICE sources."""

from itertools import pairwise
from typing import Any

from tline.interchange.deck import Card
from tline.interchange.spice_source import Said, Transient
from tline.interchange.spice_waveform import surge_factor

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
