"""Instants at which laws of elements kinked in a run, for the next run to cut its slabs there.

Friction is such a law, |y|·y where the flow turns. Inside a line this kink is smoothed, at its ends it is not.

A law is smooth between some points of its graph. With e the effort across the element and i the flow, the wave e + ρ i
into it rises along the graph, and passes each point once. A piece without a kink inside is as accurate as its order; so
the instant is sought on the piece before or behind, continued into the one that has it.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.polynomial.legendre import legval
from numpy.typing import NDArray

from tline.solver.description.description import Description
from tline.solver.description.elements import PlacedLaw
from tline.solver.description.given import Bend
from tline.solver.description.resolution import Resolution
from tline.solver.radau import Basis, basis
from tline.solver.result.result import Result, Wave
from tline.solver.run import NO_KINKS, Kinks, at_node

MOST_KINKS = 2000  # instants of an element; beyond, none is followed
MOST_HALVED = 50_000  # middles of pieces of an element; beyond, none is followed
STEPS, STEP = 8, 1e-4  # of Newton's method; and the step for its slopes, in pieces
SETTLED = 1e-13  # pieces; a step this short is the last, for each is some 1e4 times shorter than the one before
OVER = 1.5  # pieces by which a neighbour is extrapolated
ROUNDED = 1e-12  # of the largest wave; smaller values have no sign
STILL = 1e-9  # of the largest wave; a smaller flow does not turn


class PiecewiseQuantity(NamedTuple):
    """A quantity in pieces, in order of time."""

    start: NDArray  # (pieces,) s
    width: NDArray  # (pieces,) s
    values: NDArray  # (pieces, s) at the Radau points
    before: float


class Cuts:
    """Instants at which slabs of the next finer run are cut in pieces, at elements with laws.

    `kinked` are elements whose laws kink, `places` those whose waves runs are to record; if `governed`, openings move
    by themselves.
    """

    def __init__(self, description: Description):
        self.elements, self.kinked, self._middles = description.elements, kinking(description), NO_KINKS
        held = {node for element in self.kinked for node in element.nodes}  # kinks there are known
        self._ends = [
            (name, node)
            for name, line in description.lines.items()
            if line.losses is not None and line.losses.flow_law is not None
            for node in enumerate(line.nodes)
            if node[1] not in held
        ]
        self.governed = any(element.governor is not None for element in self.elements)
        self.places = [element.where for element in self.elements]

    def halved(self, last: Result) -> "Halved":
        """Instants at which pieces of the last run are halved if its slabs are."""
        return halved(last, self.elements, self._middles)

    def ahead(self, last: Result, parts: "Halved", chosen: Resolution, turns: bool) -> Kinks:
        """Instants at which slabs of the next run are cut: where laws kinked in the last one, and at halves of pieces.

        With `turns` also where flow turned at ends of recorded lines with friction.
        """
        if chosen.h < last.resolution.h:
            self._middles = parts.steep if chosen.s > last.resolution.s else parts.every
        kinks = together(kinks_of(last, self.kinked), self._middles)
        return {**kinks, **turns_of(last, self._ends)} if turns else kinks


def kinking(description: Description) -> list[PlacedLaw]:
    """Elements whose laws kink."""
    return [element for element in description.elements if [*element.kind.bends(element.constants, 1.0)]]


def kinks_of(result: Result, elements: Sequence[PlacedLaw]) -> Kinks:
    """Instants at which laws kinked in a run that recorded the waves into these elements, s."""
    found = {}
    for element in elements:
        record = result.elements[element.where]
        into = _in_pieces(record.wave)
        bends = element.kind.bends(element.constants, record.impedance)
        instants = [_crossings(_less(into, at, element, result), result) for at in bends]
        all_ = np.unique(np.concatenate([np.empty(0), *instants]))
        if 0 < len(all_) <= MOST_KINKS:
            found[element.where] = all_
    return found


def turns_of(result: Result, ends: Sequence[tuple[str, tuple[int, str]]]) -> Kinks:
    """Instants at which the flow turned at some ends of lines, each given by its line, number and node, s; by node."""
    found = {}
    for line, (end, node) in ends:
        if line not in result.lines:
            continue
        record = result.lines[line]
        a, b = (_in_pieces(wave) for wave in ((record.a2, record.b2) if end else (record.a1, record.b1)))
        flow = a.values - b.values
        flow[np.abs(flow) <= STILL * np.abs(a.values).max()] = 0.0
        instants = _crossings(a._replace(values=flow, before=a.before - b.before), result)
        if len(instants):
            found[at_node(node)] = np.union1d(found.get(at_node(node), np.empty(0)), instants)
    return found


class Halved(NamedTuple):
    """Known instants, and the middles of pieces that the middle of their slab does not part, s.

    `every` has all of these, `steep` those in which a wave changes by more than half its largest change in any other:
    the rest are as well resolved as slabs half as wide. But a run that keeps them shows their errors by its order
    alone.
    """

    every: Kinks
    steep: Kinks

    @property
    def differ(self) -> bool:
        """Whether pieces may stay as they are."""
        return any(len(self.steep.get(where, ())) < len(all_) for where, all_ in self.every.items())


def halved(result: Result, elements: Sequence[PlacedLaw], known: Kinks) -> Halved:
    """Instants at which pieces at elements are halved with their slabs, which would not make them narrower."""
    every, steep = {}, {}
    for element in elements:
        wave = result.elements[element.where].wave
        begin, end = wave.pieces.span.T
        aside = (end <= 0.5) | (begin >= 0.5)
        whole = np.delete(wave.values, wave.pieces.slab, axis=0)
        change, others = (np.ptp(values, axis=1) for values in (wave.pieces.values, whole))
        largest = max(others.max(initial=0.0), change[~aside].max(initial=0.0))
        middles = (wave.pieces.slab + (begin + end) / 2) * wave.h
        for found, these in ((every, aside), (steep, aside & (change > largest / 2))):
            all_ = np.union1d(known.get(element.where, np.empty(0)), middles[these])
            if 0 < len(all_) <= MOST_HALVED:
                found[element.where] = all_
    return Halved(every, steep)


def together(one: Kinks, other: Kinks) -> Kinks:
    """Instants of both."""
    return {where: np.union1d(one.get(where, np.empty(0)), other.get(where, np.empty(0))) for where in {*one, *other}}


def _less(into: PiecewiseQuantity, bend: Bend, element: PlacedLaw, result: Result) -> PiecewiseQuantity:
    """Subtract from the wave into an element its value at a bend."""
    control = 1.0
    if bend.varying and element.law.factor is not None:
        t = into.start[:, None] + into.width[:, None] * basis(result.resolution.s).c
        control = element.law.factor.value(t, (into.start + into.width / 2)[:, None])
    values = into.values - bend.constant - bend.varying * np.maximum(control, 0.0) ** bend.power
    return into._replace(values=values, before=float(values[0, 0]))


def _in_pieces(wave: Wave) -> PiecewiseQuantity:
    """A wave's pieces, slabs without fronts among them."""
    pieces, n = wave.pieces, len(wave.values)
    whole = np.ones(n, bool)
    whole[pieces.slab] = False
    slabs = np.flatnonzero(whole)
    start = np.concatenate([slabs, pieces.slab + pieces.span[:, 0]])
    width = np.concatenate([np.ones(len(slabs)), np.diff(pieces.span, axis=1)[:, 0]])
    order = np.argsort(start, kind="stable")
    values = np.concatenate([wave.values[whole], pieces.values])[order]
    return PiecewiseQuantity(start[order] * wave.h, width[order] * wave.h, values, wave.before)


