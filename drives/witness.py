"""Check that a run satisfies the equations of motion, by code that shares nothing with the solver.

At all samples outputs and stored energy are held against their definitions, and the three energies against each other;
states, heat and work are held against those that follow from earlier samples.

Of z' = F z the motion is z(t + h) = z(t) + D(h) z(t), and D(2h) = 2 D(h) + D(h)^2. The integral of a quadratic form
z'Q z over the stretch is z'G z with G(2h) = G(h) + M'G(h) M, M = 1 + D(h). All in floats: rounding grows with the
number of doublings, and is estimated by repeating the calculation with one more. Linear equations are followed so from
every sample to the next; of the stretches in which an input has a corner some are. Nonlinear ones are integrated by
another method than the run's, for a part of the run where most happens and for some at random.
"""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drives.by_hand import Control, Equations, Product
from drives.torque import Torque

TERMS, NODES, SHORT = 16, 6, 0.25  # of the power series, of Gauss's quadrature; first step over the shortest time
MOST_DOUBLINGS = 60
SHARE, WEIGHT = np.polynomial.legendre.leggauss(NODES)


class Motion(NamedTuple):
    """Over some lengths of time."""

    change: NDArray[np.float64]  # D of each length, shape (lengths, n, n)
    integrals: NDArray[np.float64]  # G of each form and length, shape (forms, lengths, n, n)


def motion(f: NDArray, forms: Sequence[NDArray], lengths: Sequence[float], more: int = 0) -> Motion | None:
    """Solve z' = f z over some lengths of time, by `more` doublings than needed; None if these are too many.

    Examples
    --------
    >>> decay = motion(np.array([[-2.0]]), [np.array([[4.0]])], [50.0])
    >>> float(decay.change[0, 0, 0]), round(float(decay.integrals[0, 0, 0, 0]), 12)
    (-1.0, 1.0)
    """
    spans = np.abs(np.linalg.eigvals(f)).max() * max(lengths) / SHORT
    if not spans < 2.0**MOST_DOUBLINGS:
        return None
    doublings = more + int(np.ceil(np.log2(max(spans, 1.0))))
    short = np.array(lengths) / 2.0**doublings
    at = np.append((1 + SHARE) / 2, 1.0)[:, None] * short
    step, unit = f * at[..., None, None], np.eye(len(f))
    change = step / TERMS
    for k in range(TERMS - 1, 0, -1):
        change = step @ (unit + change) / k
    moved = unit + change[:-1]
    inside = np.swapaxes(moved, -1, -2) @ np.array(forms)[:, None, None] @ moved
    integrals, d = np.einsum("flnij,f->lnij", np.swapaxes(inside, 0, 1), WEIGHT / 2) * short[:, None, None], change[-1]
    for _ in range(doublings):
        moved = unit + d
        integrals, d = integrals + np.swapaxes(moved, -1, -2) @ integrals @ moved, 2 * d + d @ d
    return Motion(d, integrals)


SUM_ROUNDING = 1e-9  # relative to the terms of a sum: far more than rounding, far less than 1 % of a parameter
SPREAD = 30.0  # times the distance of two ways to the same motion in floats
STRAIGHT, BENT, CORNERS = 2000, 4, 3  # stretches without and with corners that are followed, and corners in each
WINDOWS, PARTS, MOST_RATES = 2, 200, 3000  # of integrated runs: windows, their part of the run, evaluations
TIGHT, TIGHTER = 1e-7, 1e-10  # relative to the largest values: asked of the integration, and once more if in doubt
LOOSE, PROMISED = 1e-6, 1e-12  # and what counts as another result; of runs that are integrated, absolute


