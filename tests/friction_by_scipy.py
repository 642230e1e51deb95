"""Errors of the smooth laws over their tolerance.

Random models and forces against a reference that shares nothing with the package: the laws are written out here, and
SciPy's DOP853 runs at 1e-13, with short steps for its dense output, started afresh at each reversal and each corner of
the force.
"""

from math import copysign, cos, exp, inf, pi, sin, tanh

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.integrate import DOP853
from scipy.optimize import brentq

from friction import Dahl, ElastoPlastic, LuGre, Model, Ramp, Sine, Spring, Status, Table, Tanh, Testbench, simulate

TOLS = 1e-3, 1e-5, 1e-7, 1e-9
END = 2.0  # s
COLUMNS = ("x", "v", "z", "F_a", "F_f", "W_a", "W_f")


@njit
def forces(t, y, s, p):
    """Applied force, friction, and ż; p: F_c, F_s, v_s, σ0, σ1, σ2, z_ba, ε, mass, the force's offset, slope and start,
    amplitude, angular frequency, phase, stiffness, speed.
    """
    x, v, z = y[0], y[1], y[2]
    f_a = p[9] + p[10] * (t - p[11]) + p[12] * sin(p[13] * t + p[14]) + p[15] * (p[16] * t - x)
    g = p[0] + (p[1] - p[0]) * exp(-((v / p[2]) ** 2))
    if p[7] > 0.0:
        return f_a, g * tanh(v / p[7]) + p[5] * v, 0.0
    share, limit = 1.0, g / p[3]
    if p[6] >= 0.0 and (s * z <= 0.0 or abs(z) <= p[6]):
        share = 0.0
    elif p[6] >= 0.0 and abs(z) < limit:
        share = 0.5 * (1.0 - cos(pi * (abs(z) - p[6]) / (limit - p[6])))
    rate = v - share * p[3] * s * v * z / g
    return f_a, p[3] * z + p[4] * rate + p[5] * v, rate


@njit
def rates(t, y, s, p):
    f_a, f_f, rate = forces(t, y, s, p)
    return np.array([y[1], (f_a - f_f) / p[8], rate, f_a * y[1], f_f * y[1]])


def parameters(model: Model, bench: Testbench) -> NDArray:
    def given(name: str, default: float) -> float:
        return getattr(model, name, default)

    spring = (bench.spring.stiffness, bench.spring.speed) if bench.spring else (0.0, 0.0)
    return np.array([
        given("F_c", 1.0), given("F_s", given("F_c", 1.0)), given("v_s", 1.0), given("sigma0", 1.0),
        given("sigma1", 0.0), given("F_v", given("sigma2", 0.0)), given("z_ba", -1.0), given("epsilon", -1.0),
        bench.mass, 0.0, 0.0, 0.0, *bench.force.sine, *spring,
    ])  # fmt: skip


def reference(model: Model, bench: Testbench, times: NDArray) -> NDArray:
    """Columns x, v, z, F_a, F_f, W_a, W_f at the times; the last is the end."""
    p, found = parameters(model, bench), np.empty((times.size, 7))
    starts, values, slopes = bench.force.pieces()
    longest = min(1e-3, 5.0 / p[3]) if p[7] < 0.0 else 1e-3
    t, y, row, stop = 0.0, bench.start, 0, 0.0
    while row < times.size:
        i = np.searchsorted(starts, t, side="right") - 1
        p[9], p[10], p[11] = values[i], slopes[i], starts[i]
        end = min(times[-1], starts[i + 1] if i + 1 < starts.size else inf)
        f_a, f_f, _ = forces(t, y, 1.0, p)
        s = copysign(1.0, y[1] if y[1] != 0.0 else f_a - f_f if f_a != f_f else p[10] + p[15] * p[16] + p[12])
        run = DOP853(lambda t, y, s=s: rates(t, y, s, p), t, y, end, rtol=1e-13, atol=1e-17, max_step=longest)
        begun = y[1] != 0.0
        while run.status == "running":
            run.step()
            dense, stop = run.dense_output(), run.t
            turned = begun and s * run.y[1] <= 0.0
            if turned:
                stop = brentq(lambda at, dense=dense: dense(at)[1], run.t_old, run.t, xtol=1e-16)
            begun = begun or s * run.y[1] > 0.0
            while row < times.size and times[row] <= stop:
                at = dense(times[row])
                found[row, :3], found[row, 3:5], found[row, 5:] = at[:3], forces(times[row], at, s, p)[:2], at[3:]
                row += 1
            t, y = stop, dense(stop)
            if turned:
                y[1] = 0.0
                break
    return found


def random_case(rng: np.random.Generator) -> tuple[Model, Testbench]:
    F_c, v_s, s0 = rng.uniform(0.5, 2.0), 10.0 ** rng.uniform(-2.5, 0.0), 10.0 ** rng.uniform(2.0, 5.0)
    F_s, s1, s2 = (
        F_c * rng.uniform(1.0, 1.5),
        float(rng.choice([0.0, rng.uniform(0.0, 2.0) * s0**0.5])),
        0.5 * rng.random(),
    )
    model = (
        LuGre(F_c, F_s, v_s, s0, s1, s2),
        Dahl(F_c, s0),
        ElastoPlastic(F_c, F_s, v_s, s0, s1, s2, rng.uniform(0.2, 0.95) * F_c / s0),
        Tanh(F_c, F_s, s2, v_s, v_s * 10.0 ** rng.uniform(-2.0, -0.5)),
    )[rng.integers(4)]
    mass, v0, n = 10.0 ** rng.uniform(-0.5, 0.7), float(rng.choice([0.0, rng.normal()])), 16
    bench = (
        Testbench(Ramp(2.0 * rng.normal(), 0.3 * rng.normal()), mass, v0),
        Testbench(Sine(rng.uniform(0.5, 4.0), 10.0 ** rng.uniform(-0.5, 0.7)), mass, v0),
        Testbench(Ramp(0.0), mass, 0.0, Spring(10.0 ** rng.uniform(0.5, 2.5), rng.uniform(0.02, 0.5))),
        Testbench(Table(np.linspace(0.0, END, n), 2.0 * rng.normal(size=n)), mass, v0),
    )[rng.integers(4)]
    return model, bench


def largest_errors(
    model: Model, bench: Testbench, exact: NDArray, times: NDArray, tol: float, method: str | None = None
) -> tuple[NDArray, float]:
    """Largest true error of each column relative to its largest value, NaN if the run says it failed; the estimate."""
    run = simulate(model, bench, END, method, tol=tol, times=times)
    if run.status is not Status.DONE:
        return np.full(len(COLUMNS), np.nan), np.nan
    got = np.column_stack([getattr(run, name) for name in COLUMNS])
    sizes = np.maximum(np.abs(exact).max(axis=0), np.finfo(float).tiny)
    return np.abs(got - exact).max(axis=0) / sizes, max(run.errors[name] for name in COLUMNS)
