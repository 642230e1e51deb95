"""What is told of a run's accuracy holds wherever a user looks: any instant of a probe, and its printed extremes."""

import math
import warnings

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from kept import kept
from one_line import FAR, one_line
from random_kinks import KINDS, random_kinks
from random_scenes import random_scene

from tline.cli.report import summary
from tline.scene.scene import Scene
from tline.solver.description.description import describe
from tline.solver.description.resolution import Resolution
from tline.solver.result.accuracy import Accuracy
from tline.solver.result.dense_output import extremes
from tline.solver.run import run
from tline.solver.simulate import UnresolvedWarning, judged, simulate
from tline.study.reference import exact

pytestmark = pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")
FACTOR = 2  # an error is told by a difference of two runs, which may be that much smaller than it


@pytest.mark.parametrize(("seed", "kind", "tol"), [(k, kind, 10.0 ** -(3 + k % 4)) for k, kind in enumerate(KINDS)])
def test_errors_are_as_told_at_any_instant(seed, kind, tol):
    """`python tests/attack.py tolerance` tries hundreds."""
    found = kept(random_kinks(seed, kind), tol)
    assert found.inside <= FACTOR
    assert found.extreme <= 1
    assert not found.met or found.over <= FACTOR


@pytest.mark.parametrize(("seed", "kind"), list(enumerate(KINDS)))
def test_another_clock_changes_nothing(seed, kind):
    by, tol = 1.3, 1e-3 if kind == "pipe" else 1e-5  # loss elements of friction take long
    scene, later = (random_kinks(seed, kind, delayed) for delayed in (0.0, by))
    one, other = (simulate(each, tol=tol) for each in (scene, later))
    t = np.linspace(0.0, 7.9, 400)
    for name, probe in one.probes.items():
        then = other.probes[name]
        fronts = np.concatenate([wave.breakpoints() for wave in (probe.record.a1, probe.record.b1)])
        edges = np.concatenate([fronts, probe.t, then.t - by, scene_fronts(probe)])
        near = np.abs(t[:, None] - edges).min(axis=1) < 1e-6
        for letter in "uy":
            a, b = (getattr(seen, letter)[~near] for seen in (probe.at(t), then.at(t + by)))
            told = sum(getattr(each.accuracy.inside[name], letter) for each in (one, other))
            assert np.abs(a - b).max() <= FACTOR * (told + 1e-12) * max(np.abs(a).max(), 1e-300)


def scene_fronts(probe) -> np.ndarray:
    """Instants at which slabs' edges pass a probe inside a line."""
    ends, delay = probe.t, probe.record.delay
    return np.concatenate([ends + probe.share * delay, ends + (1 - probe.share) * delay])


LINE = {"z0": 1.0, "delay": 1.0}


def behind_one(medium: str, value: dict, load: dict, t_end: float = 3.0, line: dict = LINE, **more) -> Scene:
    """A source behind a resistance of 1, a line, and a load, which is seen."""
    return one_line(t_end, line, value, 1.0, load, **{"medium": medium, "probes": FAR} | more)


def diode(value: dict, **more) -> Scene:
    """A cable into a diode."""
    return Scene(
        medium="electrical",
        t_end="40 ns",
        lines={"cable": {"nodes": ["in", "out"], "z0": 50, "delay": "5 ns"}},
        sources={"s": {"at": "in", "kind": "voltage", "value": value, "resistance": 30}},
        loads={"d": {"at": "out", "kind": "diode", "saturation": "1e-12 A"}},
        probes={"out": {"at": "out"}},
        **more,
    )


def test_a_ramp_into_a_diode_has_no_minimum_below_zero():
    result = simulate(diode({"shape": "ramp", "to": "2 V", "duration": "1 ns"}), tol=1e-8)
    told = summary(result, result.accuracy)["probes"]["out"]["voltage"]
    assert result.accuracy.met
    assert told["minimum"] + told["error_inside_slabs"] >= 0.0
    assert told["error_inside_slabs"] <= 1e-8 * told["maximum"]


