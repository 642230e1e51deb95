"""Behind fronts, laws beside inductors and capacitors answer at rates that follow from no element alone."""

from functools import cached_property

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from tline.scene.scene import Scene
from tline.solver.simulate import judged, simulate

pytestmark = pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")
AT, THERMAL = 0.3337, 1160.0 * 1.380649e-23 / 1.602176634e-19  # s; V, of a diode at 1160 K
FACTOR = 2  # an error is told by a difference of two runs
KNOWN = 2e-5  # of the amplitude: what the reference is good for
AFTER = np.concatenate([10.0 ** np.arange(-9, -1, 0.1), np.linspace(0.1, 1.5, 30)])


class Clamp:
    """A matched step, with or without a capacitance, into a diode before an inductance."""

    def __init__(self, saturation: float, inductance: float, capacitance: float = 0.0):
        self.saturation, self.L, self.C = saturation, inductance, capacitance

    def scene(self, **solver: float) -> Scene:
        step = {"shape": "step", "to": 1, "at": AT}
        loads = {"coil": {"at": "m", "kind": "inductor", "inductance": self.L}}
        if self.C:
            loads["c"] = {"at": "b", "kind": "capacitor", "capacitance": self.C}
        return Scene(
            medium="electrical",
            t_end=2.9,
            lines={"l": {"nodes": ["a", "b"], "z0": 1.0, "delay": 1.0}},
            sources={"s": {"at": "a", "kind": "voltage", "resistance": 1.0, "value": step}},
            links={"d": {"nodes": ["b", "m"], "kind": "diode", "saturation": self.saturation, "temperature": 1160.0}},
            loads=loads,
            probes={"b": {"at": "b"}, "m": {"at": "m"}},
            solver=solver,
        )

    def voltages(self, i: NDArray, v: NDArray) -> tuple[NDArray, NDArray]:
        """Before and behind the diode, where a current i flows, and the capacitance has a voltage v."""
        b = v if self.C else 1.0 - i
        return b, b - THERMAL * np.log1p(np.maximum(i / self.saturation, -1 + 1e-12))

    @cached_property
    def exact(self) -> dict[str, NDArray]:
        """Voltages at b and m so long after the front, by an integrator of SciPy."""

        def rates(_: float, x: NDArray) -> list[float]:
            return [self.voltages(*x)[1] / self.L, (1.0 - x[1] - x[0]) / self.C if self.C else 0.0]

        atol = [1e-11 * self.saturation, 1e-14]
        x = solve_ivp(rates, (0.0, 1.6), [0.0, 0.0], "Radau", AFTER, rtol=1e-10, atol=atol).y
        return dict(zip("bm", self.voltages(*x), strict=True))


def off(clamp: Clamp, result) -> dict[str, float]:
    """Largest errors at the probes, over their amplitudes."""
    return {
        name: float(np.abs(result.probes[name].at(1.0 + AT + AFTER).u - exact).max() / np.abs(exact).max())
        for name, exact in clamp.exact.items()
    }


@pytest.mark.parametrize("saturation", [1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("tol", [1e-3, 1e-5])
def test_a_diode_before_an_inductor_is_met_where_it_is_said_to_be(saturation, tol):
    """The inductor takes the whole front, and loses it to the diode within saturation · L/u, 1e-9 s to 1e-3 s."""
    clamp = Clamp(saturation, 1.0)
    result = simulate(clamp.scene(), tol=tol)
    assert result.accuracy.met
    for name, error in off(clamp, result).items():
        assert error <= FACTOR * result.accuracy.inside[name].u + KNOWN


@pytest.mark.parametrize("seed", range(4))
def test_clamps_of_any_rates_are_as_told(seed):
    """Rates over ten decades, most of them far beyond those of the slabs; to a tolerance, and fixed by hand."""
    rng = np.random.default_rng(seed)
    clamp = Clamp(
        10.0 ** rng.uniform(-9, -2), 10.0 ** rng.uniform(-4, 1), 10.0 ** rng.uniform(-4, -1) if seed % 2 else 0.0
    )
    result = simulate(clamp.scene(), tol=1e-4)
    for name, error in off(clamp, result).items():
        assert error <= FACTOR * result.accuracy.inside[name].u + KNOWN, name
    rough = simulate(clamp.scene(order=int(rng.integers(1, 9)), slab=0.1))
    told = judged(rough)
    for name, error in off(clamp, rough).items():
        assert told.inside[name].u / 100 - KNOWN <= error <= FACTOR * told.inside[name].u + KNOWN, name
