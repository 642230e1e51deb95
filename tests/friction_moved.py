"""Friction under a prescribed velocity, by laws written out here and SciPy's integrators, from reversal to reversal."""

from collections.abc import Callable
from itertools import pairwise
from math import cos, exp, pi, tanh

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from friction import Model

Velocity = Callable[[float], float]


def rate(model: Model, s: float, v: float, z: float) -> float:
    """ż of LuGre, Dahl and the elasto-plastic law."""
    f_c, f_s = model.F_c, getattr(model, "F_s", model.F_c)
    limit = (f_c + (f_s - f_c) * exp(-((v / getattr(model, "v_s", 1.0)) ** 2))) / model.sigma0
    share, z_ba = 1.0, getattr(model, "z_ba", None)
    if z_ba is not None and (s * z <= 0.0 or abs(z) <= z_ba):
        share = 0.0
    elif z_ba is not None and abs(z) < limit:
        share = 0.5 * (1.0 - cos(pi * (abs(z) - z_ba) / (limit - z_ba)))
    return v - share * s * v * z / limit


def reversals(velocity: Velocity, t_end: float, corners: tuple[float, ...] = ()) -> NDArray:
    """0, the end, corners, and zeros between which the velocity keeps its sign; found on a grid of 20,000."""
    t = np.linspace(0.0, t_end, 20001)[:-1] + 1e-9
    v = np.array([velocity(float(at)) for at in t])
    changes = np.flatnonzero(v[1:] * v[:-1] < 0.0)
    jump = [min(abs(corner - t[k]) for corner in (*corners, -1.0)) < 2.0 * (t[1] - t[0]) for k in changes]
    roots = [brentq(velocity, t[k], t[k + 1], xtol=1e-16) for k, one in zip(changes, jump, strict=True) if not one]
    return np.unique([0.0, t_end, *corners, *roots])


def force_by_scipy(
    model: Model,
    velocity: Velocity,
    times: NDArray,
    corners: tuple[float, ...] = (),
    tol: float = 1e-12,
    z0: float = 0.0,
) -> NDArray:
    """z and F_f at times, shape (n, 2); the last is the end. At rest under a static law the force is NaN."""
    found, z = np.full((times.size, 2), np.nan), z0
    v = np.array([velocity(float(t)) for t in times])
    if not hasattr(model, "sigma0"):
        f_s, v_s = getattr(model, "F_s", model.F_c), getattr(model, "v_s", 1.0)
        g = model.F_c + (f_s - model.F_c) * np.exp(-((v / v_s) ** 2))
        way = np.array([tanh(at / model.epsilon) for at in v]) if hasattr(model, "epsilon") else np.sign(v)
        force = g * way + model.F_v * v
        return np.column_stack(
            [0.0 * v, np.where(way == 0.0, np.nan, force) if not hasattr(model, "epsilon") else force]
        )
    edges = reversals(velocity, float(times[-1]), corners)
    for begin, end in pairwise(edges):
        s = float(np.sign(velocity(0.5 * (begin + end))))
        inside = np.flatnonzero((times > begin) & (times <= end)) if begin else np.flatnonzero(times <= end)
        at = np.append(times[inside], end)[: inside.size + (not inside.size or times[inside[-1]] < end)]
        method = "DOP853" if tol < 1e-9 else "LSODA"
        longest = min(end - begin, 3e-3 if tol < 1e-10 else 1e-2)
        run = solve_ivp(
            lambda t, y, s=s, end=end: [rate(model, s, velocity(min(t, end - 1e-15)), y[0])],
            (begin, end), [z], method, at, rtol=tol, atol=1e-3 * tol * model.F_c / model.sigma0, max_step=longest,
        )  # fmt: skip
        assert run.success, run.message
        found[inside, 0], z = run.y[0, : inside.size], run.y[0, -1]
    rates = [rate(model, 1.0 if at >= 0.0 else -1.0, at, z) for at, z in zip(v, found[:, 0], strict=True)]
    viscous = getattr(model, "sigma2", 0.0) * v
    found[:, 1] = model.sigma0 * found[:, 0] + getattr(model, "sigma1", 0.0) * np.array(rates) + viscous
    return found
