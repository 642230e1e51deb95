"""Notes on pressures beyond limits, and on rises above Joukowsky's pressure and line packing.

Limits are the vapour pressure of a liquid and the rating of the scene.
"""

from collections.abc import Iterator, Mapping
from math import inf

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.description import Description
from tline.solver.description.excitation import just_before, varies
from tline.solver.result.envelope import Envelope
from tline.solver.result.result import ProbeResult
from tline.units import engineering
from tline.words.wording import place

VACUUM = -101_325.0  # Pa, gauge
LISTED = 3  # elements in a sentence
MARGIN = 1.01
TRICKLE = 1e-6  # relative to the efforts; a smaller rise is ignored


def beyond_limits(description: Description, extremes: Mapping[str, tuple[float, float]]) -> list[str]:
    """Notes where pressures fall below vacuum, or efforts exceed the scene's rating.

    Extremes are the lowest and highest effort by place; a gauge pressure, Pa; else V.

    Examples
    --------
    >>> from tline.scene.scene import Scene
    >>> from tline.solver.description.description import describe
    >>> scene = Scene(
    ...     medium="hydraulic", t_end=1, probes={"valve": {"at": "b"}}, rating="16 bar",
    ...     lines={"pipe": {"nodes": ["a", "b"], "z0": 1e8, "delay": 1}},
    ... )
    >>> for note in beyond_limits(describe(scene), {"probes.valve": (-2e5, 2e6)}):
    ...     print(note)
    probes.valve: the pressure falls to -2 bar; a liquid cavitates below -1.013 bar gauge (0 absolute): not modelled
    probes.valve: the pressure rises to 20 bar, above the rating of 16 bar
    """
    medium = description.medium
    unit, found = medium.shown["effort"], []
    deep = {where: low for where, (low, _) in extremes.items() if low < VACUUM}
    if medium.hydraulic and deep:
        modelled = (
            "modelled at cavities only, and a jump within a slab shoots past it"
            if description.collapses
            else "not modelled"
        )
        limit = f"a liquid cavitates below {engineering(VACUUM, unit)} gauge (0 absolute): {modelled}"
        falls = f"the pressure falls to {engineering(min(deep.values()), unit)}"
        found.append(f"{first_of(worst_first(deep, -1))}: {falls}; {limit}")
    rating = float(description.scene.rating or inf)
    sizes = {where: high if medium.hydraulic else max(high, -low) for where, (low, high) in extremes.items()}
    high = {where: size for where, size in sizes.items() if size > rating}
    if high:
        rises = f"the {medium.effort} rises to {engineering(max(high.values()), unit)}"
        above = f"above the rating of {engineering(rating, unit)}"
        found.append(f"{first_of(worst_first(high, 1))}: {rises}, {above}")
    return found


def worst_first(sizes: Mapping[str, float], sign: int) -> list[str]:
    """Places by falling size (sign 1) or rising (sign -1); ties within rounding keep their order."""
    return sorted(sizes, key=lambda where: -sign * float(f"{sizes[where]:.9g}"))


def first_of(places: list[str]) -> str:
    """Name the first place, and the number of others."""
    return places[0] + f" and {len(places) - 1} more" * (len(places) > 1)


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
    if joukowsky <= TRICKLE * abs(highest) or not beyond:
        return []
    worst, *_ = places = worst_first(beyond, 1)
    moved = [where for where, shape in description.waveforms.items() if varies(shape)] + [*description.switched]
    causes = moved[:LISTED] + ["more"] * (len(moved) > LISTED)
    causes += ["cavities that collapse"] * description.collapses
    by = " and ".join(causes) or "what runs down or shuts by itself"
    rise, most, packed = (
        engineering(x, description.medium.shown["effort"]) for x in (beyond[worst], joukowsky, packing[worst])
    )
    return [
        f"{first_of(places)}: the pressure rises by {rise}, above Joukowsky's {most} and the line packing of {packed} "
        f"that the flow in one pipe explains; waves of {by} add up"
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
