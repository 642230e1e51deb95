"""A scene written to a file is the scene that was read: every key, every number, as it was typed."""

import copy
import pickle
import tomllib
from functools import cache
from itertools import pairwise

import jsonschema
import pytest
from hypothesis import given, settings, strategies as st

from tline.scene.file import scene_from, scene_text, schema
from tline.scene.line import Cable, Pipe
from tline.scene.load import Matched, NoFlow, Reservoir, Short, Switch
from tline.scene.measure import Probe
from tline.scene.multiport import ControlledSource, CoupledInductors, Gyrator, Transformer
from tline.scene.rational import Capacitor, Impedance, Inductor, Parallel, Resistor, Series
from tline.scene.scene import Scene, Solver
from tline.scene.source import Source
from tline.words.wording import one_line


def quantity(*units: str, least: float = 1e-3, most: float = 1e3, signed: bool = False):
    """A number in SI, whole or not, or a text with one of the units."""
    size = st.floats(least, most) | st.integers(max(int(least), 1), int(most))
    size = size | size.map(lambda x: -x) if signed else size
    return size | st.builds("{} {}".format, size, st.sampled_from(units))


time = quantity("s", "ms", "min")
instant = quantity("s", "us", signed=True)
resistance = {
    "electrical": quantity("ohm", "kohm", "Ω") | st.sampled_from([0, 0.0, "0 ohm", float("inf"), "inf"]),
    "hydraulic": quantity("Pa s/m^3", "bar/(m^3/s)") | st.sampled_from([0, float("inf")]),
}
positive = {"electrical": quantity("ohm", "Mohm"), "hydraulic": quantity("Pa s/m^3")}
inductance = {"electrical": quantity("H", "nH"), "hydraulic": quantity("Pa s^2/m^3")}
capacitance = {"electrical": quantity("F", "pF"), "hydraulic": quantity("m^3/Pa")}
name = st.text("abcxyzÄé .-_0/\"'\\日", min_size=1, max_size=8).filter(lambda text: text.strip())


def table(required: dict, optional: dict | None = None):
    return st.fixed_dictionaries(required, optional=optional or {})


@st.composite
def points(draw, level):
    times = sorted(draw(st.lists(st.integers(-50, 50), min_size=2, max_size=6, unique=True)))
    jump = draw(st.booleans())
    return [[t, draw(level)] for t in (times + times[-1:] if jump else times)]


UNITS = {"pressure": ("Pa", "bar"), "flow": ("m^3/s", "L/s"), "voltage": ("V", "mV"), "current": ("A", "mA")}


@cache
def waveform(kind: str):
    """All shapes; a plain number or text is the constant."""
    level = quantity(*UNITS[kind], signed=True)

    def shape(word: str, required: dict, **optional):
        return table({"shape": st.just(word)} | required, {"at": instant} | optional)

    low, high = st.floats(0.001, 1.0), st.floats(1.5, 9.0)
    return st.one_of(
        level,
        shape("step", {"to": level}, **{"from": level}),
        shape("ramp", {"to": level, "duration": time}, **{"from": level}),
        table({"shape": st.just("piecewise linear"), "points": points(level)}),
        table({"shape": st.just("table"), "file": st.just("points.csv")}),
        shape("pulses", {"high": level, "width": low}, low=level, rise=low, fall=low),
        shape("pulses", {"high": level, "width": low, "period": high, "count": st.integers(1, 9)}, rise=st.just(0)),
        shape("sine", {"amplitude": level, "frequency": quantity("Hz")}, phase=quantity("deg", "rad"), offset=level),
        shape("modulated sine", {"amplitude": level, "frequency": quantity("Hz")}, decay=time, offset=level),
        shape("exponential", {"to": level, "time_constant": time}, **{"from": level}),
        shape("double exponential", {"peak": level, "rise": low, "decay": high}),
    )  # fmt: skip


@cache  # making a strategy takes longer than drawing from it
def passive(medium: str):
    """R, L, C, impedances and switches: the kinds that loads and links share."""
    rlc = {"resistance": positive[medium], "inductance": inductance[medium], "capacitance": capacitance[medium]}
    rl, c = {key: rlc[key] for key in ("resistance", "inductance")}, {"capacitance": capacitance[medium]}
    number = st.integers(1, 10**20) | st.floats(1e-9, 1e9) | st.just("4.7 nH")
    changing = {"before": resistance[medium], "after": resistance[medium], "time": instant}
    parameters = table({"R": quantity("ohm", "m", "bar"), "L": quantity("H")})
    return [
        table({"kind": st.just("valve" if medium == "hydraulic" else "switch")} | changing),
        table({"kind": st.just("inductor"), "inductance": inductance[medium]}),
        table({"kind": st.just("capacitor"), "capacitance": capacitance[medium]}),
        table({"kind": st.sampled_from(["series", "parallel"])} | rl, c),
        table({"kind": st.sampled_from(["series", "parallel"])} | c, rl),
        table({"kind": st.just("impedance"), "expression": st.just("R + s*L"), "parameters": parameters}),
        table({"kind": st.just("impedance"), "expression": st.sampled_from(["1/(s*2e-9 + 1)", "s + 2"])}),
        table({"kind": st.just("impedance"), "numerator": st.tuples(number, number).map(list),
               "denominator": st.lists(number, min_size=1, max_size=3)}),
    ]  # fmt: skip


