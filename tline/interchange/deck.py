"""A SPICE netlist as cards: lines joined, comments cut, subcircuits opened, every card with its line number."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from typing import NamedTuple

from tline.errors import InputError
from tline.interchange.spice_number import Parameters, parse_value
from tline.scene.text_file import read_text

LONGEST = 400  # characters of what is said of a card
MOST_CARDS, DEEPEST = 100_000, 20  # after all subcircuits are opened
COMMENT = re.compile(r";.*|//.*|(?:^|\s)\$.*")
WORD = re.compile(r"\{[^{}]*\}|'[^']*'|=|[^\s(),={}']+")
GROUND = {"0", "gnd"}


class Card(NamedTuple):
    """One element or command, with the values that names have where it stands."""

    where: str  # file, line and name, for messages
    kind: str  # first letter of the element's own name; '.' of a command
    name: str  # of the element, behind those of the subcircuits it is in; or the command
    words: list[str]  # what follows
    text: str  # the whole card
    parameters: Parameters

    def value(self, word: str) -> float:
        """A number, a parameter or an expression in braces."""
        return parse_value(word, self.parameters, self.where)

    def refuse(self, problem: str, expected: str = "", got: str = "") -> InputError:
        """The error to raise, pointing here, whatever long words the card has."""
        return InputError(self.where, *(f"{text:.{LONGEST}}" for text in (problem, expected, got)))


@dataclass
class Subcircuit:
    """A definition: the names of its nodes, default values of its parameters, and its cards."""

    nodes: list[str]
    defaults: list[str]
    cards: list[Card] = field(default_factory=list)


class Deck(NamedTuple):
    """A netlist read: its title and all elements and commands, subcircuits opened."""

    title: str
    cards: list[Card]


def read_deck(path: str | Path) -> Deck:
    """Read a netlist; its first line is the title, whatever it says.

    Raises
    ------
    InputError
        The file cannot be read, a subcircuit is unknown, never ends or contains itself, a parameter has no value, or
        there are too many cards.
    """
    title, *lines = read_text(Path(path)).splitlines() or [""]
    plain, subcircuits = _sorted(_joined(lines, str(path)))
    return Deck(title.strip().lstrip("*").strip(), list(_opened(plain, subcircuits, {}, count(1))))


def _joined(lines: list[str], path: str) -> Iterator[Card]:
    """Cards up to .end, with continuation lines in their places."""
    cards: list[tuple[int, str]] = []
    for number, line in enumerate(lines, 2):
        text = COMMENT.sub("", line).strip()
        if not text or text.startswith("*"):
            continue
        if cards and cards[-1][1].lower() == ".end":
            raise InputError(f"{path}, line {number}", "stands behind .end", "nothing", f"'{text:.40}'")
        if text.startswith("+"):
            if not cards:
                raise InputError(f"{path}, line {number}", "continues nothing", "an element in front of it")
            cards[-1] = cards[-1][0], f"{cards[-1][1]} {text[1:]}"
        else:
            cards.append((number, text))
    if len(cards) > MOST_CARDS:
        raise InputError(path, "too many cards", f"at most {MOST_CARDS}", f"{len(cards)}")
    for number, text in cards:
        name, *words = WORD.findall(text) or [text]
        if name.lower() != ".end":
            kind = name[0].upper()
            words = _nodes_first(words) if kind == "W" else words
            yield Card(f"{path}, line {number}, {name:.40}", kind, name, words, text, {})


def _nodes_first(words: list[str]) -> list[str]:
    """A card with what is assigned in front of its nodes put behind them."""
    k = 0
    while words[k + 1 : k + 2] == ["="]:
        k += 3
    return [*words[k:], *words[:k]]


def nodes_of(words: list[str]) -> int:
    """How many words stand in front of what is assigned."""
    return max(words.index("=") - 1, 0) if "=" in words else len(words)


def _sorted(cards: Iterator[Card]) -> tuple[list[Card], dict[str, Subcircuit]]:
    """Cards outside subcircuits, and the subcircuits by name."""
    plain, subcircuits, inside, begun = [], {}, None, None
    for card in cards:
        match card.name.lower():
            case ".subckt":
                if inside is not None:
                    raise card.refuse("a subcircuit inside another", ".ends before it")
                if not card.words:
                    raise card.refuse("has no name", ".subckt NAME NODE …")
                nodes, defaults = _assignments(card.words[1:])
                if card.words[0].lower() in subcircuits:
                    raise card.refuse("defined twice", "another name", card.words[0])
                inside, begun = Subcircuit([node.lower() for node in nodes], defaults), card
                subcircuits[card.words[0].lower()] = inside
            case ".ends":
                if inside is None:
                    raise card.refuse("ends no subcircuit", ".subckt before it")
                inside = None
            case _:
                (plain if inside is None else inside.cards).append(card)
    if inside is not None and begun is not None:
        raise begun.refuse("never ends", ".ends behind its elements")
    return plain, subcircuits


def _assignments(words: list[str]) -> tuple[list[str], list[str]]:
    """Words in front of the first name = value, and these, without 'params:'."""
    words = [word for word in words if word.lower() != "params:"]
    return words[: nodes_of(words)], words[nodes_of(words) :]


def _set(card: Card, words: list[str], scope: Parameters, seen: Parameters) -> dict[str, float]:
    """The scope with what is assigned, each value as seen from `seen`."""
    found = dict(scope)
    if len(words) % 3 or any(word != "=" for word in words[1::3]):
        raise card.refuse("not a list of parameters", "name = value", " ".join(words)[:60])
    for name, value in zip(words[::3], words[2::3], strict=True):
        found[name.lower()] = parse_value(value, found if seen is scope else seen, card.where)
    return found


def _opened(
    cards: list[Card], subcircuits: Mapping[str, Subcircuit], scope: Parameters, counter: Iterator[int], depth: int = 0
) -> Iterator[Card]:
    """The cards with their parameters, those of subcircuits in the places where they are used."""
    for card in cards:
        if card.name.lower() == ".param":
            scope = _set(card, card.words, scope, scope)
    for card in cards:
        if next(counter) > MOST_CARDS:
            raise card.refuse("with its subcircuits opened, the netlist is too long", f"at most {MOST_CARDS} cards")
        if card.kind == "X":
            yield from _inside(card, subcircuits, scope, counter, depth)
        elif card.name.lower() != ".param":
            yield card._replace(parameters=scope)


def _inside(
    card: Card, subcircuits: Mapping[str, Subcircuit], scope: Parameters, counter: Iterator[int], depth: int
) -> Iterator[Card]:
    """The cards of one subcircuit, its nodes and elements renamed."""
    words, assigned = _assignments(card.words)
    if not words or words[-1].lower() not in subcircuits:
        raise card.refuse("no such subcircuit", ", ".join(subcircuits) or ".subckt", words[-1] if words else "")
    used = subcircuits[words[-1].lower()]
    if len(used.nodes) != len(words) - 1:
        raise card.refuse("has another number of nodes", f"{len(used.nodes)}", f"{len(words) - 1}")
    if depth == DEEPEST:
        raise card.refuse("subcircuits in subcircuits", f"at most {DEEPEST} deep: does one contain itself?")
    for name in assigned[::3]:
        if name.lower() not in map(str.lower, used.defaults[::3]):
            raise card.refuse("no such parameter", ", ".join(used.defaults[::3]) or "none", name)
    names = dict(zip(used.nodes, words[:-1], strict=True))
    own = _set(card, assigned, _set(card, used.defaults, scope, scope), scope)
    for inner in _opened(used.cards, subcircuits, own, counter, depth + 1):
        if inner.kind == "." and inner.name.lower() != ".model":
            raise inner.refuse("a command inside a subcircuit", "elements, .model and .param")
        own = _names_inside(inner, names, card.name)
        name = inner.name if inner.kind == "." else f"{card.name}.{inner.name}"
        where = f"{inner.where} of {card.name}"
        yield inner._replace(name=name, words=own + inner.words[len(own) :], where=where)


def _names_inside(inner: Card, names: Mapping[str, str], inside: str) -> list[str]:
    """The first words of a card in a subcircuit, as they are called outside: nodes, coupled inductors, or a model."""
    if inner.kind in ".K":
        return [f"{inside}.{name}" for name in inner.words[: 1 if inner.kind == "." else 2]]
    count = nodes_of(inner.words) if inner.kind == "W" else 4 if inner.kind in "TOEG" else 2
    return [_outside(node, names, inside) for node in inner.words[:count]]


def _outside(node: str, names: Mapping[str, str], inside: str) -> str:
    return node if node.lower() in GROUND else names.get(node.lower(), f"{inside}.{node}")
