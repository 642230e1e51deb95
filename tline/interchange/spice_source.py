"""What a SPICE source does over time, as waveforms of a scene."""

from typing import Any, NamedTuple

from tline.interchange.deck import Card
from tline.interchange.findings import Findings
from tline.interchange.spice_waveform import surge_factor

Waveform = float | dict[str, Any]  # as in a scene file
SHAPES = ("PULSE", "PWL", "SIN", "EXP")
MOST = {"PULSE": 7, "SIN": 6, "EXP": 6}  # numbers


class Transient(NamedTuple):
    """What .tran says."""

    step: float
    end: float
    uic: bool


class Said(NamedTuple):
    """What a source's card says: a constant level, a shape with its numbers, an internal resistance."""

    level: float
    shape: str
    numbers: list[float]
    resistance: float

    @property
    def is_zero(self) -> bool:
        """Whether nothing is prescribed but zero."""
        return not self.shape and self.level == 0 and self.resistance == 0

    @property
    def is_quiet(self) -> bool:
        """Whether it is zero up to t = 0."""
        if not self.shape:
            return self.level == 0
        if self.shape == "PWL":
            return self.numbers[1] == 0
        phase = self.numbers[5] if self.shape == "SIN" and len(self.numbers) > 5 else 0.0
        return self.numbers[0] == 0 and self.numbers[1] * phase == 0


def said_of(card: Card, found: Findings) -> Said:
    """What the words behind the nodes of a source say.

    Raises
    ------
    InputError
        The source is something else, or has numbers that no waveform has.
    """
    words, assigned = card.assigned(2)
    level = 0.0
    if "dc" in assigned:
        level, *rest = map(card.value, assigned.pop("dc"))
        if rest:
            raise card.refuse("DC with more than a level", "DC 5")
    resistance = _resistance(card, assigned)
    if words and words[0].upper() not in (*SHAPES, "AC", "DC"):
        level, words = card.value(words[0]), words[1:]
    shape, numbers = "", []
    while words:
        word, own = words[0].upper(), []
        if word not in (*SHAPES, "AC", "DC"):
            raise card.refuse("not known here", "DC, PULSE, PWL, SIN or EXP", f"'{words[0]:.40}'")
        words = words[1:]
        while words and words[0].upper() not in (*SHAPES, "AC", "DC"):
            own, words = [*own, words[0]], words[1:]
        if word == "AC":
            found.note(card.where, "its AC part is skipped")
        elif word == "DC":
            if len(own) != 1:
                raise card.refuse("DC without a level", "DC 5")
            level = card.value(own[0])
        elif shape:
            raise card.refuse("has two waveforms", "one", f"{shape} and {word}")
        else:
            shape, numbers = word, [card.value(each) for each in own]
    if shape and (len(numbers) < 2 or len(numbers) > MOST.get(shape, len(numbers))):
        expected = f"2 to {MOST[shape]}" if shape in MOST else "pairs of time and level"
        raise card.refuse(f"{shape} with {len(numbers)} numbers", expected)
    return Said(level, shape, numbers, resistance)


def _resistance(card: Card, assigned: dict[str, list[str]]) -> float:
    """Of LTspice's sources."""
    given = assigned.pop("rser", ["0"])
    if assigned or len(given) != 1:
        key = next(iter(assigned), "rser")
        raise card.refuse("has more than a waveform", "DC, PULSE, PWL, SIN or EXP", f"'{key}='")
    value = card.value(given[0])
    if value < 0:
        raise card.refuse("its resistance is below zero", "0 or more", f"{value:g}")
    return value


def waveforms(card: Card, said: Said, tran: Transient, factor: float) -> list[Waveform]:
    """Waveforms whose sum is the source times a factor.

    Raises
    ------
    InputError
        It has numbers that no waveform has.

    References
    ----------
    H. Vogt et al.: Ngspice User's Manual, chapter "Independent sources for voltage or current".
    """
    if not said.shape:
        return [factor * said.level]
    make = {"PULSE": _pulse, "PWL": _points, "SIN": _sine, "EXP": _exponential}[said.shape]
    return make(card, said.numbers, tran, factor)


def _given(numbers: list[float], k: int, default: float) -> float:
    """The k-th number; one that is left out or zero has a default."""
    return numbers[k] if k < len(numbers) and numbers[k] else default


def _pulse(card: Card, numbers: list[float], tran: Transient, factor: float) -> list[Waveform]:
    rise, fall = (_given(numbers, k, tran.step) for k in (3, 4))
    at, width, period = _given(numbers, 2, 0.0), _given(numbers, 5, tran.end), _given(numbers, 6, tran.end)
    pulse: dict[str, Any] = {"shape": "pulses", "low": factor * numbers[0], "high": factor * numbers[1], "at": at}
    pulse |= {"width": width, "rise": rise, "fall": fall}
    return [pulse | ({"period": period} if at + period < tran.end else {})]


def _points(card: Card, numbers: list[float], tran: Transient, factor: float) -> list[Waveform]:
    if len(numbers) % 2:
        raise card.refuse(f"PWL with {len(numbers)} numbers", "pairs of time and level")
    points = [[t, factor * level] for t, level in zip(numbers[::2], numbers[1::2], strict=True)]
    return [points[0][1]] if len(points) == 1 else [{"shape": "piecewise linear", "points": points}]


def _sine(card: Card, numbers: list[float], tran: Transient, factor: float) -> list[Waveform]:
    if _given(numbers, 4, 0.0):
        raise card.refuse("a sine that is damped", "THETA = 0", f"{numbers[4]:g}")
    sine: dict[str, Any] = {"shape": "sine", "offset": factor * numbers[0], "amplitude": factor * numbers[1]}
    sine |= {"frequency": _given(numbers, 2, 1 / tran.end), "at": _given(numbers, 3, 0.0)}
    return [sine | ({"phase": f"{numbers[5]!r} deg"} if len(numbers) > 5 else {})]


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