class Record:
    """A run as rows.

    Parameters
    ----------
    t : numpy.ndarray
        Times of the samples, s, shape (n,).
    x, energies : numpy.ndarray
        The state by hand; heat and work since the start; shapes (states, n) and (2, n).
    inputs : sequence of Torque
    events : sequence of float
        Instants at which dry friction lets go or stops, s.
    """

    def __init__(self, t: NDArray, x: NDArray, energies: NDArray, inputs: Sequence[Torque], events: Sequence[float]):
        self.t, self.x, self.rows, self.inputs = t, x, np.vstack([x, energies]), inputs
        self.u, self.events = np.array([one.pieces(t)[0] for one in inputs]), np.sort(events)

    @property
    def beside(self) -> float:
        """Distance from a sample within which a corner of an input counts as at it, s."""
        return 64 * float(np.spacing(self.t[-1]))

    def forced(self, t: NDArray) -> NDArray:
        """Inputs just after the times t, then their slopes."""
        values, slopes = zip(*(one.pieces(t + self.beside) for one in self.inputs), strict=True)
        return np.array([*(v - self.beside * s for v, s in zip(values, slopes, strict=True)), *slopes])


class Steps(NamedTuple):
    """Values at some samples computed from earlier ones, rows as in a record, and their error bounds."""

    starts: NDArray[np.intp]
    ends: NDArray[np.intp]
    found: NDArray[np.float64]
    off: NDArray[np.float64]


class Rows:
    """Linear part of the equations, as coefficients over z = (x, u, du/dt).

    Attributes
    ----------
    rates : numpy.ndarray
        F of dz/dt = F z.
    heat, work : numpy.ndarray
        Heat flow and supplied power as quadratic forms.
    outputs : dict of str to numpy.ndarray
    """

    def __init__(self, equations: Equations, n: int, m: int):
        free, size = equations.freed, n + 2 * m
        units = [[int(i == k) for k in range(size)] for i in range(size)]
        rates, heat, work = zip(*(free.at(one[:n], one[n : n + m]) for one in units), strict=True)
        self.rates = np.vstack([np.array(rates, float).T, np.eye(2 * m, size, n + m)])
        self.heat, self.work = _form(heat), _form(work)
        seen = [free.outputs(one[:n], one[n : n + m]) for one in units]
        self.outputs = {name: np.array([one[name] for one in seen], float) for name in seen[0]}


def _form(products: Sequence[list[Product]]) -> NDArray[np.float64]:
    """A sum of products as a symmetric matrix, from the products at each unit vector."""
    c, a, b = np.moveaxis(np.array(products, float), -1, 0)
    form = (c * a) @ b.T
    return (form + form.T) / 2


def follow(equations: Equations, rows: Rows, record: Record) -> Iterator[Steps]:
    """Steps of a run."""
    yield from _doubled(rows, record) if equations.linear else _integrated(equations, record)


def _doubled(rows: Rows, record: Record) -> Iterator[Steps]:
    t, beside = record.t, record.beside
    corners = np.unique([time for one in record.inputs for time in one.times])
    first, last = (np.searchsorted(corners, at) for at in (t[:-1] + beside, t[1:] - beside))
    few = np.flatnonzero((first < last) & (last - first <= CORNERS))
    random = np.random.default_rng(len(t))
    bent = random.permutation(few)[:BENT]
    ways = [np.array([t[k], *corners[first[k] : last[k]], t[k + 1]]) for k in bent]
    lengths = [t[1] - t[0], *(length for way in ways for length in np.diff(way))]
    one, other = (motion(rows.rates, (rows.heat, rows.work), lengths, more) for more in (0, 1))
    if one is None or other is None:
        return
    legs, straight = _Legs(record, one, other), random.permutation(np.flatnonzero(first == last))[:STRAIGHT]
    if len(straight):
        yield legs.along(straight, [0], t[straight][None])
    begin = 1
    for k, way in zip(bent, ways, strict=True):
        yield legs.along(np.array([k]), range(begin, begin + len(way) - 1), way[:-1, None])
        begin += len(way) - 1


