"""Why a run has its slabs, and what stepping them is predicted to cost."""

from typing import NamedTuple

from tline.solver.description.description import Description
from tline.solver.description.resolution import Resolution
from tline.solver.description.slab import breaks_of, relative_work, whole_slabs


class GridChoice(NamedTuple):
    """Reason for a slab width, and the predicted cost of one run in samples without fronts inside slabs."""

    reason: str
    cost: float | None  # not predicted beside losses, nor of a convolution


def grid_choice(description: Description, chosen: Resolution) -> GridChoice:
    """Classify the slabs of a run by what they divide, and predict its cost as the search for the cheapest does."""
    h, breaks = chosen.h, breaks_of(description)
    delays = [line.delay for name, line in description.lines.items() if name not in chosen.sections]
    work = relative_work(h, delays, breaks)
    if description.scene.solver.slab == h:
        reason = "slab given"
    elif not whole_slabs(h, delays):
        reason = "part of the shortest delay"
    elif work > 1.0:
        reason = "common tick of delays"
    else:
        reason = "common tick of delays and fronts" if len(breaks) else "common tick of delays"
    if chosen.convolved or description.dispersive:
        return GridChoice(reason, None)
    return GridChoice(reason, 2 * len(delays) * chosen.s * description.t_end / h * work)
