"""The drives under control: exact while everything is linear, event by event where the torques saturate, the controller
looks now and then, or bearings rub.

The loop is that of `drives.feedback`. Saturated torques are taken back through the same steps to the tau that would
have asked for them; the difference over K unwinds the integrals with their own integral time (back-calculation; Astrom
and Hagglund, PID Controllers, 1995, 3.5).
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from fractions import Fraction
from math import inf
from typing import Any

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from drives.assembled import Assembly, Dry
from drives.by_hand import SEEN, Control
from drives.control import PI, Design
from drives.discretise import legs, propagate
from drives.energy import Rows, energy_of
from drives.feedback import CONTROLLED, closed_loop, feedback_of, looks_of, sampled_poles
from drives.number import positive, written
from drives.parts import Winding
from drives.simulation import MOST_STEPS, Run, initial_state, moved, named, pushing, sample_times
from drives.state_space import StateSpace, floats
from drives.symbolic import OUTPUTS
from drives.torque import ZERO, Torque
from drives.torque_limit import unreachable
from drives.witness import doubts
from tline.errors import InputError

GROWS = 1e-9  # relative growth of a loop from look to look; more is not rounding


def simulate_control(
    design: Design,
    belt_speed: Torque = ZERO,
    tension: Torque = ZERO,
    *,
    d1: Torque = ZERO,
    d2: Torque = ZERO,
    limit: float | None = None,
    antiwindup: bool = True,
    period: float | None = None,
    delay: float = 0.0,
    filter_time: float = 0.0,
    slack: bool = False,
    friction: Dry = (None, None),
    winding: Winding | None = None,
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
    period : float, optional
        Time from one look of a sampled controller to the next, s; it is continuous if not given. Integrals are sums of
        errors at looks before, torques are held from look to look.
    delay : float, optional
        From a look to the torques that it leads to, s, at most 100 periods.
    filter_time : float, optional
        Time constant of a first-order low pass behind each measurement (speeds of the spools, tension), s.
    slack : bool
        Let the belt not push.
    friction : sequence of Coulomb or Karnopp, optional
        Dry friction in the bearings, as of `drives.simulate`; set points that a limit does not hold are found
        without it.
    winding : Winding, optional
        As of `drives.simulate`; the controllers, and verdicts about limits, keep the radii at the angle 0.
    t_end, step, initial
        As of `drives.simulate`; states q_speed and q_tension are the integrals.

    Raises
    ------
    InputError
        As of `drives.simulate`; a limit or a period not above 0, a delay without a period, or an unstable loop that
        leaves the range of floats. One that does not is a verdict of the run, and so are set points that the limit
        cannot hold.

    Examples
    --------
    >>> from drives import CoupledDrives, design
    >>> run = simulate_control(design(CoupledDrives(), 20, 20), Torque.step(1.0), Torque.step(5.0), t_end=2.0, step=0.5)
    >>> [round(float(v), 6) for v in run.outputs["belt_speed"]]
    [0.0, 0.999955, 1.0, 1.0, 1.0]
    """
    loop, inputs, drives = closed_loop(design, filter_time), (belt_speed, tension, d1, d2), design.drives
    t, x0 = sample_times(t_end, step), initial_state(loop.states, initial)
    u = np.column_stack([one.pieces(t)[0] for one in inputs])
    most = inf if limit is None else float(positive(limit, "limit"))
    asked = {"set_points": named(CONTROLLED, u[:, :2]), "limit": limit}
    control = _control(design, most, antiwindup, filter_time)
    if period is None and delay:
        raise InputError("delay", "without a period", "a sampled controller", f"{delay:g} s")
    verdict = tuple(_unstable(design, loop, period, delay, filter_time))
    if limit is not None:
        verdict += tuple(unreachable(drives, *inputs, limit=most, end=float(t[-1])))
    elif period is None and not (slack or winding or any(friction)):
        way = legs(inputs, float(step), len(t))
        with np.errstate(over="ignore", invalid="ignore"):
            ends = propagate(loop.a, loop.b, x0, way)
            x, energy = ends[way.sampled], energy_of(drives, loop, _torque_rows(loop), ends, way)
            outputs = named(loop.outputs, x @ loop.C.T + u @ loop.D.T)
        _within_floats(t, np.column_stack([x, energy.stored, energy.dissipated, energy.supplied]), verdict)
        run = Run(t, named(loop.states, x), outputs, energy, pushing(t, outputs["tension"]), verdict, **asked)
        return replace(run, verdicts=verdict + doubts(drives, inputs, run, control))
    parts, changes, between = Assembly(drives, x0, slack, winding), np.empty(0), np.empty(0)
    if period is not None:
        h, late = looks_of(period, delay)
        if t[-1] > MOST_STEPS * h:
            raise InputError("period", "too short", f"at most {MOST_STEPS} looks until {t[-1]:g} s", f"{h:g} s")
        changes = np.arange(int(t[-1] / h) + 1) * h + late
        changes = changes[changes <= t[-1]]
        between = np.minimum(changes + 0.5 * h, t[-1])
    given = _controlled(parts, design, control, x0[len(drives.states) :].tolist(), (period or 0.0, delay))
    m = parts.mechanism
    first, second = (m.add({torque: 1.0, m.input(2 + i): 1.0}) for i, torque in enumerate(given))
    parts.move(first, second, friction)
    run, seen, held = moved(parts, t, inputs, also=between)
    names = ("T1", "T2")
    states = {name: seen[name] for name in loop.states[len(drives.states) :]}
    outputs = {name: np.clip(seen[name], -most, most) for name in names}
    run = replace(run, states=run.states | states, outputs=run.outputs | outputs, verdicts=verdict, **asked)
    if period is None:
        return replace(
            run, verdicts=verdict + doubts(drives, inputs, run, control, slack=slack, dry=friction, winding=winding)
        )
    torques = (Torque.held(changes, held[name]) + more for name, more in zip(names, (d1, d2), strict=True))
    return replace(
        run, verdicts=verdict + doubts(drives, tuple(torques), run, slack=slack, dry=friction, winding=winding)
    )


