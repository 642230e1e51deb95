"""Losses of cables in addition to constant resistance and conductance, or tables of R, L, G and C over frequency."""

from functools import lru_cache
from math import pi, sqrt
from typing import Annotated

from pydantic import PrivateAttr, ValidationInfo, model_validator

from tline.errors import InputError
from tline.loss import ConstantLoss, DielectricLoss, Foster, Law, RoundWire, SkinEffect, tabulated
from tline.scene.element import Element, optional, required
from tline.scene.quantity import Frequency, PositiveResistancePerMetre, Quantity, Role
from tline.scene.text_file import beside, read_rows


class Skin(Element):
    """Skin effect from the resistance at one high frequency: above its corner the resistance rises with √f."""

    resistance: PositiveResistancePerMetre = required("per metre, at that frequency")
    frequency: Frequency = required("far above the corner")
    added: bool = optional("whether it adds to the resistance to steady current, as in W elements of SPICE", False)

    def laws(self, resistance: float) -> list[Law]:
        """Laws for a resistance to steady current, ohm/m: a transition to the skin effect, or the sum of both."""
        surface = self.resistance / sqrt(pi * self.frequency)
        return [ConstantLoss(resistance), SkinEffect(0.0, surface)] if self.added else [SkinEffect(resistance, surface)]


class Wire(Element):
    """Round wire alone; the other conductor is taken as perfect."""

    radius: Annotated[Quantity, Role("radius", "m", above=0)] | None = optional(
        "of the wire; half the line's wire_diameter or inner_diameter if not given"
    )
    conductivity: Annotated[Quantity, Role("conductivity", "S/m", above=0)] | None = optional("of its metal")
    resistance: PositiveResistancePerMetre | None = optional(
        "to steady current, per metre, instead of the conductivity"
    )

    def law(self, diameter: float | None) -> Law:
        """Internal impedance of the wire; its radius may follow from the diameter of the line's conductor, m."""
        radius = self.radius or (diameter or 0.0) / 2
        if not radius:
            raise InputError("wire", "its radius does not follow", "radius, or wire_diameter of the line")
        if self.conductivity is not None and self.resistance is None:
            return RoundWire(radius, self.conductivity)
        if self.resistance is not None and self.conductivity is None:
            return RoundWire.of_resistance(radius, self.resistance)
        raise InputError("wire", "not one of conductivity and resistance", "one of them")


class LossTangent(Element):
    """Insulation whose loss tangent hardly depends on frequency within a band."""

    value: Annotated[Quantity, Role("loss tangent", "", above=0, at_most=1)] = required("at the frequency")
    frequency: Frequency = required("between the limits")
    low: Frequency = required("below it there is less loss")
    high: Frequency = required("above it there is less loss")

    def law(self, capacitance: float) -> Law:
        """Law of the insulation for the capacitance at infinite frequency, F/m; at lower frequencies it is larger."""
        band = float(self.low), float(self.high)
        try:
            return DielectricLoss.before_front(capacitance, float(self.value), float(self.frequency), band)
        except InputError as error:
            key = "value" if error.where == "loss_tangent" else "frequency"
            raise InputError(f"loss_tangent.{key}", error.problem, error.expected, error.got) from None


COLUMNS = {3: "frequency, R, L", 5: "frequency, R, L, G, C"}
Rows = tuple[tuple[float, ...], ...]


class CableTable(Element):
    """Table of frequency (ascending, Hz), R in ohm/m, L in H/m, and optionally G in S/m and C in F/m, in a CSV file.

    The line is the causal and passive one that is nearest to the table; one that is not within the tolerance of it is
    refused. z0 and delay, which a front meets, are those at infinite frequency.
    """

    file: str = required("CSV file, looked for beside the scene file; a first line of words is skipped")
    tolerance: Annotated[Quantity, Role("tolerance", "", at_least=1e-12, at_most=0.5)] = optional(
        "largest difference of line and table, relative, of R + jωL and G + jωC", Quantity(0.01, "")
    )
    _laws: tuple[Foster, ...] = PrivateAttr()

    @property
    def series(self) -> Foster:
        """Law of R and L."""
        return self._laws[0]

    @property
    def shunt(self) -> Foster | None:
        """Law of G and C, if the table has them."""
        return self._laws[1] if len(self._laws) > 1 else None

    @model_validator(mode="after")
    def _read(self, info: ValidationInfo):
        path = beside(self.file, info)
        rows = tuple(read_rows(path, "file", "a row of the table", COLUMNS))
        columns = len(rows[0]) if rows else 3
        self._laws = tuple(_fitted(rows, first, float(self.tolerance)) for first in range(1, columns, 2))
        return self


@lru_cache
def _fitted(rows: Rows, first: int, tolerance: float) -> Foster:
    """Fit the law of two columns; errors name the columns."""
    names = COLUMNS[5].split(", ")
    try:
        frequencies, loss, storage = ([row[k] for row in rows] for k in (0, first, first + 1))
        law = tabulated(frequencies, loss, storage, tolerance)
    except InputError as error:
        problem = f"{names[first]} and {names[first + 1]}: {error.problem}"
        raise InputError("file", problem, error.expected, error.got) from None
    if law.storage == 0:
        problem = f"{names[first + 1]} falls to nothing at high frequency, and a front has no speed"
        raise InputError("file", problem, "frequencies up to where it stays")
    return law
