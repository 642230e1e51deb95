"""Mechanisms put together signal by signal: masses, springs, gains, limits, gaps, controllers, contacts.

`Mechanism` writes down a diagram of `friction.kernel`: all is linear but products (works and powers), the larger of
two signals, for limits, slack and backlash, and contacts with dry friction.
"""

from collections.abc import Mapping, Sequence
from math import inf, nan

import numpy as np
from numpy.typing import ArrayLike, NDArray

from friction.kernel import structures as d
from friction.kernel.automaton import automaton
from friction.models import Model
from friction.spring_contact import SpringContact
from tline.compiled.structure import pack

Signal = int
MOST_LEGS = 10_000_000
MOST_PAST = 4096  # legs within a lag
CONTACTS = d.FRICTION, d.MAXWELL, d.ARMSTRONG


class Mechanism:
    """A diagram that grows. Each method adds a signal and returns its number.

    Examples
    --------
    A mass of 2 kg that 3 N push through a gap of 1 m before a spring of 50 N/m:

    >>> m = Mechanism()
    >>> v, x = m.state(), m.state()
    >>> push = m.add({m.larger(m.add({x: 1.0}, -1.0), m.add({})): -50.0}, 3.0)
    >>> m.integrate(v, m.add({push: 0.5}))
    >>> m.integrate(x, v)
    >>> status, run, _ = m.run([0.0, 1.0], {"x": x})
    >>> status, round(float(run["x"][-1]), 9)
    (0, 0.75)
    """

    def __init__(self):
        self.kinds: list[int] = []
        self.sources: list[list[int]] = []
        self.sums: list[tuple[Mapping[Signal, float], float]] = []
        self.start: dict[Signal, float] = {}
        self.laws: list[tuple[float, ...]] = []
        self.owners: list[int] = []  # contact that each law is a part of
        self.watched: list[Signal] = []
        self.springs: list[Signal] = []  # their forces
        self.registers: list[float] = []
        self.sampled = d.Sampled(inf, 0.0, np.zeros(0, np.int64), np.zeros((0, 0)), np.zeros(0))

    def _new(self, kind: int, *source: int, terms: Mapping[Signal, float] | None = None, constant: float = 0.0) -> int:
        self.kinds.append(kind)
        self.sources.append([*source, 0, 0, 0][:3])
        self.sums.append((terms or {}, constant))
        return len(self.kinds) - 1

    def input(self, number: int = 0) -> Signal:
        """An input of the run, by its number."""
        return self._new(d.INPUT, number)

    def state(self, start: float = 0.0, *, watched: bool = True) -> Signal:
        """Add a state, whose derivative `integrate` sets; not watched if no motion depends on it."""
        found = self._new(d.STATE)
        self.start[found] = float(start)
        if watched:
            self.watched.append(found)
        return found

    def integrate(self, state: Signal, rate: Signal) -> None:
        """Say whose integral a state is."""
        self.sources[state][0] = rate

    def add(self, terms: Mapping[Signal, float], constant: float = 0.0) -> Signal:
        """Add a sum of signals times factors and a constant; a single signal times 1 is returned itself."""
        terms = {signal: float(factor) for signal, factor in terms.items() if factor}
        if not constant and list(terms.values()) == [1.0]:
            return next(iter(terms))
        return self._new(d.SUM, terms=terms, constant=float(constant))

    def multiply(self, one: Signal, other: Signal) -> Signal:
        """A product."""
        return self._new(d.PRODUCT, one, other)

    def larger(self, one: Signal, other: Signal) -> Signal:
        """The larger of two."""
        return self._switch(self.add({one: 1.0, other: -1.0}), one, other)

    def smaller(self, one: Signal, other: Signal) -> Signal:
        """The smaller of two."""
        return self._switch(self.add({one: -1.0, other: 1.0}), one, other)

    def _switch(self, difference: Signal, one: Signal, other: Signal) -> Signal:
        self.watched.append(difference)
        return self._new(d.SWITCH, difference, one, other)

    def limited(self, u: Signal, limit: float) -> Signal:
        """A signal between ± a limit; itself if that is infinite."""
        if limit == inf:
            return u
        return self.smaller(self.larger(u, self.add({}, -limit)), self.add({}, limit))

    def contact(self, law: Model | SpringContact, v: Signal, applied: Signal | None = None) -> tuple[Signal, Signal]:
        """Add a contact that moves with v; return its friction, and the applied force less it.

        Dry friction acts on a state v, which the second of these has to accelerate; a law with springs on any velocity.
        """
        owner = self.owners[-1] + 1 if self.owners else 0
        if isinstance(law, SpringContact):
            self.watched.append(v)
            parts = [self._part(law.signal, owner, row, v, v) for row in law.elements]
            self.watched += parts
            self.springs += parts
            friction = self.add(dict.fromkeys(parts, 1.0) | {v: law.viscous})
            return friction, self.add({friction: -1.0} | ({} if applied is None else {applied: 1.0}))
        if applied is None:
            raise ValueError("dry friction needs the applied force")
        self.watched.append(applied)
        f = law.law
        return self._part(d.FRICTION, owner, (f.f_c, f.f_s, f.f_v, f.v_s, f.delta), v, applied), self._new(d.NET)

    def _part(self, kind: int, owner: int, row: tuple[float, ...], v: Signal, applied: Signal) -> Signal:
        self.owners.append(owner)
        self.laws.append((*row, 0.0, 0.0, 0.0)[:8])
        return self._new(kind, v, applied, len(self.laws) - 1)

    def register(self, start: float) -> Signal:
        """Add a value that a sampled controller holds from one sample to the next; `sample` names its signal."""
        self.registers.append(float(start))
        return self._new(d.HELD, len(self.registers) - 1)

    def sample(self, kept: Sequence[Signal], outputs: Sequence[Signal], period: float, delay: float) -> list[Signal]:
        """Outputs as they were at a look, from a delay later on; registers take `kept`."""
        queue, registers = np.zeros((int(delay / period) + 2, len(outputs))), len(kept)
        held = np.r_[self.registers, np.zeros(len(outputs))]
        self.sampled = d.Sampled(period, delay, np.array([*kept, *outputs], np.int64), queue, held)
        return [self._new(d.HELD, registers + k) for k in range(len(outputs))]

    def diagram(self) -> d.Diagram:
        """The signals as the kernel reads them."""
        sizes = [len(terms) for terms, _ in self.sums]
        return d.Diagram(
            np.array(self.kinds, np.int64),
            np.array(self.sources, np.int64).reshape(-1, 3),
            np.r_[0, np.cumsum(sizes)].astype(np.int64),
            np.array([signal for terms, _ in self.sums for signal in terms], np.int64),
            np.array([factor for terms, _ in self.sums for factor in terms.values()], float),
            np.array([constant for _, constant in self.sums], float),
            np.array(self.laws, float).reshape(-1, 8),
            np.array([i for i, kind in enumerate(self.kinds) if kind in CONTACTS], np.int64),
            np.array(list(dict.fromkeys(self.watched)), np.int64),
        )

    def prepared(
        self, times: ArrayLike, shown: Sequence[Signal], inputs: "d.Inputs | None" = None, *,
        t_end: float | None = None, places: Sequence[Signal] = (), events: int = 1,
    ) -> d.HybridRun:  # fmt: skip
        """Make a run with samples at `times` and room for `events` events, recorded with the signals `places`."""
        at, n, contacts = np.array(times, float), len(self.kinds), len(self.laws)
        state, rows = np.zeros(n), d.N + 1
        state[list(self.start)] = list(self.start.values())
        inputs = inputs or d.Inputs(np.zeros(1), np.zeros((1, 1, 1)), 0.0, 0.0, 0.0)
        memory, most = np.zeros((contacts, 6)), MOST_PAST if any(law[d.LAG] for law in self.laws) else 0
        memory[:, d.SINCE], memory[:, d.UNTIL] = -inf, inf
        whole, row = np.zeros((2, n), np.int64), np.zeros((2, rows))
        where = np.array([places[owner] for owner in self.owners] if places else [0] * contacts, np.int64)
        return d.HybridRun(
            self.diagram(), inputs, self.sampled, float(at[-1] if t_end is None else t_end), at,
            np.array(shown, np.int64), where, np.full((at.size, 1 + len(shown) + contacts), nan), np.empty((events, 5)),
            np.zeros(4, np.int64), state, np.zeros(contacts, np.int64), whole[0], np.full(n, nan), np.zeros(4),
            np.zeros((n, rows)), np.zeros((2 * contacts, rows)), np.zeros((contacts, rows)), np.zeros((contacts, rows)),
            memory, np.zeros((most, contacts, rows)), np.zeros(most), row[0], row[1],
        )  # fmt: skip

    def changes(self, run: d.HybridRun) -> NDArray:
        """Changes of contacts; one with several elements slides while all of them do."""
        found, slides, parts = run.events[: run.counts[2]], np.zeros(len(self.owners)), np.array(self.owners)
        if parts.size == len(set(self.owners)):
            return found
        for before, _, _, _, j in found[::-1].tolist():
            slides[int(j)] = before

        def together(owner: int) -> float:
            mine = slides[parts == owner]
            return float(mine[0]) if np.all(mine == mine[0]) else 0.0

        whole, rows = [together(owner) for owner in range(max(self.owners) + 1)], list[tuple[float, ...]]()
        for _, after, t, x, j in found.tolist():
            slides[int(j)], owner = after, self.owners[int(j)]
            now = together(owner)
            if now != whole[owner]:
                rows.append((whole[owner], now, t, x, owner))
            whole[owner] = now
        return np.reshape(np.array(rows), (-1, 5))

    def run(
        self, times: ArrayLike, shown: Mapping[str, Signal], inputs: "d.Inputs | None" = None, *,
        places: Sequence[Signal] = (), events: int = 1, budget: int = MOST_LEGS,
    ) -> tuple[int, dict[str, NDArray], NDArray]:  # fmt: skip
        """Run; return status, signals at `times` by name, and changes of contacts with the signals `places`."""
        run = self.prepared(times, list(shown.values()), inputs, places=places, events=events)
        status = automaton(pack(run), budget)
        return status, dict(zip(shown, run.record[:, 1:].T, strict=False)), self.changes(run)
