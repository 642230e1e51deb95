"""Sources of SPICE: their cards, waveforms of a scene from their shapes and back, and gnucap's generator."""

from itertools import pairwise
from math import exp, expm1
from typing import Any, NamedTuple

import numpy as np

from tline.errors import InputError
from tline.interchange.deck import Card, Findings
from tline.scene.scene import Scene
from tline.scene.waveform import Constant, DoubleExponential, Exponential, Pulses, Shape, Sine
from tline.solver.description.excitation import just_before

ARGUMENTS = {  # numbers of each shape, by the names that gnucap has for them
    "PULSE": ("iv", "pv", "delay", "rise", "fall", "width", "period", "count"),
    "SIN": ("offset", "amplitude", "frequency", "delay", "damping", "phase", "count"),
    "EXP": ("iv", "pv", "td1", "tau1", "td2", "tau2"),
    "SFFM": ("offset", "amplitude", "carrier", "modindex", "signal"),
    "AM": ("amplitude", "offset", "signal", "carrier", "delay"),
    "PWL": (),
}
PORTNUM = "portnum"
PORT, USUAL_Z0 = (PORTNUM, "z0", "pwr", "freq", "phase"), "50"  # power does not count
ALIASES = {"SINE": "SIN", "PU": "PULSE"}
WORDS = {*ARGUMENTS, *ALIASES, "AC", "DC"}
EXPECTED = "DC, PULSE, PWL, SIN, EXP, SFFM or AM"
MOST_POINTS = 100_000
SMALLEST_JUMP = 1e-12  # levels that differ by less, relatively, are no jump
INSTANT = 1e-30  # s, in place of a zero, for which SPICE takes a default
COMMANDS = (".gen", ".generator")
SETTINGS = {  # its defaults, s and V
    "frequency": 0.0, "amplitude": 1.0, "phase": 0.0, "max": 1.0, "min": 0.0, "offset": 0.0, "initial": 0.0,
    "rise": 1e-12, "fall": 1e-12, "delay": 0.0, "width": 0.0, "period": 0.0,
}  # fmt: skip


class Transient(NamedTuple):
    """Parameters of .tran."""

    step: float
    end: float
    uic: bool
    runs: bool = True  # or else .ac asks for frequencies alone


class Said(NamedTuple):
    """Parameters of a source's card: a constant level, a shape with its numbers, an internal resistance."""

    level: float
    shape: str
    numbers: list[float]
    resistance: float
    repeat: float | None = None  # instant from which points are repeated
    delay: float = 0.0  # of points
    alternating: bool = False  # whether it has an AC part

    def is_zero(self, tran: Transient) -> bool:
        """Whether nothing is prescribed but zero."""
        silent = tran.runs or not self.alternating
        return not self.shape and self.level == 0 and self.resistance == 0 and silent

    @property
    def is_quiet(self) -> bool:
        """Whether it is zero up to t = 0."""
        if not self.shape:
            return self.level == 0
        if self.shape == "PWL":
            return self.numbers[1] == 0
        phase = self.numbers[5] if self.shape == "SIN" and len(self.numbers) > 5 else 0.0
        return self.shape == "AM" or (self.numbers[0] == 0 and self.numbers[1] * phase == 0)


