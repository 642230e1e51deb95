"""Bad files, tables and objects made in Python get one clear sentence a mistake."""

import time

import pytest
from scene_mistakes import CABLE, agree, mistakes_of

from tline.errors import InputError, SceneError
from tline.scene.file import read_scene
from tline.scene.line import Cable, Pipe
from tline.scene.load import Matched, NoFlow, Reservoir, Short, Switch
from tline.scene.measure import Probe
from tline.scene.mistakes import MOST_MISTAKES
from tline.scene.rational import Impedance, Parallel, Resistor, Series
from tline.scene.scene import Scene, Solver
from tline.scene.shape import Step
from tline.scene.source import Source
from tline.scene.waveform import Pulses
from tline.solver.assembly.assemble import assemble
from tline.solver.description.description import describe

NOTHING = ["medium: is missing", "t_end: is missing", "lines: is missing", "probes: is missing"]


DEEP = ".".join("a" * 2000)


FILES = {
    "empty": ("", NOTHING),
    "many comments": ("# x\n" * 10**5, NOTHING),
    "a million lines of junk": ("no scene at all\n" * 10**6, ["…scene.toml: is not valid TOML: Expected '='"]),
    "binary": (bytes(range(256)) * 4000, ["…scene.toml: is not a text file, expected text in UTF-8"]),
    "zeros": (bytes(10**6), ["…scene.toml: is not valid TOML: Invalid statement (at line 1, column 1)"]),
    "utf-16": (CABLE.encode("utf-16"), ["…scene.toml: is not a text file, expected text in UTF-8"]),
    "twice": (CABLE + CABLE, ["…scene.toml: is not valid TOML: Cannot declare"]),
    "deep lists": (CABLE + "x = " + "[" * 10**5, ["…scene.toml: is nested too deeply, expected a scene in TOML"]),
    "deep tables": (CABLE.replace("z0 =", f"z0.{DEEP} ="), ["lines.cable.z0: not a number, …got {'a'"]),
    "deep keys": (CABLE + f"[{DEEP}]", ["a: unknown key, expected one of 'title'"]),
    "5000 digits": (CABLE.replace('"40 ns"', "9" * 5000), ["…scene.toml: is not valid TOML: Exceeds the limit"]),
}  # fmt: skip


@pytest.mark.parametrize("what", FILES)
def test_files(what, tmp_path):
    text, begins = FILES[what]
    agree(mistakes_of(text, tmp_path), begins)


@pytest.mark.parametrize(
    ("what", "text"),
    [
        ("keys", "".join(f"x{k} = 1\n" for k in range(3 * 10**4)) + CABLE),
        ("loads", CABLE + "".join(f"[loads.l{k}]\nat = 'no{k}'\nkind = 'open'\n" for k in range(5000))),
        ("lines", CABLE + "".join(f"[lines.l{k}]\nfoo = 1\n" for k in range(5000))),
    ],
)
def test_useless_lines_are_told_of_quickly(what, text, tmp_path):
    """Not with the square of their number: some 0.5 s each, and the bound is for machines that do other things too."""
    started = time.process_time()
    assert len(mistakes_of(text, tmp_path)) == MOST_MISTAKES + 1
    assert time.process_time() - started < 20.0


def test_no_file(tmp_path):
    for path, got in ((tmp_path / "none.toml", "No such file or directory"), (tmp_path, "Is a directory")):
        with pytest.raises(InputError) as caught:
            read_scene(path)
        assert str(caught.value) == f"{path}: cannot be read, got {got}"


POINT = "line {} of '…t.csv' is not a point, expected two finite numbers with a comma between"


TABLES = {
    "0,1\n1,nan\n": POINT.format(2),
    "0,1\n1,1e400\n": POINT.format(2),
    "0,1,2\n1,2,3\n": POINT.format(1),
    "t,u\ns,V\n0,1\n": POINT.format(2),
    "0;1\n1;2\n": POINT.format(1),
    "t,1\n0,1\n1,2\n": POINT.format(1),
    "0,1\n2,1\n1,3\n": "point 3 lies before the one in front of it, expected times in order, got 1 s",
    "0,1\n1,2\n1,3\n1,4\n": "point 4 is the third at one time, expected at most two, for a jump, got 1 s",
    "t,u\n0,1\n": "too few points in '…t.csv', expected at least two lines 'time, level', got 1",
    "": "too few points in '…t.csv', expected at least two lines 'time, level', got 0",
    "0," + "1" * 200_000: "line 1 of '…t.csv' cannot be read: field larger than field limit",
    "0,\xff": "'…t.csv' is not a text file, expected text in UTF-8",
}


