"""Losses of pipes: friction of laminar and of turbulent flow, and viscoelastic walls."""

import math
from collections.abc import Sequence
from typing import Any

from tline.errors import InputError
from tline.loss.foster import Foster
from tline.loss.law import Arithmetic, ConstantLoss, Law, Shape, positive

REYNOLDS = (2e3, 1e8)  # range of Vardy and Brown's fit
TURBULENT = (4e3, 1e8)  # range of Prandtl's law of friction
FULLY_ROUGH = 70.0  # Reynolds number of roughness and friction velocity from which no viscous layer is left
ROUGHEST = 0.1  # roughness over diameter


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
        """Return 2µ/(π R⁴) · z I1(z)/I2(z)."""
        return arithmetic.quotient(1, arithmetic.sqrt(s * self.diffusion_time)) * (self.loss / 4)


class OfARoot(Law):
    """Unsteady friction in units of a pipe: z I3(z)/I2(z), z = sqrt(s), in laminar flow, or s/sqrt(1 + s)."""

    def __init__(self, laminar: bool):
        super().__init__(0.0, 0.0)
        self.laminar = laminar

    def beyond(self, s: Any, arithmetic: Arithmetic) -> Any:
        """Return that of laminar or of turbulent flow."""
        return s / (arithmetic.quotient(2, arithmetic.sqrt(s)) if self.laminar else arithmetic.sqrt(1 + s))


LAMINAR, TURBULENT_ALIKE = OfARoot(laminar=True), OfARoot(laminar=False)


class ChangingLaminarFriction(LaminarFriction):
    """Unsteady part of laminar friction: `LaminarFriction` less `hagen_poiseuille`.

    Beside a law of steady flow; parameters, errors and references as of `LaminarFriction`.

    Examples
    --------
    >>> pipe = ChangingLaminarFriction(density=1000, viscosity=1e-3, radius=0.01)
    >>> print(f"{pipe.at(0):.5g}, {pipe.at(100j):.5g}")
    0+0j, 4.3433e+06+3.2281e+08j
    """

    def __init__(self, density: float, viscosity: float, radius: float):
        super().__init__(density, viscosity, radius)
        self.loss = 0.0
        self.size = 2 * viscosity / (math.pi * radius**4)
        self.shape = Shape(LAMINAR, 1 / self.diffusion_time, self.size)

    def beyond(self, s: Any, arithmetic: Arithmetic) -> Any:
        """Return 2µ/(π R⁴) · z I3(z)/I2(z), z I1(z)/I2(z) less 4."""
        return LAMINAR.beyond(s * self.diffusion_time, arithmetic) * self.size


