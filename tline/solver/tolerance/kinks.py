"""When laws of elements kink, as a run saw it, for the next run to have its slabs cut in pieces there.

A law is smooth between some points of its graph. With e the effort across the element, less what stands behind it, and
i the flow, e + ρ i rises along the graph for any ρ > 0, and passes each point once. A piece without a kink inside is as
accurate as its order; so the instant is sought on the piece before or behind, continued into the one that has it.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tline.solver.description.description import Description
from tline.solver.description.elements import PlacedLaw
from tline.solver.description.given import ElementLaw
from tline.solver.radau import Basis, basis
from tline.solver.result.result import LineRecord, Result, Wave
from tline.solver.run import Kinks

MOST = 2000  # instants of an element; where there are more, none is followed
STEPS, STEP = 8, 1e-4  # of Newton's method, and for its slopes, in pieces
OVER = 1.5  # pieces, to which a neighbour is continued
CLOSED = 1e-12  # of the largest flow; less is none


class PiecewiseQuantity(NamedTuple):
    """A quantity in pieces, in order of time."""

    start: NDArray  # (pieces,) s
    width: NDArray  # (pieces,) s
    values: NDArray  # (pieces, s) at the Radau points
    before: float

    def __add__(self, other: "PiecewiseQuantity") -> "PiecewiseQuantity":  # pyright: ignore[reportIncompatibleMethodOverride]
        return self._replace(values=self.values + other.values, before=self.before + other.before)

    def times(self, factor: float) -> "PiecewiseQuantity":
        """The same, so many times."""
        return self._replace(values=factor * self.values, before=factor * self.before)


def kinking(description: Description) -> dict[str, tuple[PlacedLaw, list[str]]]:
    """Elements whose laws kink, by where they stand, and the lines whose records tell when."""
    nodes, found = description.nodes, {}
    for element in description.elements:
        free = [node for node in element.nodes if nodes[node].held is None]
        lines = [name for node in free for name, _ in _lines_at(description, node)]
        if lines and _points(element.law) is not None:
            found[element.where] = element, lines
    return found


def kinks_of(result: Result, description: Description, elements: Mapping[str, tuple[PlacedLaw, list[str]]]) -> Kinks:
    """Instants at which laws kinked in a run that recorded the lines at their elements, s."""
    found = {}
    for where, (element, _) in elements.items():
        instants = [_crossings(seen, result) for seen in _quantities(element, result, description)]
        all_ = np.unique(np.concatenate([np.empty(0), *instants]))
        if 0 < len(all_) <= MOST:
            found[where] = all_
    return found


def _points(law: ElementLaw) -> Sequence[tuple[float | None, float | None]] | None:
    """Points (e, i) at which a law's graph bends, one of them None if the other tells; None of a smooth law."""
    c = law.constants
    if law.kind == "quadratic":
        return [(0.0, 0.0)]
    if law.kind == "table":
        n = int(c[1])
        return list(zip(c[2 : 2 + n], c[2 + n : 2 + 2 * n], strict=True))[1:-1]
    if law.kind == "relief":
        return [(c[2], None), (c[2] + c[3], None)]
    if law.kind == "demand":
        return [(0.0, None), (c[2], None)]
    if law.kind == "leak":
        return [(0.0, None)]
    if law.kind in ("pump", "rotor") and c[4] > 0:
        return [(None, 0.0)]
    return None


def _quantities(element: PlacedLaw, result: Result, description: Description) -> Iterator[PiecewiseQuantity]:
    """What passes zero when a law kinks."""
    law, flow, across = element.law, _flow(element, result, description), _across(element, result, description)
    closed = CLOSED * float(np.abs(flow.values).max(initial=0.0)) if flow is not None else 0.0
    for e, i in _points(law) or []:
        if across is None or e is None:
            if flow is not None:
                yield _less(flow, i or closed)
        elif i is None or flow is None:
            yield _less(across, e)
        else:
            rho = _resistance(element, description)
            yield _less(across + flow.times(rho), e + rho * i)


