"""Numbers and models of scenes, read as from their tables."""

import importlib
import subprocess
import sys
import threading
from operator import attrgetter
from typing import Annotated, Literal, get_args

import pytest
from pydantic import ValidationError

import tline as tl
from tline.errors import InputError
from tline.scene.changed import with_number
from tline.scene.element import Element
from tline.scene.load import LINKS, LOADS
from tline.scene.mistakes import OneOf, validator

RC, VALVE = tl.examples["cable_rc"], tl.examples["valve_closure"]
PLACES = [
    (RC, "loads", "receiver", ("capacitance",), "5 pF"),
    (RC, "loads", "receiver", ("resistance",), 75),
    (RC, "sources", "driver", ("resistance",), "30 ohm"),
    (RC, "sources", "driver", ("value", "to"), "2 V"),
    (VALVE, "loads", "valve", ("opening", "from"), 0.9),
    (VALVE, "loads", "valve", ("opening", "duration"), "2 s"),
    (VALVE, "loads", "valve", ("kv",), 150),
]


@pytest.mark.parametrize(("scene", "part", "name", "keys", "value"), PLACES)
def test_is_as_read_from_its_table(scene, part, name, keys, value):
    found = with_number(getattr(scene, part)[name], keys, value)
    table = scene.table()
    at = table[part][name]
    for key in keys[:-1]:
        at = at[key]
    at[keys[-1]] = value
    anew = getattr(tl.Scene(**table), part)[name]
    assert found == anew
    assert found.table() == anew.table()
    if part == "loads" and scene is RC:
        assert found.ratio == anew.ratio


def test_what_is_no_number_is_left_to_others():
    driver = RC.sources["driver"]
    assert with_number(driver, ("kind",), "current") is None
    assert with_number(driver, ("value",), 3) is None  # a waveform so far
    assert with_number(driver, ("colour",), 3) is None
    assert with_number(RC.loads["receiver"], ("inductance",), "1 nH") is None  # there was none


@pytest.mark.parametrize("value", ["5 kg", -1, "five", None, [1]])
def test_a_bad_number_is_refused(value):
    with pytest.raises(InputError):
        with_number(RC.loads["receiver"], ("capacitance",), value)


def test_an_element_still_checks_itself():
    lone = tl.Scene(**RC.table() | {"sources": {"s": {"at": "near", "kind": "current", "value": 1, "resistance": 5}}})
    with pytest.raises(InputError, match="takes all of it"):
        with_number(lone.sources["s"], ("resistance",), 0)


class Round(Element):
    kind: Literal["round"] = "round"
    radius: float


class Square(Element):
    kind: Literal["square", "cube"]
    side: float


Part = Round | Square


class Holder(Element):
    parts: dict[str, Annotated[Part, OneOf(Part, "kind")]]


def test_the_word_chooses_the_model_and_tables_come_back_as_given():
    table = {"parts": {"a": {"kind": "round", "radius": 1.5}, "b": {"kind": "cube", "side": 2.0}}}
    held = Holder.model_validate(table)
    assert held.parts == {"a": Round(radius=1.5), "b": Square(kind="cube", side=2.0)}
    assert held.table() == table
    assert Holder(parts={"c": held.parts["a"]}).parts["c"] == Round(radius=1.5)


@pytest.mark.parametrize(
    ("part", "kind", "where"),
    [
        ({"kind": "oval"}, "union_tag_invalid", ("parts", "a")),
        ({"radius": 1}, "union_tag_not_found", ("parts", "a")),
        (3, "model_attributes_type", ("parts", "a")),
        ({"kind": "round"}, "missing", ("parts", "a", "round", "radius")),
        ({"kind": "round", "radius": 1, "size": 2}, "extra_forbidden", ("parts", "a", "round", "size")),
    ],
)
def test_mistakes_are_those_of_a_tagged_union(part: object, kind: str, where: tuple[str, ...]):
    with pytest.raises(ValidationError) as caught:
        validator(Holder).validate_python({"parts": {"a": part}})
    assert [(found["type"], found["loc"]) for found in caught.value.errors()] == [(kind, where)]


def test_a_model_is_built_at_its_first_use_and_once_where_threads_meet():
    class Late(Element):
        size: float

    assert not Late.__pydantic_complete__
    found: list[object] = []
    threads = [threading.Thread(target=lambda: found.append(validator(Late))) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 8
    assert len(set(map(id, found))) == 1


@pytest.mark.parametrize("kinds", [LOADS, LINKS])
def test_each_listed_kind_is_one_of_its_model_and_all_of_these_are_listed(kinds: dict[str, str]):
    told = []
    for place in dict.fromkeys(kinds.values()):
        module, name = place.split(":")
        model = attrgetter(name)(importlib.import_module(f"tline.scene.{module}"))
        told += [(kind, place) for kind in get_args(model.model_fields["kind"].annotation)]
    assert told == [*kinds.items()]


def test_laws_of_runs_are_known_where_no_element_has_them():
    code = """
import tline.solver.simulate
from tline.scene.elements import turbine
from tline.scene.law import KINDS
print("table" in KINDS, turbine.Driven.steady in KINDS)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["True", "True"]  # of switches; of turbines before the run


def test_a_plain_scene_builds_few_models():
    code = """
from tline.scene.mistakes import MODELS
from tline.scene.scene import Scene
Scene(medium="electrical", t_end=1, lines={"a": {"nodes": ["i", "j"], "z0": 50, "delay": 1}}, probes={"i": {"at": "i"}})
print(*sorted({model.__name__ for model in MODELS.values() if model.__pydantic_complete__}))
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["Constant"]  # such as what is always open
