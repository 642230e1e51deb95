"""The time loop: samples the sources chunk by chunk and lets the kernel advance all nodes.

Where no front lies inside a slab, nodes are advanced in blocks; where one does, slab by slab in pieces.

The kernel at work on one network: its structures are packed once, and then it is called by address.
"""

import time
from collections.abc import Sequence
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from tline.compiled.structure import pack
from tline.distinct import distinct
from tline.errors import InputError, NoFlowError
from tline.solver.assembly.assemble import Assembly
from tline.solver.assembly.layout import Excitation
from tline.solver.assembly.workspace import LULL, Tally, fronts_of, renew, sources_of, tally, work_for
from tline.solver.description.excitation import (
    EDGE,
    Broken,
    Waveform,
    averaged,
    broken,
    jumps_of,
    places_of,
    projected,
    sampled,
)
from tline.solver.description.laws import units_of_laws
from tline.solver.kernel import blocks
from tline.solver.kernel.fronts.structures import BEGIN, DONE, END, LATE, LIVE, NOTED, FrontRun, Fronts, Sources
from tline.solver.kernel.network import Network, Run, State
from tline.solver.kernel.units import units_of
from tline.words.progress import Progress

NOTHING = np.empty((0, 0)), np.empty((0, 2, 0))
CHUNK = 2e7  # line-end samples between two looks at the progress bar
LOOK = 2e6  # between two looks of observers, who want all pieces too
SAMPLES_AT_ONCE = 1e5  # samples of sources that are found at once
STRETCH = 1024  # slabs advanced in pieces between two looks for fronts


class Kernel:
    """A network, its state, and the units that advance it."""

    def __init__(self, network: Network, state: State, fronts: Fronts | None = None):
        self.network, self.state = network, state
        units = units_of(network, units_of_laws(network.laws), fronts=fronts is not None)
        self._work = work_for(network, state)
        self._run = pack(Run(network, state, units, pack(self._work), *NOTHING))
        self._fronts: Any = None if fronts is None else pack(fronts)

    def takes(self, network: Network, state: State, fronts: Fronts | None) -> bool:
        """Begin another run of the same network in its state, if that needs the same units."""
        if network is not self.network or state is not self.state or (fronts is None) != (self._fronts is None):
            return False
        renew(self._work, network, state.before.shape[1])
        self._fronts = None if fronts is None else pack(fronts)
        return True

    @cached_property
    def _advance_fronts(self) -> Any:
        from tline.solver.kernel.fronts.advance import advance_fronts

        return advance_fronts

    def load(self) -> None:
        """Compile the loops that will be needed, or load them."""
        blocks.advance.address  # noqa: B018
        if self._fronts is not None:
            self._advance_fronts.address  # noqa: B018

    def run(self, excitation: NDArray, record: NDArray) -> Any:
        """Packed argument of the units."""
        now = self._run.values
        if excitation is not now.excitation or record is not now.record:
            self._run.write(now._replace(excitation=excitation, record=record))
        return self._run

    def blocks(self, n_slabs: int, excitation: NDArray, record: NDArray, column: int) -> int:
        """Advance all nodes by n_slabs, writing the record from the given column (in slabs) on.

        Returns -1, or the number of a node whose effort is no longer finite; the number after the last node's if a wave
        under way is not.
        """
        node = blocks.advance(self.run(excitation, record), 0, n_slabs, column)
        if node < 0 and not np.isfinite(self.state.waves).all():
            return len(self.network.first) - 1
        return node

    def fronts(
        self, sources: Sources, excitation: NDArray, first_slab: int, n_slabs: int, record: NDArray
    ) -> tuple[int, int]:
        """Advance all nodes slab by slab with fronts as breakpoints, until none is left or the log is full.

        Returns -1, or the number of a node whose effort, or that of another in its group, is no longer finite; and the
        number of slabs done.
        """
        job = pack(FrontRun(self.run(excitation, record), self._fronts, sources))
        node = self._advance_fronts(job, first_slab, n_slabs)
        return node, int(self._fronts.values.counts[DONE])


