"""SciPy's adaptive steppers on the testbench, as a user would set them up, with a budget so that nobody waits.

With events, a static law is stuck or sliding one way at a time, and the solver starts afresh at each change.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from friction.kernel import law as laws
from friction.kernel.fixed import passed
from friction.kernel.law import BUDGET, DONE, FA, FF, MODE, STALLED
from friction.models import Model
from friction.testbench import Testbench

FREE = 9  # mode of a solver that looks at the law alone


class Motion:
    """The equations while one mode and one piece of the applied force last."""

    def __init__(self, model: Model, bench: Testbench):
        self.law, self.drive, self.mass, self.mode = model.law, bench.drive, float(bench.mass), FREE
        self.met: list[tuple[float, float, float, float]] = []
        self.shown = 0  # mode that the steps of a free run show
        self.go_on(0.0)

    def go_on(self, t: float) -> None:
        """Take the piece of the applied force that begins at t or goes on there."""
        self.push = laws.push_at(self.drive, t)

    def applied(self, t: float, y: Any) -> float:
        """Applied force."""
        return laws.applied(self.push, t, y[0])[0]

    def forces(self, t: float, y: Any) -> tuple[float, float, float]:
        """Applied force, friction, and rate of the bristles."""
        f_a = self.applied(t, y)
        if self.mode == FREE:
            return f_a, *laws.friction(self.law, y[1], y[2], f_a)
        return f_a, self.mode * laws.steady(self.law, y[1])[0] + self.law.f_v * y[1] if self.mode else f_a, 0.0

    def rates(self, t: float, y: NDArray) -> list[float]:
        """Time derivatives of x, v, z, W_a, W_f."""
        x, v, z = y[:3].tolist()
        f_a, f_f, rate = self.forces(t, (x, v, z))
        return [v, (f_a - f_f) / self.mass, rate, f_a * v, f_f * v]

    def mode_at(self, t: float, y: NDArray) -> int:
        """Sign of the motion, 0 if the mass is held; in a free run as its steps show it."""
        return self.mode if self.mode != FREE else laws.mode_of(self.law, self.shown, y[1], y[2], self.applied(t, y))

    def margin(self, t: float, y: NDArray) -> float:
        """Positive until the mode ends."""
        if self.mode == FREE:
            return 1.0
        return self.law.f_s - abs(self.applied(t, y)) if self.mode == 0 else self.mode * y[1]

    def look(self, before: tuple[float, NDArray], t: float, y: NDArray) -> None:
        """Note an event between the ends of a step of a free run."""
        then, start = before
        mode = self.mode_at(t, y)
        if mode != self.shown:
            share = passed(self.law, self.shown, start[1], start[2], y)
            at = then + share * (t - then)
            self.met.append((self.shown, mode, at, start[0] + share * (y[0] - start[0])))
        self.shown = mode

    def next_mode(self, t: float, y: NDArray, ended: bool) -> None:
        """Set the mode that begins at t, because the last one ended or the force jumped; at rest, the mass is held if
        possible.
        """
        if self.mode == FREE:
            return
        f_a, old = self.applied(t, y), self.mode
        breaks = self.mode == 0 and ended
        if self.mode != 0:
            y[1] = 0.0
        self.mode = int(np.sign(f_a)) if breaks or abs(f_a) > self.law.f_s else 0
        if self.mode != old:
            self.met.append((old, self.mode, t, y[0]))


def adaptive(
    model: Model, bench: Testbench, t_end: float, times: NDArray, tol: float, budget: int, solver: str, events: bool
) -> tuple[int, int, NDArray, list[tuple[float, float, float, float]]]:
    """Run RK45 or BDF; the status, the steps made, the record, and the events as changes of the motion."""
    from scipy.integrate import BDF, RK45
    from scipy.optimize import brentq

    motion, y = Motion(model, bench), bench.start
    if events:
        held = bench.v0 == 0.0 and abs(motion.applied(0.0, y)) <= motion.law.f_s
        motion.mode = 0 if held else int(np.sign(bench.v0 or motion.applied(0.0, y)))
    record = np.full((times.size, MODE + 1), np.nan)
    scheme: Any = {"rk45": RK45, "bdf": BDF}[solver]
    t, row, steps = 0.0, 0, 0
    while t < t_end or row < times.size:
        motion.go_on(t)
        end = min(t_end, motion.push.end)
        run = scheme(motion.rates, t, y, end, rtol=tol, atol=1e-2 * tol)
        while run.status == "running":
            if steps >= budget:
                return BUDGET, steps, record, motion.met
            if run.step() and run.status == "failed":
                return STALLED, steps, record, motion.met
            steps += 1
            before = run.t_old, y
            dense, t, y = run.dense_output(), run.t, run.y
            if not events:
                motion.look(before, t, y)
            ended = motion.margin(t, y) < 0.0
            if ended:
                start = run.t_old if motion.margin(run.t_old, dense(run.t_old)) > 0.0 else 0.9 * run.t_old + 0.1 * t
                root: Any = brentq(lambda at, dense=dense: motion.margin(at, dense(at)), start, t, xtol=1e-15)
                t = float(root)
                y = dense(t)
            row = _sample(motion, record, row, times, t, dense)
            if ended:
                motion.next_mode(t, y, True)
                break
        if t < t_end and t >= motion.push.end:  # the force may have jumped
            motion.go_on(t)
            if motion.mode == 0:
                motion.next_mode(t, y, False)
    return DONE, steps, record, motion.met


def _sample(motion: Motion, record: NDArray, row: int, times: NDArray, t: float, dense: Any) -> int:
    """Keep the samples up to t; the number of the next."""
    while row < times.size and times[row] <= t:
        at = times[row]
        state = dense(at)
        record[row, 0], record[row, 1:4], record[row, 6:8] = at, state[:3], state[3:]
        record[row, FA], record[row, FF] = motion.forces(at, state)[:2]
        record[row, MODE] = motion.mode_at(at, state)
        row += 1
    return row
