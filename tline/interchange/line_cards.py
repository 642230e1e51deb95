"""Lines of SPICE netlists: T, O by an LTRA model, Y by a TXL model, P by a CPL model, U by a URC model, W by RLGC."""

from itertools import pairwise
from math import log, pi

from tline.interchange.deck import Card
from tline.interchange.netlist import REFERENCE, Netlist, Table
from tline.interchange.per_length import UPPER, add_conductors, add_uniform, rlgc_matrices, symmetric

NUMERICAL = {  # of LTRA: how that program computes, not what the line is
    "rel", "abs", "nosteplimit", "nocontrol", "lininterp", "quadinterp", "mixedinterp", "compactrel", "compactabs",
    "truncnr", "truncdontcut", "steplimit", "fullcontrol", "halfcontrol", "complexsteplimit",
}  # fmt: skip
RC = {"k": 1.5, "fmax": 1e9, "rperl": 1e3, "cperl": 1e-12}  # of a URC model, with defaults
FEWEST, MOST_SECTIONS = 3, 100
NO_LENGTH = 1e-9  # ohm
SPELT = {"z": "z0", "zo": "z0", "delay": "td", "freq": "f"}  # of T, in the dialects


def lossless_line(card: Card, net: Netlist) -> None:
    """A T element; the numbers of its begin must be zero. With R, L, G and C per length it is lossy, as in PSpice.

    They are its own, or those of a TRN model.
    """
    plain, own = card.assigned(4)
    if len(plain) == 1:
        plain, own = [], net.model(card, plain[0]).of_kind("TRN").assigned(2)[1] | own
    given = {SPELT.get(key, key): words for key, words in own.items()}
    names = "Z0 with TD, or with F (and NL)"
    if {"len", "l", "c"} <= given.keys() <= {"len", "r", "l", "g", "c"}:
        add_uniform(card, net, _ends(card, net), _per_length(card._replace(words=["", "ltra"]), "ltra", given))
        return
    if plain or len(given) < len(own) or not given.keys() <= {"z0", "td", "f", "nl", "ic", "rel", "abs", "l"}:
        raise card.refuse("not a list of what a lossless line has", names, f"'{' '.join(card.words[4:]):.60}'")
    if any(card.value(word) for word in given.pop("ic", [])):
        raise card.refuse("a begin that is not zero", "IC=0,0,0,0")
    single = {key: words for key, words in given.items() if len(words) == 1}
    value = {key: card.value(words[0]) for key, words in single.items()}
    if "z0" not in value or ("td" in value) == ("f" in value) or {"td", "nl"} <= value.keys():
        raise card.refuse("its z0 and delay are not given once", names, ", ".join(given).upper())
    if value.get("f", 1.0) <= 0:
        raise card.refuse("its frequency is not above zero", "more than 0", f"{value['f']:g}")
    delay = value["td"] * value.get("l", 1.0) if "td" in value else value.get("nl", 0.25) / value["f"]
    net.add("lines", card, {"nodes": _ends(card, net), "z0": value["z0"], "delay": delay})


def lossy_line(card: Card, net: Netlist) -> None:
    """An O element by an LTRA model."""
    if len(card.words) > 5 and "=" not in card.words:
        raise card.refuse("has more than a model", "its nodes and a .model", f"'{' '.join(card.words[4:]):.40}'")
    given = _per_length(net.model(card, card.words[4]), "ltra", card.assigned(5)[1])
    if given["len"] > 0:
        add_uniform(card, net, _ends(card, net), given)
        return
    net.found.note(card.where, f"a line of no length is {NO_LENGTH:g} ohm between its ends")
    for k, name in enumerate((card.name, f"{card.name}.base")):  # as Xyce allows
        ends = net.node(card.words[k]), net.node(card.words[k + 2])
        if ends[0] != ends[1]:
            net.between(card, ends, {"kind": "resistor", "resistance": NO_LENGTH}, name)


def txl_line(card: Card, net: Netlist) -> None:
    """A Y element by a TXL model."""
    model = net.model(card, card.words[4])
    given = _per_length(model, "txl", card.assigned(5)[1])
    add_uniform(card, net, _ends(card, net), given)


