"""Positional valves of EPANET 2.3 as throttle valves of EPANET 2.2, whose settings are coefficients of loss."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from tline.errors import InputError
from tline.interchange.water_network import Travel

TIGHT = 1e-6  # share of the capacity that EPANET lets no valve fall below
SHUT = "CLOSED"
SETTINGS = {"[VALVES]": (0, 5), "[STATUS]": (0, 1), "[CONTROLS]": (1, 2), "[RULES]": (2, 5)}  # words: valve, setting


class Positional(NamedTuple):
    """A valve that a percentage opens."""

    loss: float  # K wide open
    travel: Travel

    def set_to(self, word: str, where: str) -> str:
        """Setting of the throttle valve for a percentage, or what shuts it; other words as they are."""
        percent = _number(word)
        if percent is None:
            return word
        if percent < 0:
            raise InputError(where, "its opening is none", "a percentage from 0 to 100", word)
        share = float(np.interp(percent / 100, *np.transpose(self.travel)))
        return f"{self.loss / share**2:.15g}" if percent and share > TIGHT else SHUT


def as_throttles(lines: Sequence[str], path: str) -> tuple[Sequence[str], dict[str, Travel]]:
    """Lines in which positional valves are throttle valves with the same losses, and their travels by name.

    K at an opening is that wide open over the square of the share of the capacity, which is the opening or follows the
    valve's curve. A valve at 0 % is shut; EPANET 2.3 has it lose 1e8 ft at 1 ft³/s.

    References
    ----------
    EPANET 2.3 Programmer's Toolkit, input file, section [VALVES].
    """
    section, clause, changed = "", "", []
    curves: dict[str, list[list[str]]] = defaultdict(list)
    rows: list[tuple[str, list[str]]] = []
    for line in lines:
        section, words = line if line.startswith("[") else section, line.split(" ")
        rows.append((section, words))
        if section == "[CURVES]" and words[2:]:
            curves[words[0]].append(words[1:3])
    found = [words for section, words in rows if section == "[VALVES]" and words[4:] and words[4].upper()[:3] == "PCV"]
    valves = {words[0]: _positional(words, curves, f"{path}: valve '{words[0]}'") for words in found}
    for section, words in rows if valves else ():
        clause = words[0].upper() if words[0].upper() in ("IF", "THEN", "ELSE") else clause
        name, at = SETTINGS.get(section, (0, len(words)))
        valve, where = valves.get("".join(words[name : name + 1])), f"{path}: {' '.join(words)}"
        of_range = section == "[STATUS]" and len(words) > 2
        if of_range and _number(words[-1]) is not None:
            raise InputError(where, "sets a range of links, in a file with positional valves", "one link a line")
        if valve and section == "[RULES]" and clause == "IF":
            if words[3:] and words[3].upper().startswith("SETT"):
                raise InputError(where, "asks how far a positional valve is open", "a premise without that")
        elif valve and section in SETTINGS and not of_range:
            words[at : at + 1] = [valve.set_to((words[at:] or ["0"])[0], where)]
        if valve and section == "[VALVES]" and len(words) > at:
            status = ["\n[STATUS]\n", words[0], SHUT, "\n[VALVES]"] if words[at] == SHUT else []
            words[4:] = ["TCV", words[at].replace(SHUT, "0"), *words[6:7], *status]
        changed.append(" ".join(words))
    return changed or lines, {name: valve.travel for name, valve in valves.items()}


def _positional(words: Sequence[str], curves: Mapping[str, list[list[str]]], where: str) -> Positional:
    loss = (_number(words[6]) if words[6:] else None) or 0.0
    if not words[7:]:
        return Positional(loss, ((0.0, 0.0), (1.0, 1.0)))
    points = [[_number(word) for word in point] for point in curves[words[7]]]
    found = [(x / 100, min(y / 100, 1.0)) for x, y in points if x is not None and y is not None]
    rises = all(x < after and y <= above for (x, y), (after, above) in pairwise(found))
    if not found or not rises or min(found[0]) < 0 or found[-1][0] > 1 or found[-1][1] < 1:
        expected = "percentages of the full capacity that rise to 100 with those of the opening"
        raise InputError(where, f"its curve '{words[7]}' is none of a valve", expected)
    first, last = ((0.0, 0.0),) * (found[0][0] > 0), ((1.0, 1.0),) * (found[-1][0] < 1)
    return Positional(loss, (*first, *found, *last))


def _number(word: str) -> float | None:
    try:
        return float(word)
    except ValueError:
        return None
