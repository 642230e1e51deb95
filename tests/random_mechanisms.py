"""Random rows of masses on dry contacts, behind springs with play, the first held by a PID controller: as mechanisms of
`friction`, and by steps of DOP853 with SciPy's tableau from event to event, which share nothing but the numbers.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.integrate._ivp import dop853_coefficients as tableau

from friction import Karnopp
from friction.mechanism import Mechanism

END, TIMES = 3.0, 61  # s
STAGES = 12
A, B, E5 = tableau.A[:STAGES, :STAGES].copy(), tableau.B.copy(), tableau.E5[:STAGES].copy()
LONGEST, TIGHT, MOST = 1e-3, 1e-13, 10_000  # step, s, as longer ones may pass the Stribeck peak; its error; events


class Row(NamedTuple):
    """Masses, springs between neighbours (stiffness, play, damping), laws, PID gains, and the start."""

    masses: list[float]
    springs: list[tuple[float, float, float]]
    laws: list[Karnopp]
    pid: tuple[float, float, float]
    v: list[float]
    x: list[float]


class Moved(NamedTuple):
    """States at times, v before x, and instants of changes of each contact."""

    states: NDArray
    events: list[list[float]]


def random_row(seed: int) -> Row:
    """From one mass to four."""
    rng = np.random.default_rng((38, seed))
    n = int(rng.integers(1, 5))
    stiff = 10.0 ** rng.uniform(0.0, 3.0, n - 1)
    springs = [(float(k), rng.uniform(0.0, 0.3), float(rng.choice([0.0, 0.5]))) for k in stiff]
    slides = rng.uniform(0.1, 1.0, n)
    laws = [Karnopp(f, f * rng.uniform(1.0, 1.5), 0.1 * rng.random(), rng.uniform(0.05, 0.5)) for f in slides.tolist()]
    pid = tuple(float(x) for x in 10.0 ** rng.uniform(0.0, 2.0) * rng.random(3) * (1.0, 1.0, 0.1))
    v, x = rng.normal(size=(2, n)).tolist()
    return Row(rng.uniform(0.5, 2.0, n).tolist(), springs, laws, pid, v, x)  # type: ignore[arg-type]


def by_friction(row: Row, times: NDArray) -> tuple[int, Moved]:
    """Status, and the motion by `Mechanism`."""
    m, n = Mechanism(), len(row.masses)
    v, x, total = [m.state(one) for one in row.v], [m.state(one) for one in row.x], m.state()
    m.integrate(total, m.add({x[0]: -1.0}))
    p, i, d = row.pid
    pulls: list[dict[int, float]] = [{x[0]: -p, total: i, v[0]: -d}, *({} for _ in range(n - 1))]
    for k, (stiffness, play, damping) in enumerate(row.springs):
        away = m.add({x[k + 1]: 1.0, x[k]: -1.0})
        stretch = m.add({away: stiffness, m.limited(away, play): -stiffness})
        for one, sign in ((k, 1.0), (k + 1, -1.0)):
            for signal, factor in ((stretch, sign), (v[k + 1], sign * damping), (v[k], -sign * damping)):
                pulls[one][signal] = pulls[one].get(signal, 0.0) + factor
    for k, law in enumerate(row.laws):
        _, net = m.contact(law, v[k], m.add(pulls[k]))
        m.integrate(v[k], m.add({net: 1.0 / row.masses[k]}))
        m.integrate(x[k], v[k])
    shown = {f"v{k}": one for k, one in enumerate(v)} | {f"x{k}": one for k, one in enumerate(x)}
    status, run, changes = m.run(times, shown, places=x, events=10_000)
    events = [changes[changes[:, 4] == k, 2].tolist() for k in range(n)]
    return status, Moved(np.column_stack([run[name] for name in shown]), events)


class Numbers(NamedTuple):
    """A row as arrays."""

    m: NDArray
    k: NDArray
    play: NDArray
    c: NDArray
    f_c: NDArray
    f_s: NDArray
    f_v: NDArray
    v_s: NDArray
    pid: NDArray


@njit(cache=True)
def pulls(y, mode, way, row, f):
    """Forces on the masses but for friction."""
    n = row.m.size
    f[:] = 0.0
    f[0] = -row.pid[0] * y[n] + row.pid[1] * y[2 * n] - row.pid[2] * y[0]
    for j in range(n - 1):
        pull = row.c[j] * (y[j + 1] - y[j]) + abs(way[j]) * row.k[j] * (y[n + j + 1] - y[n + j] - way[j] * row.play[j])
        f[j] += pull
        f[j + 1] -= pull


@njit(cache=True)
def rates(y, mode, way, row, f, out):
    n = row.m.size
    pulls(y, mode, way, row, f)
    for j in range(n):
        out[j] = 0.0
        if mode[j] != 0:
            peak = (row.f_s[j] - row.f_c[j]) * np.exp(-((y[j] / row.v_s[j]) ** 2))
            out[j] = (f[j] - mode[j] * (row.f_c[j] + peak) - row.f_v[j] * y[j]) / row.m[j]
        out[n + j] = y[j]
    out[2 * n] = -y[n]


@njit(cache=True)
def step(y, h, mode, way, row, f, stages, new):
    """One step; its error relative to the largest of 1 and each state."""
    for s in range(STAGES):
        new[:] = y
        for q in range(s):
            new += h * A[s, q] * stages[q]
        rates(new, mode, way, row, f, stages[s])
    new[:] = y
    worst = 0.0
    for s in range(STAGES):
        new += h * B[s] * stages[s]
    for i in range(y.size):
        e = 0.0
        for s in range(STAGES):
            e += h * E5[s] * stages[s, i]
        worst = max(worst, abs(e) / max(1.0, abs(y[i])))
    return worst


@njit(cache=True)
def guards(y, mode, way, row, f, out):
    """Positive while all modes last: contacts, then springs."""
    n = row.m.size
    pulls(y, mode, way, row, f)
    for j in range(n):
        out[j] = mode[j] * y[j] if mode[j] != 0 else row.f_s[j] - abs(f[j])
    for j in range(n - 1):
        away = y[n + j + 1] - y[n + j]
        out[n + j] = way[j] * away - row.play[j] if way[j] != 0 else row.play[j] - abs(away)


@njit(cache=True)
def run(y, mode, way, row, times, record, events):
    """States at times, and events (contact, t); their number."""
    n, t, h, at, met = mode.size, 0.0, 1e-5, 0, 0
    f, stages, new, half = np.zeros(n), np.zeros((STAGES, y.size)), y.copy(), y.copy()
    g, later = np.zeros(2 * n - 1), np.zeros(2 * n - 1)
    while at < times.size:
        h = min(h, LONGEST)
        error = step(y, h, mode, way, row, f, stages, new)
        if error > TIGHT and h > 1e-7:
            h *= max(0.2, 0.8 * (TIGHT / error) ** 0.125)
            continue
        guards(new, mode, way, row, f, later)
        guards(y, mode, way, row, f, g)
        first, which = 1.0, -1
        for i in range(2 * n - 1):
            if later[i] < 0.0:
                low, high = 0.0, first
                step(y, first * h, mode, way, row, f, stages, half)
                guards(half, mode, way, row, f, g)
                if g[i] >= 0.0:
                    continue
                for _ in range(60):
                    middle = 0.5 * (low + high)
                    step(y, middle * h, mode, way, row, f, stages, half)
                    guards(half, mode, way, row, f, g)
                    if g[i] < 0.0:
                        high = middle
                    else:
                        low = middle
                first, which = high, i
        while at < times.size and times[at] <= t + first * h:
            step(y, times[at] - t, mode, way, row, f, stages, half)
            record[at] = half
            at += 1
        step(y, first * h, mode, way, row, f, stages, new)
        y[:] = new
        t += first * h
        grow = min(3.0, 0.8 * (TIGHT / max(error, 1e-20)) ** 0.125)
        if which < 0:
            h *= max(grow, 0.2)
            continue
        h = min(h, 1e-4)
        if which >= n:
            j = which - n
            away = y[n + j + 1] - y[n + j]
            way[j] = 0 if way[j] != 0 else (1 if away > 0.0 else -1)
            continue
        before, j = mode[which], which
        pulls(y, mode, way, row, f)
        if before != 0:
            y[j] = 0.0
            pulls(y, mode, way, row, f)
        mode[j] = (1 if f[j] > 0.0 else -1) if before == 0 or abs(f[j]) > row.f_s[j] else 0
        if mode[j] != before and met < events.shape[0]:
            events[met, 0], events[met, 1] = j, t
            met += 1
    return met


def by_steps(row: Row, times: NDArray) -> Moved:
    """The same from event to event: a contact sticks or slides one way, a spring is slack or taken up one way."""
    n = len(row.masses)
    k, play, c = (np.array(x, float) for x in zip(*row.springs, strict=True)) if row.springs else (np.zeros(0),) * 3
    laws = [np.array([getattr(law, name) for law in row.laws]) for name in ("F_c", "F_s", "F_v", "v_s")]
    pack = Numbers(np.array(row.masses), k, play, c, *laws, np.array(row.pid))
    y = np.array([*row.v, *row.x, 0.0])
    away = np.diff(np.array(row.x))
    way = np.where(np.abs(away) > play, np.sign(away), 0.0).astype(np.int64)
    mode = np.sign(row.v).astype(np.int64)
    record, events = np.zeros((times.size, y.size)), np.zeros((MOST, 2))
    met = run(y, mode, way, pack, times, record, events)
    return Moved(record[:, : 2 * n], [events[:met][events[:met, 0] == j, 1].tolist() for j in range(n)])