def advance(network: Network, state: State, n_slabs: int, excitation: NDArray, record: NDArray, column: int) -> int:
    """Advance a network once; see `Kernel.blocks`."""
    return Kernel(network, state).blocks(n_slabs, excitation, record, column)


class Noted(NamedTuple):
    """Recorded slabs in pieces, in order of time."""

    row: NDArray  # (pieces,) of the record
    slab: NDArray  # (pieces,)
    span: NDArray  # (pieces, 2) start and end in slab time
    values: NDArray  # (pieces, 2, s) what arrived, and what left

    def of_rows(self, most: int) -> "Noted":
        """Select the pieces of the first rows of the record."""
        return Noted(*(part[self.row < most] for part in self))


def concatenated(noted: list[Noted], s: int) -> Noted:
    """Concatenate recorded pieces."""
    nothing = Noted(np.empty(0, int), np.empty(0, int), np.empty((0, 2)), np.empty((0, 2, s)))
    if not noted:
        return nothing
    return Noted(*(np.concatenate(parts) for parts in zip(nothing, *noted, strict=True)))


class Observer(Protocol):
    """Who looks at a run while it goes on."""

    def see(self, record: NDArray, first: int, n: int, pieces: Noted) -> None:
        """Take note of n slabs from number `first` on, recorded from the first column of the record on."""


class March(NamedTuple):
    """Result of a march beside its record."""

    seconds: float  # without compiling or loading the kernel
    pieces: Noted
    fronts: Tally
    final_fronts: Fronts | None  # as they are at the end; None in a run without any
    raw: bool = False  # whether its polynomials are to be read as they are, whose order is high


def march(
    assembly: Assembly, n: int, *, observers: Sequence[Observer] = (), progress: bool = False
) -> tuple[NDArray, March]:
    """Advance an assembled scene by n slabs.

    For observers the kernel records into a window of one chunk, and only recorded lines are kept.

    Returned are a record (recorded ends, 2, n * s) of arriving and leaving waves at the points of each slab, and a
    `March`.
    """
    s, windowed, rows, kept = assembly.basis.s, bool(observers), assembly.rows, assembly.kept
    chunk = min(max(int((LOOK if windowed else CHUNK) / (len(assembly.network.ends) * s)), 1), n)
    record = np.empty((kept, 2, n * s))
    window = np.empty((rows, 2, chunk * s)) if windowed else record
    steps = Stepper(assembly, n, window, rows if windowed else kept)
    steps.kernel.load()
    with Progress(n, "slab", progress) as bar:
        started = time.thread_time()
        for low, high in pairwise([*range(0, n, chunk), n]):
            if not windowed:
                steps.advance(low, high)
            else:
                seen = len(steps.noted)
                steps.begin_record(low)
                steps.advance(low, high)
                record[:, :, low * s : high * s] = window[:kept, :, : (high - low) * s]
                pieces = concatenated(steps.noted[seen:], s)
                for observer in observers:
                    observer.see(window, low, high - low, pieces)
                steps.noted[seen:] = [pieces.of_rows(kept)]
            bar.update(high - low)
        seconds = time.thread_time() - started
    steps.kernel.run(*NOTHING)  # releases the arrays of this one
    return record, steps.run(seconds)