def test_a_run_that_bends_inside_slabs_is_not_met_there():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnresolvedWarning)
        scene = diode({"shape": "ramp", "to": "2 V", "duration": "1 ns"}, solver={"order": 3, "slab": "0.5 ns"})
        accuracy = simulate(scene, tol=1e-6).accuracy
    assert accuracy.at_slab_ends <= 1e-6 < accuracy.worst
    assert not accuracy.met
    assert accuracy.limit.startswith("inside slabs the error at 'out' is up to")


def test_a_check_valve_that_shuts_inside_a_slab_costs_a_few_runs():
    """An ideal one at a pipe's end: the wave's mirror image is cut off where the flow turns, known in closed form."""
    scene = behind_one("hydraulic", {"shape": "sine", "amplitude": 1.0, "frequency": 1.3}, {"kind": "check valve"}, 1.9)
    result = simulate(scene, tol=1e-9)
    assert result.accuracy.met
    assert sum(attempt.samples for attempt in result.accuracy.attempts) < 1e6
    t = np.linspace(1.0, 1.9, 1001)
    arrived = np.sin(2 * np.pi * 1.3 * (t - 1.0))  # a wave of twice half the source's amplitude
    expected = np.where(arrived > 0, 0.0, arrived)  # open to pressure 0 outside, else shut
    assert np.abs(result.probes["far"].at(t).u - expected).max() < 2e-9


@pytest.mark.parametrize(("width", "met"), [(1e-7, True), (1e-9, False), (1e-10, False), (3e-11, False)])
def test_the_height_of_a_narrow_pulse_is_known_as_well_as_told(width, met):
    """Two thirds of the source's, from the divider of 0.5 and 1 ohm; rounding of instants tilts slopes that steep.

    The last is narrower than `NEAR` slabs, and is not seen.
    """
    pulse = {"shape": "pulses", "high": 1, "at": 1.1411291959, "width": width, "rise": width, "fall": width / 3}
    lines = {"l0": ("a", "b", 1, 0.70710678), "l1": ("b", "c", 2, 0.3), "l2": ("b", "d", 0.5, 1.7)}
    scene = Scene(
        medium="electrical",
        t_end=5.152,
        lines={name: {"nodes": [one, other], "z0": z0, "delay": t} for name, (one, other, z0, t) in lines.items()},
        sources={"s": {"at": "a", "kind": "voltage", "resistance": 0.5, "value": pulse}},
        loads={
            "x": {"kind": "parallel", "resistance": 2, "capacitance": 0.1, "at": "d"},
            "y": {"kind": "series", "resistance": 0.1, "inductance": 0.2, "at": "c"},
        },
        probes={"a": {"at": "a"}, "m": {"line": "l0", "position": "47 %"}},
    )
    result = simulate(scene, tol=1e-7)
    assert result.accuracy.met == met
    for probe in summary(result, result.accuracy)["probes"].values():
        for seen in probe.values():
            assert abs(seen["maximum"] - 2 / 3) <= seen["error_inside_slabs"]


@pytest.mark.parametrize("share", ["0 %", "37 %", "100 %"])
def test_extremes_lie_between_samples(share):
    """A sine's peaks, of the first wave alone."""
    sine = {"shape": "sine", "amplitude": 2.0, "frequency": 3.1, "until": 5.0}
    load, probes = {"kind": "resistor", "resistance": 1.0}, {"p": {"line": "line", "position": share}}
    scene = behind_one("electrical", sine, load, 0.99, LINE | {"delay": 0.5}, probes=probes)
    probe = run(describe(scene), Resolution(12, 0.05)).probes["p"]
    (low, low_at), (high, high_at) = extremes(probe, "u")
    late = 0.5 * float(share[:-2]) / 100
    assert (low, high) == pytest.approx((-1.0, 1.0), abs=1e-10)
    assert high_at == pytest.approx(late + 0.25 / 3.1, abs=1e-5)
    assert low_at == pytest.approx(late + 0.75 / 3.1, abs=1e-5)


