"""Liquid between shut laws keeps its pressure: closed forms."""

import numpy as np
import pytest

import tline as tl

PIPE = {"length": "1 km", "diameter": "20 cm", "wave_speed": 1000, "density": 1000}
SHUTS = {"shape": "ramp", "from": 1, "to": 0, "at": "1 s", "duration": "2 s"}


def station(links, nodes, **solver):
    """Run 12 s of a main behind links from a sump at 0.5 bar to a lake at 4 bar."""
    return tl.simulate(
        tl.Scene(
            medium="hydraulic",
            t_end="12 s",
            start="steady",
            lines={"main": {"nodes": ["main", "lake"], **PIPE}},
            loads={
                "sump": {"at": "sump", "kind": "reservoir", "pressure": "0.5 bar"},
                "lake": {"at": "lake", "kind": "reservoir", "pressure": "4 bar"},
            },
            links=links,
            probes={name: {"at": name} for name in nodes},
            solver=solver,
        )
    )


@pytest.mark.parametrize("solver", [{"tol": 1e-6}, {"order": 1, "slab": "10 ms", "rounded": True}])
@pytest.mark.parametrize("parted", [False, True])
def test_header_keeps_the_rise_at_no_flow(solver, parted):
    """Between a pump's check valve and a valve that shuts, also beside an open valve, the rise at rest stays."""
    curve = [["0 L/s", "6 bar"], ["40 L/s", "5 bar"], ["60 L/s", "4 bar"]]
    links = {
        "pump": {"kind": "pump", "nodes": ["sump", "header"], "curve": curve, "check_valve": True},
        "throttle": {"kind": "orifice", "nodes": ["header", "main"], "kv": 500, "opening": SHUTS},
    }
    if parted:
        links["pump"]["nodes"] = ["sump", "behind"]
        links["open"] = {"kind": "orifice", "nodes": ["behind", "header"], "kv": 800}
    result = station(links, ["header", "main"], **solver)
    late = np.linspace(3.1, 12, 90)
    assert result.accuracy is None or result.accuracy.met
    assert result.probes["main"].at(late).u.max() > 12e5  # Joukowsky's swing of what stood in the main
    assert result.probes["header"].at(late).u == pytest.approx(6.5e5, rel=1e-5)


@pytest.mark.parametrize("order", [3, 5, 8, 9])
def test_header_keeps_it_where_the_valve_shuts_within_a_slab(order):
    """The last point of the piece that ends as the valve shuts finds it open by rounding alone."""
    links = {
        "pump": {"kind": "pump", "nodes": ["sump", "header"], "curve": [["40 L/s", "5 bar"]], "check_valve": True},
        "throttle": {
            "kind": "orifice", "nodes": ["header", "main"], "flow": "0.99 m^3/s", "pressure_drop": "2500 Pa",
            "opening": {"shape": "ramp", "from": 1, "to": 0, "at": "1 s", "duration": "1 ms"},
        },
    }  # fmt: skip
    result = station(links, ["header"], order=order, slab="7.8125 ms")
    assert result.probes["header"].at(np.linspace(1.002, 12, 90)).u == pytest.approx(0.5e5 + 4 / 3 * 5e5, rel=1e-12)


def test_pocket_keeps_the_highest_pressure_before_its_check_valve():
    """Behind a check valve that leads to a shut valve there stays the highest pressure that there has been."""
    links = {
        "check": {"kind": "check valve", "nodes": ["main", "pocket"], "flow": "20 L/s", "pressure_drop": "1 bar"},
        "shut": {"kind": "orifice", "nodes": ["pocket", "sump"], "kv": 100, "opening": {**SHUTS, "duration": "10 ms"}},
    }
    result = station(links, ["pocket", "main"], tol=1e-6)
    t = np.linspace(1.1, 12, 1091)
    highest = np.maximum.accumulate(result.probes["main"].at(np.linspace(1.0, 1.1, 200)).u)[-1]
    assert result.probes["pocket"].at(t).u == pytest.approx(highest, rel=1e-3)


@pytest.mark.parametrize("tol", [1e-3, 1e-6])
@pytest.mark.parametrize("row", ["check", "pump", "pump check", "check check check"])
def test_pocket_follows_a_swinging_pressure_to_each_of_its_peaks(row, tol):
    """Behind valves in a row, which let nothing back: the highest pressure so far, and what the pumps add to it."""
    check = {"kind": "check valve", "flow": "20 L/s", "pressure_drop": "1 bar"}
    pump = {"kind": "pump", "curve": [["0 L/s", "3 bar"], ["40 L/s", "2 bar"]], "check_valve": True}
    names = ["main", *(f"between{k}" for k in range(row.count(" "))), "pocket"]
    each = zip(row.split(), names, names[1:], strict=False)
    kinds = {"check": check, "pump": pump}
    links = {f"to {after}": kinds[kind] | {"nodes": [node, after]} for kind, node, after in each}
    links["shut"] = {"kind": "orifice", "nodes": ["pocket", "sump"], "kv": 100, "opening": 0}
    swing = {"shape": "sine", "amplitude": "1 bar", "frequency": "0.37 Hz"}
    ripple = {"shape": "sine", "amplitude": "4 L/s", "frequency": "0.81 Hz"}
    scene = {
        "medium": "hydraulic", "t_end": "12 s", "start": "steady", "links": links,
        "lines": {"main": {"nodes": ["main", "lake"], **PIPE}},
        "sources": {
            "swing": {"at": "main", "kind": "pressure", "value": swing, "resistance": 1e7},
            "ripple": {"at": "main", "kind": "flow", "value": ripple},
        },
        "loads": {
            "lake": {"at": "lake", "kind": "reservoir", "pressure": "4 bar"},
            "sump": {"at": "sump", "kind": "reservoir", "pressure": "0.5 bar"},
        },
        "probes": {"main": {"at": "main"}, "pocket": {"at": "pocket"}},
    }  # fmt: skip
    result = tl.simulate(scene, tol=tol)
    t = np.linspace(0, 12, 100_001)
    before = result.probes["main"].at(t).u  # nothing passes: these waves are smooth, and known far better
    highest = np.maximum.accumulate(before) + 3e5 * row.count("pump")
    missed = 1e-8  # peaks lie between instants
    off = np.abs(result.probes["pocket"].at(t).u / highest - 1).max()
    assert result.accuracy.met
    assert off <= 3 * result.accuracy.inside["pocket"].u + missed
    assert len(result.accuracy.attempts) <= 10  # twice as narrow slabs would gain a half each
