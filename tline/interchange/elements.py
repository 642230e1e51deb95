"""Elements of a SPICE netlist between two nodes: R, L, C, diodes and sources, also those that something commands."""

from collections.abc import Callable, Iterable
from contextlib import suppress
from typing import Any

from tline.errors import InputError
from tline.interchange.deck import LUMPED, Card, Findings
from tline.interchange.line_cards import coupled_line, lossless_line, lossy_line, lumped_line, rc_line, txl_line, w_line
from tline.interchange.netlist import AMMETER, REFERENCE, Netlist, Table
from tline.interchange.spice_impedance import impedance, value_of
from tline.interchange.spice_source import said_of, waveforms

KEYS = {"is": "saturation", "n": "emission", "js": "saturation"}
DEFAULTS = {"saturation": 1e-14, "emission": 1.0}  # of SPICE
NOMINAL = 300.15  # K
ZERO = {"cjo", "cj0", "cj", "tt", "ikf", "ik", "isr", "jsw", "cjp", "cjsw"}  # of a real diode; here they must be zero
OF_THESE = {  # no matter where those are zero, or at one temperature
    "vj", "pb", "m", "mj", "fc", "eg", "xti", "tnom", "tref", "kf", "af", "nr", "level", "php", "mjsw", "fcs", "bv",
    "ibv", "nbv", "trs", "trs1", "trs2", "tcv", "mfg", "type", "iave", "vpk",
}  # fmt: skip
STAND_IN = "in its place a source behind a resistance, or a table of voltages and currents, kind = 'table'"
REFUSED = {
    **dict.fromkeys("QMJZ", ("a transistor, and there are none here", STAND_IN)),
    **dict.fromkeys("NA", ("a compiled model", "what it stands for, of elements that are known here")),
    "S": ("a switch that a voltage commands", "kind = 'switch' in a scene, which changes at an instant"),
}
KNOWN = "R, L, C, K, D, V, I, B, E, F, G, H, T, O, W, U, Y, P and X"


def diode(model: Card, found: Findings) -> tuple[dict[str, Any], float]:
    """The table of a diode, without its nodes, and the resistance in series with it, ohm."""
    plain, given = model.of_kind("D").assigned(2)
    table: dict[str, Any] = {"kind": "diode"} | DEFAULTS
    series = 0.0
    for key in plain:
        raise model.refuse("not a list of parameters", "name = value", f"'{key:.40}'")
    for name, words in given.items():
        if name in ("mfg", "type"):
            continue
        if len(words) != 1:
            raise model.refuse("not a list of parameters", "name = value", f"'{name:.40}'")
        number = model.value(words[0])
        if name in KEYS:
            table[KEYS[name]] = number
        elif name == "rs":
            series = number
        elif name in ("bv", "vb"):
            found.note(model.where, f"the breakdown at {number:g} V is left out")
        elif name not in OF_THESE and (name not in ZERO or number):
            problem = "more than an exponential and a resistance"
            raise model.refuse(problem, f"IS, N and RS; {name.upper():.40} zero", f"'{name:.40}'")
    if series < 0:
        raise model.refuse("its RS is below zero", "0 or more", f"{series:g}")
    return table, series


def take(card: Card, net: Netlist) -> None:
    """Add an element to the scene."""
    if card.kind in REFUSED:
        raise card.refuse(*REFUSED[card.kind])
    if card.kind not in ELEMENTS:
        raise card.refuse("not known here", KNOWN)
    if len(card.words) < (5 if card.kind in "TOEGYP" else 4 if card.kind in "UFH" else 3):
        raise card.refuse("is not whole", "its nodes and a value")
    ELEMENTS[card.kind](card, net)


def merge_shorts(cards: Iterable[Card], net: Netlist) -> None:
    """Merge nodes connected by sources of 0 V or resistors of 0 ohm, except sensed ones."""
    for card in cards:
        if len(card.words) < 3 or card.kind not in "VR" or card.name.lower() in net.sensed:
            continue
        with suppress(InputError):  # it is reported when the element is taken
            if value_of(card, net) == 0 if card.kind == "R" else said_of(card, Findings()).is_zero(net.tran):
                net.merge(*card.words[:2])


