"""A SPICE netlist as cards: files included, lines joined, comments cut, every card with its file and line number.

No parser from elsewhere: those that are maintained list devices and leave sources, expressions and models as text.
"""

import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from itertools import count, pairwise
from pathlib import Path
from typing import NamedTuple

from tline.errors import InputError, SceneError
from tline.interchange.spice_expression import PARAMETERS, Parameters, assignments, parse_value
from tline.scene.mistakes import limited
from tline.scene.text_file import Folder, read_text

LONGEST = 400  # characters shown of a card
MOST_CARDS, MOST_FILES, DEEPEST = 100_000, 100, 20
COMMENT = re.compile(r";.*|//.*|(?:^|\s)\$(?![Gg]_\w).*")  # $G_NAME is a node of Xyce, the same in all subcircuits
WORD = re.compile(r"\{[^{}]*\}|'[^']*'|\"[^\"]*\"|=|[^\s(),={}'\"]+")
FILE = re.compile(r"\.\w+\s+(?:\"([^\"]*)\"|'([^']*)'|(\S+))\s*(\S*)")
OTHERS_LIBRARY = re.compile(r"[A-Za-z]:[\\/]")  # such as LTspice names for each diode, whether it has a model or not
INCLUDES = (".include", ".inc", ".incl", ".lib")
OTHER_RUNS = (".alter", ".modify", ".mo", ".fault")  # HSPICE's and gnucap's: change the circuit, and run again
LUMPED = "YTRANSLINE"  # in Xyce, in place of the first letter of its name
OVER_FREQUENCY = ".ac", ".sp"
WITHIN_CONTROL = {
    "tran": ".tran",
    "ac": ".ac",
    "sp": ".sp",
    "plot": ".plot",
    "print": ".print",
    "save": ".save",
    "write": ".save",
    "meas": ".meas",
}


class Findings:
    """Mistakes and notes of one file, in the order of their discovery.

    Examples
    --------
    >>> found = Findings()
    >>> with found.gathered():
    ...     raise InputError("c.cir, line 3, Q1", "a transistor")
    >>> found.note("c.cir, line 4, .options", "skipped")
    >>> found.notes, len(found.mistakes)
    (['c.cir, line 4, .options: skipped'], 1)
    """

    def __init__(self):
        self.mistakes: list[InputError] = []
        self.notes: list[str] = []

    def note(self, where: str, text: str) -> None:
        """Add a sentence on something that is left out or read in a certain sense, once."""
        sentence = f"{where}: {text}"
        if sentence not in self.notes:
            self.notes.append(sentence)

    @contextmanager
    def gathered(self) -> Iterator[None]:
        """Keep a mistake made inside, and go on behind the block."""
        try:
            yield
        except SceneError as error:
            self.mistakes += error.mistakes
        except InputError as error:
            self.mistakes.append(error)

    def check(self) -> None:
        """Raise all mistakes, if there are any."""
        distinct = list({str(mistake): mistake for mistake in self.mistakes}.values())
        if distinct:
            raise SceneError(limited(distinct, 0))


class Card(NamedTuple):
    """One element or command, with the parameters defined at its position."""

    where: str  # file, line and name, for messages
    kind: str  # first letter of the element's own name, or LUMPED; '.' of a command
    name: str  # of the element, behind those of the subcircuits it is in; or the command
    words: list[str]  # what follows
    text: str  # the whole card
    parameters: Parameters

    def value(self, word: str) -> float:
        """A number, a parameter or an expression in braces."""
        return parse_value(word, self.parameters, self.where)

    def refuse(self, problem: str, expected: str = "", got: str = "") -> InputError:
        """Make an error that names this card, with long words cut short."""
        return InputError(self.where, *(f"{text:.{LONGEST}}" for text in (problem, expected, got)))

    def of_kind(self, *kinds: str) -> "Card":
        """Return the card of a model if it is of one of these kinds (upper case); else raise an error."""
        found = "".join(self.words[1:2])
        if found.upper() not in kinds:
            raise self.refuse("not known here", " or ".join(kinds), f"'{found}'")
        return self

    def assigned(self, start: int) -> tuple[list[str], dict[str, list[str]]]:
        """Words from one on: those in front of the first assignment, and names with the words behind their '='."""
        words = self.words[start:]
        starts = [k - 1 for k, word in enumerate(words) if word == "="]
        if not starts:
            return words, {}
        if starts[0] < 0 or any(b - a < 2 for a, b in pairwise(starts)):
            raise self.refuse("not a list of values", "name=value", f"'{' '.join(words):.40}'")
        ends = [*starts[1:], len(words)]
        found: dict[str, list[str]] = {}
        for k, end in zip(starts, ends, strict=True):
            if words[k].lower() in found:
                raise self.refuse(f"{words[k]:.40} is given twice", "each value once")
            found[words[k].lower()] = words[k + 2 : end]
        return words[: starts[0]], found


class Deck(NamedTuple):
    """Title and cards of a netlist, in the order of its files."""

    title: str
    cards: list[Card]


def read_deck(path: str | Path, found: Findings) -> Deck:
    """Read a netlist and the files that it includes from its own folder; the first line is always the title."""
    title, *lines = _lines(Path(path))
    return deck_of(title.strip().lstrip("*").strip(), lines, count(2), str(path), found)


