"""Friction of turbulent flow in a smooth round pipe, for small changes about a steady flow."""

import math
from typing import Any

from tline.errors import InputError
from tline.loss.arithmetic import Arithmetic
from tline.loss.check import positive
from tline.loss.law import Law

REYNOLDS = (2e3, 1e8)  # range of Vardy and Brown's fit
TURBULENT = (4e3, 1e8)  # range of Prandtl's law of friction


class TurbulentFriction(Law):
    """What friction adds while the flow changes: s ρ/A · (1 + 2/sqrt(B + s R² ρ/µ)), B = Re^κ/12.86.

    κ = log10(15.29/Re^0.0567). Its friction vanishes in steady flow: add `ConstantLoss` with `smooth_pipe_resistance`,
    or a friction law of another kind.

    Parameters
    ----------
    density : float
        ρ, kg/m³, above 0.
    viscosity : float
        µ, dynamic, Pa s, above 0.
    radius : float
        R, m, above 0.
    reynolds : float
        Reynolds number of the steady flow, mean speed × diameter × ρ/µ, 2e3 to 1e8.

    Raises
    ------
    InputError
        A parameter out of its range.

    Notes
    -----
    The Laplace transform of the weighting function W(τ) = exp(-B τ)/(2 sqrt(π τ)), τ = µ t/(ρ R²), with the eddy
    viscosity frozen at that of the steady flow. Fast changes meet the same friction as in laminar flow.

    References
    ----------
    A. E. Vardy, J. M. B. Brown, Journal of Sound and Vibration 259 (2003) 1011-1036, doi:10.1006/jsvi.2002.5160.

    Examples
    --------
    >>> pipe = TurbulentFriction(density=1000, viscosity=1e-3, radius=0.01, reynolds=2e4)
    >>> print(f"{pipe.at(100j):.5g}")
    4.2957e+06+3.2299e+08j
    """

    def __init__(self, density: float, viscosity: float, radius: float, reynolds: float):
        positive(density=density, viscosity=viscosity, radius=radius)
        _inside(reynolds, REYNOLDS)
        super().__init__(0.0, density / (math.pi * radius**2))
        self.diffusion_time = radius**2 * density / viscosity
        self.damping = reynolds ** math.log10(15.29 / reynolds**0.0567) / 12.86  # B

    def beyond(self, s: Any, arithmetic: Arithmetic) -> Any:
        """2 s ρ/A / sqrt(B + s R² ρ/µ)."""
        return s / arithmetic.sqrt(s * self.diffusion_time + self.damping) * (2 * self.storage)


def smooth_pipe_resistance(density: float, viscosity: float, radius: float, reynolds: float) -> float:
    """Slope of pressure drop per metre against flow, in steady turbulent flow in a smooth pipe, Pa s/m⁴.

    Parameters
    ----------
    density, viscosity, radius : float
        As `TurbulentFriction`.
    reynolds : float
        4e3 to 1e8.

    Raises
    ------
    InputError
        A parameter out of its range.

    Notes
    -----
    Darcy's friction factor by Prandtl's law 1/√f = 2 log10(Re √f) - 0.8; ρ f V²/(4R) is differentiated with it.

    References
    ----------
    H. Schlichting, K. Gersten, Boundary-Layer Theory, 9th ed., Springer 2017,
    doi:10.1007/978-3-662-52919-5.

    Examples
    --------
    >>> f"{smooth_pipe_resistance(density=1000, viscosity=1e-3, radius=0.01, reynolds=1e5):.4g} Pa s/m^4"
    '1.282e+07 Pa s/m^4'
    """
    from scipy.special import lambertw

    positive(density=density, viscosity=viscosity, radius=radius)
    _inside(reynolds, TURBULENT)
    c = 2 / math.log(10)
    x = c * lambertw(reynolds * 10**-0.4 / c).real  # 1/√f, from x = c ln(Re/x) - 0.8
    slope = 1 / (x * (x + c))  # f + (Re/2) df/dRe
    speed = reynolds * viscosity / (2 * radius * density)
    return density * speed * slope / (2 * radius * math.pi * radius**2)


def _inside(reynolds: float, limits: tuple[float, float]) -> None:
    positive(reynolds=reynolds)
    low, high = limits
    if not low <= reynolds <= high:
        raise InputError("reynolds", "out of range", f"{low:g} to {high:g}", f"{reynolds:g}")
