"""Sources of SPICE netlists that a voltage or a current commands."""

from tline.errors import InputError
from tline.interchange.deck import Card
from tline.interchange.netlist import AMMETER, REFERENCE, Netlist


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
