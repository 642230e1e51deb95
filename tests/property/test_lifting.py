"""Lifting a scene by 1000 m, with the piezometric pressures that it prescribes, changes no gauge pressure."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from random_heights import LINKS, LOADS, MULTIPORTS, WEIGHT, sloping

from tline import Result, Scene, simulate
from tline.solver.description.description import describe
from tline.solver.description.resolution import resolution
from tline.solver.run import run

LIFT = 1000.0  # m: 9.8 MPa, of which doubles keep 2e-9 Pa
BOUND = 1e-10  # of the largest pressure; those 2e-9 Pa are 5e-15 of it, and narrow pieces at fronts magnify them


def same(low: Result, high: Result, bound: float = BOUND) -> None:
    """All that is said of gauge pressures, flows and energies."""
    pressure = max(np.abs(probe.gauge_pressure).max() for probe in low.probes.values())
    flow = max(np.abs(probe.y).max() for probe in low.probes.values()) + 1e-9
    for name, probe in low.probes.items():
        lifted = high.probes[name]
        np.testing.assert_allclose(lifted.gauge_pressure, probe.gauge_pressure, rtol=0, atol=bound * pressure)
        np.testing.assert_allclose(lifted.y, probe.y, rtol=0, atol=100 * bound * flow)
        np.testing.assert_allclose(lifted.u, probe.u + WEIGHT * LIFT, rtol=0, atol=bound * pressure)
        np.testing.assert_allclose(lifted.head, lifted.u / WEIGHT, rtol=1e-15)
    for word in ("start", "lowest", "highest"):
        gauge = [getattr(each.envelope, word) - each.envelope.weight for each in (low, high)]
        inside = 10 * bound  # extremes lie inside slabs, where rounding decides which breakpoints are dissolved
        np.testing.assert_allclose(*gauge, rtol=0, atol=inside * pressure)
    for one, other in zip(low.ledger.entries, high.ledger.entries, strict=True):
        assert one.where == other.where
        np.testing.assert_allclose(other[1:], one[1:], rtol=0, atol=100 * bound * low.ledger.turnover)
    assert high.notes == low.notes


def lifted(seed: int, **scene) -> None:
    """A random scene of some kind, run at its height and 1000 m above."""
    rng = np.random.default_rng(seed)
    scene |= {"solver": {"order": int(rng.integers(1, 7)), "slab": float(rng.uniform(0.02, 0.14))}}
    low, high = (simulate(sloping(seed, z, **scene), envelope=True, ledger=True, active=True) for z in (0.0, LIFT))
    same(low, high)


SEEDS = st.integers(0, 2**32 - 1)
pytestmark = pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")


@pytest.mark.parametrize("start", ["rest", "steady"])
@pytest.mark.parametrize("load", LOADS)
@settings(max_examples=2, deadline=None)
@given(seed=SEEDS)
def test_loads(seed, load, start):
    lifted(seed, load=load, start=start)


@pytest.mark.parametrize("start", ["rest", "steady"])
@pytest.mark.parametrize("link", LINKS)
@settings(max_examples=2, deadline=None)
@given(seed=SEEDS)
def test_links(seed, link, start):
    lifted(seed, link=link, start=start)


@pytest.mark.parametrize("link", MULTIPORTS)
@settings(max_examples=2, deadline=None)
@given(seed=SEEDS, load=st.sampled_from(["closed", "resistor", "series", "impedance", "inductor"]))
def test_multiports(seed, link, load):
    lifted(seed, link=link, load=load, start="rest")


@pytest.mark.parametrize(("load", "start"), [("air vessel", "rest"), ("leak", "steady")])
def test_runs_to_a_tolerance(load, start):
    low, high = (
        simulate(sloping(5, z, load=load, start=start, solver={"tol": 1e-3}), envelope=True, ledger=True)
        for z in (0.0, LIFT)
    )
    same(low, high)
    assert [a[:2] for a in map(how, low.accuracy.attempts)] == [a[:2] for a in map(how, high.accuracy.attempts)]
    assert high.accuracy.worst == pytest.approx(low.accuracy.worst, rel=1e-6)


def how(attempt) -> tuple[int, float]:
    return attempt.order, attempt.slab


@pytest.mark.parametrize("start", ["rest", "steady"])
@pytest.mark.parametrize("load", ["resistor", "inductor", "series", "parallel"])
def test_a_short_line_that_is_lumped(load, start):
    def stub(lift: float) -> Scene:
        table = sloping(3, lift, load=load, start=start).table()
        pipe = {"length": 0.5, "wave_speed": 1000, "density": 1000, "diameter": "20 cm"}
        table["lines"]["stub"] = {"nodes": ["d", "e"]} | pipe
        table["nodes"]["e"] = {"elevation": 7 + lift}
        table["loads"]["drain"] = {"at": "e", "kind": "resistor", "resistance": "3e7 Pa s/m^3"}
        table["probes"]["far"]["line"] = "lower"
        return Scene(**table)

    def short(scene: Scene) -> Result:
        chosen = resolution(describe(scene), 4, 0.04, {"stub": 1})
        return run(describe(scene), chosen, envelope=True, ledger=True)

    same(short(stub(0.0)), short(stub(LIFT)))


def test_cavities_and_friction_inside_pipes():
    def rising(lift: float) -> Result:
        table = sloping(2, lift, load="cavity", start="steady", solver={"order": 3, "slab": 0.02}).table()
        table["lines"]["lower"]["cavities"] = {"places": 3, "gas_volume": 1e-3}
        friction = {"kind": "vardy-brown", "viscosity": "1 mPa s", "roughness": "0.1 mm", "reynolds": 1e5}
        table["lines"]["upper"]["friction"] = friction
        table["probes"].pop("middle", None)
        return simulate(Scene(**table), envelope=True, ledger=True)

    same(rising(0.0), rising(LIFT))
