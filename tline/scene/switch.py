"""Switches and valves whose resistance changes at an instant, at a node and between two."""

from typing import Literal

from pydantic import Field, ValidationInfo, field_validator

from tline.scene.element import Placed
from tline.scene.medium import check_word
from tline.scene.quantity import Resistance, Time


class Switch(Placed):
    """A valve or switch whose resistance changes from one value to another at an instant."""

    kind: Literal["switch", "valve"]
    before: Resistance = Field(description="resistance before the instant")
    after: Resistance = Field(description="resistance from the instant on")
    time: Time = Field(description="the instant")

    @field_validator("kind")
    @classmethod
    def _of_medium(cls, kind: str, info: ValidationInfo) -> str:
        return check_word(kind, info, "switch")
