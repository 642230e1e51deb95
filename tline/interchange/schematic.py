"""Schematics of LTspice (.asc) as netlists: pins of symbols, joined by wires and labels to nodes."""

import re
from collections import Counter
from itertools import count
from pathlib import Path
from typing import NamedTuple

import numpy as np

from tline.errors import InputError
from tline.interchange.deck import COMMENT, MOST_CARDS, WORD, Deck, Findings, deck_of
from tline.interchange.subcircuits import GROUND
from tline.scene.text_file import read_text
from tline.words.wording import nearest, shown

MOST_POINTS, FARTHEST = 20_000, 100_000_000  # of a sheet: ends of wires, labels and pins; units from its origin
DRAWN = ("VERSION", "SHEET", "WINDOW", "LINE", "RECTANGLE", "CIRCLE", "ARC", "IOPIN", "DATAFLAG")  # no circuit
VALUES = ("SpiceModel", "Value", "Value2", "SpiceLine", "SpiceLine2")  # in the order of the netlist
NEW_LINE = re.compile(r"(?<!\\)\\n")  # within a text
ROTATED = {"0": (1, 0), "90": (0, 1), "180": (-1, 0), "270": (0, -1)}  # clockwise: cosine and sine, with y downwards
Point = tuple[int, int]
Placed = tuple[int, str, list[Point], dict[str, str]]  # line of a symbol, letter of its element, pins, attributes


class Symbol(NamedTuple):
    """A symbol of LTspice's library: letter of its element, value if none is given, pins in the order of the nodes."""

    letter: str
    value: str
    pins: tuple[Point, ...]


TALL, SHORT, ROUND, ARROW = ((16, 16), (16, 96)), ((16, 0), (16, 64)), ((0, 16), (0, 96)), ((0, 0), (0, 80))
ENDS = ((-48, -16), (-48, 16), (48, -16), (48, 16))
CONTROL, CROSSED = ((-48, 32), (-48, 80)), ((-48, 80), (-48, 32))
SYMBOLS = {
    **dict.fromkeys(("res", "misc/europeanresistor"), Symbol("R", "R", TALL)), "res2": Symbol("R", "R", SHORT),
    **dict.fromkeys(("cap", "polcap", "misc/europeancap", "misc/europeanpolcap"), Symbol("C", "C", SHORT)),
    **dict.fromkeys(("ind", "ind2"), Symbol("L", "L", TALL)),
    **dict.fromkeys(("voltage", "misc/battery"), Symbol("V", "V", ROUND)), "misc/cell": Symbol("V", "V", SHORT),
    "misc/signal": Symbol("V", "SINE(0 1 1K)", ROUND),
    "current": Symbol("I", "I", ARROW), "load": Symbol("I", "I", SHORT),
    "tline": Symbol("T", "Td=50n Z0=50", ENDS), "ltline": Symbol("O", "LTRA", ENDS),
    **dict.fromkeys(("diode", "schottky", "zener", "led", "varactor"), Symbol("D", "D", SHORT)),
    "sw": Symbol("S", "SW", (*ROUND, *CROSSED)), "csw": Symbol("W", "CSW", ARROW),
    "bv": Symbol("B", "V=F(...)", ROUND), "bi": Symbol("B", "I=F(...)", ARROW),
    "bi2": Symbol("B", "I=F(...)", ARROW[::-1]),
    "e": Symbol("E", "E", (*ROUND, *CONTROL)), "e2": Symbol("E", "E", (*ROUND, *CROSSED)),
    "g": Symbol("G", "G", (*ROUND[::-1], *CONTROL)), "g2": Symbol("G", "G", (*ROUND[::-1], *CROSSED)),
    "f": Symbol("F", "F", ARROW), "h": Symbol("H", "H", ROUND), "misc/jumper": Symbol("R", "0", ((-32, 64), (32, 64))),
}  # fmt: skip


def read_schematic(path: str | Path, found: Findings) -> Deck:
    """Read a schematic as the netlist that LTspice makes of it; its cards name the lines of the schematic."""
    sheet, lines = Sheet(str(path)), read_text(Path(path), legacy=True).split("\n")
    if not lines[0].startswith("Version ") or len(lines) > MOST_CARDS:
        expected = f"Version 4 in its first line, and at most {MOST_CARDS} lines"
        raise InputError(str(path), "not a schematic of LTspice", expected, shown(lines[0][:40]))
    for number, line in enumerate(lines, 1):
        with found.gathered():
            sheet.take(number, *line.strip().partition(" ")[::2])
    found.check()
    if 2 * len(sheet.wires) + len(sheet.labels) + 4 * len(sheet.placed) > MOST_POINTS:
        raise InputError(str(path), "too many wires, labels and symbols", f"at most {MOST_POINTS} points")
    cards = [*sheet.elements(found), *sheet.directives]
    return deck_of(Path(path).stem, [text for _, text in cards], [number for number, _ in cards], str(path), found)


