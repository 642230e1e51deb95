"""What a run gives out ends at its end time, whatever its slabs: nothing of what waves do behind it is seen."""

import csv

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from one_line import FAR, one_line
from random_kinks import random_kinks
from random_scenes import random_scene

from tline import InputError, Scene, simulate, sweep
from tline.solver.result.dense_output import extremes, inside

pytestmark = pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")
SEEDS = st.integers(0, 10_000)
SAMPLES = 20_001
CLOSE = 1e-6  # of the amplitude: parabolas between places of a slab

# a cable whose load is still charged at the end: what is behind it is higher than all before
SEEN = FAR | {"middle": {"line": "line", "position": "50 %"}}
CAPACITOR = {"kind": "capacitor", "capacitance": "100 pF"}
RISING = one_line("7.3 ns", {"z0": 50, "delay": "2 ns"}, 1, 50, CAPACITOR, probes=SEEN)


def slabs_of(scene: Scene, slab: float, order: int) -> Scene:
    return scene.with_changes(solver={"slab": slab, "order": order})


def dense(seen, t_end: float, letter: str = "u") -> np.ndarray:
    """Samples of a probe up to the end, both sides of each front among them."""
    fronts = np.concatenate([wave.breakpoints() for wave in seen.waves])
    edges = np.concatenate([fronts, seen.t])
    t = np.concatenate([np.linspace(0.0, t_end, SAMPLES), edges, edges * (1 + 1e-8) + 1e-12])
    return getattr(seen.at(t[(t >= 0) & (t <= t_end)]), letter)


@settings(max_examples=6, deadline=None)
@given(
    seed=SEEDS, order=st.integers(1, 6), slab=st.floats(0.05, 0.45), t_end=st.floats(0.5, 15.0), steady=st.booleans()
)
def test_extremes_are_those_of_dense_samples(seed, order, slab, t_end, steady):
    start = {"start": "steady"} if steady else {}
    scene = random_scene(seed, sources=True, **start).with_changes(t_end=t_end)
    result = simulate(slabs_of(scene, slab, order), envelope=True, ledger=False)
    probe = result.probes["p"]
    assert result.t[-1] == probe.t[-1] == t_end
    assert (np.diff(result.t) > 0).all()
    assert len(probe.u) == len(result.t)
    size = max(np.abs(np.stack([probe.u, probe.a, probe.b])).max(), 1e-12)
    assert probe.u[-1] == pytest.approx(float(probe.at(t_end).u), abs=1e-9 * size)
    for letter, unit in (("u", size), ("y", size / probe.record.z0)):
        (low, low_at), (high, high_at) = extremes(probe, letter)
        samples = dense(probe, t_end, letter)
        assert 0.0 <= low_at <= t_end
        assert 0.0 <= high_at <= t_end
        for found, at, best in ((low, low_at, samples.min()), (high, high_at, samples.max())):
            assert found == pytest.approx(best, abs=1e-4 * unit)
            near = np.clip(at + np.array([-1e-7, 0, 1e-7]) * slab, 0, t_end)
            assert np.abs(getattr(probe.at(near), letter) - found).min() <= 1e-4 * unit
    assert (result.envelope.lowest_at <= t_end).all()
    assert (result.envelope.highest_at <= t_end).all()
    with pytest.raises(InputError, match="not in the run"):
        probe.at(t_end + slab / 10)


@pytest.mark.parametrize("order", [2, 3, 6])
@pytest.mark.parametrize("slab", [2e-9, 1e-9, 0.8e-9, 0.23e-9])
def test_a_load_that_is_charged_is_not_seen_behind_the_end(slab, order):
    """Its voltage is that of the exponential at the end, and so is the highest anywhere that is asked."""
    result = simulate(slabs_of(RISING, slab, order), envelope=True, record=["line"])
    t_end = float(RISING.t_end)
    last = float(result.probes["far"].at(t_end).u)
    (_, (high, high_at)) = extremes(result.probes["far"], "u")
    assert high == pytest.approx(last, rel=1e-9)
    assert high_at == pytest.approx(t_end, rel=1e-9)
    assert result.envelope.of("far")["highest"] == pytest.approx(last, rel=CLOSE, abs=3e-2 if order < 3 else 2e-3)
    assert result.envelope.of("far")["highest_at"] <= t_end
    _, _, tops = inside(result, "line").extremes(result.t)
    assert tops[-1] == pytest.approx(last, rel=1e-9)
    if order > 2 and slab < 1.9e-9:
        assert high == pytest.approx(1 - np.exp(-(t_end - 2e-9) / 5e-9), abs=2e-3)