class TurbulentFriction(Law):
    """Unsteady part of turbulent friction: s ρ/A · (1 + 4 A sqrt(π)/sqrt(B + s R² ρ/µ)).

    Of a smooth wall A = 1/(2 sqrt(π)), B = Re^κ/12.86, κ = log10(15.29/Re^0.0567); of one that is fully rough, where
    Re·ε/d·sqrt(f/8) is above 70, A = 0.0103 sqrt(Re) (ε/d)^0.39 and B = 0.352 Re (ε/d)^0.41. Its friction vanishes in
    steady flow: add `ConstantLoss` with `smooth_pipe_resistance`, or a friction law of another kind.

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
    roughness : float
        ε, of the wall, m, from 0 to a tenth of the diameter.

    Raises
    ------
    InputError
        A parameter out of its range.

    Notes
    -----
    The Laplace transform of the weighting function W(τ) = A exp(-B τ)/sqrt(τ), τ = µ t/(ρ R²), with the eddy viscosity
    frozen at that of the steady flow. Along a smooth wall fast changes meet the same friction as in laminar flow.

    References
    ----------
    A. E. Vardy, J. M. B. Brown, Journal of Sound and Vibration 259 (2003) 1011-1036, doi:10.1006/jsvi.2002.5160; of
    rough walls 270 (2004) 233-257, doi:10.1016/S0022-460X(03)00492-9.

    Examples
    --------
    >>> pipe = TurbulentFriction(density=1000, viscosity=1e-3, radius=0.01, reynolds=2e4)
    >>> print(f"{pipe.at(100j):.5g}")
    4.2957e+06+3.2299e+08j
    """

    def __init__(self, density: float, viscosity: float, radius: float, reynolds: float, roughness: float = 0.0):
        positive(density=density, viscosity=viscosity, radius=radius)
        _inside(reynolds, REYNOLDS)
        super().__init__(0.0, density / (math.pi * radius**2))
        self.diffusion_time = radius**2 * density / viscosity
        share = roughness / (2 * radius)
        if not 0 <= share <= ROUGHEST:
            raise InputError("roughness", "out of range", f"0 to {ROUGHEST:g} of the diameter", f"{share:g} of it")
        rough = share > 0 and reynolds * share / (math.sqrt(8) * 2 * math.log10(3.7 / share)) > FULLY_ROUGH
        if rough:
            self.damping = 0.352 * reynolds * share**0.41  # B
            self.weight = 0.0103 * math.sqrt(reynolds) * share**0.39  # A
        else:
            self.damping = reynolds ** math.log10(15.29 / reynolds**0.0567) / 12.86
            self.weight = 1 / (2 * math.sqrt(math.pi))
        self.size = 4 * self.weight * math.sqrt(math.pi) * self.storage
        rate = self.damping / self.diffusion_time
        self.shape = Shape(TURBULENT_ALIKE, rate, self.size * math.sqrt(rate / self.diffusion_time))

    def beyond(self, s: Any, arithmetic: Arithmetic) -> Any:
        """Return 4 A sqrt(π) s ρ/A / sqrt(B + s R² ρ/µ)."""
        return s / arithmetic.sqrt(s * self.diffusion_time + self.damping) * self.size


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


def kelvin_voigt_wall(
    compliance: float,
    radius: float,
    wall_thickness: float,
    creep: Sequence[tuple[float, float]],
    restraint: float = 1.0,
) -> Foster:
    """Admittance per metre of a pipe with a viscoelastic wall: s C + s A ψ d/e Σ J_k/(1 + s τ_k).

    Parameters
    ----------
    compliance : float
        C of the fluid and the elastic answer of the wall, m²/Pa, above 0: `HydraulicLine.compliance`.
    radius, wall_thickness : float
        Inner radius d/2 and thickness e, m, above 0.
    creep : sequence of (J_k, τ_k)
        Of each Kelvin-Voigt element the creep compliance J_k, 1/Pa, and the retardation time τ_k, s, above 0. The
        creep function of the material is J(t) = 1/E + Σ J_k (1 - exp(-t/τ_k)).
    restraint : float
        ψ, as in `HydraulicLine`, above 0.

    Returns
    -------
    Foster
        Exact: nothing is fitted.

    Raises
    ------
    InputError
        A parameter that is not positive, or no element.

    References
    ----------
    D. Covas, I. Stoianov, J. F. Mano, H. Ramos, N. Graham, C. Maksimovic, Journal of Hydraulic Research 43 (2005)
    56-70, doi:10.1080/00221680509500111: water hammer in polyethylene pipes.

    Examples
    --------
    >>> wall = kelvin_voigt_wall(1.2e-11, 0.025, 6e-3, [(1e-10, 0.05), (1.1e-10, 0.5)])
    >>> f"{wall.at(1e-9).real / 1e-9:.4g} m²/Pa, {wall.storage:.4g} to a front"
    '1.544e-11 m²/Pa, 1.2e-11 to a front'
    """
    positive(compliance=compliance, radius=radius, wall_thickness=wall_thickness, restraint=restraint)
    if not creep:
        raise InputError("creep", "no element", "at least one pair of compliance and time")
    for k, (J, tau) in enumerate(creep):
        positive(**{f"creep[{k}].compliance": J, f"creep[{k}].time": tau})
    stretch = math.pi * radius**2 * restraint * 2 * radius / wall_thickness
    return Foster(0.0, compliance, [stretch * J / tau for J, tau in creep], [1 / tau for _, tau in creep])
