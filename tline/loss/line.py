"""Uniform line of two laws, its exact response over frequency, and all its losses."""

import math
from dataclasses import dataclass
from math import sqrt
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tline.errors import InputError
from tline.loss.flow_law import FlowLaw, PowerLaw
from tline.loss.law import Arithmetic, ByValue, ConstantLoss, Law, points, positive

DISTORTIONLESS = 1e-12  # relative difference of R C and G L from rounding of typed decimals


class LossyLine(ByValue):
    """Length of line with series impedance Z'(s) and shunt admittance Y'(s) per metre.

    Parameters
    ----------
    series, shunt : Law
        Z', ohm/m (Pa s/m⁴), and Y', S/m (m²/(Pa s)); the shunt's storage above 0.
    length : float
        l, m, above 0.

    Raises
    ------
    InputError
        A length that is not positive, a shunt without storage, or a series impedance that is zero.

    Notes
    -----
    Γ = sqrt(Z') sqrt(Y') and Zc = sqrt(Z')/sqrt(Y') with principal roots are analytic off the negative real axis, and
    Zc + R is not zero there for any R >= 0.

    Examples
    --------
    >>> line = LossyLine(ConstantLoss(20, 250e-9), ConstantLoss(0, 100e-12), length=0.2)
    >>> f"z0 = {line.z0:.4g} ohm, delay {line.delay:.4g} s, {line.gamma(1e10j):.4f} per metre"
    'z0 = 50 ohm, delay 1e-09 s, 0.2000+50.0004j per metre'
    """

    def __init__(self, series: Law, shunt: Law, length: float):
        positive(length=length)
        if shunt.storage <= 0:
            raise InputError("shunt", "has no storage", "a capacitance or compliance above 0", f"{shunt.storage:g}")
        if not (series.loss or series.storage or series.at(1.0)):  # it rises from its loss, faster than its storage
            raise InputError("series", "no impedance at all", "a resistance or inductance above 0", "0")
        self.series, self.shunt, self.length = series, shunt, float(length)

    @property
    def z0(self) -> float:
        """Impedance sqrt(L/C), the limit of Zc for s to infinity, which a front meets; 0 for a series impedance without
        storage."""
        return math.sqrt(self.series.storage / self.shunt.storage)

    @property
    def delay(self) -> float:
        """Delay l sqrt(L C) of a front, s; 0 for a series impedance without storage."""
        return self.length * math.sqrt(self.series.storage * self.shunt.storage)

    @property
    def constant(self) -> bool:
        """Whether R and G are constant over frequency."""
        return isinstance(self.series, ConstantLoss) and isinstance(self.shunt, ConstantLoss)

    @property
    def distortionless(self) -> bool:
        """Whether R/L = G/C, to rounding: the line only delays and attenuates by exp(-l sqrt(R G)), and Zc = z0."""
        return self.constant and math.isclose(
            self.series.loss * self.shunt.storage, self.shunt.loss * self.series.storage, rel_tol=DISTORTIONLESS
        )

    def waves(self, s: Any, arithmetic: Arithmetic) -> tuple[Any, Any]:
        """Propagation Γ(s), 1/m, and Zc(s), ohm or Pa s/m³, in the arithmetic of s."""
        z, y = (arithmetic.sqrt(law.value(s, arithmetic)) for law in (self.series, self.shunt))
        return z * y, z / y

    def gamma(self, s: ArrayLike) -> NDArray[np.complex128]:
        """Propagation Γ(s), 1/m; shape of s, 1/s, off the negative real axis."""
        return np.sqrt(self.series.at(s)) * np.sqrt(self.shunt.at(s))

    def beyond_delay(self, s: NDArray, total: NDArray) -> NDArray:
        """Difference Γl - sT, from Γl, for constant R and G, without cancellation at high frequencies."""
        (r, g), L, C = (self.series.loss, self.shunt.loss), self.series.storage, self.shunt.storage
        return self.length**2 * ((r * C + g * L) * s + r * g) / (total + s * self.delay)

    def zc(self, s: ArrayLike) -> NDArray[np.complex128]:
        """Characteristic impedance Zc(s), ohm or Pa s/m³; shape of s. Infinite at s = 0 if the shunt does not leak."""
        y = self.shunt.at(s)
        return np.where(y == 0, np.inf, np.sqrt(self.series.at(s)) / np.sqrt(np.where(y == 0, 1, y)))

    def chain(self, s: ArrayLike) -> NDArray[np.complex128]:
        """Chain matrix: (u1, y1) = M (u2, y2), with y from end 1 to end 2 at both.

        Parameters
        ----------
        s : array_like of complex
            1/s, off the negative real axis; zero is fine.

        Returns
        -------
        ndarray of complex, shape of s and (2, 2)
            cosh(Γl), Zc sinh(Γl); sinh(Γl)/Zc, cosh(Γl).

        References
        ----------
        D. M. Pozar, Microwave Engineering, 4th ed., Wiley 2012, table 4.1.
        """
        total = self.gamma(s) * self.length
        shape = sinhc(total) * self.length
        entries = [np.cosh(total), self.series.at(s) * shape, self.shunt.at(s) * shape, np.cosh(total)]
        return np.stack(entries, axis=-1).reshape(*total.shape, 2, 2)

    def input_impedance(self, s: ArrayLike, load: ArrayLike) -> NDArray[np.complex128]:
        """Input impedance u1/y1 with a load at end 2.

        Parameters
        ----------
        s : array_like of complex
            1/s, off the negative real axis.
        load : array_like of complex
            u2/y2 at these points, ohm or Pa s/m³; np.inf for an open end.

        Returns
        -------
        ndarray of complex, shape of s and load together; inf where no flow enters

        References
        ----------
        Pozar (2012), equation (2.91).
        """
        s, load = np.broadcast_arrays(points(s), np.asarray(load, complex))
        z, y = self.series.at(s), self.shunt.at(s)
        shape = tanhc(self.gamma(s) * self.length) * self.length
        is_open = np.isinf(load)
        end = np.where(is_open, 0, load)
        over = np.where(is_open, 1, end + z * shape)
        under = np.where(is_open, y * shape, 1 + y * shape * end)
        return np.where(under == 0, np.inf, over / np.where(under == 0, 1, under))


