"""Options, keywords, comments of ports and numbers of a Touchstone file, as they are written.

A line of an odd number of numbers begins with a frequency, one of an even number continues the sample with pairs.

References
----------
Touchstone File Format Specification, version 1.1, EIA/IBIS Open Forum, 2002; version 2.0, IBIS Open Forum, 2009.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NoReturn

from passivity.errors import ExpressionError
from passivity.sampled.response import MAX_PORTS

UNITS = {"hz": 1.0, "khz": 1e3, "mhz": 1e6, "ghz": 1e9}
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][-+]?\d+)?")
KEYWORD = re.compile(r"\[([^\]]*)\]\s*(.*)")
# what field solvers write of the ports beside each sample, by lines of which it may go on
PORTS = re.compile(r"!\s*(gamma|port impedance)?((?:\s*[-+]?[\d.]+(?:e[-+]?\d+)?)+)\s*", re.IGNORECASE)
WAVES = re.compile(r"!\s*S-parameter uses the (power|pseudo|traveling) definition\.?", re.IGNORECASE)


@dataclass
class TouchstoneText:
    """Contents of a Touchstone file, number by number."""

    path: str  # named in errors
    ports: int  # by the suffix, 0 if it does not tell
    unit: float = 1e9  # hertz
    parameter: str = "s"
    form: str = "ma"
    resistances: list[float] = field(default_factory=lambda: [50.0])
    keywords: dict[str, str] = field(default_factory=dict)
    samples: list[list[str]] = field(default_factory=list)
    impedances: list[list[float]] = field(default_factory=list)  # of the ports, in comments beside the samples
    waves: str = "traveling"  # of those impedances

    def refuse(self, problem: str, expected: str = "", got: str = "") -> NoReturn:
        """Raise an error that never quotes the file, for a scene may name any."""
        raise ExpressionError(self.path, problem, expected, got)

    @property
    def half(self) -> str:
        """Which triangle of the symmetric matrices is written: lower, upper, or none if they are full."""
        return self.keywords.get("matrix format", "full").lower().replace("full", "")

    @property
    def entries(self) -> int:
        """Number of entries of a matrix that are written."""
        return self.ports * (self.ports + 1) // 2 if self.half else self.ports**2


def parse(path: str, text: str, ports: int) -> TouchstoneText:
    """Read the text of a file; `ports` are those of the suffix, or 0."""
    found = TouchstoneText(path, ports)
    lines = [(n, line.strip()) for n, line in enumerate(text.splitlines(), 1) if line.strip()]
    _comments(found, [line for _, line in lines if line[0] == "!"])
    stripped = ((n, line.partition("!")[0].strip()) for n, line in lines)
    content = iter([(n, line) for n, line in stripped if line])
    options = 0
    for n, line in content:
        if line[0] == "#":
            options += 1
            if options == 1:  # others count for nothing
                _options(found, line[1:].lower().split())
        elif line[0] == "[":
            if not _keyword(found, n, line, content):
                break
        else:
            if not options:
                found.refuse(f"not a Touchstone file: line {n} is before the option line", "# Hz S RI R 50 or the like")
            if not _numbers(found, n, line.split()):
                break
    if not options or not found.samples:
        found.refuse("not a Touchstone file", "samples, Touchstone version 1 or 2")
    _check(found)
    return found


def _options(found: TouchstoneText, words: list[str]) -> None:
    """Frequency unit, parameter, format and R with a resistance, or one for each port, in any order."""
    while words:
        word = words.pop(0)
        if word in UNITS:
            found.unit = UNITS[word]
        elif word in ("s", "y", "z", "g", "h"):
            found.parameter = word
        elif word in ("ri", "ma", "db"):
            found.form = word
        elif word == "r" and words:
            found.resistances = []
            while words and words[0] not in UNITS and words[0] not in ("s", "y", "z", "g", "h", "ri", "ma", "db"):
                found.resistances.append(_resistance(found, words.pop(0)))
        else:
            found.refuse("not a Touchstone file: its option line", "# Hz S RI R 50 or the like")


def _resistance(found: TouchstoneText, word: str) -> float:
    try:
        value = float(word)
    except ValueError:
        found.refuse("reference impedance in the option line", "a number above 0")
    if not 0 < value < float("inf"):
        found.refuse("reference impedance", "finite, real parts above 0", f"{value:g}")
    return value


def _keyword(found: TouchstoneText, n: int, line: str, content: Iterator[tuple[int, str]]) -> bool:
    """Keep a keyword; whether data of the network may follow."""
    parts = KEYWORD.fullmatch(line)
    if not parts:
        found.refuse(f"not a Touchstone file: line {n} is no keyword", "[...]")
    name, rest = " ".join(parts[1].lower().split()), parts[2].strip()
    if name == "begin information":
        for _, line in content:
            if line.lower().startswith("[end information"):
                break
    elif name == "number of ports":
        if not re.fullmatch(r"\d{1,2}", rest) or not 0 < int(rest) <= MAX_PORTS:
            found.refuse("[Number of Ports]", f"1 to {MAX_PORTS}", "" if len(rest) > 20 else rest or "nothing")
        found.ports = int(rest)
    elif name == "reference":
        values = rest.split()
        while len(values) < found.ports and NUMBER.match(line := next(content, (0, ""))[1]):
            values += line.split()
        if len(values) != found.ports:
            found.refuse("[Reference]", f"{found.ports} resistances, one for each port", f"{len(values)}")
        found.resistances = [_resistance(found, word) for word in values]
    found.keywords[name] = rest
    return name not in ("noise data", "end")


def _numbers(found: TouchstoneText, n: int, words: list[str]) -> bool:
    """Add a line of numbers to the samples; whether it is not the first of noise."""
    if not all(NUMBER.fullmatch(word) for word in words):
        found.refuse(f"not a Touchstone file: line {n} is not of numbers", "samples")
    words = [word.lower().replace("d", "e") for word in words]
    if len(words) % 2 == 0:
        if not found.samples:
            found.refuse(f"line {n} has {len(words)} numbers", "a frequency, and pairs")
        found.samples[-1] += words
        return True
    if found.samples and found.ports == 2 and len(words) == 5 and float(words[0]) <= float(found.samples[-1][0]):
        return False
    found.samples.append(words)
    return True


def _comments(found: TouchstoneText, lines: list[str]) -> None:
    """Read impedances of ports and the kind of waves from comments."""
    block = None
    for line in lines:
        if waves := WAVES.fullmatch(line):
            found.waves = waves[1].lower()
        parts = PORTS.fullmatch(line)
        if not parts:
            block = None
            continue
        if parts[1]:
            block = [] if parts[1].lower() == "port impedance" else None
            if block is not None:
                found.impedances.append(block)
        if block is not None:
            try:
                block += [float(word) for word in parts[2].split()]
            except ValueError:
                found.refuse("reference impedance in a comment", "numbers")


def _check(found: TouchstoneText) -> None:
    """Whether all fits together."""
    version, ports = found.keywords.get("version", "1"), found.ports
    if not ports:
        found.refuse("[Number of Ports]", f"1 to {MAX_PORTS}", "nothing")
    if found.half not in ("", "lower", "upper"):
        found.refuse("[Matrix Format]", "Full, Lower or Upper")
    if len(found.resistances) not in (1, ports):
        found.refuse("reference impedance", f"one, or {ports} for the ports", f"{len(found.resistances)}")
    order = found.keywords.get("two-port data order", "" if version[:1] == "2" and not found.half else "21_12")
    if ports == 2 and order not in ("12_21", "21_12"):
        found.refuse("[Two-Port Data Order] of two ports in version 2", "12_21 or 21_12")
    wanted = 1 + 2 * found.entries
    wrong = next((k for k, sample in enumerate(found.samples) if len(sample) != wanted), None)
    if wrong is not None:
        got, root = len(found.samples[wrong]), round(((len(found.samples[wrong]) - 1) / 2) ** 0.5)
        others = f", as of {root} port{'s' * (root > 1)}" if not found.half and got == 1 + 2 * root**2 and root else ""
        expected = f"{wanted}, a frequency and those of {ports} port{'s' * (ports > 1)}"
        found.refuse(f"numbers of sample {wrong + 1}", expected, f"{got}{others}")
    told = found.keywords.get("number of frequencies", f"{len(found.samples)}")
    if told != f"{len(found.samples)}":
        found.refuse("samples", f"{told[:12]} by [Number of Frequencies]", f"{len(found.samples)}")
