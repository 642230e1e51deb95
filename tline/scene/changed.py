"""Scenes with other values at dotted paths: only the elements that change are read and checked again."""

import tomllib
from collections.abc import Callable, Mapping, Sequence
from copy import deepcopy
from functools import cache, lru_cache
from inspect import signature
from typing import Any, get_args

from pydantic import TypeAdapter, ValidationError

from tline.errors import InputError, SceneError
from tline.scene.check import conflict_alike, conflicts
from tline.scene.element import Composed, Element
from tline.scene.medium import MEDIA
from tline.scene.pipe_table import PipeTable
from tline.scene.quantity import Quantity, Role
from tline.scene.scene import Scene
from tline.scene.user_defined import UserElement
from tline.words.wording import nearest, shown

SECTIONS = "lines", "sources", "loads", "links", "probes", "measures", "nodes"
ALONE = "sources", "loads", "links"  # sections whose elements take a changed number on their own
NOT_ALONE = Composed | UserElement
PLACES = "at", "nodes", "line"  # keys that place an element
SINGLE = 2  # number of parts in the path of an element
DERIVED = "heights", "single_lines", "lines_at"  # what a scene derives from its elements


def with_number(element: Any, keys: Sequence[str], value: Any) -> Any:
    """Copy an element with another number at a path within; None if there is none, or a check needs the context."""
    first, *rest = keys
    place = _places_of_numbers(type(element)).get(first) if isinstance(element, Element) else None
    if place is None:
        return None
    name, role = place
    old = getattr(element, name)
    if rest:
        new = with_number(old, rest, value)
    else:
        unit = old.unit if isinstance(old, Quantity) and role and role.unit is None else role and role.unit
        new = role.parse(value, unit) if isinstance(old, Quantity) and role and unit is not None else None
    checks = None if new is None else _checks(type(element))
    if checks is None:
        return None
    known = vars(element)
    fields = {key: known[key] for key in type(element).model_fields} | {name: new}
    found = type(element).model_construct({*element.model_fields_set, name}, **fields)
    for check in checks:
        found = check(found)
    return found


@cache
def _places_of_numbers(kind: type[Element]) -> dict[str, tuple[str, Role | None]]:
    """Attributes by key, with the role of each that holds one number."""
    found = {}
    for name, field in kind.model_fields.items():
        parts = [*field.metadata, *(part for each in get_args(field.annotation) for part in get_args(each))]
        role = next((part for part in parts if isinstance(part, Role)), None)
        found[field.alias or name] = name, role
    return found


@cache
def _checks(kind: type[Element]) -> tuple[Callable[[Any], Any], ...] | None:
    """Checks that an element makes of itself after it is read; None if they need to know its place in the scene."""
    known = kind.__pydantic_decorators__
    checks = tuple(each.func for each in known.model_validators.values())
    alone = all(len(signature(check).parameters) == 1 for check in checks)
    after = all(each.info.mode == "after" for each in known.model_validators.values())
    return checks if after and alone and not known.root_validators and not known.validators else None


Found = dict[str, dict[str, Any]]


def changed(scene: Scene, values: Mapping[str, Any]) -> Scene:
    """Return the scene with other values."""
    if not isinstance(values, Mapping):
        raise InputError("", "not values by path", "a dict such as {'lines.cable.z0': 60}", shown(values))
    if not values:
        return scene
    if any(isinstance(element, NOT_ALONE) for part in (scene.loads, scene.links) for element in part.values()):
        return _read_anew(scene, values)
    places = [(path, *parts_of(path)) for path in values]
    for path, section, *names in places:
        if section not in SECTIONS or len(names) < SINGLE:
            return _read_anew(scene, values)
        _element(scene, path, section, names[0])
    try:
        numbers = _numbers(scene, places, values)
        found = numbers or _elements(scene, places, values)
    except (ValidationError, InputError):
        return _read_anew(scene, values)  # which names the mistake
    pairs = []
    for part, each in found.items():
        pairs += zip(map(getattr(scene, part).get, each), each.values(), strict=True)
    if not numbers and any(getattr(old, key, None) != getattr(new, key, None) for old, new in pairs for key in PLACES):
        return _read_anew(scene, values)
    new = scene.model_copy(update={section: {**getattr(scene, section), **each} for section, each in found.items()})
    for name in DERIVED if {"lines", "nodes"} & found.keys() else ():
        vars(new).pop(name, None)
    for pair in pairs:
        if not conflict_alike(*pair):
            for mistake in conflicts(new):
                raise _at(mistake, values)
            break
    return new