class Signals:
    """The excitations of a run, and where they break; as those `before`, of the same grid, found them where alike."""

    def __init__(self, assembly: Assembly, n: int, before: "Signals | None" = None):
        self.of, self.h, self.basis = assembly.excitations, assembly.resolution.h, assembly.basis
        self.n, self.follows, self.plain = n, assembly.follows_edges, assembly.resolution.plain
        self.steady = assembly.description.steady
        # cells of order 1 are no better with corners in pieces, which would never be joined
        self.constants = self.basis.s == 1 and len(assembly.network.diamonds.line) > 0
        few = len(self.of) * n * self.basis.s <= SAMPLES_AT_ONCE
        self.shape = n, self.follows, few, len(self.of)
        like = before if before and before.shape == self.shape else None
        self.known = [self._found(k, parts, like.known if like else [], few) for k, parts in enumerate(self.of)]
        self.places = [places for _, places, _ in self.known]
        self._all = like._all if like else np.zeros((len(self.of), n * self.basis.s)) if few else None
        rows = [] if self._all is None else self._all
        each = enumerate(zip(self.of, self.known, strict=True))
        alike = [like and found is like.known[k] and parts == like.of[k] for k, (parts, found) in each]
        self._broken: dict[tuple[int, int], list[Broken]] = like._broken if like and all(alike) else {}
        for row, parts, found, same in zip(rows, self.of, self.known, alike, strict=False):
            if not same:
                np.multiply(parts[0][1], found[-1][0], out=row)
                for (_, share), values in zip(parts[1:], found[-1][1:], strict=True):
                    row += share * values

    def _found(self, k: int, parts: Excitation, known: list, few: bool) -> tuple[list[Waveform], NDArray, NDArray]:
        """Waveforms of a row, where it breaks, and their values, shape (parts, n s), if there are few."""
        waveforms = [waveform for waveform, _ in parts]
        if k < len(known) and known[k][0] == waveforms:
            return known[k]
        places = np.empty(0) if self.plain else places_of(parts, self.n * self.h, self.h)
        if self.constants and not self.plain:
            places = jumps_of(parts, places, self.n * self.h, self.h, self.steady)
        places = places if self.follows else places[places % 1 != 0]
        values = [self._values(waveform, 0, self.n) for waveform in waveforms] if few else []
        return waveforms, places, np.array(values)

    def _values(self, waveform: Waveform, first: int, n: int) -> NDArray:
        values_of = averaged if self.plain else projected if self.constants else sampled
        values = values_of(waveform, self.basis, self.h, first, n)
        return np.broadcast_to(values, (n, self.basis.s)).ravel()

    def broken(self, first: int, n: int) -> list[Broken]:
        """Parts of each excitation in those slabs, among n from `first` on, that hold its breaks."""
        found = self._broken.get((first, n))
        if found is None:
            each = zip(self.of, self.places, strict=True)
            found = [broken(parts, places, self.basis, self.h, first, n) for parts, places in each]
            if self._all is not None:  # of few samples
                self._broken[first, n] = found
        return found

    def sampled(self, first: int, n: int) -> NDArray:
        """Excitations of n slabs, shape (excitations, n * s), but of slabs with breaks."""
        s = self.basis.s
        if self._all is not None:
            return np.ascontiguousarray(self._all[:, first * s : (first + n) * s])
        excitation = np.zeros((len(self.of), n * s))
        for row, parts in zip(excitation, self.of, strict=True):
            for waveform, share in parts:
                row += share * self._values(waveform, first, n)
        return excitation


