"""Quantities and scenes that are valid and yet hardly meant, and those of which nothing is to be said."""

from pathlib import Path

import pytest
from hypothesis import given, strategies as st

from tline import ElectricalLine, HydraulicLine, InputError, Scene
from tline.interchange.water_scene import read_inp
from tline.line.electrical import QUANTITIES as ELECTRICAL
from tline.line.hydraulic import QUANTITIES as HYDRAULIC
from tline.line.plausible import CABLES, PIPES, unusual
from tline.line.relations import Given
from tline.scene.file import read_scene
from tline.scene.plausible import plausibility_notes
from tline.scene.rational import Parallel
from tline.units import to_si

SCENES = sorted((Path(__file__).parents[2] / "scenes").glob("**/*.toml"))
PIPE = {"wave_speed": "1200 m/s", "density": "1 kg/L", "radius": "10 cm", "length": "100 m"}
CABLE = {"z0": "50 ohm", "wave_speed": "20 cm/ns", "length": "1 m"}


@pytest.mark.parametrize(
    ("given", "meant"),
    [
        ({"radius": 10}, "radius: 10 m is outside what is built, 50 µm to 8 m: meant 10 cm?"),
        ({"radius": "10"}, "radius: 10 m is outside what is built, 50 µm to 8 m: meant 10 cm?"),
        ({"radius": "10 m"}, "radius: 10 m is outside what is built, 50 µm to 8 m: meant 10 cm?"),
        ({"radius": 5}, "radius: 5, read as 5 m, is outside what is usual, 100 µm to 2 m: meant 5 cm?"),
        ({"radius": 100}, "radius: 100 m is outside what is built, 50 µm to 8 m: meant 100 mm?"),
        ({"wave_speed": 1.2}, "1.2, read as 1.2 m/s, is outside what is usual, 10 m/s to 2500 m/s: meant 1.2 km/s?"),
        ({"density": 0.98}, "is outside what is usual, 300 kg/m^3 to 25000 kg/m^3: meant 0.98 kg/L?"),
        ({"wall_thickness": 5, "wall": "steel"}, "5 m is outside what is built, 10 µm to 3 m: meant 5 mm?"),
        (
            {"youngs_modulus": 210, "wall_thickness": "5 mm", "wave_speed": None, "bulk_modulus": "2.2 GPa"},
            "meant 210 GPa?",
        ),
        ({"length": "1 mm"}, "length: 0.001 m is short beside a radius of 0.1 m"),
        ({"wall_thickness": "20 cm", "wall": "concrete"}, "wall_thickness: 0.2 m is thick beside a radius of 0.1 m"),
    ],
)  # fmt: skip
def test_of_pipes(given: dict, meant: str) -> None:
    remarks = HydraulicLine(**(PIPE | given)).remarks
    assert meant in remarks[0]


@pytest.mark.parametrize(
    ("given", "meant"),
    [
        ({"wave_speed": 200}, "200 m/s is outside what is built, 1e+06 m/s to 3.1e+08 m/s: meant 200 m/us?"),
        ({"wave_speed": "20"}, "meant 20 cm/ns?"),
        ({"z0": "75 kohm"}, "z0: 75000 ohm is outside what is built, 50 mohm to 5 kohm"),
        ({"z0": 0.075}, "0.075, read as 0.075 ohm, is outside what is usual, 100 mohm to 3 kohm: meant 0.075 kohm?"),
        ({"velocity_factor": 0.0066, "wave_speed": None}, "velocity_factor: 0.0066, read as 0.0066, is outside"),
        ({"capacitance": 100, "wave_speed": None}, "is outside what is built, 100 fF/m to 1 µF/m: meant 100 pF/m?"),
    ],
)  # fmt: skip
def test_of_cables(given: dict, meant: str) -> None:
    assert meant in ElectricalLine(**(CABLE | given)).remarks[0]


@pytest.mark.parametrize(
    "given",
    [
        {},
        {"radius": 0.1, "wave_speed": 1200.0, "density": 998, "length": 100},
        {"radius": "5 m"},  # a tunnel, with its unit
        {"radius": "0.2 mm", "wave_speed": 5, "density": 1060} | {"wave_speed": "5 m/s", "length": "1 cm"},  # an artery
        {"density": 1.2, "wave_speed": 340},  # air in a duct
        {"radius": 1.26, "length": 0.3048},  # a dummy link of a network
    ],
)
def test_nothing_is_said_of_what_exists(given: dict) -> None:
    assert HydraulicLine(**(PIPE | given)).remarks == ()


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_nothing_is_said_of_the_shipped_scenes(path: Path) -> None:
    notes = plausibility_notes(read_scene(path))
    assert [note for note in notes if "outside what" in note or "beside a radius" in note] == []


@pytest.mark.parametrize("name", ["Net1", "Net2", "Net3"])
def test_nothing_is_said_of_networks_of_epanet(name: str) -> None:
    wntr = pytest.importorskip("wntr")
    scene, _ = read_inp(Path(wntr.__file__).parent / f"library/networks/{name}.inp", 1000)
    assert plausibility_notes(scene) == []


KNOWN = [(name, unit, known) for ranges, quantities in ((PIPES, HYDRAULIC), (CABLES, ELECTRICAL))
         for name, _, unit, *_ in quantities if (known := ranges.get(name))]  # fmt: skip