@pytest.mark.parametrize("tol", [1e-3, 1e-5, 1e-7, 1e-9])
def test_the_highest_is_the_same_at_every_tolerance(tol):
    result = simulate(RISING, tol=tol, envelope=True)
    exact = 1 - np.exp(-(7.3 - 2.0) / 5.0)
    (_, (high, _)), told = extremes(result.probes["far"], "u"), result.accuracy.inside["far"].u
    assert result.accuracy.met
    assert high == pytest.approx(exact, abs=3 * told)
    seen = result.envelope.of("far")
    assert seen["highest"] == pytest.approx(exact, abs=3 * max(seen["highest_error"], told))


@pytest.mark.parametrize("seed", range(6))
def test_extremes_agree_from_tolerance_to_tolerance(seed):
    scene = random_scene(seed, sources=True, start="steady").with_changes(t_end=3.7 + 0.61 * seed)
    one, other = (simulate(scene, tol=tol, envelope=True) for tol in (1e-4, 1e-7))
    told = one.accuracy.worst + other.accuracy.worst
    for letter in "uy":
        seen = [np.array(extremes(each.probes["p"], letter))[:, 0] for each in (one, other)]
        assert np.abs(seen[0] - seen[1]).max() <= 3 * told * np.abs(seen[1]).max() + 1e-12


@pytest.mark.parametrize("kind", ["law", "link", "element"])
def test_what_kinks_ends_there_too(kind):
    scene = random_kinks(3, kind, 0.0).with_changes(t_end=4.321)
    for tol in (1e-3, 1e-5):
        result = simulate(scene, tol=tol)
        for probe in result.probes.values():
            for _, at in extremes(probe, "u"):
                assert at <= 4.321
            assert probe.t[-1] == 4.321


@settings(max_examples=5, deadline=None)
@given(seed=SEEDS, slab=st.floats(0.05, 0.45), t_end=st.floats(1.0, 12.0), order=st.integers(2, 6))
def test_the_ledger_ends_there(seed, slab, t_end, order):
    """Its columns add up, and a run whose last slab ends there has the same."""
    scene = random_scene(seed, sources=True).with_changes(t_end=t_end)
    exact = simulate(slabs_of(scene, t_end / np.ceil(t_end / 0.02), 6), ledger=True).ledger
    found = simulate(slabs_of(scene, slab, order), ledger=True)
    close = 1e-3 if order > 3 else 0.1
    assert found.ledger.residual <= max(exact.residual, close)
    for entry in exact.entries:
        theirs = found.ledger.of(entry.where)
        assert theirs.supplied == pytest.approx(entry.supplied, abs=close * exact.turnover)
        assert theirs.stored == pytest.approx(entry.stored, abs=close * exact.turnover)


def test_energy_of_a_steady_flow_is_power_times_the_end_time():
    """A battery that feeds a resistor: nothing moves, and all of it is dissipated until the end, on any slabs."""
    scene = one_line(3.3, {"z0": 50, "delay": 1}, 2, None, 4, start="steady", probes=FAR)
    for slab in (1.0, 0.5, 0.7, 0.23):
        ledger = simulate(slabs_of(scene, slab, 3), ledger=True).ledger
        assert ledger.of("sources.s").supplied == pytest.approx(3.3, rel=1e-12)
        assert ledger.of("loads.load").dissipated == pytest.approx(3.3, rel=1e-12)
        assert ledger.of("lines.line").stored == pytest.approx(0.0, abs=1e-12)


def test_files_and_sweeps_end_there(tmp_path):
    result = simulate(slabs_of(RISING, 1e-9, 3))
    result.save(tmp_path / "seen.csv")
    with (tmp_path / "seen.csv").open() as file:
        rows = list(csv.reader(file))
    assert float(rows[-1][0]) == float(RISING.t_end) == result.to_dataframe().index[-1]
    for values in ([50.0], [50.0] * 3):
        table = sweep(RISING, {"lines.line.z0": values}, tol=1e-7)
        assert (table["highest_at"] <= float(RISING.t_end)).all()
        far = np.array(table["highest"]).reshape(len(values), -1)[:, 0]
        assert far == pytest.approx(1 - np.exp(-5.3 / 5), abs=1e-6)
