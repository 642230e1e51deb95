"""Notes on a run: limits, unresolved fronts, lumped lines, tanks, surges."""

from collections.abc import Mapping
from math import inf

import numpy as np

from tline.solver.assembly.fronts import Tally
from tline.solver.description.description import Description, describe
from tline.solver.description.groups import parts
from tline.solver.result.envelope import Envelope
from tline.solver.result.result import ProbeResult, Result
from tline.solver.result.states import drained, emptied
from tline.solver.result.surge import beyond_limits, surges
from tline.words.wording import place

LISTED = 4  # names in a sentence
VISIBLE = 1e-6  # relative to the largest wave
ENERGY_ROUNDING = 1e-9  # relative to the energy turned over


def remarks_of(result: Result) -> tuple[str, ...]:
    """Notes on a run, without those of its ledger and of unresolved parts."""
    description, probes, envelope = describe(result.scene), result.probes, result.envelope
    return (
        *_active(description, result),
        *untouched(probes),
        *unconnected(description),
        *lumped(result),
        *blurred(result),
        *description.plausibility_notes,
        *beyond_limits(description, _extremes(probes, envelope)),
        *tank_limits(description, _extremes(probes, envelope)),
        *(
            f"{where}: it is empty after {at:.4g} s: its {total:.4g} m^3 are gas, which would enter the pipe"
            for where, (at, total) in emptied(result).items()
        ),
        *(
            f"{where}: after {at:.4g} s its air, {air:.3g} m^3, takes a tenth of the pipes that end there: they drain, "
            "and are computed as full"
            for where, (at, air) in drained(result).items()
        ),
        *(f"{where}: liquid flows back through it at up to {v:.3g} m/s" for where, v in result.slams.items()),
        *surges(description, result.t, result.start, probes, envelope),
    )


def _active(description: Description, result: Result) -> list[str]:
    own = description.own
    if not own or result.ledger is None:
        return []
    entries = [entry for entry in result.ledger.entries if own & {entry.where, *entry.where.split(" and ")}]
    gains = [entry for entry in entries if entry.created > ENERGY_ROUNDING * result.ledger.turnover]
    return [f"{entry.where} gave {entry.created:.3g} J more than it had taken: its law is active" for entry in gains]


def _extremes(probes: Mapping[str, ProbeResult], envelope: Envelope | None) -> dict[str, tuple[float, float]]:
    """Lowest and highest effort, or gauge pressure, at each probe and node."""
    found = {}
    for name, probe in probes.items():
        found[place("probes", name)] = float(probe.gauge_pressure.min()), float(probe.gauge_pressure.max())
    if envelope is not None:
        low, high = (extreme - envelope.weight for extreme in (envelope.lowest, envelope.highest))
        pairs = zip(low.tolist(), high.tolist(), strict=True)
        found |= {f"node '{node}'": pair for node, pair in zip(envelope.nodes, pairs, strict=True)}
    return found


def tank_limits(description: Description, seen: Mapping[str, tuple[float, float]]) -> list[str]:
    """Notes on tanks that overflow or run empty, where probes or the envelope cover their nodes."""
    at = {place("probes", name): probe.at for name, probe in description.scene.probes.items()}
    found = []
    for where, tank in description.surge_tanks.items():
        here = [seen[each] for each in seen if at.get(each) == tank.at or each == f"node '{tank.at}'"]
        if not here:
            continue
        low, high = min(low for low, _ in here) / tank.weight, max(high for _, high in here) / tank.weight
        lowest, highest = tank.lowest_level, tank.highest_level
        if highest is not None and high > highest:
            found.append(f"{where}: it overflows: its level comes to {high:.4g} m, above its {highest:g} m")
        if lowest is not None and low < lowest:
            found.append(f"{where}: it runs empty: its level comes to {low:.4g} m, below its {lowest:g} m")
    return found


def smeared(fronts: Tally) -> list[str]:
    """Note on fronts that were not followed, if they are visible."""
    if fronts.lost < VISIBLE:
        return []
    by = (
        f"by up to {fronts.lost:.1g} of the largest wave"
        if np.isfinite(fronts.lost)
        else "corners of sources among them"
    )
    return [
        f"fronts: {fronts.dropped} breakpoints beyond the number that a slab may hold were smeared over their slabs, "
        f"{by}"
    ]


def untouched(probes: Mapping[str, ProbeResult]) -> list[str]:
    """Notes on probes that no wave reached."""
    return [
        f"{place('probes', name)}: no wave reached it before the end"
        for name, probe in probes.items()
        if not probe.a.any() and not probe.b.any()
    ]


def lumped(result: Result) -> list[str]:
    """Note on lumped lines, and their error behind fronts."""
    chosen, accuracy = result.resolution, result.accuracy
    if not chosen.sections:
        return []
    told, tol = (accuracy.behind_fronts, accuracy.tol or inf) if accuracy else (0.0, inf)
    count, named = len(chosen.sections), ", ".join(map(repr, [*chosen.sections][:LISTED]))
    n = max(chosen.sections.values())
    return [
        f"lines: {named}{' and more' * (count > LISTED)} {'is' if count == 1 else 'are'} far shorter than a slab and "
        f"lumped: {n} LC {'section' if n == 1 else 'sections'} each"
        + (f"; for {chosen.settle:.3g} s and more behind a front, what they do is blurred" if chosen.settle else "")
        + (f", and off by up to some {told:.0e}: no tolerance is asked there" if told > tol else "")
    ]


def blurred(result: Result) -> list[str]:
    """Note on the error of a convolution beside jumps."""
    accuracy, chosen = result.accuracy, result.resolution
    if not (chosen.convolved and chosen.settle) or accuracy is None or accuracy.tol is None:
        return []
    name, told = max(accuracy.blurred.items(), key=lambda item: item[1].worst)
    return [
        f"fronts: nearer than {chosen.settle:.3g} s to where a jump arrives the error is up to {told.worst:.1g}, at "
        f"{place('probes', name)}; no tolerance is asked there"
    ]


def unconnected(description: Description) -> list[str]:
    """Note on unconnected parts of the scene: often a node whose name is spelled in two ways."""
    scene = description.scene
    pairs = [*(line.nodes for line in scene.lines.values()), *(nodes for _, nodes in scene.between)]
    nodes = list(dict.fromkeys(node for pair in pairs for node in pair))
    number = {node: k for k, node in enumerate(nodes)}
    pairs = [(pair[0], node) for pair in pairs for node in pair[1:]]
    first, second = np.array([[number[node] for node in pair] for pair in pairs]).T
    part = parts(first, second, len(nodes))
    if not part.any():
        return []
    smallest = np.flatnonzero(part == np.argmin(np.bincount(part)))
    named = ", ".join(f"'{nodes[k]}'" for k in smallest[:LISTED]) + " and more" * (len(smallest) > LISTED)
    return [f"lines: they form {part.max() + 1} parts that are not connected; one has the nodes {named}"]
