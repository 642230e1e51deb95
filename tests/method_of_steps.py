"""Circuits between lossless lines as delay equations: SciPy integrates from corner to corner, lines copy what leaves.

A circuit sees a line as a wave w behind its z0: u = w - z0·i at its end, with i the flow into the circuit, and 2u - w
leaves. A scene is then one function that gives, from the state x and all arriving waves, the rates of the state and the
efforts at all ends. Integration stops at corners of sources, where they arrive, and where a law bends.
"""

from bisect import bisect_right
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from heapq import heappop, heappush
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

POINTS = 12  # of Chebyshev in a step of the integrator
ANGLES = (2 * np.arange(POINTS) + 1) * np.pi / (2 * POINTS)
NODES, WEIGHTS = (1 - np.cos(ANGLES)) / 2, (-1.0) ** np.arange(POINTS) * np.sin(ANGLES)
SAME = 1e-9  # corners closer than this share of the shortest delay are one
BESIDE = 1e-12  # share of a piece by which its ends are approached, so that a corner is seen from the right side

Mode = tuple[int, ...]
Circuit = Callable[[float, NDArray, NDArray, Mode], tuple[NDArray, NDArray]]
Edges = Callable[[float, NDArray, NDArray, Mode], list[tuple[float, float]]]


class Line(NamedTuple):
    """A lossless line; its ends are numbered 2k and 2k + 1."""

    z0: float
    delay: float


class Step(NamedTuple):
    """One step of the integrator: efforts and arriving waves of all ends, and the state, at Chebyshev points."""

    begin: float
    end: float
    values: NDArray

    def at(self, t: float) -> NDArray:
        """Interpolated."""
        apart = (t - self.begin) / (self.end - self.begin) - NODES
        if not apart.all():
            return self.values[np.argmin(np.abs(apart))]
        share = WEIGHTS / apart
        return share @ self.values / share.sum()


