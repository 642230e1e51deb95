"""A pipe wall that creeps."""

import math
from collections.abc import Sequence

from tline.errors import InputError
from tline.loss.check import positive
from tline.loss.foster import Foster


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
