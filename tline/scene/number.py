"""An element with another number somewhere in it: only that number is parsed, and what the element checks of itself."""

from collections.abc import Callable, Sequence
from functools import cache
from inspect import signature
from typing import Any, get_args

from tline.scene.element import Element
from tline.scene.quantity import Quantity, Role


def with_number(element: Any, keys: Sequence[str], value: Any) -> Any:
    """The element with another number at a path within.

    Parameters
    ----------
    element : Element
        Of a scene, so that its numbers know their units.
    keys : sequence of str
        As in a file: ``["opening", "duration"]``.
    value : number or text

    Returns
    -------
    Element or None
        None where no number stands at the path, or where more than the element itself says whether it is valid.

    Examples
    --------
    >>> from tline.scene import Scene
    >>> scene = Scene(
    ...     medium="electrical", t_end="40 ns", lines={"cable": {"nodes": ["near", "far"], "z0": 50, "delay": "5 ns"}},
    ...     loads={"series": {"at": "far", "kind": "series", "resistance": "5 ohm"}}, probes={"far": {"at": "far"}},
    ... )
    >>> with_number(scene.loads["series"], ["resistance"], "7 ohm").ratio
    Ratio(numerator=(7,), denominator=(1,))
    """
    first, *rest = keys
    place = _numbers(type(element)).get(first) if isinstance(element, Element) else None
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
def _numbers(kind: type[Element]) -> dict[str, tuple[str, Role | None]]:
    """Attributes by key, with the role of each that holds one number."""
    found = {}
    for name, field in kind.model_fields.items():
        parts = [*field.metadata, *(part for each in get_args(field.annotation) for part in get_args(each))]
        role = next((part for part in parts if isinstance(part, Role)), None)
        found[field.alias or name] = name, role
    return found


@cache
def _checks(kind: type[Element]) -> tuple[Callable[[Any], Any], ...] | None:
    """What an element checks of itself once it is read; None if that needs to know where it stands."""
    known = kind.__pydantic_decorators__
    checks = tuple(each.func for each in known.model_validators.values())
    alone = all(len(signature(check).parameters) == 1 for check in checks)
    after = all(each.info.mode == "after" for each in known.model_validators.values())
    return checks if after and alone and not known.root_validators and not known.validators else None