def lumped_line(card: Card, net: Netlist) -> None:
    """Xyce's YTRANSLINE: sections of L and R in series, each with C behind it.

    References
    ----------
    Xyce Reference Guide, "Lumped transmission line".
    """
    first, second = map(net.node, card.words[:2])
    model, own = net.model(card, card.words[2]), card.assigned(3)[1]
    lumps = card.value("".join(own.pop("lumps", ["1"])))
    if lumps < 1:
        raise card.refuse("too few sections", "LUMPS=1 or more", f"{lumps:g}")
    given, n = _per_length(model, "transline", own), int(lumps)
    if n > MOST_SECTIONS:
        net.found.note(card.where, f"the uniform line in place of its {n} sections")
        add_uniform(card, net, [first, second], given)
        return
    R, L, C = (given[key] * given["len"] / n for key in "rlc")
    if given["g"] or min(L, C) <= 0:
        raise model.refuse("values that its sections do not have", "L and C above 0, R, and no G")
    impedance: Table = {"kind": "series", "inductance": L} | ({"resistance": R} if R else {})
    nodes = [first, *(f"{card.name}.{k}" for k in range(1, n)), second]
    for k, ends in enumerate(pairwise(nodes), 1):
        net.between(card, ends, impedance, f"{card.name}.l{k}")
        net.between(card, (ends[1], REFERENCE), {"kind": "capacitor", "capacitance": C}, f"{card.name}.c{k}")


def _per_length(model: Card, kind: str, own: dict[str, list[str]]) -> dict[str, float]:
    """R, L, G and C per length, and the length, from a model and the element's own parameters."""
    plain, given = model.of_kind(kind.upper()).assigned(2)
    flags = [word for words in given.values() for word in words[1:]]
    values = {"r": 0.0, "l": 0.0, "g": 0.0, "c": 0.0}
    for word in [*plain, *flags]:
        if word.lower() not in NUMERICAL:
            raise model.refuse("not a list of what a lossy line has", "R, L, G, C and LEN", f"'{word:.40}'")
    for key, words in (given | own).items():
        name = "len" if key == "length" else key
        if name not in (*values, "len"):
            if key not in NUMERICAL:
                raise model.refuse("not a list of what a lossy line has", "R, L, G, C and LEN", f"'{key:.40}'")
            continue
        if not words:
            raise model.refuse("not a list of values", f"{name.upper()}=1")
        values[name] = model.value(words[0])
        if values[name] < 0:
            raise model.refuse(f"its {name.upper()} is below zero", "0 or more", f"{values[name]:g}")
    if "len" not in values or (kind != "ltra" and values["len"] == 0):
        raise model.refuse("its LEN is not above zero", "more than 0", f"{values.get('len', 0.0):g}")
    return values


def _ends(card: Card, net: Netlist) -> list[str]:
    """Nodes at which a line of two terminals at either end ends."""
    first, low, second, base = map(net.node, card.words[:4])
    _check_begin(card, net, first, low, second, base)
    return [net.end(card, 1, first, low), net.end(card, 2, second, base)]


def _check_begin(card: Card, net: Netlist, *nodes: str) -> None:
    for node in nodes:
        if net.initial.get(node.lower(), (card, 0.0))[1]:
            raise net.initial[node.lower()][0].refuse("a voltage on a line at t = 0", f"v({node})=0, or no .ic")


def coupled_line(card: Card, net: Netlist) -> None:
    """A P element by a CPL model: upper triangles of matrices."""
    plain, own = card.assigned(0)
    if len(plain) < 5:
        raise card.refuse("is not whole", "N nodes and 0, twice, and a model")
    *nodes, name = plain
    first, second = _conductors(card, net, nodes)
    model = net.model(card, name).of_kind("CPL")
    _, given = model.assigned(2)
    k, length = len(first), given.pop("length", given.pop("len", []))
    length = own.get("len", own.get("length", length))
    matrices = {}
    for key, words in given.items():
        if key not in ("r", "l", "g", "c"):
            raise model.refuse("not a list of what a line has", "R, L, G, C and length", f"'{key:.40}'")
        matrices[key] = symmetric(model, key, words, k, UPPER)
    if len(length) != 1:
        raise model.refuse("its length is not given once", "length=1")
    add_conductors(card, net, (first, second), matrices, model.value(length[0]))


