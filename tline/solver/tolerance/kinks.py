"""Instants at which laws of elements kinked in a run, for the next run to cut its slabs there.

Friction is such a law, |y|·y where the flow turns. Inside a line this kink is smoothed, at its ends it is not.

A law is smooth between some points of its graph. With e the effort across the element and i the flow, the wave e + ρ i
into it rises along the graph, and passes each point once. A piece without a kink inside is as accurate as its order; so
the instant is sought on the piece before or behind, continued into the one that has it.

Behind a front that meets a nearly shut orifice, and beside the instant at which its flow turns, the flow changes in a
time far shorter than a slab: a layer. There the last terms of polynomials are large. Such pieces are cut, ever closer
from run to run, to the end that is nearer to a kink of the law, or to both.
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
from tline.solver.radau import Basis, basis, thin_product
from tline.solver.result.result import Result, Wave
from tline.solver.run import NO_KINKS, Kinks, at_node

MOST_KINKS = 2000  # instants of an element; beyond, none is followed
STEPS, STEP = 8, 1e-4  # of Newton's method; and the step for its slopes, in pieces
SETTLED = 1e-13  # pieces; a step this short is the last, for each is some 1e4 times shorter than the one before
OVER = 1.5  # pieces by which a neighbour is extrapolated
ROUNDED = 1e-12  # of the largest wave; smaller values have no sign
STILL = 1e-9  # of the largest wave; a smaller flow does not turn
PLACES = np.array([1 / 16, 1 / 4])  # of cuts, from the end of a piece
NEARER = 2.0  # times as near to a kink: the end that is meant
ROUGHER = 100.0  # times the median of all pieces; where most are alike the order is too low for all
MOST, CROWD = 20, 9  # slabs in which a piece is cut after one run; pieces in one that is cut no more
FULL = 24  # cuts in a slab, at most: of more pieces waves would be smeared
LEAST = 1e-9  # slabs; narrower pieces are not cut
MOST_HALVED = 50_000  # pieces of an element; beyond, none is halved


class PiecewiseQuantity(NamedTuple):
    """A quantity in pieces, in order of time."""

    start: NDArray  # (pieces,) s
    width: NDArray  # (pieces,) s
    values: NDArray  # (pieces, s) at the Radau points
    before: float


class Cuts:
    """Instants at which slabs of the next finer run are cut in pieces, at elements with laws.

    `kinked` are elements whose laws kink, `layers` instants near which a response is not resolved, or at which pieces
    are halved, `places` the elements whose waves runs are to record; if `governed`, openings move by themselves.
    """

    def __init__(self, description: Description, tol: float):
        self.elements, self.kinked, self.layers, self._tol = description.elements, kinking(description), NO_KINKS, tol
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

    def in_pieces(self, last: Result) -> bool:
        """Whether slabs of a run were in pieces at elements, which do not become narrower with the slabs."""
        return any(len(last.elements[where].wave.pieces.slab) for where in self.places)

    def ahead(self, last: Result, chosen: Resolution, later: bool, stuck: bool) -> Kinks:
        """Instants at which slabs of the next run are cut: where laws kinked in the last one.

        Pieces are halved with their slabs if the order stays. With `later` also where flow turned at ends of recorded
        lines with friction. Where a higher order did not help, the search is `stuck`, layers that the run does not
        resolve are cut, and stay so.
        """
        kinks = kinks_of(last, self.kinked)
        if chosen.h < last.resolution.h and chosen.s <= last.resolution.s:
            self.layers = together(self.layers, middles_of(last, self.elements))
        if stuck:
            self.layers = together(self.layers, layers_of(last, self.elements, self._tol))
        self.layers = {where: _thinned(cuts / chosen.h) * chosen.h for where, cuts in self.layers.items()}
        turns = turns_of(last, self._ends) if later else {}
        return {**together(kinks, self.layers), **turns}


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
        instants = [_crossings(_beyond(into, at, element, result.resolution.s), result) for at in bends]
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


def layers_of(result: Result, elements: Sequence[PlacedLaw], tol: float) -> Kinks:
    """Instants at which to cut pieces whose last terms are beyond the tolerance, and far beyond those of most, s."""
    found = {}
    for element in elements:
        into, rough = _roughness(result, element)
        slab = ((into.start + into.width / 2) / result.resolution.h).astype(int)
        coarse = (
            (rough > max(tol, ROUGHER * np.median(rough)))
            & (np.bincount(slab)[slab] <= CROWD)
            & (into.width > LEAST * result.resolution.h)
        )
        order = np.flatnonzero(coarse)[np.argsort(-rough[coarse])]
        worst = order[np.sort(np.unique(slab[order], return_index=True)[1])][:MOST]
        if len(worst):
            cuts = np.concatenate(
                [
                    (into.start[these, None] + into.width[these, None] * places).ravel()
                    for places, these in zip((PLACES, 1 - PLACES), _ends(result, element, into, worst), strict=True)
                ]
            )
            found[element.where] = np.unique(cuts)
    return found


def middles_of(result: Result, elements: Sequence[PlacedLaw]) -> Kinks:
    """Middles of pieces that the middle of their slab does not part, s: these are no narrower in slabs half as wide.

    A run of the same order would have them wrong alike.
    """
    found = {}
    for element in elements:
        pieces, h = result.elements[element.where].wave.pieces, result.resolution.h
        begin, end = pieces.span.T
        aside = ((end <= 0.5) | (begin >= 0.5)) & (end - begin > LEAST)
        if 0 < aside.sum() <= MOST_HALVED:
            found[element.where] = (pieces.slab + (begin + end) / 2)[aside] * h
    return found


def _roughness(result: Result, element: PlacedLaw) -> tuple[PiecewiseQuantity, NDArray]:
    """The wave into an element, and the last terms of its pieces in effort and flow, over the largest change."""
    record, s = result.elements[element.where], result.resolution.s
    into = _in_pieces(record.wave)
    efforts = [(sign, _in_pieces(wave).values) for sign, wave in zip((1, -1), record.efforts, strict=True) if wave]
    terms, rough = basis(s).to_legendre[max(s - 2, 1) :], np.zeros(len(into.start))
    for values in (*(values for _, values in efforts), into.values - sum(sign * values for sign, values in efforts)):
        change = np.ptp(values)
        if change > 0:
            rough = np.maximum(rough, np.abs(thin_product(values, terms.T)).max(axis=1, initial=0.0) / change)
    return into, rough


def _ends(result: Result, element: PlacedLaw, into: PiecewiseQuantity, these: NDArray) -> tuple[NDArray, NDArray]:
    """Pieces among some that are to be cut toward their start, and toward their end."""
    away = np.full((2, len(these)), np.inf)
    for bend in element.kind.bends(element.constants, result.elements[element.where].impedance):
        off = np.abs(_beyond(into, bend, element, result.resolution.s).values)
        away = np.minimum(away, [off[these, 0], off[these, -1]])
    return these[~(away[0] > NEARER * away[1])], these[~(away[1] > NEARER * away[0])]


def _thinned(cuts: NDArray) -> NDArray:
    """Every nth of ascending cuts in each slab, so that there are `FULL` at most."""
    _, first, count = np.unique(cuts.astype(int), return_index=True, return_counts=True)
    rank = np.arange(len(cuts)) - np.repeat(first, count)
    return cuts[rank % np.repeat(-(-count // FULL), count) == 0]


def together(one: Kinks, other: Kinks) -> Kinks:
    """Instants of both."""
    return {where: np.union1d(one.get(where, np.empty(0)), other.get(where, np.empty(0))) for where in {*one, *other}}


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


def _beyond(into: PiecewiseQuantity, bend: Bend, element: PlacedLaw, s: int) -> PiecewiseQuantity:
    """Subtract from the wave into an element its value at a bend."""
    control = 1.0
    if bend.varying and element.law.factor is not None:
        t = into.start[:, None] + into.width[:, None] * basis(s).c
        control = element.law.factor.value(t, (into.start + into.width / 2)[:, None])
    values = into.values - bend.constant - bend.varying * np.maximum(control, 0.0) ** bend.power
    return into._replace(values=values, before=float(values[0, 0]))


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