def deck_of(title: str, lines: list[str], numbers: Iterable[int], path: str, found: Findings) -> Deck:
    """Read the lines of a netlist, which messages give these numbers."""
    reader = _Reader(Folder(Path(path).parent, confined=True), found)
    return Deck(title, _without_control(list(reader.cards(lines, path, numbers)), found))


def nodes_of(words: list[str]) -> int:
    """Number of words before the first assignment."""
    return max(words.index("=") - 1, 0) if "=" in words else len(words)


def _lines(path: Path) -> list[str]:
    return read_text(path, legacy=True).splitlines() or [""]


class _Reader:
    """Reader that joins lines to cards and inserts included files."""

    def __init__(self, folder: Folder, found: Findings):
        self.folder, self.found, self.files, self.count = folder, found, 0, 0

    def cards(self, lines: list[str], path: str, numbers: Iterable[int], depth: int = 0) -> Iterator[Card]:
        """Cards up to .end or another run."""
        sections = _sections(lines)
        skipped = ended = ""  # the section of a library that is passed over, and whether .end was met
        for line, text in _joined(zip(numbers, lines, strict=False), path, self.found):
            name, *words = WORD.findall(text) or [text]
            where, lower = f"{path}, line {line}, {name:.40}", name.lower()
            if lower in PARAMETERS:
                words = assignments(text)
            self.count += 1
            if ended:
                self.found.note(where, "skipped with all that follows, for it stands behind .end")
                return
            if self.count > MOST_CARDS:
                raise InputError(path, "too many cards", f"at most {MOST_CARDS}")
            if lower == ".endl" or skipped:
                skipped = "" if lower == ".endl" else skipped
            elif lower == ".lib" and len(words) == 1 and words[0].lower() in sections:
                skipped = words[0]
            elif lower in INCLUDES:
                with self.found.gathered():
                    yield from self._included(Card(where, ".", name, words, text, {}), depth)
            elif lower == ".end":
                ended = where
            elif lower in OTHER_RUNS:
                self.found.note(where, "what follows belongs to another run, and is skipped")
                return
            else:
                yield Card(where, name[0].upper(), name, words, text, {})

    def _included(self, card: Card, depth: int) -> Iterator[Card]:
        """The cards of a file, or of one section of it."""
        match = FILE.match(card.text)
        self.files += 1
        if match is None or depth == DEEPEST or self.files > MOST_FILES:
            problem = "names no file" if match is None else "files that include each other"
            raise card.refuse(problem, "a file" if match is None else f"at most {DEEPEST} deep, {MOST_FILES} in all")
        name, section = match[1] or match[2] or match[3] or "", match[4].strip("'\"").lower()
        if OTHERS_LIBRARY.match(name) and card.name.lower() == ".lib":
            self.found.note(card.where, f"'{name:.80}' is not read: it belongs to another program")
            return
        try:
            path = self.folder.find(name)
            lines = _lines(path)
        except InputError as error:
            problem, expected = error.problem.replace("scene's", "netlist's"), error.expected
            raise card.refuse(problem, expected, error.got) from None
        first = 1
        if section and card.name.lower() == ".lib":
            bounds = _sections(lines).get(section)
            if bounds is None:
                raise card.refuse("no such section in this library", ".lib NAME … .endl", f"'{section:.40}'")
            first, lines = bounds[0] + 2, lines[bounds[0] + 1 : bounds[1]]
        yield from self.cards(lines, str(path), count(first), depth + 1)


def _sections(lines: list[str]) -> dict[str, tuple[int, int]]:
    """Begin and end of sections of a library, .lib NAME … .endl."""
    found, name, start = {}, "", 0
    for k, line in enumerate(lines):
        words = line.split()
        if len(words) == 2 and words[0].lower() == ".lib" and not name:
            name, start = words[1].strip("'\"").lower(), k
        elif words and words[0].lower() == ".endl" and name:
            found[name] = (start, k)
            name = ""
    return found


def _joined(lines: Iterable[tuple[int, str]], path: str, found: Findings) -> Iterator[tuple[int, str]]:
    """Line numbers and texts of cards, with continuation lines in their places."""
    number, parts = 0, []
    for at, line in lines:
        text = COMMENT.sub("", line).strip()
        if not text or text[0] in "*#":
            continue
        if text.startswith("+") and not parts:
            found.mistakes.append(InputError(f"{path}, line {at}", "continues nothing", "an element in front of it"))
        elif text.startswith("+"):
            parts.append(text[1:])
        elif parts and parts[-1].endswith("\\\\"):
            parts[-1:] = [parts[-1][:-2], text]
        else:
            if parts:
                yield number, " ".join(parts)
            number, parts = at, [text]
    if parts:
        yield number, " ".join(parts)


def _without_control(cards: list[Card], found: Findings) -> list[Card]:
    """Replace blocks between .control and .endc by the runs and plots that they command."""
    plain, asked, inside = [], [], None
    for card in cards:
        name = card.name.lower()
        if name == ".control":
            inside = card
            found.note(card.where, "of its commands, up to .endc, only the first run and what is plotted count")
        elif name == ".endc":
            inside = None
        elif inside is None:
            plain.append(card)
        elif name in WITHIN_CONTROL:
            asked.append(card._replace(kind=".", name=WITHIN_CONTROL[name]))
    given = {card.name.lower() for card in plain} & {".tran", *OVER_FREQUENCY}
    return plain + [card for card in asked if card.name not in given]
