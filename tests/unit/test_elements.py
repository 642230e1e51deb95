"""Laws one by one: each flow fits its law behind its impedance, and its slope is its derivative."""

import numpy as np
import pytest

from tline import SceneError
from tline.scene import Pump, Ramp, Sine
from tline.scene.factor import Characterised
from tline.scene.law import KINDS
from tline.scene.pump_curves import RADIAL
from tline.solver.description.laws import laws_of
from tline.solver.kernel.laws.quadratic import rooted
from tline.solver.kernel.stores.gas import expanded
from tline.solver.steady.edges import Flows

PUMP = Pump(nodes=("a", "b"), curve=[(0.0, 2.0), (0.5, 1.9), (1.0, 1.2), (1.5, 0.3)], efficiency=0.8)
LAWS = {
    "quadratic": ((0.1, 0.7, 0.0), lambda u: 0.7 * np.sign(u) * np.sqrt(abs(u))),
    "pump": (PUMP.law().constants, None),
    "relief": ((0.0, 0.7, 0.5, 0.25), lambda u: 0.7 * np.clip((u - 0.5) / 0.25, 0, 1) * np.sqrt(max(u, 0))),
    "leak": ((0.0, 0.8, 1.3, 1.2, np.inf), lambda u: 0.8 * (max(u, 0) / 1.3) ** 1.2),
    "demand": ((0.2, 0.8, 1.3, 0.5, 1.3), lambda u: 0.8 * np.clip(u / 1.3, 0, 1) ** 0.5),
    "diode": ((0.0, 1e-12, 0.026), lambda u: 1e-12 * np.expm1(u / 0.026)),
    "table": ((0.0, 3.0, -1.0, 0.5, 1.0, -2.0, 0.0, 4.0), lambda u: np.interp(u, [-1, 0.5, 1], [-2, 0, 4])),
}


def through(kind: str, v: float, z: float, factor: float = 1.0) -> tuple[float, float]:
    laws = laws_of([], [], 0, 0)[0]._replace(
        kind=np.array([KINDS[kind].number]), at=np.zeros(1, int), constants=np.array(LAWS[kind][0]),
        control=np.array([factor]), source_impedance=np.array([z]),
    )  # fmt: skip
    flow, slope = Flows(laws)(np.array([v]))
    return flow[0], slope[0]


@pytest.mark.parametrize("kind", [kind for kind, (_, law) in LAWS.items() if law])
@pytest.mark.parametrize("z", [1e-3, 1.0, 300.0])
def test_a_flow_fits_its_law(kind, z):
    constants, law = LAWS[kind]
    for v in (-0.9, -1e-9, 0.3, 0.6, 0.73, 0.99):
        flow, _ = through(kind, v, z)
        drop = v - constants[0] - z * flow
        step = 1e-15 * max(abs(v), z * abs(flow))  # what rounding of the drop may change
        assert law(drop - 8 * step) - 1e-15 <= flow <= law(drop + 8 * step) + 1e-15


@pytest.mark.parametrize("kind", LAWS)
def test_a_slope_is_the_derivative(kind):
    for v in (-0.7, 0.37, 0.61, 1.4, 7.0):
        step = 1e-6
        difference = (through(kind, v + step, 2.0)[0] - through(kind, v - step, 2.0)[0]) / (2 * step)
        assert through(kind, v, 2.0)[1] == pytest.approx(difference, rel=1e-4, abs=1e-9)


@pytest.mark.parametrize("speed", [0.4, 1.0])
@pytest.mark.parametrize(("flow", "rise"), [(0.0, 2.0), (0.5, 1.9), (1.0, 1.2), (1.5, 0.3)])
def test_a_pump_meets_its_points_at_any_speed(speed, flow, rise):
    """By affinity: the flow goes with the speed, the rise with its square."""
    z = 0.3
    v = z * speed * flow - speed**2 * rise
    assert through("pump", v, z, speed)[0] == pytest.approx(speed * flow, abs=1e-14)


def test_a_pumps_curve_falls_smoothly_through_its_points():
    z = 0.01
    drops = np.linspace(-2.4, 1.0, 4001)
    flows, slopes = np.array([through("pump", drop, z) for drop in drops]).T
    assert (np.diff(flows) > 0).all()
    assert np.abs(np.diff(1 / slopes)).max() < 0.02 * (1 / slopes).max()
    turned = flows[flows * (z * flows - drops) > 0]  # where it gives power
    assert (turned.min(), turned.max()) == (pytest.approx(0.0, abs=0.01), pytest.approx(1.6, abs=0.1))