@cache
def load(medium: str):
    """All kinds; no node has two of them."""
    hydraulic = medium == "hydraulic"
    kinds = [
        table({"kind": st.just("closed" if hydraulic else "open")}),
        table({"kind": st.just("short")}),
        table({"kind": st.just("matched")}),
        table({"kind": st.just("resistor"), "resistance": resistance[medium]}),
        *passive(medium),
    ]
    if hydraulic:
        kinds.append(table({"kind": st.just("reservoir"), "pressure": quantity("Pa", "bar", signed=True)}))
    return st.one_of(kinds)


@cache
def link(medium: str, start: str):
    """From a node (0) to others (1, 2, 3) at which nothing else is but a resistor each."""
    kinds = [table({"kind": st.just("resistor"), "resistance": positive[medium]}), *passive(medium)]
    two = st.one_of(kinds).map(lambda one: {"nodes": [0, 1]} | one)
    ports = st.sampled_from([[0, 1], [0, 1, 2, 3], [1, 2, 0, 2]])
    gain, coils = st.sampled_from([-2, 0.5, "3"]), st.lists(inductance[medium], min_size=2, max_size=2)
    multiports = st.one_of(
        table({"nodes": ports, "kind": st.just("transformer"), "ratio": gain}),
        table({"nodes": ports, "kind": st.just("gyrator"), "resistance": positive[medium]}),
        table({"nodes": ports, "kind": st.just("controlled source"), "transconductance": gain}),
        table({"nodes": ports, "kind": st.just("controlled source"), "gain": gain, "resistance": st.just(5)}),
        table({"nodes": ports, "kind": st.just("coupled inductors"), "inductance": coils,
               "coupling": st.sampled_from([-0.99, 0, "0.5"])}),
    )  # fmt: skip
    return two if start == "steady" else two | multiports


@cache
def line(medium: str):
    lengths = quantity("m", "cm", "ft", least=0.5)
    if medium == "electrical":
        return st.one_of(
            table({"z0": quantity("ohm"), "delay": quantity("s", "ns")}),
            table({"z0": quantity("ohm"), "velocity_factor": st.floats(0.1, 1.0), "length": lengths}),
        )
    water = {"fluid": st.just("water"), "temperature": st.sampled_from(["20 degC", 300])}
    steel = {"wall": st.just("steel"), "wall_thickness": quantity("mm", least=1.0)}
    volume = {"gas_volume": quantity("mL", "m^3"), "vapour_pressure": quantity("Pa", "mPa")}
    cavities = {"cavities": table({"places": st.integers(1, 1000)}, volume)}
    return st.one_of(
        table({"z0": quantity("Pa s/m^3"), "delay": quantity("s")}, cavities),
        table({"radius": quantity("m", "mm"), "length": lengths} | water | steel),
        table({"diameter": quantity("in"), "density": quantity("kg/L"), "wave_speed": quantity("m/s"), "delay": time}),
    )  # fmt: skip


