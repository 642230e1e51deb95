"""Sites of nodes: their heights, and their places on a map."""

from typing import Annotated, Any

from pydantic import BeforeValidator

from tline.errors import InputError
from tline.scene.element import Element, optional
from tline.scene.quantity import AnyEffort, Quantity, Role
from tline.words.wording import shown

GRAVITY = 9.80665  # m/s²


def _pair(position: Any) -> Any:
    numbers = isinstance(position, list | tuple) and all(type(x) in (int, float) and abs(x) < 1e100 for x in position)
    if not numbers or len(position) != 2:
        raise InputError("", "not a place on a map", "two numbers such as [120, 45.5]", shown(position))
    return position


Place = Annotated[tuple[float, float], BeforeValidator(_pair)]


class Site(Element):
    """Height and place of a node.

    In a scene with elevations the effort u is the piezometric pressure, density·g·head, with g = 9.80665 m/s²: constant
    along a pipe at rest whatever its slope. Reservoirs and sources of pressure prescribe it. Elements open to the air
    see the gauge pressure at their node, u - density·g·elevation.
    """

    elevation: Annotated[Quantity, Role("length", "m")] | None = optional(
        "height of the node; 0 m if other nodes have one"
    )
    start: AnyEffort | None = optional(
        "piezometric pressure or voltage in the steady state of a part that nothing else determines, such "
        "as a pocket behind shut valves or check valves"
    )
    position: Place | None = optional("coordinates on a map, in any unit")
