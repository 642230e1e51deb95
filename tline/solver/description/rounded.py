"""A scene with delays a little longer or shorter, so that slabs divide them all."""

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.loss.line import LossyLine
from tline.solver.description.description import Description
from tline.solver.description.lines import Line

FEWEST = 16  # slabs in the shortest delay
ROUGH, CLOSER = 1e-3, 0.25  # of the shortest delay, that the first change by at most; and of that, the next ones


class Rounded(NamedTuple):
    """A scene so changed."""

    description: Description
    off: NDArray  # (lines,) by how much delays are longer, s


def rounded_delays(description: Description, most: float) -> Iterator[Rounded]:
    """The scene with delays that are whole slabs, ever closer to its own, each with as few slabs as that takes.

    Parameters
    ----------
    description : Description
    most : float
        Slabs in the shortest delay.
    """
    delays = np.array([line.delay for line in description.lines.values()])
    shortest = float(delays.min())
    enough = ROUGH * shortest
    for n in range(FEWEST, int(most) + 1):
        slabs = np.round(n * delays / shortest)
        h = float(slabs @ delays / (slabs @ slabs))
        off = slabs * h - delays
        if (largest := float(np.abs(off).max())) <= enough:
            enough = CLOSER * largest
            lines = description.lines.items()
            changed = {name: _whole(line, k * h) for (name, line), k in zip(lines, slabs.tolist(), strict=True)}
            yield Rounded(replace(description, lines=changed, grids={}, slab=h), off)


def _whole(line: Line, delay: float) -> Line:
    """The line with the length that has this delay."""
    losses = line.losses
    if losses is not None:
        exact = losses.exact
        losses = replace(losses, exact=LossyLine(exact.series, exact.shunt, exact.length * delay / line.delay))
    return line._replace(delay=delay, losses=losses)