def _diode(card: Card, net: Netlist) -> None:
    """An exponential, with its resistance in series if it has one."""
    first, second = map(net.node, card.words[:2])
    plain, assigned = card.assigned(3)
    if assigned.keys() - {"area", "ic", "m", "temp"} or len(plain) > 2:
        raise card.refuse("has more than a model and an area", "two nodes and a .model")
    area = 1.0
    for word in (word for word in [*plain, *assigned.get("area", []), *assigned.get("m", [])] if word.lower() != "off"):
        area *= card.value(word)
    if area <= 0:
        raise card.refuse("its area is not above zero", "more than 0", f"{area:g}")
    table, series = diode(net.model(card, card.words[2]), net.found)
    table["saturation"] *= area
    if series:
        inner = f"{card.name}.rs"
        net.between(card, (first, inner), {"kind": "resistor", "resistance": series / area}, inner)
        first = inner
    net.between(card, (first, second), table)


def _source(card: Card, net: Netlist) -> None:
    """A source; a current flows through it from its first node to its second."""
    said = said_of(card, net.found)
    first, second = map(net.node, card.words[:2])
    net.quiet = net.quiet and said.is_quiet
    sensed = card.name.lower() in net.sensed
    silent = said.is_zero(net.tran)
    if card.kind == "V" and silent and not sensed:
        net.short(card, (first, second))
        return
    if first == second:
        raise card.refuse("both ends are at one node", "two nodes")
    sign, kind = (1.0, "voltage") if card.kind == "V" else (-1.0, "current")
    if card.kind == "V" and sensed:
        if silent:
            net.ammeter(card, first, second)
            return
        net.ammeter(card, f"{card.name}.m", second)
        second = f"{card.name}.m"
    if first == REFERENCE:
        first, second, sign = second, first, -sign
    parts = waveforms(card, said, net.tran, sign)
    own: Table = {"resistance": said.resistance} if said.resistance else {}
    for k, part in enumerate(parts):  # voltages add up in a row, currents side by side
        last, name = k == len(parts) - 1, card.name + f" ({k + 1})" * (k > 0)
        low = second if kind == "current" or last else f"{card.name}.s" + f"{k}" * (k > 0)
        net.source(card, (first, low), {"kind": kind, "value": part} | (own if last else {}), name)
        first = first if kind == "current" else low


def controlled(card: Card, net: Netlist) -> None:
    """A source that a voltage (E, G) or the current of a source (F, H) commands; G by its own voltage is a resistor."""
    if "=" in card.words:
        raise _no_gain(card)
    out = (net.node(card.words[0]), net.node(card.words[1]))
    named = 4 if card.kind in "EG" else 3
    if len(card.words) != named + 1:
        raise _no_gain(card)
    gain = card.value(card.words[named])
    if gain == 0 or abs(1 / gain) == float("inf"):
        raise card.refuse("its gain is zero", "another gain", f"'{' '.join(card.words):.40}'")
    if out[0] == out[1]:
        net.found.note(card.where, "skipped, for both its ends are at one node")
        return
    if card.kind in "FH":
        at = net.sensed.get(card.words[2].lower())
        if at is None:
            raise card.refuse("no such source", "the name of a V", f"'{card.words[2]:.40}'")
        control, gain = (at, REFERENCE), gain / AMMETER
    else:
        control = (net.node(card.words[2]), net.node(card.words[3]))
    if {*control} == {*out} and control[0] != control[1]:
        conductance = gain if control == out else -gain
        if card.kind == "E" or conductance < 0:
            raise card.refuse("its own voltage commands it", "another node's", f"'{' '.join(card.words):.40}'")
        net.between(card, out, {"kind": "resistor", "resistance": 1 / conductance})
    elif control[0] == control[1]:
        raise card.refuse("what commands it is always zero", "two nodes", f"'{' '.join(card.words):.40}'")
    elif card.kind in "EH":
        net.two_port(card, (control, out), "controlled source", signed_gain=gain, resistance=0.0)
    else:
        net.two_port(card, (control, out), "controlled source", signed_transconductance=gain)


def _no_gain(card: Card) -> InputError:
    expected = "two nodes, what commands it, and a number"
    return card.refuse("is not a gain alone", expected, f"'{' '.join(card.words[2:]):.40}'")


ELEMENTS: dict[str, Callable[[Card, Netlist], None]] = {
    **dict.fromkeys("RLC", impedance), **dict.fromkeys("VI", _source), **dict.fromkeys("EFGH", controlled),
    "D": _diode, "T": lossless_line, "O": lossy_line, "Y": txl_line, "P": coupled_line,
    "U": rc_line, "W": w_line, LUMPED: lumped_line,
}  # fmt: skip
