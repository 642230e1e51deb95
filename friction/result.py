"""What a run gives back: the motion, its events, and where the energy went."""

from dataclasses import dataclass
from enum import StrEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from friction.methods import Method
from friction.models import Model
from friction.testbench import Testbench


class Kind(StrEnum):
    """What can happen to the mass."""

    BREAK_AWAY = "break-away"
    STOP = "stop"
    REVERSAL = "reversal"


class Event(NamedTuple):
    """Something that happened, at a time [s] and a place [m]."""

    kind: Kind
    t: float
    x: float


class Status(StrEnum):
    """How a run ended."""

    DONE = "done"
    BUDGET = "stopped: the budget of steps is spent"
    BLOWN_UP = "stopped: the velocity grows without bound"
    STALLED = "stopped: the step has shrunk to nothing"


class Ledger(NamedTuple):
    """Energy up to the end [J]: work of the applied force and of friction, what is stored, what became heat.

    The residual is applied − friction − gain of kinetic energy, relative to all work that was done.
    """

    applied: float
    friction: float
    kinetic_gain: float
    bristle_gain: float
    heat: float
    residual: float


@dataclass(frozen=True)
class Result:
    """A run: arrays of shape (n,), one entry a sample.

    Attributes
    ----------
    t, x, v : ndarray
        Time [s], place [m], velocity [m/s].
    z : ndarray
        Deflection of the bristles [m], 0 for the static laws.
    F_a, F_f : ndarray
        Applied force and friction [N].
    W_a, W_f : ndarray
        Work of the applied force, and work that friction took [J].
    mode : ndarray of int
        0 stuck, ±1 sliding, ±2 pushed through a dead zone. Smooth laws have no such thing: there, sliding begins when
        friction is within 1 % of its steady value, and ends when v changes its sign.
    events : list of Event
        Exact from the method `events`, which keeps the first 10 000; from all others as the samples show them.
    status : Status
        `DONE`, or why the run ended early; the arrays hold what was reached.
    steps, refused : int
        Steps made, and steps tried and refused.
    """

    model: Model
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

    @property
    def kinetic(self) -> NDArray:
        """Kinetic energy [J]."""
        return 0.5 * self.bench.mass * self.v**2

    @property
    def bristle(self) -> NDArray:
        """Energy in the bristles, σ0·z²/2 [J]."""
        return 0.5 * self.model.law.sigma0 * self.z**2

    @property
    def ledger(self) -> Ledger:
        """Where the energy went."""
        kinetic, bristle = self.kinetic[-1] - 0.5 * self.bench.mass * self.bench.v0**2, self.bristle[-1]
        applied, friction = float(self.W_a[-1]), float(self.W_f[-1])
        size = max(np.max(np.abs(self.W_a) + np.abs(self.W_f) + self.kinetic), np.finfo(float).tiny)
        residual = (applied - friction - kinetic) / size
        return Ledger(applied, friction, float(kinetic), float(bristle), float(friction - bristle), float(residual))


def modes_seen(model: Model, v: NDArray, z: NDArray, F_a: NDArray) -> NDArray:
    """Modes of a run whose method knows of none."""
    law = model.law
    sign = np.sign(v).astype(int)
    if model.name == "coulomb":
        return sign
    if model.name == "karnopp":
        return np.where((np.abs(v) <= law.delta) & (np.abs(F_a) <= law.f_s), 0, sign)
    share = law.sigma0 * z / model.g(v) if law.sigma0 else np.tanh(v / law.epsilon)
    starts, mode, now = sign * share >= 0.99, np.zeros(v.size, int), 0
    for k in range(v.size):
        if now and sign[k] != now:
            now = 0
        if starts[k]:
            now = sign[k]
        mode[k] = now
    return mode


def events_seen(t: NDArray, x: NDArray, v: NDArray, mode: NDArray) -> list[Event]:
    """Events between samples: a break-away at the last sample at rest, the others where a straight v vanishes."""
    found = []
    for k in np.flatnonzero(np.diff(mode)):
        before, after = mode[k], mode[k + 1]
        if before == 0:
            found.append(Event(Kind.BREAK_AWAY, float(t[k]), float(x[k])))
            continue
        share = v[k] / (v[k] - v[k + 1]) if v[k] * v[k + 1] < 0.0 else 1.0
        kind = Kind.STOP if after == 0 else Kind.REVERSAL
        found.append(Event(kind, float(t[k] + share * (t[k + 1] - t[k])), float(x[k] + share * (x[k + 1] - x[k]))))
    return found
