"""Measures of a scene from the .measure cards of a SPICE netlist."""

import re
from collections.abc import Iterable
from typing import Any

from tline.errors import InputError
from tline.interchange.deck import Card
from tline.interchange.netlist import REFERENCE, Netlist

Table = dict[str, Any]
MEASURE = (".measure", ".meas")
DIFFERENCE = re.compile(r"(?:[{'\"]\s*)?v\(\s*([^\s(),]+)\s*\)\s*-\s*v\(\s*([^\s(),]+)\s*\)\s*[}'\"]?", re.IGNORECASE)
WORD = re.compile(r"v\([^()]*\)|\{[^{}]*\}|'[^']*'|[^\s=,]+", re.IGNORECASE)
EXTENTS = {
    "MAX": "maximum", "MIN": "minimum", "PP": "peak to peak", "AVG": "mean", "RMS": "rms",
    "INTEG": "integral", "INTEGRAL": "integral",
}  # fmt: skip
EDGES = {"RISE": "rise", "FALL": "fall", "CROSS": "any"}
OTHERS = ("AC", "DC", "OP", "NOISE", "TF", "SP", "FFT", "TRAN_CONT", "AC_CONT", "DC_CONT", "NOISE_CONT")


def measures(cards: Iterable[Card], net: Netlist) -> dict[str, Table]:
    """Measures by name; what is not known is skipped with a note, for it changes no voltage."""
    found: dict[str, Table] = {}
    for card in cards:
        try:
            reader = _MeasureReader(card, net)
            found[reader.name] = reader.measure()
            net.cards["measures", reader.name] = card
        except InputError as error:
            net.found.note(card.where, f"skipped: {error.problem}{', got ' * bool(error.got)}{error.got}")
    return found


def nodes_measured(tables: dict[str, Table]) -> list[str]:
    """Nodes at which measures need probes."""
    ends = [each.get(key) for each in tables.values() for key in ("start", "stop", "when")]
    parts = [*tables.values(), *(end for end in ends if isinstance(end, dict))]
    return [part[key] for part in parts for key in ("probe", "minus") if key in part]


class _MeasureReader:
    """Takes the words of a card from the left; '=' counts for nothing."""

    def __init__(self, card: Card, net: Netlist):
        self.card, self.net, self.words = card, net, WORD.findall(DIFFERENCE.sub(r"v(\1,\2)", card.text))[1:]
        self._is("TRAN")
        if self.words and self.words[0].upper() in OTHERS:
            raise card.refuse("another analysis")
        self._take()
        self.name = self.last

    def measure(self) -> Table:
        """The whole card."""
        word = self._take()
        if word in EXTENTS:
            table = {"kind": EXTENTS[word]} | self._signal() | self._span()
        elif word == "WHEN":
            table = {"kind": "crossing"} | self._crossing()
        elif word == "FIND":
            table = {"kind": "value"} | self._signal()
            table |= {"at": self._number()} if self._is("AT") else {"when": self._crossing_after("WHEN")}
        elif word == "TRIG" and self._is("AT"):
            if self._number() != 0:
                raise self.card.refuse("an interval from an instant that is not 0")
            table = {"kind": "crossing"} | self._crossing_after("TARG")
        elif word == "TRIG":
            table = {"kind": "delay", "start": self._crossing(), "stop": self._crossing_after("TARG")}
        else:
            raise self.card.refuse("not known here", got=f"'{self.last:.40}'")
        if self.words:
            raise self.card.refuse("not known here", got=f"'{' '.join(self.words):.40}'")
        return table

    def _crossing_after(self, word: str) -> Table:
        if self._take() != word:
            raise self.card.refuse(f"{word} is missing", got=f"'{self.last:.40}'")
        return self._crossing()

    def _crossing(self) -> Table:
        table = self._signal()
        self._is("VAL")
        if self.words[:1] and self.words[0][:2].upper() == "V(":
            other = self._signal()
            if "minus" in table or "minus" in other:
                raise self.card.refuse("a difference that crosses a voltage")
            table |= {"minus": other["probe"], "level": 0.0}
        else:
            table["level"] = self._number()
        while self.words and self.words[0].upper() in ("TD", *EDGES):
            word = self._take()
            if word == "TD":
                table["after"] = self._number()
            else:
                table |= {"edge": EDGES[word], "count": 0 if self._is("LAST") else round(self._number())}
        return table

    def _span(self) -> Table:
        table: Table = {}
        while self.words and self.words[0].upper() in ("FROM", "TO", "TD"):
            key = "stop" if self._take() == "TO" else "start"
            table[key] = self._number()
        return table

    def _signal(self) -> Table:
        """A voltage, or the difference of two."""
        self._take()
        nodes = self.last[2:-1].replace(",", " ").replace(":", ".").split()
        if self.last[:2].upper() != "V(" or not 1 <= len(nodes) <= 2:
            raise self.card.refuse("not of voltages of nodes", got=f"'{self.last:.40}'")
        first, *second = (self.net.node(node) for node in nodes)
        second = [node for node in second if node != REFERENCE]
        known = self.net.degrees()
        for node in (first, *second):
            if node not in known or node == REFERENCE:
                raise self.card.refuse("no waves reach that node", got=f"'{node:.40}'")
        return {"probe": first} | ({"minus": second[0]} if second else {})

    def _take(self) -> str:
        """The next word in capitals; `last` has it as it stands."""
        if not self.words:
            raise self.card.refuse("not whole")
        self.last = self.words.pop(0)
        return self.last.upper()

    def _is(self, word: str) -> bool:
        """Whether the next word is this one, which is then taken."""
        return self.words[:1] != [] and self.words[0].upper() == word and self._take() == word

    def _number(self) -> float:
        self._take()
        return self.card.value(self.last)
