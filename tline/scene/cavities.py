"""Liquid that boils: at places inside a pipe, and what all cavities have in common."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import model_validator

from tline.errors import InputError
from tline.scene.element import Element, optional, required
from tline.scene.quantity import PositivePressure, PositiveVolume, Quantity, Whole

if TYPE_CHECKING:
    from tline.scene.line import SceneLine

ATMOSPHERE = Quantity(101_325, "Pa")
MOST_PLACES = 1000  # places


class Boiling(Element):
    """Liquid that boils where its pressure falls far enough."""

    vapour_pressure: PositivePressure = optional("absolute; of water at 20 degC", Quantity(2339, "Pa"))
    atmosphere: PositivePressure = optional("absolute pressure of the air outside", ATMOSPHERE)

    @model_validator(mode="after")
    def _boils_below(self):
        if self.vapour_pressure >= self.atmosphere:
            expected = f"less than the atmosphere's {self.atmosphere:g} Pa"
            raise InputError("vapour_pressure", "too high", expected, f"{self.vapour_pressure:g} Pa")
        return self


class Cavities(Boiling):
    """Cavities at places inside a pipe: of free gas and vapour (DGCM), or of vapour alone (DVCM).

    Where the ends of the pipe have elevations, that of a place lies on the straight line between them.

    References
    ----------
    E. B. Wylie, V. L. Streeter: Fluid Transients in Systems (1993), chapter 8.
    """

    places: Annotated[int, Whole(1, MOST_PLACES)] = required(
        f"number of places, from 1 to {MOST_PLACES}, between which are equal stretches"
    )
    gas_volume: PositiveVolume | None = optional(
        "volume of the free gas at each place at the atmosphere's pressure, often 1e-7 of the liquid's "
        "between two places; without it vapour alone"
    )

    def load(self, node: str) -> dict[str, Any]:
        """Table of the load at a node."""
        table: dict[str, Any] = {"at": node, "kind": "vapour cavity"}
        table |= {"vapour_pressure": float(self.vapour_pressure), "atmosphere": float(self.atmosphere)}
        return table | ({"kind": "cavity", "gas_volume": float(self.gas_volume)} if self.gas_volume is not None else {})


def with_cavities(lines: Mapping[str, "SceneLine"]) -> dict[str, "SceneLine"]:
    """Lines that have cavities; coupled conductors never do, nor tables of pipes."""
    if not isinstance(lines, dict):
        return {}
    return {name: line for name, line in lines.items() if getattr(type(line), "stretches", None) and line.stretches > 1}
