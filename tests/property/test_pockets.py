"""What valves cut off stands still, however they hold it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_pockets import random_pockets

from tline import InputError, Scene, simulate
from tline.solver.description.description import describe
from tline.solver.steady.steady_state import steady_state

STILL = 1e-8  # of the largest effort: roots of drops within rounding, and what pockets shift to bound a valve exactly
PIPE = {"length": 300, "diameter": 0.1, "wave_speed": 1000, "density": 1000}
ROUGH = PIPE | {"friction": {"kind": "darcy", "factor": 0.02}}
CHECK = {"kind": "check valve"}


@given(seed=st.integers(0, 2**32 - 1), order=st.integers(1, 3))
@settings(max_examples=6, deadline=None)
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
