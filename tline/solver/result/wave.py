"""Waves as polynomials in slabs and pieces, and what runs record of them at lines and elements."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tline.solver.description.excitation import EDGE
from tline.solver.radau import Basis
from tline.solver.result.display import shortly
from tline.solver.result.superconvergence import superconvergent

if TYPE_CHECKING:
    from tline.solver.description.lines import Line
    from tline.solver.loop.march import Noted

ROUNDINGS = 1e-14  # relative rounding error of the instant of a front


class Pieces(NamedTuple):
    """Slabs with fronts of a wave: one polynomial between each two fronts."""

    slab: NDArray  # (pieces,) number of the slab, in order of time
    span: NDArray  # (pieces, 2) start and end in slab time
    values: NDArray  # (pieces, s) at the Radau points of the piece


@dataclass(frozen=True, eq=False, repr=False)
class Wave:
    """A wave as slab polynomials; constant before t = 0."""

    values: NDArray  # (slabs, s) at the Radau points, also where the slab is in pieces
    before: float
    basis: Basis
    h: float
    pieces: Pieces

    def __repr__(self) -> str:
        return shortly("Wave", slabs=len(self.values), order=self.basis.s)

    def __call__(self, t: ArrayLike) -> NDArray:
        """Return the value at any instants up to the end of the run, same shape as t; at a jump that before it."""
        t = np.asarray(t, float)
        place = t.ravel() / self.h
        slab = np.ceil(place - EDGE).astype(int) - 1
        inside = np.clip(slab, 0, len(self.values) - 1)
        local = np.clip(place - inside, 0.0, 1.0)
        wave = self.basis.values(local[:, None], self.values[inside])[:, 0]
        if len(self.pieces.slab):
            self._in_pieces(place, inside, wave)
        return np.where(slab < 0, self.before, wave).reshape(t.shape)

    def _in_pieces(self, place: NDArray, slab: NDArray, wave: NDArray) -> None:
        """Replace values in slabs with fronts by those of their pieces."""
        seen = np.flatnonzero(np.isin(slab, self.pieces.slab))
        start, stop = (self.pieces.slab[:, None] + self.pieces.span).T
        near = np.minimum(ROUNDINGS * place[seen], EDGE)  # behind a front pieces may be far narrower than a slab
        piece = np.minimum(np.searchsorted(stop, place[seen] - near), len(stop) - 1)
        local = np.clip((place[seen] - start[piece]) / (stop[piece] - start[piece]), 0.0, 1.0)
        wave[seen] = self.basis.values(local[:, None], self.pieces.values[piece])[:, 0]

    @property
    def begins(self) -> NDArray:
        """Places of the fronts inside slabs, in slabs."""
        start = self.pieces.span[:, 0]
        return (self.pieces.slab + start)[start > 0.0]

    def breakpoints(self) -> NDArray:
        """Instants of the fronts inside slabs."""
        return self.begins * self.h

    def between(self, start: NDArray, stop: NDArray, same: NDArray | float, x: NDArray) -> NDArray:
        """Values at places x, 0 to 1, of intervals without a front inside; an end as near to one as `same` is at it."""
        middle = (start + stop) / (2 * self.h)
        slab = np.floor(middle).astype(int)
        inside = np.clip(slab, 0, len(self.values) - 1)
        values, edges = self.values[inside], np.stack([inside, inside + 1]).astype(float)
        if len(self.pieces.slab):
            spans = (self.pieces.slab[:, None] + self.pieces.span).T
            k = np.minimum(np.searchsorted(spans[1], middle), len(spans[1]) - 1)
            held = (spans[0, k] <= middle) & (middle <= spans[1, k])
            values[held], edges[:, held] = self.pieces.values[k[held]], spans[:, k[held]]
        first, last = edges * self.h
        width = last - first
        begin = np.where(start - first <= same, 0.0, (start - first) / width)
        end = np.where(last - stop <= same, 1.0, (stop - first) / width)
        if x is self.basis.c:  # as whole polynomials are known
            part = np.flatnonzero((begin > 0.0) | (end < 1.0))
            local = begin[part, None] + (end - begin)[part, None] * x
            values[part] = self.basis.values(local, values[part])
        else:
            values = self.basis.values(begin[:, None] + (end - begin)[:, None] * x, values)
        values[slab < 0] = self.before
        return values

    def at_slab_ends(self) -> NDArray:
        """Values at t = 0, h, 2h, …: where they are most accurate."""
        seen = np.concatenate([[self.before], self.values[:, -1]])
        if len(self.pieces.slab):
            last = np.flatnonzero(np.diff(self.pieces.slab, append=-1))
            seen[self.pieces.slab[last] + 1] = self.pieces.values[last, -1]
        return seen


@dataclass(frozen=True, eq=False, repr=False)
class LineRecord:
    """Waves at both ends of a line: a leaves end 1 and arrives at end 2, b leaves end 2 and arrives at end 1."""

    z0: float
    delay: float
    a1: Wave
    b1: Wave
    a2: Wave
    b2: Wave
    smeared: bool  # whether fronts were left out
    raw: bool = field(default=False, kw_only=True)  # whether to keep the polynomials of the run

    def __repr__(self) -> str:
        return shortly("LineRecord", z0=f"{self.z0:.6g}", delay=f"{self.delay:.6g} s")

    @cached_property
    def at_end1(self) -> tuple[Wave, Wave]:
        """Waves (a, b) at end 1, at any instant nearly as accurate as at slab ends."""
        return (self.a1, self.b1) if self.smeared or self.raw else superconvergent(self.a1, self.b1)

    @cached_property
    def at_end2(self) -> tuple[Wave, Wave]:
        """Waves (a, b) at end 2, at any instant nearly as accurate as at slab ends."""
        return (self.a2, self.b2) if self.smeared or self.raw else superconvergent(self.a2, self.b2)

    def passing(self, share: float) -> tuple[tuple[Wave, float], tuple[Wave, float]]:
        """Waves a and b, as they are at an end, that pass a place given as a share of the delay, and how much later."""
        if share in (0.0, 1.0):
            a, b = self.at_end2 if share else self.at_end1
            return (a, 0.0), (b, 0.0)
        return (self.at_end1[0], share * self.delay), (self.at_end2[1], (1.0 - share) * self.delay)

    def waves(self, t: ArrayLike, share: float) -> tuple[NDArray, NDArray]:
        """Waves (a, b) at instants t, at a place given as a share of the delay."""
        t, ((a, of_a), (b, of_b)) = np.asarray(t, float), self.passing(share)
        return a(t - of_a), b(t - of_b)


class Recorded(NamedTuple):
    """Waves of a run by rows, on whole slabs and in pieces of some."""

    waves: NDArray  # (rows, 2, slabs * s) that arrive, and that leave
    pieces: "Noted"
    order: Basis
    h: float
    smeared: bool = True  # whether fronts were left out
    raw: bool = True  # whether to keep the polynomials of the run

    def wave(self, row: int, side: int, before: float, lift: float = 0.0) -> Wave:
        """The arriving (side 0) or leaving wave of a row, raised by `lift`; `before` already is."""
        noted = self.pieces
        pieces = Pieces(noted.slab, noted.span, noted.values[:, side])
        if len(noted.row):
            here = noted.row == row
            pieces = Pieces(noted.slab[here], noted.span[here], pieces.values[here] + lift)
        values = self.waves[row, side].reshape(-1, self.order.s)
        return Wave(values + lift if lift else values, before, self.order, self.h, pieces)

    def line(self, row: int, line: "Line", before: NDArray, lift: float | NDArray) -> LineRecord:
        """Record of a line whose ends are in two rows, with waves (a1, b1, a2, b2) before t = 0."""
        each = zip(((0, 1), (0, 0), (1, 0), (1, 1)), before.tolist(), np.broadcast_to(lift, 4).tolist(), strict=True)
        waves = (self.wave(row + end, side, *values) for (end, side), *values in each)
        return LineRecord(line.z0, line.delay, *waves, smeared=self.smeared, raw=self.raw)

    def node(self, row: int, before: float, lift: float) -> LineRecord:
        """The effort at a node where no line ends, as on a line that carries no flow."""
        u = self.wave(row, 0, before, lift)
        return LineRecord(1.0, 0.0, u, u, u, u, self.smeared, raw=self.raw)


class ElementRecord(NamedTuple):
    """Wave e + ρ i into the law of an element behind the impedance ρ, or the effort that drives a store; its states."""

    wave: Wave
    impedance: float
    # (2, slabs + 1) first and last state, or self-acting opening, at slab ends from t = 0 on;
    # empty without either
    states: NDArray
    efforts: tuple[Wave | None, Wave | None]  # at the nodes that it leads from and to