@pytest.mark.parametrize("capacity", [0.0, 1e-200, 1e-9, 1.0, 1e9, 1e150, np.inf])
def test_a_valve_is_sound_from_shut_to_without_loss(capacity):
    flow, slope = rooted(3.0, 2.0, capacity, 0.0)
    assert 0 <= flow <= 1.5
    assert 0 <= slope <= 0.5
    if capacity >= 1e9:
        assert flow == pytest.approx(1.5, rel=1e-15)


@pytest.mark.parametrize("v", [-1e6, 1e6, 1e100])
def test_a_diode_does_not_overflow(v):
    flow, slope = through("diode", v, 50.0)
    assert np.isfinite([flow, slope]).all()
    assert flow == pytest.approx(v / 50 if v > 0 else -1e-12, rel=1e-3)


@pytest.mark.parametrize("n", [1.0, 1.2, 1.4])
def test_gas_stores_what_its_pressure_does(n):
    """X²/2 is the integral of the pressure; series near the atmosphere's and closed form beyond meet."""
    for volume in (0.01, 0.59999, 0.60001, 0.95, 1.0, 1.3, 1.39999, 1.40001, 50.0):
        effort, x, ratio = expanded(np.log(volume), n)
        y, weights = np.polynomial.legendre.leggauss(60)
        low = np.log(volume) * (1 + y) / 2  # in ln V, from 1 to volume
        work = -np.log(volume) / 2 * weights @ (np.expm1(-n * low) * np.exp(low))
        assert x**2 / 2 == pytest.approx(work, rel=1e-12, abs=1e-30)
        assert effort == pytest.approx(np.expm1(-n * np.log(volume)), rel=1e-13, abs=1e-30)
        assert ratio * x == pytest.approx(effort, rel=1e-13, abs=1e-30)


@pytest.mark.parametrize(
    ("curve", "parabola"),
    [
        ([(2.0, 3.0)], (4.0, 0.0, 0.25)),
        ([(0.0, 4.0), (2.0, 3.0)], (4.0, 0.0, 0.25)),
        ([(0.0, 4.0), (1.0, 3.5), (2.0, 2.0)], (4.0, 0.0, 0.5)),
        ([(0.0, 4.0), (1.0, 3.0), (2.0, 1.0)], (4.0, 0.5, 0.5)),
    ],
)
def test_a_curve_goes_through_its_points(curve, parabola):
    pump = Pump(nodes=("a", "b"), curve=curve)
    at_rest, b, c = parabola
    z, rise = 0.7, at_rest - 1.5 * b - 1.5**2 * c
    laws = laws_of([], [], 0, 0)[0]._replace(
        kind=np.array([KINDS["pump"].number]), at=np.zeros(1, int), constants=np.array(pump.law().constants),
        control=np.ones(1), source_impedance=np.array([z]),
    )  # fmt: skip
    assert Flows(laws)(np.array([1.5 * z - rise]))[0][0] == pytest.approx(1.5, abs=1e-12)


def test_a_characteristic_breaks_where_the_opening_passes_its_points():
    opening = Ramp(from_=1, to=0, at=1, duration=2)
    shape = Characterised.model_construct(opening=opening, shares=((0.0, 0.0), (0.25, 0.1), (1.0, 1.0)))
    assert shape.breaks(5.0) == pytest.approx([1.0, 2.5, 3.0])
    t = np.array([0.0, 1.0, 2.0, 2.5, 2.75, 4.0])
    assert shape.value(t, t - 1e-9) == pytest.approx([1, 1, 0.4, 0.1, 0.05, 0], abs=1e-8)


def test_an_opening_that_swings_breaks_wherever_it_passes_a_point():
    shape = Characterised.model_construct(
        opening=Sine(amplitude=0.5, offset=0.5, frequency=1.0), shares=((0.0, 0.0), (0.75, 0.1), (1.0, 1.0))
    )
    assert shape.breaks(1.5) == pytest.approx([0.0, 1 / 12, 5 / 12, 1 + 1 / 12, 1 + 5 / 12])


def test_the_same_figures_as_points_are_the_same_pump():
    own = [[h, b] for h, b in zip(RADIAL.head, RADIAL.torque, strict=True)]
    pump = {"nodes": ["sump", "end"], "curve": [(0.02, 5e5)], "efficiency": 0.8}
    one, other = (Pump(**pump, quadrants=quadrants) for quadrants in ("radial", own))
    assert one.law() == other.law()
    assert Pump(**other.table()) == other
    with pytest.raises(SceneError, match=r"quadrants: not Suter's tables, expected 9, 13, 17, \.\.\. points"):
        Pump(**pump, quadrants=own[:-1])