def test_envelopes_know_their_errors():
    scene = diode({"shape": "sine", "amplitude": "2 V", "frequency": "80 MHz"})
    rough, fine = (simulate(scene, tol=tol, envelope=True).envelope for tol in (1e-3, 1e-6))
    for name in ("lowest", "highest"):
        off = np.abs(getattr(rough, name) - getattr(fine, name))
        told = getattr(rough, f"{name}_error") + getattr(fine, f"{name}_error")
        assert (told <= 2e-3 * np.abs(fine.highest)).all()
        assert (off <= FACTOR * told + 1e-12).all()


def test_an_accuracy_that_knows_nothing_is_not_met():
    assert Accuracy(1e-6).worst == math.inf
    assert not Accuracy(1e-6).met


def test_envelopes_of_bent_waves_lie_within_their_errors():
    """A diode's echoes at a node without a probe, to a rough tolerance and to a fine one."""
    lines = {"l0": ("a", "b", 0.5, 0.3), "l1": ("b", "c", 0.5, 0.3), "l2": ("b", "d", 1.0, 0.5**0.5)}
    step = {"shape": "step", "to": 1, "at": 1.574193883109602}
    scene = Scene(
        medium="electrical",
        t_end=5.58,
        start="steady",
        lines={name: {"nodes": [one, other], "z0": z0, "delay": t} for name, (one, other, z0, t) in lines.items()},
        sources={"s": {"at": "a", "kind": "voltage", "resistance": 0.5, "value": step}},
        loads={
            "x": {"kind": "parallel", "resistance": 2, "capacitance": 0.1, "at": "d"},
            "y": {"kind": "diode", "saturation": 1e-3, "temperature": 1000, "at": "c"},
        },
        probes={"c": {"at": "c"}, "d": {"at": "d"}, "m": {"line": "l0", "position": "47 %"}},
    )
    rough, fine = (simulate(scene, tol=tol, envelope=True).envelope for tol in (1e-3, 1e-6))
    for name in ("lowest", "highest"):
        off = np.abs(getattr(rough, name) - getattr(fine, name))
        assert (off <= getattr(rough, f"{name}_error") + getattr(fine, f"{name}_error") + 1e-14).all()


def rubbing(value: dict, **more) -> Scene:
    """A pipe with quadratic friction into an orifice."""
    pipe = {"length": 1e3, "radius": 0.025, "density": 900, "wave_speed": 1e3, **more}
    return Scene(
        medium="hydraulic",
        t_end=8.0,
        lines={"l": {"nodes": ["a", "b"], **pipe, "friction": {"kind": "darcy", "factor": 0.03}}},
        sources={"s": {"at": "a", "kind": "pressure", "value": value, "resistance": 0}},
        loads={"r": {"at": "b", "kind": "orifice", "flow": 1e-3, "pressure_drop": 1e5}},
        probes={"near": {"at": "a"}, "far": {"at": "b"}},
    )


CORNERS = {
    "shape": "piecewise linear",
    "points": [[1.2207742, 0], [1.4832828, 1.4e5], [1.9529538, -2e5], [3.2577791, 1.9e5], [4.0200224, 1.3e5]],
}


@pytest.mark.parametrize("tol", [0.1, 0.04, 0.01, 2e-3])
def test_two_runs_with_friction_that_agree_by_accident_are_not_believed(tol):
    """From slab to slab the differences here fall by 0.4, 0.6, 0.3, 0.2, 1.1 and 0.7."""
    scene = rubbing(CORNERS)
    result, fine = simulate(scene, tol=tol), run(describe(scene), Resolution(4, 2.0**-8))
    assert result.accuracy.met
    t = np.arange(1, 8 * 1024) / 1024
    for name, probe in result.probes.items():
        for letter in "uy":
            exact = getattr(fine.probes[name].at(t), letter)
            off = np.abs(getattr(probe.at(t), letter) - exact).max()
            told = getattr(result.accuracy.inside[name], letter) + 1e-12  # rounding, where the source is
            assert off <= told * np.abs(exact).max()


