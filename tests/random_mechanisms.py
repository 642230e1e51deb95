"""Random rows of masses on dry contacts, behind springs with play, the first held by a PID controller: as mechanisms of
`friction`, and by SciPy's DOP853 from event to event, of which the two share nothing but the numbers.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from friction import Karnopp
from friction.mechanism import Mechanism

END, TIMES = 3.0, 61  # s
LONGEST = 2e-3  # step of SciPy, s: longer ones pass the Stribeck peak unseen


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


def by_scipy(row: Row, times: NDArray) -> Moved:
    """The same from event to event: a contact sticks or slides one way, a spring is slack or taken up one way."""
    n, (p, i, d) = len(row.masses), row.pid

    def forces(y):
        v, x = y[:n], y[n : 2 * n]
        f = np.zeros(n)
        f[0] = -p * x[0] + i * y[-1] - d * v[0]
        for k, (stiffness, play, damping) in enumerate(row.springs):
            pull = damping * (v[k + 1] - v[k]) + abs(way[k]) * stiffness * (x[k + 1] - x[k] - way[k] * play)
            f[k], f[k + 1] = f[k] + pull, f[k + 1] - pull
        return f

    def rates(_, y):
        f, a = forces(y), np.zeros(n)
        for k, law in enumerate(row.laws):
            if mode[k]:
                peak = (law.F_s - law.F_c) * np.exp(-((y[k] / law.v_s) ** 2))
                a[k] = (f[k] - mode[k] * (law.F_c + peak) - law.F_v * y[k]) / row.masses[k]
        return np.concatenate([a, y[:n], [-y[n]]])

    def guard(function, direction):
        function.terminal, function.direction = True, direction
        return function

    def guards():
        for k, law in enumerate(row.laws):
            if mode[k]:
                yield k, "stop", guard(lambda _, y, k=k: y[k], -mode[k])
            else:
                yield k, "free", guard(lambda _, y, k=k, law=law: abs(forces(y)[k]) - law.F_s, 1)
        for k, (_, play, _) in enumerate(row.springs):
            for side in (1, -1):
                if way[k] in (0, side):
                    at = guard(lambda _, y, k=k, b=side * play: y[n + k + 1] - y[n + k] - b, -side if way[k] else side)
                    yield k, side, at

    def side_of(k):
        away, play = y[n + k + 1] - y[n + k], row.springs[k][1]
        return int(np.sign(away)) if abs(away) > play else 0

    t, y, events = 0.0, np.array([*row.v, *row.x, 0.0]), [[] for _ in range(n)]
    found = [y[:, None]]
    way, mode = [side_of(k) for k in range(n - 1)], [int(np.sign(one)) for one in row.v]
    while t < times[-1]:
        watched = list(guards())
        how = {
            "rtol": 1e-12,
            "atol": 1e-13,
            "max_step": LONGEST,
            "t_eval": times[times > t],
            "events": [one for *_, one in watched],
        }
        run = solve_ivp(rates, (t, times[-1]), y, "DOP853", **how)
        found += [run.y] if len(run.t) else []
        hit = [index for index, when in enumerate(run.t_events) if when.size]
        if not hit:
            break
        (index,) = hit
        t, y = float(run.t_events[index][0]), run.y_events[index][0].copy()
        k, what, _ = watched[index]
        if what in ("stop", "free"):
            before, y[k] = mode[k], 0.0
            f = forces(y)[k]
            mode[k] = int(np.sign(f)) if what == "free" or abs(f) > row.laws[k].F_s else 0
            events[k] += [t] if mode[k] != before else []
        else:
            way[k] = 0 if way[k] else what
    return Moved(np.hstack(found)[: 2 * n].T, events)
