"""The tables of a scene as the elements of a netlist fill them, in the nodes that are left where some are one.

Parts that no waves reach are left out of them, sources get their resistances, and ends that stay open are closed.
"""

from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from tline.errors import InputError
from tline.interchange.deck import Card, Findings
from tline.interchange.spice_source import Transient
from tline.interchange.subcircuits import GROUND
from tline.solver.description.groups import parts

Table = dict[str, Any]
REFERENCE = "0"
MOST_NODES = 1000  # of a circuit between lines
AMMETER = 1.0  # ohm, by which a current becomes the voltage that stands for it
LINKED = ("resistor", "inductor", "capacitor", "series", "parallel", "diode")  # loads that may be links


class Netlist:
    """Lines, links, loads and sources by name, and the card that each is from."""

    def __init__(self, found: Findings, tran: Transient, models: dict[str, Card], folder: Path):
        self.found, self.tran, self.models, self.folder = found, tran, models, folder
        self.tables: dict[str, dict[str, Table]] = {"lines": {}, "sources": {}, "links": {}, "loads": {}}
        self.cards: dict[tuple[str, str], Card] = {}
        self.initial: dict[str, tuple[Card, float]] = {}  # voltages of nodes at t = 0
        self.sensed: dict[str, str] = {}  # sources whose current commands others, and the nodes that stand for it
        self.coupled: set[str] = set()  # inductors, and their values and nodes where they are waiting to be coupled
        self.windings: dict[str, tuple[float, tuple[str, str]]] = {}
        self.quiet = True  # whether all sources are zero up to t = 0
        self._same: dict[str, str] = {}
        self._spelt = {REFERENCE: REFERENCE}

    def node(self, name: str) -> str:
        """The node as it was spelt first; the reference is '0'."""
        root = self._root(name)
        return self._spelt.setdefault(root, name)

    def _root(self, name: str) -> str:
        name = REFERENCE if name.lower() in GROUND else name.lower()
        while name in self._same:
            name = self._same[name]
        return name

    def merge(self, first: str, second: str) -> None:
        """Merge two nodes, if none of them is the reference."""
        kept, gone = self._root(first), self._root(second)
        if kept != gone and REFERENCE not in (kept, gone):
            self._same[gone] = kept
            self._spelt.setdefault(kept, first)

    def add(self, section: str, card: Card, table: Table, name: str = "") -> None:
        """Add a table that a card makes."""
        name = name or card.name
        self.tables[section][name] = table
        self.cards[section, name] = card

    def between(self, card: Card, ends: Iterable[str], table: Table, name: str = "") -> None:
        """Add an element between two nodes: a load if one of them is the reference, else a link."""
        first, second = ends
        if first == second:
            self.found.note(card.where, "skipped, for both its ends are at one node")
        elif second == REFERENCE:
            self.add("loads", card, {"at": first} | table, name)
        elif first == REFERENCE:
            reverse = {"reverse": True} if table["kind"] == "diode" else {}
            self.add("loads", card, {"at": second} | table | reverse, name)
        else:
            self.add("links", card, {"nodes": [first, second]} | table, name)

    def short(self, card: Card, ends: tuple[str, str]) -> None:
        """Hold a node at zero that a source of no voltage or a resistor of 0 ohm joins to the reference."""
        at = next((node for node in ends if node != REFERENCE), REFERENCE)
        shorted = {load["at"] for load in self.tables["loads"].values() if load["kind"] == "short"}
        if REFERENCE in ends and at not in shorted:
            self.add("loads", card, {"at": at, "kind": "short"})

    def source(self, card: Card, ends: tuple[str, str], table: Table, name: str = "") -> None:
        """Add a source from a first node, its plus, to a second."""
        first, second = ends
        if second == REFERENCE:
            self.add("sources", card, {"at": first} | table, name)
        else:
            self.add("sources", card, {"nodes": [first, second]} | table, name)

    def two_port(self, card: Card, ports: tuple[tuple[str, str], ...], kind: str, name: str = "", **table: Any) -> None:
        """Add a linear two-port; the keys of `table` that begin with 'signed_' follow the sense of its ports."""
        signs, nodes = [], []
        for first, second in ports:
            signs.append(-1.0 if first == REFERENCE else 1.0)
            nodes.append(second if first == REFERENCE else first)
        kept = signs[0] == signs[1] or any(key.startswith("signed_") for key in table)
        grounded = all(REFERENCE in port for port in ports) and len({*nodes}) == 2 and kept
        given = {}
        for key, value in table.items():
            plain = key.removeprefix("signed_")
            given[plain] = value * signs[0] * signs[1] if grounded and plain != key else value
        if not grounded:
            nodes = [node for port in ports for node in port]
            if REFERENCE in nodes:
                self.tables["loads"]["reference"] = {"at": REFERENCE, "kind": "short"}
                self.cards["loads", "reference"] = card
        self.add("links", card, {"nodes": nodes, "kind": kind} | given, name)

    def ammeter(self, card: Card, first: str, second: str) -> None:
        """Put a gyrator between two nodes, whose second port has the current through its first as voltage."""
        at = self.sensed[card.name.lower()]
        self.two_port(card, ((first, second), (at, REFERENCE)), "gyrator", at, resistance=AMMETER)

    def end(self, card: Card, which: int, first: str, second: str) -> str:
        """The node at which a line ends between two nodes."""
        if second == REFERENCE != first:
            return first
        inner = f"{card.name}.{which}"
        if first == second:
            self.add("loads", card, {"at": inner, "kind": "short"}, inner)
        else:
            self.two_port(card, ((first, second), (inner, REFERENCE)), "transformer", inner, signed_ratio=1.0)
        return inner

    def model(self, card: Card, name: str) -> Card:
        """The model of that name in the innermost subcircuit around a card that has one."""
        around = card.name.split(".")[:-1]
        for depth in range(len(around), -1, -1):
            model = self.models.get(".".join([*around[:depth], name]).lower())
            if model is not None:
                return model
        raise card.refuse("its model is not there", "the name of a .model", f"'{name:.40}'")

    def at_begin(self, ends: tuple[str, str]) -> float:
        """Voltage between two nodes at t = 0 by .ic."""
        first, second = (self.initial[end.lower()][1] if end.lower() in self.initial else 0.0 for end in ends)
        return first - second

    def terminals(self) -> Iterator[tuple[str, str, list[str]]]:
        """Section, name and nodes of all elements; the reference counts where a link names it."""
        for section, tables in self.tables.items():
            for name, table in tables.items():
                nodes = [*table.get("nodes", ()), *table.get("nodes1", ()), *table.get("nodes2", ())]
                yield section, name, [*nodes, *([table["at"]] if "at" in table else [])]

    def degrees(self) -> Counter[str]:
        """Number of terminals at each node."""
        return Counter(node for _, _, nodes in self.terminals() for node in nodes)