def sinhc(z: NDArray) -> NDArray:
    """Compute sinh(z)/z."""
    return np.where(z == 0, 1, np.sinh(z) / np.where(z == 0, 1, z))


def tanhc(z: NDArray) -> NDArray:
    """Compute tanh(z)/z."""
    return np.where(z == 0, 1, np.tanh(z) / np.where(z == 0, 1, z))


@dataclass(frozen=True)
class Losses:
    """Losses of one line."""

    exact: LossyLine  # the linear part; its storages are those of the lossless line, which a front meets
    # non-linear addition to the drop of pressure per metre, a function of the flow
    flow_law: FlowLaw | None = None

    @property
    def linear(self) -> bool:
        """Whether the losses are independent of the amplitude."""
        return self.flow_law is None

    @property
    def quadratic(self) -> float:
        """Coefficient K, Pa s²/m⁷, if the law of flow is K |y| y; else 0."""
        law = self.flow_law
        return law.strength if isinstance(law, PowerLaw) and law.exponent == 2 else 0.0

    @property
    def constant(self) -> tuple[float, float] | None:
        """Resistance and conductance per metre, if there are no other losses."""
        return (self.exact.series.loss, self.exact.shunt.loss) if self.linear and self.exact.constant else None

    @property
    def only_quadratic(self) -> bool:
        """Whether K |y| y is the only loss."""
        plain = self.exact.constant and not (self.exact.series.loss or self.exact.shunt.loss)
        return self.quadratic > 0 and plain

    @property
    def distortionless(self) -> bool:
        """Whether the line only delays and attenuates."""
        return self.linear and self.exact.distortionless

    @property
    def attenuation(self) -> float:
        """Attenuation l sqrt(R G) of a distortionless line, in nepers."""
        return self.exact.length * sqrt(self.exact.series.loss * self.exact.shunt.loss)

    def friction(self, y: NDArray) -> tuple[NDArray, NDArray]:
        """Non-linear drop over the whole line at the flow y, and its slope."""
        if self.flow_law is None:
            return np.zeros_like(y), np.zeros_like(y)
        drop, slope = self.flow_law(np.abs(y))
        return np.sign(y) * drop * self.exact.length, slope * self.exact.length

    def steady_drop(self, y: float) -> tuple[float, float]:
        """Fall of the effort from end 1 to end 2 in steady flow y, and its slope over y; without leakage."""
        drop, slope = self.friction(np.array(float(y)))
        resistance = self.exact.series.loss * self.exact.length
        return float(drop) + resistance * y, float(slope) + resistance
