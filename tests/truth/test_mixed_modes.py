"""Coupled conductors whose losses mix the modes, against matrix functions of their line, transformed by damped FFT."""

import numpy as np
import pytest

from tline import InputError, Scene, simulate
from tline.scene.stretches import expanded

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


@pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")  # of what is 1e-4 of the wave
def test_twice_as_many_places_leave_two_fifths_of_the_error():
    """Behind corners, at most; behind jumps a half."""
    given = scene(LOSSES["resistance"], solver={"order": 4, "slab": "4.6 ps"})
    t, voltages = exact(LOSSES["resistance"])
    errors = []
    for doublings in (0, 1, 2):
        result = simulate(expanded(given, doublings))
        errors.append(np.abs(result.probes["b2"].at(t[7::13]).u - voltages[7::13, 3]).mean())
    assert errors[1] < 0.4 * errors[0]
    assert errors[2] < 0.4 * errors[1]


def test_places_take_energy_in_any_state():
    links = expanded(scene(LOSSES["both"])).links
    assert len(links) == 8
    for link in links.values():
        assert np.linalg.norm(np.array(link.scattering, float), 2) <= 1 + 1e-12


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


def test_a_skin_effect_that_mixes_modes_is_refused_in_other_runs():
    skin = {"skin": {"resistance": [[20, 3], [3, 5]], "frequency": "1 GHz"}}
    with pytest.raises(InputError, match=r"skin: .*modes see each other"):
        simulate(scene(skin, solver={"order": 4, "slab": "4.6 ps"}))