class _Legs:
    """Linear motion over some lengths of time, from states with an uncertainty."""

    def __init__(self, record: Record, one: Motion, other: Motion):
        self.record, self.motion = record, one
        rough = Motion(*(np.abs(x - y) for x, y in zip(one, other, strict=True)))
        largest = np.abs(np.vstack([record.x, record.forced(record.t)])).max(axis=1)
        self.noise = SPREAD * (rough.change @ largest)
        self.noise_energies = SPREAD * (rough.integrals @ largest @ largest)

    def along(self, samples: NDArray, legs: Sequence[int], begins: NDArray) -> Steps:
        """Integrate from samples to the next ones, over legs that begin at some times."""
        n, found = len(self.record.x), self.record.rows[:, samples]
        x, energies = found[:n], found[n:]
        off, off_energies = np.zeros_like(x), np.zeros_like(energies)
        for leg, at in zip(legs, begins, strict=True):
            z, change = np.vstack([x, self.record.forced(at)]), self.motion.change[leg]
            sizes = np.abs(z)
            for row, form in enumerate(self.motion.integrals[:, leg]):
                energies[row] += ((form @ z) * z).sum(axis=0)
                slopes = np.abs(form) @ sizes
                off_energies[row] += SUM_ROUNDING * (slopes * sizes).sum(axis=0) + 2 * (slopes[:n] * off).sum(axis=0)
            off_energies += self.noise_energies[:, leg, None]
            off += (
                np.abs(change[:n, :n]) @ off + SUM_ROUNDING * (np.abs(change[:n]) @ sizes) + self.noise[leg, :n, None]
            )
            x += change[:n] @ z
        return Steps(samples, samples + 1, found, np.vstack([off, off_energies]))


class _TooLong(Exception):
    """Integration that costs more than a check is worth."""


