"""Cavities inside a pipe: gas cavities between lossless stretches as a delay equation, solved on its own."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import BarycentricInterpolator

from tline.scene.scene import Scene
from tline.solver.inside import inside
from tline.solver.simulate import simulate

Z0, DELAY, HEAD, FLOW = 2e7, 0.4, 3e5, 0.03
PLACES, GAS, ABOVE_VAPOUR = 3, 3e-4, 101_325.0 - 2339.0
STRETCH = DELAY / (PLACES + 1)
END = 16 * STRETCH
HEIGHT, WEIGHT = 6.0, 1000 * 9.80665  # of the end
SHUT = {"shape": "ramp", "from": -FLOW, "to": 0, "at": 0, "duration": STRETCH}
POINTS = 120  # in a stretch's delay


def scene(order: int, slabs: int, cavities: dict | None, end: dict, out: dict = SHUT, **pipe) -> Scene:
    """A pipe that rises from a tank to where a flow is drawn; slabs in a stretch's delay."""
    pipe = {"nodes": ["tank", "end"], "z0": Z0, "delay": DELAY, "density": 1000} | pipe
    return Scene(
        medium="hydraulic",
        t_end=END,
        start="steady",
        lines={"pipe": pipe | ({"cavities": cavities} if cavities else {})},
        nodes={"tank": {"elevation": 0}, "end": {"elevation": HEIGHT}},
        loads={"tank": {"at": "tank", "kind": "reservoir", "pressure": HEAD}, "end": {"at": "end"} | end},
        sources={"out": {"at": "end", "kind": "flow", "value": out}},
        probes={"end": {"at": "end"}, "middle": {"line": "pipe", "position": "50 %"}},
        solver={"order": order, "slab": STRETCH / slabs},
    )


def delay_equation() -> tuple[np.ndarray, np.ndarray]:
    """Instants, and the pressure at each place and at the end.

    With volumes V, (u - back + P) V = P GAS and V' = -i; each stretch brings what left its other end a delay ago, and
    what leaves a node is 2 u less what arrived there. So in one delay after the other the waves that arrive are known.
    """
    back = WEIGHT * HEIGHT * np.arange(1, PLACES + 2) / (PLACES + 1)
    c = (1 - np.cos(np.pi * np.arange(POINTS) / (POINTS - 1))) / 2  # Chebyshev's points
    from_left = np.full((PLACES + 1, POINTS), HEAD + Z0 * FLOW)  # arriving at each place, and at the end
    from_right = np.full((PLACES + 1, POINTS), HEAD - Z0 * FLOW)  # at the tank, and at each place

    def pressure(volume):
        return ABOVE_VAPOUR * (GAS / volume - 1) + back

    volume, t, u = ABOVE_VAPOUR * GAS / (HEAD - back + ABOVE_VAPOUR), [], []
    for k in range(round(END / STRETCH)):
        drawn = -FLOW * (1 - c) if k == 0 else 0 * c
        w = np.vstack([(from_left[:-1] + from_right[1:]) / 2, from_left[-1] + Z0 * drawn])
        arriving = BarycentricInterpolator(c * STRETCH, w.T)
        z = np.append(np.full(PLACES, Z0 / 2), Z0)

        def rate(s, x, arriving=arriving, z=z):
            return -(arriving(s) - pressure(np.exp(x))) / z * np.exp(-x)

        with np.errstate(over="ignore"):  # in steps that are tried and not taken
            found = solve_ivp(rate, (0, STRETCH), np.log(volume), "DOP853", c * STRETCH, rtol=1e-12, atol=1e-13)
        volume, here = np.exp(found.y[:, -1]), pressure(np.exp(found.y).T).T
        t.append(k * STRETCH + c * STRETCH)
        u.append(here)
        right = 2 * here[:-1] - from_left[:-1]  # toward the tank, from places
        left = 2 * here[:-1] - from_right[1:]
        tank, last = 2 * HEAD - from_right[0], 2 * here[-1] - from_left[-1]
        from_left, from_right = np.vstack([tank, left]), np.vstack([right, last])
    return np.concatenate(t), np.concatenate(u, axis=1)


def test_gas_cavities_inside_are_a_delay_equation():
    """Places at heights between those of the ends, and a cavity at the end."""
    t, u = delay_equation()
    end = {"kind": "cavity", "gas_volume": GAS, "back_pressure": WEIGHT * HEIGHT}
    result = simulate(scene(6, 32, {"places": PLACES, "gas_volume": GAS}, end), record=["pipe"])
    boiling = WEIGHT * HEIGHT - ABOVE_VAPOUR
    assert u[-1].min() < 0.9 * boiling < u[-1].max() - HEAD  # it is all but vapour once
    whole = np.isclose(t % STRETCH, 0, atol=1e-9) | np.isclose(t % STRETCH, STRETCH, atol=1e-9)
    for k in range(PLACES + 1):
        seen = inside(result, "pipe").effort(t[whole], (k + 1) / (PLACES + 1))
        print(k, np.abs(seen - u[k][whole]).max() / HEAD)
    print(np.abs(result.probes["middle"].at(t[whole]).u-u[1][whole]).max()/HEAD, u.min(axis=1), u.max(axis=1))
    for o,n in ((3,8),(4,8),(4,16),(5,16),(6,16),(6,32),(8,32)):
        r = simulate(scene(o, n, {"places": PLACES, "gas_volume": GAS}, end), record=["pipe"])
        print(o,n,np.abs(r.probes["middle"].at(t[whole]).u-u[1][whole]).max()/HEAD,np.abs(r.probes["end"].at(t[whole]).u-u[-1][whole]).max()/HEAD)
