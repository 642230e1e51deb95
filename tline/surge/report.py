"""The worst of an operated network as text, and as plain data."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from tline.scene.rating import BAR
from tline.solver.result.accuracy import Accuracy
from tline.solver.result.result import Result
from tline.solver.result.states import StateTrace
from tline.surge.band import Band
from tline.surge.columns import Columns
from tline.surge.worst import Extreme, Worst, class_of, extremes, worst
from tline.units import to_si
from tline.words.wording import aligned, first_of

NAMED, DECIMALS = 5, 6  # nodes in a sentence; of a spread
STATES, MOST_STATES = ["element", "", "before", "lowest", "at [s]", "highest", "at [s]", "at the end"], 20


def as_dict(result: Result, found: Worst, columns: Columns | None = None) -> dict[str, Any]:
    """The worst nodes in SI, in full precision, and results for columns that separated."""
    told = columns and {
        "places": list(columns.places),
        "spread": columns.spread,
        "cavities": [one._asdict() for one in columns.cavities],
    }
    return {
        "title": result.scene.title,
        "end_time": float(result.t[-1]),
        "risen": [extreme._asdict() for extreme in found.risen],
        "fallen": [extreme._asdict() for extreme in found.fallen],
        "boiling": [extreme._asdict() for extreme in found.boiling],
        "highest": found.highest._asdict(),
        "pressure_class": found.needed,
        "columns": told,
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


def as_text(result: Result, accuracy: Accuracy | None, found: Worst, columns: Columns | None = None) -> str:
    """Two tables of nodes, the class of pressure, and where water boils."""
    lines = [
        result.scene.title or "a surge",
        *([_accuracy(result, accuracy)] if columns is None else _separate(result, columns)),
    ]
    lines.append(f"worst within {result.t[-1]:.4g} s, gauge pressures")
    size, unit = result.medium.unit("effort")
    head = ["node", f"before [{unit}]", "highest", "±", "at [s]", "rise", "lowest", "±", "at [s]", f"fall [{unit}]"]
    for word, rows in (("rise", found.risen), ("fall", found.fallen)):
        table = (
            [f"largest {word}s", *aligned([head, *(_cells(row, size) for row in rows)], 1)]
            if rows
            else [f"nothing {word}s"]
        )
        lines += ["", *table]
    moving = [trace for trace in result.states if np.ptp(trace.values)]
    if moving:
        rows = [STATES, *(_state(result, trace) for trace in moving[:MOST_STATES])]
        lines += ["", "states", *aligned(rows, 1)]
        left = len(moving) - MOST_STATES
        lines += [f"and {left} more: --tables or --states writes them"] * (left > 0)
    top = found.highest
    bears = f" ({found.needed / size:.4g} {unit})" * (size != BAR) if found.needed else ""
    least = class_of(top.highest - found.spread)
    at_least = f"{least / BAR:g} to " if least and least != found.needed else ""
    asks = (
        f"asks for PN {at_least}{found.needed / BAR:g}{bears}" if found.needed else "is above all classes up to PN 100"
    )
    by = f" ± {round(columns.spread / size, DECIMALS):.2g} by places" if columns and len(columns.places) > 1 else ""
    where = f"{top.highest / size:.4g} {unit}{by} at {top.node} after {top.highest_at:.4g} s"
    named = f", {asks}" if not found.untold else f"; no pressure class is named, for {found.untold}"
    lines += ["", f"the highest pressure, {where}{named}"]
    if found.boiling:
        names = first_of([one.node for one in found.boiling], NAMED)
        lines.append(f"water boils at {names}: put cavities or protection there")
    if found.unfinished:
        names = " and ".join(dict.fromkeys(one.node for one in found.unfinished))
        lines.append(f"an extreme lies at the end of the run, at {names}: run longer")
    return "\n".join(lines)


def _separate(result: Result, columns: Columns) -> list[str]:
    """Places of separated columns, method, and the largest cavities."""
    cubic = result.medium.shown.get("m^3", "L")
    size = to_si(f"1 {cubic}", "m^3")
    many = " and ".join(map(str, columns.places))
    lines = [f"columns separate: computed with {many} cavities, by a method of first order"]
    lines += ["± is by their number and the slabs"] * (len(columns.places) > 1)
    for one in columns.cavities:
        gone = f"gone after {one.collapse:.4g} s" if one.collapse is not None else "there to the end"
        lines.append(f"cavity of up to {one.volume / size:.3g} {cubic} at {one.where} after {one.at:.4g} s, {gone}")
    return lines


def band_text(result: Result, band: Band) -> Iterator[str]:
    """Effect of guesses on the highest and the lowest pressure, the governing guess, and the classes between."""
    size, unit = result.medium.unit("effort")
    told = worst(result)
    yield ""
    if band.left:
        yield f"not varied, for want of time: {', '.join(band.left)}"
    if not band.varied:
        return
    for key, at in (("highest", told.highest.highest), ("lowest", min(one.lowest for one in extremes(result)))):
        below, above, governs = band.of(key)
        if not below and not above:
            continue
        span = f"{(at - below) / size:.4g} to {(at + above) / size:.4g} {unit}"
        yield f"as guesses vary, the {key} pressure is {span}, most by {governs.guess}"
    below, above, _ = band.of("highest")
    ends = [class_of(told.highest.highest + by) for by in (-below, above)]
    words = dict.fromkeys(f"PN {end / BAR:g}" if end else "above PN 100" for end in ends)
    if not told.untold:
        yield f"so it asks for {' to '.join(words)}"


def _state(result: Result, trace: StateTrace) -> list[str]:
    """Row of a state of an element, in the units of the scene."""
    size, unit = result.medium.unit(trace.unit)
    return [trace.name, unit, *(f"{x:.4g}" for x in trace.row(size))]


def _cells(one: Extreme, size: float) -> list[str]:
    """A row: pressures in a unit of this size, Pa, with their errors, and instants."""
    before, high, rise, low, fall = (
        f"{x / size:.4g}" for x in (one.before, one.highest, one.rise, one.lowest, one.fall)
    )
    high_error, low_error = (f"{error / size:.1g}" for error in (one.highest_error, one.lowest_error))
    at_high, at_low = f"{one.highest_at:.4g}", f"{one.lowest_at:.4g}"
    return [one.node, before, high, high_error, at_high, rise, low, low_error, at_low, fall]


def _accuracy(result: Result, accuracy: Accuracy | None) -> str:
    if accuracy is None:
        return "error not estimated: the run is long, and fixed by hand"
    rounded, missed = result.resolution.rounded, accuracy.tol is not None and accuracy.at_slab_ends > accuracy.tol
    what = "largest pressure, of extremes" if rounded else "amplitude at slab ends"
    words = f"estimated error {accuracy.at_slab_ends:.1g} of the {what}"
    asked = "" if accuracy.tol is None else f", {accuracy.tol:g} asked" + f" and NOT met: {accuracy.limit}" * missed
    if rounded:
        return f"{words}{asked}; delays are rounded to {result.resolution.h:.3g} s"
    inside = f"; up to {accuracy.worst:.1g} inside the slabs of jumps" * (accuracy.worst > 10 * accuracy.at_slab_ends)
    return words + asked + inside
