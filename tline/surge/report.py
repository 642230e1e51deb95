"""The worst of an operated network as text, and as plain data."""

from functools import partial
from itertools import islice
from typing import Any

from tline.solver.result.accuracy import Accuracy
from tline.solver.result.result import Result
from tline.solver.result.states import StateTrace
from tline.surge.worst import Extreme, Worst
from tline.units import to_si
from tline.words.aligned import aligned

BAR, NAMED = 1e5, 5  # Pa; nodes in a sentence
STATES, MOST_STATES = ["element", "", "before", "lowest", "at [s]", "highest", "at [s]", "at the end"], 20


def as_dict(result: Result, found: Worst) -> dict[str, Any]:
    """The worst nodes in SI, in full precision."""
    return {
        "title": result.scene.title,
        "end_time": float(result.t[-1]),
        "risen": [extreme._asdict() for extreme in found.risen],
        "fallen": [extreme._asdict() for extreme in found.fallen],
        "boiling": [extreme._asdict() for extreme in found.boiling],
        "highest": found.highest._asdict(),
        "pressure_class": found.needed,
        "no_pressure_class": found.untold or None,
        "states": [_told(trace) for trace in result.states],
        "unfinished": [extreme.node for extreme in found.unfinished],
        "notes": list(result.notes),
    }


def _told(trace: StateTrace) -> dict[str, Any]:
    """Extremes of a state in SI."""
    low, low_at, high, high_at = trace.extremes()
    found = {"element": trace.where, "quantity": trace.word, "unit": trace.unit, "before": float(trace.values[0])}
    return found | {"lowest": low, "lowest_at": low_at, "highest": high, "highest_at": high_at}


def as_text(result: Result, accuracy: Accuracy | None, found: Worst) -> str:
    """Two tables of nodes, the class of pressure, and where water boils."""
    lines = [result.scene.title or "a surge", _accuracy(accuracy)]
    lines.append(f"worst within {result.t[-1]:.4g} s, gauge pressures")
    unit = result.medium.shown["effort"]
    size = to_si(f"1 {unit}", "Pa")
    head = ["node", f"before [{unit}]", "highest", "±", "at [s]", "rise", "lowest", "±", "at [s]", f"fall [{unit}]"]
    for word, rows in (("rise", found.risen), ("fall", found.fallen)):
        table = (
            [f"largest {word}s", *aligned([head, *(_cells(row, size) for row in rows)], 1)]
            if rows
            else [f"nothing {word}s"]
        )
        lines += ["", *table]
    if result.states:
        lines += [
            "",
            "states",
            *aligned([STATES, *islice(map(partial(_state, result), result.states), MOST_STATES)], 1),
        ]
        left = len(result.states) - MOST_STATES
        lines += [f"and {left} more: --tables or --states writes them"] * (left > 0)
    top = found.highest
    bears = f" ({found.needed / size:.4g} {unit})" * (size != BAR) if found.needed else ""
    asks = f"asks for PN {found.needed / BAR:g}{bears}" if found.needed else "is above all classes up to PN 100"
    where = f"{top.highest / size:.4g} {unit} at {top.node} after {top.highest_at:.4g} s"
    named = f", {asks}" if not found.untold else f"; no pressure class is named, for {found.untold}"
    lines += ["", f"the highest pressure, {where}{named}"]
    if found.boiling:
        names = ", ".join(one.node for one in found.boiling[:NAMED])
        more = f" and {len(found.boiling) - NAMED} more" * (len(found.boiling) > NAMED)
        lines.append(f"water boils at {names}{more}: put cavities or protection there")
    if found.unfinished:
        names = " and ".join(dict.fromkeys(one.node for one in found.unfinished))
        lines.append(f"an extreme lies at the end of the run, at {names}: run longer")
    return "\n".join(lines)


def _state(result: Result, trace: StateTrace) -> list[str]:
    """A row: what an element shows, in the units of people."""
    size, unit = trace.read_in(result.medium)
    low, low_at, high, high_at = trace.extremes()
    numbers = trace.values[0] / size, low / size, low_at, high / size, high_at, trace.values[-1] / size
    return [trace.name, unit, *(f"{float(x):.4g}" for x in numbers)]


def _cells(one: Extreme, size: float) -> list[str]:
    """A row: pressures in a unit of this size, Pa, with their errors, and instants."""
    before, high, rise, low, fall = (
        f"{x / size:.4g}" for x in (one.before, one.highest, one.rise, one.lowest, one.fall)
    )
    high_error, low_error = (f"{error / size:.1g}" for error in (one.highest_error, one.lowest_error))
    return [
        one.node,
        before,
        high,
        high_error,
        f"{one.highest_at:.4g}",
        rise,
        low,
        low_error,
        f"{one.lowest_at:.4g}",
        fall,
    ]


def _accuracy(accuracy: Accuracy | None) -> str:
    if accuracy is None:
        return "error not estimated: the run is long, and fixed by hand"
    words = f"estimated error {accuracy.at_slab_ends:.1g} of the amplitude at slab ends"
    missed = " and NOT met" * (accuracy.tol is not None and accuracy.at_slab_ends > accuracy.tol)
    asked = "" if accuracy.tol is None else f", {accuracy.tol:g} asked{missed}"
    inside = f"; up to {accuracy.worst:.1g} inside the slabs of jumps" * (accuracy.worst > 10 * accuracy.at_slab_ends)
    return words + asked + inside
