"""Loss in an insulation whose loss tangent hardly depends on frequency."""

import math
from typing import Any

from tline.errors import InputError
from tline.loss.arithmetic import Arithmetic
from tline.loss.check import positive
from tline.loss.law import Law


class DielectricLoss(Law):
    """Y(s) = s (C∞ + K ln((ω2 + s)/(ω1 + s))): a loss tangent nearly constant between two frequencies, and causal.

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

    def beyond(self, s: Any, arithmetic: Arithmetic) -> Any:
        """s K ln(1 + (ω2 - ω1)/(ω1 + s))."""
        return s * arithmetic.log1p((self.fast - self.slow) / (s + self.slow)) * self.spread
