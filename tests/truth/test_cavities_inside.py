"""Cavities inside a pipe: gas cavities between lossless stretches as a delay equation, solved on its own."""

from pathlib import Path

import numpy as np
import pytest
from one_line import from_tank
from scipy.integrate import solve_ivp
from scipy.interpolate import BarycentricInterpolator

from tline import Scene, simulate
from tline.scene.file import read_scene
from tline.solver.description.description import describe
from tline.solver.description.resolution import Resolution
from tline.solver.result.dense_output import inside
from tline.solver.run import run

Z0, DELAY, HEAD, FLOW = 2e7, 0.4, 3e5, 0.03
PLACES, GAS, ABOVE_VAPOUR = 3, 3e-4, 101_325.0 - 2339.0
STRETCH = DELAY / (PLACES + 1)
END = 12 * STRETCH
HEIGHT, WEIGHT = 6.0, 1000 * 9.80665  # of the end
SHUT = {"shape": "ramp", "from": -FLOW, "to": 0, "at": 0, "duration": STRETCH}
POINTS = 120  # in a stretch's delay


def scene(order: int, slabs: int, cavities: dict | None, end: dict, out: dict = SHUT) -> Scene:
    """A pipe that rises from a tank to where a flow is drawn; slabs in a stretch's delay."""
    pipe = {"z0": Z0, "delay": DELAY, "density": 1000} | ({"cavities": cavities} if cavities else {})
    more = {
        "nodes": {"tank": {"elevation": 0}, "end": {"elevation": HEIGHT}},
        "sources": {"out": {"at": "end", "kind": "flow", "value": out}},
        "probes": {"end": {"at": "end"}, "middle": {"line": "pipe", "position": "50 %"}},
        "solver": {"order": order, "slab": STRETCH / slabs},
    }
    return from_tank(END, pipe, HEAD, {"end": {"at": "end"} | end}, **more)


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
    end = {"kind": "cavity", "gas_volume": GAS}
    result = simulate(scene(6, 32, {"places": PLACES, "gas_volume": GAS}, end), record=["pipe"])
    assert u[-1].min() < 0.8 * (WEIGHT * HEIGHT - ABOVE_VAPOUR)  # next to vapour for a while
    whole = np.isclose((t + 1e-9) % STRETCH, 0, atol=2e-9)
    for k in range(PLACES + 1):
        seen = inside(result, "pipe").effort(t[whole], (k + 1) / (PLACES + 1))
        assert np.abs(seen - u[k][whole]).max() < 1e-9 * HEAD  # so far it is from itself with twice the points
    assert result.probes["middle"].at(t[whole]).u == pytest.approx(u[1][whole], abs=1e-9 * HEAD)


def test_without_cavitation_it_is_the_uncut_line():
    """Vapour alone, and pressures above it."""
    gentle = {"shape": "ramp", "from": -0.005, "to": 0, "at": "33 ms", "duration": "71 ms"}
    cut, whole = (
        simulate(scene(4, 8, cavities, {"kind": "closed"}, gentle), record=["pipe"])
        for cavities in ({"places": PLACES}, None)
    )
    assert np.ptp(whole.probes["middle"].u) > 0.3 * HEAD
    for name in whole.probes:
        assert np.abs(cut.probes[name].u - whole.probes[name].u).max() < 1e-12 * HEAD
        assert Z0 * np.abs(cut.probes[name].y - whole.probes[name].y).max() < 1e-12 * HEAD
    t = np.linspace(0, END, 101)
    for share in (0.0, 0.2, 0.5, 0.77, 1.0):
        seen, expected = (inside(result, "pipe").effort(t, share) for result in (cut, whole))
        assert np.abs(seen - expected).max() < 1e-12 * HEAD


