"""Elements see the gauge pressure at their height: closed forms, and the same liquid with pressures counted by hand."""

import numpy as np
import pytest
from random_heights import LOADS, WEIGHT

from tline import Scene, simulate

PIPE = {"nodes": ["tank", "end"], "length": "400 m", "diameter": "20 cm", "wave_speed": 1000, "density": 1000}
ROUNDING = 1e-12


def behind_a_tank(load: dict, head: float = 130.0, step: float = 0.0, z: float | None = 100.0, **scene) -> Scene:
    """A load at the end of a pipe on a height; the head at its other end steps, both in m."""
    shape = {"shape": "step", "from": WEIGHT * head, "to": WEIGHT * (head + step), "at": "0.1 s"}
    heights = {} if z is None else {"nodes": {node: {"elevation": z} for node in ("tank", "end")}}
    return Scene(
        medium="hydraulic",
        lines={"pipe": PIPE},
        sources={"tank": {"at": "tank", "kind": "pressure", "value": shape}},
        loads={"load": load | {"at": "end"}},
        probes={"end": {"at": "end"}},
        **{"t_end": 3, "start": "steady", "solver": {"order": 4, "slab": "25 ms"}} | heights | scene,
    )


def test_an_air_vessel_on_a_height_is_the_same_as_in_the_valley():
    """Piezometric pressure in p·Vⁿ would make the gas stiffer: the peak were ten metres lower."""
    vessel = {"kind": "air vessel", "gas_volume": "2 m^3", "gas_pressure": WEIGHT * 30}
    high = simulate(behind_a_tank(vessel, step=20, t_end=60)).probes["end"]
    low = simulate(behind_a_tank(vessel, 30, 20, z=None, t_end=60)).probes["end"]
    np.testing.assert_allclose(high.gauge_pressure, low.u, rtol=ROUNDING)
    np.testing.assert_allclose(high.head, 100 + low.u / WEIGHT, rtol=ROUNDING)
    assert low.u.max() > 52 * WEIGHT


def test_a_hole_passes_what_it_passes_at_its_gauge_pressure():
    leak = {"kind": "leak", "flow": "10 L/s", "pressure": WEIGHT * 30}
    probe = simulate(behind_a_tank(leak)).probes["end"]
    np.testing.assert_allclose(probe.y, 0.010, rtol=ROUNDING)
    np.testing.assert_allclose(probe.gauge_pressure, 30 * WEIGHT, rtol=ROUNDING)
    np.testing.assert_allclose(probe.head, 130, rtol=ROUNDING)


@pytest.mark.parametrize(("head", "share"), [(90, 0.0), (110, 0.5**0.5), (125, 1.0)])
def test_a_demand_is_met_by_its_gauge_pressure(head, share):
    demand = {"kind": "demand", "flow": "10 L/s", "required_pressure": WEIGHT * 20}
    np.testing.assert_allclose(simulate(behind_a_tank(demand, head)).probes["end"].y, 0.010 * share, atol=1e-14)


@pytest.mark.parametrize(
    ("load", "flow"),
    [
        ({"kind": "resistor", "resistance": 3e7}, 30 * WEIGHT / 3e7),
        ({"kind": "valve", "before": 3e7, "after": 3e7, "time": 9}, 30 * WEIGHT / 3e7),
        ({"kind": "parallel", "resistance": 3e7, "capacitance": 1e-8}, 30 * WEIGHT / 3e7),
        ({"kind": "impedance", "expression": "3e7 + 1e6*s"}, 30 * WEIGHT / 3e7),
        ({"kind": "series", "resistance": 3e7, "capacitance": 1e-8}, 0.0),
        ({"kind": "orifice", "flow": 0.01, "pressure_drop": WEIGHT * 30}, 0.01),
        ({"kind": "table", "points": [[0, 0], [3e6, 0.1]]}, 30 * WEIGHT / 3e7),
    ],
)
def test_steady_flows_to_the_open_air(load, flow):
    scene = behind_a_tank(load)
    np.testing.assert_allclose(simulate(scene).probes["end"].y, flow, rtol=1e-11, atol=1e-14)


@pytest.mark.parametrize("kind", ["orifice", "check valve", "relief valve", "cavity", "vapour cavity", "air valve"])
def test_a_height_is_a_back_pressure_counted_by_hand(kind):
    """With an elevation, and without one but with density·g·elevation as the pressure outside."""
    table = behind_a_tank(LOADS[kind] | {"kind": kind}, 45.0, -25.0, solver={"order": 2, "slab": "25 ms"}).table()
    heights = table | {"nodes": {"tank": {"elevation": 0}, "end": {"elevation": 30}}}
    table["loads"] = {"load": table["loads"]["load"] | {"back_pressure": 30 * WEIGHT}}
    del table["nodes"]
    one, other = (simulate(Scene(**each)).probes["end"] for each in (heights, table))
    np.testing.assert_allclose(one.u, other.u, rtol=0, atol=1e-10 * 45 * WEIGHT)
    assert np.ptp(one.u) > 10 * WEIGHT


