"""Notes on a run: limits, unresolved fronts, lumped lines, tanks, rises above Joukowsky's pressure and line packing."""

from collections.abc import Iterator, Mapping
from math import inf

import numpy as np
from numpy.typing import NDArray

from tline.solver.assembly.workspace import Tally
from tline.solver.description.description import Description, describe
from tline.solver.description.excitation import just_before, varies
from tline.solver.description.given import plausibility_notes
from tline.solver.description.groups import parts
from tline.solver.result.envelope import Envelope
from tline.solver.result.result import ProbeResult, Result
from tline.solver.result.states import drained, emptied
from tline.units import engineering
from tline.words.wording import first_of, place

LISTED = 4  # names in a sentence
VISIBLE = 1e-6  # relative to the largest wave, or to the efforts
ENERGY_ROUNDING = 1e-9  # relative to the energy turned over
VACUUM = -101_325.0  # Pa, gauge
MOST_CAUSES = 3  # elements in a sentence
MARGIN = 1.01


def remarks_of(result: Result) -> tuple[str, ...]:
    """Notes on a run, without those of its ledger and of unresolved parts."""
    description, probes, envelope = describe(result.scene), result.probes, result.envelope
    return (
        *_active(description, result),
        *(
            f"{place('probes', name)}: no wave reached it before the end"
            for name, probe in probes.items()
            if not probe.a.any() and not probe.b.any()
        ),
        *unconnected(description),
        *lumped(result),
        *blurred(result),
        *plausibility_notes(result.scene),
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
    size = f"by up to {fronts.lost:.1g} of the largest wave" if fronts.lost < inf else "corners of sources among them"
    many = f"{fronts.dropped} breakpoints beyond the number that a slab may hold"
    return [f"fronts: {many} were smeared over their slabs, {size}"]


def lumped(result: Result) -> list[str]:
    """Note on lumped lines, and their error behind fronts."""
    chosen, accuracy = result.resolution, result.accuracy
    if not chosen.sections:
        return []
    told, tol = (accuracy.behind_fronts, accuracy.tol or inf) if accuracy else (0.0, inf)
    count, named = len(chosen.sections), first_of([*map(repr, chosen.sections)], LISTED)
    n = max(chosen.sections.values())
    return [
        f"lines: {named} {'is' if count == 1 else 'are'} far shorter than a slab and "
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
    named = first_of([f"'{nodes[k]}'" for k in smallest], LISTED)
    return [f"lines: they form {part.max() + 1} parts that are not connected; one has the nodes {named}"]


def beyond_limits(description: Description, extremes: Mapping[str, tuple[float, float]]) -> list[str]:
    """Notes where pressures fall below vacuum, or efforts exceed the scene's rating.

    Extremes are the lowest and highest effort by place; a gauge pressure, Pa; else V.
    """
    medium = description.medium
    unit, found = medium.shown["effort"], []
    deep = {where: low for where, (low, _) in extremes.items() if low < VACUUM}
    if medium.hydraulic and deep:
        at_cavities = "modelled at cavities only, and a jump within a slab shoots past it"
        modelled = at_cavities if description.collapses else "not modelled"
        limit = f"a liquid cavitates below {engineering(VACUUM, unit)} gauge (0 absolute): {modelled}"
        falls = f"the pressure falls to {engineering(min(deep.values()), unit)}"
        found.append(f"{first_of(worst_first(deep, -1), 1)}: {falls}; {limit}")
    rating = float(description.scene.rating or inf)
    sizes = {where: high if medium.hydraulic else max(high, -low) for where, (low, high) in extremes.items()}
    high = {where: size for where, size in sizes.items() if size > rating}
    if high:
        rises = f"the {medium.effort} rises to {engineering(max(high.values()), unit)}"
        above = f"above the rating of {engineering(rating, unit)}"
        found.append(f"{first_of(worst_first(high, 1), 1)}: {rises}, {above}")
    return found


def worst_first(sizes: Mapping[str, float], sign: int) -> list[str]:
    """Places by falling size (sign 1) or rising (sign -1); ties within rounding keep their order."""
    return sorted(sizes, key=lambda where: -sign * float(f"{sizes[where]:.9g}"))


def surges(
    description: Description,
    t: NDArray,
    start: Mapping[str, NDArray],
    probes: Mapping[str, ProbeResult],
    envelope: Envelope | None,
) -> list[str]:
    """Note on the rise above Joukowsky's pressure and line packing, and its causes; one sentence, or none.

    Where the flow y of a single pipe stops, the pressure rises by z0 |y| (Joukowsky) and by the friction loss on
    the way from the highest pressure (line packing). A source of flow may change it by more. Higher rises come where
    waves add up: at dead ends, beyond junctions, where columns collapse. There is no note beside a source whose
    pressure changes, nor where nothing flows at first.

    `start` has by line the waves (a1, b1, a2, b2) before t = 0, counted from the level.

    References
    ----------
    E. B. Wylie, V. L. Streeter, Fluid Transients in Systems, Prentice Hall, 1993.
    """
    pressures = any(source.is_effort and varies(source.value) for source in description.scene.sources.values())
    if not description.medium.hydraulic or not description.steady or not start or pressures:
        return []
    a1, b1, a2, b2 = np.stack(list(start.values()), axis=1)
    highest = float(np.maximum(a1 + b1, a2 + b2).max()) / 2
    joukowsky = max([float(np.abs(a1 - b1).max()) / 2, *_changes(description, t)])
    rises = _rises(description, probes, envelope)
    packing = {where: max(highest - before, 0.0) for where, (before, _) in rises.items()}
    beyond = {where: top - before for where, (before, top) in rises.items()}
    beyond = {where: rise for where, rise in beyond.items() if rise > MARGIN * (joukowsky + packing[where])}
    if joukowsky <= VISIBLE * abs(highest) or not beyond:
        return []
    worst, *_ = places = worst_first(beyond, 1)
    moved = [where for where, shape in description.waveforms.items() if varies(shape)] + [*description.switched]
    causes = moved[:MOST_CAUSES] + ["more"] * (len(moved) > MOST_CAUSES)
    causes += ["cavities that collapse"] * description.collapses
    by = " and ".join(causes) or "what runs down or shuts by itself"
    rise, most, packed = (
        engineering(x, description.medium.shown["effort"]) for x in (beyond[worst], joukowsky, packing[worst])
    )
    return [
        f"{first_of(places, 1)}: the pressure rises by {rise}, above Joukowsky's {most} and the line packing of "
        f"{packed} that the flow in one pipe explains; waves of {by} add up"
    ]


def _rises(
    description: Description, probes: Mapping[str, ProbeResult], envelope: Envelope | None
) -> dict[str, tuple[float, float]]:
    """Effort before t = 0 and highest effort, at each probe and at nodes without one, counted from the level."""
    found = {}
    for name, probe in probes.items():
        u = probe.u - probe.height.level
        found[place("probes", name)] = float(u[0]), float(u.max())
    if envelope is not None:
        level = np.array([description.nodes[node].height.level for node in envelope.nodes])
        pairs = zip((envelope.start - level).tolist(), (envelope.highest - level).tolist(), strict=True)
        probed = {probe.at for probe in description.scene.probes.values()}
        found |= {f"node '{node}'": x for node, x in zip(envelope.nodes, pairs, strict=True) if node not in probed}
    return found


def _changes(description: Description, t: NDArray) -> Iterator[float]:
    for source in description.scene.sources.values():
        admittance = max(description.nodes[node].lines for node in source.terminals if node is not None)
        if not source.is_effort and admittance:
            flow = np.append(source.value.value(t, t), just_before(source.value))
            yield float(np.ptp(flow)) / admittance
