"""Elements that are not linear take energy and give none; a steady state stays; what is cut off stands still."""

from itertools import pairwise

import numpy as np
import pytest
from energy import in_pieces, never_grows, on_lines, silent
from hypothesis import given, settings, strategies as st
from random_elements import random_elements
from random_pockets import random_pockets

from tline import InputError, Scene
from tline.scene.air_valve import Air
from tline.scene.vessel import Gas, Tank, Vapour
from tline.solver.assembly.assemble import Assembly, assemble
from tline.solver.description.description import describe
from tline.solver.kernel.stores import gas, rotor, tank
from tline.solver.loop.march import Stepper
from tline.solver.simulate import simulate
from tline.solver.steady.steady_state import steady_state

AIR, GAS, TANK, VAPOUR = (kind.number for kind in (Air, Gas, Tank, Vapour))
AT_ONCE = 2e-14  # of the energy at the start, in one slab: roundings of waves and of the laws' solutions


def in_elements(assembly: Assembly) -> float:
    """Energy in gas and in surge tanks: half the square of the state, times what makes it J."""
    laws, total = assembly.network.laws, 0.0
    for kind, at, place in zip(laws.kind, laws.at, laws.state_at, strict=True):
        if place >= 0:
            c = laws.constants[at:]
            if kind == VAPOUR:
                total -= c[0] * assembly.state.load[place]
                continue
            if kind == AIR:
                volume, air = assembly.state.load[place : place + 2]
                total += c[1] * (air * np.log(air / volume) + volume - air) if air else 0.0
                continue
            unit = c[2] * c[3] if kind == GAS else c[2]
            stored = (gas if kind == GAS else tank if kind == TANK else rotor).stored
            total += unit * stored(laws.constants, at, assembly.state.load[place])[0] ** 2 / 2
    return total


@settings(max_examples=6, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), order=st.integers(1, 8), slab=st.floats(0.06, 0.49))
def test_stored_energy_never_grows(seed, order, slab):
    """Any order, any slab, any delays, openings that move: waves, gas and tanks together only lose."""
    scene = random_elements(seed, solver={"order": order, "slab": slab})
    assembly = silent(scene, seed)
    n = int(scene.t_end / 2 / slab)  # openings move until then
    steps = Stepper(assembly, n, np.zeros((0, 2, n * order)))
    energies = []
    for low, high in pairwise(range(n)):
        waiting = 0.0 if steps.fronts is None else in_pieces(steps)
        energy = on_lines(assembly) + waiting + in_elements(assembly)
        energies.append(energy)
        assert energy <= energies[max(len(energies) - 2, 0)] + AT_ONCE * energies[0]
        steps.advance(low, high)


@settings(max_examples=5, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), order=st.integers(1, 6), slab=st.floats(0.1, 0.49))
def test_nothing_moves_where_nothing_is_operated(seed, order, slab):
    scene = random_elements(seed, operated=False, driven=True, start="steady", solver={"order": order, "slab": slab})
    scene = type(scene)(**scene.table() | {"t_end": 60.0})
    result = simulate(scene, record=list(scene.lines))
    scale = max(abs(wave.before) for line in result.lines.values() for wave in (line.a1, line.b1))
    for line in result.lines.values():
        for wave in (line.a1, line.b1, line.a2, line.b2):
            assert np.abs(wave.values - wave.before).max() <= 1e-9 * scale


def test_the_tests_cover_every_kind():
    """Random scenes hold each kind of law that stores or takes energy."""
    kinds = {law.kind for seed in range(60) for law in random_elements(seed).laws.values()}
    assert kinds == {"quadratic", "relief", "leak", "demand", "diode", "table", "gas", "tank", "vapour", "air"}
    assert assemble(describe(random_elements(3)), set()).network.laws.kind.size


LINE = {"diameter": 0.2, "wave_speed": 1000, "density": 1000}
KEEPS = {"downstream": "set_pressure", "upstream": "set_pressure", "level": "set_pressure", "flow": "set_flow"}


def valve(rng: np.random.Generator, keeps: str) -> dict:
    time = {"time_constant": float(10 ** rng.uniform(-1, 1))} | ({"stroke_time": 0.1} if rng.random() < 0.5 else {})
    kept = {KEEPS[keeps]: float(rng.uniform(0.1, 2)) * (1e-3 if keeps == "flow" else 1e5)}
    bore = {"loss_coefficient": 2, "diameter": 0.2, "opening": float(rng.random())}
    return {"kind": "regulating valve", "keeps": keeps} | time | kept | bore


def disc(rng: np.random.Generator) -> dict:
    moves = {"disc_mass": float(10 ** rng.uniform(0, 2)), "travel": 0.1, "damping": float(rng.choice([0, 100]))}
    return {"kind": "check valve", "loss_coefficient": 2, "diameter": 0.2, "cracking_pressure": 100} | moves


def chattering(seed):
    """Seeds whose discs or valves once left flows so near to zero that they were not found within 20 s."""
    return pytest.param(seed, 20, id=f"{seed} for longer")


@pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")  # corners of the pulse
@pytest.mark.parametrize("order", [1, 2, 3, 5])
@pytest.mark.parametrize(("seed", "t_end"), [*((k, 8) for k in range(3)), *map(chattering, (127, 155, 171))])
def test_energy_never_grows(order, seed, t_end):
    """Three pipes and two of them in a row, after a pulse at one end; both ends are dead."""
    rng = np.random.default_rng(seed)
    first = valve(rng, [*KEEPS][seed % 4])
    second = disc(rng) if seed % 2 else valve(rng, "downstream")
    kick = {"shape": "piecewise linear", "points": [[0, 0], [0.05, 0.02], [0.3, 0.0]]}
    scene = Scene(
        medium="hydraulic",
        t_end=t_end,
        lines={
            "p1": {"nodes": ["s", "a"], "length": 100, **LINE},
            "p2": {"nodes": ["b", "e"], "length": float(rng.uniform(50, 300)), **LINE},
            "p3": {"nodes": ["c", "f"], "length": 70, **LINE},
        },
        links={"one": {"nodes": ["a", "b"], **first}, "two": {"nodes": ["b", "c"], **second}},
        sources={"kick": {"at": "s", "kind": "flow", "value": kick}},
        probes={"e": {"at": "e"}},
        solver={"order": order, "slab": float(rng.uniform(0.005, 0.03))},
    )
    ledger = simulate(scene, ledger=True).ledger
    for entry in ledger.entries:
        if entry.where.startswith("links"):
            assert entry.created <= 1e-12 * ledger.turnover, entry


ORDERS, SLABS, SEEDS = st.integers(1, 7), st.floats(0.05, 0.49), st.integers(0, 2**32 - 1)


def only_loses(load: dict, weight: int, order: int, slab: float, seed: int) -> None:
    """At the end of a pipe; half of one of its law's constants times its state squared is held."""
    scene = Scene(
        medium="hydraulic",
        t_end=20.0,
        lines={"pipe": {"nodes": ["a", "b"], "z0": 1.0, "delay": 1.0}},
        loads={"x": {"at": "b"} | load},
        probes={"b": {"at": "b"}},
        solver={"order": order, "slab": slab},
    )

    def held(assembly):
        laws = assembly.network.laws
        return laws.constants[weight] * assembly.state.load[laws.state_at[0]] ** 2 / 2

    never_grows(scene, seed, held, AT_ONCE)


@settings(max_examples=12, deadline=None)
@given(
    seed=SEEDS,
    order=ORDERS,
    slab=SLABS,
    bottom=st.floats(-0.5, 0.0),
    rim=st.floats(0.01, 0.5),
    losses=st.tuples(st.floats(1e-3, 5), st.floats(1e-3, 5)),
    one_way=st.booleans(),
)
def test_a_tank_with_a_rim_and_a_bottom(seed, order, slab, bottom, rim, losses, one_way):
    ends = {"lowest_level": bottom, "highest_level": rim, "loss_in": losses[0], "loss_out": losses[1]}
    tank = {"kind": "open tank", "tank_area": 1.0, "bore": 1.0, "gravity": 1.0, "density": 1.0, "one_way": one_way}
    only_loses(tank | ends, 3, order, slab, seed)


@settings(max_examples=12, deadline=None)
@given(
    seed=SEEDS,
    order=ORDERS,
    slab=SLABS,
    preload=st.floats(-0.5, 0.5),
    stroke=st.floats(0.05, 0.5),
    stiffness=st.floats(0.1, 10),
)
def test_an_accumulator_on_a_spring(seed, order, slab, preload, stroke, stiffness):
    spring = {"stiffness": stiffness, "preload": preload, "stroke": stroke}
    only_loses({"kind": "spring accumulator", "piston_diameter": 1.0} | spring, 1, order, slab, seed)


STILL = 1e-8  # of the largest effort: roots of drops within rounding, and what pockets shift to bound a valve exactly
PIPE = {"length": 300, "diameter": 0.1, "wave_speed": 1000, "density": 1000}
ROUGH = PIPE | {"friction": {"kind": "darcy", "factor": 0.02}}
CHECK = {"kind": "check valve"}


@given(seed=st.integers(0, 2**32 - 1), order=st.integers(1, 3))
@settings(max_examples=4, deadline=None)
@pytest.mark.filterwarnings("ignore::tline.solver.simulate.UnresolvedWarning")
def test_nothing_operated_nothing_moves(seed, order):
    envelope = simulate(random_pockets(seed, solver={"order": order}), envelope=True, ledger=False).envelope
    assert envelope is not None
    by = np.maximum(envelope.highest - envelope.start, envelope.start - envelope.lowest)
    assert by.max() <= STILL * np.abs(envelope.start).max()


