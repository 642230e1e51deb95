"""Earth as the return conductor of an overhead line."""

import math
from typing import Any

from tline.line.electrical import MU0
from tline.loss.arithmetic import Arithmetic
from tline.loss.check import positive
from tline.loss.law import Law


class EarthReturn(Law):
    """Impedance that earth adds to a wire over a perfect ground: s µ0/2π · ln(1 + p/h), p = sqrt(ρ/(s µ0)).

    Deri's complex depth: earth acts as a perfect mirror at the depth p. Inductance outside the wire and its internal
    impedance are added as `ConstantLoss` (0, external inductance) and `RoundWire`.

    Parameters
    ----------
    height : float
        h of the wire's centre over earth, m, above 0.
    resistivity : float
        ρ of the earth, ohm m, above 0 (10 in wet clay, 100 in loam, 1000 in sand or rock).

    Raises
    ------
    InputError
        A parameter that is not positive.

    Notes
    -----
    Positive real: for s above the negative real axis arg(1 + p/h) lies between -π/2 and 0, so Im ln(1 + p/h) does, and
    F/s = µ0/2π · ln(1 + p/h) = ∫ r(x)/(s + x) dx with r(x) = µ0/2π² · arctan(sqrt(ρ/(x µ0))/h) > 0: relaxations only.

    Carson's integral is exact for a flat, homogeneous earth without displacement currents. Deri's formula is within
    2.6 % of it, and its real part within 3.4 %, at any height, resistivity and frequency. Displacement currents exceed
    conduction above 1/(2π ρ εr ε0), 2 MHz at 1000 ohm m with εr = 10: the law is for slower edges than that.

    References
    ----------
    A. Deri, G. Tevan, A. Semlyen, A. Castanheira, IEEE Transactions on Power Apparatus and Systems PAS-100 (1981)
    3686-3693, doi:10.1109/TPAS.1981.317011. J. R. Carson, Bell System Technical Journal 5 (1926) 539-554,
    doi:10.1002/j.1538-7305.1926.tb00122.x.

    Examples
    --------
    >>> earth = EarthReturn(height=10, resistivity=100)
    >>> print((earth.at(2j * math.pi * 50) * 1000).round(4), "ohm/km")  # R goes to µ0 ω/8, 0.0493 ohm/km
    (0.0485+0.2471j) ohm/km
    """

    def __init__(self, height: float, resistivity: float):
        positive(height=height, resistivity=resistivity)
        super().__init__(0.0, 0.0)
        self.diffusion_time = height**2 * MU0 / resistivity

    def beyond(self, s: Any, arithmetic: Arithmetic) -> Any:
        """µ0/(2π τ) · z² ln(1 + 1/z), z = h/p = sqrt(s τ)."""
        z = arithmetic.sqrt(s * self.diffusion_time)
        return z * arithmetic.log_ratio(z) * (MU0 / (2 * math.pi) / self.diffusion_time)
