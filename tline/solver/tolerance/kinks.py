"""Instants at which laws of elements kinked in a run, for the next run to cut its slabs there.

Friction is such a law, |y|·y where the flow turns. Inside a line this kink is smoothed, at its ends it is not.

A law is smooth between some points of its graph. With e the effort across the element and i the flow, the wave e + ρ i
into it rises along the graph, and passes each point once. A piece without a kink inside is as accurate as its order; so
the instant is sought on the piece before or behind, continued into the one that has it.

The pressure behind a check valve through which nothing comes out rises with the one before it: the wave stays at the
kink until that has a peak, leaves it with a slope of zero, and is back when the pressure is as high again.

The flow through an orifice of capacity C is i = (sqrt(v² + v |e + ρ i|) - v)·2/ρ with v = (ρ C/2)²: beside its kink it
turns within a layer as wide as v, which is little if the orifice is nearly shut. Slabs are cut where the wave is
`WIDER` times farther from the kink than at the cut before, if slabs sweep over as much: on all such pieces
polynomials converge alike.
"""

from collections.abc import Callable, Iterator, Sequence
from itertools import chain
from typing import NamedTuple

import numpy as np
from numpy.polynomial.legendre import legder, legval
from numpy.typing import NDArray

from tline.distinct import distinct
from tline.solver.description.description import Description
from tline.solver.description.elements import PlacedLaw
from tline.solver.description.given import Bend, Shape
from tline.solver.description.resolution import Resolution
from tline.solver.radau import Basis, basis
from tline.solver.result.result import Result
from tline.solver.result.wave import Wave
from tline.solver.run import NO_KINKS, Kinks, at_node