def connected(net: Netlist) -> set[str]:
    """Drop parts that no line reaches, such as a supply of omitted transistors; return the dropped nodes."""
    neighbours: dict[str, set[str]] = {}
    for _, _, nodes in net.terminals():
        own = [node for node in nodes if node != REFERENCE]
        for node in own:
            neighbours.setdefault(node, set()).update(own)
    reached: set[str] = set()
    waiting = [node for section, _, nodes in net.terminals() if section == "lines" for node in nodes]
    while waiting:
        node = waiting.pop()
        if node not in reached:
            reached.add(node)
            waiting += neighbours.get(node, ())
    for section, name, nodes in list(net.terminals()):
        if not reached.intersection(nodes) and REFERENCE not in nodes[:1]:
            del net.tables[section][name]
            net.found.note(net.cards[section, name].where, "skipped, for it is connected to no line")
    return neighbours.keys() - reached


def check_size(net: Netlist, path: str) -> None:
    """Refuse circuits with too many nodes between lines: their matrices take minutes and gigabytes."""
    numbers: dict[str, int] = {}
    ends = [
        [numbers.setdefault(node, len(numbers)) for node in link["nodes"] if node != REFERENCE]
        for link in net.tables["links"].values()
    ]
    first, second = np.array([(nodes[0], node) for nodes in ends for node in nodes], int).reshape(-1, 2).T
    most = int(np.bincount(parts(first, second, len(numbers))).max(initial=0))
    if most > MOST_NODES:
        raise InputError(path, "a circuit of too many nodes between lines", f"at most {MOST_NODES}", f"{most}")