def _crossings(seen: PiecewiseQuantity, result: Result) -> NDArray:
    """Instants at which a quantity passes zero, s."""
    order = basis(result.resolution.s)
    heights = np.column_stack([np.append(seen.before, seen.values[:-1, -1]), seen.values])
    told = np.abs(heights) > ROUNDED * np.abs(heights).max()  # the others keep the sign before them
    told[0, 0] = True
    last = np.maximum.accumulate(np.where(told, np.arange(heights.size).reshape(heights.shape), 0).ravel())
    below = (heights.ravel() < 0)[last].reshape(heights.shape)
    piece, k = np.nonzero(below[:, :-1] != below[:, 1:])
    if not 0 < len(piece) <= MOST_KINKS:
        return np.empty(0)
    places = np.append(0.0, order.c)
    low, high = places[k], places[k + 1]
    own = np.clip(_root(seen, order, piece, (low + high) / 2), low, high)
    found = own.copy()
    near = own > 0.5
    for side, preferred in ((1, near), (-1, ~near)):
        neighbour = np.clip(piece + side, 0, len(seen.start) - 1)
        ratio = seen.width[piece] / seen.width[neighbour]
        offset = (seen.start[piece] - seen.start[neighbour]) / seen.width[neighbour]
        x = (_root(seen, order, neighbour, offset + own * ratio) - offset) / ratio
        reach = OVER * seen.width[neighbour] / seen.width[piece]
        fits = (x > -0.02) & (x < 1.02) & (np.where(side > 0, 1 - x, x) < reach) & (neighbour != piece)
        found = np.where(preferred & fits, x, found)
    t = seen.start[piece] + np.clip(found, 0.0, 1.0) * seen.width[piece]
    return t[(t > 0) & (t < result.t[-1])]


def _root(seen: PiecewiseQuantity, order: Basis, piece: NDArray, x: NDArray) -> NDArray:
    """Newton's root of the polynomials of pieces, continued; from places x, in their own widths."""
    series = order.to_legendre @ seen.values[piece].T
    low, high = -OVER - 1, OVER + 2
    for _ in range(STEPS):
        here, ahead = legval(2 * np.stack([x, x + STEP]) - 1, series[:, None], tensor=False)
        slope = (ahead - here) / STEP
        before, x = x, np.clip(x - here / np.where(slope == 0, np.inf, slope), low, high)
        if np.abs(x - before).max() <= SETTLED:
            break
    return x
