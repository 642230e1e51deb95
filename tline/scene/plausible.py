"""Plausibility of a valid scene: sentences on probable mistakes, for the notes of a run."""

from collections import defaultdict
from collections.abc import Iterator
from math import isfinite
from typing import Any

from tline.scene.coupled import Coupled
from tline.scene.element import Element
from tline.scene.heights import taken_as_zero
from tline.scene.load import Switch
from tline.scene.quantity import Quantity
from tline.scene.scene import Scene
from tline.words.wording import first_of, place

EVERYDAY = {"ohm", "V", "A", ""}  # units that a bare number commonly has
LISTED = 3


def plausibility_notes(scene: Scene) -> list[str]:
    """Notes on probable oversights in a scene."""
    return [*_of_lines(scene), *taken_as_zero(scene), *_idle(scene), *_bare(scene)]


def _of_lines(scene: Scene) -> Iterator[str]:
    """Notes on implausible quantities of lines, one for all lines with the same remark."""
    lines = defaultdict(list)
    for name, line in scene.single_lines.items():
        for remark in line.parameters.remarks:
            lines[remark].append(place("lines", name))
    for name, line in scene.lines.items():
        if isinstance(line, Coupled) and line.faster_than_light:
            lines["L and C are too small: a mode is faster than light"].append(place("lines", name))
    for name, line in scene.single_lines.items():
        residual = getattr(line, "attenuation_residual", 0.0)
        if residual:
            lines[f"its attenuation is within {100 * residual:.2g} % of the data sheet's"].append(place("lines", name))
        fitted = getattr(line, "fitted_resistance", None)
        if fitted is not None:
            guess = f"its resistance to steady current, {fitted:.3g} ohm/m, is a guess from its attenuation"
            lines[f"{guess}; `resistance` sets that of the data sheet"].append(place("lines", name))
    for name, line in scene.single_lines.items():
        if line.nodes[0] == line.nodes[1]:
            lines["both ends are at one node"].append(place("lines", name))
    return (f"{_first(names)}: {remark}" for remark, names in lines.items())


def _idle(scene: Scene) -> list[str]:
    """Notes on valves and switches that do not move within the run, and waveforms that begin after it."""
    moves = {place(*at): element.time for at, element in scene.placed if isinstance(element, Switch)}
    begins = {place(part, name): getattr(shape, "at", 0.0) for (part, name, _), shape in scene.waveforms.items()}
    late = [f"{where} ({t:.6g} s)" for where, t in (moves | begins).items() if t >= scene.t_end]
    early = [f"{where} ({t:.6g} s)" for where, t in moves.items() if t < 0]
    return [
        *([f"{_first(late)}: nothing changes there before the run ends at {scene.t_end:.6g} s"] if late else []),
        *([f"{_first(early)}: moved before the run begins"] if early else []),
    ]


def _bare(scene: Scene) -> list[str]:
    """Note on texts with a number but no unit, where a unit is usual."""
    found = [f"{place(*where)} = {quantity.typed!r} ({quantity.unit})" for where, quantity in _without_unit(scene)]
    return [f"taken as SI for want of a unit: {_first(found)}"] if found else []


def _without_unit(part: Any) -> list[tuple[tuple[str | int, ...], Quantity]]:
    """Quantities typed without a unit, with the keys that lead to them; others are skipped, as networks have many."""
    if isinstance(part, Quantity):
        bare = isinstance(part.typed, str) and _is_number(part.typed) and part.unit not in {None, *EVERYDAY}
        return [((), part)] if bare else []
    if isinstance(part, Element):
        inside = [(key, vars(part)[key]) for key in type(part).model_fields]
    elif isinstance(part, dict):
        inside = part.items()
    elif isinstance(part, list | tuple):
        inside = enumerate(part)
    else:
        return []
    return [
        ((key if isinstance(key, int) else key.rstrip("_"), *where), quantity)
        for key, value in inside
        if value is not None
        for where, quantity in _without_unit(value)
    ]


def _is_number(text: str) -> bool:
    try:
        return isfinite(float(text))
    except ValueError:
        return False


def _first(texts: list[str]) -> str:
    return first_of(texts, LISTED)