def steady(lines: dict, links: dict, loads: dict, **more):
    """Steady efforts and flows; where a load is a pressure alone, a reservoir of that name stands at that node."""
    loads = {
        name: load if isinstance(load, dict) else {"at": name, "kind": "reservoir", "pressure": load}
        for name, load in loads.items()
    }
    given = {"medium": "hydraulic", "t_end": 1, "start": "steady", "probes": {"p": {"at": lines["first"]["nodes"][0]}}}
    return steady_state(describe(Scene(**given, lines=lines, links=links, loads=loads, **more)))


def row(*links: dict, start: float | None = None) -> dict[str, float]:
    """Steady efforts of a reservoir of 5 bar, elements in a row with pipes between, and one of 8 bar at the end."""
    lines, between = {"first": ROUGH | {"nodes": ["lake", "n0"]}}, {}
    for k, link in enumerate(links):
        between[f"link{k}"] = {"nodes": [f"n{k}", f"m{k}"]} | link
        lines[f"pipe{k}"] = ROUGH | {"nodes": [f"m{k}", f"n{k + 1}"]}
    loads = {"lake": "5 bar", f"n{len(links)}": "8 bar"}
    return steady(lines, between, loads, nodes={} if start is None else {"m0": {"start": start}})[0]


SHUT = {"kind": "orifice", "kv": 10, "opening": 0}
CRACKING = CHECK | {"cracking_pressure": "1 bar"}
RELIEF = {"kind": "relief valve", "set_pressure": "12 bar", "band": "1 bar", "kv": 100}


@pytest.mark.parametrize(
    ("links", "bar"),
    [
        ((CHECK, CHECK), 5),  # as if filled from the reservoir below
        ((CRACKING, CHECK), 4),
        ((SHUT, CHECK), 8),  # the largest that does not open toward the reservoir above
        ((SHUT, SHUT), 5),
        ((CHECK, SHUT), 5),
        ((RELIEF, SHUT), 5),  # it could hold 12 bar, and would leave a vacuum
    ],
)
def test_a_pocket_in_a_row(links, bar):
    effort = row(*links)
    assert [effort["m0"], effort["n1"]] == pytest.approx([bar * 1e5] * 2, rel=1e-9)


def test_a_pocket_starts_with_what_it_is_said_to():
    assert row(CHECK, CHECK, start=6.5e5)["n1"] == pytest.approx(6.5e5, rel=1e-12)
    assert row(SHUT, SHUT, start=2e5)["n1"] == pytest.approx(2e5, rel=1e-12)
    with pytest.raises(InputError, match=r"nodes\.m0\.start: a valve would open, expected such as 500000 Pa"):
        row(CHECK, CHECK, start=4e5)


@pytest.mark.parametrize("flow", [1e-2, 1e-5, 1e-8, 1e-11])
@pytest.mark.parametrize("drop", [1e-1, 1e3, 1e7])
def test_a_tight_valve_before_a_dead_end(flow, drop):
    """However little it lets pass, the same pressure is behind it."""
    lines = {"first": ROUGH | {"nodes": ["lake", "a"]}, "second": ROUGH | {"nodes": ["b", "end"]}}
    tight = {"kind": "orifice", "nodes": ["a", "b"], "flow": flow, "pressure_drop": drop}
    out = {"at": "a", "kind": "orifice", "flow": 5e-3, "pressure_drop": "14 bar"}
    effort, _ = steady(lines, {"tight": tight}, {"lake": "15 bar", "out": out})
    assert effort["end"] == pytest.approx(effort["a"], rel=1e-9)


SUCTION = {"first": PIPE | {"nodes": ["sump", "a"]}, "second": PIPE | {"nodes": ["b", "end"]}}
PUMP = {"kind": "pump", "nodes": ["a", "b"], "curve": [[0.01, 3e5]]}


@pytest.mark.parametrize("pressure", [0.0, 1.0, 1e5])
@pytest.mark.parametrize("pump", [{"speed": 0}, {"speed": 0, "check_valve": True}, {}, {"check_valve": True}])
@pytest.mark.parametrize("end", [{}, SHUT, {"kind": "vapour cavity"}])
def test_a_pump_that_draws_from_the_open_air_fills_a_dead_end(pressure, pump, end):
    """Nothing flows, and the largest effort is the pump's own."""
    loads = {"sump": pressure} | ({"end": end | {"at": "end"}} if end else {})
    effort, flows = steady(SUCTION, {"pump": PUMP | pump}, loads)
    assert effort["end"] == pytest.approx(pressure + (0 if "speed" in pump else 4e5), rel=1e-9, abs=1e-9)
    assert np.abs(flows).max() < 1e-12


def test_a_flow_that_nothing_takes_is_refused():
    source = {"s": {"at": "end", "kind": "flow", "value": "1 mL/s"}}
    links, loads = {"pump": PUMP | {"check_valve": True}}, {"sump": {"at": "sump", "kind": "short"}}
    with pytest.raises(InputError, match=r"sources\.s: no steady state: nothing takes the flow"):
        steady(SUCTION, links, loads, sources=source)


@pytest.mark.parametrize("seed", [73, 78, 87])
def test_a_scene_in_which_nothing_moves_is_computed(seed):
    assert simulate(random_elements(seed), tol=1e-3).accuracy.met
