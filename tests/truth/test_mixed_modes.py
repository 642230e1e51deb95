"""Coupled conductors whose losses mix the modes, against matrix functions of their line, transformed by damped FFT."""

import numpy as np
import pytest
from scipy.linalg import expm

from tline import InputError, Scene, simulate

RISE, T_END, SAMPLES = 0.3e-9, 5e-9, 1 << 16
NODES, TERMINATIONS = ("a1", "a2", "b1", "b2"), (50.0, 60.0, 75.0, 40.0)
LINE = {
    "nodes1": ["a1", "a2"], "nodes2": ["b1", "b2"], "length": 0.2,
    "inductance": [[3.2e-7, 0.6e-7], [0.6e-7, 2.6e-7]], "capacitance": [[1.2e-10, -0.2e-10], [-0.2e-10, 1.5e-10]],
}  # fmt: skip
LOSSES = {
    "resistance": {"resistance": [[20, 3], [3, 5]]},
    "conductance": {"conductance": [[4e-3, -1e-3], [-1e-3, 2e-3]]},
    "both": {"resistance": [[20, 0], [0, 0]], "conductance": [[1e-3, 0], [0, 5e-3]]},
}


def scene(losses: dict, **more) -> Scene:
    return Scene(
        medium="electrical", t_end=T_END, lines={"pair": LINE | losses},
        sources={"s": {"at": "a1", "kind": "voltage", "resistance": TERMINATIONS[0],
                       "value": {"shape": "ramp", "to": 1, "duration": RISE}}},
        loads={at: {"at": at, "kind": "resistor", "resistance": ohm}
               for at, ohm in zip(NODES[1:], TERMINATIONS[1:], strict=True)},
        probes={at: {"at": at} for at in NODES}, **more,
    )  # fmt: skip