@pytest.mark.parametrize("gas", [None, 1e-7, 1e-10])
@pytest.mark.parametrize(("order", "slabs"), [(1, 1), (3, 2), (5, 7)])
def test_cavities_add_no_energy(gas, order, slabs):
    """Whatever the slab: the ledger closes, and cavities take; so little gas holds next to nothing at first."""
    cavities = {"places": PLACES} | ({"gas_volume": gas} if gas else {})
    end = {"kind": "cavity", "gas_volume": gas} if gas else {"kind": "vapour cavity"}
    ledger = simulate(scene(order, slabs, cavities, end), ledger=True).ledger
    assert ledger is not None
    assert ledger.residual < 1e-12
    assert ledger.of("lines.pipe.cavities").taken + ledger.of("loads.end").taken > 0


def test_the_largest_pressure_measured_by_bergant_and_simpson():
    """1015 kPa, absolute, as J. He, C. Li, Y. Guo (Processes 13 (2025) 3510) quote it; docs/elements.md says more."""
    given = read_scene(Path(__file__).parents[2] / "scenes" / "column_separation.toml")
    probe = simulate(given.with_changes(t_end="0.2 s")).probes["valve"]
    on_the_wall = probe.u + 101_325 - 999.1 * 9.80665 * 2.03
    assert on_the_wall.max() == pytest.approx(1015e3, rel=0.05)
    assert on_the_wall.max() > on_the_wall[probe.t < 0.05].max() * 1.3  # more than Joukowsky's rise


@pytest.mark.parametrize("parted", [{}, {"cavities": {"places": 7}}, {"probe": "37 %"}])
@pytest.mark.parametrize("acting", [{}, {"length": 300}])
def test_local_losses_are_taken_once_however_a_pipe_is_parted(parted, acting):
    """Torricelli with losses: drop = (f L/d + K) ρ v²/2."""
    d, f, K, length, drop = 0.25, 0.02, 40.0, 900.0, 3e5
    pipe = {"nodes": ["a", "b"], "length": length, "diameter": d, "wave_speed": 1000, "density": 1000}
    pipe |= {"friction": {"kind": "darcy", "factor": f, "minor_loss": K} | acting}
    pipe |= {"cavities": parted["cavities"]} if "cavities" in parted else {}
    probes = {"b": {"at": "b"}} | ({"in": {"line": "p", "position": parted["probe"]}} if "probe" in parted else {})
    tanks = {
        "a": {"at": "a", "kind": "reservoir", "pressure": 4e5},
        "b": {"at": "b", "kind": "reservoir", "pressure": 4e5 - drop},
    }
    given = {"lines": {"p": pipe}, "loads": tanks, "probes": probes, "solver": {"order": 2, "slab": 0.9 / 8 / 3}}
    result = simulate(Scene(medium="hydraulic", t_end=0.1, start="steady", **given))
    v = np.sqrt(2 * drop / 1000 / (f * acting.get("length", length) / d + K))
    assert np.abs(result.probes["b"].y / (v * np.pi * d**2 / 4) - 1).max() < 1e-9


def test_beside_friction_slab_ends_are_as_told():
    """Diamonds against cells on slabs 32 times as narrow, which share neither friction nor nodes' slabs."""
    pipe = {"length": 1000, "diameter": 0.3, "wave_speed": 1000, "density": 1000}
    pipe |= {"friction": {"kind": "darcy", "factor": 0.03}}
    out = {"at": "end", "kind": "flow", "value": {"shape": "ramp", "from": -0.08, "to": 0, "duration": 0.5}}
    scene = from_tank(6, pipe, 3e5, {"end": {"at": "end", "kind": "vapour cavity"}}, sources={"out": out})
    result = simulate(scene, tol=1e-2)
    assert result.accuracy
    assert result.accuracy.at_slab_ends < 1e-2
    slab = result.probes["end"].slabs.width / 32
    plain = run(describe(scene), Resolution(3, slab, diamonds=False)).probes["end"]
    found, wanted = result.probes["end"].at_slab_ends.u, plain.at_slab_ends.u[::32]
    n = min(len(found), len(wanted))
    assert wanted.min() < 2339 - 101_325 + 1  # it boils
    assert np.abs(found[:n] - wanted[:n]).max() < 1e-2 * np.abs(wanted).max()
