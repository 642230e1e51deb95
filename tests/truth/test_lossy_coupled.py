"""Coupled conductors with losses: pairs against inverse Laplace, others against matrix exponentials of their line."""

import numpy as np
import pytest
from scipy.linalg import expm

from tline import Scene, simulate
from tline.frequency.ports import scattering_parameters
from tline.frequency.response import respond
from tline.loss import ConstantLoss, Law, LossyLine, SkinEffect
from tline.solver.description.description import describe
from tline.solver.description.resolution import Resolution
from tline.solver.run import run
from tline.study.reference.lossy import lossy_response

NS, LENGTH = 1e-9, 0.2
EVEN, ODD = (60.0, 1.1 * NS, 14.0), (40.0, 0.9 * NS, 10.0)
SOURCE, LOAD = 30.0, 75.0
STEP = {"shape": "step", "to": 1}
R = np.diag([9.0, 20.0, 4.0]) + 1.5


def mode(z0: float, delay: float, resistance: float) -> dict:
    return {"z0": z0, "delay": delay, "resistance": resistance}


def driver(at: str, value: object) -> dict:
    return {"at": at, "kind": "voltage", "resistance": SOURCE, "value": value}


def resistor(at: str, ohm: float) -> dict:
    return {"at": at, "kind": "resistor", "resistance": ohm}


def pair(losses: tuple[dict, dict]) -> Scene:
    line = {"nodes1": ["a1", "a2"], "nodes2": ["b1", "b2"], "length": LENGTH, "even": losses[0], "odd": losses[1]}
    return Scene(
        medium="electrical", t_end="12 ns", lines={"pair": line},
        sources={"one": driver("a1", STEP), "two": driver("a2", 0)},
        loads={at: resistor(at, LOAD) for at in ("b1", "b2")},
        probes={at: {"at": at} for at in ("a1", "a2", "b1", "b2")},
    )  # fmt: skip


def exact(t: np.ndarray, end: str, series: list[Law]) -> tuple[np.ndarray, np.ndarray]:
    """Voltages and currents of both conductors between symmetric ends: half the sum and difference of two lines."""
    found = []
    for (z0, delay, _), law in zip((EVEN, ODD), series, strict=True):
        line = LossyLine(law + ConstantLoss(0, z0 * delay / LENGTH), ConstantLoss(0, delay / z0 / LENGTH), LENGTH)
        x = LENGTH if end == "b" else 0.0
        seen = lossy_response(line, [repr(float(each)) for each in t], x, source=SOURCE, load=LOAD, digits=13)
        found.append(np.array([seen.efforts, seen.flows]))
    even, odd = found
    return (even + odd) / 2, (even - odd) / 2


def between_fronts(t: np.ndarray) -> np.ndarray:
    """Instants at which no step passes an end."""
    places = t[:, None] / np.array([EVEN[1], ODD[1]])
    return t[(np.abs(places - places.round()) > 1e-3).all(axis=1)]


@pytest.mark.parametrize("tol", [1e-5, 1e-8, 1e-11])
def test_a_step_into_a_pair_with_resistance(tol):
    result = simulate(pair((mode(*EVEN), mode(*ODD))), tol=tol)
    assert result.accuracy.met
    t = between_fronts(result.t[4:-1:9])
    for end in "ab":
        both = exact(t, end, [ConstantLoss(EVEN[2]), ConstantLoss(ODD[2])])
        for conductor, (u, y) in enumerate(both, 1):
            probe = result.probes[f"{end}{conductor}"].at(t)
            assert np.abs(probe.u - u).max() < tol
            assert np.abs(probe.y - y).max() < tol / ODD[0]


def test_skin_effect_of_one_mode_a_slab_behind_the_front():
    """Circuits of 1e-5 over the band."""
    z0, delay, _ = ODD
    odd = {"z0": z0, "delay": delay, "skin": {"resistance": "10 ohm/m", "frequency": "100 MHz"}}
    result = run(describe(pair((mode(*EVEN), odd))), Resolution(4, 0.1 * NS, fit=1e-5))
    t = result.t[1:]
    behind = np.array([[(each - delay) % (2 * delay) for delay in (EVEN[1], ODD[1])] for each in t + 1e-15])
    t = t[(behind > 0.28 * NS).all(axis=1) & (t > 1.2 * NS)][::11]
    series = [ConstantLoss(EVEN[2]), SkinEffect(0, 10 / np.sqrt(np.pi * 1e8))]
    for probe, (u, _) in zip(("b1", "b2"), exact(t, "b", series), strict=True):
        assert result.probes[probe].at(t).u == pytest.approx(u, abs=1e-4)


def unlike(value: object, t_end: str) -> tuple[Scene, dict[str, np.ndarray], np.ndarray]:
    """Three unlike conductors in an insulation all alike, with any resistances; matrices, and conductances at ends."""
    C = np.array([[1.2, -0.3, -0.1], [-0.3, 1.4, -0.35], [-0.1, -0.35, 1.1]]) * 1e-10
    L = np.linalg.inv(C) / 2e8**2
    near, far = ["a1", "a2", "a3"], ["b1", "b2", "b3"]
    ohms = np.array([[35.0, 120.0, 60.0], [80.0, 45.0, 300.0]])
    matrices = {"inductance": L, "capacitance": C, "resistance": R, "conductance": C * 3e7}
    line = {"nodes1": near, "nodes2": far, "length": LENGTH, **{key: M.tolist() for key, M in matrices.items()}}
    loads = {at: resistor(at, ohm) for at, ohm in zip(near[1:] + far, ohms.ravel()[1:].tolist(), strict=True)}
    source = {"at": "a1", "kind": "voltage", "resistance": ohms[0, 0], "value": value}
    probes = {at: {"at": at} for at in near + far}
    made = Scene(medium="electrical", t_end=t_end, lines={"w": line}, sources={"s": source}, loads=loads, probes=probes)
    return made, matrices, 1 / ohms