@st.composite
def scenes(draw):
    """A chain of lines, so that every conflict can be kept out by hand."""
    medium = draw(st.sampled_from(["electrical", "hydraulic"]))
    names = draw(st.lists(name, min_size=2, max_size=5, unique=True))
    nodes = draw(st.lists(name, min_size=len(names) + 1, max_size=len(names) + 1, unique=True))
    ends = pairwise(nodes)
    lines = {n: {"nodes": list(pair)} | draw(line(medium)) for n, pair in zip(names, ends, strict=True)}
    kind = draw(st.sampled_from(["pressure", "flow"] if medium == "hydraulic" else ["voltage", "current"]))
    source = {"at": nodes[0], "kind": kind, "value": draw(waveform(kind))}
    if draw(st.booleans()):
        source["resistance"] = draw(positive[medium])
    loads = {n: {"at": node} | draw(load(medium)) for n, node in zip(names, nodes[1:], strict=True)}
    loads = {n: one for n, one in loads.items() if one["kind"] != "matched" or one["at"] == nodes[-1]}
    middle = {"at": nodes[1], "line": names[draw(st.integers(0, 1))]}
    places = ["25 %", "0 %", "99.5%", *(["1 mm", 0, 0.001] if "length" in lines[names[0]] else [])]
    share = {"line": names[0], "position": draw(st.sampled_from(places))}
    end = {"at": nodes[-1]}
    probes = draw(st.sampled_from([{"p": middle}, {"a b": share}, {"p": middle, "q": share, '"': end}]))
    sources, links, start = {draw(name): source}, {}, draw(st.sampled_from(["rest", "steady"]))
    for node in draw(st.lists(st.sampled_from(nodes), max_size=3, unique=True)):
        one = draw(link(medium, start))
        around = [node, *(f"{node} inside {k}" for k in range(3))]
        links[draw(name)] = one | {"nodes": [around[k] for k in one["nodes"]]}
    inside = list(dict.fromkeys(node for one in links.values() for node in one["nodes"] if node not in nodes))
    loads |= {f"of {node}": {"at": node, "kind": "resistor", "resistance": 1} for node in inside}
    if inside and draw(st.booleans()):
        sources["between"] = {"nodes": [inside[0], nodes[0]], "kind": kind, "value": 1, "resistance": 1}
    optional = {
        "title": st.text("abc äöü\n\t\x1b\"'\\日", max_size=20).map(one_line),
        "solver": table({}, {"order": st.integers(1, 16), "slab": st.just("1e-12 s") | st.just(1e-20)}),
    }
    given = {"start": start, "sources": sources, "loads": loads, "links": links}
    whole = {"medium": st.just(medium), "t_end": time, "lines": st.just(lines), "probes": st.just(probes)}
    return draw(table(whole | {key: st.just(value) for key, value in given.items()}, optional))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("scenes")
    (path / "points.csv").write_text("t, u\n0, 1\n1, 2\n1, 3\n")
    return str(path)


@pytest.fixture(scope="module")
def validator():
    jsonschema.Draft202012Validator.check_schema(schema())
    return jsonschema.Draft202012Validator(schema())


def typed(value):
    """Nested values with their types: 1, 1.0, "1" and true differ."""
    if isinstance(value, dict):
        return {key: typed(one) for key, one in value.items()}
    return [typed(one) for one in value] if isinstance(value, list) else (type(value).__name__, value)


@settings(max_examples=25, deadline=None)
@given(data=scenes())
def test_file_to_scene_to_file_is_the_identity(data, folder, validator):
    validator.validate(data)
    scene = scene_from(data, folder)
    text = scene_text(scene)
    assert typed(tomllib.loads(text)) == typed(data)
    again = scene_from(tomllib.loads(text), folder)
    assert again == scene
    assert scene_text(again) == text


LINES = {"hydraulic": Pipe, "electrical": Cable}
LOADS = {
    "closed": NoFlow, "open": NoFlow, "short": Short, "reservoir": Reservoir, "matched": Matched, "resistor": Resistor,
    "switch": Switch, "valve": Switch, "series": Series, "parallel": Parallel, "impedance": Impedance,
    "inductor": Inductor, "capacitor": Capacitor,
}  # fmt: skip
LINKS = {
    "resistor": Resistor, "inductor": Inductor, "capacitor": Capacitor, "series": Series,
    "parallel": Parallel, "impedance": Impedance, "switch": Switch, "valve": Switch,
    "transformer": Transformer, "gyrator": Gyrator, "controlled source": ControlledSource,
    "coupled inductors": CoupledInductors,
}  # fmt: skip


@settings(max_examples=15, deadline=None)
@given(data=scenes())
def test_objects_to_text_to_objects_is_the_identity(data, folder):
    parts = copy.deepcopy(data)
    for key, model in (("lines", LINES[data["medium"]]), ("probes", Probe)):
        parts[key] = {n: model(**one) for n, one in data[key].items()}
    parts["loads"] = {n: LOADS[one["kind"]](**one) for n, one in data.get("loads", {}).items()}
    parts["links"] = {n: LINKS[one["kind"]](**one) for n, one in data.get("links", {}).items()}
    if "points.csv" not in str(data):  # a table alone looks for its file in the working folder
        parts["sources"] = {n: Source(**one) for n, one in data.get("sources", {}).items()}
    if "solver" in data:
        parts["solver"] = Solver(**data["solver"])
    scene = Scene(folder, **parts)
    assert scene_from(tomllib.loads(scene_text(scene)), folder) == scene
    for twin in (pickle.loads(pickle.dumps(scene)), copy.deepcopy(scene)):
        assert twin == scene
        assert scene_text(twin) == scene_text(scene)


def test_a_constant_may_be_written_at_length():
    """The one thing that is written shorter than it was read."""
    source = {"at": "a", "kind": "voltage", "value": {"shape": "constant", "level": "3 V"}}
    assert Source(**source) == Source(**source | {"value": "3 V"})
    assert Source(**source).table() == source | {"value": "3 V"}
