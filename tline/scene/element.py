"""What all elements of a scene share: unknown keys are refused, numbers carry units, nothing changes afterwards."""

from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError

from tline.errors import InputError, SceneError
from tline.scene.choice import validator
from tline.scene.mistakes import MOST, WORDS, limited, mistakes, register
from tline.words.wording import shown


def is_name(name: Any) -> bool:
    """Whether this can name an element or a node."""
    return isinstance(name, str) and bool(name.strip()) and name.isprintable()


def _readable(name: str) -> str:
    if not is_name(name):
        raise InputError("", "not a name", "letters, digits and other visible characters", shown(name))
    return name


def words_are_required(schema: dict[str, Any]) -> None:
    """Kind and shape have defaults in Python, but a file must name them."""
    required, properties = schema.setdefault("required", []), schema.get("properties", {})
    for word in sorted(WORDS & properties.keys()):
        properties[word].setdefault("description", f"the {word}")
        required[:] = [word, *(key for key in required if key != word)]


Name = Annotated[str, AfterValidator(_readable)]


class Element(BaseModel):
    """A table of a scene file.

    Raises
    ------
    SceneError
        With every mistake of the element.
    """

    model_config = ConfigDict(
        extra="forbid",
        frozen=True,
        defer_build=True,
        populate_by_name=True,
        revalidate_instances="always",
        validate_default=True,
        json_schema_extra=words_are_required,
    )

    def __init__(self, /, **data: Any) -> None:
        try:
            validator(type(self)).validate_python(data, self_instance=self)
        except ValidationError as error:
            found = mistakes(error, type(self), within=self._title())
            raise SceneError(limited(found, error.error_count() - MOST)) from None

    # elements inside a scene are built without the wrapper above, so that their mistakes are told together
    __init__.__pydantic_base_init__ = True  # pyright: ignore[reportFunctionMemberAccess]

    @classmethod
    def __pydantic_init_subclass__(cls, **kwargs: Any) -> None:
        super().__pydantic_init_subclass__(**kwargs)
        register(cls)

    def model_post_init(self, context: Any) -> None:
        """Count the word that tells kinds apart as given, so that it is always written to a file."""
        self.model_fields_set.update(type(self).model_fields.keys() & WORDS)

    def __eq__(self, other: object) -> bool:
        """Whether the same was given: all else follows from that."""
        fields = type(self).model_fields
        return type(self) is type(other) and all(getattr(self, name) == getattr(other, name) for name in fields)

    def __setattr__(self, name: str, value: Any) -> None:
        if not name.startswith("_"):
            raise InputError(name, "scenes and elements do not change", "scene.change({path: value}), a new scene")
        super().__setattr__(name, value)

    def __delattr__(self, name: str) -> None:
        self.__setattr__(name, None)

    def __repr__(self) -> str:
        given = ", ".join(f"{key}={value!r}" for key, value in self.table().items())
        return f"{self._title()}({given})"

    @classmethod
    def _title(cls) -> str:
        """Name of the class as it is written."""
        return cls.__name__

    def __str__(self) -> str:
        return repr(self)

    def __dir__(self) -> list[str]:
        """What belongs to scenes: without what all of pydantic's models have."""
        return [name for name in super().__dir__() if name.startswith("_") or not hasattr(BaseModel, name)]

    def table(self) -> dict[str, Any]:
        """The element as it stands in a scene file: what was given, as it was typed."""
        return self.model_dump(by_alias=True, exclude_unset=True)


class AtNode(Element):
    """An element between a node and the reference (earth, or the open air at the node's height)."""

    at: Name = Field(description="node")

    @property
    def terminals(self) -> tuple[str, None]:
        """Its node, and the reference."""
        return self.at, None