def _conductors(card: Card, net: Netlist, names: list[str]) -> tuple[list[str], list[str]]:
    """Nodes at either end of conductors over a reference."""
    nodes, half = [net.node(name) for name in names], len(names) // 2
    if len(nodes) < 4 or len(nodes) % 2:
        raise card.refuse("its ends have not as many nodes", "N nodes and 0, twice", f"'{' '.join(nodes):.40}'")
    first, second = nodes[: half - 1], nodes[half:-1]
    _check_begin(card, net, *nodes)
    if half == 2:
        return [net.end(card, 1, first[0], nodes[1])], [net.end(card, 2, second[0], nodes[3])]
    if {nodes[half - 1], nodes[-1]} != {REFERENCE}:
        raise card.refuse("conductors that are not against the reference", "0 for the last node of either end")
    if REFERENCE in (*first, *second):
        raise card.refuse("an end at the reference", "another node, and a resistor to 0 there")
    return first, second


def w_line(card: Card, net: Netlist) -> None:
    """A W element by a static RLGC model, inline or in a file; ngspice's W, a switch, is refused."""
    plain, own = card.assigned(0)
    if not own:
        raise card.refuse("a switch that a current commands", "kind = 'switch' in a scene, which changes at an instant")
    first, second = _conductors(card, net, plain)
    length, matrices = rlgc_matrices(card, net, own, len(first))
    add_conductors(card, net, (first, second), matrices, length)


def rc_line(card: Card, net: Netlist) -> None:
    """A U element by a URC model, in the sections that SPICE makes of it: shorter towards the ends.

    References
    ----------
    A. Vladimirescu: The SPICE Book, Wiley 1994, on the uniform RC line; L. Gertzberg's thesis of 1974.
    """
    if len(card.assigned(0)[0]) != 4:
        expected = "two nodes, base and a URC model; for U of HSPICE a W element or T"
        raise card.refuse("not a uniform RC line", expected)
    first, second, base = map(net.node, card.words[:3])
    model = net.model(card, card.words[3]).of_kind("URC")
    values, own = dict(RC), {key: card.value(words[0]) for key, words in card.assigned(4)[1].items() if words}
    for key, words in model.assigned(2)[1].items():
        if key not in RC or len(words) != 1:
            raise model.refuse("not a list of what an RC line has", "K, FMAX, RPERL and CPERL", f"'{key:.40}'")
        values[key] = model.value(words[0])
    if own.keys() - {"l", "n"} or own.get("l", 0.0) <= 0:
        raise card.refuse("not a length and perhaps a number of sections", "L=1 N=6")
    k, R, C = values["k"], own["l"] * values["rperl"], own["l"] * values["cperl"]
    if k <= 1 or min(R, C, values["fmax"]) <= 0:
        raise model.refuse("values that no line has", "K above 1, the others above 0")
    width = 2 * pi * values["fmax"] * R * C
    lumps = own.get("n", FEWEST if width < 35 else max(FEWEST, log(width * ((k - 1) / k) ** 2) / log(k)))
    if not 1 <= lumps <= MOST_SECTIONS:
        raise card.refuse("too few or too many sections", f"N=1 to {MOST_SECTIONS}", f"{lumps:g}")
    n = int(lumps)
    r, c = R * (k - 1) / (2 * k**n - 2), C * (k - 1) / (k ** (n - 1) * (k + 1) - 2)
    low, high = first, second
    for i in range(1, n + 1):
        middle = f"{card.name}.m"
        a, b = (middle, middle) if i == n else (f"{card.name}.lo{i}", f"{card.name}.hi{i}")
        for side, inner, outer in (("lo", a, low), ("hi", b, high)):
            table = {"kind": "resistor", "resistance": r * k ** (i - 1)}
            net.between(card, (outer, inner), table, f"{card.name}.r{side}{i}")
            if side == "lo" or i < n:
                table = {"kind": "capacitor", "capacitance": c * k ** (i - 1)}
                net.between(card, (inner, base), table, f"{card.name}.c{side}{i}")
        low, high = a, b
