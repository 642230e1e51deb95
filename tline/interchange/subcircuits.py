"""Subcircuits of SPICE netlists opened, each element with its parameters."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from itertools import count

from tline.errors import InputError
from tline.interchange.deck import DEEPEST, LUMPED, MOST_CARDS, Card, Findings, nodes_of
from tline.interchange.spice_expression import FUNCTION, PARAMETERS, Defined, Parameters, function, parse_value
from tline.interchange.spice_linear import BY_LAW, law_words, with_outside_names
from tline.interchange.spice_source import PORTNUM

GROUND = {"0", "gnd", "gnd!", "ground"}
GLOBAL = "$g_"  # begin of the names of nodes that Xyce has everywhere
PORTS = {"T": 4, "O": 4, "Y": 4, "E": 4, "G": 4, "U": 3, "S": 4, "Q": 3, "J": 3, "Z": 3, "M": 4}  # nodes; others have 2
TYPES = ("VCVS", "VCCS", "CCCS", "CCVS")  # of HSPICE, said once more


class EndlessError(InputError):
    """Subcircuits that become too many or too deep, so that no more of them are opened."""


@dataclass
class Subcircuit:
    """A definition: the names of its nodes, default values of its parameters, and its cards."""

    nodes: list[str]
    defaults: list[str]
    cards: list[Card] = field(default_factory=list)


@dataclass
class _Opening:
    """Data shared by all depths."""

    subcircuits: Mapping[str, Subcircuit]
    shared: set[str]  # nodes that have one name everywhere
    found: Findings
    counter: Iterator[int] = field(default_factory=lambda: count(1))


def opened(cards: list[Card], found: Findings) -> list[Card]:
    """All elements, models and commands with their parameters; elements of subcircuits in the places of their use."""
    plain, subcircuits = _sorted(cards, found)
    shared = GROUND | {word.lower() for card in plain if card.name.lower() == ".global" for word in card.words}
    plain = [card for card in plain if card.name.lower() != ".global"]
    opening = _Opening(subcircuits, shared, found)
    result: list[Card] = []
    with found.gathered():  # too many cards end all
        result.extend(_opened(plain, {}, opening, 0))
    return result


def _sorted(cards: list[Card], found: Findings) -> tuple[list[Card], dict[str, Subcircuit]]:
    """Cards outside subcircuits, and all subcircuits by name, wherever they are defined."""
    plain: list[Card] = []
    subcircuits: dict[str, Subcircuit] = {}
    inside: list[tuple[Card, Subcircuit]] = []
    for card in cards:
        with found.gathered():
            match card.name.lower():
                case ".subckt" | ".macro":
                    nodes, defaults = _assignments(card.words[1:])
                    begun = Subcircuit([node.lower() for node in nodes], defaults)
                    inside.append((card, begun))
                    name = card.words[0].lower() if card.words else ""
                    if not name:
                        raise card.refuse("has no name", ".subckt NAME NODE …")
                    if name in subcircuits:
                        raise card.refuse("defined twice", "another name", card.words[0])
                    subcircuits[name] = begun
                case ".ends" | ".eom":
                    if not inside:
                        raise card.refuse("ends no subcircuit", ".subckt before it")
                    inside.pop()
                case _:
                    (inside[-1][1].cards if inside else plain).append(_in_order(card))
    found.mistakes += [card.refuse("never ends", ".ends behind its elements") for card, _ in inside]
    return plain, subcircuits


def _in_order(card: Card) -> Card:
    """Put the nodes of an element first, in front of any words of its dialect."""
    words = card.words
    if card.name.upper() == LUMPED and words:
        return card._replace(kind=LUMPED, name=f"Y{words[0]}", words=words[1:])
    if card.kind == "P" and "port" in map(str.lower, words):  # of HSPICE and Xyce: a source behind a resistance
        named = (PORTNUM if word.lower() == "port" else word for word in words[2:])
        return card._replace(kind="V", words=[*words[:2], *named])
    if card.kind == "W":
        k = 0
        while words[k + 1 : k + 2] == ["="]:
            k += 3
        words = [*words[k:], *words[:k]]
    elif card.kind in "EFGH" and len(words) > 3 and words[2].upper() in TYPES:
        words = [*words[:2], *words[3:]]
    return card._replace(words=law_words(card._replace(words=words)) or words)


def _assignments(words: list[str]) -> tuple[list[str], list[str]]:
    """Words in front of the first name = value, and these, without 'params:'."""
    words = [word for word in words if word.lower() not in ("params:", "params", "optional:")]
    return words[: nodes_of(words)], words[nodes_of(words) :]


def _set(card: Card, words: list[str], scope: Parameters, seen: Parameters) -> dict[str, float | Defined]:
    """Return the scope with assigned values, each evaluated in `seen`."""
    found = dict(scope)
    if len(words) % 3 or any(word != "=" for word in words[1::3]):
        raise card.refuse("not a list of parameters", "name = value", " ".join(words)[:60])
    for name, value in zip(words[::3], words[2::3], strict=True):
        found[name.lower()] = parse_value(value, found if seen is scope else seen, card.where)
    return found


def _parameters(cards: list[Card], scope: Parameters, found: Findings) -> Parameters:
    """Return the scope with all .func and .param of these cards, in an order in which each finds its parameters."""
    waiting = [
        (card._replace(words=card.words[k : k + 3]))
        for card in cards
        if card.name.lower() in PARAMETERS
        for k in range(0, len(card.words), 3)
    ]
    functions = [card for card in cards if card.name.lower() == FUNCTION]
    for card in [*functions, *(card for card in waiting if card.words[0].endswith(")"))]:
        defined = function(card.text if card in functions else f".func {' '.join(card.words)}")
        if defined is None:
            found.mistakes.append(card.refuse("not a function", ".func NAME(X) {an expression}", f"'{card.text:.40}'"))
        else:
            scope = {**scope, f"{defined[0]}()": defined[1]}
    waiting = [card for card in waiting if not card.words[0].endswith(")")]
    while waiting:
        left: list[tuple[Card, InputError]] = []
        for card in waiting:
            try:
                scope = _set(card, card.words, scope, scope)
            except InputError as error:
                left.append((card, error))
        if len(left) == len(waiting):
            found.mistakes += [error for _, error in left]
            break
        waiting = [card for card, _ in left]
    return scope


def _opened(cards: list[Card], scope: Parameters, opening: _Opening, depth: int) -> Iterator[Card]:
    """The cards with their parameters, those of subcircuits in the places where they are used."""
    scope = _parameters(cards, scope, opening.found)
    for card in cards:
        if next(opening.counter) > MOST_CARDS:
            raise EndlessError(card.where, "its subcircuits make the netlist too long", f"at most {MOST_CARDS} cards")
        if card.kind == "X":
            if depth == DEEPEST:
                expected = f"at most {DEEPEST} deep: does one contain itself?"
                raise EndlessError(card.where, "subcircuits in subcircuits", expected)
            try:
                inner, names, own = _used(card, opening.subcircuits, scope)
            except InputError as error:
                opening.found.mistakes.append(error)
                continue
            yield from _inside(card, _opened(inner, own, opening, depth + 1), names, opening)
        elif card.name.lower() not in (*PARAMETERS, FUNCTION):
            yield card._replace(parameters=scope)


def _inside(outer: Card, cards: Iterator[Card], names: Mapping[str, str], opening: _Opening) -> Iterator[Card]:
    """Elements and models of a subcircuit as they are called outside."""
    for card in cards:
        if card.kind == "." and card.name.lower() != ".model":
            opening.found.note(card.where, "skipped, for it stands inside a subcircuit")
        else:
            yield _renamed(card, outer, names, opening)


def _used(
    card: Card, subcircuits: Mapping[str, Subcircuit], scope: Parameters
) -> tuple[list[Card], dict[str, str], Parameters]:
    """Cards of a subcircuit, outer names of its nodes, and its parameters."""
    words, assigned = _assignments(card.words)
    if not words or words[-1].lower() not in subcircuits:
        raise card.refuse("no such subcircuit", ", ".join(subcircuits) or ".subckt", words[-1] if words else "")
    used = subcircuits[words[-1].lower()]
    if len(used.nodes) != len(words) - 1:
        raise card.refuse("has another number of nodes", f"{len(used.nodes)}", f"{len(words) - 1}")
    for name in assigned[::3]:
        if name.lower() not in map(str.lower, used.defaults[::3]):
            raise card.refuse("no such parameter", ", ".join(used.defaults[::3]) or "none", name)
    given, own = _set(card, assigned, {}, scope), dict(scope)
    for name, value in zip(used.defaults[::3], used.defaults[2::3], strict=False):
        if name.lower() in given:
            own[name.lower()] = given[name.lower()]
        else:
            own = _set(card, [name, "=", value], own, own)
    return used.cards, dict(zip(used.nodes, words[:-1], strict=True)), own


def _renamed(inner: Card, outer: Card, names: Mapping[str, str], opening: _Opening) -> Card:
    """A card of a subcircuit with the names that its element, nodes and the like have outside."""
    where, words = f"{inner.where} of {outer.name}", inner.words
    if inner.kind == ".":
        own = [f"{outer.name}.{word}" for word in words[:1]]
        return inner._replace(words=own + words[1:], where=where)
    if inner.kind == "K":
        own = [f"{outer.name}.{word}" for word in words[: nodes_of(words) - ("=" not in words)]]
    elif words[2:3] == [BY_LAW]:
        node, source = partial(_outside, names, outer.name, opening.shared), f"{outer.name}.{{}}".format
        own = with_outside_names(words, node, source)
    else:
        count = {"W": nodes_of(words), "P": nodes_of(words) - 1}.get(inner.kind, PORTS.get(inner.kind, 2))
        own = [_outside(names, outer.name, opening.shared, node) for node in words[:count]]
        if inner.kind in "FH" or (inner.kind == "W" and "=" not in words):
            own[2:] = [f"{outer.name}.{word}" for word in words[2:3]]
    return inner._replace(name=f"{outer.name}.{inner.name}", words=own + words[len(own) :], where=where)


def _outside(names: Mapping[str, str], inside: str, shared: set[str], node: str) -> str:
    return node if node.lower() in shared or node[:3].lower() == GLOBAL else names.get(node.lower(), f"{inside}.{node}")