@given(st.sampled_from(KNOWN), st.floats(0.01, 0.99), st.integers(0, 3))
def test_what_is_usual_passes_in_any_unit_and_what_is_proposed_is_usual(which, share: float, other: int) -> None:
    name, unit, known = which
    value = known.usual_least ** (1 - share) * known.usual_most**share
    scale = known.units[other % len(known.units)]
    text = f"{value / to_si(f'1 {scale}', unit)!r} {scale}"
    for typed in (value, repr(value), text):
        assert list(unusual({name: known}, Given({name: value}, typed={name: typed}, units={name: unit}))) == []
    bare = float(text.split()[0])
    said = list(unusual({name: known}, Given({name: bare}, typed={name: bare}, units={name: unit})))
    assert len(said) == (not known.usual_least <= bare <= known.usual_most)
    for remark in said:  # one of the units makes it usual, if only the one it was made with
        proposed = remark.partition("meant ")[2].rstrip("?")
        assert known.usual_least <= to_si(proposed, unit) <= known.usual_most


def test_a_scene_names_the_pipes() -> None:
    lines = {name: {"nodes": ["a", name], "radius": 10, "length": 300, "fluid": "water"} for name in ("b", "c")}
    scene = Scene(medium="hydraulic", t_end="1 s", lines=lines, probes={"a": {"at": "b"}})
    note = "lines.b, lines.c: radius: 10 m is outside what is built, 50 µm to 8 m: meant 10 cm?"
    assert plausibility_notes(scene) == [note]


UNUSUAL_PIPE = {"nodes": ["tank", "valve"], "length": "300 m", "radius": "10 cm", "fluid": "water"}


def scene(**changes) -> Scene:
    table = {
        "medium": "hydraulic",
        "t_end": "2 s",
        "lines": {"pipe": UNUSUAL_PIPE},
        "loads": {"tank": {"at": "tank", "kind": "reservoir", "pressure": "3 bar"}},
        "probes": {"valve": {"at": "valve"}},
    }
    return Scene(**table | changes)


def valve(time) -> dict:
    return {"v": {"at": "valve", "kind": "valve", "before": "90 bar/(m^3/s)", "after": "inf", "time": time}}


def source(**waveform) -> dict:
    return {"s": {"at": "tank", "kind": "pressure", "value": {"to": "3 bar", "shape": "step"} | waveform}}


@pytest.mark.parametrize(
    ("changes", "note"),
    [
        ({"loads": valve("5 s")}, "loads.v (5 s): nothing changes there before the run ends at 2 s"),
        ({"loads": valve("2 s")}, "loads.v (2 s): nothing changes there before the run ends at 2 s"),
        ({"loads": valve("-1 s")}, "loads.v (-1 s): moved before the run begins"),
        (
            {"loads": {}, "sources": source(at="3 s")},
            "sources.s (3 s): nothing changes there before the run ends at 2 s",
        ),
        (
            {"lines": {"ring": UNUSUAL_PIPE | {"nodes": ["tank", "tank"]}}, "probes": {"tank": {"at": "tank"}}},
            "lines.ring: both ends are at one node",
        ),
        (
            {"lines": {name: UNUSUAL_PIPE | {"density": "1 kg/L", "nodes": ["tank", name]} for name in ("valve", "b")}},
            "lines.valve, lines.b: density: 1000 kg/m^3 as given, instead of 998.207 kg/m^3 of the fluid",
        ),
        (
            {
                "lines": {"pipe": UNUSUAL_PIPE | {"length": "300", "radius": "0.1"}},
                "loads": {},
                "sources": source(to="3", at="1"),
            },
            "taken as SI for want of a unit: lines.pipe.radius = '0.1' (m), lines.pipe.length = '300' (m), "
            "sources.s.value.to = '3' (Pa) and 1 more",
        ),
    ],
)
def test_what_is_probably_not_meant_is_said_in_one_sentence(changes: dict, note: str) -> None:
    assert plausibility_notes(scene(**changes)) == [note]


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"loads": valve("0.1 s")},
        {"loads": {}, "sources": source(at="-1 s")},
        {"lines": {"pipe": UNUSUAL_PIPE | {"length": 300}}, "t_end": 2.0},  # a number needs no unit
    ],
)
def test_nothing_is_said_of_what_is_plain(changes: dict) -> None:
    assert plausibility_notes(scene(**changes)) == []


def test_ohms_and_volts_need_no_unit() -> None:
    cable = {"nodes": ["near", "far"], "z0": "50", "delay": "1 ns"}
    drive = {"at": "near", "kind": "voltage", "value": "1", "resistance": "20"}
    end = {"at": "far", "kind": "resistor", "resistance": "75"}
    lines, sources, loads, probes = {"cable": cable}, {"s": drive}, {"end": end}, {"far": {"at": "far"}}
    plain = Scene(medium="electrical", t_end="1 us", lines=lines, sources=sources, loads=loads, probes=probes)
    assert plausibility_notes(plain) == []


def test_a_negative_resistance_leads_to_an_active_impedance() -> None:
    with pytest.raises(InputError, match=r"kind = 'impedance' with expression = '-30', which runs with --active, got"):
        scene(loads={"r": {"at": "valve", "kind": "resistor", "resistance": "-30 Pa s/m^3"}})
    with pytest.raises(InputError, match=r"more than 0, or kind = 'impedance' with expression = '-5'"):
        Parallel(at="valve", resistance=-5)
    with pytest.raises(InputError, match=r"more than 0, got 0$"):
        Parallel(at="valve", resistance=0)