def at_ends(Z: np.ndarray, Y: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Voltages of the conductors at end 1, then end 2, per volt of the source, by the exponential of the line."""
    k, nothing = len(Z), np.zeros_like(Z)
    chain = expm(-LENGTH * np.block([[nothing, Z], [Y, nothing]]))
    current = np.vstack([np.eye(k), -np.diag(ends[0])])  # (v, i) at end 1 for v, the source silent
    driven = np.concatenate([np.zeros(k), [ends[0, 0]], np.zeros(k - 1)])
    balance = np.hstack([-np.diag(ends[1]), np.eye(k)]) @ chain  # no current is left at end 2
    v = np.linalg.solve(balance @ current, -balance @ driven)
    return np.concatenate([v, (chain @ (current @ v + driven))[:k]])


def test_direct_current_in_unlike_conductors_is_that_of_the_resistors():
    """Six modes of a chain of resistors; the transient has died away by 60 ns."""
    scene, matrices, ends = unlike(STEP, "60 ns")
    result = simulate(scene, tol=1e-9)
    found = at_ends(matrices["resistance"], matrices["conductance"], ends)
    assert [probe.u[-1] for probe in result.probes.values()] == pytest.approx(found, abs=1e-8)


def test_a_sine_in_unlike_conductors_settles_to_the_exponential_of_the_line():
    f = 0.4e9
    value = {"shape": "sine", "amplitude": 1, "frequency": f}
    scene, matrices, ends = unlike(value, "40 ns")
    result = simulate(scene, tol=1e-9)
    t = result.t[-round(2.5e-9 / result.resolution.h) :]  # a period
    basis = np.stack([np.sin(2 * np.pi * f * t), np.cos(2 * np.pi * f * t)], axis=1)
    s = 2j * np.pi * f
    Z = matrices["resistance"] + s * matrices["inductance"]
    exactly = at_ends(Z, matrices["conductance"] + s * matrices["capacitance"], ends)
    for probe, value in zip(result.probes.values(), exactly, strict=True):
        sine, cosine = np.linalg.lstsq(basis, probe.at(t).u)[0]
        assert abs(sine + 1j * cosine - value) < 1e-8


def test_a_pair_whose_losses_mix_modes_over_frequency():
    """By the matrix exponential of its length: S at its ends, both modes, and what a source makes at a conductor."""
    L, C = np.array([[300e-9, 60e-9], [60e-9, 380e-9]]), np.array([[140e-12, -22e-12], [-22e-12, 105e-12]])
    R, K = np.array([[8.0, 1], [1, 3]]), np.array([[6e-4, 1e-4], [1e-4, 3e-4]])
    s, z0 = 2j * np.pi * np.array([1e6, 3.3e8, 2e9]), 50.0
    skin = {"resistance": (K * np.sqrt(np.pi * 1e9)).tolist(), "frequency": 1e9, "added": True}
    table = {
        "medium": "electrical", "t_end": 1e-9, "probes": {"b2": {"at": "b2"}},
        "lines": {"pair": {
            "nodes1": ["a1", "a2"], "nodes2": ["b1", "b2"], "length": 0.3, "inductance": L.tolist(),
            "capacitance": C.tolist(), "resistance": R.tolist(), "skin": skin,
        }},
    }  # fmt: skip
    driven = {"sources": {"s": driver("a1", 1)}, "loads": {at: resistor(at, LOAD) for at in ("a2", "b1", "b2")}}
    ports, zero = ["a1", "a2", "b1", "b2"], np.zeros((2, 2))
    S, seen = scattering_parameters(Scene(**table), ports, s, z0), respond(Scene(**table, **driven), s)["b2"]
    mixes = np.array([[1, -1, 0, 0], [0, 0, 1, -1], [1, 1, 0, 0], [0, 0, 1, 1]]) / np.sqrt(2)
    for k, at in enumerate(s):
        whole = expm(0.3 * np.block([[zero, -(R + K * np.sqrt(at) + at * L)], [-at * C, zero]]))
        A, B = whole[:2, :2], whole[:2, 2:]  # u2 = A u1 + B y1
        Y = np.block([[-np.linalg.solve(B, A), np.linalg.inv(B)], [np.linalg.inv(B), -np.linalg.solve(B, A)]])
        expected = np.linalg.solve(np.eye(4) + z0 * Y, np.eye(4) - z0 * Y)
        np.testing.assert_allclose(S[k], expected, atol=1e-9)
        np.testing.assert_allclose(S.mixed()[k], mixes @ expected @ mixes.T, atol=1e-9)
        u = np.linalg.solve(Y + np.diag([1 / SOURCE, *3 * [1 / LOAD]]), [1 / SOURCE, 0, 0, 0])[3]
        np.testing.assert_allclose([seen.u[k], seen.y[k]], [u, u / LOAD], atol=1e-9)
    assert S.mixed().z0 == (100, 100, 25, 25)
