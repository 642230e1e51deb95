"""Switches and valves whose resistance changes at an instant, at a node and between two."""

from typing import Literal

from pydantic import ValidationInfo, field_validator

from tline.scene.element import Placed, required
from tline.scene.medium import check_word
from tline.scene.quantity import Resistance, Time


class Switch(Placed):
    """A valve or switch whose resistance changes from one value to another at an instant."""

    kind: Literal["switch", "valve"]
    before: Resistance = required("resistance before the instant")
    after: Resistance = required("resistance from the instant on")
    time: Time = required("the instant")

    @field_validator("kind")
    @classmethod
    def _of_medium(cls, kind: str, info: ValidationInfo) -> str:
        return check_word(kind, info, "switch")
