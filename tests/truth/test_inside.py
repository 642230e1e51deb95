"""What is inside lossy lines: Laplace transforms inverted by mpmath, a closed form, and lines cut in two."""

from collections.abc import Callable

import mpmath
import numpy as np
import pytest
from one_line import one_line

from tline import Result, Scene, simulate
from tline.solver.result.dense_output import inside

Z0, DELAY, LENGTH, R, G, NEAR, FAR, RISE = 50.0, 5e-9, 1.0, 30.0, 4e-3, 20.0, 150.0, 3e-9


def cable(**value) -> Result:
    """A cable with resistance and leakage, between resistors that do not match."""
    line = {"z0": Z0, "delay": DELAY, "length": LENGTH, "resistance": R, "conductance": G}
    scene = one_line("40 ns", line, value, NEAR, FAR, probes={"far": {"at": "far"}})
    return simulate(scene, tol=1e-9, record=["line"])


def exact(x: float, t: float, source: Callable) -> float:
    """Voltage at a share x of the telegraph equation's line, for a source of that transform."""
    L, C = Z0 * DELAY / LENGTH, DELAY / Z0 / LENGTH

    def transform(s):
        z, y = R + s * L, G + s * C
        zc, gamma = mpmath.sqrt(z / y), mpmath.sqrt(z * y) * LENGTH
        back = (FAR - zc) / (FAR + zc)
        forth = (NEAR - zc) / (NEAR + zc)
        waves = mpmath.exp(-gamma * x) + back * mpmath.exp(-gamma * (2 - x))
        return zc / (zc + NEAR) * waves / (1 - forth * back * mpmath.exp(-2 * gamma)) * source(s)

    return float(mpmath.invertlaplace(transform, t, method="dehoog", degree=40))


@pytest.mark.parametrize(
    ("value", "transform", "order", "close"),
    [
        ({"shape": "exponential", "to": 1, "time_constant": RISE}, lambda s: 1 / (s * (1 + s * RISE)), 2, 1e-5),
        ({"shape": "step", "to": 1}, lambda s: 1 / s, 1, 1e-3),
    ],
)
def test_inside_of_a_lossy_cable(value: dict, transform: Callable, order: int, close: float) -> None:
    """Of second order in the cells; a front costs half a cell's loss, and so makes it the first."""
    places = [(0.25, 10e-9), (0.5, 20e-9), (0.75, 30e-9)]  # on all lattices, and on no front
    result, expected = cable(**value), np.array([exact(x, t, transform) for x, t in places])
    cells, off = [8, 16, 32, 64], []
    for n in cells:
        seen = inside(result, "line", n)
        off.append(np.abs([seen.effort(np.array(t), x) for x, t in places] - expected).max())
    assert off[-1] < close, off
    assert -np.polyfit(np.log(cells), np.log(off), 1)[0] > order - 0.15, off


def test_steady_flow_falls_as_a_straight_line() -> None:
    """Darcy: density·f·l/d·v²/2 from end to end, and nothing moves."""
    pipe = {"nodes": ["a", "b"], "length": "900 m", "diameter": "250 mm", "wave_speed": 1000, "density": 1000,
            "friction": {"kind": "darcy", "factor": 0.02}}  # fmt: skip
    flow, drop = 0.1, 1000 * 0.02 * 900 / 0.25 * (0.1 / (np.pi / 4 * 0.25**2)) ** 2 / 2
    scene = Scene(
        medium="hydraulic", t_end="4 s", start="steady", lines={"pipe": pipe}, probes={"b": {"at": "b"}},
        loads={"tank": {"at": "a", "kind": "reservoir", "pressure": "9 bar"}},
        sources={"draw": {"at": "b", "kind": "flow", "value": -flow}},
    )  # fmt: skip
    seen = inside(simulate(scene, tol=1e-6, record=["pipe"]), "pipe", 10)
    expected = 9e5 - drop * np.linspace(0, 1, 11)
    for found in seen.extremes(np.array([0.0, 4.0])):
        np.testing.assert_allclose(found, expected, rtol=2e-6)  # CLOSE of the iteration


def test_extremes_on_a_lossless_line_are_those_of_a_standing_wave() -> None:
    """Open at its end, u = A cos(w T (1 - x)) cos(w t) where waves of A/2 have met; peaks on no sample."""
    frequency = 1.37e8
    sine = {"shape": "sine", "amplitude": 2.0, "frequency": frequency}
    scene = one_line("60 ns", {"z0": Z0, "delay": DELAY}, sine, Z0, probes={"far": {"at": "far"}})
    seen = inside(simulate(scene, tol=1e-10, record=["line"]), "line")
    phase = 2 * np.pi * frequency * DELAY * (1 - seen.places)
    standing, alone = 2 * np.abs(np.cos(phase)), 2 * phase  # until that phase a wave is alone
    _, low, high = seen.extremes(np.linspace(0, 60e-9, 3))
    expected = np.maximum(standing, np.sin(np.minimum(alone, np.pi / 2)))
    np.testing.assert_allclose(high, expected, rtol=1e-8)
    expected = np.maximum(standing, -np.sin(np.clip(alone, 0, 3 * np.pi / 2)))
    np.testing.assert_allclose(-low, expected, rtol=1e-8)


LOSSES = {
    "darcy": {"friction": {"kind": "darcy", "factor": 0.03}},
    "quasi-steady": {"friction": {"kind": "quasi-steady", "viscosity": "1 mPa s", "roughness": 1e-4}},
    "vardy-brown": {"friction": {"kind": "vardy-brown", "viscosity": "1 mPa s", "roughness": 0, "reynolds": 1e5}},
}


@pytest.mark.parametrize("kind", LOSSES)
def test_the_middle_is_what_a_node_there_sees(kind: str) -> None:
    """A valve shuts on a pipe, and on the same pipe in two halves."""

    def hammer(**lines: list[str]) -> Scene:
        pipe = {"diameter": "200 mm", "wave_speed": 1000, "density": 1000, **LOSSES[kind]}
        return Scene(
            medium="hydraulic", t_end="2.5 s", start="steady",
            lines={name: {"nodes": at, "length": 1000 / len(lines), **pipe} for name, at in lines.items()},
            loads={"tank": {"at": "a", "kind": "reservoir", "pressure": "20 bar"},
                   "valve": {"at": "b", "kind": "valve", "before": 4e7, "after": float("inf"), "time": "0.5 s"}},
            probes={"m": {"at": "m", "line": "one"} if "one" in lines else {"at": "b"}},
        )  # fmt: skip

    seen = inside(simulate(hammer(pipe=["a", "b"]), tol=3e-4, record=["pipe"]), "pipe", 32)
    node = simulate(hammer(one=["a", "m"], two=["m", "b"]), tol=3e-4).probes["m"]
    t = np.arange(0.25, 2.5, 0.5)  # fronts pass the middle at whole seconds
    effort, expected = seen.effort(t, 0.5), node.at(t).u
    jump = np.ptp(expected)
    assert np.abs(effort - expected).max() < 2e-3 * jump