ANSWERS = ["resistor", "valve", "series", "parallel", "impedance", "capacitor"]


@pytest.mark.parametrize(
    ("kind", "start"), [*((kind, start) for kind in ANSWERS for start in ("rest", "steady")), ("inductor", "rest")]
)
def test_heights_drop_out_of_how_a_linear_scene_answers(kind, start):
    """Two runs whose sources differ: their difference knows nothing of heights."""
    load = {"kind": kind} | LOADS[kind]

    def answer(z: tuple[float, float] | None) -> np.ndarray:
        heights = {} if z is None else {"nodes": {"tank": {"elevation": z[0]}, "end": {"elevation": z[1]}}}
        runs = [
            simulate(behind_a_tank(load, 30, step, z=None, start=start, **heights)).probes["end"].u for step in (0, 7)
        ]
        return runs[1] - runs[0]

    np.testing.assert_allclose(answer((20.0, 5.0)), answer(None), rtol=0, atol=1e-10 * 7 * WEIGHT)


STILL = ["closed", "series", "capacitor", "air vessel", "surge tank", "cavity", "vapour cavity", "air valve"]


@pytest.mark.parametrize("kind", STILL)
def test_liquid_at_rest_stands_still(kind):
    """Filled up to the highest node, where the gauge pressure is zero."""
    load = {"kind": kind} | LOADS[kind]
    scene = behind_a_tank(
        load, 40.0, t_end=4, start="rest", nodes={"tank": {"elevation": 40}, "end": {"elevation": 12}}
    )
    probe = simulate(scene).probes["end"]
    np.testing.assert_allclose(probe.gauge_pressure, 28 * WEIGHT, rtol=ROUNDING)
    np.testing.assert_allclose(probe.y, 0.0, atol=1e-14)


def test_what_lets_liquid_out_at_rest_begins_without_a_flow_in_what_is_inert():
    """Into the open air 28 m below the level, through R and L behind z0: y = u0/(R + z0)·(1 - exp(-(R + z0)·t/L))."""
    R, L = 1e7, 3e6
    load = {"kind": "series", "resistance": R, "inductance": L}
    heights = {"tank": {"elevation": 40}, "end": {"elevation": 12}}
    scene = behind_a_tank(load, 40.0, t_end=0.7, start="rest", nodes=heights, solver={"order": 8, "slab": "20 ms"})
    probe = simulate(scene).probes["end"]
    total = R + scene.lines["pipe"].parameters.z0
    expected = 28 * WEIGHT / total * -np.expm1(-total * probe.t / L)
    np.testing.assert_allclose(probe.y, expected, rtol=0, atol=1e-9 * expected.max())
    charged = {"kind": "parallel", "resistance": R, "capacitance": 1e-8}
    probe = simulate(behind_a_tank(charged, 40.0, start="rest", nodes=heights)).probes["end"]
    assert probe.gauge_pressure[1] == pytest.approx(28 * WEIGHT, rel=0.3)  # and not that of an empty one
    assert probe.gauge_pressure[0] == pytest.approx(28 * WEIGHT)


def test_gravity_has_an_account_of_what_flows_out_below_the_highest_node():
    leak = {"kind": "leak", "flow": "10 L/s", "pressure": WEIGHT * 30}
    nodes = {"tank": {"elevation": 120}, "end": {"elevation": 100}}
    result = simulate(behind_a_tank(leak, nodes=nodes), ledger=True)
    volume = 0.010 * result.t[-1]
    assert result.ledger.of("loads.load").dissipated == pytest.approx(30 * WEIGHT * volume)
    assert result.ledger.of("gravity").supplied == pytest.approx(20 * WEIGHT * volume)
    assert result.ledger.of("sources.tank").supplied == pytest.approx(10 * WEIGHT * volume)
    assert result.ledger.residual < 1e-12


def test_a_surge_tank_fills_to_the_head_above_its_own_node():
    """Mass oscillation in a stiff tunnel without friction: the level swings by v0·sqrt(l·A/(g·S)) about the head."""
    tank = {"kind": "surge tank", "tank_area": "1 m^2"}
    result = simulate(behind_a_tank(tank, 130, 2, t_end=120))
    assert result.probes["end"].gauge_pressure[0] == pytest.approx(30 * WEIGHT, rel=1e-12)
    assert result.probes["end"].head.max() == pytest.approx(134, abs=0.1)
