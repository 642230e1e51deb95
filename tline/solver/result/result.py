"""Result of a run: the waves at the ends of recorded lines, and the quantities derived from them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tline.errors import InputError
from tline.solver.assembly.workspace import Tally
from tline.solver.description.given import NO_HEIGHT, Height, Medium, Scene, readable
from tline.solver.description.lines import Circuits
from tline.solver.description.resolution import Resolution
from tline.solver.ledger.ledger import Ledger
from tline.solver.loop.slabs import Slabs
from tline.solver.radau import Basis
from tline.solver.result.accuracy import Accuracy
from tline.solver.result.display import Display, shortly
from tline.solver.result.envelope import Envelope
from tline.solver.result.export import Export
from tline.solver.result.superconvergence import superconvergent
from tline.words.wording import place

if TYPE_CHECKING:
    from tline.solver.loop.march import Noted
    from tline.solver.result.states import Measured, StateTrace

AT_SLAB_END = 1e-9  # in slabs; an instant this near to a slab end is taken as the end
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

    @classmethod
    def of_row(
        cls, waves: NDArray, noted: "Noted", row: int, side: int, before: float, lift: float, basis: Basis, h: float
    ) -> "Wave":
        """Make the arriving (side 0) or leaving wave of a row of a record, raised by `lift`; `before` already is."""
        pieces = Pieces(noted.slab, noted.span, noted.values[:, side])
        if len(noted.row):
            here = noted.row == row
            pieces = Pieces(noted.slab[here], noted.span[here], pieces.values[here] + lift)
        values = waves[row, side].reshape(-1, basis.s)
        return cls(values + lift if lift else values, before, basis, h, pieces)

    def __call__(self, t: ArrayLike) -> NDArray:
        """Return the value at any instants up to the end of the run, same shape as t; at a jump that before it."""
        t = np.asarray(t, float)
        place = t.ravel() / self.h
        slab = np.ceil(place - AT_SLAB_END).astype(int) - 1
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
        near = np.minimum(ROUNDINGS * place[seen], AT_SLAB_END)  # behind a front pieces may be far narrower than a slab
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


class ElementRecord(NamedTuple):
    """Wave e + ρ i into the law of an element behind the impedance ρ, or the effort that drives a store; its states."""

    wave: Wave
    impedance: float
    # (2, slabs + 1) first and last state, or self-acting opening, at slab ends from t = 0 on;
    # empty without either
    states: NDArray
    efforts: tuple[Wave | None, Wave | None]  # at the nodes that it leads from and to


class AtHeight:
    """Efforts `u` somewhere, at a `height`."""

    u: Any
    height: Height

    @property
    def gauge_pressure(self) -> NDArray:
        """Pressure above the air's at the same height, Pa: u - density·g·elevation; u itself without elevations."""
        return self.u - self.height.weight

    @property
    def head(self) -> NDArray:
        """Piezometric head above the zero of elevations, m: u/(density·g).

        Raises
        ------
        InputError
            The density of the liquid is not known.
        """
        if np.isnan(self.height.per_metre):
            raise InputError("head", "the density of the liquid is not known", "the density of the pipe")
        return self.u / self.height.per_metre


@dataclass(frozen=True, eq=False, repr=False)
class Samples(AtHeight):
    """Effort, flow and waves at instants t, in SI; flow counts positive from end 1 to end 2 of the line."""

    t: NDArray
    u: NDArray
    y: NDArray
    a: NDArray
    b: NDArray
    height: Height = NO_HEIGHT

    def __repr__(self) -> str:
        return shortly("Samples", instants=self.t.size, of="t, u, y, a, b")


@dataclass(frozen=True, eq=False, repr=False)
class ProbeResult(AtHeight):
    """Signals at one probe."""

    name: str
    line: str  # '' at a node without line ends
    share: float  # place on the line, 0 at end 1 and 1 at end 2
    record: LineRecord
    slabs: Slabs
    height: Height = NO_HEIGHT

    def __repr__(self) -> str:
        return shortly(f"Probe {self.name!r}", instants=f"{len(self.t):,}", to=f"{self.t[-1]:.6g} s")

    @property
    def has_flow(self) -> bool:
        """Whether the probe is on a line; at a node without line ends flow is 0 and both waves are the effort."""
        return bool(self.line)

    def at(self, t: ArrayLike) -> Samples:
        """Effort, flow and waves at any instants of the run, and before t = 0; at a jump the values before it.

        Errors are estimated by `Accuracy.inside`; slab ends (`t`, `u`, `y`) are more accurate.

        Raises
        ------
        InputError
            An instant is no number, or lies behind the end of the run.
        """
        t, end = np.asarray(t, float), self.slabs.end
        if not (t <= end * (1 + AT_SLAB_END)).all():
            raise InputError(
                place("probes", self.name), "instant not in the run", f"at most {end:.9g} s", f"{t.max():.9g} s"
            )
        return self.of_waves(t, *self.record.waves(t, self.share))

    @cached_property
    def samples(self) -> Samples:
        """Signals at slab ends, t = 0 included, and at the end of the run."""
        seen = self.at_slab_ends
        if not self.slabs.rest:
            return seen
        last = self.at(self.slabs.ends[-1:])
        return replace(seen, **{key: np.append(getattr(seen, key), getattr(last, key)) for key in ("t", *"uyab")})

    @cached_property
    def at_slab_ends(self) -> Samples:
        """Signals at slab ends within the run, t = 0 included, where values are most accurate."""
        record, n = self.record, self.slabs.whole + 1
        a, b = (record.a1, record.b1) if self.share == 0.0 else (record.a2, record.b2)
        t = self.slabs.ends[:n] if self.slabs.rest else self.slabs.ends  # one array for all probes
        if self.share not in (0.0, 1.0) or self.slabs.number != len(a.values):
            return self.at(t)
        return self.of_waves(t, a.at_slab_ends()[:n], b.at_slab_ends()[:n])

    @property
    def passing(self) -> tuple[tuple[Wave, float], tuple[Wave, float]]:
        """Waves a and b that pass the probe, as they are at an end of its line, and how much later."""
        return self.record.passing(self.share)

    @property
    def waves(self) -> tuple[Wave, Wave]:
        """Waves (a, b) that pass the probe, as they are at an end of its line."""
        (a, _), (b, _) = self.passing
        return a, b

    def of_waves(self, t: NDArray, a: NDArray, b: NDArray) -> Samples:
        """Samples at instants, of the waves there."""
        return Samples(t, (a + b) / 2, (a - b) / (2 * self.record.z0), a, b, self.height)

    @property
    def t(self) -> NDArray:
        """Instants, s."""
        return self.samples.t

    @property
    def u(self) -> NDArray:
        """Effort: pressure in Pa, piezometric if nodes have elevations, or voltage in V."""
        return self.samples.u

    @property
    def y(self) -> NDArray:
        """Flow: m³/s, or A."""
        return self.samples.y

    @property
    def a(self) -> NDArray:
        """Wave u + z0·y, toward end 2."""
        return self.samples.a

    @property
    def b(self) -> NDArray:
        """Wave u - z0·y, toward end 1."""
        return self.samples.b


