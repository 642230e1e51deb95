"""Switches and valves whose resistance changes at an instant, at a node and between two."""

from typing import Literal

from pydantic import Field, ValidationInfo, field_validator

from tline.scene.between import Between
from tline.scene.element import AtNode, Element
from tline.scene.medium import check_word
from tline.scene.quantity import Resistance, Time


class _Switch(Element):
    kind: Literal["switch", "valve"]
    before: Resistance = Field(description="resistance before the instant")
    after: Resistance = Field(description="resistance from the instant on")
    time: Time = Field(description="the instant")

    @field_validator("kind")
    @classmethod
    def _of_medium(cls, kind: str, info: ValidationInfo) -> str:
        return check_word(kind, info, "switch")


class Switch(_Switch, AtNode):
    """A valve or switch whose resistance changes from one value to another at an instant."""


class SwitchLink(_Switch, Between):
    """A valve or switch between two nodes whose resistance changes from one value to another at an instant."""
