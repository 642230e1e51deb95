"""Lines by their histories: all that was sent from an end, after as many zeros as the longest delay takes."""

from typing import NamedTuple

import numpy as np

from tline.compiled.structure import Floats2, Integers, pack
from tline.compiled.unit import unit
from tline.study.baseline.kernel.nodes import NodeScattering, NodeState, at_rest, scatter
from tline.study.baseline.kernel.signals import BaselineSignals


class Histories(NamedTuple):
    """Lines and nodes."""

    net: NodeScattering
    now: NodeState
    signals: BaselineSignals
    late: Integers  # (lines,) whole steps of the delay
    taps: Floats2  # (lines, 4) weights of the samples 1 step late, on time, 1 and 2 steps early
    history: Floats2  # (ends, zeros + steps + 1)


def advance_moc(net, late, taps, drive, seen, steps, record):
    """Advance a network at rest by so many steps."""
    history = np.zeros((2 * len(late), steps + 1 + late.max() + 2))
    advance_histories(
        pack(Histories(net, at_rest(net), BaselineSignals(drive, seen, record), late, taps, history)), steps
    )


@unit
def advance_histories(run: Histories, steps: int) -> int:
    """Take what arrives from the histories, scatter it, and note what is sent."""
    history, late, taps, now = run.history, run.late, run.taps, run.now
    ends, pad = history.shape[0], history.shape[1] - steps - 1
    for k in range(steps + 1):
        for e in range(ends):
            at = k + pad - late[e // 2]
            arriving = 0.0
            for j in range(4):
                if taps[e // 2, j] != 0.0:
                    arriving += taps[e // 2, j] * history[e ^ 1, at + 1 - j]
            now.arriving[e] = arriving
        scatter(run.net, now, run.signals, k)
        for e in range(ends):
            history[e, k + pad] = now.sent[e]
    return 0
