"""Losses of cables: inside conductors, in the insulation, and in the earth as return."""

import math
from typing import Any

from tline.errors import InputError
from tline.line.electrical import MU0
from tline.loss.law import Arithmetic, Law, not_negative, positive


class SkinEffect(Law):
    """Skin effect sqrt(R² + k² s): right at steady flow and far above the corner R²/k², a classical guess between.

    With R = 0 it is k sqrt(s), the surface impedance of a flat thick conductor; `ConstantLoss` + that is the model of
    the W element of SPICE programs with R0 and Rs.

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
        """Return sqrt(R² + k² s)."""
        return arithmetic.sqrt(s * self.surface**2 + (0 * s + self.loss) ** 2)  # so that loss is exact in balls


class RoundWire(Law):
    """Internal impedance of a straight round wire alone: R/2 · z I0(z)/I1(z), z = a·sqrt(s µ σ).

    R = 1/(π a² σ) at steady flow; there the internal inductance is µ/(8π). The inductance of the field outside is added
    as `ConstantLoss` (0, external inductance).

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
        """Create the wire of that radius, m, and resistance to steady current, ohm/m; not magnetic.

        Examples
        --------
        >>> f"{RoundWire.of_resistance(radius=0.01, resistance=1e-4).loss:.4g} ohm/m"
        '0.0001 ohm/m'
        """
        positive(radius=radius, resistance=resistance)
        return cls(radius, 1 / (math.pi * radius**2 * resistance))

    def beyond(self, s: Any, arithmetic: Arithmetic) -> Any:
        """Return R/2 · z I0(z)/I1(z)."""
        return arithmetic.quotient(0, arithmetic.sqrt(s * self.diffusion_time)) * (self.loss / 2)


class DielectricLoss(Law):
    """Dielectric loss Y(s) = s (C∞ + K ln((ω2 + s)/(ω1 + s))): a nearly constant, causal loss tangent within a band.

    Constant tan δ for all frequencies is not causal: where tan δ stays, the capacitance falls, by K ln(10) per
    decade. Near the ends of the band tan δ falls to half.

    Parameters
    ----------
    capacitance, loss_tangent : float
        Re(Y/s), F/m, and tan δ = -Im(Y/s)/Re(Y/s) at `frequency`, above 0.
    frequency : float
        Where those were measured, Hz.
    band : pair of float
        ω1/2π and ω2/2π, Hz: relaxation times are spread evenly, on a logarithmic scale, between them.

    Raises
    ------
    InputError
        A parameter that is not positive, a frequency not inside the band, or more loss than a capacitance that falls
        over so wide a band allows (C∞ would not be positive).

    References
    ----------
    C. Svensson, G. E. Dermer, IEEE Transactions on Advanced Packaging 24 (2001) 191-196, doi:10.1109/6040.928754.
    A. R. Djordjevic, R. M. Biljic, V. D. Likar-Smiljanic, T. K. Sarkar, IEEE Transactions on Electromagnetic
    Compatibility 43 (2001) 662-667, doi:10.1109/15.974647.

    Examples
    --------
    >>> law = DielectricLoss(capacitance=100e-12, loss_tangent=0.02, frequency=1e9, band=(1e4, 1e12))
    >>> y = law.at(2j * math.pi * 1e9) / (2j * math.pi * 1e9)
    >>> f"{y.real:.4e} F/m, tan delta {-y.imag / y.real:.4f}"
    '1.0000e-10 F/m, tan delta 0.0200'
    """

    def __init__(self, capacitance: float, loss_tangent: float, frequency: float, band: tuple[float, float]):
        low, high = band
        positive(capacitance=capacitance, loss_tangent=loss_tangent, frequency=frequency, low=low, high=high)
        if not low < frequency < high:
            raise InputError(
                "frequency", "not inside the band", f"between {low:g} and {high:g} Hz", f"{frequency:g} Hz"
            )
        angle = math.atan(frequency / low) - math.atan(frequency / high)
        fall = math.log(math.hypot(high, frequency) / math.hypot(low, frequency))
        self.spread = capacitance * loss_tangent / angle  # K
        storage = capacitance - self.spread * fall
        if storage <= 0:
            raise InputError(
                "loss_tangent", "too much for so wide a band", f"below {angle / fall:.3g}", f"{loss_tangent:g}"
            )
        super().__init__(0.0, storage)
        self.slow, self.fast = 2 * math.pi * low, 2 * math.pi * high

    @classmethod
    def before_front(
        cls, front: float, loss_tangent: float, frequency: float, band: tuple[float, float]
    ) -> "DielectricLoss":
        """Create the law by its capacitance at infinite frequency, F/m; at lower frequencies it is larger."""
        return cls(front / cls(1.0, loss_tangent, frequency, band).storage, loss_tangent, frequency, band)

    def beyond(self, s: Any, arithmetic: Arithmetic) -> Any:
        """Return s K ln(1 + (ω2 - ω1)/(ω1 + s))."""
        return s * arithmetic.log1p((self.fast - self.slow) / (s + self.slow)) * self.spread


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
        """Return µ0/(2π τ) · z² ln(1 + 1/z), z = h/p = sqrt(s τ)."""
        z = arithmetic.sqrt(s * self.diffusion_time)
        return z * arithmetic.log_ratio(z) * (MU0 / (2 * math.pi) / self.diffusion_time)
