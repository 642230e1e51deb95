"""Rises of pressure beyond what the change of the flow in one pipe explains."""

from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.description import Description
from tline.solver.description.excitation import just_before, varies
from tline.solver.result.envelope import Envelope
from tline.solver.result.limits import first_of, worst_first
from tline.solver.result.result import ProbeResult
from tline.units import engineering
from tline.words.wording import place

LISTED = 3  # elements
MARGIN = 1.01
TRICKLE = 1e-6  # of the efforts; a smaller rise is none


def surges(
    description: Description,
    t: NDArray,
    start: Mapping[str, NDArray],
    probes: Mapping[str, ProbeResult],
    envelope: Envelope | None,
) -> list[str]:
    """What rises above Joukowsky and line packing, and what was operated; one sentence, or none.

    Where the flow y of a single pipe stops, the pressure rises by z0 |y| (Joukowsky) and by what friction had taken on
    the way from the highest pressure (line packing). A source of a flow may change it by more. Higher rises come where
    waves add up: at dead ends, beyond junctions, where columns collapse. Nothing is said beside a source whose
    pressure changes, for that may rise as it likes, nor where nothing flows at first.

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
    """Effort before t = 0, and the highest, at each probe and at nodes without one, counted from the level."""
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
    """What sources of flow do to the pipes beside them, Pa."""
    for source in description.scene.sources.values():
        admittance = max(description.nodes[node].lines for node in source.terminals if node is not None)
        if not source.is_effort and admittance:
            flow = np.append(source.value.value(t, t), just_before(source.value))
            yield float(np.ptp(flow)) / admittance
