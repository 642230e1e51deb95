"""What a SPICE netlist asks for: the end time by .tran, nodes by .print and the like."""

import re
from collections.abc import Iterator

from tline.errors import InputError
from tline.interchange.deck import Card
from tline.interchange.spice_source import Transient

SHOWN = (".print", ".plot", ".save", ".probe")
VOLTAGE = re.compile(r"v\(\s*([^\s,()]+)\s*\)", re.IGNORECASE)


def transient(cards: list[Card], path: str) -> Transient:
    """What the one .tran of a netlist says."""
    if len(cards) != 1:
        where = cards[1].where if cards else path
        raise InputError(where, "the end time is not given once", "one .tran STEP END", f"{len(cards)}")
    (card,) = cards
    words = [word for word in card.words if word.lower() != "uic"]
    if not 2 <= len(words) <= 4:
        raise card.refuse("not a time step and an end", ".tran STEP END [0 [LONGEST STEP]] [UIC]")
    step, end, *more = map(card.value, words)
    if step <= 0 or end <= 0:
        raise card.refuse("a time that is not above zero", "more than 0")
    if more and more[0]:
        raise card.refuse("results that begin later", "0 for the third time", f"{more[0]:g}")
    return Transient(step, end, len(words) < len(card.words))


def nodes_shown(card: Card) -> Iterator[tuple[Card, str]]:
    """The nodes that a card asks for, each with the card."""
    rest = VOLTAGE.sub(" ", card.text).split()[1:]
    if any(word.lower() not in ("tran", "all") for word in rest):
        expected = "v(NODE)"
        raise card.refuse("asks for something else than voltages of nodes", expected, f"'{' '.join(rest):.40}'")
    return ((card, name) for name in VOLTAGE.findall(card.text))