def said_of(card: Card, found: Findings) -> Said:
    """Read the words behind the nodes of a source."""
    words, assigned = card.assigned(2)
    words, port = _without_port(card, words, assigned)
    level, shape, numbers = 0.0, "", []
    if "dc" in assigned:
        level, *after = assigned.pop("dc")
        level, words = card.value(level), [*words, *after]
    alternating = assigned.pop("ac", None) is not None
    resistance = _single(card, assigned, "rser") + port
    if words and words[0].upper() not in WORDS:
        level, words = card.value(words[0]), words[1:]
    repeat = None
    while words:
        word, own = words[0].upper(), []
        if word not in WORDS:
            raise card.refuse("not known here", EXPECTED, f"'{words[0]:.40}'")
        words = words[1:]
        while words and words[0].upper() not in WORDS:
            own, words = [*own, words[0]], words[1:]
        if word == "AC":
            alternating = True
        elif word == "DC":
            if len(own) != 1:
                raise card.refuse("DC without a level", "DC 5, then perhaps " + EXPECTED, f"'{' '.join(own):.40}'")
            level = card.value(own[0])
        elif shape:
            raise card.refuse("has two waveforms", "one", f"{shape} and {word}")
        else:
            shape = ALIASES.get(word, word)
            if shape == "PWL" and own[-1:] in (["R"], ["r"]):
                own, repeat = own[:-1], 0.0
            numbers = [card.value(each) for each in own] or _named(card, shape, assigned)
            if shape == "PWL":
                _after(card, found, own, numbers)
    if alternating:
        found.note(card.where, "its AC part is skipped")
    delay = 0.0
    if shape == "PWL":
        repeat = _single(card, assigned, "r") if "r" in assigned else repeat
        delay = _single(card, assigned, "td")
    if assigned:
        raise card.refuse("has more than a waveform", EXPECTED, f"'{next(iter(assigned)):.40}='")
    most = len(ARGUMENTS.get(shape, ())) or len(numbers)
    if shape and not 2 <= len(numbers) <= most:
        expected = f"2 to {most}" if ARGUMENTS[shape] else "pairs of time and level"
        raise card.refuse(f"{shape} with {len(numbers)} numbers", expected)
    if resistance < 0:
        raise card.refuse("its resistance is below zero", "0 or more", f"{resistance:g}")
    return Said(level, shape, numbers, resistance, None if repeat is None or repeat < 0 else repeat, delay, alternating)


def _without_port(card: Card, words: list[str], assigned: dict[str, list[str]]) -> tuple[list[str], float]:
    """Words without those of a port, by 'name value' or 'name=value', and its resistance; 0 without a port."""
    given = {key: " ".join(assigned.pop(key)) for key in PORT if key in assigned} if PORTNUM in assigned else {}
    at = next((k for k, word in enumerate(words) if word.lower() == PORTNUM), len(words))
    named = [word.lower() for word in words[at::2]]
    if not {*named} <= {*PORT}:
        raise card.refuse("not a port", "portnum 1 z0 50", f"'{' '.join(words[at:]):.40}'")
    given |= dict(zip(named, words[at + 1 :: 2], strict=False))
    return words[:at], card.value(given.get("z0", USUAL_Z0)) if PORTNUM in given else 0.0


def _after(card: Card, found: Findings, words: list[str], numbers: list[float]) -> None:
    """Add the time of the point in front to times that begin with a plus, as LTspice has it."""
    behind = [k for k in range(2, len(words), 2) if words[k].startswith("+")]
    for k in behind:
        numbers[k] += numbers[k - 2]
    if behind:
        found.note(card.where, "times with + count from the point in front, as in LTspice")


def _single(card: Card, assigned: dict[str, list[str]], key: str) -> float:
    """The value of a key, which is taken out; zero without it."""
    words = assigned.pop(key, ["0"])
    if len(words) != 1:
        raise card.refuse(f"{key.upper()} is not one number", f"{key.upper()}=0", f"'{' '.join(words):.40}'")
    return card.value(words[0])


def _named(card: Card, shape: str, assigned: dict[str, list[str]]) -> list[float]:
    """Numbers of a shape by their names, in their order; those that are left out are zero."""
    full = {key: name for key in assigned for name in ARGUMENTS[shape] if name.startswith(key) and len(key) > 1}
    given = {name: _single(card, assigned, key) for key, name in full.items()}
    last = max((ARGUMENTS[shape].index(name) for name in given), default=-1)
    return [given.get(name, 0.0) for name in ARGUMENTS[shape][: last + 1]]


Waveform = float | dict[str, Any]  # as in a scene file


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
    """Points of a waveform of straight pieces from t = 0 on; from rest, the value before does not count."""
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
        elif abs(first - points[-1][1]) > SMALLEST_JUMP * max(abs(first), abs(points[-1][1])):
            if rise is None or rise >= stop - start:
                problem = f"jumps at {start:.6g} s, and SPICE has no jumps"
                raise InputError(f"{where}.value", problem, f"a rise time below {stop - start:.3g} s", _time(rise))
            points.append((start + rise, float(waveform.value(np.array(start + rise), inside))))
        points.append((stop, last))
    return points if len({level for _, level in points}) > 1 else points[:1]


def _time(rise: float | None) -> str:
    return "none" if rise is None else f"{rise:g} s"


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
    """Return the settings of a command; words may be cut short."""
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
