"""Elements with one file each: every file here adds its element to scenes, the schema and the documentation."""

from importlib import import_module
from pkgutil import iter_modules
from typing import Any

from tline.scene.element import AtNode, Between, Element, Placed

_modules = [import_module(f"{__name__}.{found.name}") for found in iter_modules(__path__)]
ELEMENTS: dict[str, Any] = {
    name: model
    for module in _modules
    for name, model in vars(module).items()
    if isinstance(model, type) and issubclass(model, Element) and model.__module__ == module.__name__
    and "kind" in model.model_fields
}  # fmt: skip
__all__ = list(ELEMENTS)  # pyright: ignore[reportUnsupportedDunderAll]


def __getattr__(name: str) -> Any:
    if name not in ELEMENTS:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'", name=name)
    return ELEMENTS[name]


def loads() -> list[Any]:
    """Models of the elements at a node."""
    return [
        model.load if issubclass(model, Placed) else model
        for model in ELEMENTS.values()
        if not issubclass(model, Between)
    ]


def links() -> list[Any]:
    """Models of the elements between two nodes."""
    return [
        model.link if issubclass(model, Placed) else model
        for model in ELEMENTS.values()
        if not issubclass(model, AtNode)
    ]
