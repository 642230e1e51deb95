"""The two media: names of effort and flow, and their units."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, NamedTuple

from tline.errors import InputError
from tline.units import to_si

if TYPE_CHECKING:
    from pydantic import ValidationInfo

    from tline.scene.scene import Scene


class Medium(NamedTuple):
    """Words and SI units of a medium."""

    name: str
    effort: str  # name of u
    flow: str  # name of y
    units: dict[str, str]  # role -> SI unit
    shown: dict[str, str]  # role, or SI unit -> unit people read it in
    no_flow: str  # kind of load that lets nothing pass
    switch: str  # kind of load that opens or closes
    written: dict[str, str]  # role, or SI unit -> unit in tables, where that is not SI

    def unit(self, quantity: str, written: bool = False) -> tuple[float, str]:
        """Size and name of the unit for a role or an SI unit, in which it is displayed, or written to files.

        Examples
        --------
        >>> HYDRAULIC.unit("effort"), HYDRAULIC.unit("m^3/s"), HYDRAULIC.unit("effort", written=True)
        ((100000.0, 'bar'), (0.001, 'L/s'), (1.0, 'Pa'))
        """
        si = self.units.get(quantity, quantity)
        role = next((role for role, unit in self.units.items() if unit == si), si)
        name = (self.written if written else self.shown).get(role, si)
        return (to_si(f"1 {name}", None) if name else 1.0), name

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
    {"effort": "bar", "flow": "L/s", "Hz": "rpm"},
    "closed",
    "valve",
    {},
)
ELECTRICAL = Medium(
    "electrical",
    "voltage",
    "current",
    {"effort": "V", "flow": "A", "resistance": "ohm", "inductance": "H", "capacitance": "F"},
    {"effort": "V", "flow": "A"},
    "open",
    "switch",
    {},
)
MEDIA = {medium.name: medium for medium in (HYDRAULIC, ELECTRICAL)}
SYSTEMS = {"si": (), "us": ("psi", "gpm", "ft", "ft/s", "ft^3", "hp", "ft lbf", "lbf")}
OTHERS = "m", "m/s", "m^3", "W", "N m", "N", "Hz"  # SI units of other quantities than effort and flow


def readable(scene: Scene) -> Medium:
    """Medium of a scene, with the units for display."""
    return in_units(scene.medium, scene.units)


@cache
def in_units(medium: str, text: str) -> Medium:
    """Medium with the units that a text names: a system, units of single quantities, or both.

    Examples
    --------
    >>> in_units("hydraulic", "US, MGD").shown["effort"], in_units("hydraulic", "US, MGD").shown["flow"]
    ('psi', 'MGD')
    """
    known, chosen = MEDIA[medium], dict[str, str]()
    roles = {"effort": known.units["effort"], "flow": known.units["flow"], **{unit: unit for unit in OTHERS}}
    for word in (word.strip() for word in text.split(",")):
        system = SYSTEMS.get(word.lower())
        for unit in (word,) if system is None else system:
            role = next((role for role, si in roles.items() if _fits(unit, si)), None)
            if role is None and system is None:
                raise InputError("", "no unit that results have", "'SI', 'US', or units such as 'US, MGD'", f"'{unit}'")
            chosen |= {role: unit} if role else {}
    return known._replace(shown=known.shown | chosen, written=chosen)


def _fits(unit: str, si: str) -> bool:
    try:
        return to_si(f"1 {unit}", si) > 0
    except InputError:
        return False


def check_units(text: str, info: ValidationInfo) -> str:
    """Check a text that names units of the scene's medium."""
    in_units((info.context or {}).get("medium", "hydraulic"), text)
    return text


def check_word(kind: str, info: ValidationInfo, *roles: str) -> str:
    """Check that the kind of an element is the word of the scene's medium for one of some roles."""
    medium = MEDIA.get((info.context or {}).get("medium", ""))
    words = [getattr(medium, role) for role in roles] if medium else [kind]
    if medium and kind not in words:
        raise InputError("", f"not a word of {medium.name} scenes", " or ".join(map(repr, words)), f"'{kind}'")
    return kind