def test_cells_that_will_not_do_are_given_up_soon():
    """Minutes of ever narrower slabs would not reach what is asked."""
    walls = {"wall_thickness": "2 mm", "creep": [{"compliance": "1e-10 1/Pa", "time": 0.3}]}  # no diamonds with these
    accuracy = simulate(rubbing(CORNERS, **walls), tol=1e-6).accuracy
    assert not accuracy.met
    assert accuracy.limit.startswith("narrower slabs would reach")
    assert sum(attempt.samples for attempt in accuracy.attempts) < 5e5
    assert accuracy.worst < 1e-3


STIFF = {
    "receiver": ("electrical", {"kind": "parallel", "resistance": 1.0, "capacitance": 1.0}, "capacitance"),
    "vessel": ("hydraulic", {"kind": "air vessel", "gas_volume": 5.0, "gas_pressure": 0.0, "atmosphere": 5.0,
                             "exponent": 1.0}, "gas_volume"),
    "tank": ("hydraulic", {"kind": "surge tank", "tank_area": 1.0, "gravity": 1.0, "density": 1.0}, "tank_area"),
}  # fmt: skip


@pytest.mark.parametrize("kind", list(STIFF))
@pytest.mark.parametrize("fast", [1e-5, 1e-8])
def test_what_a_fast_load_does_behind_a_front_is_followed(kind, fast):
    """A step charges it far within a slab: whole slabs of any order agree on what follows; none sees how it begins."""
    result = simulate(charged(fast, kind, slab=0.25), tol=1e-3)
    soon = result.probes["far"].at(1.3337 + 1e-3 * fast).u
    assert result.accuracy.met
    assert 0.0 <= soon + 1e-3 <= 3e-3  # 1e-3 at most


def without_corner(capacitance: float, **solver) -> Scene:
    """A sine into a capacitance."""
    sine = {"shape": "sine", "amplitude": 1.0, "frequency": 0.5, "phase": "90 deg"}
    load = {"kind": "parallel", "resistance": 1.0, "capacitance": capacitance}
    return behind_one("electrical", sine, load, start="steady", solver=solver)


@pytest.mark.parametrize("capacitance", [1e-8, 1e-12])
def test_a_fast_load_that_nothing_excites_does_not_keep_a_tolerance_from_being_met(capacitance):
    """A sine that begins without a corner, into a capacitance too small to matter."""
    result = simulate(without_corner(capacitance, slab=0.25), tol=1e-6)
    t = np.linspace(1.0, 3.0, 400)
    assert result.accuracy.met
    assert np.abs(result.probes["far"].at(t).u - 0.5 * np.cos(np.pi * (t - 1.0))).max() <= 5e-7


def charged(fast: float, kind: str, at: float = 0.3337, line: dict = LINE, **solver: float) -> Scene:
    """A step into a line that ends at a fast load."""
    medium, load, key = STIFF[kind]
    step = {"shape": "step", "to": 1, "at": at}
    return behind_one(medium, step, load | {key: fast * load[key]}, line=line, solver=solver)


@pytest.mark.parametrize("kind", list(STIFF))
@pytest.mark.parametrize("fast", [1e-3, 1e-5, 1e-7])
@pytest.mark.parametrize("order", [1, 4, 7])
def test_a_run_by_hand_knows_that_it_does_not_resolve_a_fast_load(kind, fast, order):
    result = simulate(charged(fast, kind, slab=0.25, order=order))
    soon = result.probes["far"].at(1.3337 + 1e-2 * fast).u  # 1e-2 of the step at most
    told = judged(result)
    size = np.abs(result.probes["far"].u).max()
    assert soon - 1e-2 <= told.inside["far"].u * size <= 4 * soon
    assert len(told.attempts) == 2


