"""The envelope of a convolution, from what its lines record."""

import numpy as np

from tline.solver.description.description import Description
from tline.solver.description.given import Height
from tline.solver.result.dense_output import extremes
from tline.solver.result.envelope import Envelope
from tline.solver.result.result import ProbeResult, Result


def envelope_of(description: Description, result: Result) -> Envelope:
    """Extremes at all nodes at which lines end, all of which are recorded; what their errors are is not known yet."""
    seen = {
        node: ProbeResult(node, name, float(side), record, result.slabs, description.heights.get(node, Height()))
        for name, record in result.lines.items()
        for side, node in enumerate(description.lines[name].nodes)
    }
    found = [extremes(probe, "u") for probe in seen.values()]
    (low, low_at), (high, high_at) = (np.array(side).T for side in zip(*found, strict=True))
    start = np.array([sum(wave.before for wave in probe.waves) / 2 for probe in seen.values()])
    weight, per_metre = (np.array([getattr(p.height, name) for p in seen.values()]) for name in ("weight", "per_metre"))
    unknown = np.full(len(seen), np.nan)
    return Envelope((*seen,), start, low, low_at, unknown, high, high_at, unknown, weight, per_metre)
