"""Multiports of SPICE netlists: coupled inductors, and sources that a voltage commands, all against the reference."""

from collections.abc import Mapping
from typing import Any

from tline.interchange.branches import Branch
from tline.interchange.deck import Card


def coupled_inductors(card: Card, cards: Mapping[str, Card], branches: list[Branch]) -> dict[str, Any]:
    """The link that a K card makes of two inductors, which are taken out of the branches.

    Raises
    ------
    InputError
        Naming the K card: its inductors are not there or coupled already, or do not stand between different nodes and
        the reference; or its coupling is not between -1 and 1.
    """
    if len(card.words) != 3:
        raise card.refuse("couples other than two inductors", "K1 L1 L2 0.9", f"'{' '.join(card.words):.40}'")
    nodes, inductance, coupling = [], [], card.value(card.words[2])
    for name in card.words[:2]:
        windings = [branch for branch in branches if branch.name.lower() == name.lower()]
        if not windings or cards[name.lower()].kind != "L":
            raise card.refuse("no such inductor, or another K couples it", "two L of their own", f"'{name:.40}'")
        (winding,) = windings
        if "0" not in winding.nodes:
            between = " and ".join(f"'{node}'" for node in winding.nodes)
            raise card.refuse(f"{name} lies between nodes {between}", "inductors from a node to 0")
        branches.remove(winding)
        nodes.append(winding.other("0"))
        inductance.append(cards[name.lower()].value(cards[name.lower()].words[2]))
        coupling *= 1 if winding.nodes[1] == "0" else -1  # the first node has the dot
    if nodes[0] == nodes[1]:
        raise card.refuse("both inductors are at one node", "two nodes", f"'{nodes[0]}'")
    if abs(coupling) >= 1:
        raise card.refuse("without leakage the windings are one", "a coupling between -1 and 1", f"{coupling:g}")
    return {"kind": "coupled inductors", "nodes": nodes, "inductance": inductance, "coupling": coupling}
