"""Base classes of the elements of a scene, and their placement: at a node, between two, or either."""

from collections.abc import Callable, Container, Iterable
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Self

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    SerializerFunctionWrapHandler,
    ValidationError,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
    WrapSerializer,
    WrapValidator,
    field_validator,
    model_validator,
)

from tline.errors import InputError, SceneError
from tline.scene.mistakes import MOST_MISTAKES, WORDS, limited, mistakes, register, validator
from tline.words.wording import shown


def is_name(name: Any) -> bool:
    """Whether a value can name an element or a node."""
    return isinstance(name, str) and bool(name.strip()) and name.isprintable()


def _readable(name: str) -> str:
    if not is_name(name):
        raise InputError("", "not a name", "letters, digits and other visible characters", shown(name))
    return name


def words_are_required(schema: dict[str, Any]) -> None:
    """Require kind and shape in a file, although they have defaults in Python."""
    required, properties = schema.setdefault("required", []), schema.get("properties", {})
    for word in sorted(WORDS & properties.keys()):
        properties[word].setdefault("description", f"the {word}")
        required[:] = [word, *(key for key in required if key != word)]


Name = Annotated[str, AfterValidator(_readable)]


class Element(BaseModel):
    """Table of a scene file. Raises SceneError: with every mistake of the element."""

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
            raise SceneError(limited(found, error.error_count() - MOST_MISTAKES)) from None

    # elements inside a scene are built without the wrapper above, so that their mistakes are reported together
    __init__.__pydantic_base_init__ = True  # pyright: ignore[reportFunctionMemberAccess]

    @classmethod
    def __pydantic_init_subclass__(cls, **kwargs: Any) -> None:
        super().__pydantic_init_subclass__(**kwargs)
        register(cls)

    def model_post_init(self, context: Any) -> None:
        """Count the key that distinguishes kinds as given, so that it is always written to a file."""
        self.model_fields_set.update(type(self).model_fields.keys() & WORDS)

    def __eq__(self, other: object) -> bool:
        """Whether both are of one class and were given the same values: all else follows from these."""
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
        """Name of the class as written in a scene."""
        return cls.__name__

    def __str__(self) -> str:
        return repr(self)

    def __dir__(self) -> list[str]:
        """Names of attributes, without those of every pydantic model."""
        return [name for name in super().__dir__() if name.startswith("_") or not hasattr(BaseModel, name)]

    def table(self) -> dict[str, Any]:
        """Table of the element as in a scene file: the values given, as typed."""
        return self.model_dump(by_alias=True, exclude_unset=True)


def required(description: str, **limits: Any) -> Any:
    """Key that a table must have."""
    return Field(description=description, **limits)


def optional(description: str, default: Any = None, **limits: Any) -> Any:
    """Key that a table may have."""
    return Field(default=default, description=description, **limits)


class AtNode(Element):
    """Element between a node and the reference (earth, or the open air at the node's height)."""

    at: Name = required("node")

    @property
    def terminals(self) -> tuple[str, None]:
        """Node of the element, and the reference."""
        return self.at, None


def sequence_of(sizes: Container[int], problem: str, expected: str) -> BeforeValidator:
    """Raise an error unless the value is a list of an allowed length."""

    def checked(given: Any) -> Any:
        if not isinstance(given, list | tuple) or len(given) not in sizes:
            raise InputError("", problem, expected, shown(given))
        return given

    return BeforeValidator(checked)


def nodes_of(most: int, words: str) -> BeforeValidator:
    """Raise an error unless the value is a list of at least two nodes."""
    return sequence_of(range(2, most + 1), "not a list of nodes", f"{words}, 2 to {most}")


def pair(words: str) -> BeforeValidator:
    """Raise an error unless the value is a pair; the words describe its parts."""
    return sequence_of((2,), "not a point", f"a pair [{words}]")


def named(what: str, names: Iterable[str], shown_as: Any) -> WrapValidator:
    """Accept one of some names in place of a list, and refuse other texts; the schema shows both."""

    def known(value: Any, points: ValidatorFunctionWrapHandler) -> Any:
        if isinstance(value, str) and value not in names:
            raise InputError("", f"not a kind of {what}", f"{' or '.join(map(repr, names))}, or points", shown(value))
        return value if isinstance(value, str) else points(value)

    return WrapValidator(known, json_schema_input_type=shown_as)


