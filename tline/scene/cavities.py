"""Column separation inside a pipe: cavities at equally spaced places, which part it in equal stretches."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field

from tline.errors import InputError
from tline.scene.quantity import Quantity, Role, Whole
from tline.scene.vessel import Boiling
from tline.words.wording import place

if TYPE_CHECKING:
    from tline.scene.line import SceneLine

MOST = 1000  # places


class Cavities(Boiling):
    """Cavities at places inside a pipe: of free gas and vapour (DGCM), or of vapour alone (DVCM).

    Where the ends of the pipe have elevations, that of a place lies on the straight line between them.

    References
    ----------
    E. B. Wylie, V. L. Streeter: Fluid Transients in Systems (1993), chapter 8.
    """

    places: Annotated[int, Whole(1, MOST)] = Field(
        description=f"number of places, from 1 to {MOST}, between which are equal stretches"
    )
    gas_volume: Annotated[Quantity, Role("volume", "m^3", above=0)] | None = Field(
        default=None,
        description="volume of the free gas at each place at the atmosphere's pressure, often 1e-7 of the liquid's "
        "between two places; without it vapour alone",
    )

    def load(self, node: str) -> dict[str, Any]:
        """The table of the load at a node."""
        table: dict[str, Any] = {"at": node, "kind": "vapour cavity"}
        table |= {"vapour_pressure": float(self.vapour_pressure), "atmosphere": float(self.atmosphere)}
        return table | ({"kind": "cavity", "gas_volume": float(self.gas_volume)} if self.gas_volume is not None else {})


def with_cavities(lines: Mapping[str, "SceneLine"]) -> dict[str, "SceneLine"]:
    """Those of the lines that have cavities; coupled conductors never do."""
    return {name: line for name, line in lines.items() if getattr(type(line), "stretches", None) and line.stretches > 1}


def refuse_cavities(lines: Mapping[str, "SceneLine"], what: str) -> None:
    """Refuse cavities in lines where something does not know them."""
    for name in with_cavities(lines):
        raise InputError(place("lines", name, "cavities"), "is non-linear", f"a line without for {what}")