def exact(losses: dict) -> tuple[np.ndarray, np.ndarray]:
    """Instants and voltages of all nodes; what the transform wraps around is exp(-25) of itself."""
    period, damping = 2 * T_END, 12.5 / T_END
    s = damping + 2j * np.pi * np.fft.rfftfreq(SAMPLES, period / SAMPLES)
    L, C = (np.array(LINE[key]) for key in ("inductance", "capacitance"))
    R, G = (np.array(losses.get(key, np.zeros((2, 2)))) for key in ("resistance", "conductance"))
    Z, Y = R + s[:, None, None] * L, G + s[:, None, None] * C
    if skin := losses.get("skin"):
        K = np.array(skin["resistance"]) / np.sqrt(np.pi * 1e9)
        half = np.linalg.cholesky(L)  # any factor of L: the root of a square is the same matrix in all of them
        back = np.linalg.inv(half)
        squares = (back @ R @ back.T) @ (back @ R @ back.T) + (back @ K @ back.T) @ (back @ K @ back.T) * s[
            :, None, None
        ]
        trace, det = np.trace(squares, axis1=1, axis2=2), np.sqrt(np.linalg.det(squares))
        root = (squares + det[:, None, None] * np.eye(2)) / np.sqrt(trace + 2 * det)[:, None, None]  # Cayley, Hamilton
        Z = (K * np.sqrt(s)[:, None, None] if skin["added"] else half @ root @ half.T - R) + Z
    squares, V = np.linalg.eig(Z @ Y)
    gamma = np.sqrt(squares)
    through = np.exp(-gamma * LINE["length"])

    def function(values):
        return np.linalg.solve(Z, V @ (values[:, :, None] * np.linalg.inv(V)))

    own, other = (function(gamma * x / (1 - through**2)) for x in (1 + through**2, -2 * through))
    admittance = np.block([[own, other], [other, own]]) + np.diag(1 / np.array(TERMINATIONS))
    driven = np.zeros((len(s), 4, 1), complex)
    driven[:, 0, 0] = (1 - np.exp(-s * RISE)) / (s * s * RISE) / TERMINATIONS[0]
    t = np.arange(SAMPLES) * period / SAMPLES
    seen = np.fft.irfft(np.linalg.solve(admittance, driven)[:, :, 0], SAMPLES, axis=0) * SAMPLES / period
    return t[: SAMPLES // 2], (seen * np.exp(damping * t)[:, None])[: SAMPLES // 2]


@pytest.mark.parametrize("name", LOSSES)
def test_a_pair_is_what_its_matrices_say(name):
    t, voltages = exact(LOSSES[name])
    result = simulate(scene(LOSSES[name]), tol=3e-3)
    assert result.accuracy.met
    assert "its losses mix the modes" in result.notes[0]
    for at, seen in zip(NODES, voltages.T, strict=True):
        off = np.abs(result.probes[at].at(t[7::13]).u - seen[7::13]).max() / np.abs(seen).max()
        assert off < 3e-3
        assert off < 3 * result.accuracy.inside[at].u + 2e-4  # the transform cuts off what is faster than 1.5 ps


def test_a_differential_probe_sees_the_end_that_it_names():
    probes = {
        "d": {"at": "b1", "beside": "b2", "mode": "differential", "line": "pair"},
        "b1": {"at": "b1"},
        "b2": {"at": "b2"},
    }
    result = simulate(scene(LOSSES["resistance"]).with_changes(probes=probes), tol=1e-2)
    t = np.linspace(0, T_END, 101)
    one, other, both = (result.probes[name].at(t).u for name in ("b1", "b2", "d"))
    assert both == pytest.approx(one - other, abs=1e-12)


@pytest.mark.parametrize("added", [True, False])
def test_a_skin_effect_that_mixes_modes(added):
    losses = LOSSES["resistance"] | {"skin": {"resistance": [[30, 4], [4, 18]], "frequency": "1 GHz", "added": added}}
    t, voltages = exact(losses)
    result = simulate(scene(losses), tol=1e-3)
    assert result.accuracy.met
    for at, seen in zip(NODES, voltages.T, strict=True):
        off = np.abs(result.probes[at].at(t[7::13]).u - seen[7::13]).max() / np.abs(seen).max()
        assert off < 3 * result.accuracy.inside[at].u + 2e-4


@pytest.mark.parametrize("name", LOSSES)
def test_slabs_by_hand(name):
    t, voltages = exact(LOSSES[name])
    result = simulate(scene(LOSSES[name], solver={"order": 4, "slab": "4.6 ps"}))
    for at, seen in zip(NODES, voltages.T, strict=True):
        assert result.probes[at].at(t[7::13]).u == pytest.approx(seen[7::13], abs=2e-3 * np.abs(seen).max())


@pytest.mark.parametrize("name", LOSSES)
def test_a_steady_start_is_that_of_the_matrices_at_rest(name):
    """From 2 V to 3 V: twice the steady state, and the response to 1 V from rest."""
    given = scene(LOSSES[name])
    table = given.table()["sources"]["s"]
    steady = given.change({"start": "steady", "sources.s": table | {"value": table["value"] | {"from": 2, "to": 3}}})
    R, G = (np.array(LOSSES[name].get(key, np.zeros((2, 2)))) for key in ("resistance", "conductance"))
    A, B, C, D = (
        part for half in np.vsplit(expm(-0.2 * np.block([[0 * R, R], [G, 0 * R]])), 2) for part in np.hsplit(half, 2)
    )
    near, far = np.diag(TERMINATIONS[:2]), np.diag(TERMINATIONS[2:])
    # u1 = E - near y1, u2 = far y2 of u2 = A u1 + B y1, y2 = C u1 + D y1
    y1 = np.linalg.solve(far @ (D - C @ near) - B + A @ near, (A - far @ C) @ [2.0, 0.0])
    u1 = np.array([2.0, 0.0]) - near @ y1
    before = [*u1, *(A @ u1 + B @ y1)]
    result, rest = simulate(steady, tol=1e-5), simulate(given, tol=1e-5)
    assert result.accuracy.met
    t = np.linspace(0, T_END, 1001)
    for at, start in zip(NODES, before, strict=True):
        assert result.probes[at].at(t).u == pytest.approx(start + rest.probes[at].at(t).u, abs=1e-4)


@pytest.mark.parametrize(("more", "solver"), [({}, {"tol": 1e-12}), ({"ledger": True}, {})])
def test_what_convolutions_do_not_know_is_refused(more, solver):
    with pytest.raises(InputError, match=r"lines\.pair: "):
        simulate(scene(LOSSES["both"], solver=solver), **more)