class Sheet:
    """Wires, labels, symbols and directives of a schematic, with their lines."""

    def __init__(self, path: str):
        self.path = path
        self.wires: list[tuple[Point, Point]] = []
        self.labels: list[tuple[int, Point, str]] = []
        self.placed: list[Placed] = []
        self.directives: list[tuple[int, str]] = []
        self.attributes: dict[str, str] = {}  # of the symbol taken last

    def take(self, line: int, word: str, rest: str) -> None:
        """Take one line of the file."""
        where = f"{self.path}, line {line}"
        if word == "WIRE":
            x1, y1, x2, y2 = _numbers(rest.split(), where, 4)
            self.wires.append(((x1, y1), (x2, y2)))
        elif word == "FLAG":
            x, y = _numbers(rest.split(None, 2)[:2], where, 2)
            self.labels.append((line, (x, y), _name("".join(rest.split(None, 2)[2:]), where, "label")))
        elif word == "SYMBOL":
            self.attributes = {}
            self._place(line, [*rest.rsplit(None, 3), "", "", "", ""], where)
        elif word == "SYMATTR":
            key, _, value = rest.partition(" ")
            self.attributes[key] = value.strip().removeprefix('""')
        elif word == "TEXT":
            text = "".join(rest.split(None, 4)[4:])
            if text.startswith("!"):
                self.directives += [(line, each) for each in NEW_LINE.split(text[1:])]
        elif word and word.upper() not in DRAWN:
            raise InputError(where, "not known here", "WIRE, FLAG, SYMBOL, SYMATTR or TEXT", shown(word))

    def _place(self, line: int, words: list[str], where: str) -> None:
        """Place a symbol: rotated, then mirrored from left to right, if at all, then moved."""
        name, orientation = re.sub(r"\\+", "/", words[0]), words[3].upper()
        symbol = SYMBOLS.get(name.lower())
        if symbol is None:
            raise InputError(where, "a symbol that is not known here", nearest(name, sorted(SYMBOLS)), shown(name))
        if orientation[:1] not in ("R", "M") or orientation[1:] not in ROTATED:
            raise InputError(where, f"'{name}' is not turned so", "R0, R90, R180, R270, or M0 to M270", shown(words[3]))
        x, y = _numbers(words[1:3], where, 2)
        side, (c, s) = -1 if orientation.startswith("M") else 1, ROTATED[orientation[1:]]
        pins = [(x + side * (c * px - s * py), y + s * px + c * py) for px, py in symbol.pins]
        self.attributes["Value"] = symbol.value
        self.placed.append((line, symbol.letter, pins, self.attributes))

    def elements(self, found: Findings) -> list[tuple[int, str]]:
        """Elements as cards of a netlist, and a card for each further label of a node, with their lines."""
        labels = sorted(self.labels, key=lambda each: each[2].lower() not in GROUND)
        nets = self._nets([at for _, at, _ in labels] + [pin for _, _, pins, _ in self.placed for pin in pins])
        names, cards = dict[int, str](), [(1, ".model D D")]
        for (line, _, label), net in zip(labels, nets, strict=False):
            name = names.setdefault(net, label)
            if name.lower() not in (label.lower(), *GROUND):
                cards.append((line, f"R§{line} {name} {label} 0"))
        taken, members, behind = {label.lower() for _, _, label in labels}, Counter(nets), iter(nets[len(labels) :])
        unlabelled = (node for k in count(1) if (node := f"N{k:03}").lower() not in taken)
        for line, letter, pins, given in self.placed:
            where, own = f"{self.path}, line {line}", [next(behind) for _ in pins]
            with found.gathered():
                name, letter = _name(given.get("InstName", ""), where, "InstName"), given.get("Prefix", letter)
                name = name if name.upper().startswith(letter[:1].upper()) else f"{letter}§{name}"
                for k, net in enumerate(own, 1):
                    names[net] = names.get(net) or next(unlabelled)
                    if members[net] == 1:
                        found.note(f"{where}, {name}", f"its pin {k} is joined to nothing")
                values = [given[key] for key in VALUES if given.get(key)]
                cards.append((line, " ".join([name, *(names[net] for net in own), *values])))
        return cards

    def _nets(self, points: list[Point]) -> list[int]:
        """Number of the net of each point: a wire joins all points on it, ends of other wires among them."""
        at = np.array([*points, *(end for wire in self.wires for end in wire)], int).reshape(-1, 2)
        net = np.unique(at, axis=0, return_inverse=True)[1].reshape(-1)
        for first, second in np.array(self.wires, int).reshape(-1, 2, 2):
            (dx, dy), from_first = second - first, at - first
            inside = ((at >= np.minimum(first, second)) & (at <= np.maximum(first, second))).all(axis=1)
            joined = np.unique(net[inside & (from_first[:, 0] * dy == from_first[:, 1] * dx)])
            if len(joined) > 1:
                net[np.isin(net, joined)] = joined[0]
        return net[: len(points)].tolist()


def _numbers(words: list[str], where: str, n: int) -> list[int]:
    """Coordinates, of which there have to be n."""
    try:
        found = [int(word) for word in words]
    except ValueError:
        found = []
    if len(found) != n or any(abs(number) > FARTHEST for number in found):
        raise InputError(where, "not coordinates", f"{n} whole numbers", shown(" ".join(words)))
    return found


def _name(text: str, where: str, what: str) -> str:
    """Return a label or name if a netlist can say it in one word."""
    if not WORD.fullmatch(text) or text[0] in "{'\"=" or COMMENT.search(" " + text):
        raise InputError(where, f"its {what} is not a word of a netlist", "letters and digits", shown(text))
    return text
