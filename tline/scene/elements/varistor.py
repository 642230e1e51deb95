"""Varistors: zinc oxide arresters, and other clamps with a power law."""

from typing import Annotated, ClassVar, Literal

import numpy as np

from tline.scene.element import Placed, optional, required
from tline.scene.law import Bend, ElementLaw, LawKind, OfCables
from tline.scene.quantity import Effort, Quantity, Role


class PowerLaw(LawKind):
    """Law of a varistor; constants: effort beyond the element, current at a voltage, that voltage, exponent."""

    name, unit = "varistor", "laws.varistor.varistor"

    def bends(self, c, rho):
        """Kink at the origin, unless the exponent is odd: then the law is smooth there too."""
        if c[3] % 2 != 1:
            yield Bend(c[0])

    def flow(self, c):  # noqa: D102
        _, current, voltage, exponent = c
        return lambda d: current * np.sign(d) * np.abs(d / voltage) ** exponent


class Varistor(OfCables, Placed):
    """Varistor or arrester: i = current·sign(u)·(abs(u)/voltage)^exponent.

    References
    ----------
    W. G. Carlson, T. K. Gupta, A. Sweetana: A procedure for estimating the lifetime of gapless metal oxide surge
    arresters for ac application. IEEE Trans. Power Delivery 1 (1986) 67-74.
    """

    kind: Literal["varistor"] = "varistor"
    current: Annotated[Quantity, Role("flow", above=0)] = required("current at that voltage, such as 1 mA")
    voltage: Effort = required("voltage at which that current flows")
    exponent: Annotated[Quantity, Role("exponent", "", at_least=1, at_most=100)] = optional(
        "20 to 50 of zinc oxide, 3 to 7 of silicon carbide", Quantity(25, "")
    )
    example: ClassVar[str] = 'kind = "varistor"\ncurrent = "1 mA"\nvoltage = "420 V"\n'

    def law(self) -> ElementLaw:  # noqa: D102
        return ElementLaw("varistor", (0.0, float(self.current), float(self.voltage), float(self.exponent)))
