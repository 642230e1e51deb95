"""The elements of a SPICE netlist, each checked alone: lines, sources, R, L, C, and what .tran and .print ask for."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from tline.errors import InputError
from tline.interchange.branches import Branch, element
from tline.interchange.deck import GROUND, Card, read_deck
from tline.interchange.spice_source import Transient

SHOWN = (".print", ".plot", ".save", ".probe")
VOLTAGE = re.compile(r"v\(\s*([^\s,()]+)\s*\)", re.IGNORECASE)
KNOWN = "R, L, C, V, I, T, O, X, .model, .subckt, .param, .tran, .print, .plot, .save, .probe and .end"
PER_METRE = {"r", "l", "c", "len"}
NUMERICAL = {  # of LTRA: how that program computes, not what the line is
    "rel", "abs", "nosteplimit", "nocontrol", "lininterp", "quadinterp", "mixedinterp", "compactrel", "compactabs",
    "truncnr", "truncdontcut", "steplimit",
}  # fmt: skip


class Drive(NamedTuple):
    """A source: the node that it drives, and the sign of its level there."""

    card: Card
    node: str
    sign: float


class Netlist:
    """A netlist read.

    Raises
    ------
    InputError
        Naming the line and the element that is not known, not whole or out of range.
    """

    def __init__(self, path: str | Path):
        self.path, deck = str(path), read_deck(path)
        self.title, self.spelt = deck.title, dict.fromkeys(GROUND, "0")
        self.cards: dict[str, Card] = {}  # elements by name in lower case
        self.lines: dict[str, dict[str, Any]] = {}
        self.branches: list[Branch] = []
        self.drives: list[Drive] = []
        self.shown: list[tuple[Card, str]] = []  # nodes, and where they are asked for
        commands = [card for card in deck.cards if card.kind == "."]
        self.tran = self._transient([card for card in commands if card.name.lower() == ".tran"])
        self.models = {card.words[0].lower(): card for card in commands if card.name.lower() == ".model" and card.words}
        for card in commands:
            if card.name.lower() in SHOWN:
                self.shown += self._nodes_shown(card)
            elif card.name.lower() not in (".tran", ".model"):
                raise card.refuse("not known here", KNOWN)
        for card in deck.cards:
            if card.kind != ".":
                self._take(card)

    def node(self, name: str) -> str:
        """The node as it was spelt first; the reference is '0'."""
        return self.spelt.setdefault(name.lower(), name)

    def _transient(self, cards: list[Card]) -> Transient:
        if len(cards) != 1:
            where = cards[1].where if cards else self.path
            raise InputError(where, "the end time is not given once", "one .tran STEP END", f"{len(cards)}")
        (card,) = cards
        words = [word for word in card.words if word.lower() != "uic"]
        if not 2 <= len(words) <= 4:
            raise card.refuse("not a time step and an end", ".tran STEP END [0 [LONGEST STEP]] [UIC]")
        step, end, *more = map(card.value, words)
        if step <= 0 or end <= 0:
            raise card.refuse("a time that is not above zero", "more than 0")
        if more and more[0]:
            raise card.refuse("results that begin later", "0 for the third time", f"{more[0]:g}")
        return Transient(step, end, len(words) < len(card.words))

    def _nodes_shown(self, card: Card) -> Iterator[tuple[Card, str]]:
        rest = VOLTAGE.sub(" ", card.text).split()[1:]
        if any(word.lower() not in ("tran", "all") for word in rest):
            expected = "v(NODE)"
            raise card.refuse("asks for something else than voltages of nodes", expected, f"'{' '.join(rest):.40}'")
        return ((card, name) for name in VOLTAGE.findall(card.text))

    def _take(self, card: Card) -> None:
        """One element."""
        kind, key = card.kind, card.name.lower()
        if key in self.cards:
            raise card.refuse("named twice", "another name")
        if kind not in "RLCVITO":
            raise card.refuse("not known here", KNOWN)
        if len(card.words) < (5 if kind in "TO" else 3):
            raise card.refuse("is not whole", "its nodes and a value")
        self.cards[key] = card
        if kind in "TO":
            line = self._line if kind == "T" else self._lossy_line
            self.lines[card.name] = {"nodes": self._ends(card)} | line(card)
        elif kind in "RLC":
            self.branches.append(self._branch(card, kind))
        else:
            self.drives.append(self._drive(card, kind))

    def _ends(self, card: Card) -> list[str]:
        first, low, second, base = map(self.node, card.words[:4])
        if (low, base) != ("0", "0"):
            raise card.refuse("a line that is not against the reference", "0 for its second and fourth node")
        if "0" in (first, second):
            raise card.refuse("an end at the reference", "another node, and a resistor to 0 there")
        return [first, second]

    def _line(self, card: Card) -> dict[str, Any]:
        words = card.words[4:]
        given = {key.lower(): card.value(value) for key, value in zip(words[::3], words[2::3], strict=False)}
        names = "Z0 with TD, or with F (and NL)"
        if len(words) % 3 or any(word != "=" for word in words[1::3]) or not given.keys() <= {"z0", "td", "f", "nl"}:
            raise card.refuse("not a list of what a lossless line has", names, " ".join(words)[:60])
        if "z0" not in given or ("td" in given) == ("f" in given) or given.keys() & {"td", "nl"} == {"td", "nl"}:
            raise card.refuse("its z0 and delay are not given once", names, ", ".join(given).upper())
        if given.get("f", 1.0) <= 0:
            raise card.refuse("its frequency is not above zero", "more than 0", f"{given['f']:g}")
        delay = given["td"] if "td" in given else given.get("nl", 0.25) / given["f"]
        return {"z0": given["z0"], "delay": delay}

    def _lossy_line(self, card: Card) -> dict[str, Any]:
        """R, L and C per metre by an LTRA model."""
        model = self.models.get(card.words[4].lower())
        if model is None or len(card.words) > 5:
            raise card.refuse("its model is not there", "the name of a .model", f"'{' '.join(card.words[4:]):.40}'")
        kind, words = "".join(model.words[1:2]), model.words[2:]
        if kind.lower() != "ltra":
            raise model.refuse("not known here", "LTRA", f"'{kind}'")
        given: dict[str, float] = {}
        while words:
            key, *words = words
            valued = words[:1] == ["="] and len(words) > 1
            if key.lower() not in PER_METRE | NUMERICAL or (key.lower() in PER_METRE and not valued):
                raise model.refuse("not a list of what a line with resistance has", "R, L, C and LEN", f"'{key}'")
            if valued:
                given[key.lower()] = model.value(words[1])
                words = words[2:]
        for name in ("l", "c", "len"):
            if given.get(name, 0.0) <= 0:
                raise model.refuse(f"its {name.upper()} is not above zero", "more than 0", f"{given.get(name, 0.0):g}")
        if given.get("r", 0.0) < 0:
            raise model.refuse("its R is below zero", "0 or more", f"{given['r']:g}")
        delay = given["len"] * (given["l"] * given["c"]) ** 0.5
        line = {"z0": (given["l"] / given["c"]) ** 0.5, "delay": delay, "length": given["len"]}
        return line | ({"resistance": given["r"]} if given.get("r") else {})

    def _branch(self, card: Card, kind: str) -> Branch:
        if len(card.words) > 3:
            raise card.refuse("has more than a value", "two nodes and a number", f"'{' '.join(card.words[3:]):.40}'")
        first, second, value = self.node(card.words[0]), self.node(card.words[1]), card.value(card.words[2])
        if value <= 0:
            raise card.refuse("its value is not above zero", "more than 0", f"{value:g}")
        if first == second:
            raise card.refuse("both ends are at one node", "two nodes")
        return Branch((first, second), element(kind, value), [card.name])

    def _drive(self, card: Card, kind: str) -> Drive:
        """A source against the reference; a current flows through it from its first node to its second."""
        first, second = self.node(card.words[0]), self.node(card.words[1])
        if first == second or "0" not in (first, second):
            raise card.refuse("is not against the reference", "0 for one of its nodes")
        plus = second == "0"
        return Drive(card, first if plus else second, 1.0 if plus == (kind == "V") else -1.0)