MOST_KINKS = 2000  # instants of an element; beyond, none is followed
STEPS, STEP = 8, 1e-4  # of Newton's method; and the step for its slopes, in pieces
SETTLED = 1e-13  # pieces; a step this short is the last, for each is some 1e4 times shorter than the one before
OVER = 1.5  # pieces by which a neighbour is extrapolated
ROUNDED = 1e-12  # of the largest wave; smaller values have no sign
STILL = 1e-9  # of the largest wave; a smaller flow does not turn
STAYS = 1e-9  # of the largest effort; a wave so near to a kink of a valve that holds stays there
WIDER = 4.0  # ratio of distances from a kink of two cuts beside it
SHUT = 1e-2  # control signal; layers of elements nearer to shut are not resolved
FULL = 24  # middles of pieces at which a slab is cut, at most: of more pieces waves would be smeared
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

    `kinked` are elements whose laws kink, `middles` middles of pieces that were halved with their slabs, `places` the
    elements whose waves runs are to record; if `sharp`, all are cut beside kinks and knees as well; if `governed`,
    openings move by themselves.
    """

    def __init__(self, description: Description):
        self.elements, self.kinked = description.elements, kinking(description)
        self.sharp, self.middles = False, NO_KINKS
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

    def after(self, last: Result, chosen: Resolution, stuck: bool) -> Kinks:
        """Instants at which slabs of a run at the chosen resolution are cut: where laws kinked in the last one.

        Pieces are halved with their slabs if the order stays. From where a higher order did not help, and the search
        is `stuck`, slabs are cut beside kinks and knees as well.
        """
        self.sharp |= stuck
        if chosen.h < last.resolution.h and chosen.s <= last.resolution.s:
            self.middles = united(self.middles, middles_of(last, self.elements))
        self.middles = {where: _thinned(cuts / chosen.h) * chosen.h for where, cuts in self.middles.items()}
        return united(kinks_of(last, self.elements if self.sharp else self.kinked, self.sharp), self.middles)

    def turns(self, last: Result) -> Kinks:
        """Instants at which flow turned in a run at ends of recorded lines with friction, away from these elements."""
        found = {}
        for name, (end, node) in self._ends:
            if name not in last.lines:
                continue
            line = last.lines[name]
            a, b = (_in_pieces(wave) for wave in ((line.a2, line.b2) if end else (line.a1, line.b1)))
            flow = a.values - b.values
            flow[np.abs(flow) <= STILL * np.abs(a.values).max()] = 0.0
            instants = _crossings(a._replace(values=flow, before=a.before - b.before), last)
            if len(instants):
                found[at_node(node)] = distinct(np.append(found.get(at_node(node), np.empty(0)), instants))
        return found


def kinking(description: Description) -> list[PlacedLaw]:
    """Elements whose laws kink."""
    return [element for element in description.elements if [*element.kind.bends(element.constants, 1.0)]]


def kinks_of(result: Result, elements: Sequence[PlacedLaw], sharp: bool) -> Kinks:
    """Instants at which waves into elements, as a run recorded them, passed kinks, s, and if `sharp` places beside."""
    found = {}
    for element in elements:
        record = result.elements[element.where]
        into = _in_pieces(record.wave)
        factor = element.law.factor
        points = into.start[:, None] + into.width[:, None] * basis(result.resolution.s).c
        control = _control(factor, points, (into.start + into.width / 2)[:, None])
        instants = [np.empty(0)]
        bends, knees = (find(element.constants, record.impedance) for find in (element.kind.bends, element.kind.knees))
        least, most = element.kind.holds(element.constants, 1.0)
        efforts = (effort for effort in (record.wave, *record.efforts) if effort is not None)
        rounded = STAYS * max(np.abs(effort.values).max() for effort in efforts) if least < most else 0.0
        for place in chain(bends, knees if sharp else ()):
            beside = _beside(place, into, control) if sharp else ()
            for level in (place._replace(layer=0.0), *beside):
                values = into.values - level.constant - level.varying * control**level.power
                off = into._replace(values=values, before=float(values[0, 0]))
                t = np.append(_crossings(off, result, rounded), _stays(off, result, rounded) if rounded else ())
                opened = np.maximum(_control(factor, t, t), SHUT)
                instants.append(t[_swept(off, result.resolution.h)(t) >= (WIDER - 1) * level.layer * opened**2])
        all_ = distinct(np.concatenate(instants))
        if 0 < len(all_) <= MOST_KINKS:
            found[element.where] = all_
    return found


def _control(factor: Shape | None, t: NDArray, inside: NDArray) -> NDArray:
    """Control signal of an element."""
    return np.ones(1) if factor is None else np.maximum(factor.value(t, inside), 0.0)


def _beside(bend: Bend, into: PiecewiseQuantity, control: NDArray) -> Iterator[Bend]:
    """Waves on either side of a kink, each farther away by the same factor, up to the largest."""
    most, moves = np.abs(into.values - bend.constant).max(), control.size > 1
    away = bend.layer / (WIDER**2 if moves else 1.0)  # a layer that shrinks passes over the wave
    while 0 < away * max(control.min(), SHUT) ** 2 < most:
        yield from (Bend(bend.constant, sign * away, 2, away) for sign in (-1, 1))
        away *= WIDER


def _swept(into: PiecewiseQuantity, h: float) -> Callable[[NDArray], NDArray]:
    """Function of instants: what a quantity sweeps over in the slab there."""
    slab = ((into.start + into.width / 2) / h).astype(int)
    low, high = np.full(slab[-1] + 1, np.inf), np.full(slab[-1] + 1, -np.inf)
    np.minimum.at(low, slab, into.values.min(axis=1))
    np.maximum.at(high, slab, into.values.max(axis=1))
    return lambda t: (high - low)[np.minimum((t / h).astype(int), slab[-1])]


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


def _thinned(cuts: NDArray) -> NDArray:
    """Every nth of ascending cuts in each slab, so that there are `FULL` at most."""
    _, first, count = np.unique(cuts.astype(int), return_index=True, return_counts=True)
    rank = np.arange(len(cuts)) - np.repeat(first, count)
    return cuts[rank % np.repeat(-(-count // FULL), count) == 0]


def united(*all_: Kinks) -> Kinks:
    """Instants of all, ascending, by place."""
    return {
        where: distinct(np.concatenate([each[where] for each in all_ if where in each])) for where in {*chain(*all_)}
    }


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


def _crossings(seen: PiecewiseQuantity, result: Result, rounded: float = 0.0) -> NDArray:
    """Instants at which a quantity passes zero, s; none of its values up to `rounded` has a sign."""
    order = basis(result.resolution.s)
    heights = np.column_stack([np.append(seen.before, seen.values[:-1, -1]), seen.values])
    told = np.abs(heights) > max(ROUNDED * np.abs(heights).max(), rounded)  # the others keep the sign before them
    told[0, 0] = True
    last = np.maximum.accumulate(np.where(told, np.arange(heights.size).reshape(heights.shape), 0).ravel())
    below = (heights.ravel() < 0)[last].reshape(heights.shape)
    piece, k = np.nonzero(below[:, :-1] != below[:, 1:])
    if not 0 < len(piece) <= MOST_KINKS:
        return np.empty(0)
    places = np.append(0.0, order.c)
    low, high = places[k], places[k + 1]
    own = np.clip(_root(seen, order, piece, (low + high) / 2), low, high)
    found, near = own, own > 0.5
    for side, preferred in ((1, near), (-1, ~near)):
        x, reach = _continued(seen, order, piece, np.full(len(piece), side), own)
        fits = (x > -0.02) & (x < 1.02) & (np.where(side > 0, 1 - x, x) < reach)
        found = np.where(preferred & fits, x, found)
    return _instants(seen, result, piece, np.clip(found, 0.0, 1.0))


def _stays(seen: PiecewiseQuantity, result: Result, rounded: float) -> NDArray:
    """Instants at which a quantity begins and ceases to stay at zero, s."""
    order, found = basis(result.resolution.s), []
    heights = np.column_stack([np.append(seen.values[0, 0], seen.values[:-1, -1]), seen.values])
    zero, places, s = np.abs(heights) <= rounded, np.append(0.0, order.c), len(order.c)
    piece, k = np.nonzero(zero[:, :-1] & ~zero[:, 1:])  # a point may still be at zero behind the peak
    if 0 < len(piece) <= MOST_KINKS:
        x, _ = _continued(seen, order, piece, np.where(k > 0, 1, 0), places[k], turns=True)
        found.append(_instants(seen, result, piece, np.clip(x, np.where(k > 0, places[k - 1], -1.0), places[k + 1])))
    piece, k = np.nonzero(~zero[:, :-1] & zero[:, 1:])
    if 0 < len(piece) <= MOST_KINKS:
        x, _ = _continued(seen, order, piece, np.where(k + 1 < s, -1, 0), places[k + 1])
        found.append(_instants(seen, result, piece, np.clip(x, places[k], places[k + 1])))
    return np.concatenate([np.empty(0), *found])


def _continued(
    seen: PiecewiseQuantity, order: Basis, piece: NDArray, side: NDArray, x: NDArray, turns: bool = False
) -> tuple[NDArray, NDArray]:
    """Places in pieces where polynomials of those beside them, continued, pass zero or turn; and their reach."""
    neighbour = np.clip(piece + side, 0, len(seen.start) - 1)
    ratio = seen.width[piece] / seen.width[neighbour]
    offset = (seen.start[piece] - seen.start[neighbour]) / seen.width[neighbour]
    found = (_root(seen, order, neighbour, offset + x * ratio, turns) - offset) / ratio
    return found, np.where(neighbour != piece, OVER / ratio, 0.0)


def _instants(seen: PiecewiseQuantity, result: Result, piece: NDArray, x: NDArray) -> NDArray:
    """Instants of places in pieces, s, during the run."""
    t = seen.start[piece] + x * seen.width[piece]
    return t[(t > 0) & (t < result.t[-1])]


def _root(seen: PiecewiseQuantity, order: Basis, piece: NDArray, x: NDArray, turns: bool = False) -> NDArray:
    """Newton's root of the polynomials of pieces, or of their slopes, continued; from places x, in their own widths."""
    series = order.to_legendre @ seen.values[piece].T
    series = legder(series) if turns else series
    low, high = -OVER - 1, OVER + 2
    for _ in range(STEPS):
        here, ahead = legval(2 * np.stack([x, x + STEP]) - 1, series[:, None], tensor=False)
        slope = (ahead - here) / STEP
        before, x = x, np.clip(x - here / np.where(slope == 0, np.inf, slope), low, high)
        if np.abs(x - before).max() <= SETTLED:
            break
    return x
