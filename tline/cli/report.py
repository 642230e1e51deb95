"""Text and numbers that `tline run` prints of a result."""

from collections.abc import Iterator, Mapping
from dataclasses import asdict
from math import isfinite
from typing import Any

from numpy.typing import NDArray

from tline.cli.fit import as_dict
from tline.solver.description.description import describe
from tline.solver.description.resolution import cell_in, grid_choice
from tline.solver.ledger.ledger import COLUMNS, TOLERANCE, Entry, Ledger
from tline.solver.result.accuracy import Accuracy, Estimate
from tline.solver.result.quantities import Bounds, in_tables
from tline.solver.result.result import ProbeResult, Result
from tline.solver.simulate import judged
from tline.units import handy
from tline.words.wording import aligned, place

MOST_JUDGED = 1e8  # line-end samples; a run with fixed order and slab below this is repeated to estimate its error


def judgement(result: Result) -> Accuracy | None:
    """Estimate the accuracy of a result; None if that would take too long."""
    if result.accuracy is None and result.samples <= MOST_JUDGED:
        return judged(result)
    return result.accuracy


def summary(result: Result, accuracy: Accuracy | None, times: NDArray | None = None) -> dict[str, Any]:
    """Resolution, and smallest, largest and last value of every probe and its estimated error, in SI.

    With instants, s, also the values at the probes then.
    """
    told = result.to_dict()
    estimates, blurred = (accuracy.estimates, accuracy.blurred) if accuracy else ({}, {})
    for name, estimate in estimates.items():
        probe = result.probes[name]
        shown = [each for each in in_tables(result.scene) if each.seen_by(probe)]
        seen = {each: told["probes"][name][each.named(result.scene)] for each in shown}
        sizes = {each.key: max(abs(ends["minimum"]), abs(ends["maximum"])) for each, ends in seen.items()}
        for each, ends in seen.items():
            ends["error"] = each.error(_bounds(probe, estimate, sizes))
            ends["error_inside_slabs"] = each.error(_bounds(probe, blurred[name], sizes))
    return told | {
        "grid": grid_choice(describe((result.parts or result).scene), result.resolution),
        "lumped": dict(result.resolution.sections),
        "losses": _losses(result),
        "measured": {
            name: {"file": x.file} | as_dict(x.model)
            for (part, name), x in result.scene.measured.items()
            if part == "loads"
        },
        "measured_links": {
            name: {"file": x.file, "delays": list(map(float, x.delays or ()))} | as_dict(x.model)
            for (part, name), x in result.scene.measured.items()
            if part == "links"
        },
        "line_end_samples": result.samples,
        "seconds": result.seconds,
        "accuracy": accuracy and _told(accuracy),
        **({} if times is None else {"samples": _samples(result, times)}),
        "ledger": result.ledger and ledger_as_dict(result.ledger),
    }


def _bounds(probe: ProbeResult, told: Estimate, sizes: Mapping[str, float]) -> Bounds:
    """Errors of effort and flow at a probe, from estimates relative to gauge pressure, or effort, and flow."""
    gauge, flow = sizes.get("gauge_pressure", sizes.get("u", 0.0)), sizes.get("y", 0.0)
    weight = abs(probe.height.weight)
    return Bounds(told.u * gauge, told.y * flow, probe.record.z0, probe.height.per_metre, gauge + weight, flow)


def _samples(result: Result, times: NDArray) -> dict[str, Any]:
    """Values at the probes at these instants, in SI."""
    found: dict[str, Any] = {}
    for name, probe in result.probes.items():
        seen = probe.at(times)
        shown = [each for each in in_tables(result.scene) if each.seen_by(probe)]
        found[name] = {each.named(result.scene): each.of(seen).tolist() for each in shown}
    return {"time": times.tolist(), "probes": found}


def _measured_in_words(result: Result) -> list[str]:
    """Describe each element from a Touchstone or IBIS file in a line of text."""
    measured = result.scene.measured
    drivers = [f"{place(*at)}: {x.summary}" for at, x in result.scene.composed.items() if at not in measured]
    return drivers + [f"{place(*at)}: {x.file}, {x.model.summary}" for at, x in measured.items()]