@dataclass(frozen=True, eq=False, repr=False)
class Result(Display, Export):
    """A finished run.

    Attributes
    ----------
    scene : Scene
        As it was run.
    slabs : Slabs
        Their number and width, and the end of the run.
    probes : mapping
        ProbeResult by name.
    lines : mapping
        LineRecord of each recorded line by name.
    resolution : Resolution
        Order s and slab width h.
    unresolved : tuple of str
        Parts of the run that were not resolved; empty if all were.
    start : mapping of str to ndarray
        By line the waves (a1, b1, a2, b2) before t = 0, counted from the level.
    samples : int
        Line-end samples computed.
    seconds : float
        Processor time spent stepping [s].
    fronts : Tally
        Count and size of the fronts that did not fit the slabs.
    accuracy : Accuracy or None
        Estimated errors; None for a run whose order or slab is fixed by hand, without a tolerance.
    envelope : Envelope or None
        Lowest and highest effort at every node; None if not asked for.
    accounts : Ledger, callable or None
        Energy by element, or a function that returns it; `ledger` reads it.
    circuits : mapping of str to Circuits
        Circuits that approximate the laws of lossy lines, by line.
    elements : mapping of str to ElementRecord
        Records of elements with states, by place; in runs on the way to a tolerance also of laws with kinks.
    slams : mapping of str to float
        Largest velocity of reverse flow through check valves with a disc, by place, m/s.
    parts : Result or None
        Result of the expanded scene, with stretches in place of lines with cavities; None if there are none.
    warned : tuple of str
        Remarks made before the run.
    """

    scene: Scene
    slabs: Slabs
    probes: Mapping[str, ProbeResult]
    lines: Mapping[str, LineRecord]
    resolution: Resolution
    unresolved: tuple[str, ...]
    start: Mapping[str, NDArray]
    samples: int
    seconds: float
    fronts: Tally
    accuracy: Accuracy | None = None
    envelope: Envelope | None = None
    accounts: Ledger | Callable[[], Ledger | None] | None = None
    circuits: Mapping[str, Circuits] = field(default_factory=dict)
    elements: Mapping[str, ElementRecord] = field(default_factory=dict)
    slams: Mapping[str, float] = field(default_factory=dict)
    parts: "Result | None" = None
    warned: tuple[str, ...] = ()

    @cached_property
    def t(self) -> NDArray:
        """Slab ends, s, beginning with 0, and the end of the run."""
        return self.slabs.ends

    @cached_property
    def ledger(self) -> Ledger | None:
        """Energy by element, computed when first read; None if not asked for or too expensive."""
        return self.accounts() if callable(self.accounts) else self.accounts

    @cached_property
    def states(self) -> "list[StateTrace]":
        """States, openings and speeds of elements at slab ends.

        Speed, torque and power of pumps, volume and pressure of gas, levels, openings, volumes of air and cavities.
        """
        from tline.solver.result.states import states_of

        return states_of(self)

    @cached_property
    def measures(self) -> "Mapping[str, Measured]":
        """Value and unit of each measure of the scene by name; NaN where its event does not happen."""
        from tline.solver.result.states import measures_of

        return measures_of(self)

    @cached_property
    def remarks(self) -> tuple[str, ...]:
        """Remarks on the scene and the run; empty if there are none."""
        from tline.solver.result.notes import remarks_of

        return (*self.warned, *(self.parts.remarks if self.parts else remarks_of(self)))

    @property
    def notes(self) -> tuple[str, ...]:
        """Remarks, notes of the ledger, and unresolved parts."""
        return (*self.remarks, *(self.ledger.notes if self.ledger else ()), *self.unresolved)

    @property
    def medium(self) -> Medium:
        """Words and units of the scene's medium."""
        return readable(self.scene)
