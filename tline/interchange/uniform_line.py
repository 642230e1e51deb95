"""Lines with R, L, G and C per length as lines of a scene, or as resistors and capacitors where they have no L."""

from collections.abc import Sequence
from itertools import pairwise
from math import cosh, sinh, sqrt

import numpy as np

from tline.interchange.deck import Card
from tline.interchange.netlist import REFERENCE, Netlist, Table
from tline.line.electrical import LIGHT
from tline.scene.cable_loss import LossTangent
from tline.scene.quantity import LARGEST

USUAL = 2e8  # m/s, taken where the length in SPICE, which has no unit, is no metre
SECTIONS = 40  # of a line of R and C alone
HIGH = 1e9  # Hz, at which the resistance by Rs and the conductance by Gd are said
LOW, TOP = 1e5, 1e12  # Hz, between which the loss tangent hardly changes
Matrix = list[list[float]]


def add_uniform(card: Card, net: Netlist, nodes: Sequence[str], given: dict[str, float]) -> None:
    """Add a line of one conductor."""
    R, L, G, C, length = (given[key] for key in ("r", "l", "g", "c", "len"))
    if L and C:
        net.add("lines", card, {"nodes": [*nodes]} | _line(card, net, R, L, G, C, length))
    elif R and C and not L:
        _rc_line(card, net, nodes, R * length, G * length, C * length)
    elif R and not L:
        _resistors(card, net, nodes, R * length, G * length)
    else:
        raise card.refuse("without C, or without R and L, it is no line", "R, L, G and C", f"L={L:g} and C={C:g}")


def _line(card: Card, net: Netlist, R: float, L: float, G: float, C: float, length: float) -> Table:
    delay = length * sqrt(L * C)
    line: Table = {"z0": sqrt(L / C), "delay": delay}
    if R or G:
        metres = _metres(card, net, length, delay)
        scale = length / metres
        line |= {"length": metres} | {key: x * scale for key, x in (("resistance", R), ("conductance", G)) if x}
    return line


def _metres(card: Card, net: Netlist, length: float, delay: float) -> float:
    """The length, or another where waves would be faster than light over it."""
    if length <= delay * LIGHT:
        return length
    net.found.note(card.where, f"its length of {length:g} is no metres; taken as {delay * USUAL:.3g} m, at 2e8 m/s")
    return delay * USUAL


def _rc_line(card: Card, net: Netlist, nodes: Sequence[str], R: float, G: float, C: float) -> None:
    """C and G between halves of R."""
    net.found.note(card.where, f"a line without inductance: {SECTIONS} sections of R and C")
    chain = [nodes[0], *(f"{card.name}.{k}" for k in range(1, SECTIONS + 1)), nodes[1]]
    for k, (first, second) in enumerate(pairwise(chain), 1):
        part = R / SECTIONS / (2 if k in (1, SECTIONS + 1) else 1)
        net.between(card, (first, second), {"kind": "resistor", "resistance": part}, f"{card.name}.r{k}")
    table: Table = {"kind": "parallel", "capacitance": C / SECTIONS} | ({"resistance": SECTIONS / G} if G else {})
    for k, node in enumerate(chain[1:-1], 1):
        net.between(card, (node, REFERENCE), table, f"{card.name}.c{k}")


def _resistors(card: Card, net: Netlist, nodes: Sequence[str], R: float, G: float) -> None:
    """A line of R and G alone, exactly: one resistor between its ends, one at either end."""
    theta = sqrt(R * G)
    through = R * sinh(theta) / theta if theta else R
    net.between(card, nodes, {"kind": "resistor", "resistance": through}, f"{card.name}.r")
    if G:
        for k, node in enumerate(nodes, 1):
            table = {"kind": "resistor", "resistance": through / (cosh(theta) - 1)}
            net.between(card, (node, REFERENCE), table, f"{card.name}.g{k}")


def add_conductors(
    card: Card, net: Netlist, ends: tuple[list[str], list[str]], given: dict[str, Matrix], length: float
) -> None:
    """Add conductors by matrices per length: r, l, g, c, and rs of skin effect at 1 Hz."""
    if length <= 0:
        raise card.refuse("its length is not above zero", "more than 0", f"{length:g}")
    largest = max((abs(value) for rows in given.values() for row in rows for value in row), default=0.0)
    for key, name in (("l", "L"), ("c", "C")):
        if key not in given or min(row[k] for k, row in enumerate(given[key])) <= 0:
            raise card.refuse(f"its {name} is not above zero", "more than 0 for each conductor")
    if largest > LARGEST:
        raise card.refuse("its matrices hold a number that is too large", f"at most {LARGEST:g}", f"{largest:g}")
    squares = np.linalg.eigvals(np.array(given["l"]) @ np.array(given["c"])).real
    delay = length * float(np.sqrt(max(squares.min(), 0.0)))
    scale = length / _metres(card, net, length, delay) if delay else 1.0
    matrices = {key: (scale * np.array(rows)).tolist() for key, rows in given.items() if np.any(rows)}
    names = {"l": "inductance", "c": "capacitance", "r": "resistance", "g": "conductance"}
    line: Table = {"length": length / scale} | {name: matrices[key] for key, name in names.items() if key in matrices}
    if "rs" in matrices:
        high = [[value * sqrt(HIGH) for value in row] for row in matrices["rs"]]
        line["skin"] = {"resistance": high, "frequency": HIGH, "added": True}
    if len(ends[0]) > 1:
        net.add("lines", card, {"nodes1": ends[0], "nodes2": ends[1]} | line)
        return
    line = {name: value[0][0] if isinstance(value, list) else value for name, value in line.items()}
    if "skin" in line:
        line["skin"] = line["skin"] | {"resistance": line["skin"]["resistance"][0][0]}
    if "gd" in given and given["gd"][0][0]:
        line |= _insulation(card, net, line["capacitance"], given["gd"][0][0] * scale)
    net.add("lines", card, {"nodes": [ends[0][0], ends[1][0]]} | line)


def _insulation(card: Card, net: Netlist, C: float, Gd: float) -> Table:
    """Capacitance and loss tangent of a conductance proportional to frequency: causal, and the same at 1 GHz."""
    tangent = Gd / (2 * np.pi * C)
    said = {"value": tangent, "frequency": HIGH, "low": LOW, "high": TOP}
    try:
        law = LossTangent.model_validate(said).law(C)
    except ValueError:
        raise card.refuse("Gd is too large beside C", "a loss tangent below 0.1", f"{tangent:.3g}") from None
    text = (
        f"Gd becomes a loss tangent of {tangent:.3g} from {LOW:g} to {TOP:g} Hz: beside a constant C it is not causal"
    )
    net.found.note(card.where, text)
    return {"loss_tangent": said, "capacitance": C * C / law.storage}