def _losses(result: Result) -> dict[str, Any]:
    """Losses by line, or by stretch between cavities: number of diamonds or cells, and terms of the circuits."""
    told: dict[str, Any] = {}
    description = describe((result.parts or result).scene)
    lines = description.lines
    if result.resolution.convolved:
        return {name: {"convolved": True, "terms": 0, "error": 0.0} for name, line in lines.items() if line.losses}
    cell = cell_in(description, result.resolution)
    kind, width = ("cells", cell) if cell else ("diamonds", result.resolution.h)
    for name, line in lines.items():
        if line.losses is not None:
            parts = {kind: max(round(line.delay / width), 1)} if line.dispersive else {}
            circuits = result.circuits.get(name)
            terms = len(circuits.series.rates) + len(circuits.shunt.rates) if circuits else 0
            told[name] = parts | {"terms": terms, "error": circuits.error if circuits else 0.0}
    return told


def _losses_in_words(losses: dict[str, Any]) -> list[str]:
    """Summarise the losses in one line of text; of many lines only the extremes."""
    if not losses:
        return []
    parts = ["convolved with what they answer in s"] * any("convolved" in each for each in losses.values()) + [
        f"up to {most} {kind}"
        for kind in ("diamonds", "cells")
        if (most := max(each.get(kind, 0) for each in losses.values()))
    ]
    terms, error = (max(each[key] for each in losses.values()) for key in ("terms", "error"))
    exact = f"circuits of up to {terms} terms, {error:.1g} from their laws" if error else "laws as they are"
    lines = f"{len(losses)} {'line' if len(losses) == 1 else 'lines'}"
    return [f"losses: {lines}, {', '.join(parts)}; {exact}"]


def _grid_in_words(grid: dict[str, Any]) -> str:
    """Explain the choice of the slabs, and predict the cost of the run."""
    cost = grid["cost"]
    return grid["reason"] if cost is None else f"{grid['reason']}, predicted cost {cost:,.0f} samples without fronts"


def _told(accuracy: Accuracy) -> dict[str, Any]:
    return {
        "tol": accuracy.tol,
        "met": None if accuracy.tol is None else accuracy.met,
        "limit": accuracy.limit,
        "estimate": accuracy.worst,
        "estimate_at_slab_ends": accuracy.at_slab_ends,
        "inside_slabs": {name: estimate.worst for name, estimate in accuracy.inside.items()},
        "runs": [asdict(attempt) for attempt in accuracy.attempts],
    }


def as_table(result: Result, accuracy: Accuracy | None) -> str:
    """Format the summary of a result in handy units."""
    told = summary(result, accuracy)
    slab, slab_unit = handy(told["slab"], "s")
    second, time_unit = handy(told["end_time"], "s")
    head = [
        f"order {told['order']}, {told['slabs']} slabs of {told['slab'] / slab:.4g} {slab_unit}, "
        f"{told['line_end_samples']:,} line-end samples in {told['seconds']:.2g} s; {_grid_in_words(told['grid'])}",
        _in_words(accuracy),
        *_losses_in_words(told["losses"]),
        *_measured_in_words(result),
        "",
    ]
    at = f"at [{time_unit}]"
    rows = [["probe", "quantity", "minimum", at, "maximum", at, "at the end", "± error"]]
    for name, probe in told["probes"].items():
        shown = {each.named(result.scene): each.shown(result.scene) for each in in_tables(result.scene)}
        for k, (word, seen) in enumerate(probe.items()):
            size, unit = handy(max(abs(seen["minimum"]), abs(seen["maximum"])), shown[word])
            numbers = [
                seen["minimum"] / size,
                seen["minimum_time"] / second,
                seen["maximum"] / size,
                seen["maximum_time"] / second,
                seen["end"] / size,
            ]
            texts = [f"{number:.4g}" for number in numbers]
            texts.append(f"{seen['error_inside_slabs'] / size:.1g}" if "error" in seen else "?")
            rows.append(["" if k else name, f"{word} [{unit}]", *texts])
    for trace in result.states[:SHOWN]:
        size, unit = result.medium.unit(trace.unit)
        _, low, low_at, high, high_at, last = trace.row(size)
        numbers = low, low_at / second, high, high_at / second, last
        word = f"{trace.word} [{unit}]" if unit else trace.word
        rows.append([trace.where.partition(".")[2], word, *(f"{number:.4g}" for number in numbers), "?"])
    measured = ["", *aligned([["measure", "value"], *_measured(result)], 1)] if result.measures else []
    return "\n".join([*([result.scene.title] if result.scene.title else []), *head, *aligned(rows, 2), *measured])