def test_a_run_by_hand_whose_orders_converge_is_not_doubted():
    """A capacitance too small to matter behind a sine without a corner."""
    result, t = simulate(without_corner(1e-9, slab=0.25, order=4)), np.linspace(1.0, 3.0, 400)
    off = np.abs(result.probes["far"].at(t).u - 0.5 * np.cos(np.pi * (t - 1.0))).max()
    assert off <= 0.5 * judged(result).worst <= 100 * off  # the capacitance counts as one that no slab resolves


@pytest.mark.parametrize(
    ("start", "to", "atmosphere", "exponent", "slab", "volume"),
    [(0.0, 1.0, 3.0, 1.2, 0.25, 0.04), (1.9, 2.9, 0.18, 1.2, 0.25, 0.019), (0.0, 1.0, 0.7, 1.1, 0.125, 0.024)],
)
@pytest.mark.parametrize("order", [None, 4])
def test_gas_is_stiffer_under_pressure_than_without(start, to, atmosphere, exponent, slab, volume, order):
    """Its pressure does not jump; that in which a run jumps is an error, and is told."""
    step = {"shape": "step", "from": start, "to": to, "at": 0.3337}
    vessel = {"kind": "air vessel", "gas_volume": volume, "gas_pressure": 0.0, "atmosphere": atmosphere}
    solver = {"slab": slab} | ({"order": order} if order else {})
    scene = behind_one("hydraulic", step, vessel | {"exponent": exponent}, start="steady", solver=solver)
    result = simulate(scene, tol=1e-3)
    jump = abs(float(result.probes["far"].at(1.3337 + 1e-8).u) - start)
    assert jump <= result.accuracy.inside["far"].u * np.abs(result.probes["far"].u).max() + 1e-6


@pytest.mark.parametrize(
    ("kind", "solver"), [("receiver", {"slab": 0.25, "order": 3}), ("tank", {"slab": 0.25, "order": 3}), ("tank", {})]
)
def test_fast_loads_behind_lossy_lines_are_not_believed_either(kind, solver):
    """The front arrives at a slab's end; a ten-thousandth of a time constant later the load is filled to as much."""
    cable = {"length": 1.0, "inductance": 1.0, "capacitance": 1.0, "skin": {"resistance": 0.3, "frequency": 10.0},
             "resistance": 0.05}  # fmt: skip
    pipe = {"length": 1.0, "wave_speed": 1.0, "density": 1.0, "radius": math.pi**-0.5,
            "friction": {"kind": "darcy", "factor": 0.3}}  # fmt: skip
    fast = 1e-7 if kind == "receiver" else 4e-3
    result = simulate(charged(fast, kind, 0.5, cable if kind == "receiver" else pipe, **solver), tol=1e-2)
    soon, largest = float(result.probes["far"].at(1.5 + 1e-4 * fast).u), np.abs(result.probes["far"].u).max()
    assert abs(soon - 1e-4 * largest) <= FACTOR * result.accuracy.inside["far"].u * largest


TOL = 1e-7


@settings(max_examples=7, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_effort_and_flow_are_within_the_tolerance(seed):
    scene = random_scene(seed, lines=3, sources=True, switches=False)
    scene = Scene(**scene.table() | {"t_end": 6.0})
    result = simulate(scene, tol=TOL)
    seen = result.probes["p"].samples
    few = np.linspace(1, len(seen.t) - 1, 25).astype(int)
    few = few[seen.t[few] <= 6.0]
    true, z0 = exact(scene, seen.t[few].tolist(), "p"), result.probes["p"].record.z0
    for found, expected in ((seen.u[few], true.efforts), (z0 * seen.y[few], z0 * true.flows)):
        amplitude = max(np.abs(true.efforts).max(), z0 * np.abs(true.flows).max())
        assert np.abs(found - expected).max() <= 3 * TOL * amplitude
