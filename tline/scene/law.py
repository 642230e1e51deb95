"""What an element of a scene tells the solver: the kind of its law, its constants, and what scales it over time."""

from typing import NamedTuple

from pydantic import ValidationInfo, field_validator

from tline.errors import InputError
from tline.scene.element import Element
from tline.scene.shape import Shape

# the key of what scales a kind over time
FACTORS = {
    "quadratic": "opening",
    "leak": "opening",
    "demand": "pattern",
    "pump": "speed",
    "rotor": "trip",
    "table": "scale",
    "user_defined": "opening",
}


class ElementLaw(NamedTuple):
    """Flow as a function of the effort across an element; the solver knows the kinds and what their constants mean."""

    kind: str
    constants: tuple[float, ...]
    factor: Shape | None = None  # opening or speed over time, 1 without it
    reverse: bool = False  # whether it looks from the second node, or the reference, to the first


class NonLinear(Element):
    """An element with such a law."""

    def law(self) -> ElementLaw:
        """What the solver needs to know of it."""
        raise NotImplementedError


class OfLiquids(NonLinear):
    """One that only pipes have."""

    @field_validator("kind", check_fields=False)
    @classmethod
    def _of_medium(cls, kind: str, info: ValidationInfo) -> str:
        if (info.context or {}).get("medium") == "electrical":
            expected = "such as 'resistor', 'diode' or 'table'"
            raise InputError("", "not a word of electrical scenes", expected, f"'{kind}'")
        return kind