def _measured(result: Result) -> Iterator[list[str]]:
    """Measures in handy units, one a row."""
    shown = {each.si(result.scene): each.shown(result.scene) for each in in_tables(result.scene)}
    for name, (value, unit) in result.measures.items():
        size, word = handy(abs(value), shown.get(unit, unit)) if isfinite(value) and value else (1.0, unit)
        yield [name, f"{value / size:.6g} {word}" if isfinite(value) else "does not happen"]


def _in_words(accuracy: Accuracy | None) -> str:
    """Describe the tolerance asked, the error reached and the effort spent."""
    if accuracy is None:
        return "error not estimated: the run is long, and fixed by hand"
    worst = max(accuracy.inside, key=lambda name: accuracy.inside[name].worst, default=None)
    reached = f"estimated error {accuracy.worst:.1g} of the amplitude at '{worst}'" if worst else "no estimate"
    reached += f" ({accuracy.at_slab_ends:.1g} at slab ends)" if accuracy.worst > 10 * accuracy.at_slab_ends else ""
    if accuracy.tol is None:
        coarse, fine, *_ = accuracy.attempts
        return f"{reached}, from a run {'on slabs half as wide' if fine.slab < coarse.slab else 'of the next order'}"
    runs, seconds = len(accuracy.attempts), sum(attempt.seconds for attempt in accuracy.attempts)
    asked = f"{accuracy.tol:.3g} asked and met" if accuracy.met else f"{accuracy.tol:.3g} NOT met: {accuracy.limit}"
    return f"{reached}, {asked}; {runs} runs in {seconds:.2g} s"


SHOWN = 30  # accounts shown; of more, those with the largest numbers
QUIET = 1e-9  # relative to the turnover; accounts below it are left out


def ledger_as_dict(ledger: Ledger) -> dict[str, Any]:
    """All accounts, J, and the residual."""
    return {
        "turnover": ledger.turnover,
        "residual": ledger.residual,
        "total": _numbers(ledger.total),
        "accounts": {entry.where: _numbers(entry) for entry in ledger.entries},
    }


def _numbers(entry: Entry) -> dict[str, float]:
    return {column: number for column, number in entry._asdict().items() if column != "where"}


def ledger_as_table(ledger: Ledger) -> str:
    """Format the accounts in handy units."""
    size, unit = handy(ledger.turnover, "J")
    worth = sorted(ledger.entries, key=_largest, reverse=True)[:SHOWN]
    kept = {entry.where for entry in worth if _largest(entry) > QUIET * ledger.turnover}
    shown = [entry for entry in ledger.entries if entry.where in kept]
    rows = [[f"energy [{unit}]", *COLUMNS]]
    for entry in (*shown, ledger.total):
        numbers = [getattr(entry, column) for column in COLUMNS]
        rows.append([entry.where, *(f"{x / size:.4g}" if abs(x) > QUIET * ledger.turnover else "0" for x in numbers)])
    closes = "closes" if ledger.residual <= TOLERANCE else "does NOT close"
    last = f"the ledger {closes}: {ledger.residual:.1g} of the energy turned over is not accounted for"
    missing = len(ledger.entries) - len(shown)
    left_out = (
        [f"{missing} accounts with less are not shown"]
        if any(_largest(entry) > QUIET * ledger.turnover for entry in ledger.entries if entry.where not in kept)
        else []
    )
    return "\n".join([*aligned(rows, 1), *left_out, last])


def _largest(entry: Entry) -> float:
    return max(abs(getattr(entry, column)) for column in COLUMNS)
