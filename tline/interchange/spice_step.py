"""The sweep that the .step cards of a SPICE netlist stand for, where each varies one value of the scene."""

import re
from collections.abc import Callable, Iterator
from math import floor, log
from shlex import quote
from typing import Any, NamedTuple

from tline.errors import InputError
from tline.interchange.deck import Card, Findings
from tline.interchange.spice_expression import PARAMETERS

STEP, MOST_VALUES = ".step", 100_000
RATIOS = {"dec": 10.0, "oct": 2.0}
BARE = re.compile(r"[\w-]+", re.ASCII)  # a key that needs no quotes
Tables = dict[str, Any]


class StepCard(NamedTuple):
    """What one .step varies, the values as `tline sweep` takes them, and two of them."""

    name: str
    values: str
    samples: tuple[str, str]


def with_first_values(cards: list[Card]) -> list[Card]:
    """The cards, and the first value of each parameter that is stepped and defined nowhere."""
    defined = {name for card in cards for name in _defined(card)}
    steps = [(card, step) for card in cards if (step := _step(card)) and "param" in map(str.lower, card.words[:2])]
    missing = {step.name: card._replace(name=".param", words=[step.name, "=", step.samples[0]]) for card, step in steps}
    return [*cards, *(card for name, card in missing.items() if name not in defined)]


def note_steps(cards: list[Card], found: Findings, file: str, tables: Callable[[list[Card]], Tables]) -> None:
    """Note the command of the sweep that all .step cards ask for together, or that there is none."""
    varied = []
    for card in cards:
        if card.name.lower() != STEP:
            continue
        step = _step(card)
        path = _path(cards, step, tables) if step else ""
        if step and path:
            varied.append((card, f"--vary {quote(f'{path}={step.values}')}"))
        else:
            found.note(card.where, "skipped: make a run for each value")
    if varied:
        command = " ".join(["tline sweep", quote(file), *(option for _, option in varied)])
        found.note(varied[0][0].where, f"skipped: {command}")


def _step(card: Card) -> StepCard | None:
    """What a card varies; nothing where it is no .step, or its values are in no order that a sweep has."""
    words = [word for word in card.words if word.lower() not in ("lin", "param")] if card.name.lower() == STEP else []
    ratio = RATIOS.get(words[0].lower()) if words else None
    name, *given = words[1:] if ratio else words or [""]
    try:
        if given[:1] and given[0].lower() == "list":
            values = [repr(card.value(word)) for word in given[1:]]
            return StepCard(name.lower(), ", ".join(values), (values[0], values[-1])) if len(values) > 1 else None
        first, last, by = map(card.value, given)
        steps = (log(last / first, ratio) if ratio else (last - first)) * (by if ratio else 1 / by) + 1e-9
    except (InputError, ValueError, ArithmeticError):
        return None
    if not 1 <= steps < MOST_VALUES:  # nor if it is no number
        return None
    count = floor(steps)
    end = first * ratio ** (count / by) if ratio else first + count * by
    return StepCard(name.lower(), f"{first!r}:{end!r}:{count + 1}{':log' * bool(ratio)}", (repr(first), repr(end)))


def _path(cards: list[Card], step: StepCard, tables: Callable[[list[Card]], Tables]) -> str:
    """Where the scene has the value, nowhere else and as it is; empty if there is no such place."""
    try:
        first, second = (tables([_with(card, step.name, value) for card in cards]) for value in step.samples)
    except InputError:
        return ""
    found = list(_differences(first, second, ()))
    wanted = tuple(map(float, step.samples))
    if len(found) != 1 or found[0][1:] != wanted:
        return ""
    return ".".join(key if BARE.fullmatch(key) else f'"{key}"' for key in found[0][0])


def _with(card: Card, name: str, value: str) -> Card:
    """The card with a value in place of what it gives the parameter, or the element of that name."""
    if name in _defined(card):
        words = list(card.words)
        words[[word.lower() for word in words].index(name) + 2] = value
        return card._replace(words=words)
    if card.name.lower() == name and card.kind in "RLCVI" and len(card.words) == 3:
        return card._replace(words=[*card.words[:2], value])
    return card


def _defined(card: Card) -> list[str]:
    """The parameters that a card gives values."""
    return [word.lower() for word in card.words[::3]] if card.name.lower() in PARAMETERS else []


def _differences(first: Any, second: Any, path: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], Any, Any]]:
    """Paths in tables of tables at which two differ, and what they have there."""
    if isinstance(first, dict) and isinstance(second, dict) and first.keys() == second.keys():
        for key in first:
            yield from _differences(first[key], second[key], (*path, key))
    elif first != second:
        yield path, first, second
