"""Validation errors as sentences that name the element and the nearest valid word."""

from collections.abc import Callable, Iterable, Mapping
from functools import cached_property, partial, reduce
from importlib import import_module
from operator import attrgetter, or_
from threading import RLock
from typing import Annotated, Any, get_args

from pydantic import (
    BaseModel,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    TypeAdapter,
    ValidationError,
    ValidationInfo,
)
from pydantic_core import CoreSchema, SchemaValidator, core_schema

from tline.errors import InputError
from tline.words.wording import listed, nearest, place, shown

UNKNOWN, MISSING = "unknown key", "is missing"
WORDS = {"kind", "shape"}  # keys that distinguish the models for one place
MODELS: dict[tuple[str, str], type[BaseModel]] = {}  # (links, measures or else "", value of such a key) -> model
# index in the validator's locations of the value
WORD_AT = {"loads": 2, "links": 2, "measures": 2, "sources": 3, "value": 1}
MOST_MISTAKES = 100  # sentences; further mistakes are counted only
_WRONG_TYPES = {
    "string_type": ("not a text", "text in quotes"),
    "list_type": ("not a list", ""),
    **dict.fromkeys(("dict_type", "model_type", "model_attributes_type"), ("not a table", "keys with values")),
}


def register(model: type[BaseModel]) -> None:
    """Register the words that select this model, after all others."""
    section = getattr(model, "section", "")
    for word in model.model_fields.keys() & WORDS:
        for value in get_args(model.model_fields[word].annotation):
            MODELS.pop((section, value), None)
            MODELS[section, value] = model


def mistakes(
    error: ValidationError,
    root: type[BaseModel],
    sections: Mapping[str, type[BaseModel]] | None = None,
    within: str = "",
) -> list[InputError]:
    """Convert each validation error to an InputError, up to MOST_MISTAKES of them."""
    findings = error.errors(include_url=False)
    sentences = [
        _sentence(finding, root, sections or {}, (within,) if within else ()) for finding in findings[:MOST_MISTAKES]
    ]
    meant = {f"{m.where.rpartition('.')[0]}.{m.expected.strip(chr(39))}" for m in sentences if m.problem == UNKNOWN}
    # a key that is missing because it is misspelt is one mistake, not two
    return [m for m in sentences if not (m.problem == MISSING and (m.where in meant or f".{m.where}" in meant))]


def limited(found: list[InputError], untold: int) -> list[InputError]:
    """Return the first MOST_MISTAKES mistakes, and a sentence that counts all others."""
    rest = max(len(found) - MOST_MISTAKES, 0) + max(untold, 0)
    return [*found[:MOST_MISTAKES], InputError("", f"and {rest:,} more mistakes")] if rest else found


def _sentence(
    finding: Any, root: type[BaseModel], sections: Mapping[str, type[BaseModel]], within: tuple[str, ...]
) -> InputError:
    location, got, context = finding["loc"], shown(finding["input"]), finding.get("ctx", {})
    word_at = WORD_AT.get(str(location[0])) if location else None
    word = location[word_at] if word_at is not None and len(location) > word_at else None
    section = location[0] if location and location[0] in ("links", "measures") else ""
    chosen = MODELS.get((section, word)) if isinstance(word, str) else None
    parts = [part for k, part in enumerate(location) if not (chosen and k == word_at) and part != "[key]"]
    where = place(*within, *parts)
    match finding["type"]:
        case "missing":
            return InputError(where, MISSING)
        case "extra_forbidden":
            outer = sections.get(str(location[0]), root) if len(location) > 1 else root
            models = _innermost(chosen or outer, location[(word_at or 1) + 1 : -1] if chosen else location[2:-1])
            known = [*dict.fromkeys(key for model in models for key in keys(model))]
            if known[0] in ("at", "nodes"):  # the parts of a table come next
                known[1:] = sorted(known[1:], key=lambda key: key not in WORDS)
            return InputError(where, UNKNOWN, nearest(str(location[-1]), known))
        case "union_tag_not_found":
            key, own = context["discriminator"].strip("'"), sections.values()
            known = [(word, model) for (part, word), model in MODELS.items() if part == section]
            words = [word for word, model in known if key in model.model_fields and model not in own]
            return InputError(place(*within, *parts, key), MISSING, listed(words))
        case "union_tag_invalid":
            key, known = context["discriminator"].strip("'"), context["expected_tags"].strip("'").split("', '")
            word = finding["input"][key] if isinstance(finding["input"], Mapping) else context["tag"]
            return InputError(place(*within, *parts, key), "unknown", nearest(str(word), known), shown(word))
        case "literal_error":
            return InputError(where, "unknown", context["expected"], got)
        case "too_short":
            return InputError(where, "too few", f"at least {context['min_length']}", f"{context['actual_length']}")
        case "value_error" if isinstance(context.get("error"), InputError):
            inner = context["error"]
            inside = ".".join(part for part in (where, inner.where) if part)
            return InputError(inside, inner.problem, inner.expected, inner.got)
        case kind if kind in _WRONG_TYPES:
            problem, expected = _WRONG_TYPES[kind]
            return InputError(where, problem, expected, got)
        case _:
            return InputError(where, finding["msg"][0].lower() + finding["msg"][1:], got=got)


