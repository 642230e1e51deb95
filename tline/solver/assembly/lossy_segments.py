"""Lossy lines in segments one slab long, each advanced by its exact evolution over a slab, projected on polynomials.

What a segment holds (a, b and the memories of its circuits over x) and what enters it during a slab (a at its left end,
b at its right end, over t) are polynomials of degree s - 1; so is, after projection, what it holds a slab later, and
what has left it. The equations dissipate and the projections lose energy, so a segment cannot create any. There is no
other error: a front that enters on a slab's edge leaves on one, and all between is smooth.
"""

from collections.abc import Mapping
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from tline.loss import Law
from tline.loss.foster import Foster
from tline.solver.description.circuits import Circuits
from tline.solver.description.lines import Line
from tline.solver.description.slab import WHOLE
from tline.solver.kernel.network import Segments
from tline.solver.radau import Basis, Matrix

MOST_DIFFERENT = 50  # segments, for each takes some hundredths of a second to find

Plain = tuple[float, float, tuple[float, ...], tuple[float, ...]]  # a circuit as what makes it


class Segment(NamedTuple):
    """Maps of a segment over a slab, of n fields at s points each; b leaves at the left, a at the right."""

    held: Matrix  # (n s, n s) from what it holds to what it holds a slab later
    entered: Matrix  # (n s, 2 s) from what enters (a, b) to what it holds then
    left: Matrix  # (2 s, n s) from what it holds to what leaves (a, b)
    back: Matrix  # (s, s) from what enters at an end to what leaves at the same end


def segment(series: Foster, shunt: Foster, h: float, s: int) -> Segment:
    """The segment of a line with circuits given per metre, for slabs of h seconds."""
    plain = [
        (law.loss, law.storage, tuple(law.strengths.tolist()), tuple(law.rates.tolist())) for law in (series, shunt)
    ]
    return _segment(*plain, h, s)


@lru_cache(maxsize=256)
def _segment(series: Plain, shunt: Plain, h: float, s: int) -> Segment:
    from tline.solver.assembly.evolution import evolution

    whole = evolution(Foster(*series), Foster(*shunt), h, s)
    inside = len(whole) - 2 * s
    return Segment(
        whole[:inside, :inside], whole[:inside, inside:], whole[inside:, :inside], whole[inside + s :, inside:-s]
    )


class SegmentedLine(NamedTuple):
    """A line in segments, and what of a wave sent from an end its own node feels in the same slab."""

    number: int
    segment: Segment
    memories: tuple[int, int]  # of the series and of the shunt circuit

    @property
    def echo(self) -> Matrix:
        """Q = K/(1 + K) of `advance_segments`, shape (s, s)."""
        return np.linalg.solve(np.eye(len(self.segment.back)) + self.segment.back, self.segment.back)

    def maps(self) -> Matrix:
        """All maps in the order of `Segments.maps`."""
        held, entered, left, K = self.segment
        one = np.eye(len(K))
        X, R = np.linalg.inv(one - K @ K), np.linalg.inv(one + K)
        next_, then = np.vstack([held, left @ held]), np.vstack([entered, left @ entered])
        return np.concatenate([part.T.ravel() for part in (next_, then, X, X @ K, R, R @ K)])


def fits(lines: Mapping[str, Line], h: float) -> bool:
    """Whether all lossy lines fit segments: linear ones whose delay is whole slabs, unless too many differ."""
    different: set[tuple[Law, Law]] = set()
    for line in lines.values():
        if line.losses is not None and line.dispersive:
            different.add((line.losses.exact.series, line.losses.exact.shunt))
            if len(different) > MOST_DIFFERENT or not _fits(line, h):
                return False
    return True


def _fits(line: Line, h: float) -> bool:
    slabs = line.delay / h
    return line.losses is not None and line.losses.linear and abs(slabs - round(slabs)) <= WHOLE * slabs


def segmented_lines(
    lines: Mapping[str, Line], circuits: Mapping[str, Circuits], order: Basis, h: float
) -> dict[int, SegmentedLine]:
    """Lines that are cut into segments, by their numbers; none where one does not fit."""
    found: dict[int, SegmentedLine] = {}
    for k, (name, line) in enumerate(lines.items() if fits(lines, h) else ()):
        if line.dispersive:
            series, shunt, _ = circuits[name]
            made = segment(series, shunt, h, order.s)
            found[k] = SegmentedLine(round(line.delay / h), made, (len(series.rates), len(shunt.rates)))
    return found


def segments_of(lines: Mapping[int, SegmentedLine]) -> tuple[Segments, int]:
    """All lines in segments by their numbers, and how many values they hold."""
    rows = list(lines.values())
    maps = [row.maps() for row in rows]
    values = np.cumsum([0, *(row.number * sum(row.segment.left.shape) + len(row.segment.left) for row in rows)])
    segments = Segments(
        line=np.array(list(lines), int),
        number=np.array([row.number for row in rows], int),
        held=np.array([len(row.segment.held) for row in rows], int),
        at=np.cumsum([0, *map(len, maps)])[:-1],
        maps=np.concatenate([np.empty(0), *maps]),
        state=values[:-1],
    )
    return segments, int(values[-1])