def _numbers(scene: Scene, places: Sequence[tuple[str, ...]], values: Mapping[str, Any]) -> Found | None:
    """Elements with other numbers, by section and name; None if a value is not a number in place of a number."""
    found: Found = {}
    for path, section, name, *keys in places:
        here = found.setdefault(section, {})
        element = here.get(name, getattr(scene, section)[name])
        new = with_number(element, keys, values[path]) if section in ALONE else None
        if new is None:
            return None
        here[name] = new
    return found


def _elements(scene: Scene, places: Sequence[tuple[str, ...]], values: Mapping[str, Any]) -> Found:
    """Read elements again from their tables with other values, by section and name."""
    tables: Found = {}
    for path, section, name, *keys in places:
        here = tables.setdefault(section, {})
        _put(here.setdefault(name, deepcopy(getattr(scene, section)[name].table())), path, keys, values[path])
    context = {"folder": scene.folder, "medium": scene.medium, "units": MEDIA[scene.medium].units}
    return {part: _adapter(part).validate_python(each, context=context) for part, each in tables.items()}


@lru_cache(maxsize=1024)
def parts_of(path: str) -> tuple[str, ...]:
    """Split a dotted path into its keys, by the rules of TOML.

    Examples
    --------
    >>> parts_of('lines."main.1".length')
    ('lines', 'main.1', 'length')
    """
    try:
        table: Any = tomllib.loads(f"{path} = 0")
    except tomllib.TOMLDecodeError:
        raise InputError(path, "not a path", "keys with dots between, such as loads.receiver.capacitance") from None
    keys = []
    while isinstance(table, dict) and len(table) == 1:
        ((key, table),) = table.items()
        keys.append(key)
    if table != 0:
        raise InputError(path, "not a path", "keys with dots between, such as loads.receiver.capacitance")
    return tuple(keys)


def _read_anew(scene: Scene, values: Mapping[str, Any]) -> Scene:
    """Return the scene with other values by reading the whole scene again."""
    table = deepcopy(scene.table())
    if isinstance(scene.lines, PipeTable) and any(parts_of(path)[0] == "lines" for path in values):
        pipes = scene.lines.items()
        table["lines"] = {name: pipe.model_dump(by_alias=True, exclude_unset=True) for name, pipe in pipes}
    for path, value in values.items():
        section, *names = parts_of(path)
        if section in SECTIONS:
            if not names:
                raise InputError(path, "not a value", "a path such as loads.receiver.capacitance")
            if len(names) == 1:
                _put_element(table, path, section, names[0], value)
                continue
            _element(scene, path, section, names[0])
        elif section not in type(scene).model_fields:
            raise InputError(path, "no such key", nearest(section, [*type(scene).model_fields]), shown(section))
        _put(table, path, [section, *names], value)
    try:
        return scene.with_changes(**table)
    except SceneError as error:
        raise _at(error.mistakes[0], values) from None


def _element(scene: Scene, path: str, section: str, name: str) -> Any:
    elements = getattr(scene, section)
    if name not in elements or (section, name) in scene.parts:
        raise InputError(path, "no such element", nearest(name, [*elements]), shown(name))
    return elements[name]


def _put(table: dict[str, Any], path: str, keys: list[str], value: Any) -> None:
    """Put a value in a table of tables."""
    *above, last = keys
    for key in above:
        table = table.setdefault(key, {}) if isinstance(table, dict) else {}
        if not isinstance(table, dict):
            raise InputError(path, "not a table", "a path that ends earlier", shown(key))
    table[last] = value


def _put_element(table: dict[str, Any], path: str, section: str, name: str, value: Any) -> None:
    """Put a whole element in its place, or remove it."""
    elements = table.setdefault(section, {})
    if isinstance(value, Mapping | Element):
        elements[name] = value
    elif value is None and name in elements:
        del elements[name]
    elif value is None:
        raise InputError(path, "no such element", nearest(name, [*elements]), shown(name))
    else:
        raise InputError(path, "not an element", "a table, an element, or None to remove it", shown(value))


def _at(mistake: InputError, values: Mapping[str, Any]) -> InputError:
    """Report a mistake at the path of the value that causes it."""
    if mistake.where in values or len(values) > 1:
        return mistake
    (path,) = values
    problem = f"{mistake.where}: {mistake.problem}" if mistake.where and mistake.where != path else mistake.problem
    return InputError(path, problem, mistake.expected, mistake.got)


@cache
def _adapter(section: str) -> TypeAdapter[Any]:
    return TypeAdapter(Scene.model_fields[section].annotation or dict)
