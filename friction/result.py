"""Result of a run: motion, events, and energy balance."""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from friction.methods import Method
from friction.models import Model
from friction.spring_contact import SpringContact
from friction.testbench import Testbench
from tline.presentation import History, plain

SHOWN, LISTED = 12, 1000  # events in the text, and as plain data
CYCLE = 0.01  # by which cycles may differ that are called the same
UNITS = {"t": "s", "x": "m", "v": "m/s", "z": "m", "F_a": "N", "F_f": "N", "W_a": "J", "W_f": "J", "mode": ""}
COLUMNS = tuple(UNITS)


class Kind(StrEnum):
    """Event of the motion of the mass."""

    BREAK_AWAY = "break-away"
    STOP = "stop"
    REVERSAL = "reversal"


class Event(NamedTuple):
    """Something that happened, at a time [s] and a place [m].

    Attributes
    ----------
    kind : Kind
    t : float
        Instant [s].
    x : float
        Place [m].
    """

    kind: Kind
    t: float
    x: float


class Status(StrEnum):
    """How a run ended."""

    DONE = "done"
    BUDGET = "stopped: the budget of steps is spent, a larger budget goes on (--budget)"
    BLOWN_UP = "stopped: the velocity grows without bound"
    STALLED = "stopped: the step has shrunk to nothing"
    INACCURATE = "done, but the tolerance is not met"
    DOUBTED = "done, but two methods disagree"


class Ledger(NamedTuple):
    """Energy up to the end [J]: work of the applied force and of friction, stored energy, and heat.

    The residual is applied − friction − gain of kinetic energy, relative to all work that was done.

    Attributes
    ----------
    applied, friction : float
        Work of the applied force, and work that friction took [J].
    kinetic_gain, bristle_gain, heat : float
        Gain of energy in the motion and in the bristles, and energy lost [J].
    residual : float
        Relative to all work that was done.
    """

    applied: float
    friction: float
    kinetic_gain: float
    bristle_gain: float
    heat: float
    residual: float


class Cycle(NamedTuple):
    """Cycle that a motion has settled into: the stick–slip of a rig, or a controller that hunts.

    Attributes
    ----------
    period : float
        Time from a break-away, or a reversal, to that of the next cycle [s].
    span : float
        Way between the places of its events that are furthest apart [m].
    slips : int
        How many a cycle has: 1, or 2 to and fro.
    change : float
        How far the cycle before differs, relative to period and span.
    """

    period: float
    span: float
    slips: int
    change: float


