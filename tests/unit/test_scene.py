"""Scenes piece by piece: numbers and names, elements, probes, the schema, nodes, order and slab width."""

import pickle
import time
import tomllib
from fractions import Fraction
from pathlib import Path

import jsonschema
import numpy as np
import pytest
import tomli_w
from random_scenes import random_scene

from passivity import RationalFunction
from tline import InputError, Scene
from tline.scene import Cable, Impedance, Parallel, Pipe, Probe, Ramp, Resistor, Series, Source, Step
from tline.scene.file import read_scene, schema
from tline.scene.quantity import Quantity
from tline.solver.description.description import describe
from tline.solver.description.resolution import resolution
from tline.solver.description.slab import CHEAP, MOST_KEPT
from tline.words.wording import nearest, place, shown

SCENES = sorted((Path(__file__).parents[2] / "scenes").glob("*.toml"))


def scene(delays=(1.0,), **parts) -> Scene:
    """A chain of lines."""
    lines = {f"l{k}": {"nodes": [f"n{k}", f"n{k + 1}"], "z0": 50, "delay": delay} for k, delay in enumerate(delays)}
    whole = {"medium": "electrical", "t_end": 10.0, "lines": lines, "probes": {"p": {"at": "n0"}}}
    return Scene(**whole | parts)


# numbers and names


def test_a_quantity_remembers_what_was_typed():
    for typed, kept in (("10 cm", "10 cm"), (2, 2), (0.5, 0.5), (np.float64(0.5), 0.5), (np.int64(2), 2.0)):
        quantity = Quantity(typed, "m")
        assert quantity.typed == kept
        assert type(quantity.typed) in (int, float, str)
        again = pickle.loads(pickle.dumps(quantity))
        assert (again, again.typed) == (quantity, kept)


def test_an_element_alone_takes_any_unit_and_the_scene_looks_again():
    load = Resistor(at="n1", resistance="3 bar/(m^3/s)")
    assert load.resistance == 3e5
    with pytest.raises(InputError, match=r"loads\.r\.resistance: this unit measures something else"):
        scene(loads={"r": load})


def test_names_may_be_any_visible_text():
    names = ["a.b", "with space", "καλώδιο", "'quoted'", '"', "1", "kind", "lines", "step"]
    lines = {name: {"nodes": [name, name + "'"], "z0": 50, "delay": 1} for name in names}
    probes = {name: {"at": name} for name in names}
    made = scene(lines=lines, probes=probes, loads={name: {"at": name, "kind": "open"} for name in names})
    assert list(made.lines) == list(made.loads) == names


def test_places_read_as_in_the_file():
    assert place("lines", "pipe", "nodes", 0) == "lines.pipe.nodes[0]"
    assert place("loads", "a.b", "at") == 'loads."a.b".at'
    assert place("loads", "", 'x"y\n') == 'loads.""."x\\"y\\n"'


def test_what_is_quoted_is_short():
    deep: list = []
    for _ in range(10**5):
        deep = [deep]
    for value in ("x" * 10**6, list(range(10**6)), {"a": deep}, deep, 10**10**4, dict.fromkeys(range(99), "x" * 99)):
        assert len(shown(value)) <= 60
    assert shown("near") == "'near'"


def test_the_nearest_word():
    known = ["wave_speed", "z0", "delay"]
    assert nearest("wavespeed", known) == "'wave_speed'"
    assert nearest("Z0", known) == "'z0'"
    assert nearest("mass", known) == "one of 'wave_speed', 'z0', 'delay'"
    assert nearest("x", ["far"]) == "'far'"
    assert nearest("none", [f"node {k}" for k in range(10**5)]).endswith("'node 15' and 99984 more")


# elements


def test_lines_know_all_their_quantities():
    pipe = Pipe(nodes=("a", "b"), radius="10 cm", wave_speed=1500, density=980, length="300 m")
    assert pipe.parameters.z0 == pytest.approx(1500 * 980 / (np.pi * 0.01))
    assert pipe.parameters.delay == pytest.approx(0.2)
    cable = Cable(nodes=["a", "b"], z0="50 ohm", velocity_factor="66 %", length="2 m")
    assert cable.parameters.delay == pytest.approx(2 / (0.66 * 299_792_458))
    assert pickle.loads(pickle.dumps(cable)) == cable


