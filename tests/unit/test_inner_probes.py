"""What is told of a probe at a node where no line ends, or several meet: its effort, and no flow."""

import numpy as np
import pytest
from one_line import one_line

from tline import Scene, plot, simulate
from tline.cli.report import as_table, summary
from tline.frequency.response import respond
from tline.solver.result.export import save_csv, save_npz


def result_of(*probes):
    links = {"r": {"kind": "resistor", "nodes": ["far", "inner"], "resistance": 30}}
    loads = {"end": {"at": "inner", "kind": "resistor", "resistance": 20}}
    places = {name: {"at": name} for name in probes}
    return simulate(one_line(5, {"z0": 50, "delay": 1}, 1, 25, links=links, loads=loads, probes=places))


@pytest.fixture(scope="module")
def result():
    return result_of("inner", "far")


def test_tables(result, tmp_path):
    told = summary(result, result.accuracy)
    assert list(told["probes"]["inner"]) == ["voltage"]
    assert list(told["probes"]["far"]) == ["voltage", "current"]
    assert [line.split()[0] for line in as_table(result, result.accuracy).splitlines()[-3:]] == [
        "inner",
        "far",
        "current",
    ]
    save_csv(result, tmp_path / "out.csv")
    head = (tmp_path / "out.csv").read_text().partition("\n")[0].split(",")
    assert head == [
        "time [s]",
        "inner voltage [V]",
        *(f"far {x}" for x in ("voltage [V]", "current [A]", "a [V]", "b [V]")),
    ]
    save_npz(result, tmp_path / "out.npz")
    kept = np.load(tmp_path / "out.npz")
    assert [key for key in kept if key.startswith("inner")] == ["inner/u"]
    assert kept["inner/u"][-1] == pytest.approx(0.4 * kept["far/u"][-1], rel=1e-12)


def test_pictures(result):
    effort, flow = plot(result).axes
    assert (len(effort.lines), len(flow.lines)) == (2, 1)
    assert flow.lines[0].get_color() == effort.lines[1].get_color()
    (alone,) = plot(result_of("inner")).axes
    assert alone.get_ylabel().startswith("voltage at inner")


def test_in_python(result):
    inner = result.probes["inner"]
    assert not inner.has_flow
    assert result.probes["far"].has_flow
    assert not inner.y.any()
    assert (inner.a == inner.u).all()


def test_a_probe_at_a_junction_sees_the_effort_that_all_lines_have_there():
    line = {"z0": 50, "delay": 1}
    scene = Scene(
        medium="electrical",
        t_end=7,
        lines={name: line | {"nodes": ["far", name] if name != "in" else ["near", "far"]} for name in ("in", "a", "b")},
        sources={"s": {"at": "near", "kind": "voltage", "value": 1, "resistance": 25}},
        probes={"alone": {"at": "far"}, "of a": {"at": "far", "line": "a"}},
    )
    result = simulate(scene)
    alone, beside = result.probes["alone"], result.probes["of a"]
    assert (alone.has_flow, beside.has_flow) == (False, True)
    assert alone.u == pytest.approx(beside.u, abs=1e-12)
    seen = respond(scene, [0.3j])
    assert seen["alone"].u == pytest.approx(seen["of a"].u, rel=1e-12)
