"""An orifice that lets something flow at once, from rest, behind two pipes whose delays no slab divides, exactly."""

from functools import lru_cache
from math import sqrt
from typing import NamedTuple

import numpy as np
import pytest

import tline as tl

Z, T, C, SUCTION = (2e7, 5e7), (0.0597, 0.178177), 2e-5, -3e4  # Pa s/m³, s, m³/s/√Pa, Pa


def into_suction(w: float) -> float:
    """Effort at the orifice behind a wave: (w - u)/Z = C sqrt(u - SUCTION), in the closed form of the quadratic."""
    half = Z[1] * C / 2
    root = sqrt(half**2 + abs(w - SUCTION)) - half
    return SUCTION + (root**2 if w > SUCTION else -(root**2))


class Seen(NamedTuple):
    """Efforts, and the waves that leave the closed end, the joint to either side, and the orifice."""

    joint: float
    orifice: float
    closed_out: float
    joint_out: tuple[float, float]
    orifice_out: float


@lru_cache(None)
def seen(t: float, i: int, j: int) -> Seen:
    """What is there i delays of one pipe and j of the other before t."""
    if t - i * T[0] - j * T[1] < 0:
        return Seen(0.0, 0.0, 0.0, (0.0, 0.0), 0.0)
    one, other = seen(t, i + 1, j), seen(t, i, j + 1)  # a delay of either pipe before
    into = one.closed_out, other.orifice_out
    joint = (into[0] / Z[0] + into[1] / Z[1]) / (1 / Z[0] + 1 / Z[1])
    closed, w = one.joint_out[0], other.joint_out[1]  # a closed end sends back what arrives
    orifice = into_suction(w)
    return Seen(joint, orifice, closed, (2 * joint - into[0], 2 * joint - into[1]), 2 * orifice - w)


@pytest.mark.parametrize("tol", [1e-3, 1e-6, 1e-9])
def test_what_flows_at_once_is_a_front(tol):
    lines = {f"l{k}": {"nodes": [f"n{k}", f"n{k + 1}"], "z0": Z[k], "delay": T[k]} for k in range(2)}
    orifice = {"at": "n2", "kind": "orifice", "flow": C, "pressure_drop": 1.0, "back_pressure": SUCTION}
    probes = {"joint": {"at": "n1", "line": "l1"}, "orifice": {"at": "n2"}}
    result = tl.simulate(
        {"medium": "hydraulic", "t_end": 1.0, "lines": lines, "loads": {"valve": orifice}, "probes": probes}, tol=tol
    )
    assert result.accuracy.met
    t = np.random.default_rng(1).uniform(0.0, 1.0, 200)
    for name in ("joint", "orifice"):
        exact = np.array([getattr(seen(float(each), 0, 0), name) for each in t])
        error = np.abs(result.probes[name].at(t).u - exact).max() / np.abs(exact).max()
        assert error <= 3 * max(tol, result.accuracy.worst)