def test_impedances_are_exact_for_the_decimals_typed():
    s = RationalFunction.from_coefficients([1, 0], [1])
    R, L, C = Fraction("0.1"), Fraction("3e-9"), Fraction("2e-12")
    parts = {"resistance": 0.1, "inductance": "3 nH", "capacitance": "2 pF"}
    assert Series(at="n", **parts).rational() == R + L * s + 1 / (C * s)
    assert Parallel(at="n", **parts).rational() == 1 / (1 / R + 1 / (L * s) + C * s)
    typed = Impedance(at="n", expression="R + s*L", parameters={"R": 0.1, "L": "3 nH"}).rational()
    assert typed == R + L * s
    assert Impedance(at="n", numerator=[3e-9, "0.1"], denominator=[1]).rational() == typed
    assert Impedance(at="n", numerator=[10**20 + 1, 0.1], denominator=[1]).rational() == s * (10**20 + 1) + R


def test_a_system_of_scipy_is_an_impedance():
    from scipy.signal import lti

    load = Impedance.from_system(lti([0.3, 1], [2, 1]), at="n")
    exact = RationalFunction.from_coefficients([0.3, 1], [2, 1])
    assert load.rational() == exact
    again = Impedance(**tomllib.loads(tomli_w.dumps(load.table())))
    assert again.rational() == exact


def test_a_source_is_an_effort_or_a_flow_behind_its_resistance():
    kinds = {"voltage": True, "pressure": True, "current": False, "flow": False}
    for kind, is_effort in kinds.items():
        assert Source(at="n", kind=kind, value=1).is_effort == is_effort
        assert Source(at="n", kind=kind, value=1).conductance == (np.inf if is_effort else 0.0)
        assert Source(at="n", kind=kind, value=1, resistance=4).conductance == 0.25
        assert Source(at="n", kind=kind, value=1, resistance="inf").conductance == 0.0
    assert Source(at="n", kind="voltage", value=1, resistance=0).conductance == np.inf


@pytest.mark.parametrize(
    ("probe", "share"),
    [
        ({"at": "a", "line": "x"}, 0.0),
        ({"at": "b", "line": "x"}, 1.0),
        ({"line": "x", "position": 0}, 0.0),
        ({"line": "x", "position": 0.5}, 0.25),
        ({"line": "x", "position": "50 cm"}, 0.25),
        ({"line": "x", "position": "2 m"}, 1.0),
        ({"line": "x", "position": "25 %"}, 0.25),
        ({"line": "x", "position": "100%"}, 1.0),
    ],
)
def test_probes_know_their_place(probe, share):
    line = Cable(nodes=("a", "b"), z0=50, wave_speed=2e8, length="2 m")
    assert Probe(**probe).fraction(line) == pytest.approx(share, abs=1e-15)


def test_a_probe_at_both_ends_of_a_line_is_at_end_1():
    loop = scene(lines={"loop": {"nodes": ["n0", "n0"], "z0": 1, "delay": 1}})
    assert loop.probes["p"].fraction(loop.lines["loop"]) == 0.0


# the schema


def tables(node, path=()):
    """All tables with keys in a schema."""
    if isinstance(node, dict):
        if "properties" in node:
            yield path, node
        for key, value in node.items():
            yield from tables(value, (*path, key))


def test_the_schema_describes_every_key():
    whole = schema()
    jsonschema.Draft202012Validator.check_schema(whole)
    found = dict(tables(whole))
    assert len(found) > 20
    for path, table in found.items():
        for key, value in table["properties"].items():
            assert value.get("description"), (path, key)
        for word in ("kind", "shape"):
            assert word not in table["properties"] or word in table["required"]
    assert whole["properties"]["t_end"]["unit"] == "s"
    assert whole["$defs"]["Pipe"]["properties"]["length"]["anyOf"][0]["unit"] == "m"


@pytest.fixture(scope="module")
def accepts():
    """Raises where a table is not as the schema says."""
    return jsonschema.Draft202012Validator(schema()).validate


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_the_schema_accepts_the_scenes(path, accepts):
    accepts(tomllib.loads(path.read_text(encoding="utf-8")))


@pytest.mark.parametrize(
    ("section", "element"),
    [
        ("loads", {"at": "n0", "kind": "resistor"}),
        ("loads", {"at": "n0", "pressure": 5}),
        ("loads", {"at": "n0", "kind": "resistor", "resistance": -1}),
        ("loads", {"at": "n0", "kind": "resistor", "resistance": True}),
        ("sources", {"at": "n0", "kind": "voltage", "value": {"to": 1}}),
        ("sources", {"at": "n0", "kind": "voltage", "value": {"shape": "step", "to": 1, "too": 1}}),
        ("lines", {"nodes": ["a"], "z0": 1, "delay": 1}),
        ("probes", {"at": 5}),
    ],
)
def test_the_schema_refuses_what_a_scene_refuses(section, element, accepts):
    table = scene().table() | {section: {"x": element}}
    table["lines"] = {name: line | {"nodes": list(line["nodes"])} for name, line in table["lines"].items()}
    with pytest.raises(jsonschema.ValidationError):
        accepts(table)
    with pytest.raises(InputError):
        Scene(**table)


