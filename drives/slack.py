"""A belt that cannot push: where the linear model would press it, it hangs slack and carries nothing.

The tension is f = max(0, k_s*e_p), and -e_p is the slack. While there is some the pulley rests at x_k = 0, the belts
relax at their own rate K/B, and the spools turn freely until it is taken up.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from drives.coupled import CoupledDrives
from drives.energy import Energy, stored_in
from drives.integrate import integrate
from drives.simulation import Run, initial_state, named, sample_times
from drives.torque import ZERO, Torque
from drives.witness import doubts


def simulate_slack(
    drives: CoupledDrives,
    T1: Torque = ZERO,
    T2: Torque = ZERO,
    *,
    t_end: float,
    step: float,
    initial: Mapping[str, float] | None = None,
) -> Run:
    """Run the mechanism with a belt that pulls but does not push; arguments as in `drives.simulation`.

    Examples
    --------
    >>> run = simulate_slack(CoupledDrives(), T1=Torque.step(-0.1), T2=Torque.step(-0.1), t_end=1.0, step=0.5)
    >>> [float(f) for f in run.outputs["tension"]]
    [0.0, 0.0, 0.0]
    """
    t, x0 = sample_times(t_end, step), initial_state(drives.states, initial)
    left, right, belts = drives.left, drives.right, list(drives.damped.values())
    r1, r2, spring = float(left.radius), float(right.radius), float(drives.spring)
    damped = [(float(belt.stiffness), float(belt.damping)) for belt in belts]
    j1, b1, j2, b2 = (float(x) for x in (left.inertia, left.friction, right.inertia, right.friction))

    def rates(x: NDArray, u: NDArray) -> NDArray:
        _, w1, w2, e_p, *e = x[:-2]
        force = spring * max(0.0, e_p)
        speeds = [(force - k * one) / b for (k, b), one in zip(damped, e, strict=True)]
        heat = b1 * w1 * w1 + b2 * w2 * w2 + sum(b * v * v for (_, b), v in zip(damped, speeds, strict=True))
        turn1, turn2 = (-u[0] - b1 * w1 + r1 * force) / j1, (u[1] - b2 * w2 - r2 * force) / j2
        return np.array([w1, turn1, turn2, r2 * w2 - r1 * w1 - sum(speeds), *speeds, heat, u[1] * w2 - u[0] * w1])

    x = integrate(rates, np.append(x0, [0.0, 0.0]), (T1, T2), t)
    model, seen = drives.state_space(), x[:, :-2]
    outputs = named(model.outputs, seen @ model.C.T)
    pushed = outputs["tension"] < 0
    for name in ("tension", "x_k"):
        outputs[name] = np.where(pushed, 0.0, outputs[name])
    tight = seen.copy()
    tight[pushed, drives.states.index("e_p")] = 0.0  # slack stores nothing
    run = Run(t, named(drives.states, seen), outputs, Energy(stored_in(drives, tight), x[:, -2], x[:, -1]))
    return replace(run, verdicts=doubts(drives, (T1, T2), run, slack=True))