class Motion:
    """What was integrated."""

    def __init__(self, lines: list[Line], before: NDArray):
        self.lines, self.before, self.begins, self.steps = lines, before, [], []
        self.ends = 2 * len(lines)

    def at(self, t: float) -> NDArray:
        """Efforts and arriving waves of all ends, and the state."""
        return self.before if t <= 0 else self.steps[max(bisect_right(self.begins, t) - 1, 0)].at(t)

    def arriving(self, t: float) -> NDArray:
        """Waves that arrive at all ends."""
        left, w = {}, np.empty(self.ends)
        for k, line in enumerate(self.lines):
            if line.delay not in left:
                found = self.at(t - line.delay)
                left[line.delay] = 2 * found[: self.ends] - found[self.ends : 2 * self.ends]
            w[2 * k], w[2 * k + 1] = left[line.delay][2 * k + 1], left[line.delay][2 * k]
        return w

    def keep(self, begin: float, end: float, values: NDArray) -> None:
        self.begins.append(begin)
        self.steps.append(Step(begin, end, values))

    def probe(self, end: int, times: NDArray) -> tuple[NDArray, NDArray]:
        """Effort, and flow from end 1 to end 2, at an end."""
        found = np.array([self.at(t) for t in times])
        u, w = found[:, end], found[:, self.ends + end]
        return u, (w - u) / self.lines[end // 2].z0 * (1 if end % 2 else -1)


@dataclass(frozen=True)
class ByHand:
    """A scene whose equations are written by hand, steady until it begins, and the end at which each probe stands."""

    integrated: Callable[[], Motion]
    probes: dict[str, int]
    begins: float = 0.0

    @cached_property
    def motion(self) -> Motion:
        return self.integrated()

    def differences(self, probes: Mapping[str, Any], inside: int = 0) -> dict[str, float]:
        """Largest difference of effort and flow at each probe, relative to the amplitude.

        At slab ends, or, if a number of them is given, at so many random instants.
        """
        motion, found = self.motion, {}
        last = motion.steps[-1].end
        for name, end in self.probes.items():
            probe = probes[name]
            if inside:
                probe = probe.at(np.sort(np.random.default_rng(0).uniform(0, self.begins + last, inside)))
            shared = probe.t - self.begins <= last * (1 + 1e-12)
            exact = motion.probe(end, np.clip(probe.t[shared] - self.begins, 0, last))
            for key, theirs, ours in zip("uy", exact, (probe.u, probe.y), strict=True):
                found[f"{name}.{key}"] = float(np.abs(ours[shared] - theirs).max() / (np.abs(theirs).max() or 1.0))
        return found


def integrate(
    circuit: Circuit,
    lines: list[Line],
    t_end: float,
    *,
    scale: NDArray | list[float],
    state: NDArray | list[float] | None = None,
    steady: NDArray | list[float] | None = None,
    corners: tuple[float, ...] = (),
    edges: Edges | None = None,
    mode: Mode = (),
    rtol: float = 1e-13,
    longest: float = np.inf,
) -> Motion:
    """Integrate a scene from t = 0.

    Parameters
    ----------
    circuit : callable
        (t, x, w, mode) to rates of x and efforts at all ends.
    scale : array
        Sizes of the state's parts, of which errors are counted.
    state, steady : array, optional
        State at t = 0, and efforts and arriving waves of all ends before; zeros without.
    corners : tuple of float
        Instants at which a source or an opening bends.
    edges : callable, optional
        (t, x, w, mode) to, for each law with pieces, the distances to the edges above and below its present piece:
        where one falls to zero the mode of that law rises or falls by one.
    """
    size, shortest = np.asarray(scale, float), min(line.delay for line in lines)
    x = np.zeros(len(size)) if state is None else np.asarray(state, float)
    at_ends = np.zeros(4 * len(lines)) if steady is None else np.asarray(steady, float)
    motion, t = Motion(lines, np.concatenate([at_ends, x])), 0.0
    ahead, delays = [], {line.delay for line in lines}
    for corner in (0.0, *corners):
        heappush(ahead, corner)
    while t < t_end * (1 - 1e-12):
        while ahead and ahead[0] < t + SAME * shortest:
            corner = heappop(ahead)
            for delay in delays:
                if all(abs(corner + delay - known) > SAME * shortest for known in ahead):
                    heappush(ahead, corner + delay)
        stop = min(t + shortest, ahead[0], t_end)
        end, x, bent = _piece(motion, circuit, (t, stop), x, size, edges, mode, rtol, longest)
        if bent is not None:
            law, above = divmod(bent, 2)
            mode = (*mode[:law], mode[law] + (-1 if above else 1), *mode[law + 1 :])
            for delay in delays:
                heappush(ahead, end + delay)
        t = end if bent is not None else stop
    return motion


def _piece(motion, circuit, span, x, size, edges, mode, rtol, longest):
    """Integrate between two corners, at most to where a law bends: the end, the state there, and which edge it was."""
    near = BESIDE * (span[1] - span[0])

    def inside(t):
        return min(max(t, span[0] + near), span[1] - near)

    def rates(t, x):
        s = inside(t)
        return circuit(s, x * size, motion.arriving(s), mode)[0] / size

    def distance(k):
        def event(t, x):
            s = inside(t)
            return edges(s, x * size, motion.arriving(s), mode)[k // 2][k % 2]

        event.terminal, event.direction = True, -1
        return event

    events = [distance(k) for k in range(2 * len(mode))] if edges else None
    done = solve_ivp(
        rates, span, x / size, method="DOP853", rtol=rtol, atol=rtol, dense_output=True, events=events, max_step=longest
    )
    assert done.success, done.message
    for begin, end, dense in zip(done.t[:-1], done.t[1:], done.sol.interpolants, strict=True):
        rows = []
        for t in begin + (end - begin) * NODES:
            s, y = inside(t), dense(t) * size
            w = motion.arriving(s)
            rows.append(np.concatenate([circuit(s, y, w, mode)[1], w, y]))
        motion.keep(begin, end, np.array(rows))
    which = next((k for k, found in enumerate(done.t_events or []) if len(found)), None)
    return done.t[-1], done.y[:, -1] * size, which
