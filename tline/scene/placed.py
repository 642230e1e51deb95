"""Elements written once that stand at a node, as a load, or between two, as a link."""

from typing import TYPE_CHECKING, Any, ClassVar, Self

from tline.scene.between import Between
from tline.scene.element import AtNode, Element, Name


class Placed(Element):
    """An element that is a load if it is given `at`, and a link if it is given `nodes`.

    A subclass has the keys that both have. Those that only one has are in a class of their own, given as keyword:
    ``class Diode(Placed, load=Reversible)``. What is made is a `Diode` of either place.
    """

    if TYPE_CHECKING:  # of one that is a load, and of one that is a link
        at: Name = ""
        nodes: tuple[Name, Name] = ("", "")

        @property
        def terminals(self) -> tuple[str, Any]:
            """Its nodes, or its node and the reference."""
            return self.nodes

    load: ClassVar[type["Placed"]]
    link: ClassVar[type["Placed"]]

    def __new__(cls, *args: Any, **data: Any) -> Self:
        """A load or a link."""
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
            cls.load, cls.link = cls._standing(load, cls.__name__), cls._standing(link, f"{cls.__name__}Link")

    @classmethod
    def _standing(cls, place: type, name: str) -> Any:
        """The class of those at such a place."""
        home = {"__module__": cls.__module__, "__qualname__": f"{cls.__qualname__}.{name}", "__doc__": cls.__doc__}
        made = type(cls)(name, (cls, place), home)
        setattr(cls, name, made)  # where it is found again when it has been sent to another process
        return made

    @classmethod
    def _title(cls) -> str:
        return cls.__qualname__.rpartition(".")[0].rpartition(".")[2] or cls.__name__