# what stands at nodes


def test_nodes_gather_what_is_attached():
    made = scene(
        (1.0, 2.0),
        sources={
            "v": {"at": "n1", "kind": "voltage", "value": 3, "resistance": 5},
            "i": {"at": "n1", "kind": "current", "value": 2},
        },
        loads={
            "r": {"at": "n1", "kind": "resistor", "resistance": 10},
            "z": {"at": "n1", "kind": "impedance", "expression": "20"},
            "m": {"at": "n2", "kind": "matched"},
            "a": {"at": "n0", "kind": "series", "resistance": 1, "capacitance": 1},
            "b": {"at": "n0", "kind": "series", "resistance": 1, "capacitance": 1},
            "s": {"at": "n2", "kind": "switch", "before": 4, "after": 8, "time": 3},
        },
    )  # fmt: skip
    nodes = describe(made).nodes
    assert [node.ends for node in nodes.values()] == [[0], [1, 2], [3]]
    assert nodes["n1"].total == pytest.approx(2 / 50 + 1 / 5 + 1 / 10 + 1 / 20)
    assert nodes["n1"].flow_before() == pytest.approx(3 / 5 + 2)
    assert nodes["n2"].total == pytest.approx(2 / 50)
    assert [nodes["n2"].switched(t) for t in (0, 3, np.nextafter(3, 4), 9)] == [1 / 4, 1 / 4, 1 / 8, 1 / 8]
    assert str(nodes["n0"].load.function) == "(s + 1)/(2*s)"  # what both have in common has gone
    assert nodes["n0"].load_name == "loads.b"


def test_ideal_efforts_hold_a_node():
    loads = {
        "r": {"at": "n1", "kind": "reservoir", "pressure": "3 bar"},
        "s": {"at": "n2", "kind": "short"},
        "z": {"at": "n3", "kind": "resistor", "resistance": 0},
    }
    sources = {"p": {"at": "n0", "kind": "pressure", "value": "2 bar"}}
    nodes = describe(scene((1, 1, 1), medium="hydraulic", sources=sources, loads=loads)).nodes
    held = [float(node.held.value(np.array(0.0), np.array(1.0))) for node in nodes.values() if node.held is not None]
    assert held == [2e5, 3e5, 0.0, 0.0]


# order and slab width


def chosen(made: Scene):
    return resolution(describe(made))


@pytest.mark.parametrize(
    ("delays", "slabs"),
    [
        ((1.0,), (50,)),
        ((0.3, 0.7, 1.1), (15, 35, 55)),
        ((1e-9, 2.5e-9), (20, 50)),
        ((3.17, 1.25, 2.5), (317, 125, 250)),
        ((1, 1 / 3, 1 / 7), (63, 21, 9)),
        ((1e-6, 1), (1, 1_000_000)),
    ],
)
def test_one_slab_divides_all_delays_that_have_a_measure(delays, slabs):
    found = chosen(scene(delays, t_end=10 * max(delays)))
    assert [delay / found.h for delay in delays] == pytest.approx(slabs, rel=1e-12)
    assert found.notes == ()


@pytest.mark.parametrize("delays", [(1.0, 2**0.5), (1.0, 1.00123), (0.1, np.pi, np.e)])
def test_delays_without_a_measure_leave_the_shortest_whole(delays):
    found = chosen(scene(delays))
    assert (min(delays) / found.h) == pytest.approx(round(min(delays) / found.h), rel=1e-12)
    assert 10 / 500 * 0.9 < found.h <= min(delays) / 4


def test_a_fixed_order_and_slab_are_kept():
    found = chosen(scene((1, 2**0.5), solver={"order": 7, "slab": 0.3}))
    assert found[:3] == (7, 0.3, ())


@pytest.mark.parametrize("count", [1, 10, 1000, 10_000])
def test_the_default_is_affordable(count):
    """Whatever is fast in a scene, neither time nor memory is spent without end, and what is lost is told."""
    loads = {"stiff": {"at": f"n{count}", "kind": "parallel", "resistance": 50, "capacitance": 1e-20}}
    made = scene([1.0] * count, t_end=100.0, loads=loads, probes={"p": {"at": "n0"}})
    s, h, notes, *_ = chosen(made)
    assert h <= 1.0
    assert 2 * count * s * made.t_end / h <= CHEAP * 1.001 or h == 1.0
    assert max(4 * s * made.t_end, 2 * s * count) / h <= MOST_KEPT * 1.001 or h == 1.0
    begin = f"loads.stiff: its time scale of 2.5e-19 s is shorter than the slab of {h:.3g} s; what is faster"
    assert [note[: len(begin)] for note in notes] == [begin]


