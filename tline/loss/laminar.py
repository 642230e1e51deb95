"""Friction of laminar flow in a round pipe."""

import math
from typing import Any

from tline.loss.arithmetic import Arithmetic
from tline.loss.check import positive
from tline.loss.constant import ConstantLoss
from tline.loss.law import Law


def hagen_poiseuille(density: float, viscosity: float, radius: float) -> ConstantLoss:
    """Friction as in steady laminar flow, at all frequencies: 8µ/(π R⁴) + s ρ/A.

    Parameters
    ----------
    density, viscosity, radius : float
        As `LaminarFriction`.

    Raises
    ------
    InputError
        A parameter that is not positive.

    References
    ----------
    F. M. White, Viscous Fluid Flow, 3rd ed., McGraw-Hill 2006.

    Examples
    --------
    >>> f"{hagen_poiseuille(density=1000, viscosity=1e-3, radius=0.01).loss:.5g} Pa s/m^4"
    '2.5465e+05 Pa s/m^4'
    """
    positive(density=density, viscosity=viscosity, radius=radius)
    return ConstantLoss(8 * viscosity / (math.pi * radius**4), density / (math.pi * radius**2))


class LaminarFriction(Law):
    """Frequency-dependent friction, exact for laminar flow in a long round pipe.

    Z(s) = s ρ/A · I0(z)/I2(z), z = R·sqrt(s ρ/µ).

    Parameters
    ----------
    density : float
        ρ, kg/m³, above 0.
    viscosity : float
        µ, dynamic, Pa s, above 0.
    radius : float
        R, m, above 0.

    Raises
    ------
    InputError
        A parameter that is not positive.

    Notes
    -----
    Computed as s ρ/A + 2µ/(π R⁴) · z I1(z)/I2(z). Valid for waves much longer than the radius and Reynolds numbers
    below about 2000.

    References
    ----------
    W. Zielke, Journal of Basic Engineering 90 (1968) 109-115, doi:10.1115/1.3605049. J. R. Womersley, Journal of
    Physiology 127 (1955) 553-563, doi:10.1113/jphysiol.1955.sp005276 (the same, over frequency).

    Examples
    --------
    >>> pipe = LaminarFriction(density=1000, viscosity=1e-3, radius=0.01)
    >>> print(f"{pipe.at(0):.5g}, {pipe.at(100j):.5g}")
    2.5465e+05+0j, 4.5979e+06+3.2281e+08j
    """

    def __init__(self, density: float, viscosity: float, radius: float):
        steady = hagen_poiseuille(density, viscosity, radius)
        super().__init__(steady.loss, steady.storage)
        self.diffusion_time = radius**2 * density / viscosity

    def beyond(self, s: Any, arithmetic: Arithmetic) -> Any:
        """2µ/(π R⁴) · z I1(z)/I2(z)."""
        return arithmetic.quotient(1, arithmetic.sqrt(s * self.diffusion_time)) * (self.loss / 4)