def _innermost(model: type[BaseModel], parts: tuple[str | int, ...]) -> list[type[BaseModel]]:
    """Models that a nested table may have, as far as keys and words determine them."""
    models = [model]
    for part in map(str, parts):
        fields = [one.model_fields[part] for one in models if part in one.model_fields]
        inside = [kind for field in fields for kind in (*_read(field.metadata), *_models_in(field.annotation))]
        models = inside or ([MODELS["", part]] if ("", part) in MODELS else models)
    return models


def _models_in(annotation: Any) -> list[type[BaseModel]]:
    """Models in an annotation."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    arguments = get_args(annotation)
    described = _read(getattr(annotation, "__metadata__", ()))
    return described or [model for argument in arguments for model in _models_in(argument)]


def _read(metadata: Iterable[Any]) -> list[type[BaseModel]]:
    """Models of values read by a function."""
    return [model for one in metadata for model in _models_in(getattr(one, "described", None))]


def keys(model: type[BaseModel]) -> list[str]:
    """Keys that a table of this model may have."""
    return [field.alias or name for name, field in model.model_fields.items()]


_building = RLock()


def validator(model: type[BaseModel]) -> Any:
    """Validator of a model, built at its first use, once also with several threads."""
    if not model.__pydantic_complete__:
        with _building:
            model.model_rebuild()
    return model.__pydantic_validator__


def _validated(model: type[BaseModel], value: Any, info: ValidationInfo) -> Any:
    return validator(model).validate_python(value, context=info.context)


def _union(models: Iterable[type[BaseModel]], word: str) -> CoreSchema:
    choices: dict[Any, CoreSchema] = {
        value: core_schema.with_info_plain_validator_function(partial(_validated, model))
        for model in models
        for value in get_args(model.model_fields[word].annotation)
    }
    return core_schema.tagged_union_schema(choices, word, from_attributes=True)


class OneOf:
    """One of several models, selected by the value of a key."""

    def __init__(self, models: Any, word: str):
        self.models, self.word = get_args(models) or tuple(models), word
        for model in self.models:  # mistakes name them in this order
            register(model)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return _union(self.models, self.word)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        union: Any = Annotated[reduce(or_, self.models), Field(discriminator=self.word)]
        return handler(TypeAdapter(union).core_schema)


class OfKind:
    """One of several models, selected by `kind`; each is imported when a value of its kind is first read.

    Parameters
    ----------
    places : mapping of str to str
        Module in `tline.scene` and name of each model, by kind; mistakes name them in this order.
    others : str
        Module and name of a function that returns all further models.
    """

    def __init__(self, places: Mapping[str, str], others: str):
        self._places, self._others = places, others
        self._unions: dict[str | None, SchemaValidator] = {}  # of one model, by its place, or of all

    @cached_property
    def _all(self) -> OneOf:
        return OneOf([*map(_found, dict.fromkeys(self._places.values())), *_found(self._others)()], "kind")

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self._read)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return self._all.__get_pydantic_json_schema__(schema, handler)

    def _read(self, value: Any, info: ValidationInfo) -> Any:
        kind = value.get("kind") if isinstance(value, dict) else getattr(value, "kind", None)
        place = self._places.get(kind) if isinstance(kind, str) else None
        if place not in self._unions:
            self._unions[place] = SchemaValidator(_union([_found(place)] if place else self._all.models, "kind"))
        return self._unions[place].validate_python(value, context=info.context)


def _found(place: str) -> Any:
    module, _, name = place.partition(":")
    return attrgetter(name)(import_module(f"tline.scene.{module}"))


class Read:
    """Value read by a function."""

    def __init__(self, reader: Callable[[Any, ValidationInfo], Any], described: Any):
        self.reader, self.described = reader, described

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self.reader)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return handler(TypeAdapter(self.described).core_schema)