@pytest.mark.parametrize("table", TABLES, ids=[problem[:40] for problem in TABLES.values()])
def test_tables(table, tmp_path):
    (tmp_path / "t.csv").write_bytes(table.encode("latin-1"))
    text = CABLE.replace('"1 V"', '{shape = "table", file = "t.csv"}')
    agree(found := mistakes_of(text, tmp_path), ["sources.gen.value.file: " + TABLES[table]])
    assert not any(line in str(sentence) for sentence in found for line in table.splitlines() if line)


def scene(**parts) -> Scene:
    line = Cable(nodes=("a", "b"), z0=50, delay="0.1 s")
    return Scene(**{"medium": "electrical", "t_end": 1, "lines": {"c": line}, "probes": {"p": Probe(at="a")}} | parts)


PIPELINE = Pipe(nodes=("a", "b"), z0=5, delay=1)


SOURCE = {"at": "a", "kind": "voltage"}


TRAIN = Pulses(high=1, width=1e-9, period=2e-9, at=-1)


AMPERE = Source(at="a", kind="current", value=Step(to="1 A"))


OBJECTS = [
    ("lines", PIPELINE, "lines.x: not a line of electrical scenes, expected a table or a Cable, got a Pipe"),
    ("lines", Short(at="a"), "lines.x: not a line of electrical scenes, expected a table or a Cable, got a Short"),
    ("loads", Resistor(at="b", resistance="5 Pa s/m^3"), "loads.x.resistance: this unit measures something else"),
    ("loads", Series(at="b", inductance="5 F"), "loads.x.inductance: this unit measures something else"),
    ("loads", Parallel(at="b", capacitance="5 m^3/Pa"), "loads.x.capacitance: this unit measures something else"),
    ("loads", Reservoir(at="b", pressure="5 bar"), "loads.x.kind: not a word of electrical scenes"),
    ("loads", NoFlow(at="b", kind="closed"), "loads.x.kind: not a word of electrical scenes, expected 'open'"),
    ("loads", Switch(at="b", kind="valve", before=1, after=2, time=0), "loads.x.kind: not a word of electrical scenes"),
    ("loads", Matched(at="c"), "loads.x.at: no line ends at this node, expected one of 'a', 'b', got 'c'"),
    ("loads", Probe(at="b"), "loads.x.kind: is missing"),
    ("loads", AMPERE, "loads.x.kind: unknown, expected one of 'closed'"),
    ("loads", Impedance(at="b", expression="-50 ohm"), "loads.x: cancels the conductance of the lines at node 'b'"),
    ("loads", Impedance(at="b", expression="1e-200*s^3 + 1e300*s^2 + 1"), "loads.x: its coefficients are too far"),
    ("sources", Source(at="a", kind="pressure", value="1 bar"), "sources.x.kind: not a word of electrical scenes"),
    ("sources", Source(**SOURCE, value=1, resistance="1 bar"), "sources.x.resistance: this unit"),
    ("sources", {**SOURCE, "value": AMPERE.value}, "sources.x.value.to: this unit measures something else"),
    ("sources", Short(at="a"), "sources.x: not a table, expected keys with values, got Short("),
    ("sources", Source(**SOURCE, value=TRAIN), "sources.x.value.period: too many pulses before the end"),
    ("probes", Probe(line="c", position=0.5), "probes.x.position: the line's length is not known"),
    ("probes", Probe(at="a", position=0.5), "probes.x: its place is not given once"),
]  # fmt: skip


@pytest.mark.parametrize(("section", "element", "begin"), OBJECTS, ids=[case[2][:50] for case in OBJECTS])
def test_objects(section, element, begin):
    with pytest.raises(InputError) as caught:
        assemble(describe(scene(**{section: {"x": element}})), set())
    agree(str(caught.value).splitlines(), [begin])


