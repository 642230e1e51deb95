"""Density and bulk modulus of named fluids, and Young's modulus of named wall materials.

Bulk moduli are isentropic (density times speed of sound squared): a wave is too fast to exchange heat. Plastics creep:
a fast wave meets a higher modulus than a lasting load; it falls with temperature. Glass-reinforced plastic is absent
since its winding decides: give youngs_modulus.

References
----------
M. H. Chaudhry, Applied Hydraulic Transients, 3rd ed., Springer 2014, doi:10.1007/978-1-4614-8538-4, chapter 1, table of
moduli of wall materials (the middle of the range beside it); ductile iron and PVC as in the design standards of these.
"""

from collections.abc import Mapping
from typing import NamedTuple

from tline.errors import InputError
from tline.line.parameters import choose
from tline.units import to_si

ROOM = 293.15  # K, where a temperature is needed and none is given
# coefficients of SR6-08: power -> coefficient
LOWEST, FREEZES, BOILS, HIGHEST = 253.15, 273.15, 372.76, 383.15  # K
R, SCALE, P0 = 461.51805, 10.0, 1e5  # J/(kg K), K, Pa
G_ALPHA = {4: -1.661470539e5, 5: 2.708781640e6, 7: -1.557191544e8}
G_BETA = {2: -8.237426256e-1, 3: 1.908956353, 4: -2.017597384, 5: 8.546361348e-1}
V_ALPHA = {4: 6.74458446e3, 5: -2.22521604e5, 7: 1.00231247e8, 8: -1.63552118e9, 9: 8.32299658e9}
V_BETA = {
    1: 5.78545292e-3, 2: -1.53195665e-2, 3: 3.11337859e-2, 4: -4.23546241e-2, 5: 3.38713507e-2,
    6: -1.19946761e-2,
}  # fmt: skip
VP_ALPHA = {1: -7.5245878e-6, 3: -1.3767418e-2, 5: 1.0627293e1, 6: -2.0457795e2, 7: 1.2037414e3}
VP_BETA = {
    1: -3.1091470e-6, 3: 2.8964919e-5, 4: -1.3112763e-4, 5: 3.0410453e-4, 6: -3.9034594e-4, 7: 2.3403117e-4,
    9: -4.8510101e-5,
}  # fmt: skip
WALLS = {
    "steel": 206e9,  # mild steel, 200-212 GPa
    "ductile iron": 165.5e9,  # 24e6 psi in ANSI/AWWA C150
    "cast iron": 125e9,  # 80-170 GPa
    "copper": 119e9,  # 107-131 GPa
    "aluminium": 70.5e9,  # alloys, 68-73 GPa
    "concrete": 22e9,  # 14-30 GPa
    "pvc": 2.76e9,  # rigid; 400e3 psi in ANSI/AWWA C900, 2.4-2.75 GPa in Chaudhry
    "hdpe": 0.8e9,  # polyethylene, one value
}


class Fluid(NamedTuple):
    """Fluid at rest."""

    density: float  # kg/m^3
    bulk_modulus: float  # Pa


# Typical of mineral hydraulic oils of 46 mm^2/s (ISO VG 46 at 40 degC) without air, which lowers the bulk
# modulus; the general hydraulic oil of Wolfram System Modeler (Hydraulic.Media.Oil) has these values.
HYDRAULIC_OIL = Fluid(density=850.0, bulk_modulus=1.4e9)


def water(temperature: float = ROOM) -> Fluid:
    """Liquid water at 0.1 MPa, 253.15 to 383.15 K; metastable below 273.15 K and above 372.76 K.

    References
    ----------
    IAPWS SR6-08(2011), Revised Supplementary Release on Properties of Liquid Water at 0.1 MPa,
    http://www.iapws.org/relguide/LiquidWater.html; J. Pátek et al., J. Phys. Chem. Ref. Data 38 (2009) 21-29,
    doi:10.1063/1.3043575.
    """
    if not LOWEST <= temperature <= HIGHEST:
        problem = "no liquid water at 0.1 MPa" + ": it boils at 99.6 degC" * (temperature > HIGHEST)
        expected = "'-20 degC' to '110 degC' (a bare number is in kelvin)"
        raise InputError("temperature", problem, expected, _shown(temperature))
    alpha, beta = SCALE / (593.0 - temperature), SCALE / (temperature - 232.0)
    v = R * SCALE / P0 * (1.93763157e-2 + _series(V_ALPHA, alpha) + _series(V_BETA, beta))
    v_T = R / P0 * (_series(V_ALPHA, alpha, 1) - _series(V_BETA, beta, 1))
    v_p = R * SCALE / P0**2 * (_series(VP_ALPHA, alpha) + _series(VP_BETA, beta))
    tau = temperature / SCALE
    c_p = -R * (-8.983025854 + tau * (_series(G_ALPHA, alpha, 2) + _series(G_BETA, beta, 2)))
    return Fluid(density=1 / v, bulk_modulus=-v / (v_p + temperature * v_T**2 / c_p))


def fluid(name: str, temperature: float | str | None = None) -> Fluid:
    """Look up a fluid by name, water at a temperature, K or a text; 20 degC without one."""
    found = choose(FLUIDS, name, "fluid")
    if found is None:
        return water(ROOM if temperature is None else to_si(temperature, "K", "temperature"))
    if temperature is not None:
        raise InputError("temperature", "only water is known at other temperatures", got=repr(temperature))
    return found


def metastable(temperature: float | str | None) -> list[str]:
    """Remark on water that boils or freezes at 0.1 MPa; empty if it does not.

    Examples
    --------
    >>> metastable("20 degC")
    []
    """
    kelvin = ROOM if temperature is None else to_si(temperature, "K", "temperature")
    if FREEZES <= kelvin <= BOILS:
        return []
    what, kept = ("boils", "overheated") if kelvin > BOILS else ("freezes", "undercooled")
    values = f"density and bulk modulus are those of the {kept} liquid"
    return [f"temperature: water of {_shown(kelvin)} {what} at 0.1 MPa; {values}"]


def _shown(temperature: float) -> str:
    return f"{temperature:.6g} K ({temperature - 273.15:.5g} degC)"


# by name; that of water depends on temperature
FLUIDS: dict[str, Fluid | None] = {"water": None, "hydraulic oil": HYDRAULIC_OIL}


def _series(terms: Mapping[int, float], x: float, derivative: int = 0) -> float:
    """Sum of coefficient * x**n; its derivatives in temperature obey d(x**n)/dT = ± n*x**(n+1)/SCALE."""
    rising = {0: lambda n: 1, 1: lambda n: n, 2: lambda n: n * (n + 1)}[derivative]
    return sum(coefficient * rising(n) * x ** (n + derivative) for n, coefficient in terms.items())


def youngs_modulus(name: str) -> float:
    """Young's modulus in Pa of the wall material of that name."""
    return choose(WALLS, name, "wall")