class Stepper:
    """An assembled scene under way."""

    def __init__(self, assembly: Assembly, n: int, record: NDArray, noting: int = 0):
        self.assembly, self.record = assembly, record
        self.noting = noting  # rows of the record whose pieces are noted
        self.origin = 0  # slab at the record's first column; the kernel of fronts counts from it
        self.signals = assembly.signals = Signals(assembly, n, assembly.signals)
        near, snapped = 0.5 if assembly.resolution.plain else EDGE, []
        for each in assembly.events:
            edge = float(round(each.at))
            snapped.append(each._replace(at=edge) if abs(each.at - edge) <= near else each)
        events = [event for event in snapped if event.at < n]
        self.at_edges = [] if assembly.follows_edges else [each for each in events if each.at % 1 == 0 and each.moves]
        inside = [each for each in events if assembly.follows_edges or each.at % 1 != 0]
        instants = np.concatenate([*self.signals.places, [each.at for each in inside]])
        self.events = distinct(np.floor(instants).astype(int)) if instants.size else instants
        self.fronts: Fronts | None = None
        if len(self.events):
            in_slab = [np.unique(np.floor(p), return_counts=True)[1] for p in self.signals.places]
            self.fronts = fronts_of(assembly, n, inside, 1 + int(np.concatenate([[0], *in_slab]).max()))
        kept: Kernel | None = assembly.kernel
        again = kept is not None and kept.takes(assembly.network, assembly.state, self.fronts)
        self.kernel = kept if kept and again else Kernel(assembly.network, assembly.state, self.fronts)
        assembly.kernel = self.kernel
        self.noted: list[Noted] = []

    def begin_record(self, slab: int) -> None:
        """Let the record's first column be that of a slab, from now on."""
        if self.fronts is not None:
            self.fronts.events.at[:] -= slab - self.origin
            self.fronts.settled[:] -= slab - self.origin
        self.origin = slab

    def advance(self, low: int, high: int) -> None:
        """Advance from slab `low` to slab `high`."""
        edges = sorted({low, high, *(int(each.at) for each in self.at_edges if low < each.at < high)})
        for first, last in pairwise(edges):
            for each in self.at_edges:
                if each.at == first:
                    self.assembly.network.step_row[each.group] = each.row
            while first < last:
                first += self._stretch(first, last)

    def _stretch(self, low: int, high: int) -> int:
        if self.fronts is not None:
            ahead = self.events[np.searchsorted(self.events, low) :]
            front_free = (int(ahead[0]) if len(ahead) else high) - low
            settling = (self.fronts.settled > low - self.origin).any()
            if self.fronts.counts[LIVE] or settling or front_free < LULL:
                return self._in_pieces(low, min(high - low, STRETCH))
            high = min(high, low + front_free)
        node = self.kernel.blocks(high - low, self.signals.sampled(low, high - low), self.record, low - self.origin)
        if node >= 0:
            _refuse(self.assembly, node)
        if self.fronts is not None:
            self.fronts.pieces.width[:] = 0.0
        return high - low

    def _in_pieces(self, first: int, n: int) -> int:
        """Advance by at most n slabs with fronts as breakpoints; returns by how many."""
        assembly, fronts = self.assembly, self.fronts
        assert fronts is not None
        sources = sources_of(self.signals.broken(first, n), assembly.basis.s)
        sources.slab[:] -= self.origin
        excitation, column = self.signals.sampled(first, n), first - self.origin
        node, done = self.kernel.fronts(sources, excitation, column, n, self.record)
        if node >= 0:
            begin, end = (first + int(done) + float(place) for place in fronts.sizes[BEGIN : END + 1])
            _refuse(assembly, node, (begin, end) if begin < end else None)
        if fronts.counts[LATE]:
            where = " and ".join(assembly.description.switched)
            problem = "more moves and fronts meet in one slab than it can hold"
            raise InputError(where, problem, "narrower slabs, or instants farther apart")
        noted, fronts.counts[NOTED] = fronts.counts[NOTED], 0
        where, span, values = (part[:noted] for part in fronts.log)
        pieces = Noted(where[:, 0], where[:, 1] + self.origin, span, values)
        self.noted.append(pieces.of_rows(self.noting))
        return int(done)

    def run(self, seconds: float) -> March:
        """Record of the march so far."""
        pieces = concatenated(self.noted, self.assembly.basis.s)
        return March(seconds, pieces, Tally() if self.fronts is None else tally(self.fronts), self.fronts)


def _refuse(assembly: Assembly, node: int, span: tuple[float, float] | None = None) -> None:
    group = int(np.searchsorted(assembly.network.group, node, side="right")) - 1
    error = None
    if group < len(assembly.groups) and assembly.groups[group].elements:
        where = " and ".join(element.where for element in assembly.groups[group].elements)
        cure = "narrower slabs, or a line between elements"
        error = NoFlowError(where, "no flow was found that fits the waves", cure)
    elif len(assembly.network.diamonds.line) and np.isfinite(assembly.state.waves).all():
        error = NoFlowError("lines", "friction too strong for the slabs", "narrower slabs")
    if error:
        error.span = span
        raise error
    where = " and ".join(assembly.description.active) or "lines"
    raise InputError(where, "the waves grow beyond all bounds", "passive loads", "active ones")
