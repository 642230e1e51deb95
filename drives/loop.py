"""The drives under control: exact while everything is linear, event by event where the torques saturate.

With y = (belt_speed, tension), e = (set points) - y and the controllers' integrals dq/dt = e + antiwindup,

    tau = K e + K/T_i q,   F = N tau,   T = S F + R x

where N is the decoupler in belt forces, and S and R make unequal spools behave alike (see `drives.control`). Saturated
torques are taken back through the same three steps to the tau that would have asked for them; the difference over K
unwinds the integrals with their own integral time (back-calculation; Astrom and Hagglund, PID Controllers, 1995, 3.5).
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from math import inf

import numpy as np
from flint import fmpq, fmpq_mat
from numpy.typing import NDArray

from drives.assembled import Parts
from drives.by_hand import Control
from drives.control import PI, Design
from drives.decoupling import decoupler
from drives.discretise import legs, propagate
from drives.energy import Energy, Rows, energy_of, stored_in
from drives.number import positive, rational, written
from drives.simulation import Run, initial_state, named, pushing, sample_times
from drives.state_space import StateSpace, floats
from drives.symbolic import OUTPUTS
from drives.torque import ZERO, Torque
from drives.torque_limit import unreachable
from drives.witness import doubts
from tline.errors import InputError

CONTROLLED = ("belt_speed", "tension")


@dataclass(frozen=True)
class _Law:
    """tau = error_gain (r - C x) + integral_gain q and T = torque_gain tau + feedback x, as exact matrices."""

    seen: fmpq_mat
    gain: fmpq_mat
    integral: fmpq_mat
    torque: fmpq_mat
    feedback: fmpq_mat


def _law(design: Design) -> _Law:
    drives = design.drives
    seen = drives.state_space(CONTROLLED).c
    rows = {name: drives.state_space((name,)).c for name in ("w1", "w2", "tension")}
    torque, feedback = [], []
    for one, speed, sign in zip(decoupler(drives), ("w1", "w2"), (-1, 1), strict=True):
        torque.append([rational(one.share * x / 2) for x in (sign, 1)])
        pull = rows[speed] * rational(one.per_speed) + rows["tension"] * rational(one.per_tension)
        feedback.append(pull.tolist()[0])
    gains = [rational(one.gain) for one in (design.speed, design.tension)]
    rates = [rational(one.gain / one.integral_time) for one in (design.speed, design.tension)]
    return _Law(seen, _diagonal(gains), _diagonal(rates), fmpq_mat(torque), fmpq_mat(feedback))


def closed_loop(design: Design) -> StateSpace:
    """The drives with their controllers, exact.

    Inputs are the set points of belt_speed and tension and disturbing torques d1 and d2, which act like T1 and T2;
    outputs those of the drives and the motors' T1 and T2. The free angle's 0 and the belts' hidden mode are among its
    poles.

    Parameters
    ----------
    design : Design

    Examples
    --------
    >>> from drives import CoupledDrives, design
    >>> loop = closed_loop(design(CoupledDrives(), 20, 20))
    >>> [round(p.real, 3) for p in loop.poles]
    [-475.341, -100.0, -100.0, -100.0, -20.0, -19.306, -5.353, 0.0]
    """
    drives, law = design.drives, _law(design)
    plant = drives.state_space()
    on_states = law.feedback - law.torque * law.gain * law.seen
    on_integrals, on_references = law.torque * law.integral, law.torque * law.gain
    unit, none = _diagonal([rational(Fraction(1))] * 2), fmpq_mat(2, 2)
    a = _blocks([[plant.a + plant.b * on_states, plant.b * on_integrals], [-1 * law.seen, none]])
    b = _blocks([[plant.b * on_references, plant.b], [unit, none]])
    p = len(OUTPUTS)
    c = _blocks([[plant.c, fmpq_mat(p, 2)], [on_states, on_integrals]])
    d = _blocks([[fmpq_mat(p, 4)], [_blocks([[on_references, none]])]])
    names = (*drives.states, "q_speed", "q_tension")
    return StateSpace(a, b, c, d, names, ("belt_speed_set", "tension_set", "d1", "d2"), (*OUTPUTS, "T1", "T2"))


def simulate_control(
    design: Design,
    belt_speed: Torque = ZERO,
    tension: Torque = ZERO,
    *,
    d1: Torque = ZERO,
    d2: Torque = ZERO,
    limit: float | None = None,
    antiwindup: bool = True,
    t_end: float,
    step: float,
    initial: Mapping[str, float] | None = None,
) -> Run:
    """Run the drives under control.

    Parameters
    ----------
    design : Design
    belt_speed, tension : Torque
        Set points, m/s and N, as pieces in time.
    d1, d2 : Torque
        Disturbing torques, N m, which act like T1 and T2.
    limit : float, optional
        Largest torque of each motor, N m; without it the run is linear and exact at the samples.
    antiwindup : bool
        Unwind the integrals while a motor is at its limit.
    t_end, step, initial
        As of `drives.simulate`; states q_speed and q_tension are the integrals.

    Raises
    ------
    InputError
        What `drives.simulation` refuses, a limit that is not more than 0, or an unstable loop that leaves the range of
        floats. One that does not is a verdict of the run, and so are set points that the limit cannot hold.

    Examples
    --------
    >>> from drives import CoupledDrives, design
    >>> run = simulate_control(design(CoupledDrives(), 20, 20), Torque.step(1.0), Torque.step(5.0), t_end=2.0, step=0.5)
    >>> [round(float(v), 6) for v in run.outputs["belt_speed"]]
    [0.0, 0.999955, 1.0, 1.0, 1.0]
    """
    loop, inputs, drives = closed_loop(design), (belt_speed, tension, d1, d2), design.drives
    limited = None if limit is None else float(positive(limit, "limit"))
    t, x0 = sample_times(t_end, step), initial_state(loop.states, initial)
    u = np.column_stack([one.pieces(t)[0] for one in inputs])
    fastest = loop.poles[-1]
    asked = {"set_points": named(CONTROLLED, u[:, :2]), "limit": limited}
    verdict = (f"the loop is unstable: a pole at {written(fastest)} rad/s",) if fastest.real > 0 else ()
    if limited is None:
        way = legs(inputs, float(step), len(t))
        with np.errstate(over="ignore", invalid="ignore"):
            ends = propagate(loop.a, loop.b, x0, way)
            x, energy = ends[way.sampled], energy_of(drives, loop, _torque_rows(loop), ends, way)
            outputs = named(loop.outputs, x @ loop.C.T + u @ loop.D.T)
        _within_floats(t, np.column_stack([x, energy.stored, energy.dissipated, energy.supplied]), verdict)
        run = Run(t, named(loop.states, x), outputs, energy, pushing(t, outputs["tension"]), verdict, **asked)
        return _heard(run, design, inputs)
    verdict += tuple(unreachable(drives, *inputs, limit=limited, end=float(t[-1])))
    parts = Parts(drives, x0)
    _saturated(parts, design, limited, antiwindup, x0[len(drives.states) :])
    x, energies, found, _ = parts.run(t, inputs)
    plant, given = drives.state_space(), (np.clip(found[name], -limited, limited) for name in ("T1", "T2"))
    outputs = named(loop.outputs, np.column_stack([x @ plant.C.T, *given]))
    energy = Energy(stored_in(drives, x), *energies)
    x = np.column_stack([x, found["q_speed"], found["q_tension"]])
    run = Run(t, named(loop.states, x), outputs, energy, pushing(t, outputs["tension"]), verdict, **asked)
    return _heard(run, design, inputs, limited, antiwindup)


def _heard(run: Run, design: Design, inputs: tuple[Torque, ...], limit: float = inf, antiwindup: bool = True) -> Run:
    """The run with what its witness says."""

    def numbers(controller: PI) -> tuple[float, float]:
        return float(controller.gain), float(controller.integral_time)

    control = Control(numbers(design.speed), numbers(design.tension), limit, antiwindup)
    return replace(run, verdicts=run.verdicts + doubts(design.drives, inputs, run, control))


def _within_floats(t: NDArray, values: NDArray, verdict: tuple[str, ...]) -> None:
    """Refuse a run that leaves the range of floats."""
    lost = ~np.isfinite(values).all(axis=1)
    if lost.any():
        why = verdict[0] if verdict else "inputs too large"
        got = f"{why}, lost at {t[lost.argmax()]:.4g} s"
        raise InputError("simulation", "beyond the range of floats", "a stable loop", got)


def _torque_rows(loop: StateSpace) -> Rows:
    """T1 + d1 and T2 + d2 as rows over (states, inputs, their slopes)."""
    rows, p = [], len(OUTPUTS)
    for seen, direct, disturbance in zip(loop.c.tolist()[p:], loop.d.tolist()[p:], ("d1", "d2"), strict=True):
        direct[loop.inputs.index(disturbance)] += 1
        rows.append([*seen, *direct, *[fmpq(0)] * len(direct)])
    return rows


def _saturated(parts: Parts, design: Design, limit: float, antiwindup: bool, q0: NDArray) -> None:
    """Torques asked for and given, and the integrals, as signals.

    Where both cannot be had the tension comes first: tau_v is cut until neither motor is asked for more than its limit.
    """
    law, m = _law(design), parts.mechanism
    seen, gain, integral, torque, feedback = map(floats, (law.seen, law.gain, law.integral, law.torque, law.feedback))
    q = [m.state(start) for start in q0]
    errors = [m.add({m.input(k): 1.0} | parts.of(-seen[k])) for k in range(2)]
    tau_v, tau_f = (m.add({errors[k]: gain[k, k], q[k]: integral[k, k]}) for k in range(2))
    rests = [m.add(parts.of(feedback[i]) | {tau_f: torque[i, 1]}) for i in range(2)]
    slopes = torque[:, 0]
    lows, highs = (
        [m.add({rest: -1.0 / slope}, sign * limit / abs(slope)) for rest, slope in zip(rests, slopes, strict=True)]
        for sign in (-1.0, 1.0)
    )
    low, high = m.larger(*lows), m.smaller(*highs)
    between = m.add({low: 0.5, high: 0.5})
    cut = m.smaller(m.larger(tau_v, m.smaller(low, between)), m.larger(high, between))
    given = []
    for i in range(2):
        held = m.smaller(m.larger(cut, lows[i]), highs[i])
        given.append(m.add({held: slopes[i], rests[i]: 1.0}))
    back = floats((law.torque * law.gain).inv()) * antiwindup
    less = [m.add({given[i]: 1.0, tau_v: -slopes[i], rests[i]: -1.0}) for i in range(2)]
    for k in range(2):
        m.integrate(q[k], m.add({errors[k]: 1.0, less[0]: back[k, 0], less[1]: back[k, 1]}))
    names = "q_speed", "q_tension", "T1", "T2"
    parts.shown.update(zip(names, (*q, *given), strict=True))
    first, second = (m.add({given[i]: 1.0, m.input(2 + i): 1.0}) for i in range(2))
    parts.move(first, second)


def _diagonal(entries: list) -> fmpq_mat:
    n = len(entries)
    return fmpq_mat(n, n, [entries[i] if i == k else 0 for i in range(n) for k in range(n)])


def _blocks(blocks: list[list[fmpq_mat]]) -> fmpq_mat:
    """One matrix of several."""
    rows = []
    for across in blocks:
        lists = [block.tolist() for block in across]
        rows += [[x for part in parts for x in part] for parts in zip(*lists, strict=True)]
    return fmpq_mat(rows)
