"""The swing of an air vessel at the end of a rigid column, against the quadrature of its energy."""

import numpy as np
import pytest
from scipy.optimize import brentq

from tline import Scene, simulate

AIR, P0, P1, V0 = 101_325.0, 3e5, 5e5, 0.5
INERTIA = 1000 * 400 / 0.05  # density·length/area of the column, kg/m⁴


@pytest.mark.parametrize("n", [1.0, 1.2, 1.4])
def test_a_polytropic_swing_has_the_extreme_and_the_period_of_its_energy(n):
    """I·q²/2 is what the pressure behind the column has done beyond the gas's; q vanishes at both ends of the swing."""
    scene = Scene(
        medium="hydraulic",
        t_end=16,
        start="steady",
        lines={"aside": {"nodes": ["lake", "dead"], "z0": 1e9, "delay": 0.05}},
        links={"column": {"nodes": ["lake", "vessel"], "kind": "inductor", "inductance": INERTIA}},
        sources={"lake": {"at": "lake", "kind": "pressure", "value": {"shape": "step", "from": P0, "to": P1}}},
        loads={"vessel": {"at": "vessel", "kind": "air vessel", "gas_volume": V0, "gas_pressure": P0, "exponent": n}},
        probes={"vessel": {"at": "vessel"}},
    )

    def gas(v: float) -> float:
        return (P0 + AIR) * (V0 / v) ** n - AIR

    def work(v: float) -> float:
        squeezed = V0 * np.log(V0 / v) if n == 1 else V0**n * (V0 ** (1 - n) - v ** (1 - n)) / (1 - n)
        return (P1 + AIR) * (V0 - v) - (P0 + AIR) * squeezed

    least = brentq(work, 0.2 * V0, 0.9 * V0, xtol=1e-15)
    middle, half = (V0 + least) / 2, (V0 - least) / 2  # v = middle + half·cos(a) takes the root's poles away
    x, weights = np.polynomial.legendre.leggauss(100)
    angles = np.pi / 2 * (1 + x)
    flows = np.sqrt([2 * work(v) / INERTIA for v in middle + half * np.cos(angles)])
    swing = float(np.pi / 2 * weights @ (half * np.sin(angles) / flows))
    probe = simulate(scene, tol=1e-8).probes["vessel"]
    t = swing + np.linspace(-0.05, 0.05, 2001)
    near = probe.at(t).u
    assert near.max() == pytest.approx(gas(least), rel=1e-6)
    assert t[near.argmax()] == pytest.approx(swing, abs=1e-3)
    assert probe.at(2 * swing).u == pytest.approx(P0, rel=1e-5)
