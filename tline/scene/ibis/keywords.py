"""Keywords of IBIS files, the words below them, and numbers in them."""

import re
from collections.abc import Sequence
from typing import NamedTuple

from tline.errors import InputError
from tline.words.wording import shown

SCALES = {"T": 1e12, "G": 1e9, "M": 1e6, "k": 1e3, "m": 1e-3, "u": 1e-6, "n": 1e-9, "p": 1e-12, "f": 1e-15, "": 1.0}
NUMBER = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)([TGMkmunpf]?)[A-Za-z]*", re.ASCII)
KEYWORD = re.compile(r"\[([^\[\]]*)\](.*)")
MISSING = "NA"  # in place of a number
CORNERS = ("typ", "min", "max")
MOST = {
    "": 1e6,
    "V": 1e3,
    "A": 1e3,
    "s": 1.0,
    "ohm": 1e9,
    "F": 1e-3,
    "H": 1.0,
}  # that a pin may plausibly have, in size
MOST_ROWS = 100_000  # below one keyword


class Section(NamedTuple):
    """Keyword, the words behind it, and the lines below it: their numbers in the file and their words."""

    keyword: str  # in small letters, words apart by one space
    line: int
    words: list[str]
    rows: list[tuple[int, list[str]]]

    def find(self, name: str) -> tuple[int, list[str]] | None:
        """Line number and words behind a name that begins a line, as `C_comp 1pF` or `R_load = 50`."""
        for line, words in self.rows:
            if words and words[0].lower() == name.lower():
                return line, words[1:]
        return None

    def first_word(self, name: str) -> str:
        """First word behind a name, in small letters; empty if there is none."""
        found = self.find(name)
        return found[1][0].lower() if found and found[1] else ""


def sections_of(text: str) -> list[Section]:
    """Split a file into its keywords, in order.

    Examples
    --------
    >>> sections_of("[IBIS Ver] 5.0\\n[Model] DQ | of memory\\nModel_type I/O\\nC_comp = 1pF NA 2pF")[1].rows
    [(3, ['Model_type', 'I/O']), (4, ['C_comp', '1pF', 'NA', '2pF'])]
    """
    found: list[Section] = []
    comment = "|"
    for number, raw in enumerate(text.splitlines(), 1):
        line = raw.partition(comment)[0].strip()
        if matched := KEYWORD.fullmatch(line):
            keyword = " ".join(matched[1].replace("_", " ").lower().split())
            if keyword == "comment char":
                comment = raw.partition("]")[2].strip()[:1] or comment
            found.append(Section(keyword, number, matched[2].split(), []))
        elif line and found:
            found[-1].rows.append((number, line.replace("=", " ").split()))
            if len(found[-1].rows) > MOST_ROWS:
                raise InputError(
                    "file", f"line {number}: too many lines below [{found[-1].keyword}]", f"at most {MOST_ROWS:,}"
                )
    if not any(section.keyword == "ibis ver" for section in found):
        raise InputError("file", "is no IBIS file", "one that begins with [IBIS Ver]")
    return found


def number_of(word: str, line: int, unit: str) -> float:
    """Parse a number in SI, with a letter for its scale and optionally a unit.

    Examples
    --------
    >>> number_of("2.5pF", 1, "F"), number_of("-40mA", 1, "A"), number_of("1.8V", 1, "V")
    (2.5e-12, -0.04, 1.8)
    """
    matched = NUMBER.fullmatch(word)
    if matched is None:
        raise InputError("file", f"line {line}: not a number", "such as 2.5pF", shown(word))
    value = float(matched[1]) * SCALES[matched[2]]
    if abs(value) > MOST[unit]:
        raise InputError("file", f"line {line}: not plausible", f"at most {MOST[unit]:g} {unit} in size", shown(word))
    return value


def without_far_ends(section: Section) -> Section:
    """Leave out first and last rows with currents beyond what is plausible, as of exponentials of clamps."""
    far = [any(_size(word) > MOST["A"] for word in row[1:]) for _, row in section.rows]
    near = [k for k, each in enumerate(far) if not each]
    return section._replace(rows=section.rows[near[0] : near[-1] + 1]) if near else section


def _size(word: str) -> float:
    matched = NUMBER.fullmatch(word)
    return abs(float(matched[1])) * SCALES[matched[2]] if matched else 0.0


def at_corner(words: Sequence[str], corner: str, line: int, unit: str) -> float:
    """Value at a corner of typical, minimum, maximum; the typical one if unknown, or the mean if that is unknown too.

    Examples
    --------
    >>> at_corner(["1pF", "NA", "2pF"], "min", 1, "F"), at_corner(["1pF"], "max", 1, "F")
    (1e-12, 1e-12)
    >>> at_corner(["NA", "1pF", "2pF"], "typ", 1, "F")
    1.5e-12
    """
    values = [None if word.upper() == MISSING else number_of(word, line, unit) for word in words[: len(CORNERS)]]
    known = [value for value in values if value is not None]
    if not known:
        raise InputError("file", f"line {line}: there is no typical value", "a number", " ".join(words) or "none")
    chosen = values[CORNERS.index(corner)] if len(values) > CORNERS.index(corner) else None
    typical = sum(known) / len(known) if values[0] is None else values[0]
    return typical if chosen is None else chosen


def table_of(
    section: Section, corner: str, units: tuple[str, str], words: frozenset[str] = frozenset()
) -> list[tuple[float, float]]:
    """Rows of a table: first column and value at a corner; rows of named values, or of unknown ones, are skipped."""
    rows = []
    for line, row in section.rows:
        if row[0].lower() in words or {word.upper() for word in row[1:]} == {MISSING}:
            continue
        rows.append((number_of(row[0], line, units[0]), at_corner(row[1:], corner, line, units[1])))
    if len(rows) < 2:
        raise InputError("file", f"line {section.line}: [{section.keyword}] has too few rows", "two or more")
    return rows
