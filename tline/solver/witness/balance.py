"""Whether what a run gives out fits the equations of lines and of what stands at nodes, at instants drawn at random."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.result.result import Wave
from tline.solver.witness.nodes import Balance
from tline.solver.witness.seen import FAINT, INSTANTS, ROUNDING, Seen

MOST_ASIDE = 4  # instants that may be wrong: polynomials beside fronts at ends that no probe sees


class Doubt(NamedTuple):
    """Where and when a result does not fit, and what."""

    where: str
    t: float
    what: str


def balance_doubts(seen: Seen, nodes: list[Balance]) -> Iterator[Doubt]:
    """Nodes at which a result does not fit at more than a few instants."""
    at = slice(INSTANTS)
    for one in nodes:
        if not seen.reads(one):
            continue
        efforts, (off_u, off_y) = seen.efforts(one)[:, at], seen.allowed(one)
        where = f"node '{one.name}'"
        yield from _doubt(seen, np.ptp(efforts, axis=0) > 2 * off_u, where, "efforts of lines that meet there differ")
        if one.held is not None:
            wrong = np.abs(efforts[0] - one.held(seen.instants)) > off_u
            yield from _doubt(seen, wrong, where, "the effort is not the one that is prescribed")
        elif not one.stores:
            (low, high), out = seen.passed(one), seen.out(one)
            wrong = (out < low - off_y) | (out > high + off_y)
            yield from _doubt(seen, wrong[at], where, "what flows in does not flow out")


def line_doubts(seen: Seen) -> Iterator[Doubt]:
    """Lossless lines that do more to waves than to delay them, as they are given out and as they were computed."""
    for name, record in seen.result.lines.items():
        line = seen.description.lines.get(name)
        if line is None or line.losses is not None:
            continue
        (a1, b1), (a2, b2) = record.at_end1, record.at_end2
        for sent, arrived in ((a1, a2), (b2, b1)):
            wrong = _is_another(seen, sent, arrived, line.delay)
            if wrong.sum() > MOST_ASIDE:
                pair = (record.a1, record.a2) if sent is a1 else (record.b2, record.b1)
                wrong &= _is_another(seen, *pair, line.delay)
            yield from _doubt(seen, wrong, f"lines.{name}", "a wave does not arrive as it left")


def _is_another(seen: Seen, sent: Wave, arrived: Wave, delay: float) -> NDArray:
    """Whether a wave is not what was sent a delay ago, at the instants at random."""
    now, then = arrived(seen.instants), sent(seen.instants - delay)
    size = max(float(np.abs(now).max()), FAINT * seen.largest)
    return np.abs(now - then) > (4 * seen.tol + ROUNDING) * size


def _doubt(seen: Seen, wrong: NDArray, where: str, what: str) -> Iterator[Doubt]:
    if wrong.sum() > MOST_ASIDE:
        yield Doubt(where, float(seen.instants[wrong][0]), what)
