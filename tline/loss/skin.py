"""Impedance inside conductors: the current moves to the surface as the frequency rises."""

import math
from typing import Any

from tline.line.electrical import MU0
from tline.loss.arithmetic import Arithmetic
from tline.loss.check import not_negative, positive
from tline.loss.law import Law


class SkinEffect(Law):
    """Z(s) = sqrt(R² + k² s): right at steady flow and far above the corner R²/k², a classical guess between.

    With R = 0 it is k sqrt(s), the surface impedance of a flat thick conductor; `ConstantLoss` + that is what the W
    element of SPICE programs takes for R0 and Rs.

    Parameters
    ----------
    resistance : float
        R at steady flow, ohm/m, from 0.
    surface : float
        k, ohm s^½/m, from 0 (not both 0): the resistance at a high frequency f is k·sqrt(π f), so k = Rs/sqrt(π) with
        Rs in ohm/(m·sqrt(Hz)); a conductor of permeability µ, conductivity σ and perimeter p has k = sqrt(µ/σ)/p.

    Raises
    ------
    InputError
        A negative parameter, or both zero.

    References
    ----------
    S. Ramo, J. R. Whinnery, T. Van Duzer, Fields and Waves in Communication Electronics, 3rd ed., Wiley 1994.
    H. A. Wheeler, Proceedings of the IRE 30 (1942) 412-424, doi:10.1109/JRPROC.1942.232015.

    Examples
    --------
    >>> law = SkinEffect(resistance=5, surface=1e-3)
    >>> print(law.at([0, 2e12j]).round(2))
    [   5.    +0.j   1000.01+999.99j]
    """

    def __init__(self, resistance: float, surface: float):
        not_negative(resistance=resistance, surface=surface)
        positive(resistance_or_surface=max(resistance, surface))
        super().__init__(resistance, 0.0)
        self.surface = float(surface)

    def beyond(self, s: Any, arithmetic: Arithmetic) -> Any:
        """sqrt(R² + k² s)."""
        return arithmetic.sqrt(s * self.surface**2 + (0 * s + self.loss) ** 2)  # so that loss is exact in balls


class RoundWire(Law):
    """Internal impedance of a straight round wire alone: R/2 · z I0(z)/I1(z), z = a·sqrt(s µ σ).

    R = 1/(π a² σ) at steady flow; there the internal inductance is µ/(8π). What the field outside holds is added as
    `ConstantLoss` (0, external inductance).

    Parameters
    ----------
    radius : float
        a, m, above 0.
    conductivity : float
        σ, S/m, above 0 (copper at 20 °C: 5.8e7).
    permeability : float
        µ, H/m, above 0; that of vacuum if not given.

    Raises
    ------
    InputError
        A parameter that is not positive.

    References
    ----------
    S. A. Schelkunoff, Bell System Technical Journal 13 (1934) 532-579, doi:10.1002/j.1538-7305.1934.tb00679.x.
    Ramo, Whinnery, Van Duzer (1994).

    Examples
    --------
    >>> wire = RoundWire(radius=0.5e-3, conductivity=5.8e7)
    >>> f"{wire.loss:.5f} ohm/m, {wire.at(2j):.3e}"  # 2 j µ/(8 π) = 1e-7 j
    '0.02195 ohm/m, 2.195e-02+1.000e-07j'
    """

    def __init__(self, radius: float, conductivity: float, permeability: float = MU0):
        positive(radius=radius, conductivity=conductivity, permeability=permeability)
        super().__init__(1 / (math.pi * radius**2 * conductivity), 0.0)
        self.diffusion_time = radius**2 * permeability * conductivity

    @classmethod
    def of_resistance(cls, radius: float, resistance: float) -> "RoundWire":
        """The wire of that radius, m, and resistance to steady current, ohm/m; not magnetic.

        Examples
        --------
        >>> f"{RoundWire.of_resistance(radius=0.01, resistance=1e-4).loss:.4g} ohm/m"
        '0.0001 ohm/m'
        """
        positive(radius=radius, resistance=resistance)
        return cls(radius, 1 / (math.pi * radius**2 * resistance))

    def beyond(self, s: Any, arithmetic: Arithmetic) -> Any:
        """R/2 · z I0(z)/I1(z)."""
        return arithmetic.quotient(0, arithmetic.sqrt(s * self.diffusion_time)) * (self.loss / 2)