def test_a_load_that_can_be_resolved_is_resolved():
    load = {"at": "n1", "kind": "series", "resistance": 50, "inductance": 0.1}  # with the line's 50: 1 ms
    found = chosen(scene(loads={"l": load}))
    assert 0.5e-3 < found.h <= 1e-3
    assert found.notes == ()


@pytest.mark.parametrize(
    ("waveform", "widest", "note"),
    [
        (Step(to=1), 0.02, ""),
        (Step(to=1, at=0.125), 1 / 56, ""),  # 7 slabs to the jump
        (Step(to=1, at=0.123), 0.001, ""),  # 123
        (Step(to=1, at=np.pi), 0.25, ""),  # no slab divides this and the delay: a front in few wide slabs
        (Ramp(to=1, duration=0.01), 0.01, ""),
        (Ramp(to=1, duration="1 ns"), 0.25, ""),  # a piece inside its slab
        (Ramp(to=1, duration="1 ns", at=5), 0.25, ""),
        (Ramp(to=1, duration="1 ps"), 0.02, ""),  # of 10 s: a jump
        ({"shape": "pulses", "high": 1, "width": 0.5, "period": 0.5}, 0.02, ""),
        ({"shape": "pulses", "high": 1, "width": 0.1, "period": 0.3}, 0.02, ""),
        ({"shape": "sine", "amplitude": 1, "frequency": 100}, 1 / (200 * np.pi), ""),
        ({"shape": "exponential", "to": 1, "time_constant": 1e-3}, 1e-3, ""),
        ({"shape": "sine", "amplitude": 1, "frequency": "1 THz"}, 1e-5, "sources.s: its time scale of 1.59e-13 s"),
    ],
)
def test_waveforms_ask_for_slabs(waveform, widest, note):
    source = {"at": "n0", "kind": "voltage", "value": waveform, "resistance": 50}
    found = chosen(scene(sources={"s": source}))
    assert widest * 0.49 < found.h <= widest * (1 + 1e-12)
    assert len(found.notes) == bool(note)
    assert found.notes[0].startswith(note) if note else True


def test_a_run_may_end_before_a_wave_arrives():
    found = chosen(scene(t_end=1e-3))
    assert 1e-3 / 500 * 0.5 < found.h <= 1e-3 / 500


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"delays": (1e-9, 1.0)}, "lines.l0: slabs of 1e-09 s put 1e+10 samples on the lines at once, for lines.l1"),
        ({"t_end": 1e30}, "t_end: slabs of 1 s make a run of 1e+30 slabs"),
        ({"t_end": 1e-30}, "t_end: the run ends within the first slab"),
        ({"solver": {"slab": 0.5}, "t_end": 0.1}, "t_end: the run ends within the first slab, expected at least"),
        ({"solver": {"slab": 1e-9}}, "solver.slab: slabs of 1e-09 s put 1e+10 samples on the lines at once"),
    ],
)  # fmt: skip
def test_what_cannot_be_computed_is_refused(parts, message):
    with pytest.raises(InputError) as caught:
        chosen(scene(**parts))
    assert str(caught.value).startswith(message)


def test_large_scenes_are_read_quickly():
    """Some 0.15 ms a line, and 0.2 ms for a load; the bound is for machines that do other things too."""
    table = random_scene(1, lines=4000).table()
    started = time.process_time()
    made = Scene(**table)
    chosen(made)
    assert time.process_time() - started < 10.0


def test_a_probe_at_a_measured_load_sees_the_flow_of_its_cable():
    scene = read_scene(Path(__file__).parents[2] / "scenes" / "antenna.toml")
    assert len(scene.lines) == 2  # the cable, and the delay of the antenna
    assert scene.probed_line("far") == "cable"


def test_pipes_that_are_alike_share_all_but_their_nodes():
    pipe = {"length": "100 m", "diameter": 0.2, "wave_speed": 1000, "density": 1000}
    pipe |= {"friction": {"kind": "darcy", "factor": 0.02}}
    lines = {name: pipe | {"nodes": [name, "hub"]} for name in "ab"} | {
        "c": pipe | {"nodes": ["c", "hub"], "length": 100}
    }
    scene = Scene(medium="hydraulic", t_end=1, lines=lines, probes={"p": {"at": "hub", "line": "a"}})
    a, b, c = scene.lines.values()
    assert a.losses is b.losses
    assert a.losses is not c.losses
    assert (b.nodes, b.length.typed, c.length.typed) == (("b", "hub"), "100 m", 100)
    assert scene.change({"lines.b.length": 50}).lines["a"].length == 100
    with pytest.raises(InputError, match=r"lines\.b\.nodes: not two nodes"):
        Scene(**scene.table() | {"lines": lines | {"b": pipe | {"nodes": ["b"]}}})
