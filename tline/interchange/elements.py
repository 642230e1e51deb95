"""The elements of a SPICE netlist: lines, sources, R, L, C, multiports, and what .tran and .print ask for."""

from math import inf
from pathlib import Path
from typing import Any, NamedTuple

from tline.interchange.branches import Branch, element
from tline.interchange.deck import GROUND, Card, nodes_of, read_deck
from tline.interchange.diode import diode
from tline.interchange.line_cards import lossless_line, ltra_line, rlgc_line, rlgc_settings
from tline.interchange.multiports import coupled_inductors
from tline.interchange.spice_commands import SHOWN, nodes_shown, transient

KNOWN = "R, L, C, D, K, V, I, E, G, T, O, W, X, .model, .subckt, .param, .tran, .print, .plot, .save, .probe and .end"


class SourceCard(NamedTuple):
    """A source: the node that it drives, and the sign of its level there; of an E its gain, and what commands it."""

    card: Card
    node: str
    sign: float
    control: str = ""


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
        self.links: dict[str, dict[str, Any]] = {}
        self.diodes: dict[str, dict[str, Any]] = {}  # to the reference
        self.branches: list[Branch] = []
        self.drives: list[SourceCard] = []
        self.shown: list[tuple[Card, str]] = []  # nodes, and where they are asked for
        commands = [card for card in deck.cards if card.kind == "."]
        self.tran = transient([card for card in commands if card.name.lower() == ".tran"], self.path)
        self.models = {card.words[0].lower(): card for card in commands if card.name.lower() == ".model" and card.words}
        for card in commands:
            if card.name.lower() in SHOWN:
                self.shown += nodes_shown(card)
            elif card.name.lower() not in (".tran", ".model"):
                raise card.refuse("not known here", KNOWN)
        for card in deck.cards:
            if card.kind != ".":
                self._take(card)
        for card in self.cards.values():
            if card.kind == "K":
                self.links[card.name] = coupled_inductors(card, self.cards, self.branches)
        self.ends = self._ends_of_lines()
        self.joined = self._joined()

    def node(self, name: str) -> str:
        """The node as it was spelt first; the reference is '0'."""
        return self.spelt.setdefault(name.lower(), name)

    def _take(self, card: Card) -> None:
        """One element."""
        kind, key = card.kind, card.name.lower()
        if key in self.cards:
            raise card.refuse("named twice", "another name")
        if kind in "FH":
            raise card.refuse("a current commands it", "E or G, which a voltage commands")
        if kind not in "RLCKVIEGTOWD":
            raise card.refuse("not known here", KNOWN)
        if len(card.words) < (5 if kind in "TOEG" else 3):
            raise card.refuse("is not whole", "its nodes and a value")
        if kind in "KEG" and not self.tran.uic:
            raise card.refuse("has no steady state here", "UIC in .tran, which is the same if all sources begin at 0")
        self.cards[key] = card
        if kind in "TO":
            line = lossless_line if kind == "T" else self._lossy_line
            self.lines[card.name] = {"nodes": self._ends(card)} | line(card)
        elif kind == "W":
            self.lines[card.name] = self._conductors(card)
        elif kind == "D":
            self._diode(card)
        elif kind in "RLC":
            self.branches.append(self._branch(card, kind))
        elif kind in "EG":
            self._controlled(card)
        elif kind in "VI":
            self.drives.append(self._drive(card, kind))

    def _ends(self, card: Card) -> list[str]:
        first, low, second, base = map(self.node, card.words[:4])
        self._check_ends(card, [first, second], {low, base})
        return [first, second]

    def _check_ends(self, card: Card, ends: list[str], references: set[str]) -> None:
        if references != {"0"}:
            raise card.refuse("a line that is not against the reference", "0 for the last node of either end")
        if "0" in ends:
            raise card.refuse("an end at the reference", "another node, and a resistor to 0 there")

    def _lossy_line(self, card: Card) -> dict[str, Any]:
        """R, L and C per metre by an LTRA model."""
        if len(card.words) > 5:
            raise card.refuse("has more than a model", "its nodes and a .model", f"'{' '.join(card.words[4:]):.40}'")
        return ltra_line(self._model(card, card.words[4]))

    def _conductors(self, card: Card) -> dict[str, Any]:
        """Conductors between two lists of nodes, each with its reference, by an RLGC model."""
        nodes, half = [self.node(word) for word in card.words[: nodes_of(card.words)]], nodes_of(card.words) // 2
        if len(nodes) < 4 or len(nodes) % 2:
            raise card.refuse("its ends have not as many nodes", "N nodes and 0, twice", f"'{' '.join(nodes):.40}'")
        first, second = nodes[: half - 1], nodes[half:-1]
        self._check_ends(card, [*first, *second], {nodes[half - 1], nodes[-1]})
        line = rlgc_line(card, self._model(card, rlgc_settings(card)["rlgcmodel"]), half - 1)
        return ({"nodes": [*first, *second]} if half == 2 else {"nodes1": first, "nodes2": second}) | line

    def _model(self, card: Card, name: str) -> Card:
        """The model of that name in the innermost subcircuit around a card that has one."""
        around = card.name.split(".")[:-1]
        for depth in range(len(around), -1, -1):
            model = self.models.get(".".join([*around[:depth], name]).lower())
            if model is not None:
                return model
        raise card.refuse("its model is not there", "the name of a .model", f"'{name:.40}'")

    def _diode(self, card: Card) -> None:
        """A load to the reference, or a link."""
        if len(card.words) > 3:
            raise card.refuse("has more than a model", "two nodes and a .model", f"'{' '.join(card.words[3:]):.40}'")
        first, second = map(self.node, card.words[:2])
        if first == second:
            raise card.refuse("both ends are at one node", "two nodes")
        table = diode(self._model(card, card.words[2]))
        if "0" in (first, second):
            at = first if second == "0" else second
            self.diodes[card.name] = {"at": at} | table | ({"reverse": True} if first == "0" else {})
        else:
            self.links[card.name] = {"nodes": [first, second]} | table

    def _branch(self, card: Card, kind: str) -> Branch:
        if len(card.words) > 3:
            raise card.refuse("has more than a value", "two nodes and a number", f"'{' '.join(card.words[3:]):.40}'")
        first, second, value = self.node(card.words[0]), self.node(card.words[1]), card.value(card.words[2])
        if value <= 0:
            raise card.refuse("its value is not above zero", "more than 0", f"{value:g}")
        if first == second:
            raise card.refuse("both ends are at one node", "two nodes")
        return Branch((first, second), element(kind, value), [card.name])

    def _drive(self, card: Card, kind: str) -> SourceCard:
        """A source against the reference; a current flows through it from its first node to its second."""
        node, sign = self._against_reference(card, card.words[:2])
        return SourceCard(card, node, sign if kind == "V" else -sign)

    def _against_reference(self, card: Card, words: list[str]) -> tuple[str, float]:
        """The node of two that is not the reference, and whether it is the first, as a sign."""
        first, second = map(self.node, words)
        if first == second or "0" not in (first, second):
            raise card.refuse("is not against the reference", "0 for one of its nodes")
        return (first, 1.0) if second == "0" else (second, -1.0)

    def _controlled(self, card: Card) -> None:
        """A source that a voltage commands; one that its own voltage commands is a resistor."""
        if len(card.words) != 5 or "=" in card.words:
            given = " ".join(card.words[2:])
            raise card.refuse("is not a gain alone", "two nodes, two that command it, and a number", f"'{given:.40}'")
        (out, sign), (control, other) = (self._against_reference(card, card.words[k : k + 2]) for k in (0, 2))
        gain = sign * other * card.value(card.words[4])
        none = gain == 0 or abs(1 / gain) == inf
        if none or (out == control and (card.kind == "E" or gain < 0)):
            problem = "its gain is zero" if none else "its own voltage commands it"
            raise card.refuse(problem, "another gain" if none else "another node's", f"'{' '.join(card.words)}'")
        if card.kind == "E":
            self.drives.append(SourceCard(card, out, gain, control))
        elif out == control:
            self.branches.append(Branch((out, "0"), element("R", 1 / gain), [card.name]))
        else:
            kind = {"kind": "controlled source", "nodes": [control, out]}
            self.links[card.name] = kind | {"transconductance": gain}

    def _ends_of_lines(self) -> dict[str, str]:
        """Nodes where lines end, and the first line there."""
        ends: dict[str, str] = {}
        for name, line in self.lines.items():
            for node in line.get("nodes") or [*line["nodes1"], *line["nodes2"]]:
                ends.setdefault(node, name)
        return ends

    def _joined(self) -> set[str]:
        """Nodes where lines end, or multiports, beside sources that are driven elsewhere."""
        controls = {drive.control for drive in self.drives if drive.control}
        diodes = {table["at"] for table in self.diodes.values()}
        return {*self.ends, *controls, *diodes, *(node for link in self.links.values() for node in link["nodes"])}
