"""The sweep that a .step of a SPICE netlist stands for, where it varies the value of one element."""

from collections.abc import Iterable
from math import floor
from shlex import quote

from tline.errors import InputError
from tline.interchange.deck import Card
from tline.interchange.elements import KINDS
from tline.interchange.netlist import Netlist
from tline.interchange.subcircuits import PARAMETERS

MOST_VALUES = 100_000


def note_step(step: Card, cards: Iterable[Card], net: Netlist, path: str) -> None:
    """Note the command of the sweep that a .step asks for, or that there is none."""
    words = [word for word in step.words if word.lower() != "lin"]
    try:
        values = _values(step, words[2:]) if words[:1] and words[0].lower() == "param" else ""
    except InputError:
        values = ""
    varied = _varied(words[1].lower(), step, cards, net) if values else ""
    advice = (
        f"tline sweep {quote(path)} --vary {quote(f'{varied}={values}')}" if varied else "make a run for each value"
    )
    net.found.note(step.where, f"skipped: {advice}")


def _values(step: Card, words: list[str]) -> str:
    """The values as `tline sweep` takes them; none where they are not a list or evenly spaced."""
    if words[:1] and words[0].lower() == "list":
        return ", ".join(repr(step.value(word)) for word in words[1:])
    if len(words) != 3:
        return ""
    first, last, by = map(step.value, words)
    steps = (last - first) / by + 1e-9 if by else 0.0
    if not 1 <= steps < MOST_VALUES:  # nor if it is no number
        return ""
    return f"{first!r}:{first + floor(steps) * by!r}:{floor(steps) + 1}"


def _varied(name: str, step: Card, cards: Iterable[Card], net: Netlist) -> str:
    """Where the scene has the parameter: as the whole value of one R, L or C, and nowhere else."""
    using = [card for card in cards if name in card.text.lower() and card.where != step.where]
    using = [card for card in using if not _defines(card, name)]
    if len(using) != 1 or using[0].kind not in KINDS or [w.strip("{}'").lower() for w in using[0].words[2:]] != [name]:
        return ""
    card, (kind, key) = using[0], KINDS[using[0].kind]
    sections = [s for s in ("loads", "links") if net.tables.get(s, {}).get(card.name, {}).get("kind") == kind]
    return f"{sections[0]}.{card.name}.{key}" if sections and "." not in card.name else ""


def _defines(card: Card, name: str) -> bool:
    """Whether a card gives the parameter its value, and does nothing else."""
    alone = card.words.count("=") == 1 and card.words[0].lower() == name
    return alone and card.name.lower() in PARAMETERS