def _integrated(equations: Equations, record: Record) -> Iterator[Steps]:
    from scipy.integrate import solve_ivp

    y, t = record.rows, record.t
    n, scale, last, left = len(record.x), np.abs(y).max(axis=1), len(t) - 1, [MOST_RATES]
    scale[scale == 0] = 1.0
    off, stride = LOOSE * scale + PROMISED, max(last // PARTS, 1)
    moved = (np.abs(y[:, stride:] - y[:, :-stride]) / scale[:, None]).max(axis=0)
    first, behind = (
        np.searchsorted(record.events, at) for at in (t[:-stride] - record.beside, t[stride:] + record.beside)
    )
    still = np.flatnonzero(first == behind)  # dry friction is the same throughout
    if not still.size:
        return
    chosen = still[np.random.default_rng(last).integers(0, still.size, WINDOWS)]
    chosen = [*still[np.argsort(-moved[still])[: (WINDOWS + 1) // 2]], *chosen]

    def rates(time: float, state: NDArray, begin: float, u: NDArray, slope: NDArray) -> list[float]:
        if not left[0]:
            raise _TooLong
        left[0] -= 1
        x, u = (state * scale)[:n].tolist(), (u + slope * (time - begin)).tolist()
        found, *powers = equations.at(x, u)
        return np.array([*found, *(sum(c * a * b for c, a, b in one) for one in powers)]) / scale

    def after(k: int, tolerance: float) -> NDArray:
        found, end = y[:, k] / scale, t[k + stride]
        corners = {time for one in record.inputs for time in one.times if t[k] + record.beside < time < end}
        for begin, stop in pairwise([t[k], *sorted(corners), end]):
            u, slope = np.split(record.forced(np.array([begin]))[:, 0], 2)
            how = {"method": "Radau", "t_eval": [stop], "rtol": tolerance, "atol": tolerance}
            found = solve_ivp(rates, (begin, stop), found, args=(begin, u, slope), **how).y[:, -1]
        return found * scale

    for k in dict.fromkeys(int(k) for k in chosen[:WINDOWS]):
        try:
            found = after(k, TIGHT)
            if (np.abs(found - y[:, k + stride]) > off).any():
                found = after(k, TIGHTER)
        except _TooLong:
            return
        yield Steps(np.array([k]), np.array([k + stride]), found[:, None], off[:, None])


BALANCED = 1e-8  # relative to the energy turned over; runs that are integrated have 1e-10
DIGITS = 1e-13  # relative to an output value
ENERGIES = "the heat", "the work of the motors"


def doubts(
    parts: Any,
    inputs: Sequence[Torque],
    run: Any,
    control: Control | None = None,
    *,
    slack: bool = False,
    dry: Sequence[Any] = (None, None),
    winding: Any = None,
) -> tuple[str, ...]:
    """Return the first contradiction of a run to the equations of motion as a sentence; empty without any.

    Parameters
    ----------
    parts : CoupledDrives
    inputs : sequence of Torque
        T1 and T2, or under control the set points of belt speed and tension, d1 and d2.
    run : drives.simulation.Run
    control : Control, optional
    slack : bool
        Whether the belt cannot push.
    dry : sequence of Coulomb, Karnopp or None
        Dry friction of the left and the right bearing.
    winding : Winding, optional
    """
    equations = Equations(parts, control, slack, dry, winding)
    x = np.array([*(run.states[name] for name in equations.states), run.outputs["phi2"]])
    events = [event.t for side in run.events.values() for event in side]
    record = Record(run.t, x, np.array([run.energy.dissipated, run.energy.supplied]), inputs, events)
    with np.errstate(all="ignore"):  # values outside the range of floats are not judged
        for one in _all(equations, record, run):
            return (one,)
    return ()


def _all(equations: Equations, record: Record, run: Any) -> Iterator[str]:
    rows = Rows(equations, len(record.x), len(record.u))
    z = np.abs(np.vstack([record.x, record.u, 0 * record.u]))
    sizes = {name: np.abs(row) @ z for name, row in rows.outputs.items()}  # of the terms of each
    yield from _of_definitions(equations, record, run, sizes)
    yield from _of_balance(record, run)
    grain = DIGITS * np.abs(record.rows)
    grain[len(record.x) - 1] = DIGITS * sizes["phi2"]
    for starts, ends, found, off in follow(equations, rows, record):
        given, off = record.rows[:, ends], off + grain[:, ends] + grain[:, starts]
        for name, *values in zip((*equations.states, "phi2", *ENERGIES), given, found, off, strict=True):
            yield from _apart(record.t[ends], name, *values)


def _of_definitions(equations: Equations, record: Record, run: Any, sizes: dict[str, NDArray]) -> Iterator[str]:
    """Outputs and stored energy, from the states at each sample."""
    if equations.linear:
        found = equations.outputs(record.x, record.u)
    else:
        each = [equations.outputs(*one) for one in zip(record.x.T.tolist(), record.u.T.tolist(), strict=True)]
        found = {name: np.array([one[name] for one in each]) for name in each[0]}
    for name, value in found.items():
        yield from _apart(run.t, name, run.outputs[name], value, SUM_ROUNDING * sizes.get(name, np.abs(value)))
    stored = equations.stored(record.x)
    yield from _apart(run.t, "the stored energy", run.energy.stored, stored, SUM_ROUNDING * stored)


def _of_balance(record: Record, run: Any) -> Iterator[str]:
    """Gain in stored energy + heat = work."""
    heat, work = record.rows[-2:]
    gained, largest = run.energy.stored - run.energy.stored[0] + heat, np.abs(record.x).max(axis=1)
    torques = [np.abs(one.starts).max() for one in record.inputs[-2:]]
    torques += [np.abs(run.outputs[name]).max() for name in ("T1", "T2") if name in run.outputs]
    back_and_forth = sum(torques) * (largest[1] + largest[2]) * run.t[-1]
    turnover = run.energy.stored.max() + heat.max() + np.abs(work).max() + back_and_forth
    yield from _apart(
        run.t, "the energy stored and dissipated", gained, work, np.full_like(gained, BALANCED * turnover)
    )


def _apart(t: NDArray, name: str, given: NDArray, found: NDArray, off: NDArray) -> Iterator[str]:
    """Yield a sentence if two values differ by more than `off`, at the instant where this is worst."""
    far = np.abs(given - found)
    wrong = far > off
    if wrong.any():
        k = int(np.argmax(np.where(wrong, far / (off + np.finfo(float).tiny), 0.0)))
        value = f"{name} is {given[k]:.6g}, {far[k]:.2g} off what the equations of motion give"
        yield f"two methods disagree at {t[k]:.6g} s: {value}"