def _across(element: PlacedLaw, result: Result, description: Description) -> PiecewiseQuantity | None:
    """Effort across an element less what stands behind it; None if no line tells it."""
    efforts = [_effort(node, result, description) for node in (element.from_node, element.to_node)]
    known = [seen for seen in efforts if isinstance(seen, PiecewiseQuantity)]
    if None in efforts or not known:
        return None
    one, other = (seen if isinstance(seen, PiecewiseQuantity) else _sampled(seen, known[0], result) for seen in efforts)
    return _less(one + other.times(-1.0), element.law.constants[0])


def _less(seen: PiecewiseQuantity, level: float) -> PiecewiseQuantity:
    return seen._replace(values=seen.values - level, before=seen.before - level)


def _lines_at(description: Description, node: str) -> list[tuple[str, int]]:
    """Lines that end at a node, and which of their ends."""
    names = list(description.lines)
    return [(names[end // 2], end % 2) for end in description.nodes[node].ends]


def _resistance(element: PlacedLaw, description: Description) -> float:
    """That of a line at the element."""
    (name, _), *_ = (end for node in element.nodes for end in _lines_at(description, node))
    return description.lines[name].z0


def _effort(node: str | None, result: Result, description: Description):
    """Effort at a node in pieces; a shape where it is held, 0 at the reference, None where it is not known."""
    if node is None:
        return 0.0
    held = description.nodes[node].held
    if held is not None:
        return held
    lines = _lines_at(description, node)
    if not lines or lines[0][0] not in result.lines:
        return None
    a, b = _waves(result.lines[lines[0][0]], lines[0][1])
    return (_in_pieces(a) + _in_pieces(b)).times(0.5)


def _flow(element: PlacedLaw, result: Result, description: Description) -> PiecewiseQuantity | None:
    """Flow through an element from its first node to its other, if it alone is at one of them, beside lines."""
    for name, sign in ((element.from_node, 1.0), (element.to_node, -1.0)):
        if name is None or description.nodes[name].held is not None:
            continue
        node, lines = description.nodes[name], _lines_at(description, name)
        alone = node.conductance == 0 and node.load is None and not node.switches and not node.excitations
        laws = sum(name in other.nodes for other in description.elements)
        if alone and laws == 1 and lines and all(line in result.lines for line, _ in lines):
            parts = []
            for line, k in lines:
                record = result.lines[line]
                a, b = _waves(record, k)
                out = (_in_pieces(a) + _in_pieces(b).times(-1.0)).times((2 * k - 1) / (2 * record.z0))
                parts.append(out)
            total = parts[0]
            for part in parts[1:]:
                total += part
            return total.times(sign)
    return None


def _waves(record: LineRecord, end: int) -> tuple[Wave, Wave]:
    return (record.a1, record.b1) if end == 0 else (record.a2, record.b2)


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


def _sampled(held, like: PiecewiseQuantity, result: Result) -> PiecewiseQuantity:
    """An effort that is held, in the pieces of another."""
    if isinstance(held, float):
        return like._replace(values=np.full_like(like.values, held), before=held)
    c = basis(result.resolution.s).c
    t = like.start[:, None] + like.width[:, None] * c
    values = held.value(t, (like.start + like.width / 2)[:, None])
    return like._replace(values=np.broadcast_to(values, t.shape), before=float(values[0, 0]))


def _crossings(seen: PiecewiseQuantity, result: Result) -> NDArray:
    """Instants at which a quantity passes zero, s."""
    order = basis(result.resolution.s)
    heights = np.column_stack([np.append(seen.before, seen.values[:-1, -1]), seen.values])
    piece, k = np.nonzero((heights[:, :-1] < 0) != (heights[:, 1:] < 0))
    if not 0 < len(piece) <= MOST:
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
    values = seen.values[piece]
    low, high = -OVER - 1, OVER + 2
    for _ in range(STEPS):
        here, ahead = (np.einsum("ns,ns->n", order.evaluation(x + d), values) for d in (0.0, STEP))
        slope = (ahead - here) / STEP
        x = np.clip(x - here / np.where(slope == 0, np.inf, slope), low, high)
    return x