def without_idle_stores(net: Netlist) -> None:
    """Drop capacitors and inductors beside ideal voltages against the reference: no voltage depends on them."""
    ideal = [s for s in net.tables["sources"].values() if s["kind"] == "voltage" and "resistance" not in s]
    held = {source.get("at") for source in ideal}
    for name, load in list(net.tables["loads"].items()):
        if load["at"] in held and load["kind"] in ("capacitor", "inductor"):
            del net.tables["loads"][name]
            net.found.note(net.cards["loads", name].where, "skipped, for it stands beside an ideal voltage")


def folded(net: Netlist, probed: set[str]) -> None:
    """Merge a resistor behind a source of voltage, alone at its node, into the source's resistance."""
    degrees = net.degrees()
    links = {node: name for name, link in net.tables["links"].items() for node in link["nodes"]}
    for table in net.tables["sources"].values():
        first = table.get("at") or table["nodes"][0]
        name = links.get(first, "")
        link = net.tables["links"].get(name, {})
        if degrees[first] != 2 or first in probed or link.get("kind") != "resistor" or table["kind"] != "voltage":
            continue
        one, other = link["nodes"]
        beyond = other if one == first else one
        if beyond in table.get("nodes", ()):
            continue
        if "at" in table:
            table["at"] = beyond
        else:
            table["nodes"] = [beyond, table["nodes"][1]]
        table["resistance"] = table.get("resistance", 0.0) + link["resistance"]
        del net.tables["links"][name]


def with_open_ends(net: Netlist) -> None:
    """Put open loads at ends of links and sources where nothing else is."""
    ends = {node for section, _, nodes in net.terminals() if section == "lines" for node in nodes}
    degrees = net.degrees()
    for section, name, nodes in list(net.terminals()):
        for node in nodes if section in ("links", "sources") else ():
            if degrees[node] == 1 and node not in ends:
                net.add("loads", net.cards[section, name], {"at": node, "kind": "open"}, f"{node} (open)")


def with_links(net: Netlist) -> None:
    """Turn a load at a node without lines and links into a link to the reference, since a scene needs one there."""
    elements = [element for tables in net.tables.values() for element in tables.values()]
    ended = {node for each in elements for key in ("nodes", "nodes1", "nodes2") for node in each.get(key, ())}
    alone = {source["at"] for source in net.tables["sources"].values() if "at" in source} - ended
    joined: set[str] = set()
    for name, load in list(net.tables["loads"].items()):
        if (node := load["at"]) in alone and load["kind"] in LINKED:
            nodes = [node, REFERENCE][:: -1 if load.get("reverse") else 1]
            table = {key: value for key, value in load.items() if key not in ("at", "reverse")}
            net.add("links", net.cards["loads", name], {"nodes": nodes} | table, name)
            del net.tables["loads"][name]
            joined.add(node)
    ideal = {s["at"]: name for name, s in net.tables["sources"].items() if s["kind"] == "voltage" and "at" in s}
    for node, name in ideal.items():
        if node in alone - joined and "resistance" not in net.tables["sources"][name]:
            card = net.cards["sources", name]
            net.found.note(card.where, "it stands alone: a resistor of 1 ohm is put beside it")
            net.add("links", card, {"nodes": [node, REFERENCE], "kind": "resistor", "resistance": 1.0}, f"{name}.r")
    if any(REFERENCE in link["nodes"] for link in net.tables["links"].values()):
        net.tables["loads"]["reference"] = {"at": REFERENCE, "kind": "short"}