PARTS = [
    ({"lines": [PIPELINE]}, "lines: not a table, expected keys with values, got [Pipe("),
    ({"lines": None}, "lines: not a table, expected keys with values, got None"),
    ({"lines": {}}, "lines: there is nothing to simulate, expected at least one table [lines.NAME]"),
    ({"lines": {1: Cable(nodes=("a", "b"), z0=5, delay=1)}}, "lines[1]: not a text, expected text in quotes, got 1"),
    ({"loads": {"r": Short(at="b"), "s": Short(at="b")}}, "loads.s: node 'b' is already held by loads.r"),
    (
        {"loads": {f"r{k}": Impedance(at="b", expression=f"1 + 1/(s + {k})^11") for k in (1, 2)}},
        "loads.r2: with the loads beside it, its degree in s is too high, expected at most 20, got 22",
    ),
    ({"probes": {}}, "probes: nothing would be recorded"),
    (
        {"solver": Solver(slab=2)},
        "solver.slab: longer than the shortest delay, expected at most that of lines.c, 0.1 s",
    ),
    ({"solver": None}, "solver: not a table"),
    ({"t_end": 10**5000}, "t_end: not a finite number"),
    ({"t_end": None}, "t_end: not a number, expected a time such as '1 s', got None"),
    ({"medium": None}, "medium: unknown, expected 'hydraulic' or 'electrical', got None"),
    ({"something": object()}, "something: unknown key, expected one of 'title', 'medium', 't_end'"),
    ({"self": 1}, "self: unknown key"),
]


@pytest.mark.parametrize(("parts", "begin"), PARTS, ids=[case[1][:50] for case in PARTS])
def test_parts(parts, begin):
    with pytest.raises(InputError) as caught:
        assemble(describe(scene(**parts)), set())
    agree(str(caught.value).splitlines(), [begin])


def test_a_hydraulic_scene_refuses_electrical_objects():
    with pytest.raises(SceneError) as caught:
        scene(
            medium="hydraulic",
            lines={"pipe": PIPELINE, "cable": Cable(nodes=("a", "b"), z0=1, delay=1)},
            loads={"r": Resistor(at="b", resistance="50 ohm")},
            probes={"p": Probe(at="a", line="pipe")},
        )
    begins = ["lines.cable: not a line of hydraulic scenes", "loads.r.resistance: this unit measures something else"]
    agree(str(caught.value).splitlines(), begins)


ELEMENTS = [
    (lambda: Resistor(at="a", resistance="x"), "Resistor.resistance: there is no number in front"),
    (lambda: Resistor(**{"at": "a", "resistanc": 1}), "Resistor.resistanc: unknown key, expected 'resistance'"),
    (lambda: Probe(at=""), "Probe.at: not a name"),
    (lambda: Cable(nodes=("a",), z0=1, delay=1), 'Cable.nodes: not two nodes, expected two names such as ["a", "b"]'),
    (lambda: Cable(nodes=("a", "b"), z0=1), "Cable: wave_speed or delay cannot be found"),
    (lambda: Cable(nodes=("a", "b"), z0="1 m", delay=1), "Cable.z0: this unit measures something else"),
    (lambda: Source(**SOURCE, value="1 A"), "Source.value: this unit measures something else, expected a voltage"),
    (lambda: Source(**SOURCE, value=Step(to="1 A")), "Source.value.to: this unit measures something else"),
    (lambda: Source(**SOURCE, value={"shape": "step", "t": 1, "to": 1}), "Source.value.t: unknown key"),
    (lambda: Impedance(at="a", expression="1+"), "Impedance.expression: column 3: the expression ends too early"),
    (lambda: Solver(order=0), "Solver.order: not a whole number in range, expected one from 1 to 16, got 0"),
]


@pytest.mark.parametrize(("make", "begin"), ELEMENTS, ids=[case[1][:50] for case in ELEMENTS])
def test_elements_alone(make, begin):
    with pytest.raises(SceneError) as caught:
        make()
    agree(str(caught.value).splitlines(), [begin])
