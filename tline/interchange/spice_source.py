"""What the card of a SPICE source says: a level, a shape with its numbers, a resistance."""

from typing import NamedTuple

from tline.interchange.deck import Card
from tline.interchange.findings import Findings

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


class Transient(NamedTuple):
    """What .tran says."""

    step: float
    end: float
    uic: bool
    runs: bool = True  # or else .ac asks for frequencies alone


class Said(NamedTuple):
    """What a source's card says: a constant level, a shape with its numbers, an internal resistance."""

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
    """What the words behind the nodes of a source say."""
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
                raise card.refuse("DC without a level", "DC 5")
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
    """Words without those of a port, by 'name value' or 'name=value', and its resistance; 0 of what is no port."""
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
    given = {name: _single(card, assigned, name) for name in ARGUMENTS[shape] if name in assigned}
    last = max((ARGUMENTS[shape].index(name) for name in given), default=-1)
    return [given.get(name, 0.0) for name in ARGUMENTS[shape][: last + 1]]
