"""Laws of both media: diodes, and tables of effort and flow."""

from itertools import pairwise
from math import log, pi
from typing import Annotated, Literal

import numpy as np
from pydantic import PrivateAttr, ValidationInfo, model_validator

from tline.errors import InputError
from tline.scene.element import AtNode, Placed, optional, pair, required
from tline.scene.factor import ALWAYS, Factor
from tline.scene.law import Bend, ElementLaw, LawKind, NonLinear
from tline.scene.polyline import Tabled
from tline.scene.quantity import AnyEffort, Quantity, Role
from tline.scene.text_file import beside, read_rows

BOLTZMANN, CHARGE = 1.380649e-23, 1.602176634e-19  # J/K, C; exact in the SI
Saturation = Annotated[Quantity, Role("flow", at_least=1e-30, at_most=1e3)]
Emission = Annotated[Quantity, Role("emission", "", at_least=0.1, at_most=100)]
MOST_POINTS = 1000  # points of a curve
COLDEST, HOTTEST = 1.0, 5000.0  # K
HOTTEST_JUNCTION = 700.0  # relative to the thermal voltage: largest exponent of the diode law


class Shockley(LawKind):
    """Law of a diode; constants: effort beyond the element, saturation current, thermal voltage."""

    name, unit = "diode", "laws.diode.diode"

    def knees(self, c, rho):
        """Place of the pair of branch points of Lambert's W in the flow, π thermal voltages beside real waves."""
        beyond, saturation, thermal = c
        if rho > 0:
            place = beyond + thermal * (log(thermal / (rho * saturation)) - 1) - rho * saturation
            yield Bend(place, layer=pi * thermal)

    def flow(self, c):  # noqa: D102
        _, saturation, thermal = c
        return lambda d: saturation * np.expm1(np.minimum(d / thermal, HOTTEST_JUNCTION))


class Reversible(AtNode):
    """Element at a node that may point either way."""

    reverse: bool = optional("whether it points from the reference to the node", False)


class Diode(NonLinear, Placed, load=Reversible):
    """A diode from the node to the reference, or from the first node to the second: i = Is·(exp(u/(n·k·T/q)) - 1).

    References
    ----------
    W. Shockley: The theory of p-n junctions in semiconductors and p-n junction transistors. Bell Syst. Tech. J. 28
    (1949) 435-489.
    """

    kind: Literal["diode"] = "diode"
    saturation: Saturation = required("current that flows backwards, Is")
    emission: Emission = optional("n", Quantity(1, ""))
    temperature: Annotated[Quantity, Role("temperature", "K", at_least=COLDEST, at_most=HOTTEST)] = optional(
        "of the junction", Quantity("300.15 K", "K")
    )

    def law(self) -> ElementLaw:  # noqa: D102
        thermal = self.emission * BOLTZMANN * self.temperature / CHARGE
        return ElementLaw(
            "diode", (0.0, float(self.saturation), float(thermal)), reverse=getattr(self, "reverse", False)
        )


Point = Annotated[tuple[AnyEffort, Annotated[Quantity, Role("flow")]], pair("effort, flow")]


class Curve(NonLinear, Placed):
    """Flow over effort, to the reference or from node to node: straight lines between points, continued beyond."""

    kind: Literal["table"] = "table"
    points: list[Point] | None = optional(
        "pairs [effort, flow], neither of which may fall", min_length=2, max_length=MOST_POINTS
    )
    file: str | None = optional("instead of `points`, a CSV file of two columns, effort and flow, in SI")
    scale: Factor = optional("what all flows are multiplied by, constant or over time", ALWAYS)

    _curve: tuple[tuple[float, ...], ...] = PrivateAttr()

    @model_validator(mode="after")
    def _rises(self, info: ValidationInfo):
        if (self.points is None) == (self.file is None):
            raise InputError("", "its curve is not given once", "either points or file")
        self._curve = tuple((float(u), float(i)) for u, i in self.points or ()) or _read(self.file or "", info)
        for k, ((u, i), (v, j)) in enumerate(pairwise(self._curve), 2):
            if v < u or j < i or (u, i) == (v, j):
                where = f"points[{k - 1}]" if self.points else "file"
                got = f"({v:g}, {j:g}) after ({u:g}, {i:g})"
                raise InputError(where, "the curve falls or stands still", "points that rise", got)
        return self

    def law(self) -> ElementLaw:  # noqa: D102
        efforts, flows = zip(*self._curve, strict=True)
        return ElementLaw(Tabled.name, (0.0, float(len(efforts)), *map(float, efforts), *map(float, flows)), self.scale)


def _read(file: str, info: ValidationInfo) -> tuple[tuple[float, ...], ...]:
    """Read the points of a CSV file."""
    rows = read_rows(beside(file, info), "file", "a point", {2: "two finite numbers with a comma between"})
    if not 2 <= len(rows) <= MOST_POINTS:
        raise InputError("file", f"not the points of a curve in '{file}'", f"2 to {MOST_POINTS} lines", str(len(rows)))
    return tuple(rows)
