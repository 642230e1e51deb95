"""What may stand in one place of a scene; a model is built when a scene first has it, for most scenes have few."""

from collections.abc import Callable
from functools import partial, reduce
from operator import or_
from threading import RLock
from typing import Annotated, Any, get_args

from pydantic import BaseModel, Field, GetCoreSchemaHandler, GetJsonSchemaHandler, TypeAdapter, ValidationInfo
from pydantic_core import CoreSchema, core_schema

from tline.scene.mistakes import register

_building = RLock()


def validator(model: type[BaseModel]) -> Any:
    """The validator of a model, built at its first use, once also where threads meet."""
    if not model.__pydantic_complete__:
        with _building:
            model.model_rebuild()
    return model.__pydantic_validator__


def _validated(model: type[BaseModel], value: Any, info: ValidationInfo) -> Any:
    return validator(model).validate_python(value, context=info.context)


class OneOf:
    """One of several models, told apart by the value of a key.

    Parameters
    ----------
    models : union or sequence of types
    word : str
        The key.
    """

    def __init__(self, models: Any, word: str):
        self.models, self.word = get_args(models) or tuple(models), word
        for model in self.models:  # mistakes name them in this order
            register(model)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        choices: dict[Any, CoreSchema] = {
            value: core_schema.with_info_plain_validator_function(partial(_validated, model))
            for model in self.models
            for value in get_args(model.model_fields[self.word].annotation)
        }
        return core_schema.tagged_union_schema(choices, self.word, from_attributes=True)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        union: Any = Annotated[reduce(or_, self.models), Field(discriminator=self.word)]
        return handler(TypeAdapter(union).core_schema)


class Read:
    """A value that a function reads.

    Parameters
    ----------
    reader : callable
        Of the value and its context.
    described : type
        What stands in a file, for its JSON schema.
    """

    def __init__(self, reader: Callable[[Any, ValidationInfo], Any], described: Any):
        self.reader, self.described = reader, described

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self.reader)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return handler(TypeAdapter(self.described).core_schema)