@dataclass(frozen=True, repr=False)
class Result(History):
    """A run: arrays of shape (n,), one entry a sample.

    Attributes
    ----------
    model, bench, method : Model or law with springs, Testbench, Method
        As they were given.
    t, x, v : ndarray
        Time [s], place [m], velocity [m/s].
    z : ndarray
        Deflection of the bristles [m], mean one of springs, 0 for the static laws.
    F_a, F_f : ndarray
        Applied force and friction [N].
    W_a, W_f : ndarray
        Work of the applied force, and work that friction took [J].
    mode : ndarray of int
        0 stuck, ±1 sliding, ±2 pushed through a dead zone. Springs slide if all do. In a smooth law, sliding begins
        when friction without its viscous part comes within 1 % of its steady value, in the direction of the motion, and
        ends when v vanishes.
    events : list of Event
        Where the mode changes, between 0 and t_end, the first million. From `events` exact, from `rosenbrock`, `taylor`
        and SciPy's with events at their instants, from all others as the steps show them. None depends on `times`.
    event_count : int
        Events met.
    status : Status
        `DONE`, or why the run ended early or missed its tolerance; the arrays hold the part that was reached.
    steps, refused : int
        Steps made, and steps tried and refused; of the run that is given, not of those it was compared with.
    tol : float or None
        Tolerance of a run by `rosenbrock` or `taylor`, if one was given.
    errors : dict of str to float
        From `rosenbrock` and `taylor`, an estimate for each column: its largest error in the run, relative to its
        largest magnitude there; at "t" that of the instants of events, relative to t_end, 1 if events differ between
        runs that are compared. Empty for other methods: `events` is exact to rounding, the rest have none.
    doubt : str or None
        Where and how a run by one of these or `events` misses Newton's law or the law of friction, if it does.
    stored : ndarray or None
        Energy in the springs of `MaxwellSlip` or `Armstrong` [J].
    """

    model: Model | SpringContact
    bench: Testbench
    method: Method
    status: Status
    steps: int
    refused: int
    t: NDArray
    x: NDArray
    v: NDArray
    z: NDArray
    F_a: NDArray
    F_f: NDArray
    W_a: NDArray
    W_f: NDArray
    mode: NDArray
    events: list[Event]
    event_count: int
    tol: float | None
    errors: dict[str, float]
    doubt: str | None = None
    stored: NDArray | None = None
    picture, units = "friction.pictures:draw_run", UNITS

    @property
    def columns(self) -> dict[str, NDArray]:
        """All columns by name, SI."""
        return {name: getattr(self, name) for name in UNITS}

    @property
    def worst(self) -> tuple[str, float] | None:
        """The column with the largest estimate of its error, and that; None if there are no estimates."""
        return max(self.errors.items(), key=lambda item: item[1]) if self.errors else None

    @property
    def kinetic(self) -> NDArray:
        """Kinetic energy [J]."""
        return 0.5 * self.bench.mass * self.v**2

    @property
    def bristle(self) -> NDArray:
        """Energy in the bristles, σ0·z²/2, or in springs [J]."""
        return 0.5 * self._stiffness * self.z**2 if self.stored is None else self.stored

    @property
    def _stiffness(self) -> float:
        return 0.0 if isinstance(self.model, SpringContact) else self.model.law.sigma0

    @property
    def ledger(self) -> Ledger:
        """Energy balance of the run."""
        bench = self.bench
        kinetic = self.kinetic[-1] - 0.5 * bench.mass * bench.v0**2
        bristle = self.bristle[-1] - 0.5 * self._stiffness * bench.z0**2
        applied, friction = float(self.W_a[-1]), float(self.W_f[-1])
        size = max(np.max(np.abs(self.W_a) + np.abs(self.W_f) + self.kinetic), np.finfo(float).tiny)
        residual = (applied - friction - kinetic) / size
        return Ledger(applied, friction, float(kinetic), float(bristle), float(friction - bristle), float(residual))

    @property
    def cycle(self) -> Cycle | None:
        """The last cycle of sticking and slipping, or of swinging, if the one before was the same to 1 %."""
        breaks = [k for k, event in enumerate(self.events) if event.kind is not Kind.STOP]
        for slips in (1, 2):
            if len(breaks) > 2 * slips:
                first, middle, last = (breaks[-1 - n * slips] for n in (2, 1, 0))
                t, x = np.array([self.events[k][1:] for k in (first, middle, last)]).T
                span = float(np.ptp([event.x for event in self.events[middle : last + 1]]))
                change = np.abs(np.diff([np.diff(t), np.diff(x)])).ravel() / (t[2] - t[1], span or 1.0)
                if change.max() <= CYCLE:
                    return Cycle(float(t[2] - t[1]), span, slips, float(change.max()))
        return None

    def text_lines(self) -> Iterator[str]:
        """Events, the end, energy, and how good the numbers are."""
        ledger = self.ledger
        method = f"{self.method.name} (order {self.method.order})"
        yield f"{self.model.name} by {method}: {self.status}, {self.steps:,} steps"
        for event in self.events[:SHOWN]:
            yield f"  {event.kind} at {event.t:.10g} s, x = {event.x:.6g} m"
        if self.event_count > SHOWN:
            yield f"  and {self.event_count - SHOWN:,} more events"
        if cycle := self.cycle:
            ways = "to and fro" if cycle.slips == 2 else "one way"
            same = f"like the one before to {cycle.change:.0e}"
            stuck = any(event.kind is Kind.STOP for event in self.events[-2 * cycle.slips :])
            what = "sticks and slips" if stuck else "swings"
            yield f"{what} {ways}: period {cycle.period:.8g} s, span {cycle.span:.8g} m, {same}"
        yield (
            f"t = {self.t[-1]:.6g} s: x = {self.x[-1]:.10g} m, v = {self.v[-1]:.10g} m/s, F_f = {self.F_f[-1]:.10g} N"
        )
        yield (
            f"work in {ledger.applied:.6g} J = friction {ledger.friction:.6g} J + kinetic {ledger.kinetic_gain:.6g} J, "
            f"residual {ledger.residual:.1e}; {ledger.bristle_gain:.3g} J in bristles"
        )
        yield f"NOT met: {self.doubt}" if self.doubt else self._errors_in_words()

    def _errors_in_words(self) -> str:
        if self.worst is None:
            exact = self.method.step == "events"
            return "errors: those of rounding" if exact else f"errors: not estimated by {self.method.name}"
        told = [f"{name} {error:.0e}" for name, error in self.errors.items() if name != "t"]
        asked = "" if self.tol is None else f"; tolerance {self.tol:g}"
        events = f", events {self.errors['t']:.0e}·t_end" if self.event_count else ""
        worst = "events" if self.worst[0] == "t" else self.worst[0]
        return f"errors, of each column's largest value: {', '.join(told)}{events}; worst: {worst}{asked}"

    def to_dict(self) -> dict[str, Any]:
        """Method, status, state at the end, the first thousand events, energy and errors; samples are attributes."""
        found = {
            "model": self.model.name,
            "method": self.method.name,
            "order": self.method.order,
            "status": self.status,
            "steps": self.steps,
            "end": {name: float(getattr(self, name)[-1]) for name in COLUMNS},
            "events": self.events[:LISTED],
            "event_count": self.event_count,
            "cycle": self.cycle and self.cycle._asdict(),
            "energy": self.ledger,
            "tol": self.tol,
            "errors": self.errors or None,
            "doubt": self.doubt,
        }
        return plain(found)


def events_of(changes: NDArray) -> list[Event]:
    """Events from changes of the motion: its sign before, after, t, x."""
    return [
        Event(Kind.BREAK_AWAY if before == 0.0 else Kind.STOP if after == 0.0 else Kind.REVERSAL, t, x)
        for before, after, t, x, *_ in changes.tolist()
    ]