def _as_typed(value: Any, points: SerializerFunctionWrapHandler) -> Any:
    return value if isinstance(value, str) else points(value)


NAMED = WrapSerializer(_as_typed)  # of values that may be such a name


class OneMedium(Element):
    """Element for pipes only, or for cables only."""

    medium: ClassVar[str]
    instead: ClassVar[str]  # corresponding elements of the other medium

    @field_validator("kind", check_fields=False)
    @classmethod
    def _of_medium(cls, kind: str, info: ValidationInfo) -> str:
        given = (info.context or {}).get("medium", cls.medium)
        if given != cls.medium:
            raise InputError("", f"not a word of {given} scenes", cls.instead, f"'{kind}'")
        return kind


TwoNodes = Annotated[tuple[Name, Name], sequence_of((2,), "not two nodes", 'two names such as ["a", "b"]')]


class Composed(Element):
    """Element that is `taken_apart`: its file composes it of several others, `near` the places given."""


class Measured(Composed):
    """Element that a `model` of S-parameters in a file replaces, behind `delay_lines`."""


class Between(Element):
    """Element between two different nodes; flow counts positive from the first to the second."""

    section: ClassVar[str] = "links"
    nodes: TwoNodes = required("first node, second node")

    @property
    def terminals(self) -> tuple[str, str]:
        """Nodes of the element."""
        return self.nodes

    @model_validator(mode="after")
    def _apart(self):
        if self.nodes[0] == self.nodes[1]:
            raise InputError("nodes", "both ends are at one node", "two different nodes", shown(self.nodes[0]))
        return self


class _WhenAsked:
    """Class that is made when it is first asked for."""

    def __init__(self, make: Callable[[], type]):
        self._made = cache(make)

    def __get__(self, instance: object, owner: type) -> type:
        return self._made()


class Placed(Element):
    """Element that is a load if given `at`, and a link if given `nodes`.

    A subclass has the keys of both. The keys of only one are in a class of their own, given as keyword:
    ``class Diode(Placed, load=Reversible)``. Its instances are `Diode` in either place.
    """

    if TYPE_CHECKING:  # of one that is a load, and of one that is a link
        at: Name = ""
        nodes: tuple[Name, Name] = ("", "")

        @property
        def terminals(self) -> tuple[str, Any]:
            """Nodes of the element, or its node and the reference."""
            return self.nodes

    load: ClassVar[type["Placed"]]
    link: ClassVar[type["Placed"]]

    def __new__(cls, *args: Any, **data: Any) -> Self:
        """Create a load or a link."""
        if issubclass(cls, AtNode | Between):
            return super().__new__(cls)
        return super().__new__(cls.link if "nodes" in data else cls.load)  # pyright: ignore[reportReturnType, reportArgumentType]

    def __init_subclass__(cls, load: type = AtNode, link: type = Between, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)

    @classmethod
    def __pydantic_init_subclass__(cls, load: type = AtNode, link: type = Between, **kwargs: Any) -> None:
        if issubclass(cls, AtNode | Between) or "kind" not in cls.model_fields:
            super().__pydantic_init_subclass__(**kwargs)
        else:
            cls._stand("load", load, cls.__name__)
            cls._stand("link", link, f"{cls.__name__}Link")

    @classmethod
    def _stand(cls, key: str, place: type, name: str) -> None:
        """Let the subclass for one kind of place be made, and found again when it has been sent to another process."""
        home = {"__module__": cls.__module__, "__qualname__": f"{cls.__qualname__}.{name}", "__doc__": cls.__doc__}
        made = _WhenAsked(lambda: type(cls)(name, (cls, place), home))
        setattr(cls, key, made)
        setattr(cls, name, made)

    @classmethod
    def _title(cls) -> str:
        return cls.__qualname__.rpartition(".")[0].rpartition(".")[2] or cls.__name__
