"""Lines of netlists by R, L, G and C per length, or by static RLGC models, as lines or as R and C of a scene."""

from collections.abc import Sequence
from itertools import pairwise
from math import cosh, sinh, sqrt

import numpy as np

from tline.errors import InputError
from tline.interchange.deck import Card
from tline.interchange.netlist import REFERENCE, Netlist, Table
from tline.line.electrical import LIGHT
from tline.scene.cable_loss import LossTangent
from tline.scene.quantity import LARGEST
from tline.scene.text_file import Folder, read_text

MATRICES = {"l0": "l", "c0": "c", "r0": "r", "g0": "g", "rs": "rs", "gd": "gd"}
IN_FILE = ("l", "c", "r", "g", "rs", "gd")  # in this order
NO_MATTER = {"delayopt", "fgd"}  # the first tells how to compute, the second is a corner of Gd
LOWER, UPPER = "a lower", "an upper"
Matrix = list[list[float]]
USUAL = 2e8  # m/s, taken where the length in SPICE, which has no unit, is no metre
SECTIONS = 40  # of a line of R and C alone
HIGH = 1e9  # Hz, at which the resistance by Rs and the conductance by Gd are said
LOW, TOP = 1e5, 1e12  # Hz, between which the loss tangent hardly changes


def symmetric(model: Card, key: str, words: list[str], n: int, side: str) -> Matrix:
    """Rows of a symmetric matrix by its lower or upper triangle, row by row."""
    if len(words) != n * (n + 1) // 2:
        problem, expected = f"its {key.capitalize()} is not {side} triangle", f"{n * (n + 1) // 2} values"
        raise model.refuse(problem, expected, f"{len(words)}")
    rows = [[0.0] * n for _ in range(n)]
    places = [(i, j) for i in range(n) for j in (range(i + 1) if side == LOWER else range(i, n))]
    for (i, j), word in zip(places, words, strict=True):
        rows[i][j] = rows[j][i] = model.value(word)
    return rows


def rlgc_matrices(
    card: Card, net: Netlist, own: dict[str, list[str]], conductors: int
) -> tuple[float, dict[str, Matrix]]:
    """Length and matrices per length of a W element.

    Z(f) = Ro + √f (1+j) Rs + 2πj f Lo and Y(f) = Go + f Gd + 2πj f Co per metre, lower triangles of symmetric matrices.

    References
    ----------
    HSPICE Elements and Device Models Manual, chapter "W element", input model 1; D. B. Kuznetsov, J. E. Schutt-Aine,
    IEEE Trans. Circuits and Systems I 43 (1996) 110-121.
    """
    own = {key: words for key, words in own.items() if key not in NO_MATTER}
    given = {key: words[0] for key, words in own.items() if len(words) == 1}
    if "tablemodel" in given:
        raise card.refuse("a table over frequency", "tabulated, with a CSV file, in the scene")
    if given.keys() != own.keys() or given.keys() not in ({"n", "l", "rlgcmodel"}, {"n", "l", "rlgcfile"}):
        expected = "N=1 in 0 out 0 RLGCMODEL=name L=length, or RLGCFILE=file"
        raise card.refuse("not a line by a static RLGC model", expected, f"'{' '.join(card.words):.60}'")
    if card.value(given["n"]) != conductors:
        raise card.refuse("another number of conductors", f"N={conductors}", f"N={given['n']:.40}")
    length = card.value(given["l"])
    if "rlgcfile" in given:
        matrices = _from_file(card, net, given["rlgcfile"].strip("'\""), conductors)
    else:
        matrices = _from_model(net.model(card, given["rlgcmodel"]), conductors)
    if conductors > 1 and any(map(any, matrices.get("gd", []))):
        problem = "Gd of several conductors, a conductance proportional to frequency, is not causal beside constant C"
        raise card.refuse(problem, "Gd=0")
    return length, matrices


def _from_model(model: Card, n: int) -> dict[str, Matrix]:
    _, given = model.of_kind("W").assigned(2)
    if [word.lower() for word in given.pop("modeltype", [])] != ["rlgc"]:
        raise model.refuse("not known here", ".model NAME W MODELTYPE=RLGC", f"'{' '.join(model.words[1:5])}'")
    if [model.value(word) for word in given.pop("n", [str(n)])] != [n]:
        raise model.refuse("another number of conductors", f"N={n}")
    found: dict[str, Matrix] = {}
    for key, words in given.items():
        name = MATRICES.get(key[0] + "0" if key[1:] in ("", "o") else key)
        if name is None or name in found:
            raise model.refuse("not a list of what a line has", "Lo, Co, Ro, Go, Rs and Gd, each once", f"'{key:.40}'")
        found[name] = symmetric(model, key, words, n, LOWER)
    return found


def _from_file(card: Card, net: Netlist, name: str, n: int) -> dict[str, Matrix]:
    """Matrices of a file beside the netlist: the number of conductors, then lower triangles in a fixed order."""
    try:
        text = read_text(Folder(net.folder, confined=True).find(name), legacy=True)
    except InputError as error:
        raise card.refuse(error.problem.replace("scene's", "netlist's"), error.expected, error.got) from None
    words = [word for line in text.splitlines() for word in line.partition("*")[0].replace(",", " ").split()]
    size = n * (n + 1) // 2
    count, left = divmod(len(words) - 1, size)
    if not words or card.value(words[0]) != n or left or not 2 <= count <= len(IN_FILE):
        problem = f"'{name:.60}' has not the numbers of {n} conductors"
        raise card.refuse(problem, f"{n}, then {size} numbers for each of L, C, R, G, Rs and Gd, at least L and C")
    parts = [words[1 + k * size : 1 + (k + 1) * size] for k in range(count)]
    return {key: symmetric(card, key, part, n, LOWER) for key, part in zip(IN_FILE, parts, strict=False)}


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
