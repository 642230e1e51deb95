"""The two media: what effort and flow are called there, and their units."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from tline.errors import InputError

if TYPE_CHECKING:
    from pydantic import ValidationInfo


class Medium(NamedTuple):
    """Words and SI units of a medium."""

    name: str
    effort: str  # what u is
    flow: str  # what y is
    units: dict[str, str]  # role -> SI unit
    shown: dict[str, str]  # role -> unit people read it in
    no_flow: str  # kind of load that lets nothing pass
    switch: str  # kind of load that opens or closes

    @property
    def hydraulic(self) -> bool:
        """Whether efforts are pressures."""
        return self.name == "hydraulic"


HYDRAULIC = Medium(
    "hydraulic",
    "pressure",
    "flow",
    {
        "effort": "Pa",
        "flow": "m^3/s",
        "resistance": "Pa s/m^3",
        "inductance": "Pa s^2/m^3",
        "capacitance": "m^3/Pa",
    },
    {"effort": "bar", "flow": "L/s"},
    "closed",
    "valve",
)
ELECTRICAL = Medium(
    "electrical",
    "voltage",
    "current",
    {"effort": "V", "flow": "A", "resistance": "ohm", "inductance": "H", "capacitance": "F"},
    {"effort": "V", "flow": "A"},
    "open",
    "switch",
)
MEDIA = {medium.name: medium for medium in (HYDRAULIC, ELECTRICAL)}


def check_word(kind: str, info: ValidationInfo, role: str) -> str:
    """The kind of an element, if it is the word of the scene's medium for that role."""
    medium = MEDIA.get((info.context or {}).get("medium", ""))
    if medium is not None and getattr(medium, role) != kind:
        raise InputError("", f"not a word of {medium.name} scenes", f"'{getattr(medium, role)}'", f"'{kind}'")
    return kind
