"""What sources give at all steps, and what is recorded."""

from typing import NamedTuple

from tline.compiled.structure import Floats2, Integers
from tline.compiled.unit import function


class BaselineSignals(NamedTuple):
    """Arrays over the steps of a loop."""

    drive: Floats2  # (nodes, steps + 1) what sources give
    seen: Integers  # (rows,) nodes whose efforts are recorded
    record: Floats2  # (rows, steps + 1)


@function
def put(signals, u, step):
    """Record efforts of nodes."""
    for row in range(signals.seen.size):
        signals.record[row, step] = u[signals.seen[row]]
