import subprocess
import sys
import threading
from typing import Annotated, Literal

import pytest
from pydantic import ValidationError

from tline.scene.element import Element
from tline.scene.mistakes import OneOf, validator


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


def test_a_plain_scene_builds_few_models():
    code = """
from tline.scene.mistakes import MODELS
from tline.scene.scene import Scene
Scene(medium="electrical", t_end=1, lines={"a": {"nodes": ["i", "j"], "z0": 50, "delay": 1}}, probes={"i": {"at": "i"}})
print(*sorted({model.__name__ for model in MODELS.values() if model.__pydantic_complete__}))
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["Constant"]  # such as what is always open
