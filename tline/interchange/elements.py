"""Elements of a SPICE netlist between two nodes: R, L, C, diodes, and sources that nothing commands."""

from collections.abc import Callable, Iterable
from contextlib import suppress

from tline.errors import InputError
from tline.interchange.deck import Card
from tline.interchange.diode import diode
from tline.interchange.findings import Findings
from tline.interchange.line_cards import coupled_line, lossless_line, lossy_line, rc_line, txl_line, w_line
from tline.interchange.multiports import controlled, coupled_inductors
from tline.interchange.netlist import REFERENCE, Netlist, Table
from tline.interchange.spice_source import said_of, waveforms

KINDS = {"R": ("resistor", "resistance"), "L": ("inductor", "inductance"), "C": ("capacitor", "capacitance")}
NEUTRAL = {  # of R, L and C, with the values that change nothing; None where all are so
    "tc": 0.0, "tc1": 0.0, "tc2": 0.0, "m": 1.0, "scale": 1.0, "rser": 0.0, "lser": 0.0, "dtemp": 0.0, "cpar": 0.0,
    "vc1": 0.0, "vc2": 0.0, "noisy": None, "tol": None, "pwr": None, "ac": None, "v": None, "irms": None, "mfg": None,
}  # fmt: skip
STAND_IN = "in its place a source behind a resistance, or a table of voltages and currents, kind = 'table'"
REFUSED = {
    **dict.fromkeys("QMJZ", ("a transistor, and there are none here", STAND_IN)),
    **dict.fromkeys("BA", ("a behavioural source", "E, F, G or H with a number, or sources over time")),
    "N": ("a compiled model", "what it stands for, of elements that are known here"),
    "S": ("a switch that a voltage commands", "kind = 'switch' in a scene, which changes at an instant"),
}
KNOWN = "R, L, C, K, D, V, I, E, F, G, H, T, O, W, U, Y, P and X"


def take(card: Card, net: Netlist) -> None:
    """Let an element be part of the scene.

    Raises
    ------
    InputError
        It is not known, not whole or out of range.
    """
    if card.kind in REFUSED:
        raise card.refuse(*REFUSED[card.kind])
    if card.kind not in ELEMENTS:
        raise card.refuse("not known here", KNOWN)
    if len(card.words) < (5 if card.kind in "TOEGYP" else 4 if card.kind in "UFH" else 3):
        raise card.refuse("is not whole", "its nodes and a value")
    ELEMENTS[card.kind](card, net)


def merge_shorts(cards: Iterable[Card], net: Netlist) -> None:
    """Let nodes be one between which sources of no voltage or resistors of 0 ohm stand, but for what is sensed."""
    for card in cards:
        if len(card.words) < 3 or card.kind not in "VR" or card.name.lower() in net.sensed:
            continue
        with suppress(InputError):  # which is told when the element is taken
            if _value(card) == 0 if card.kind == "R" else said_of(card, Findings()).is_zero:
                net.merge(*card.words[:2])


def _value(card: Card) -> float:
    """The number of R, L or C."""
    plain, assigned = card.assigned(2)
    own = {"R": ("r", "res"), "L": ("l", "ind"), "C": ("c", "cap")}[card.kind]
    words = [word for word in plain if word.lower() not in ("tc", "off")]
    words += [word for key in own for word in assigned.pop(key, [])]
    tc = assigned.get("tc", [])
    if "TC" in map(str.upper, plain):
        raise card.refuse("TC without '='", "TC=0")
    if len(words) != 1:
        raise card.refuse("its value is not given once", "two nodes and a number", f"'{' '.join(plain):.40}'")
    for key, given in assigned.items():
        if key == "ic" and card.kind != "R":
            continue
        neutral = NEUTRAL.get(key, ...)
        if neutral is ... or (neutral is not None and any(card.value(word) != neutral for word in given)):
            problem = f"{key.upper()} other than {neutral:g}" if isinstance(neutral, float) else f"{key:.40}"
            raise card.refuse(
                f"{problem} is not known here", "two nodes and a number", f"'{' '.join(given or tc):.40}'"
            )
    return card.value(words[0])


def _impedance(card: Card, net: Netlist) -> None:
    kind, key = KINDS[card.kind]
    first, second, value = net.node(card.words[0]), net.node(card.words[1]), _value(card)
    if card.kind == "R" and value == 0:
        net.short(card, (first, second))
        return
    if first == second:
        net.found.note(card.where, "skipped, for both its ends are at one node")
        return
    if value <= 0:
        raise card.refuse("its value is not above zero", "more than 0", f"{value:g}")
    begin = _at_begin(card, net, (first, second))
    if card.kind == "L" and card.name.lower() in net.coupled:
        if begin:
            raise card.refuse("a current at t = 0 in a coupled inductor", "IC=0", f"{begin:g}")
        net.windings[card.name.lower()] = value, (first, second)
        return
    if begin and card.kind == "C":
        inner = f"{card.name}.ic"
        net.source(card, (first, inner), {"kind": "voltage", "value": begin}, inner)
        first = inner
    elif begin:
        net.source(card, (second, first), {"kind": "current", "value": begin}, f"{card.name}.ic")
    net.between(card, (first, second), {"kind": kind, key: value})


def _at_begin(card: Card, net: Netlist, ends: tuple[str, str]) -> float:
    """Voltage of C or current of L at t = 0."""
    given = card.assigned(2)[1].get("ic") if card.kind in "LC" else None
    if given is None:
        return net.at_begin(ends) if card.kind == "C" and net.tran.uic else 0.0
    if not net.tran.uic:
        net.found.note(card.where, "its IC is skipped, for .tran has no UIC")
        return 0.0
    if len(given) != 1:
        raise card.refuse("IC is not one number", "IC=1")
    return card.value(given[0])


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
    if card.kind == "V" and said.is_zero and not sensed:
        net.short(card, (first, second))
        return
    if first == second:
        raise card.refuse("both ends are at one node", "two nodes")
    sign, kind = (1.0, "voltage") if card.kind == "V" else (-1.0, "current")
    if card.kind == "V" and sensed:
        if said.is_zero:
            net.ammeter(card, first, second)
            return
        net.ammeter(card, f"{card.name}.m", second)
        second = f"{card.name}.m"
    if first == REFERENCE:
        first, second, sign = second, first, -sign
    parts = waveforms(card, said, net.tran, sign)
    own: Table = {"resistance": said.resistance} if said.resistance else {}
    for k, part in enumerate(parts):  # voltages add up in a row, currents side by side
        last, name = k == len(parts) - 1, card.name + " (fall)" * k
        low = second if kind == "current" or last else f"{card.name}.s"
        net.source(card, (first, low), {"kind": kind, "value": part} | (own if last else {}), name)
        first = first if kind == "current" else low


ELEMENTS: dict[str, Callable[[Card, Netlist], None]] = {
    **dict.fromkeys("RLC", _impedance), **dict.fromkeys("VI", _source), **dict.fromkeys("EFGH", controlled),
    "K": coupled_inductors, "D": _diode, "T": lossless_line, "O": lossy_line, "Y": txl_line, "P": coupled_line,
    "U": rc_line, "W": w_line,
}  # fmt: skip
