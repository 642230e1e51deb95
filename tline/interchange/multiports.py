"""Multiports of SPICE netlists: coupled inductors, and sources that a voltage or a current commands."""

from math import sqrt

from tline.errors import InputError
from tline.interchange.deck import Card
from tline.interchange.netlist import AMMETER, REFERENCE, Netlist
from tline.scene.multiport import TIGHTEST


def coupled_inductors(card: Card, net: Netlist) -> None:
    """Two inductors as one element; without leakage, or nearly so, a transformer beside what magnetises it.

    Raises
    ------
    InputError
        Its inductors are not there, coupled by another K already, or have a begin; or its coupling is not -1 to 1.
    """
    plain, assigned = card.assigned(0)
    words = [*plain, *assigned.get("k", [])]
    if len(words) != 3 or assigned.keys() - {"k"}:
        raise card.refuse("couples other than two inductors", "K1 L1 L2 0.9", f"'{' '.join(card.words):.40}'")
    coupling = card.value(words[2])
    windings = []
    for name in words[:2]:
        winding = net.windings.pop(name.lower(), None)
        if winding is None:
            raise card.refuse("no such inductor, or another K couples it", "two L of their own", f"'{name:.40}'")
        windings.append(winding)
    if abs(coupling) > 1:
        raise card.refuse("a coupling that no windings have", "from -1 to 1", f"{coupling:g}")
    (one, first), (two, second) = ((value, ends) for value, ends in windings)
    if abs(coupling) <= TIGHTEST:
        table = {"inductance": [one, two], "signed_coupling": coupling}
        net.two_port(card, (first, second), "coupled inductors", **table)
        return
    magnetising, leakage = one * coupling**2, one * (1 - coupling**2)
    if leakage:
        inner = f"{card.name}.leakage"
        net.between(card, (first[0], inner), {"kind": "inductor", "inductance": leakage}, inner)
        first = inner, first[1]
    net.between(card, first, {"kind": "inductor", "inductance": magnetising}, f"{card.name}.magnetising")
    net.two_port(card, (first, second), "transformer", signed_ratio=coupling * sqrt(one / two))


def controlled(card: Card, net: Netlist) -> None:
    """A source that a voltage (E, G) or the current of a source (F, H) commands; G by its own voltage is a resistor.

    Raises
    ------
    InputError
        Its law is not a number, its gain is zero, or it commands itself.
    """
    if "=" in card.words:
        raise _no_gain(card)
    out = (net.node(card.words[0]), net.node(card.words[1]))
    named = 4 if card.kind in "EG" else 3
    gain = _gain(card, card.words[named:])
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


def _gain(card: Card, words: list[str]) -> float:
    """A number, or a polynomial of the first degree without an offset."""
    if words[:1] == ["POLY"] and len(words) > 2:
        offset, gain, *more = map(card.value, words[1:])
        if not offset and not any(more):
            return gain
    if len(words) != 1:
        raise _no_gain(card)
    return card.value(words[0])


def _no_gain(card: Card) -> InputError:
    expected = "two nodes, what commands it, and a number"
    return card.refuse("is not a gain alone", expected, f"'{' '.join(card.words[2:]):.40}'")