def _control(design: Design, limit: float, antiwindup: bool, filter_time: float) -> Control:
    """Return the controllers in the form of the witness."""

    def numbers(controller: PI) -> tuple[float, float]:
        return float(controller.gain), float(controller.integral_time)

    return Control(numbers(design.speed), numbers(design.tension), limit, antiwindup, float(filter_time))


def _unstable(
    design: Design, loop: StateSpace, period: float | None, delay: float, filter_time: float
) -> Iterator[str]:
    """A sentence, if the loop is."""
    if period is None and loop.poles[-1].real > 0:
        yield f"the loop is unstable: a pole at {written(loop.poles[-1])} rad/s"
    elif period is not None and (growth := abs(sampled_poles(design, period, delay, filter_time)[0])) > 1 + GROWS:
        yield f"the sampled loop is unstable: from look to look a disturbance grows by {growth:.4g}"


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


def _controlled(
    parts: Assembly, design: Design, control: Control, start: list[float], looks: tuple[float, float]
) -> list[int]:
    """Torques given, as signals; beside them filters and integrals, which begin at `start`."""
    law, m = feedback_of(design, Fraction(0)), parts.mechanism
    seen, gain, integral, torque, feedback = map(floats, law[3:])
    limit, y, period = control.limit, [parts.states["w1"], parts.states["w2"], parts.tension], looks[0]
    if control.filter_time:
        behind = [m.state(one) for one in start[:-2]]
        for one, raw in zip(behind, y, strict=True):
            m.integrate(one, m.add({raw: 1.0 / control.filter_time, one: -1.0 / control.filter_time}))
        parts.shown.update(zip(SEEN, behind, strict=True))
        y = behind
    q = [m.register(one) if period else m.state(one) for one in start[-2:]]
    errors = [m.add({m.input(k): 1.0} | dict(zip(y, (-seen[k]).tolist(), strict=True))) for k in range(2)]
    tau_v, tau_f = (m.add({errors[k]: gain[k, k], q[k]: integral[k, k]}) for k in range(2))
    rests = [m.add(dict(zip(y, feedback[i].tolist(), strict=True)) | {tau_f: torque[i, 1]}) for i in range(2)]
    slopes, rates = torque[:, 0], [{error: 1.0} for error in errors]
    given = [m.add({tau_v: slopes[i], rests[i]: 1.0}) for i in range(2)]
    if limit < inf:
        given = _limited(m, limit, tau_v, list(zip(slopes.tolist(), rests, strict=True)))
    if limit < inf and control.antiwindup:
        back = floats((law.torque * law.gain).inv())
        less = [m.add({given[i]: 1.0, tau_v: -slopes[i], rests[i]: -1.0}) for i in range(2)]
        rates = [rate | dict(zip(less, back[k].tolist(), strict=True)) for k, rate in enumerate(rates)]
    if period:
        kept = [
            m.add({one: 1.0} | {s: period * x for s, x in rate.items()}) for one, rate in zip(q, rates, strict=True)
        ]
        given = m.sample(kept, given, *looks)
    else:
        for one, rate in zip(q, rates, strict=True):
            m.integrate(one, m.add(rate))
    parts.shown.update(zip(("q_speed", "q_tension", "T1", "T2"), (*q, *given), strict=True))
    return given


def _limited(m: Any, limit: float, tau_v: int, motors: list[tuple[float, int]]) -> list[int]:
    """Torques slope*tau_v + rest of the motors within a limit.

    Where both are out of reach the tension has priority: tau_v is cut until neither motor exceeds its limit.
    """
    lows, highs = (
        [m.add({rest: -1.0 / slope}, sign * limit / abs(slope)) for slope, rest in motors] for sign in (-1.0, 1.0)
    )
    low, high = m.larger(*lows), m.smaller(*highs)
    between = m.add({low: 0.5, high: 0.5})
    cut = m.smaller(m.larger(tau_v, m.smaller(low, between)), m.larger(high, between))
    own = [m.smaller(m.larger(cut, low), high) for low, high in zip(lows, highs, strict=True)]
    return [m.add({cut: slope, rest: 1.0}) for cut, (slope, rest) in zip(own, motors, strict=True)]
