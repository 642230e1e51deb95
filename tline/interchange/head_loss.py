"""What a pipe loses by EPANET's formulas, as the friction of a scene's pipe."""

from typing import Any

from tline.interchange.water_network import Pipe
from tline.scene.friction import FOOT
from tline.scene.site import GRAVITY

EPANETS = 32.2 * FOOT  # m/s², its g
MANNING = 1.49**2 * FOOT ** (2 - 1.333)  # of its formula in m and s: n²·v²/(this·R^1.333)


def friction_of(pipe: Pipe, density: float, viscosity: float) -> dict[str, Any]:
    """The table of friction of a pipe, which loses the same head at any flow.

    Where EPANET's constants are not those of the scene, friction acts over a slightly different length.

    Parameters
    ----------
    pipe : Pipe
    density, viscosity : float
        kg/m³, and kinematic in m²/s.

    References
    ----------
    EPANET 2.2 User Manual, section 3.1.
    """
    friction, ratio = pipe.friction, GRAVITY / EPANETS
    if friction.formula == "H-W":
        table, along = {"kind": "hazen-williams", "coefficient": friction.roughness}, 1.0
    elif friction.formula == "C-M":
        table = {"kind": "manning", "coefficient": friction.roughness}
        along = (pipe.diameter / 4) ** (4 / 3 - 1.333) / MANNING
    else:
        table = {"kind": "swamee-jain", "roughness": friction.roughness, "viscosity": density * viscosity}
        along = ratio
    if along * friction.length != pipe.length:
        table["length"] = along * friction.length
    return table | ({"minor_loss": ratio * friction.minor} if friction.minor else {})
